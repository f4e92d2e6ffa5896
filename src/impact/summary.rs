//! A run in a few numbers.

use super::{Ending, Exact, History, Run};
use crate::scene::ContactSite;
use crate::schemes::{ContactSearch, Scheme};

/// What the summary table shows of a run; `None` where there is no exact solution or nothing to divide by, and for a run
/// that blew up: its last rows are noise of any size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// rms of force minus exact force over the rows, over the peak exact force. Sampled once a step if the recording
    /// has a row for every step. Where the exact force jumps, central differences, whose force belongs to the step that
    /// begins, are compared with its later value, the other schemes with the earlier one.
    pub force_error: Option<f64>,
    /// Median of g/h over the middle half of the first exact contact interval.
    pub steady_relative_gap: Option<f64>,
    /// Kinetic, strain and penalty energy at the end over that at the start. With a body force its potential belongs to
    /// both, measured from where the bar touches the wall.
    pub energy_ratio: Option<f64>,
    /// How often a contact has opened or closed.
    pub switches: u64,
}

impl Summary {
    /// The summary of `history`, which `run` has left.
    pub fn of(run: &Run, history: &History) -> Self {
        if matches!(history.ending, Ending::BlewUp { .. }) {
            let switches = history.switches;
            return Self { force_error: None, steady_relative_gap: None, energy_ratio: None, switches };
        }
        let exact = Exact::of(run.model().scene(), run.duration());
        let exact = exact.as_ref();
        Self {
            force_error: exact.and_then(|exact| force_error(run.scheme(), exact, history)),
            steady_relative_gap: exact.and_then(|exact| steady_gap(exact, history)),
            energy_ratio: energy_ratio(run, history),
            switches: history.switches,
        }
    }
}

fn force_error(scheme: &dyn Scheme, exact: &Exact, history: &History) -> Option<f64> {
    let expected = |t: f64| match scheme.facts().search {
        ContactSearch::StartOfStep => exact.force(t),
        ContactSearch::Predictor => exact.force_before(t),
    };
    let errors = history.time.iter().zip(history.forces(0)).map(|(t, force)| force - expected(*t));
    let mean = errors.map(|e| e * e).sum::<f64>() / history.time.len() as f64;
    let peak = exact.peak_force();
    (peak > 0.0).then(|| mean.sqrt() / peak)
}

fn steady_gap(exact: &Exact, history: &History) -> Option<f64> {
    let (start, end) = *exact.contact_intervals().first()?;
    let quarter = 0.25 * (end - start);
    let middle = start + quarter..=end - quarter;
    let rows = history.time.iter().zip(history.relative_gaps(0));
    let mut gaps: Vec<f64> = rows.filter(|(t, _)| middle.contains(t)).map(|(_, gap)| gap).collect();
    gaps.sort_unstable_by(f64::total_cmp);
    let half = gaps.len() / 2;
    match gaps.len() {
        0 => None,
        odd if odd % 2 == 1 => Some(gaps[half]),
        _ => Some(0.5 * (gaps[half - 1] + gaps[half])),
    }
}

fn energy_ratio(run: &Run, history: &History) -> Option<f64> {
    let available = potential_at_start(run);
    let [first, last] = history.first_and_last;
    let start = first.stored() + available;
    let end = last.stored() + available - (last.body_work - first.body_work);
    // Below, energies are subnormal and have lost their digits.
    (start >= f64::MIN_POSITIVE).then(|| end / start)
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
