//! A run in a few numbers.

use super::{Accuracy, Ending, History, Run};
use crate::scene::ContactSite;

/// What the summary table shows of a run; `None` where there is no exact solution or nothing to divide by, and for a run
/// that blew up: its last rows are noise of any size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// [`Accuracy::force_error`]; `None` also if the recording did not ask for it.
    pub force_error: Option<f64>,
    /// [`Accuracy::steady_relative_gap`]; `None` also if the recording did not ask for it.
    pub steady_relative_gap: Option<f64>,
    /// [`Accuracy::overshoot`] and [`Accuracy::variation`]; `None` as the others.
    pub oscillation: [Option<f64>; 2],
    /// Kinetic, strain and penalty energy at the end over that at the start. With a body force its potential belongs to
    /// both, measured from where the bar touches the wall.
    pub energy_ratio: Option<f64>,
    /// Whether `energy_ratio` is above 1 by more than rounding: 4 epsilon a step of the largest energy in it.
    pub more_energy: bool,
    /// How often a contact has opened or closed.
    pub switches: u64,
}

impl Summary {
    /// The summary of `history`, which `run` has left.
    pub fn of(run: &Run, history: &History) -> Self {
        let switches = history.switches;
        if matches!(history.ending, Ending::BlewUp { .. }) {
            return Self::new(Accuracy::default(), None, switches);
        }
        Self::new(history.accuracy.unwrap_or_default(), energy_ratio(run, history), switches)
    }

    /// With the energy at the end over that at the start, and what rounding may make of it.
    pub fn new(accuracy: Accuracy, energy: Option<(f64, f64)>, switches: u64) -> Self {
        let Accuracy { force_error, steady_relative_gap, overshoot, variation } = accuracy;
        Self {
            force_error,
            steady_relative_gap,
            oscillation: [overshoot, variation],
            energy_ratio: energy.map(|(ratio, _)| ratio),
            more_energy: energy.is_some_and(|(ratio, rounding)| ratio > 1.0 + rounding),
            switches,
        }
    }
}

/// End over start, and what rounding may make of it: each step rounds each of the sums of the balance, which the
/// energies keep to 4 epsilon a step of the largest of them.
fn energy_ratio(run: &Run, history: &History) -> Option<(f64, f64)> {
    let available = potential_at_start(run);
    let [first, last] = history.first_and_last;
    let work = last.body_work - first.body_work;
    let start = first.stored() + available;
    let end = last.stored() + available - work;
    let sizes = [start, available, work, last.stored(), last.loss];
    let largest = sizes.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let rounding = 4.0 * f64::EPSILON * (history.steps + 1) as f64 * largest / start;
    // Below, energies are subnormal and have lost their digits.
    (start >= f64::MIN_POSITIVE).then(|| (end / start, rounding))
}

/// The work that the body force does until the row of bars touches its first wall, J.
pub(crate) fn potential_at_start(run: &Run) -> f64 {
    let scene = run.model().scene();
    let Some(impact) = scene.impact() else { return 0.0 };
    let weight: f64 = scene.bars().iter().map(|bar| bar.element_mass() * bar.elements as f64).sum();
    let wall = scene.contact_sites().into_iter().enumerate().find_map(|(j, site)| match site {
        ContactSite::LeftWall => Some((j, -1.0)),
        ContactSite::RightWall => Some((j, 1.0)),
        ContactSite::Between(_) => None,
    });
    wall.map_or(0.0, |(j, direction)| {
        weight * impact.gravity * direction * impact.gaps.get(j).copied().unwrap_or(0.0)
    })
}
