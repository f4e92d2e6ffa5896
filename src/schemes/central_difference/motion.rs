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
//! each step, of contacts that act on each other by a matrix of which each q is an entry only. So these forms serve
//! 1/2 < q <= 1 and a matrix that is at most 1 ([`Body::relief`]); elsewhere the plain sums lose a digit at most, unless q
//! exceeds 1 by very little.
//!
//! Energy: shadow = -dt^2/8 a'M a, balance_work = sum (lambda_n + lambda_{n+1})/2 dg, and closed contacts store
//! s g^2/2 + m (Z'v)^2/2.

use crate::error::Refusal;
use crate::schemes::{Body, Energy, Motion, State, System};

/// A motion by central differences.
#[derive(Debug)]
pub(super) struct Steps {
    body: Body,
    state: State,
    /// The last dt a, m/s.
    kick: Vec<f64>,
    /// Z' of it, and Z' of dt a without contact, m/s.
    gap_kick: Vec<f64>,
    free_kick: Vec<f64>,
    /// g one step ago, m.
    previous_gap: Vec<f64>,
    /// Whether force, kick and `closed` belong to the present displacement.
    synchronised: bool,
    /// m - dt^2 s, kg, and where sums of gap and gap rate would cancel.
    relief: Vec<f64>,
    delicate: Vec<bool>,
    next: Vec<f64>,
    pull: Vec<f64>,
    gap_scratch: [Vec<f64>; 2],
    /// u and v of contact nodes after the step: node, displacement, velocity.
    touched: Vec<(usize, f64, f64)>,
}

impl Steps {
    /// v_{-1/2} = v_0 - dt/2 a_0, so that the first mid-point velocity is v_0 + dt/2 a_0.
    pub(super) fn start(system: &System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Self, Refusal> {
        let body = Body::new(system, system.time_step)?;
        let (n, k) = (u.len(), body.contacts.len());
        let (relief, delicate) = body.relief();
        let state = State::new(&body.contacts, u, v, body.dt);
        let touched = (0..k).map(|j| body.contacts.column(j).len()).sum();
        let mut steps = Self {
            kick: vec![0.0; n],
            gap_kick: vec![0.0; k],
            free_kick: vec![0.0; k],
            previous_gap: vec![0.0; k],
            synchronised: false,
            next: vec![0.0; n],
            pull: vec![0.0; k],
            gap_scratch: [vec![0.0; k], vec![0.0; k]],
            touched: Vec::with_capacity(touched),
            body,
            state,
            relief,
            delicate,
        };
        steps.accelerate();
        let Self { state, body, kick, gap_kick, previous_gap, .. } = &mut steps;
        state.velocity.iter_mut().zip(kick).for_each(|(v, kick)| *v -= 0.5 * *kick);
        state.gap_velocity.iter_mut().zip(gap_kick).for_each(|(v, kick)| *v -= 0.5 * *kick);
        for (j, previous) in previous_gap.iter_mut().enumerate() {
            *previous = state.gap[j] - body.dt * state.gap_velocity[j];
        }
        (state.contact_work, state.balance_work, state.switches) = (0.0, 0.0, 0);
        Ok(steps)
    }

    /// Force and dt a at the time of u.
    fn accelerate(&mut self) {
        self.body.operator.apply(&self.state.displacement, &mut self.kick);
        for (j, kick) in self.free_kick.iter_mut().enumerate() {
            *kick = self.body.contacts.across(j, &self.kick);
        }
        self.react();
        self.body.contacts.add_columns(-self.body.dt, &self.state.force, &mut self.kick);
        self.synchronised = true;
    }

    /// lambda and Z'(dt a) from the free kicks Z'(dt M^-1 (f - K u)).
    fn react(&mut self) {
        let Self { body: Body { contacts, dt, rule, .. }, state, pull: p, .. } = self;
        state.search(*rule);
        p.iter_mut().zip(&self.free_kick).for_each(|(p, kick)| *p = kick / *dt);
        contacts.reactions(&state.closed, &state.gap, Some(p), &mut state.force);
        // From here on p holds the pull of the closed contacts.
        for (j, (s, _)) in contacts.terms.iter().enumerate() {
            let pull = -*dt * s * state.gap[j];
            p[j] = if state.closed[j] { pull } else { 0.0 };
        }
        self.gap_kick.copy_from_slice(&self.free_kick);
        contacts.relax(&state.closed, p, &mut self.gap_kick);
        state.contact_work += state.half_work();
        state.balance_work = state.contact_work;
    }

    /// g and w after the kick, in the forms of the module head where a contact needs them.
    fn advance_gaps(&mut self) {
        let Self { body: Body { contacts, dt, .. }, state, free_kick: kick, pull: y, .. } = self;
        let (dt, [velocity, gap]) = (*dt, &mut self.gap_scratch);
        let delicate = (0..state.gap.len()).any(|j| state.closed[j] && self.delicate[j]);
        if delicate {
            for j in 0..y.len() {
                let pull = -dt * contacts.terms[j].0 * self.previous_gap[j];
                let both = self.relief[j] * state.gap_velocity[j] + pull;
                y[j] = if state.closed[j] { both } else { 0.0 };
                velocity[j] = state.gap_velocity[j] + kick[j];
            }
            contacts.relax(&state.closed, y, velocity);
            for j in 0..y.len() {
                y[j] = if state.closed[j] { self.relief[j] * state.gap[j] } else { 0.0 };
                gap[j] = state.gap[j] + dt * kick[j];
            }
            contacts.relax(&state.closed, y, gap);
        }
        for j in 0..state.gap.len() {
            self.previous_gap[j] = state.gap[j];
            if state.closed[j] && self.delicate[j] {
                state.gap[j] = dt * state.gap_velocity[j] + gap[j];
                state.gap_velocity[j] = velocity[j];
            } else {
                state.gap_velocity[j] += self.gap_kick[j];
                state.gap[j] += dt * state.gap_velocity[j];
            }
            state.last_gap_change[j] = dt * state.gap_velocity[j];
            state.contact_work += 0.5 * state.force[j] * state.last_gap_change[j];
        }
        state.balance_work = state.contact_work;
    }

    /// Lumped mass, contacts at nodes of their own: the contact nodes first, then one pass over all nodes. The same bytes
    /// as the two passes of [`Self::accelerate`] and a drift.
    fn fused_step(&mut self) {
        let Self { body: Body { contacts, operator, dt, .. }, state, next, .. } = self;
        if contacts.is_empty() {
            operator.kick_drift(*dt, &mut state.displacement, &mut state.velocity, next);
            return;
        }
        for (j, kick) in self.free_kick.iter_mut().enumerate() {
            let rate = |(node, z): &(u32, f64)| z * operator.rate_at(&state.displacement, *node as usize);
            *kick = contacts.column(j).iter().map(rate).sum();
        }
        self.react();
        let Self { body: Body { contacts, operator, dt, .. }, state, touched, next, .. } = self;
        touched.clear();
        for j in 0..contacts.len() {
            for node in contacts.column(j).iter().map(|(node, _)| *node as usize) {
                let free = operator.rate_at(&state.displacement, node);
                let kick = free + -*dt * state.force[j] * contacts.entry(j, node);
                let velocity = state.velocity[node] + kick;
                touched.push((node, state.displacement[node] + *dt * velocity, velocity));
            }
        }
        operator.kick_drift(*dt, &mut state.displacement, &mut state.velocity, next);
        for (node, displacement, velocity) in touched {
            (state.displacement[*node], state.velocity[*node]) = (*displacement, *velocity);
        }
    }
}

impl Motion for Steps {
    fn step(&mut self) {
        if self.synchronised || !self.body.operator.is_lumped() || !self.body.contacts.are_disjoint() {
            self.synchronise();
            let State { velocity, displacement, .. } = &mut self.state;
            self.body.operator.drift(self.body.dt, &self.kick, velocity, displacement);
        } else {
            self.fused_step();
        }
        if !self.body.contacts.is_empty() {
            self.advance_gaps();
            self.state.settle(&self.body.contacts);
        }
        self.synchronised = false;
        self.state.steps += 1;
    }

    /// Central differences would find force and acceleration in the next step only; that step then uses what is found
    /// here.
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
        let mut velocity = std::mem::take(&mut self.next);
        self.velocity(&mut velocity);
        let energy = self.body.energy(&self.state, &velocity);
        self.next = velocity;
        let shadow = -0.125 * self.body.pencil.mass().quadratic(&self.kick, &self.kick);
        let penalty = self.state.penalty_energy(&self.body.contacts.terms, &self.gap_kick);
        Energy { penalty, loss: self.state.balance_work - penalty + shadow, ..energy }
    }
}
