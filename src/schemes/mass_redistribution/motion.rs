//! One step: the contact nodes find their place, then the others make central differences.
//!
//! Energy: with the velocity (u_n - u_{n-1})/dt of a massless unknown the sums are those of `schemes::impulses`, without buffers.

use super::mass::{massless, redistributed};
use crate::error::Refusal;
use crate::schemes::{Body, ContactRule, Energy, Equilibrium, Motion, State, System};

/// A motion by mass redistribution.
#[derive(Debug)]
pub(super) struct Steps {
    /// With M'.
    body: Body,
    state: State,
    massless: Vec<usize>,
    equilibrium: Equilibrium,
    force: Vec<f64>,
    /// dt a, m/s; 0 at massless nodes.
    kick: Vec<f64>,
    synchronised: bool,
}

impl Steps {
    /// v_{-1/2} = v_0 - dt/2 a_0 inside.
    pub(super) fn start(system: &System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Self, Refusal> {
        let massless = massless(system.pencil);
        let pencil = redistributed(system.pencil, &massless)?;
        let equilibrium = Equilibrium::new(pencil.stiffness(), pencil.gaps(), &massless)?;
        let body = Body::new(&System { pencil: &pencil, ..system.clone() }, system.time_step)?;
        let state = State::new(&body.contacts, u, v, body.dt);
        let (kick, force) = (vec![0.0; pencil.size()], vec![0.0; pencil.gaps().len()]);
        let mut steps = Self { body, state, massless, equilibrium, force, kick, synchronised: false };
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

    /// Puts the massless unknowns where their forces balance, and finds the reactions.
    fn place(&mut self) {
        let Self { body: Body { rule, load, .. }, state, equilibrium, force, .. } = self;
        equilibrium.settle(load, *rule, &mut state.displacement, force, &mut state.gap);
        for (j, force) in force.iter().enumerate() {
            let closed = match rule {
                ContactRule::HeldClosed => true,
                ContactRule::HeldOpen => false,
                ContactRule::Unilateral => *force > 0.0,
            };
            state.switches += u64::from(closed != state.closed[j]);
            (state.closed[j], state.force[j]) = (closed, *force);
        }
    }

    fn accelerate(&mut self) {
        self.body.operator.apply(&self.state.displacement, &mut self.kick);
        self.massless.iter().for_each(|i| self.kick[*i] = 0.0);
        self.synchronised = true;
    }
}

impl Motion for Steps {
    fn step(&mut self) {
        self.synchronise();
        let Self { body: Body { operator, dt, .. }, state, massless, kick, .. } = self;
        let before: Vec<f64> = massless.iter().map(|i| state.displacement[*i]).collect();
        let gaps = state.gap.clone();
        let forces = state.force.clone();
        operator.drift(*dt, kick, &mut state.velocity, &mut state.displacement);
        self.place();
        let Self { body: Body { dt, .. }, state, massless, .. } = self;
        for (i, before) in massless.iter().zip(before) {
            state.velocity[*i] = (state.displacement[*i] - before) / *dt;
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
        self.massless.iter().for_each(|i| velocity[*i] = 0.0);
        let Self { body, state, kick, .. } = self;
        let shadow = body.leapfrog_shadow(state, kick);
        Energy { loss: state.balance_work + shadow, ..body.energy(state, &velocity) }
    }
}
