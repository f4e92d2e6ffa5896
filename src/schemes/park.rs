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

use super::{Park, State, Stepper};

/// The constants of the pullback.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pullback {
    /// dt_c, s.
    critical_step: f64,
    /// theta dt_c^2 b2, s^2; negative for dt < dt_c.
    weight: f64,
}

impl Pullback {
    pub(super) fn new(park: Park, dt: f64) -> Self {
        let Park { theta, critical_step } = park;
        let alpha = dt / critical_step;
        let b2 = alpha / 6.0 * (alpha - 1.0) * (alpha + 1.0);
        Self { critical_step, weight: theta * critical_step * critical_step * b2 }
    }
}

impl Stepper {
    /// a_0 with the reaction of the contacts that are closed at the start.
    pub(super) fn start_park(&mut self, state: &mut State) {
        self.accelerate_park(state);
        std::mem::swap(&mut state.rate, &mut self.scratch[0]);
        state.gap_rate.copy_from_slice(&self.contact_scratch[0]);
        state.synchronised = true;
    }

    /// a at the time of u into `scratch[0]`, Z'a into `contact_scratch[0]`, lambda into the state.
    fn accelerate_park(&mut self, state: &mut State) {
        self.operator.apply(&state.displacement, &mut self.scratch[0]);
        state.search(self.rule);
        self.contacts.reactions(&state.closed, &state.gap, None, &mut state.force);
        for (j, contact) in self.contacts.list.iter().enumerate() {
            let free = contact.across(&self.scratch[0]);
            self.contact_scratch[0][j] = free - self.contacts.mu_times(j, &state.force);
        }
        self.contacts.add_columns(-1.0, &state.force, &mut self.scratch[0]);
    }

    pub(super) fn step_park(&mut self, state: &mut State) {
        let (dt, Pullback { critical_step: far, weight }) = (self.dt, self.pullback);
        let [ahead, pulled] = &mut self.scratch;
        for (i, ahead) in ahead.iter_mut().enumerate() {
            *ahead = state.displacement[i] + far * (state.velocity[i] + 0.5 * far * state.rate[i]);
        }
        self.operator.apply(ahead, pulled);
        for (j, contact) in self.contacts.list.iter().enumerate() {
            let extra = weight * (contact.across(pulled) - state.gap_rate[j]);
            let change = dt * (state.gap_velocity[j] + 0.5 * dt * state.gap_rate[j]) + extra;
            state.gap[j] += change;
            state.balance_work += 0.5 * state.force[j] * change;
            state.last_gap_change[j] = change;
        }
        for (i, pulled) in pulled.iter_mut().enumerate() {
            *pulled = weight * (*pulled - state.rate[i]);
            state.displacement[i] += dt * (state.velocity[i] + 0.5 * dt * state.rate[i]) + *pulled;
        }
        self.accelerate_park(state);
        if self.account {
            state.pullback_loss += self.pullback_loss(&state.rate);
        }
        let new = &mut self.scratch[0];
        for (i, v) in state.velocity.iter_mut().enumerate() {
            *v += 0.5 * dt * (state.rate[i] + new[i]);
        }
        std::mem::swap(&mut state.rate, new);
        for (j, new) in self.contact_scratch[0].iter().enumerate() {
            state.gap_velocity[j] += 0.5 * dt * (state.gap_rate[j] + new);
            state.gap_rate[j] = *new;
            state.balance_work += 0.5 * state.force[j] * state.last_gap_change[j];
        }
        state.contact_work = state.balance_work;
        state.settle(&self.contacts);
    }

    /// e'M (a + a')/2 with the extra displacement e of the pullback in `scratch[1]`, a' in `scratch[0]`, J.
    fn pullback_loss(&self, old: &[f64]) -> f64 {
        let [new, extra] = &self.scratch;
        let sum = |i: usize| old[i] + new[i];
        let (diagonal, off) = (&self.mass.diagonal, &self.mass.off_diagonal);
        let own: f64 = (0..extra.len()).map(|i| diagonal[i] * extra[i] * sum(i)).sum();
        let cross = |i: usize| off[i] * (extra[i] * sum(i + 1) + extra[i + 1] * sum(i));
        0.5 * (own + (0..off.len()).map(cross).sum::<f64>())
    }
}
