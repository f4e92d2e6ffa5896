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
        "largest distance",
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
}

fn line(rows: &[VerifyRow]) -> Option<Vec<String>> {
    let first = rows.first()?;
    let judged = || rows.iter().filter(|row| row.agrees.is_some());
    let distance =
        |row: &VerifyRow| (0.5 * (row.stable_at.0 + row.unstable_at.0) / row.predicted.0 - 1.0).abs();
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
