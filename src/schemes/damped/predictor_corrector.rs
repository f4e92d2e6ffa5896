//! v_pred = v + h M^-1 (f - K u - (A M + B K) v), g_pred = g + h Z'v_pred, (I + m mu) lambda = s (g_pred + c Z'v_pred),
//! v' = v_pred - h M^-1 Z lambda, u' = u + h v'.
//!
//! Energy: as for the predictor-corrector, shadow = -h/2 v'(K u - f), balance_work = sum lambda (g_{n+1} - g_{n-1})/2 with the
//! reactions lambda, dampers included; A M + B K take sum h/2 v_n'(A M + B K)(v_n + v_{n+1}).

use super::dampers::Dampers;
use crate::damping::Damping;
use crate::error::Refusal;
use crate::schemes::predictor_corrector::energy;
use crate::schemes::{Body, Energy, Motion, State, System};

/// A motion by the damped predictor-corrector.
#[derive(Debug)]
pub(super) struct Steps {
    dampers: Dampers,
    body: Body,
    state: State,
    /// h a, m/s.
    kick: Vec<f64>,
    /// Z'v_pred, and the g + c Z'v that a contact pushes back by.
    predicted: Vec<f64>,
    push: Vec<f64>,
    account: bool,
}

impl Steps {
    /// With the reaction of the contacts that are closed at the start.
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
            predicted: state.gap_velocity.clone(),
            push: vec![0.0; k],
            account: system.account,
            body,
            state,
        };
        steps.react();
        steps.state.switches = 0;
        Ok(steps)
    }

    /// lambda from the predicted gaps and their rates.
    fn react(&mut self) {
        let Self { body: Body { contacts, rule, .. }, state, push, .. } = self;
        state.search(*rule);
        for (j, push) in push.iter_mut().enumerate() {
            *push = state.gap[j] + self.dampers.contact() * self.predicted[j];
        }
        contacts.reactions(&state.closed, push, None, &mut state.force);
    }

    /// h/2 v'(A M + B K)(2 v + h a), J.
    fn lost_to_damping(&self) -> f64 {
        let v = &self.state.velocity;
        let sum: Vec<f64> = v.iter().zip(&self.kick).map(|(v, kick)| 2.0 * v + kick).collect();
        0.5 * self.body.dt * self.dampers.power(&self.body.pencil, v, &sum)
    }
}

impl Motion for Steps {
    fn step(&mut self) {
        self.dampers.kick(&self.body, &self.state, &mut self.kick);
        let Self { body: Body { contacts, dt, .. }, state, kick, predicted, .. } = self;
        for (j, predicted) in predicted.iter_mut().enumerate() {
            *predicted = state.gap_velocity[j] + contacts.across(j, kick);
            state.gap[j] += *dt * *predicted;
        }
        self.react();
        self.body.contacts.add_columns(-self.body.dt, &self.state.force, &mut self.kick);
        if self.account {
            self.dampers.dissipated += self.lost_to_damping();
        }
        let Self { body: Body { contacts, operator, dt, .. }, state, kick, predicted, .. } = self;
        operator.drift(*dt, kick, &mut state.velocity, &mut state.displacement);
        for (j, predicted) in predicted.iter().enumerate() {
            let back = *dt * contacts.mu_times(j, &state.force);
            state.gap[j] -= *dt * back;
            state.gap_velocity[j] = predicted - back;
            let change = *dt * state.gap_velocity[j];
            state.contact_work += state.force[j] * change;
            state.balance_work += state.force[j] * 0.5 * (change + state.last_gap_change[j]);
            state.last_gap_change[j] = change;
        }
        state.settle(contacts);
        state.steps += 1;
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn energy(&mut self) -> Energy {
        let energy = energy(&self.body, &self.state);
        Energy { loss: energy.loss + self.dampers.dissipated, ..energy }
    }
}
