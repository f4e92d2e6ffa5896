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
    /// The energy at the end; `None` where nothing moves at the start, and where the passage has blown up.
    pub fn kept(&self) -> Option<Kept> {
        let blown_up = matches!(self.ending, Ending::BlewUp { .. });
        if blown_up { None } else { Kept::of(self.energy, 0.0, self.steps) }
    }
}

/// The energy at the end of a run, beside that at its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kept {
    /// Kinetic, strain and penalty energy at the end, less the work of the load, over that at the start.
    pub ratio: f64,
    /// Whether `ratio` is above 1 by more than rounding.
    pub more: bool,
    /// Whether contact has added to the energy that the scheme keeps without it, by more than rounding.
    pub gained: bool,
}

impl Kept {
    /// Of the first and the last energies, with what the load can still give at the start, after this many steps. Each step
    /// rounds each of the sums of the balance, which the energies keep to 4 epsilon a step of the largest of them. `None`
    /// where there is nothing to divide by: below, energies are subnormal and have lost their digits.
    pub(super) fn of([first, last]: [Energy; 2], available: f64, steps: u64) -> Option<Self> {
        let work = last.body_work - first.body_work;
        let (start, end) = (first.stored() + available, last.stored() + available - work);
        let sizes = [start, available, work, last.stored(), last.loss];
        let largest = sizes.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let rounding = 4.0 * f64::EPSILON * (steps + 1) as f64 * largest;
        let gained = last.gained - first.gained > rounding;
        (start >= f64::MIN_POSITIVE).then(|| Self {
            ratio: end / start,
            more: end / start > 1.0 + rounding / start,
            gained,
        })
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
