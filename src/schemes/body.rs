//! What a scheme is started with, and what every scheme makes of it.

use super::{ContactRule, Contacts, Energy, Operator, State};
use crate::error::Refusal;
use crate::pencil::{Penalty, Pencil};

/// What is to be stepped in time.
#[derive(Debug, Clone)]
pub struct System<'a> {
    /// K, M and the contacts.
    pub pencil: &'a Pencil,
    /// The penalty of closed contacts.
    pub penalty: Penalty,
    /// Nodal forces f, N; empty for none.
    pub load: Vec<f64>,
    /// dt, s.
    pub time_step: f64,
    /// The critical step 2/omega_max without contact, s, which a scheme may refer to.
    pub critical_step: f64,
    /// Which contacts are closed.
    pub rule: ContactRule,
    /// Whether losses that only a sum over all steps gives are summed up; the Park scheme has one.
    pub account: bool,
}

/// A system made ready to be stepped.
#[derive(Debug, Clone)]
pub struct Body {
    /// K, M and the contacts.
    pub pencil: Pencil,
    /// The columns M^-1 z and the reactions of the contacts.
    pub contacts: Contacts,
    /// u -> scale M^-1 (f - K u).
    pub operator: Operator,
    /// f, N; empty for none.
    pub load: Vec<f64>,
    /// dt, s.
    pub dt: f64,
    /// Which contacts are closed.
    pub rule: ContactRule,
    p: Vec<f64>,
}

impl Body {
    /// The body of `system`, with an operator of this scale: dt for velocity increments, 1 for accelerations.
    ///
    /// # Errors
    /// Refuses a step that is not positive and finite, and what [`Contacts::new`] and [`Operator::new`] refuse.
    pub fn new(system: &System<'_>, scale: f64) -> Result<Self, Refusal> {
        let System { pencil, penalty, load, time_step, .. } = system;
        positive("time step", *time_step)?;
        Ok(Self {
            contacts: Contacts::new(pencil, penalty)?,
            p: vec![0.0; pencil.gaps().len()],
            operator: Operator::new(pencil, load, scale)?,
            pencil: (*pencil).clone(),
            load: load.clone(),
            dt: *time_step,
            rule: system.rule,
        })
    }

    /// dt (M + M_p)^-1 (f - K u - K_p u) with the contacts that are closed at u, for an operator of scale dt: their
    /// reactions (s g + m Z'M^-1 (f - K u))/(1 + m mu) go into the state.
    pub fn kick(&mut self, state: &mut State, kick: &mut [f64]) {
        let Self { contacts, operator, dt, rule, p, .. } = self;
        state.search(*rule);
        operator.apply(&state.displacement, kick);
        p.iter_mut().enumerate().for_each(|(j, p)| *p = contacts.across(j, kick) / *dt);
        contacts.reactions(&state.closed, &state.gap, Some(p), &mut state.force);
        contacts.add_columns(-*dt, &state.force, kick);
    }

    /// The energies of `state` that need no scheme, with `velocity` at the time of u: penalty and loss are 0.
    pub fn energy(&self, state: &State, velocity: &[f64]) -> Energy {
        let u = &state.displacement;
        Energy {
            kinetic: 0.5 * self.pencil.mass().quadratic(velocity, velocity),
            strain: 0.5 * self.pencil.stiffness().strain(u, u),
            penalty: 0.0,
            contact_work: state.contact_work,
            body_work: self.work(u),
            gained: -state.balance_work,
            loss: 0.0,
        }
    }

    /// v at the time of u from the velocity half a step before and dt a = `kick`.
    pub(super) fn velocity(&self, state: &State, kick: &[f64], velocity: &mut [f64]) {
        velocity.copy_from_slice(&state.velocity);
        velocity.iter_mut().zip(kick).for_each(|(v, kick)| *v += 0.5 * kick);
    }

    /// What the leapfrog energy of n - 1/2 has beyond kinetic and strain energy at n, J: -dt^2/8 a'M a, and half the work of
    /// the present reactions over the step before.
    pub(super) fn leapfrog_shadow(&self, state: &State, kick: &[f64]) -> f64 {
        state.half_work() - 0.125 * self.pencil.mass().quadratic(kick, kick)
    }

    /// f'x.
    pub(super) fn work(&self, x: &[f64]) -> f64 {
        self.load.iter().zip(x).map(|(f, x)| f * x).sum()
    }

    /// m - dt^2 s of each contact, kg, and where sums of gap and gap rate would cancel: 1/2 < q <= 1, q = dt^2 s mu/(1 + m mu).
    ///
    /// Of contacts that act on each other the matrix Q = dt^2 (1 + a mu S)^-1 mu S must not exceed 1 either, as a rounding
    /// is multiplied by -Q in each step where three numbers are kept. With N = S^1/2 mu S^1/2 the part of Q for some
    /// contacts is no larger than what their part of N gives (x/(1 + a x) is operator concave and 0 at 0), and that is at
    /// most 1 if (dt^2 - a) N is. So it is if (dt^2 - a) s_j sum_i |mu_ji| <= 1 in each row (Gershgorin).
    pub(super) fn relief(&self) -> (Vec<f64>, Vec<bool>) {
        let contacts = &self.contacts;
        let relief = |(s, m): &(f64, f64)| difference(*m, self.dt, *s);
        let relief: Vec<f64> = contacts.terms.iter().map(relief).collect();
        let delicate = |(j, (_, m)): (usize, &(f64, f64))| {
            let mu = contacts.compliance(j);
            let kept = (1.0 + mu * relief[j]) / (1.0 + mu * m);
            (0.0..0.5).contains(&kept) && -relief[j] * contacts.compliance_sum(j) <= 1.0
        };
        let delicate = contacts.terms.iter().enumerate().map(delicate).collect();
        (relief, delicate)
    }
}

/// Refuses a time that is not positive and finite.
pub(super) fn positive(place: &str, value: f64) -> Result<(), Refusal> {
    let held = value > 0.0 && value.is_finite();
    held.then_some(()).ok_or_else(|| Refusal::new(place, value, "a positive finite number (s)"))
}

/// m - dt^2 s, formed with twice the digits of f64. m, dt and s carry a rounding each, dt^2 two, so that a result
/// below 4 units in the last place of m is not known from zero, the value of C = 1/2 with r = 1: it is taken as zero.
fn difference(m: f64, dt: f64, s: f64) -> f64 {
    let product = |a: f64, b: f64| {
        let high = a * b;
        (high, a.mul_add(b, -high))
    };
    let (square, square_low) = product(dt, dt);
    let (high, low) = product(square, s);
    let exact = (m - high) - (low + square_low * s);
    if exact.abs() <= 4.0 * f64::EPSILON * m { 0.0 } else { exact }
}
