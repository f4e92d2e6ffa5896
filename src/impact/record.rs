//! What the passage of an encounter leaves behind.

use super::Ending;
use crate::schemes::{Energy, Motion};

/// The rows of a passage, as columns; k contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// k.
    pub contacts: usize,
    /// Time of every row, s.
    pub time: Vec<f64>,
    /// lambda of every contact, N, positive in compression: k values a row, row by row.
    pub force: Vec<f64>,
    /// g of every contact, m, positive in penetration: k values a row.
    pub gap: Vec<f64>,
    /// The energies of every row.
    pub energy: Vec<Energy>,
    /// How often contacts have opened or closed.
    pub switches: u64,
    /// Steps done.
    pub steps: u64,
    /// How the passage ended.
    pub ending: Ending,
}

/// How a passage went, beside its rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Energies at the start and at the end.
    pub energy: [Energy; 2],
    /// How often contacts have opened or closed.
    pub switches: u64,
    /// Steps done.
    pub steps: u64,
    /// How it ended.
    pub ending: Ending,
}

impl Outcome {
    /// Kinetic, strain and penalty energy at the end, less the work of the load, over that at the start, and what rounding may
    /// make of it: each step rounds each of the sums of the balance, which the energies keep to 4 epsilon a step of the largest.
    /// `None` where nothing moves at the start, and where the passage has blown up.
    pub fn energy_ratio(&self) -> Option<(f64, f64)> {
        let [first, last] = self.energy;
        let (start, work) = (first.stored(), last.body_work - first.body_work);
        let largest =
            [start, work, last.stored(), last.loss].into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let rounding = 4.0 * f64::EPSILON * (self.steps + 1) as f64 * largest / start;
        let blown_up = matches!(self.ending, Ending::BlewUp { .. });
        (!blown_up && start >= f64::MIN_POSITIVE).then(|| ((last.stored() - work) / start, rounding))
    }
}

impl Record {
    pub(super) fn new(contacts: usize) -> Self {
        Self {
            contacts,
            time: Vec::new(),
            force: Vec::new(),
            gap: Vec::new(),
            energy: Vec::new(),
            switches: 0,
            steps: 0,
            ending: Ending::Finished,
        }
    }

    pub(super) fn note(&mut self, time: f64, motion: &mut dyn Motion) {
        motion.synchronise();
        self.time.push(time);
        self.force.extend_from_slice(&motion.state().force);
        self.gap.extend_from_slice(&motion.state().gap);
        self.energy.push(motion.energy());
    }

    /// How the passage went, which its first and its last row tell with it; `None` without a row.
    pub fn outcome(&self) -> Option<Outcome> {
        let energy = [*self.energy.first()?, *self.energy.last()?];
        Some(Outcome { energy, switches: self.switches, steps: self.steps, ending: self.ending })
    }

    /// lambda of one contact, row by row, N.
    pub fn forces(&self, contact: usize) -> impl Iterator<Item = f64> + '_ {
        self.force.iter().skip(contact).step_by(self.contacts.max(1)).copied()
    }

    /// g of one contact, row by row, m.
    pub fn gaps(&self, contact: usize) -> impl Iterator<Item = f64> + '_ {
        self.gap.iter().skip(contact).step_by(self.contacts.max(1)).copied()
    }

    /// The sum of the forces of all contacts, row by row, N: the force between two bodies or on a wall where all
    /// contacts have one direction.
    pub fn resultant(&self) -> Vec<f64> {
        (0..self.time.len())
            .map(|row| self.force[row * self.contacts..(row + 1) * self.contacts].iter().sum())
            .collect()
    }

    /// The largest distance of the energy balance from its start, J: rounding.
    pub fn imbalance(&self) -> f64 {
        let start = self.energy.first().map_or(0.0, Energy::balance);
        self.energy.iter().map(|energy| (energy.balance() - start).abs()).fold(0.0, f64::max)
    }

    /// The largest energy in any row, J: what rounding is measured by.
    pub fn largest_energy(&self) -> f64 {
        let size = |e: &Energy| {
            let parts = [e.kinetic, e.strain, e.penalty, e.loss, e.body_work];
            parts.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()))
        };
        self.energy.iter().map(size).fold(0.0, f64::max)
    }
}
