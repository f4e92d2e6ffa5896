//! Central differences with reactions that are found with the step they act in: what four schemes share.
//!
//! ```text
//! (v_{n+1/2} - v_{n-1/2})/dt = M^-1 (f - K u_n - Z lambda_n)      u_{n+1} = u_n + dt v_{n+1/2}
//! 0 <= lambda_n   perpendicular to   y - t >= 0 in its negative:  the gap rate y = Z'v_{n+1/2} may not exceed t
//! ```
//! A [`Law`] says what t is. A contact may have a buffer, a mass m on a spring s with a coordinate q of its own, which
//! makes central differences beside the bodies and takes the reaction from the other side; gap and gap rate are then those
//! between body and buffer, g - q and Z'v - c. A contact that was closed by the step has the gap and the rate of its
//! buffer, which are kept instead of the sum over u: at s = 1e12 N/m no digit is lost.
//!
//! *Work.* The leapfrog energy of the bodies, H = v'Mv/2 + u_n'K u_{n+1}/2 less the work of f, and that of the buffers,
//! m c^2/2 + s q_n q_{n+1}/2, both at n + 1/2, change by
//!
//! ```text
//! -dt lambda_n (x + y)/2      x, y = gap rate before and after the step (relative to the buffer)
//! ```
//! in step n, contact by contact, whatever M. So a law gains nothing if y >= -x wherever lambda > 0.

use std::fmt::Debug;

use super::{Body, ContactRule, Energy, Motion, State, System};
use crate::error::Refusal;
use crate::schemes::complementarity::Complementarity;

/// Where a step leaves a contact that it closes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Landing {
    /// t, the largest gap rate that is allowed, m/s.
    pub rate: f64,
    /// The gap at the end of the step with this rate, m.
    pub gap: f64,
}

/// What a scheme allows a contact.
pub(super) trait Law: Debug + Send + Sync {
    /// The landing of a contact with this gap and gap rate before the step; `None` if the contact is not looked at.
    fn landing(&self, gap: f64, rate: f64, dt: f64) -> Option<Landing>;
}

/// A mass on a spring between the contact and the ground, or between two bodies.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Buffer {
    /// s, N/m.
    pub stiffness: f64,
    /// m, kg; infinite for a rigid stop.
    pub mass: f64,
    /// s/m, 1/s^2.
    pub rate: f64,
    position: f64,
    velocity: f64,
}

impl Buffer {
    /// What does not move.
    pub const RIGID: Self =
        Self { stiffness: 0.0, mass: f64::INFINITY, rate: 0.0, position: 0.0, velocity: 0.0 };

    /// A mass on a spring, at rest.
    pub fn new(stiffness: f64, mass: f64, rate: f64) -> Self {
        Self { stiffness, mass, rate, ..Self::RIGID }
    }

    /// Without a mass there is no buffer: a contact of no penalty.
    fn exists(&self) -> bool {
        self.mass > 0.0
    }

    fn acceleration(&self, lambda: f64) -> f64 {
        if self.exists() { lambda / self.mass - self.rate * self.position } else { 0.0 }
    }

    /// s q^2/2 + m c^2/2 with c at the time of q.
    fn energy(&self, lambda: f64, dt: f64) -> f64 {
        if self.stiffness == 0.0 {
            return 0.0;
        }
        let velocity = self.velocity + 0.5 * dt * self.acceleration(lambda);
        0.5 * (self.stiffness * self.position * self.position + self.mass * velocity * velocity)
    }
}

/// A motion by central differences under a law.
#[derive(Debug)]
pub(super) struct Steps<L> {
    law: L,
    body: Body,
    state: State,
    buffers: Vec<Buffer>,
    problem: Complementarity,
    /// The last dt a, m/s, and Z' of it without contact.
    kick: Vec<f64>,
    free_kick: Vec<f64>,
    landings: Vec<Landing>,
    /// Whether a contact is looked at in this step, and what its reaction has to achieve.
    counts: Vec<bool>,
    demand: Vec<f64>,
    synchronised: bool,
}

impl<L: Law> Steps<L> {
    /// v_{-1/2} = v_0 - dt/2 a_0 without the reactions of contacts that the first step closes.
    pub fn start(
        law: L,
        buffers: Vec<Buffer>,
        system: &System<'_>,
        u: Vec<f64>,
        v: Vec<f64>,
    ) -> Result<Self, Refusal> {
        let body = Body::new(system, system.time_step)?;
        let (n, k) = (u.len(), body.contacts.len());
        let state = State::new(&body.contacts, u, v, body.dt);
        let compliance: Vec<f64> = buffers.iter().map(|buffer| 1.0 / buffer.mass).collect();
        let problem = Complementarity::new(&body.contacts, 1.0, &compliance);
        let mut steps = Self {
            law,
            problem,
            buffers,
            kick: vec![0.0; n],
            free_kick: vec![0.0; k],
            landings: vec![Landing { rate: 0.0, gap: 0.0 }; k],
            counts: vec![false; k],
            demand: vec![0.0; k],
            synchronised: false,
            body,
            state,
        };
        steps.begin();
        Ok(steps)
    }

    /// Half a step back. A buffer that is pressed in at the start moves with its contact.
    fn begin(&mut self) {
        for j in 0..self.buffers.len() {
            let pressed = self.body.rule != ContactRule::HeldOpen && self.state.gap[j] > 0.0;
            self.counts[j] = pressed && self.buffers[j].stiffness > 0.0;
            self.state.closed[j] = self.counts[j] || self.body.rule == ContactRule::HeldClosed;
            if self.counts[j] {
                self.buffers[j].position = self.state.gap[j];
                self.buffers[j].velocity = self.state.gap_velocity[j];
            }
        }
        let Self { body: Body { operator, contacts, dt, .. }, state, kick, .. } = self;
        operator.apply(&state.displacement, kick);
        for (j, free) in self.free_kick.iter_mut().enumerate() {
            *free = contacts.across(j, kick);
            self.demand[j] = (*free + *dt * self.buffers[j].rate * self.buffers[j].position) / *dt;
        }
        self.problem.hold(&self.demand, &self.counts, &mut state.force);
        contacts.add_columns(-*dt, &state.force, kick);
        state.velocity.iter_mut().zip(kick).for_each(|(v, kick)| *v -= 0.5 * *kick);
        for (j, buffer) in self.buffers.iter_mut().enumerate() {
            let relief = contacts.mu_times(j, &state.force);
            if self.counts[j] {
                buffer.velocity -= 0.5 * *dt * buffer.acceleration(state.force[j]);
                state.gap_velocity[j] = buffer.velocity;
            } else {
                state.gap_velocity[j] -= 0.5 * (self.free_kick[j] - *dt * relief);
            }
            state.last_gap_change[j] = *dt * state.gap_velocity[j];
        }
        state.force.fill(0.0);
        self.accelerate();
        (self.state.contact_work, self.state.balance_work) = (0.0, 0.0);
    }

    /// lambda and dt a at the time of u.
    fn accelerate(&mut self) {
        let Self { body: Body { contacts, operator, dt, rule, .. }, state, kick, buffers, .. } = self;
        operator.apply(&state.displacement, kick);
        for (j, buffer) in buffers.iter().enumerate() {
            self.free_kick[j] = contacts.across(j, kick);
            let (gap, rate) = (state.gap[j] - buffer.position, state.gap_velocity[j] - buffer.velocity);
            let landing = self.law.landing(gap, rate, *dt).filter(|_| *rule != ContactRule::HeldOpen);
            self.counts[j] = landing.is_some() && buffer.exists();
            self.landings[j] = landing.unwrap_or(Landing { rate: 0.0, gap: 0.0 });
            let coming = rate + (self.free_kick[j] + *dt * buffer.rate * buffer.position);
            self.demand[j] = (coming - self.landings[j].rate) / *dt;
        }
        if *rule == ContactRule::HeldClosed {
            self.problem.hold(&self.demand, &self.counts, &mut state.force);
            state.closed.fill(true);
        } else {
            self.problem.push(&self.demand, &self.counts, &mut state.force);
            state.close_where_pressed();
        }
        for (force, change) in state.force.iter().zip(&state.last_gap_change) {
            state.contact_work += 0.5 * force * change;
        }
        contacts.add_columns(-*dt, &state.force, kick);
        self.synchronised = true;
    }

    /// Gaps, gap rates and buffers at the end of the step.
    fn advance(&mut self) {
        let Self { body: Body { contacts, dt, .. }, state, buffers, .. } = self;
        for (j, buffer) in buffers.iter_mut().enumerate() {
            let (before, lambda) = (state.gap[j], state.force[j]);
            let relief = contacts.mu_times(j, &state.force);
            buffer.velocity += *dt * buffer.acceleration(lambda);
            buffer.position += *dt * buffer.velocity;
            if state.closed[j] && self.counts[j] {
                state.gap_velocity[j] = buffer.velocity + self.landings[j].rate;
                state.gap[j] = buffer.position + self.landings[j].gap;
            } else {
                state.gap_velocity[j] += self.free_kick[j] - *dt * relief;
                state.gap[j] += *dt * state.gap_velocity[j];
                // The bodies are away, now and a step ago: whatever the buffer still has is dropped.
                if before <= 0.0 && state.gap[j] <= 0.0 {
                    (buffer.position, buffer.velocity) = (0.0, 0.0);
                }
            }
            let change = state.gap[j] - before;
            state.contact_work += 0.5 * lambda * change;
            state.balance_work += 0.5 * lambda * (change + state.last_gap_change[j]);
            state.last_gap_change[j] = change;
        }
    }
}

impl<L: Law> Motion for Steps<L> {
    fn step(&mut self) {
        self.synchronise();
        let State { velocity, displacement, .. } = &mut self.state;
        self.body.operator.drift(self.body.dt, &self.kick, velocity, displacement);
        self.advance();
        self.state.settle(&self.body.contacts);
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

    /// The balance is that of n - 1/2, the last step that is complete: v'Mv/2 at the time of u differs from it by the
    /// usual dt^2/8 a'Ma and by half the work of the present reaction.
    fn energy(&mut self) -> Energy {
        self.synchronise();
        let mut velocity = vec![0.0; self.kick.len()];
        self.velocity(&mut velocity);
        let Self { body, state, kick, buffers, .. } = self;
        let energy = body.energy(state, &velocity);
        let shadow = body.leapfrog_shadow(state, kick);
        let penalty =
            buffers.iter().zip(&state.force).map(|(buffer, force)| buffer.energy(*force, body.dt)).sum();
        Energy { penalty, loss: state.balance_work - penalty + shadow, ..energy }
    }
}
