//! The stabilised predictor-corrector scheme of the paper (4.4): contact is searched on the predicted displacement,
//! and the mass penalty divides the corrector only.
//!
//! ```text
//! a_pred = M^-1 (f - K u)    g_pred = Z'(u + dt v + dt^2 a_pred) + g0    (I + m mu) lambda = s g_pred
//! v += dt (a_pred - M^-1 Z lambda)        u += dt v
//! ```
//!
//! Contacts that act on each other may pull at g_pred > 0; unilateral ones then obey
//!
//! ```text
//! 0 <= lambda   perpendicular to   (1/s + a mu) lambda - g_pred >= 0        a = m/s
//! ```
//! which is the same wherever nothing pulls, and for contacts that act apart (a lumped mass, no node in two contacts).
//!
//! *Theorem: nothing is gained.* For dt^2 < a + 1/l_max(S mu), the lower bound of the limit, the leapfrog energy v'Mv/2 + u_{n-1}'K u_n/2 of
//! the bodies never exceeds its start, from g_0, g_{-1} <= 0: for any number of contacts, any mesh and mass matrix, any
//! sequence of openings. *Proof.* As g_pred = g_{n+1} + dt^2 mu lambda, the condition is 0 <= lambda perpendicular to
//! B lambda - g_{n+1} >= 0 with B = 1/s + (a - dt^2) mu, positive definite: lambda is a slope at g_{n+1} of the convex
//! f(g) = max over lambda >= 0 of g'lambda - lambda'B lambda/2, f >= 0, and f = 0 for g <= 0. So the work
//! lambda_n'(g_{n+1} - g_{n-1})/2 of a step is at least (f(g_{n+1}) - f(g_{n-1}))/2, and their sum telescopes to
//! (f(g_{n+1}) + f(g_n))/2 >= 0. QED. Without the condition contacts that pull do gain: up to twice the kinetic energy
//! in random rows of bars at r = 1/4, C = 0.99, gamma < 1.
//!
//! Energy: shadow = -dt/2 v'(K u - f), balance_work = sum lambda (g_{n+1} - g_{n-1})/2, and closed contacts store
//! lambda g/2: the mass penalty is no inertia but a reduced stiffness.

use crate::error::Refusal;
use crate::schemes::complementarity::Complementarity;
use crate::schemes::{Body, ContactRule, Contacts, Energy, Motion, State, System};

/// A motion by the predictor-corrector.
#[derive(Debug)]
pub(super) struct Steps {
    body: Body,
    state: State,
    /// dt a, m/s.
    kick: Vec<f64>,
    /// m - dt^2 s, kg, and where sums of gap and gap rate would cancel.
    relief: Vec<f64>,
    delicate: Vec<bool>,
    /// g at the start of the step, and the predicted Z'v at its end.
    before: Vec<f64>,
    predicted_velocity: Vec<f64>,
    /// Of unilateral contacts that act on each other, with those that have a penalty.
    problem: Option<(Complementarity, Vec<bool>)>,
}

impl Steps {
    /// With the reaction of the contacts that are closed at the start, as the scheme would have found it.
    pub(super) fn start(system: &System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Self, Refusal> {
        let body = Body::new(system, system.time_step)?;
        let (n, k) = (u.len(), body.contacts.len());
        let (relief, delicate) = body.relief();
        let state = State::new(&body.contacts, u, v, body.dt);
        let [before, predicted_velocity] = [vec![0.0; k], vec![0.0; k]];
        let kick = vec![0.0; n];
        let coupled = body.rule == ContactRule::Unilateral && !body.contacts.act_apart();
        let problem = coupled.then(|| problem(&body.contacts));
        let mut steps = Self { body, state, kick, relief, delicate, before, predicted_velocity, problem };
        steps.react();
        steps.state.switches = 0;
        Ok(steps)
    }

    fn react(&mut self) {
        let Self { body: Body { contacts, rule, .. }, state, .. } = self;
        if let Some((problem, count)) = &mut self.problem {
            problem.push(&state.gap, count, &mut state.force);
            state.close_where_pressed();
            return;
        }
        state.search(*rule);
        contacts.reactions(&state.closed, &state.gap, None, &mut state.force);
    }

    /// g and Z'v at the end of the step. With q = dt^2 s mu/(1 + m mu) a closed contact keeps (1 - q) g_pred, which
    /// for q near 1 must not be formed as a difference:
    /// s g = lambda + (m - dt^2 s) mu lambda (several contacts: component by component).
    fn correct_gaps(&mut self) {
        let Self { body: Body { contacts, dt, .. }, state, before, predicted_velocity, .. } = self;
        for j in 0..contacts.len() {
            let relief = contacts.mu_times(j, &state.force);
            let plain_velocity = predicted_velocity[j] - *dt * relief;
            if state.closed[j] && self.delicate[j] {
                state.gap[j] = (state.force[j] + self.relief[j] * relief) / contacts.terms[j].0;
                state.gap_velocity[j] = (state.gap[j] - before[j]) / *dt;
            } else {
                state.gap[j] = before[j] + *dt * plain_velocity;
                state.gap_velocity[j] = plain_velocity;
            }
            let change = state.gap[j] - before[j];
            state.contact_work += state.force[j] * change;
            state.balance_work += state.force[j] * 0.5 * (change + state.last_gap_change[j]);
            state.last_gap_change[j] = change;
        }
    }
}

/// (1/s + a mu) lambda - g_pred, and which contacts have an s.
fn problem(contacts: &Contacts) -> (Complementarity, Vec<bool>) {
    let own: Vec<f64> = contacts.terms.iter().map(|(s, _)| 1.0 / s).collect();
    let count = contacts.terms.iter().map(|(s, _)| *s > 0.0).collect();
    (Complementarity::new(contacts, contacts.inverse_rate(), &own), count)
}

impl Motion for Steps {
    fn step(&mut self) {
        let Self { body: Body { contacts, operator, dt, .. }, state, kick, .. } = self;
        let dt = *dt;
        operator.apply(&state.displacement, kick);
        for j in 0..contacts.len() {
            self.before[j] = state.gap[j];
            self.predicted_velocity[j] = state.gap_velocity[j] + contacts.across(j, kick);
            state.gap[j] += dt * self.predicted_velocity[j];
        }
        self.react();
        let Self { body: Body { contacts, operator, .. }, state, kick, .. } = self;
        contacts.add_columns(-dt, &state.force, kick);
        operator.drift(dt, kick, &mut state.velocity, &mut state.displacement);
        self.correct_gaps();
        self.state.settle(&self.body.contacts);
        self.state.steps += 1;
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn energy(&mut self) -> Energy {
        energy(&self.body, &self.state)
    }
}

/// The energies of a motion by the predictor-corrector, with the loss that its steps and contacts make.
pub(in crate::schemes) fn energy(body: &Body, state: &State) -> Energy {
    let energy = body.energy(state, &state.velocity);
    let pull = body.pencil.stiffness().strain(&state.velocity, &state.displacement);
    let shadow = -0.5 * body.dt * (pull - body.work(&state.velocity));
    let penalty = state.reduced_penalty_energy();
    Energy { penalty, loss: state.balance_work - penalty + shadow, ..energy }
}
