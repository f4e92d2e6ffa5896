//! One step: the contact nodes find their place, then the others make central differences.
//!
//! Energy: with the velocity (u_n - u_{n-1})/dt of a massless node the sums are those of `schemes::impulses`, without buffers.

use super::mass::{heirs, redistributed};
use crate::error::Refusal;
use crate::pencil::Matrix;
use crate::schemes::flexible::Flexible;
use crate::schemes::{Body, ContactRule, Energy, Motion, State, System};

/// A motion by mass redistribution.
#[derive(Debug)]
pub(super) struct Steps {
    /// With M'.
    body: Body,
    state: State,
    /// The massless unknowns, the part of their rows of K that is not in balance, N/m, and K_cc.
    massless: Vec<u32>,
    ground: Vec<f64>,
    flexible: Flexible,
    /// Where they move to.
    shift: Vec<f64>,
    free_gap: Vec<f64>,
    /// dt a, m/s; 0 at massless unknowns.
    kick: Vec<f64>,
    synchronised: bool,
}

impl Steps {
    /// v_{-1/2} = v_0 - dt/2 a_0 inside.
    pub(super) fn start(system: &System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Self, Refusal> {
        let heirs = heirs(system.pencil)?;
        let pencil = redistributed(system.pencil, &heirs)?;
        let massless: Vec<u32> = heirs.0.iter().map(|(unknown, _)| *unknown).collect();
        let flexible = Flexible::new(&pencil, &massless, None)?;
        let body = Body::new(&System { pencil: &pencil, ..system.clone() }, system.time_step)?;
        let state = State::new(&body.contacts, u, v, body.dt);
        let ground = massless.iter().map(|i| unbalanced(pencil.stiffness(), *i as usize)).collect();
        let (shift, free_gap) = (vec![0.0; massless.len()], vec![0.0; state.gap.len()]);
        let kick = vec![0.0; pencil.size()];
        let mut steps =
            Self { body, state, massless, ground, flexible, shift, free_gap, kick, synchronised: false };
        steps.place();
        steps.state.switches = 0;
        steps.accelerate();
        let Self { state, kick, .. } = &mut steps;
        state.velocity.iter_mut().zip(kick).for_each(|(v, kick)| *v -= 0.5 * *kick);
        for j in 0..steps.state.gap.len() {
            steps.state.gap_velocity[j] = steps.body.contacts.across(j, &steps.state.velocity);
            steps.state.last_gap_change[j] = steps.body.dt * steps.state.gap_velocity[j];
        }
        Ok(steps)
    }

    /// Puts the massless nodes where their forces balance, and finds the reactions.
    fn place(&mut self) {
        let Self { body: Body { pencil, contacts, rule, load, .. }, state, massless, ground, .. } = self;
        let u = &mut state.displacement;
        for ((x, i), ground) in self.shift.iter_mut().zip(&*massless).zip(ground) {
            let i = *i as usize;
            // In differences: a translation along the row takes the node along exactly.
            let pull: f64 = pencil.stiffness().row(i).map(|(j, k)| k * (u[j] - u[i])).sum();
            *x = load.get(i).copied().unwrap_or(0.0) - pull - *ground * u[i];
        }
        self.flexible.apply(&mut self.shift);
        for (j, gap) in self.free_gap.iter_mut().enumerate() {
            *gap = contacts.across(j, u) + self.flexible.across(j, &self.shift) + contacts.initial(j);
        }
        self.flexible.react(*rule, &self.free_gap, &mut state.force, &mut self.shift);
        massless.iter().zip(&self.shift).for_each(|(i, x)| u[*i as usize] += x);
        for j in 0..self.free_gap.len() {
            let closed = match rule {
                ContactRule::Unilateral => state.force[j] > 0.0,
                ContactRule::HeldClosed => true,
                ContactRule::HeldOpen => false,
            };
            state.switches += u64::from(closed != state.closed[j]);
            state.closed[j] = closed;
            let gap = contacts.across(j, u) + contacts.initial(j);
            state.gap[j] = if closed { 0.0 } else { gap };
        }
    }

    fn accelerate(&mut self) {
        self.body.operator.apply(&self.state.displacement, &mut self.kick);
        self.massless.iter().for_each(|i| self.kick[*i as usize] = 0.0);
        self.synchronised = true;
    }
}

/// sum_j K_ij, 0 where it is rounding: each entry of an assembled row carries some.
fn unbalanced(k: &Matrix, i: usize) -> f64 {
    let (mut sum, mut size, mut terms) = (0.0, 0.0, 0);
    for (_, k) in k.row(i) {
        sum += k;
        size += k.abs();
        terms += 1;
    }
    if sum.abs() <= 4.0 * f64::EPSILON * f64::from(terms) * size { 0.0 } else { sum }
}

impl Motion for Steps {
    fn step(&mut self) {
        self.synchronise();
        let Self { body: Body { operator, dt, .. }, state, massless, kick, .. } = self;
        let before: Vec<f64> = massless.iter().map(|i| state.displacement[*i as usize]).collect();
        let gaps = state.gap.clone();
        let forces = state.force.clone();
        operator.drift(*dt, kick, &mut state.velocity, &mut state.displacement);
        self.place();
        let Self { body: Body { dt, .. }, state, massless, .. } = self;
        for (i, before) in massless.iter().map(|i| *i as usize).zip(before) {
            state.velocity[i] = (state.displacement[i] - before) / *dt;
        }
        for (j, before) in gaps.iter().enumerate() {
            let change = state.gap[j] - before;
            state.contact_work += 0.5 * (forces[j] + state.force[j]) * change;
            state.balance_work += 0.5 * forces[j] * (change + state.last_gap_change[j]);
            state.gap_velocity[j] = change / *dt;
            state.last_gap_change[j] = change;
        }
        self.synchronised = false;
        self.state.steps += 1;
    }

    fn synchronise(&mut self) {
        if !self.synchronised {
            self.accelerate();
        }
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn velocity(&self, velocity: &mut [f64]) {
        self.body.velocity(&self.state, &self.kick, velocity);
    }

    fn energy(&mut self) -> Energy {
        self.synchronise();
        let mut velocity = vec![0.0; self.kick.len()];
        self.velocity(&mut velocity);
        self.massless.iter().for_each(|i| velocity[*i as usize] = 0.0);
        let Self { body, state, kick, .. } = self;
        let shadow = body.leapfrog_shadow(state, kick);
        Energy { loss: state.balance_work + shadow, ..body.energy(state, &velocity) }
    }
}
