//! What a run leaves behind: rows at the times that were asked for, and how it ended.

use super::Accuracy;
use crate::schemes::Energy;

/// What to record; nothing else is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// A row every so many steps, from step 0 on; the last step has one always. At least 1.
    pub every: u64,
    /// Whether rows have energies. The energies of the first and the last row are computed always.
    pub energies: bool,
    /// Whether force and gap of every step are compared with the exact solution, however sparse the rows are.
    pub compare: bool,
    /// Times at which the stress along the bars is taken, s; the nearest step is.
    pub stress_times: Vec<f64>,
}

impl Default for Recording {
    fn default() -> Self {
        Self { every: 1, energies: false, compare: true, stress_times: Vec::new() }
    }
}

/// The stress along the bars at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct StressField {
    /// The time of the step that is nearest to the one asked for, s.
    pub time: f64,
    /// Of every element from left to right, Pa, positive in tension.
    pub stress: Vec<f64>,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ending {
    /// At its duration.
    Finished,
    /// By the stop flag.
    Stopped {
        /// Steps done.
        step: u64,
        /// Time reached, s.
        time: f64,
    },
    /// A velocity became undefined or left all bounds.
    BlewUp {
        /// The step at which it was seen.
        step: u64,
        /// Its time, s.
        time: f64,
    },
}

/// The rows of a run, as columns.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Number of contacts k.
    pub contacts: usize,
    /// Time of every row, s.
    pub time: Vec<f64>,
    /// lambda, N, positive in compression: k values a row, row by row.
    pub force: Vec<f64>,
    /// g/h, dimensionless, positive in penetration: k values a row.
    pub relative_gap: Vec<f64>,
    /// One a row, or none if not asked for.
    pub energy: Vec<Energy>,
    /// One a stress time that the run has reached, in the order of time.
    pub stress: Vec<StressField>,
    /// How far from the exact solution; `None` if not asked for or if the scene has none.
    pub accuracy: Option<Accuracy>,
    /// Energies at the start and at the end.
    pub first_and_last: [Energy; 2],
    /// How often a contact has opened or closed.
    pub switches: u64,
    /// Steps done.
    pub steps: u64,
    /// How the run ended.
    pub ending: Ending,
}

impl History {
    /// lambda of `contact` row by row, N.
    pub fn forces(&self, contact: usize) -> impl Iterator<Item = f64> + '_ {
        self.force.iter().skip(contact).step_by(self.contacts.max(1)).copied()
    }

    /// g/h of `contact` row by row.
    pub fn relative_gaps(&self, contact: usize) -> impl Iterator<Item = f64> + '_ {
        self.relative_gap.iter().skip(contact).step_by(self.contacts.max(1)).copied()
    }

    /// The largest departure of the energy balance from its value at the start, J; the rows must have energies.
    pub fn imbalance(&self) -> f64 {
        let start = self.first_and_last[0].balance();
        self.energy.iter().map(|energy| (energy.balance() - start).abs()).fold(0.0, f64::max)
    }
}
