//! What `verify-limits` says at the end: how many limits stepping confirms, and which it cannot reach.

use super::print_table;
use crate::record::VerifyRow;

/// Prints one line for each list of rows of one model and scheme, and what could not be judged.
pub fn print_verification(all: &[Vec<VerifyRow>]) {
    let header = [
        "scene",
        "elements",
        "mass",
        "scheme",
        "points",
        "agree",
        "limit within",
        "growth too slow to be seen",
    ];
    print_table(&header, all.iter().filter_map(|rows| line(rows)));
    let unseen = || all.iter().flatten().filter(|row| row.agrees.is_none());
    let steps = unseen().filter_map(|row| row.steps_needed).map(|steps| steps.0);
    if let Some(most) = steps.reduce(f64::max) {
        eprintln!(
            "{} of {} points are not judged: above the predicted limit growth is too slow to be seen \
             (predicted_growth), up to {most:.0e} steps would show it (steps_needed); below it none grew",
            unseen().count(),
            all.iter().map(Vec::len).sum::<usize>()
        );
    }
    islands(all);
}

/// How often a scheme is stable again above its limit, with the first example.
fn islands(all: &[Vec<VerifyRow>]) {
    let with = || all.iter().flatten().filter(|row| !row.islands.is_empty());
    if let Some(row) = with().next() {
        eprintln!(
            "{} points are stable again above their limit (islands), as {}, {} mass, {}, beta_s = {}, r = {}: limit \
             {:.6}, island {}; when the contact opens the contact-free limit binds",
            with().count(),
            row.scene,
            row.mass,
            row.scheme,
            row.stiffness_penalty.0,
            row.ratio.0,
            row.predicted.0,
            row.islands
        );
    }
}

fn line(rows: &[VerifyRow]) -> Option<Vec<String>> {
    let first = rows.first()?;
    let judged = || rows.iter().filter(|row| row.agrees.is_some());
    let distance = |row: &VerifyRow| {
        let (below, above) = (row.stable_at.0 / row.predicted.0, row.unstable_at.0 / row.predicted.0);
        (below - 1.0).abs().max((above - 1.0).abs())
    };
    let agree = judged().filter(|row| row.agrees == Some(true)).count();
    let unseen = rows.len() - judged().count();
    Some(vec![
        first.scene.clone(),
        first.elements.to_string(),
        first.mass.clone(),
        first.scheme.to_owned(),
        rows.len().to_string(),
        if agree == rows.len() - unseen { format!("all {agree}") } else { format!("{agree}, NOT ALL") },
        format!("{:.1e}", judged().map(distance).fold(0.0, f64::max)),
        unseen.to_string(),
    ])
}
