//! Central differences: (M + M_p) a = f - K u - K_p u, v_{n+1/2} = v_{n-1/2} + dt a, u_{n+1} = u_n + dt v_{n+1/2}.
//!
//! With q = dt^2 s mu/(1 + m mu) the contact brakes the gap rate w to (1 - q) w, and q = 1 - 1/(1 + m mu) at C = 1/2 with
//! r = 1: the sums w + dt Z'a and g + dt w would then lose what decides whether the contact opens. There
//!
//! ```text
//! (1 + m mu) w_{n+1/2} = w (1 + mu (m - dt^2 s)) + dt p - dt mu s g_{n-1}
//! g_{n+1} = dt w + (g (1 + mu (m - dt^2 s)) + dt^2 p)/(1 + m mu)                  w = w_{n-1/2}
//! ```
//! The three numbers g, w, g_{n-1} are then one more than needed. A rounding that sets them apart is multiplied by -q in
//! each step, so that these forms serve 1/2 < q <= 1 only; elsewhere the plain sums lose a digit at most, unless q exceeds
//! 1 by very little.

use super::{State, Stepper};
use crate::pencil::Gap;

impl Stepper {
    /// v_{-1/2} = v_0 - dt/2 a_0, so that the first mid-point velocity is v_0 + dt/2 a_0.
    pub(super) fn start_central_difference(&mut self, state: &mut State) {
        self.accelerate_central_difference(state);
        state.velocity.iter_mut().zip(&state.rate).for_each(|(v, kick)| *v -= 0.5 * kick);
        state.gap_velocity.iter_mut().zip(&state.gap_rate).for_each(|(v, kick)| *v -= 0.5 * kick);
        for (j, gap) in state.gap.iter().enumerate() {
            state.previous_gap[j] = gap - self.dt * state.gap_velocity[j];
        }
        (state.contact_work, state.balance_work) = (0.0, 0.0);
    }

    /// Force and dt a at the time of u, into the state.
    pub(super) fn accelerate_central_difference(&mut self, state: &mut State) {
        self.operator.apply(&state.displacement, &mut state.rate);
        for (kick, contact) in state.free_kick.iter_mut().zip(&self.contacts.list) {
            *kick = contact.across(&state.rate);
        }
        self.react(state);
        self.contacts.add_columns(-self.dt, &state.force, &mut state.rate);
        state.synchronised = true;
    }

    /// lambda and Z'(dt a) from the free kicks Z'(dt M^-1 (f - K u)).
    fn react(&mut self, state: &mut State) {
        state.search(self.rule);
        let (kick, p) = (&state.free_kick, &mut self.contact_scratch[0]);
        p.iter_mut().zip(kick.iter()).for_each(|(p, kick)| *p = kick / self.dt);
        self.contacts.reactions(&state.closed, &state.gap, Some(p), &mut state.force);
        // From here on p holds the pull of the closed contacts.
        for (j, contact) in self.contacts.list.iter().enumerate() {
            let pull = -self.dt * contact.penalty.stiffness * state.gap[j];
            p[j] = if state.closed[j] { pull } else { 0.0 };
        }
        state.gap_rate.copy_from_slice(kick);
        self.contacts.relax(&state.closed, p, &mut state.gap_rate);
        let halves =
            state.force.iter().zip(&state.last_gap_change).map(|(force, change)| 0.5 * force * change);
        state.contact_work += halves.sum::<f64>();
        state.balance_work = state.contact_work;
    }

    /// g and w after the kick, in the forms of the module head where a contact needs them.
    fn advance_gaps(&mut self, state: &mut State) {
        let dt = self.dt;
        let delicate = (0..state.gap.len()).any(|j| state.closed[j] && self.delicate[j]);
        if delicate {
            let (kick, y) = (&state.free_kick, &mut self.contact_scratch[0]);
            let [velocity, gap] = &mut self.gap_scratch;
            for j in 0..y.len() {
                let pull = -dt * self.contacts.list[j].penalty.stiffness * state.previous_gap[j];
                let both = self.relief[j] * state.gap_velocity[j] + pull;
                y[j] = if state.closed[j] { both } else { 0.0 };
                velocity[j] = state.gap_velocity[j] + kick[j];
            }
            self.contacts.relax(&state.closed, y, velocity);
            for j in 0..y.len() {
                y[j] = if state.closed[j] { self.relief[j] * state.gap[j] } else { 0.0 };
                gap[j] = state.gap[j] + dt * kick[j];
            }
            self.contacts.relax(&state.closed, y, gap);
        }
        for j in 0..state.gap.len() {
            state.previous_gap[j] = state.gap[j];
            if state.closed[j] && self.delicate[j] {
                state.gap[j] = dt * state.gap_velocity[j] + self.gap_scratch[1][j];
                state.gap_velocity[j] = self.gap_scratch[0][j];
            } else {
                state.gap_velocity[j] += state.gap_rate[j];
                state.gap[j] += dt * state.gap_velocity[j];
            }
            state.last_gap_change[j] = dt * state.gap_velocity[j];
            state.contact_work += 0.5 * state.force[j] * state.last_gap_change[j];
        }
        state.balance_work = state.contact_work;
    }

    pub(super) fn step_central_difference(&mut self, state: &mut State) {
        if state.synchronised || !self.operator.is_lumped() {
            if !state.synchronised {
                self.accelerate_central_difference(state);
            }
            self.operator.drift(self.dt, &state.rate, &mut state.velocity, &mut state.displacement);
        } else {
            self.fused_step(state);
        }
        self.advance_gaps(state);
        state.settle(&self.contacts);
        state.synchronised = false;
    }

    /// Lumped mass: the contact nodes first, then one pass over all nodes. The same bytes as the two passes of
    /// [`Stepper::accelerate_central_difference`] and a drift.
    fn fused_step(&mut self, state: &mut State) {
        for (j, contact) in self.contacts.list.iter().enumerate() {
            let rate = |node: usize| self.operator.rate_at(&state.displacement, node);
            state.free_kick[j] = match contact.gap {
                Gap::Wall { node } => contact.direction * rate(node),
                Gap::Pair { left } => rate(left) - rate(left + 1),
            };
        }
        self.react(state);
        let dt = self.dt;
        self.touched.clear();
        for (j, contact) in self.contacts.list.iter().enumerate() {
            for (node, _) in contact.column().into_iter().flatten() {
                let free = self.operator.rate_at(&state.displacement, node);
                let kick = free + -dt * state.force[j] * self.contacts.entry(j, node);
                let velocity = state.velocity[node] + kick;
                self.touched.push((node, state.displacement[node] + dt * velocity, velocity));
            }
        }
        let next = &mut self.scratch[0];
        self.operator.kick_drift(dt, &state.displacement, &mut state.velocity, next);
        std::mem::swap(&mut state.displacement, next);
        for (node, displacement, velocity) in &self.touched {
            (state.displacement[*node], state.velocity[*node]) = (*displacement, *velocity);
        }
    }
}
