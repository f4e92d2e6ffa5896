//! The records and figures of `contact-impact`.

use super::{
    FinishedPassage, FinishedRun, Output, PlannedRun, exact_energy, exact_force, exact_stress, suffix,
};
use crate::charts::impacts::{self, Quantity};
use crate::error::Result;
use crate::record::{HistoryRow, ImpactRow};
use bipenalty::impact::Ending;

/// Writes the records of the runs of one figure; the number of files.
///
/// # Errors
/// What the system says of a file.
pub fn write_impacts(finished: &[FinishedRun], output: &Output) -> Result<usize> {
    let mut files = 0;
    for run in finished {
        for contact in 0..run.history.contacts {
            files +=
                output.write_rows(&run.history_stem(contact), &HistoryRow::of(&run.history, contact))?.len();
        }
        files += output.write_rows(&run.stress_stem(), &run.stress())?.len();
    }
    Ok(files)
}

/// Draws the runs of one figure, contact by contact. What has blown up would hide everything else; its row says when.
///
/// # Errors
/// What the system says of a file.
pub fn draw_impacts(finished: &[FinishedRun], output: &Output) -> Result<usize> {
    let drawable = |run: &&FinishedRun| !matches!(run.history.ending, Ending::BlewUp { .. });
    let drawable: Vec<&FinishedRun> = finished.iter().filter(drawable).collect();
    let Some(first) = drawable.first().filter(|_| output.wants_figures()) else { return Ok(0) };
    (0..first.history.contacts).map(|contact| draw(&first.planned, &drawable, contact, output)).sum()
}

/// Force and gap of one contact; with the first also what belongs to the bars.
fn draw(planned: &PlannedRun, runs: &[&FinishedRun], contact: usize, output: &Output) -> Result<usize> {
    let (run, ratio) = (&planned.run, planned.ratio.get());
    let (scene, mass) = (run.model().scene().name(), run.model().mass().name());
    let ratio = if ratio == 1.0 { String::new() } else { format!("-r{ratio}") };
    let records: Vec<_> = runs.iter().map(|run| run.record(contact)).collect();
    let summary: Vec<ImpactRow> = runs.iter().map(|run| run.row()).collect();
    let number = (run.model().scales().len() > 1).then_some(contact + 1);
    let histories: Vec<String> = runs.iter().map(|run| run.history_stem(contact)).collect();
    let mut files = 0;
    for (name, quantity) in Quantity::ALL.into_iter().filter(|(_, q)| contact == 0 || q.is_of_contact()) {
        let exact = match quantity {
            Quantity::Force => exact_force(run),
            Quantity::Energy => exact_energy(run),
            Quantity::Gap | Quantity::LargestGap => Vec::new(),
        };
        let figure = impacts::histories(scene, &mass, &records, (quantity, number), &exact);
        let stem = format!("{scene}-{name}-{mass}{ratio}{}", suffix(contact));
        files += output.write_figure_of(&stem, &figure, &histories, Some(&summary))?.len();
    }
    if contact == 0 {
        let time = records.iter().flat_map(|record| &record.stress).map(|row| row.time.0).next();
        let exact = time.map_or_else(Vec::new, |time| exact_stress(run, time));
        let figure = impacts::stresses(scene, &mass, &records, &exact);
        let stem = format!("{scene}-stress-{mass}{ratio}");
        let stresses: Vec<String> = runs.iter().map(|run| run.stress_stem()).collect();
        files += output.write_figure_of(&stem, &figure, &stresses, Some(&summary))?.len();
    }
    Ok(files)
}

/// Draws resultant force, largest gap and energies of the runs of one figure.
///
/// # Errors
/// What the system says of a file.
pub fn draw_passages(finished: &[FinishedPassage], output: &Output) -> Result<usize> {
    let drawable: Vec<&FinishedPassage> =
        finished.iter().filter(|run| !matches!(run.ending, Ending::BlewUp { .. })).collect();
    let Some(first) = drawable.first().filter(|_| output.wants_figures()) else { return Ok(0) };
    let (scene, mass, ratio) =
        (first.planned.model.name(), first.planned.mass(), first.planned.point.ratio.get());
    let ratio = if ratio == 1.0 { String::new() } else { format!("-r{ratio}") };
    let records: Vec<_> = drawable.iter().map(|run| run.record()).collect();
    let summary: Vec<ImpactRow> = drawable.iter().map(|run| run.row.clone()).collect();
    let histories: Vec<String> = drawable.iter().map(|run| run.planned.stem()).collect();
    let mut files = 0;
    for (name, quantity) in Quantity::OF_MANY {
        let exact = if quantity == Quantity::Force { first.planned.exact.clone() } else { Vec::new() };
        let figure = impacts::histories(scene, &mass, &records, (quantity, None), &exact);
        let stem = format!("{scene}-{name}-{mass}{ratio}");
        files += output.write_figure_of(&stem, &figure, &histories, Some(&summary))?.len();
    }
    Ok(files)
}
