//! `--time-step DT`: is a step within the limit, by what margin, and which penalties does it stand?

use std::path::PathBuf;

use super::summary::{FEW_POINTS, short};
use super::{Job, LimitOptions, Output, Progress, Solved};
use crate::error::Result;
use crate::record::{StabilityRow, StepRow, Subject};
use bipenalty::stability::Largest;

/// A step held against the limits of every job.
#[derive(Debug, Default)]
pub struct HeldStep {
    /// One row a point.
    pub rows: Vec<StepRow>,
    /// The same in words.
    pub answers: Vec<String>,
    /// Number of files written.
    pub files: usize,
}

/// Holds `time_step`, s, against the limit at every point of the jobs, finds the penalties that it stands, and writes the
/// rows.
///
/// # Errors
/// What [`Job::check`], [`Job::solve`] and [`AnyModel::largest_penalty`](bipenalty::stability::AnyModel::largest_penalty)
/// refuse, and what the system says of the files.
pub fn hold_step(
    jobs: &[Job],
    limit: &LimitOptions,
    time_step: f64,
    output: &Output,
    quiet: bool,
) -> Result<HeldStep> {
    jobs.iter().try_for_each(Job::check)?;
    let progress = Progress::new(jobs.iter().map(Job::points).sum(), "points", quiet);
    let mut held = HeldStep::default();
    for job in jobs {
        for solved in job.solve(limit, &progress)? {
            let subject = Subject::of(&solved.model)?;
            let rows = rows_of(&solved, &subject, limit, time_step)?;
            held.answers.extend(answers(&solved, &subject, &rows, time_step));
            let written: Vec<PathBuf> = output.write_rows(&job.stem, &rows)?;
            held.files += written.len();
            held.rows.extend(rows);
        }
    }
    Ok(held)
}

fn rows_of(solved: &Solved, subject: &Subject, limit: &LimitOptions, time_step: f64) -> Result<Vec<StepRow>> {
    let (model, asking) = (&*solved.model, limit.asking()?);
    let points = StabilityRow::of(subject, limit.name()?, &solved.curves);
    let betas: Vec<f64> = solved.curves[0].points.iter().map(|point| point.stiffness_penalty.get()).collect();
    let ratio = |beta_s: &f64| match *beta_s > 0.0 && subject.scale().is_some() {
        true => model.largest_ratio(time_step, *beta_s, &asking),
        false => Ok(None),
    };
    let ratios = betas.iter().map(ratio).collect::<Result<Vec<Option<Largest>>, _>>()?;
    let mut rows = Vec::new();
    for (curve, points) in solved.curves.iter().zip(points.chunks(betas.len())) {
        let penalty = match subject.scale() {
            Some(_) => model.largest_penalty(time_step, curve.ratio.get(), &asking)?,
            None => None,
        };
        let row = |(row, ratio): (&StabilityRow, &Option<Largest>)| {
            StepRow::new(subject, row, time_step, penalty, *ratio)
        };
        rows.extend(points.iter().zip(&ratios).map(row));
    }
    Ok(rows)
}

/// The verdict first, then what the step stands.
fn answers(solved: &Solved, subject: &Subject, rows: &[StepRow], time_step: f64) -> Vec<String> {
    let Some(first) = rows.first() else { return Vec::new() };
    let whose = match solved.limit.is_spectrum() {
        true => "linear limit".to_owned(),
        false => format!("linear limit of {}", spoken(first.limit)),
    };
    let free = solved.contact_free.ok();
    let free = free.map(|step| (solved.seconds_of(step.lower), solved.seconds_of(step.upper)));
    let within = free.and_then(|(lower, upper)| match (time_step <= lower, time_step > upper) {
        (true, _) => Some(true),
        (false, true) => Some(false),
        (false, false) => None,
    });
    let verdict = judged(within, time_step, free);
    let mut text = vec![
        format!("{}, {} mass: dt = {} s is {verdict}", first.scene, first.mass, short(time_step))
            .replace("LIMIT", &format!("the {whose} without contact")),
    ];
    let closed: Vec<&StepRow> = rows.iter().filter(|row| row.stiffness_penalty.0 > 0.0).collect();
    if closed.len() > FEW_POINTS {
        let of = |wanted: Option<bool>| closed.iter().filter(|row| row.within == wanted).count();
        let (within, all) = (of(Some(true)), closed.len());
        let unknown = match of(None) {
            0 => String::new(),
            n => format!(", unknown at {n}"),
        };
        text.push(format!(
            "  within the linear limit of closed contact at {within} of {all} points{unknown}"
        ));
    } else {
        for row in closed {
            let enclosed = row.step_lower.zip(row.step_upper).map(|(lower, upper)| (lower.0, upper.0));
            let verdict = judged(row.within, time_step, enclosed);
            let verdict = verdict.replace("LIMIT", "the linear limit of closed contact");
            text.push(format!("  {}, r = {}: {verdict}", penalty(subject, row), short(row.ratio.0)));
        }
    }
    if within != Some(false) && subject.scale().is_some() {
        text.extend(stands(subject, rows));
    }
    text
}

/// How a limit is called in a sentence.
fn spoken(limit: &str) -> String {
    match limit {
        "park" => "Park's scheme".to_owned(),
        other => format!("the {} scheme", other.replace("damped-", "damped ")),
    }
}

/// Whether a step is within its limit, between `enclosed` in s, and by how much.
fn judged(within: Option<bool>, time_step: f64, enclosed: Option<(f64, f64)>) -> String {
    match (within, enclosed) {
        (Some(true), Some((lower, _))) => {
            format!(
                "within LIMIT by {} (dt_cr = {} s)",
                percent(lower / time_step - 1.0),
                rounded_down(lower)
            )
        }
        (Some(false), Some((lower, _))) => {
            format!(
                "BEYOND LIMIT by {} (dt_cr = {} s)",
                percent(1.0 - lower / time_step),
                rounded_down(lower)
            )
        }
        (None, Some((lower, upper))) => {
            let beyond = match upper.is_finite() {
                true => format!("unstable from {} s on", short(upper)),
                false => "more is not proven".to_owned(),
            };
            format!("not decided: stable up to dt = {} s, {beyond}", rounded_down(lower))
        }
        (_, None) => "held against LIMIT in vain: it could not be certified".to_owned(),
    }
}

/// The largest penalty for each ratio, and the largest ratio for each penalty.
fn stands(subject: &Subject, rows: &[StepRow]) -> Vec<String> {
    let mut text = Vec::new();
    for row in rows.iter().filter(|row| row.stiffness_penalty == rows[0].stiffness_penalty) {
        let most = match (row.largest_stiffness_penalty_lower, row.largest_penalty_stiffness) {
            (Some(most), _) if most.0.is_infinite() => "any stiffness".to_owned(),
            (Some(most), Some(stiffness)) if most.0 > 0.0 => {
                format!("beta_s up to {}, {} N/m", rounded_down(most.0), rounded_down(stiffness.0))
            }
            (Some(_), _) => "no stiffness is proven".to_owned(),
            (None, _) => "no stiffness".to_owned(),
        };
        text.push(format!("  r = {}: {most}", short(row.ratio.0)));
    }
    let closed = rows.iter().filter(|row| row.ratio == rows[0].ratio && row.stiffness_penalty.0 > 0.0);
    for row in closed.take(FEW_POINTS) {
        let most = match row.largest_ratio_lower {
            Some(most) if most.0.is_infinite() => "any r".to_owned(),
            Some(most) if most.0 > 0.0 => format!("r up to {}", rounded_down(most.0)),
            Some(_) => "no r is proven".to_owned(),
            None => "no r".to_owned(),
        };
        text.push(format!("  {}: {most}", penalty(subject, row)));
    }
    text
}

fn penalty(subject: &Subject, row: &StepRow) -> String {
    let beta_s = row.stiffness_penalty.0;
    match subject.scale() {
        Some(scale) => format!("beta_s = {} ({} N/m)", short(beta_s), rounded_down(beta_s * scale)),
        None => format!("beta_s = {}", short(beta_s)),
    }
}

fn percent(share: f64) -> String {
    match 100.0 * share {
        percent if percent < 0.1 => format!("{percent:.1e} %"),
        percent if percent < 10.0 => format!("{percent:.1} %"),
        percent => format!("{percent:.0} %"),
    }
}

/// Six digits of a positive number, never more than it: what is proven up to there stays proven.
fn rounded_down(x: f64) -> String {
    let text = format!("{x:e}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    // A digit, a point and five digits; all of them are ASCII.
    let kept = &mantissa[..mantissa.len().min(7)];
    match exponent {
        "0" => kept.to_owned(),
        _ => format!("{kept}e{exponent}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_down() {
        for (x, text) in [(1.999_999_9, "1.99999"), (2.0, "2"), (1.234_567e-7, "1.23456e-7"), (9.5, "9.5")] {
            assert_eq!(rounded_down(x), text);
        }
    }
}
