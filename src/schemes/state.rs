//! What every scheme keeps of a motion.

use super::Contacts;

/// Which contacts are closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactRule {
    /// Those with g > 0.
    #[default]
    Unilateral,
    /// All, in tension too: the linear system whose stability the maps show.
    HeldClosed,
    /// None.
    HeldOpen,
}

/// Displacements and velocities of n nodes, gaps of k contacts. The gaps and their rates are state of their own,
/// advanced by increments: where u is of size 1 and the penetration 1e-15, the difference of displacements has no digit
/// left.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Steps done since the start.
    pub steps: u64,
    /// u, m.
    pub displacement: Vec<f64>,
    /// v as the scheme stores it, m/s: central differences half a step before the time of u.
    pub velocity: Vec<f64>,
    /// g of every contact, m, positive in penetration; with the digits that u has lost.
    pub gap: Vec<f64>,
    /// Z'v, m/s, at the time of v.
    pub gap_velocity: Vec<f64>,
    /// g after the last step minus g before it, m.
    pub last_gap_change: Vec<f64>,
    /// lambda of every contact, N, positive in compression.
    pub force: Vec<f64>,
    /// Which contacts are closed.
    pub closed: Vec<bool>,
    /// Changes between open and closed since the start, all contacts together.
    pub switches: u64,
    /// Work that the bodies have done on the contacts, J.
    pub contact_work: f64,
    /// The same with the weights that the scheme's own energy balance uses, J: minus what the contacts have added to the
    /// energy that the scheme keeps without them.
    pub balance_work: f64,
}

impl State {
    /// The state at time 0 from u and v (n entries each), for steps of dt (s).
    pub fn new(contacts: &Contacts, displacement: Vec<f64>, velocity: Vec<f64>, dt: f64) -> Self {
        let k = contacts.len();
        let across = |x: &[f64]| (0..k).map(|j| contacts.across(j, x)).collect::<Vec<_>>();
        let mut gap = across(&displacement);
        gap.iter_mut().enumerate().for_each(|(j, gap)| *gap += contacts.initial(j));
        let gap_velocity = across(&velocity);
        Self {
            steps: 0,
            last_gap_change: gap_velocity.iter().map(|w| dt * w).collect(),
            displacement,
            velocity,
            gap,
            gap_velocity,
            force: vec![0.0; k],
            closed: vec![false; k],
            switches: 0,
            contact_work: 0.0,
            balance_work: 0.0,
        }
    }

    /// Notes which contacts are closed.
    pub fn search(&mut self, rule: ContactRule) {
        for (closed, gap) in self.closed.iter_mut().zip(&self.gap) {
            let now = match rule {
                ContactRule::Unilateral => *gap > 0.0,
                ContactRule::HeldClosed => true,
                ContactRule::HeldOpen => false,
            };
            self.switches += u64::from(now != *closed);
            *closed = now;
        }
    }

    /// Notes the contacts with a force as closed, and no other.
    pub(super) fn close_where_pressed(&mut self) {
        for (closed, force) in self.closed.iter_mut().zip(&self.force) {
            let now = *force > 0.0;
            self.switches += u64::from(now != *closed);
            *closed = now;
        }
    }

    /// Reads the gaps from u and v: simple, where the digits that u has lost are not needed.
    pub fn read_gaps(&mut self, contacts: &Contacts) {
        for j in 0..contacts.len() {
            let gap = contacts.across(j, &self.displacement) + contacts.initial(j);
            self.last_gap_change[j] = gap - std::mem::replace(&mut self.gap[j], gap);
            self.gap_velocity[j] = contacts.across(j, &self.velocity);
        }
    }

    /// Sets u and v of the contact nodes from the gaps, which have kept more digits.
    pub fn settle(&mut self, contacts: &Contacts) {
        for j in 0..contacts.len() {
            contacts.set_across(j, self.gap[j] - contacts.initial(j), &mut self.displacement);
            contacts.set_across(j, self.gap_velocity[j], &mut self.velocity);
        }
    }

    /// Half the work of the reactions over the step before, J.
    pub(super) fn half_work(&self) -> f64 {
        self.force.iter().zip(&self.last_gap_change).map(|(force, change)| 0.5 * force * change).sum()
    }

    /// s g^2/2 + m (Z'v)^2/2 of the closed contacts, J, with s and m by contacts and Z'v half of `gap_kick` after that of the
    /// state: what they store where the mass penalty is an inertia.
    pub(super) fn penalty_energy(&self, terms: &[(f64, f64)], gap_kick: &[f64]) -> f64 {
        let stored = |j: usize| {
            let velocity = self.gap_velocity[j] + 0.5 * gap_kick[j];
            let (s, m) = terms[j];
            0.5 * (s * self.gap[j] * self.gap[j] + m * velocity * velocity)
        };
        (0..self.gap.len()).filter(|j| self.closed[*j]).map(stored).sum()
    }

    /// lambda g/2 of the closed contacts, J: what they store where the mass penalty is no inertia but a reduced
    /// stiffness.
    pub(super) fn reduced_penalty_energy(&self) -> f64 {
        let closed = (0..self.gap.len()).filter(|j| self.closed[*j]);
        closed.map(|j| 0.5 * self.force[j] * self.gap[j]).sum()
    }
}
