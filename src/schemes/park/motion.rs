//! The stabilised Park scheme (Park, Lim, Huh 2012; Cho, Park, Huh 2013), with alpha = dt/dt_c:
//!
//! ```text
//! u_fs = u + dt_c v + dt_c^2/2 a      a_fs = M^-1 (f - K u_fs)
//! pullback     u_1 = u + alpha dt_c v + dt_c^2 (b1 a + b2 a_fs)
//! pushforward  u_2 = u + dt v + dt^2/2 a
//! u = theta u_1 + (1 - theta) u_2     b1 = alpha/6 (1 + 3 alpha - alpha^2)     b2 = alpha/6 (alpha^2 - 1)
//! ```
//! As b1 + b2 = alpha^2/2, u = u_2 + theta dt_c^2 b2 (a_fs - a), which is how it is computed. Then
//! a_pred = M^-1 (f - K u), the contact is searched on u, (I + m mu) lambda = s g, a' = a_pred - M^-1 Z lambda and
//! v += dt/2 (a + a').
//!
//! Energy: shadow = -dt^2/8 a'M a + sum e'M (a_n + a_{n+1})/2 with e = theta dt_c^2 b2 (a_fs - a), balance_work = sum
//! (lambda_n + lambda_{n+1})/2 dg, and closed contacts store lambda g/2: the mass penalty is no inertia but a reduced
//! stiffness.

use super::Park;
use crate::error::Refusal;
use crate::schemes::body::positive;
use crate::schemes::{Body, Energy, Motion, State, System};

/// A motion by the Park scheme.
#[derive(Debug)]
pub(super) struct Steps {
    body: Body,
    state: State,
    /// dt_c, s.
    critical_step: f64,
    /// theta dt_c^2 b2, s^2; negative for dt < dt_c.
    weight: f64,
    /// a, m/s^2, and Z'a.
    acceleration: Vec<f64>,
    gap_acceleration: Vec<f64>,
    /// a' at the end of the step, and Z'a'.
    next: Vec<f64>,
    next_gap: Vec<f64>,
    /// M^-1 (f - K u_fs), then the extra displacement of the pullback.
    pulled: Vec<f64>,
    /// Energy lost to the pullback, J, if it is wanted.
    pullback_loss: f64,
    account: bool,
}

impl Steps {
    /// With a_0 and the reaction of the contacts that are closed at the start.
    pub(super) fn start(
        scheme: Park,
        system: &System<'_>,
        u: Vec<f64>,
        v: Vec<f64>,
    ) -> Result<Self, Refusal> {
        let (dt, critical_step) = (system.time_step, system.critical_step);
        let body = Body::new(system, 1.0)?;
        positive("critical step of the Park scheme", critical_step)?;
        let (n, k) = (u.len(), body.contacts.len());
        let state = State::new(&body.contacts, u, v, dt);
        let alpha = dt / critical_step;
        let b2 = alpha / 6.0 * (alpha - 1.0) * (alpha + 1.0);
        let mut steps = Self {
            weight: scheme.theta * critical_step * critical_step * b2,
            critical_step,
            acceleration: vec![0.0; n],
            gap_acceleration: vec![0.0; k],
            next: vec![0.0; n],
            next_gap: vec![0.0; k],
            pulled: vec![0.0; n],
            pullback_loss: 0.0,
            account: system.account,
            body,
            state,
        };
        steps.accelerate();
        std::mem::swap(&mut steps.acceleration, &mut steps.next);
        steps.gap_acceleration.copy_from_slice(&steps.next_gap);
        steps.state.switches = 0;
        Ok(steps)
    }

    /// a' and Z'a' at the time of u, lambda into the state.
    fn accelerate(&mut self) {
        let Self { body: Body { contacts, operator, rule, .. }, state, next, .. } = self;
        operator.apply(&state.displacement, next);
        state.search(*rule);
        contacts.reactions(&state.closed, &state.gap, None, &mut state.force);
        for j in 0..contacts.len() {
            self.next_gap[j] = contacts.across(j, next) - contacts.mu_times(j, &state.force);
        }
        contacts.add_columns(-1.0, &state.force, next);
    }

    /// e'M (a + a')/2 with the extra displacement e of the pullback, J.
    fn lost_to_pullback(&self) -> f64 {
        let sum: Vec<f64> = self.acceleration.iter().zip(&self.next).map(|(old, new)| old + new).collect();
        0.5 * self.body.pencil.mass().quadratic(&self.pulled, &sum)
    }
}

impl Motion for Steps {
    fn step(&mut self) {
        let Self { body: Body { contacts, operator, dt, .. }, state, pulled, acceleration, .. } = self;
        let (dt, far, weight) = (*dt, self.critical_step, self.weight);
        for (i, ahead) in self.next.iter_mut().enumerate() {
            *ahead = state.displacement[i] + far * (state.velocity[i] + 0.5 * far * acceleration[i]);
        }
        operator.apply(&self.next, pulled);
        for j in 0..contacts.len() {
            let extra = weight * (contacts.across(j, pulled) - self.gap_acceleration[j]);
            let change = dt * (state.gap_velocity[j] + 0.5 * dt * self.gap_acceleration[j]) + extra;
            state.gap[j] += change;
            state.balance_work += 0.5 * state.force[j] * change;
            state.last_gap_change[j] = change;
        }
        for (i, pulled) in pulled.iter_mut().enumerate() {
            *pulled = weight * (*pulled - acceleration[i]);
            state.displacement[i] += dt * (state.velocity[i] + 0.5 * dt * acceleration[i]) + *pulled;
        }
        self.accelerate();
        if self.account {
            self.pullback_loss += self.lost_to_pullback();
        }
        let Self { state, acceleration, next, .. } = self;
        for (i, v) in state.velocity.iter_mut().enumerate() {
            *v += 0.5 * dt * (acceleration[i] + next[i]);
        }
        std::mem::swap(acceleration, next);
        for (j, new) in self.next_gap.iter().enumerate() {
            state.gap_velocity[j] += 0.5 * dt * (self.gap_acceleration[j] + new);
            self.gap_acceleration[j] = *new;
            state.balance_work += 0.5 * state.force[j] * state.last_gap_change[j];
        }
        state.contact_work = state.balance_work;
        state.settle(&self.body.contacts);
        state.steps += 1;
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn energy(&mut self) -> Energy {
        let Self { body, state, .. } = self;
        let energy = body.energy(state, &state.velocity);
        let square = body.pencil.mass().quadratic(&self.acceleration, &self.acceleration);
        let shadow = -0.125 * body.dt * body.dt * square + self.pullback_loss;
        let penalty = state.reduced_penalty_energy();
        Energy { penalty, loss: state.balance_work - penalty + shadow, ..energy }
    }
}
