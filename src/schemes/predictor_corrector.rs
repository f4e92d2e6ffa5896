//! The stabilised predictor-corrector scheme of the paper (4.4): contact is searched on the predicted displacement,
//! and the mass penalty divides the corrector only.
//!
//! ```text
//! a_pred = M^-1 (f - K u)    g_pred = Z'(u + dt v + dt^2 a_pred) + g0    (I + m mu) lambda = s g_pred
//! v += dt (a_pred - M^-1 Z lambda)        u += dt v
//! ```

use super::{State, Stepper};

impl Stepper {
    /// Reaction of the contacts that are closed at the start, as the scheme would have found it.
    pub(super) fn start_predictor_corrector(&mut self, state: &mut State) {
        state.search(self.rule);
        self.contacts.reactions(&state.closed, &state.gap, None, &mut state.force);
        state.synchronised = true;
    }

    pub(super) fn step_predictor_corrector(&mut self, state: &mut State) {
        let dt = self.dt;
        self.operator.apply(&state.displacement, &mut state.rate);
        let [before, predicted_velocity] = &mut self.contact_scratch;
        for (j, contact) in self.contacts.list.iter().enumerate() {
            before[j] = state.gap[j];
            predicted_velocity[j] = state.gap_velocity[j] + contact.across(&state.rate);
            state.gap[j] += dt * predicted_velocity[j];
        }
        state.search(self.rule);
        self.contacts.reactions(&state.closed, &state.gap, None, &mut state.force);
        self.contacts.add_columns(-dt, &state.force, &mut state.rate);
        self.operator.drift(dt, &state.rate, &mut state.velocity, &mut state.displacement);
        self.correct_gaps(state);
        state.settle(&self.contacts);
    }

    /// g and Z'v at the end of the step. With q = dt^2 s mu/(1 + m mu) a closed contact keeps (1 - q) g_pred, which
    /// for q near 1 must not be formed as a difference:
    /// s g = lambda + (m - dt^2 s) mu lambda (several contacts: component by component).
    fn correct_gaps(&mut self, state: &mut State) {
        let dt = self.dt;
        let [before, predicted_velocity] = &self.contact_scratch;
        for (j, contact) in self.contacts.list.iter().enumerate() {
            let relief = self.contacts.mu_times(j, &state.force);
            let plain_velocity = predicted_velocity[j] - dt * relief;
            if state.closed[j] && self.delicate[j] {
                state.gap[j] = (state.force[j] + self.relief[j] * relief) / contact.penalty.stiffness;
                state.gap_velocity[j] = (state.gap[j] - before[j]) / dt;
            } else {
                state.gap[j] = before[j] + dt * plain_velocity;
                state.gap_velocity[j] = plain_velocity;
            }
            let change = state.gap[j] - before[j];
            state.contact_work += state.force[j] * change;
            state.balance_work += state.force[j] * 0.5 * (change + state.last_gap_change[j]);
            state.last_gap_change[j] = change;
        }
    }
}

/// m - dt^2 s, formed with twice the digits of f64. m, dt and s carry a rounding each, dt^2 two, so that a result
/// below 4 units in the last place of m is not known from zero, the value of C = 1/2 with r = 1: it is taken as zero.
pub(super) fn difference(m: f64, dt: f64, s: f64) -> f64 {
    let product = |a: f64, b: f64| {
        let high = a * b;
        (high, a.mul_add(b, -high))
    };
    let (square, square_low) = product(dt, dt);
    let (high, low) = product(square, s);
    let exact = (m - high) - (low + square_low * s);
    if exact.abs() <= 4.0 * f64::EPSILON * m { 0.0 } else { exact }
}
