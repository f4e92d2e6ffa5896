//! Central differences: (M + M_p) a = f - K u - K_p u, v_{n+1/2} = v_{n-1/2} + dt a, u_{n+1} = u_n + dt v_{n+1/2}.

use super::{State, Stepper};
use crate::pencil::Gap;

impl Stepper {
    /// v_{-1/2} = v_0 - dt/2 a_0, so that the first mid-point velocity is v_0 + dt/2 a_0.
    pub(super) fn start_central_difference(&mut self, state: &mut State) {
        self.accelerate_central_difference(state);
        state.velocity.iter_mut().zip(&state.rate).for_each(|(v, kick)| *v -= 0.5 * kick);
        state.gap_velocity.iter_mut().zip(&state.gap_rate).for_each(|(v, kick)| *v -= 0.5 * kick);
        (state.contact_work, state.balance_work) = (0.0, 0.0);
    }

    /// Force and dt a at the time of u, into the state.
    pub(super) fn accelerate_central_difference(&mut self, state: &mut State) {
        self.operator.apply(&state.displacement, &mut state.rate);
        let kick = &mut self.contact_scratch[0];
        for (kick, contact) in kick.iter_mut().zip(&self.contacts.list) {
            *kick = contact.across(&state.rate);
        }
        self.react(state);
        self.contacts.add_columns(-self.dt, &state.force, &mut state.rate);
        state.synchronised = true;
    }

    /// lambda and Z'(dt a) from the free kicks Z'(dt M^-1 (f - K u)) in `contact_scratch[0]`.
    fn react(&mut self, state: &mut State) {
        state.search(self.rule);
        let [kick, p] = &mut self.contact_scratch;
        p.iter_mut().zip(kick.iter()).for_each(|(p, kick)| *p = kick / self.dt);
        self.contacts.reactions(&state.closed, &state.gap, Some(p), &mut state.force);
        self.contacts.gap_rates(&state.closed, &state.gap, kick, self.dt, &mut state.gap_rate);
        let half_work: f64 =
            state.force.iter().zip(&state.last_gap_change).map(|(force, change)| 0.5 * force * change).sum();
        state.contact_work += half_work;
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
        for (j, gap) in state.gap.iter_mut().enumerate() {
            state.gap_velocity[j] += state.gap_rate[j];
            state.last_gap_change[j] = self.dt * state.gap_velocity[j];
            *gap += state.last_gap_change[j];
            state.contact_work += 0.5 * state.force[j] * state.last_gap_change[j];
        }
        state.balance_work = state.contact_work;
        state.settle(&self.contacts);
        state.synchronised = false;
    }

    /// Lumped mass: the contact nodes first, then one pass over all nodes. The same bytes as the two passes of
    /// [`Stepper::accelerate_central_difference`] and a drift.
    fn fused_step(&mut self, state: &mut State) {
        for (j, contact) in self.contacts.list.iter().enumerate() {
            let rate = |node: usize| self.operator.rate_at(&state.displacement, node);
            self.contact_scratch[0][j] = match contact.gap {
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
