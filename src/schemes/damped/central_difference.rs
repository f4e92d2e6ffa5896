//! (M + M_p) a = f - K (u + B v) - A M v - Z s (g + c Z'v), v_{n+1/2} = v_{n-1/2} + h a, u_{n+1} = u_n + h v_{n+1/2}, v = v_{n-1/2}.
//!
//! Energy: as for central differences, shadow = -h^2/8 a'M a and balance_work = sum (lambda_n + lambda_{n+1})/2 dg with the
//! reactions lambda, dampers included; and what A M + B K take,
//!
//! ```text
//! sum h/2 (v_{n-1/2} + v_{n+1/2})'(A M + B K) v_{n+1/2}
//! ```
//! by the same summation by parts.

use super::dampers::Dampers;
use crate::damping::Damping;
use crate::error::Refusal;
use crate::schemes::{Body, Energy, Motion, State, System};

/// A motion by damped central differences.
#[derive(Debug)]
pub(super) struct Steps {
    dampers: Dampers,
    body: Body,
    state: State,
    /// The last h a, m/s, and Z' of it.
    kick: Vec<f64>,
    gap_kick: Vec<f64>,
    /// Whether force, kick and `closed` belong to the present displacement.
    synchronised: bool,
    account: bool,
    pull: Vec<f64>,
    push: Vec<f64>,
}

impl Steps {
    /// v_{-1/2} = v_0 - h/2 a_0, so that the first mid-point velocity is v_0 + h/2 a_0 but for the damping of the
    /// difference.
    pub(super) fn start(
        damping: Damping,
        system: &System<'_>,
        u: Vec<f64>,
        v: Vec<f64>,
    ) -> Result<Self, Refusal> {
        let body = Body::new(system, system.time_step)?;
        let (n, k) = (u.len(), body.contacts.len());
        let state = State::new(&body.contacts, u, v, body.dt);
        let mut steps = Self {
            dampers: Dampers::new(damping, n),
            kick: vec![0.0; n],
            gap_kick: vec![0.0; k],
            synchronised: false,
            account: system.account,
            pull: vec![0.0; k],
            push: vec![0.0; k],
            body,
            state,
        };
        steps.accelerate();
        let Self { state, kick, gap_kick, .. } = &mut steps;
        state.velocity.iter_mut().zip(kick).for_each(|(v, kick)| *v -= 0.5 * *kick);
        state.gap_velocity.iter_mut().zip(gap_kick).for_each(|(v, kick)| *v -= 0.5 * *kick);
        (state.contact_work, state.balance_work, state.switches) = (0.0, 0.0, 0);
        steps.synchronised = false;
        Ok(steps)
    }

    /// Reactions and h a at the time of u.
    fn accelerate(&mut self) {
        self.dampers.kick(&self.body, &self.state, &mut self.kick);
        let Self { body: Body { contacts, dt, rule, .. }, state, kick, .. } = self;
        state.search(*rule);
        for j in 0..contacts.len() {
            self.pull[j] = contacts.across(j, kick) / *dt;
            self.push[j] = state.gap[j] + self.dampers.contact() * state.gap_velocity[j];
        }
        contacts.reactions(&state.closed, &self.push, Some(&self.pull), &mut state.force);
        contacts.add_columns(-*dt, &state.force, kick);
        for (j, gap_kick) in self.gap_kick.iter_mut().enumerate() {
            *gap_kick = contacts.across(j, kick);
        }
        state.contact_work += state.half_work();
        state.balance_work = state.contact_work;
        self.synchronised = true;
    }

    /// h/2 (v + w)'(A M + B K) w with w = v + h a, J.
    fn lost_to_damping(&self) -> f64 {
        let v = &self.state.velocity;
        let next: Vec<f64> = v.iter().zip(&self.kick).map(|(v, kick)| v + kick).collect();
        let sum: Vec<f64> = v.iter().zip(&next).map(|(v, next)| v + next).collect();
        0.5 * self.body.dt * self.dampers.power(&self.body.pencil, &sum, &next)
    }
}

impl Motion for Steps {
    fn step(&mut self) {
        self.synchronise();
        if self.account {
            self.dampers.dissipated += self.lost_to_damping();
        }
        let Self { body: Body { contacts, operator, dt, .. }, state, .. } = self;
        operator.drift(*dt, &self.kick, &mut state.velocity, &mut state.displacement);
        for j in 0..state.gap.len() {
            state.gap_velocity[j] += self.gap_kick[j];
            let change = *dt * state.gap_velocity[j];
            state.gap[j] += change;
            state.last_gap_change[j] = change;
            state.contact_work += 0.5 * state.force[j] * change;
        }
        state.balance_work = state.contact_work;
        state.settle(contacts);
        self.synchronised = false;
        state.steps += 1;
    }

    /// The next step uses what is found here.
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
        let mut velocity = std::mem::take(self.dampers.scratch());
        self.velocity(&mut velocity);
        let energy = self.body.energy(&self.state, &velocity);
        *self.dampers.scratch() = velocity;
        let shadow = -0.125 * self.body.pencil.mass().quadratic(&self.kick, &self.kick);
        let penalty = self.state.penalty_energy(&self.body.contacts.terms, &self.gap_kick);
        Energy {
            penalty,
            loss: self.state.balance_work - penalty + shadow + self.dampers.dissipated,
            ..energy
        }
    }
}
