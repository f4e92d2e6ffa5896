//! Answers in words: the step of a point, and what governs it.

use super::Solved;
use super::summary::short;
use crate::record::StabilityRow;
use bipenalty::penalty::Ratio;
use bipenalty::stability::{AnyModel, Governing, MapPoint};

/// The answer for each of a few points, in words.
pub fn point_answers(solved: &Solved, rows: &[StabilityRow]) -> Vec<String> {
    let points =
        solved.curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve.ratio, point)));
    let answer = |((ratio, point), row): ((Ratio, &MapPoint), &StabilityRow)| {
        let step = point.step.ok()?;
        let pure = if ratio == Ratio::PURE_PENALTY { " (pure penalty)" } else { "" };
        let free = solved.contact_free.ok();
        let evidence = match solved.limit.is_spectrum() {
            true => format!(", omega_max = {:e} rad/s", step.omega_max),
            false => match free.filter(|free| free.upper < step.lower) {
                None => format!(", {}", solved.limit.name()),
                Some(free) => format!(
                    ", {}; when the contact opens dt = {:e} s binds",
                    solved.limit.name(),
                    solved.seconds_of(free.lower)
                ),
            },
        };
        let (what, bound) = match step.is_lower_bound() {
            true => ("stable up to at least", "lower bound, "),
            false => ("linear limit of closed contact", ""),
        };
        Some(format!(
            "{}, {} mass, beta_s = {}, r = {}{pure}: {what} dt = {:e} s ({bound}C_r = {}{evidence})",
            row.scene,
            row.mass,
            short(row.stiffness_penalty.0),
            short(row.ratio.0),
            solved.seconds_of(step.lower),
            step.critical_courant,
        ))
    };
    points.zip(rows).filter_map(answer).collect()
}

/// What governs a point, in words: contacts and bodies of at least a tenth, and the first element.
pub fn governing_answer(model: &AnyModel, beta_s: f64, ratio: f64, governing: &Governing) -> String {
    const SHARE: f64 = 0.1;
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let contacts: Vec<String> =
        governing.contacts.iter().filter(|c| c.share >= SHARE).map(ToString::to_string).collect();
    let bodies: Vec<String> = governing
        .bodies
        .iter()
        .filter(|(_, share)| *share >= SHARE)
        .map(|(name, share)| format!("{name} {}", percent(*share)))
        .collect();
    let mut text = format!(
        "{}, beta_s = {}, r = {}: {} of the elastic energy of the critical mode is in its {} contacts",
        model.name(),
        short(beta_s),
        short(ratio),
        percent(governing.contact_energy),
        model.contacts(),
    );
    if governing.contact_energy >= SHARE {
        text += &match contacts.is_empty() {
            true => ", none of which holds a tenth".to_owned(),
            false => format!("; of it {}", contacts.join(", ")),
        };
    }
    if !bodies.is_empty() {
        text += &format!("; in motion: {}", bodies.join(", "));
    }
    if let Some((element, share)) = governing.elements.first() {
        text += &format!("; strained most: element {} ({})", element + 1, percent(*share));
    }
    text
}
