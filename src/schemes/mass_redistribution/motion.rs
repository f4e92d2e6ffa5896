//! One step: the contact nodes find their place, then the others make central differences.
//!
//! Energy: with the velocity (u_n - u_{n-1})/dt of a massless node the sums are those of `schemes::impulses`, without buffers.

use super::mass::{Massless, massless, redistributed};
use crate::error::Refusal;
use crate::schemes::{Body, ContactRule, Energy, Motion, State, System};

/// A motion by mass redistribution.
#[derive(Debug)]
pub(super) struct Steps {
    /// With M'.
    body: Body,
    state: State,
    massless: Vec<Vec<Massless>>,
    /// dt a, m/s; 0 at massless nodes.
    kick: Vec<f64>,
    synchronised: bool,
}

impl Steps {
    /// v_{-1/2} = v_0 - dt/2 a_0 inside.
    pub(super) fn start(system: &System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Self, Refusal> {
        let massless = massless(system.pencil)?;
        let pencil = redistributed(system.pencil, &massless);
        let body = Body::new(&System { pencil: &pencil, ..system.clone() }, system.time_step)?;
        let state = State::new(&body.contacts, u, v, body.dt);
        let kick = vec![0.0; pencil.size()];
        let mut steps = Self { body, state, massless, kick, synchronised: false };
        steps.place();
        steps.state.switches = 0;
        steps.accelerate();
        let Self { state, kick, .. } = &mut steps;
        state.velocity.iter_mut().zip(kick).for_each(|(v, kick)| *v -= 0.5 * *kick);
        for j in 0..steps.massless.len() {
            steps.state.gap_velocity[j] = steps.body.contacts.across(j, &steps.state.velocity);
            steps.state.last_gap_change[j] = steps.body.dt * steps.state.gap_velocity[j];
        }
        Ok(steps)
    }

    /// Puts the massless nodes where their forces balance, and finds the reactions.
    fn place(&mut self) {
        let Self { body: Body { contacts, rule, load, .. }, state, massless, .. } = self;
        for (j, nodes) in massless.iter().enumerate() {
            let mut compliance = 0.0;
            for Massless { node, weight, stiffness, springs } in nodes {
                // In differences, where the row has no ground: a translation takes the node along exactly.
                let near = state.displacement[springs[0].0];
                let held: f64 = springs.iter().map(|(i, k)| k * (state.displacement[*i] - near)).sum();
                let ground = stiffness + springs.iter().map(|(_, k)| k).sum::<f64>();
                let force = load.get(*node).copied().unwrap_or(0.0) - held - ground * near;
                state.displacement[*node] = near + force / stiffness;
                compliance += weight * weight / stiffness;
            }
            let gap = contacts.across(j, &state.displacement) + contacts.initial(j);
            let closed = match rule {
                ContactRule::Unilateral => gap > 0.0,
                ContactRule::HeldClosed => true,
                ContactRule::HeldOpen => false,
            };
            state.switches += u64::from(closed != state.closed[j]);
            state.closed[j] = closed;
            (state.force[j], state.gap[j]) = if closed { (gap / compliance, 0.0) } else { (0.0, gap) };
            for Massless { node, weight, stiffness, .. } in nodes {
                state.displacement[*node] -= weight * state.force[j] / stiffness;
            }
        }
    }

    fn accelerate(&mut self) {
        self.body.operator.apply(&self.state.displacement, &mut self.kick);
        self.massless.iter().flatten().for_each(|at| self.kick[at.node] = 0.0);
        self.synchronised = true;
    }
}

impl Motion for Steps {
    fn step(&mut self) {
        self.synchronise();
        let Self { body: Body { operator, dt, .. }, state, massless, kick, .. } = self;
        let nodes = || massless.iter().flatten().map(|at| at.node);
        let before: Vec<f64> = nodes().map(|node| state.displacement[node]).collect();
        let gaps = state.gap.clone();
        let forces = state.force.clone();
        operator.drift(*dt, kick, &mut state.velocity, &mut state.displacement);
        self.place();
        let Self { body: Body { dt, .. }, state, massless, .. } = self;
        for (node, before) in massless.iter().flatten().map(|at| at.node).zip(before) {
            state.velocity[node] = (state.displacement[node] - before) / *dt;
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
        self.massless.iter().flatten().for_each(|at| velocity[at.node] = 0.0);
        let Self { body, state, kick, .. } = self;
        let shadow = body.leapfrog_shadow(state, kick);
        Energy { loss: state.balance_work + shadow, ..body.energy(state, &velocity) }
    }
}
