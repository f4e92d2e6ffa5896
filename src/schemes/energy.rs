//! The energies of a state, and the balance that each scheme keeps exactly.
//!
//! At the time of u, with lambda the reactions and W the work of the body forces f'(u - u_0):
//!
//! ```text
//! kinetic + strain + penalty + loss - W = constant
//! loss = balance_work - penalty + shadow
//! central differences:  shadow = -dt^2/8 a'M a             balance_work = sum (lambda_n + lambda_{n+1})/2 dg
//! predictor-corrector:  shadow = -dt/2 v'(K u - f)         balance_work = sum lambda (g_{n+1} - g_{n-1})/2
//! Park:                 shadow = -dt^2/8 a'M a + sum e'M (a_n + a_{n+1})/2        e = theta dt_c^2 b2 (a_fs - a)
//! ```
//! Each follows from the scheme by summation by parts; the loss is computed from accelerations and reactions, not as
//! what is left over. The penalty energy is s g^2/2 + m (Z'v)^2/2 for central differences and lambda g/2 for the other
//! two, in which the mass penalty is no inertia but a reduced stiffness.

use super::{Scheme, State, Stepper};
use crate::pencil::Tridiagonal;

/// The energies of a state, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// v'M v/2 at the time of u.
    pub kinetic: f64,
    /// u'K u/2.
    pub strain: f64,
    /// Stored in closed contacts.
    pub penalty: f64,
    /// Work that the bars have done on the contacts since the start: the integral of lambda dg.
    pub contact_work: f64,
    /// f'u, whose change is the work of the body forces.
    pub body_work: f64,
    /// Algorithmic loss; negative is a gain.
    pub loss: f64,
}

impl Energy {
    /// kinetic + strain + penalty: what a perfect scheme would only exchange with the body forces.
    pub fn stored(&self) -> f64 {
        self.kinetic + self.strain + self.penalty
    }

    /// kinetic + strain + penalty + loss - f'u, constant in every run.
    pub fn balance(&self) -> f64 {
        self.stored() + self.loss - self.body_work
    }
}

impl Stepper {
    /// The energies at the time of u; synchronises the state.
    pub fn energy(&mut self, state: &mut State) -> Energy {
        self.synchronise(state);
        let mut velocity = std::mem::take(&mut self.scratch[0]);
        self.nodal_velocity(state, &mut velocity);
        let kinetic = 0.5 * quadratic(&self.mass, &velocity, &velocity);
        let strain = 0.5 * strain_form(&self.stiffness, &state.displacement, &state.displacement);
        let body_work = dot(&self.load, &state.displacement);
        let dt = self.dt;
        let shadow = match self.scheme {
            Scheme::CentralDifference => -0.125 * quadratic(&self.mass, &state.rate, &state.rate),
            Scheme::PredictorCorrector => {
                let pull = strain_form(&self.stiffness, &velocity, &state.displacement);
                -0.5 * dt * (pull - dot(&self.load, &velocity))
            }
            Scheme::Park => {
                let square = quadratic(&self.mass, &state.rate, &state.rate);
                -0.125 * dt * dt * square + state.pullback_loss
            }
        };
        self.scratch[0] = velocity;
        let penalty = self.penalty_energy(state);
        let loss = state.balance_work - penalty + shadow;
        Energy { kinetic, strain, penalty, contact_work: state.contact_work, body_work, loss }
    }

    fn penalty_energy(&self, state: &State) -> f64 {
        let closed = self.contacts.list.iter().enumerate().filter(|(j, _)| state.closed[*j]);
        let stored = |(j, contact): (usize, &super::Contact)| match self.scheme {
            Scheme::CentralDifference => {
                let velocity = state.gap_velocity[j] + 0.5 * state.gap_rate[j];
                let (s, m) = (contact.penalty.stiffness, contact.penalty.mass);
                0.5 * (s * state.gap[j] * state.gap[j] + m * velocity * velocity)
            }
            Scheme::PredictorCorrector | Scheme::Park => 0.5 * state.force[j] * state.gap[j],
        };
        closed.map(stored).sum()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// x'A y.
pub(crate) fn quadratic(a: &Tridiagonal, x: &[f64], y: &[f64]) -> f64 {
    let own: f64 = (0..x.len()).map(|i| a.diagonal[i] * x[i] * y[i]).sum();
    let cross = |(i, off): (usize, &f64)| off * (x[i] * y[i + 1] + x[i + 1] * y[i]);
    own + a.off_diagonal.iter().enumerate().map(cross).sum::<f64>()
}

/// x'K y from differences, so that a rigid translation adds nothing.
pub(crate) fn strain_form(k: &Tridiagonal, x: &[f64], y: &[f64]) -> f64 {
    let spring = |(i, off): (usize, &f64)| -off * (x[i + 1] - x[i]) * (y[i + 1] - y[i]);
    let springs: f64 = k.off_diagonal.iter().enumerate().map(spring).sum();
    let ground = |i: usize| {
        let left = if i > 0 { k.off_diagonal[i - 1] } else { 0.0 };
        (k.diagonal[i] + left + k.off_diagonal.get(i).copied().unwrap_or(0.0)) * x[i] * y[i]
    };
    springs + (0..x.len()).map(ground).sum::<f64>()
}
