//! Force and gap beside the exact solution, taken at every step, whatever is recorded.

use super::{Exact, Run};
use crate::schemes::{ContactSearch, State};

/// Gaps kept for their median: a window of more steps is sampled evenly.
const MOST_GAPS: u64 = 1 << 20;

/// How far a run is from the exact solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// rms of force minus exact force over all steps, over the peak exact force. Where the exact force jumps, central
    /// differences, whose force belongs to the step that begins, are compared with its later value, the other schemes with
    /// the earlier one.
    pub force_error: Option<f64>,
    /// Median of g/h over the middle half of the first exact contact interval: of all its steps, or of 2^20 to 2^19 of
    /// them at equal distances if there are more.
    pub steady_relative_gap: Option<f64>,
}

/// What has been seen so far of the first contact.
pub(super) struct Comparison {
    exact: Exact,
    search: ContactSearch,
    squares: f64,
    steps: u64,
    /// The middle half of the first exact contact interval, s.
    middle: Option<(f64, f64)>,
    /// Every how many steps a gap of it is kept.
    stride: u64,
    length: f64,
    gaps: Vec<f64>,
}

impl Comparison {
    /// The comparison for `run`, whose first contact has elements of `length`; `None` without an exact solution.
    pub(super) fn new(run: &Run, length: f64) -> Option<Self> {
        let exact = Exact::of(run.model().scene(), run.duration())?;
        let middle = exact.contact_intervals().first().map(|(start, end)| {
            let quarter = 0.25 * (end - start);
            (start + quarter, end - quarter)
        });
        let steps = middle.map_or(0, |(start, end)| ((end - start) / run.time_step()) as u64);
        let search = run.scheme().facts().search;
        let stride = steps / MOST_GAPS + 1;
        Some(Self { exact, search, squares: 0.0, steps: 0, middle, stride, length, gaps: Vec::new() })
    }

    /// Takes the step at `time`; the state must be synchronised.
    pub(super) fn note(&mut self, time: f64, state: &State) {
        let expected = match self.search {
            ContactSearch::StartOfStep => self.exact.force(time),
            ContactSearch::Predictor => self.exact.force_before(time),
        };
        let error = state.force[0] - expected;
        self.squares += error * error;
        let within = self.middle.is_some_and(|(start, end)| start <= time && time <= end);
        if within && self.steps.is_multiple_of(self.stride) {
            self.gaps.push(state.gap[0] / self.length);
        }
        self.steps += 1;
    }

    /// What was found.
    pub(super) fn finish(mut self) -> Accuracy {
        let peak = self.exact.peak_force();
        let rms = (self.squares / self.steps as f64).sqrt();
        let force_error = (peak > 0.0 && self.steps > 0).then(|| rms / peak);
        Accuracy { force_error, steady_relative_gap: median(&mut self.gaps) }
    }
}

fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let half = values.len() / 2;
    match values.len() {
        0 => None,
        odd if odd % 2 == 1 => Some(values[half]),
        _ => Some(0.5 * (values[half - 1] + values[half])),
    }
}
