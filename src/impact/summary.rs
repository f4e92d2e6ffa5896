//! A run in a few numbers.

use super::{Accuracy, Ending, History, Kept, Run};
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
    /// [`Kept::more`].
    pub more_energy: bool,
    /// [`Kept::gained`].
    pub gained: bool,
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
        let kept = Kept::of(history.first_and_last, potential_at_start(run), history.steps);
        Self::new(history.accuracy.unwrap_or_default(), kept, switches)
    }

    /// With the energy at the end.
    pub fn new(accuracy: Accuracy, kept: Option<Kept>, switches: u64) -> Self {
        let Accuracy { force_error, steady_relative_gap, overshoot, variation } = accuracy;
        Self {
            force_error,
            steady_relative_gap,
            oscillation: [overshoot, variation],
            energy_ratio: kept.map(|kept| kept.ratio),
            more_energy: kept.is_some_and(|kept| kept.more),
            gained: kept.is_some_and(|kept| kept.gained),
            switches,
        }
    }
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
