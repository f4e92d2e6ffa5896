//! Force and gap beside the exact solution, taken at every step, whatever is recorded.

use super::{Exact, Run};
use crate::schemes::ContactSearch;

/// Gaps kept for their median: a window of more steps is sampled evenly.
const MOST_GAPS: u64 = 1 << 20;

/// How far a run is from the exact solution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Accuracy {
    /// rms of force minus exact force over all steps, over the peak exact force. Where the exact force jumps, central
    /// differences, whose force belongs to the step that begins, are compared with its later value, the other schemes with
    /// the earlier one.
    pub force_error: Option<f64>,
    /// Median of g/h over the middle half of the first exact contact interval: of all its steps, or of 2^20 to 2^19 of
    /// them at equal distances if there are more.
    pub steady_relative_gap: Option<f64>,
    /// The largest force over the largest exact one, minus 1.
    pub overshoot: Option<f64>,
    /// The total variation of the force over that of the exact one, both over the steps that were compared: 1 without
    /// oscillations.
    pub variation: Option<f64>,
}

/// What has been seen so far of a contact force, or of the resultant of several, beside the exact one.
#[derive(Debug, Clone)]
pub struct Comparison {
    exact: Exact,
    search: ContactSearch,
    squares: f64,
    steps: u64,
    /// The last force and the last exact one, N.
    last: [f64; 2],
    /// Their total variations, N.
    variations: [f64; 2],
    /// The largest force, N.
    largest: f64,
    /// The middle half of the first exact contact interval, s.
    middle: Option<(f64, f64)>,
    /// Every how many steps a gap of it is kept.
    stride: u64,
    length: f64,
    gaps: Vec<f64>,
}

impl Comparison {
    /// The comparison for `run`, whose first contact has elements of `length`; `None` without an exact solution.
    pub(super) fn of(run: &Run, length: f64) -> Option<Self> {
        let exact = Exact::of(run.model().scene(), run.duration())?;
        Some(Self::new(exact, run.scheme().facts().search, run.time_step(), length))
    }

    /// The comparison with `exact` of a scheme that looks for contact as `search` says, every `interval` (s), with gaps over
    /// `length` (m).
    pub fn new(exact: Exact, search: ContactSearch, interval: f64, length: f64) -> Self {
        let middle = exact.contact_intervals().first().map(|(start, end)| {
            let quarter = 0.25 * (end - start);
            (start + quarter, end - quarter)
        });
        let steps = middle.map_or(0, |(start, end)| ((end - start) / interval) as u64);
        let stride = steps / MOST_GAPS + 1;
        let (squares, largest) = (0.0, f64::NEG_INFINITY);
        let (last, variations, gaps) = ([0.0; 2], [0.0; 2], Vec::new());
        Self { exact, search, squares, steps: 0, last, variations, largest, middle, stride, length, gaps }
    }

    /// The exact force at `time`, N: where it jumps the value that the scheme is compared with.
    pub fn expected(&self, time: f64) -> f64 {
        match self.search {
            ContactSearch::StartOfStep => self.exact.force(time),
            ContactSearch::Predictor => self.exact.force_before(time),
        }
    }

    /// Takes the force (N) and the gap (m) at `time`.
    pub fn note(&mut self, time: f64, force: f64, gap: f64) {
        let now = [force, self.expected(time)];
        let error = force - now[1];
        self.squares += error * error;
        self.largest = self.largest.max(force);
        if self.steps > 0 {
            (0..2).for_each(|i| self.variations[i] += (now[i] - self.last[i]).abs());
        }
        self.last = now;
        let within = self.middle.is_some_and(|(start, end)| start <= time && time <= end);
        if within && self.steps.is_multiple_of(self.stride) {
            self.gaps.push(gap / self.length);
        }
        self.steps += 1;
    }

    /// What was found.
    pub fn finish(mut self) -> Accuracy {
        let peak = self.exact.peak_force();
        let rms = (self.squares / self.steps as f64).sqrt();
        let compared = peak > 0.0 && self.steps > 0;
        let [variation, exact] = self.variations;
        Accuracy {
            force_error: compared.then(|| rms / peak),
            steady_relative_gap: median(&mut self.gaps),
            overshoot: compared.then(|| self.largest / peak - 1.0),
            variation: (exact > 0.0).then(|| variation / exact),
        }
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
