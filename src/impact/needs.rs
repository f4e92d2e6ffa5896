//! The memory that a run takes, known before its first step.

use super::{Recording, Run};
use crate::error::Refusal;
use crate::memory;
use crate::schemes::Energy;

/// Bytes of a node while a run goes on: K and M as assembled (32) and as kept by the stepper (32), the factors of a mass
/// matrix that is not lumped (16, and 16 of the columns of the contacts while they are found), load (8), the state (24), two scratch
/// vectors (16), the initial velocity (8), and half as much again for what is dropped meanwhile.
const BYTES_PER_NODE: u64 = 228;

impl Run {
    /// Bytes taken while the run goes on, beside its history.
    pub fn working_bytes(&self) -> u64 {
        let scene = self.model().scene();
        BYTES_PER_NODE * (scene.elements() + scene.bars().len()) as u64
    }

    /// Rows of the history: one every so many steps, the start and the end.
    pub fn rows(&self, recording: &Recording) -> u64 {
        self.steps() / recording.every.max(1) + 2
    }

    /// Bytes of the history: rows of time, forces, gaps and energies, and the stresses.
    pub fn history_bytes(&self, recording: &Recording) -> u64 {
        let stresses = (recording.stress_times.len() * self.model().scene().elements()) as u64;
        self.rows(recording) * self.row_bytes(recording) + 8 * stresses
    }

    /// Bytes of a row.
    pub fn row_bytes(&self, recording: &Recording) -> u64 {
        let energies = if recording.energies { size_of::<Energy>() } else { 0 };
        (8 + 16 * self.model().scales().len() + energies) as u64
    }

    /// Refuses a scene and a recording that the memory does not hold.
    pub(super) fn check_memory(&self, recording: &Recording) -> Result<(), Refusal> {
        let scene = self.model().scene();
        let (working, row) = (self.working_bytes(), self.row_bytes(recording));
        let elements = (&*format!("scene {}, elements", scene.name()), &*scene.elements().to_string());
        let stresses = 8 * (recording.stress_times.len() * scene.elements()) as u64;
        memory::require(elements, "matrices, states and stresses", working + stresses, |available| {
            format!("at most {} elements", available / (BYTES_PER_NODE + 8))
        })?;
        let every = ("steps between records", &*recording.every.to_string());
        let all = working + self.history_bytes(recording);
        memory::require(every, &format!("{} rows", self.rows(recording)), all, |available| {
            least_every(self.steps(), 1, row, available.saturating_sub(working + stresses))
        })
    }
}

/// The steps between records with which the rows of `runs` runs, `row_bytes` each, fit into `available` bytes, in words;
/// `steps` are those of all runs.
pub fn least_every(steps: u64, runs: u64, row_bytes: u64, available: u64) -> String {
    match (available / row_bytes.max(1)).saturating_sub(2 * runs) {
        0 => "fewer elements or fewer runs at once".to_owned(),
        rows => format!("at least {} steps", steps.div_ceil(rows)),
    }
}
