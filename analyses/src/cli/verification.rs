//! What `verify-limits` says at the end: how many limits stepping confirms, and which it cannot reach.

use super::print_table;
use crate::record::VerifyRow;

/// Prints one line for each list of rows of one model and scheme, and what could not be judged.
pub fn print_verification(all: &[Vec<VerifyRow>]) {
    let header = ["scene", "elements", "mass", "scheme", "points", "agree", "limit within", "not judged"];
    print_table(&header, all.iter().filter_map(|rows| line(rows)));
    let unseen = || all.iter().flatten().filter(|row| row.agrees.is_none());
    let steps = unseen().filter_map(|row| row.steps_needed).map(|steps| steps.0);
    if let Some(most) = steps.reduce(f64::max) {
        crate::tell!(
            "{} of {} points are not judged: above the predicted limit growth is too slow to be seen \
             (predicted_growth), up to {most:.0e} steps would show it (steps_needed); below it none grew",
            unseen().count(),
            all.iter().map(Vec::len).sum::<usize>()
        );
    }
    let unpredicted = all.iter().flatten().filter(|row| row.predicted.is_none()).count();
    if unpredicted > 0 {
        crate::tell!(
            "{unpredicted} points have no prediction: stable_at and unstable_at are what stepping found"
        );
    }
    let growing = all.iter().flatten().filter(|row| row.stable_at.0 == 0.0).count();
    if growing > 0 {
        crate::tell!(
            "{growing} points have no stable step that trials of this length can tell (stable_at = 0)"
        );
    }
    islands(all);
}

/// Prints why points have no prediction: each reason once, with the number of points.
pub fn print_reasons(reasons: &[String]) {
    let mut counted: Vec<(&String, usize)> = Vec::new();
    for reason in reasons {
        match counted.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, count)) => *count += 1,
            None => counted.push((reason, 1)),
        }
    }
    for (reason, count) in counted {
        crate::tell!("{count} points without a prediction: {reason}");
    }
}

/// How often a scheme is stable again above its limit, with the first example.
fn islands(all: &[Vec<VerifyRow>]) {
    let with = || all.iter().flatten().filter(|row| !row.islands.is_empty());
    if let Some(row) = with().next() {
        crate::tell!(
            "{} points are stable again above their limit (islands), as {}, {} mass, {}, beta_s = {}, r = {}: limit \
             {:.6}, island {}; when the contact opens the contact-free limit binds",
            with().count(),
            row.scene,
            row.mass,
            row.scheme,
            row.stiffness_penalty.0,
            row.ratio.0,
            row.predicted.map_or(f64::NAN, |predicted| predicted.0),
            row.islands
        );
    }
}

fn line(rows: &[VerifyRow]) -> Option<Vec<String>> {
    let first = rows.first()?;
    let judged = || rows.iter().filter(|row| row.agrees.is_some());
    let distance = |row: &VerifyRow| {
        let predicted = row.predicted.map_or(f64::NAN, |predicted| predicted.0);
        (row.stable_at.0 / predicted - 1.0).abs().max((row.unstable_at.0 / predicted - 1.0).abs())
    };
    let agree = judged().filter(|row| row.agrees == Some(true)).count();
    let unseen = rows.len() - judged().count();
    Some(vec![
        first.scene.clone(),
        first.elements.map_or_else(|| "-".to_owned(), |elements| elements.to_string()),
        first.mass.clone(),
        first.scheme.to_owned(),
        rows.len().to_string(),
        if agree == rows.len() - unseen { format!("all {agree}") } else { format!("{agree}, NOT ALL") },
        format!("{:.1e}", judged().map(distance).fold(0.0, f64::max)),
        unseen.to_string(),
    ])
}
