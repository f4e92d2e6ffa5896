//! Central differences whose contact mass pays for what it takes.
//!
//! The mass penalty of a closed contact is a body of its own here, a *buffer*: a mass m on a spring s with the coordinate
//! q, at rest at q = 0 until something hits it. It makes central differences beside the bodies; the reaction between both
//! is found with the step it acts in, so that the contact is closed and not opened at its end,
//!
//! ```text
//! M (v_{n+1/2} - v_{n-1/2}) = dt (f - K u_n - Z lambda_n)     m (c_{n+1/2} - c_{n-1/2}) = dt (lambda_n - s q_n)
//! 0 <= lambda_n   perpendicular to   d_{n+1} <= 0             d = Z'u + g0 - q
//! ```
//! While a contact stays closed, d = 0 and q is the gap: what moves is (M + M_p) a = f - K u - K_p u, digit for digit the
//! scheme of the paper (4.3), with its spectrum. It differs where the contact closes, since the mass joins at its own
//! velocity and not at the one it is hit with, and where it opens, as soon as the reaction would pull.
//!
//! # No energy is gained
//! *Theorem.* For dt < dt_c (contact-free) and dt^2 s <= 4 m, whatever the mesh, the mass matrix, the number of contacts and
//! the sequence in which they open and close, the sum of
//!
//! ```text
//! H = v_{n+1/2}'M v_{n+1/2}/2 + u_n'K u_{n+1}/2 - work of f      Q_j = m_j c_{n+1/2}^2/2 + s_j q_n q_{n+1}/2
//! ```
//! never grows, and each of its terms without f is positive; so H + sum Q is a norm of the motion that never grows.
//!
//! *Proof.* Multiply the first line by (v_{n+1/2} + v_{n-1/2})/2 and the second one by (c_{n+1/2} + c_{n-1/2})/2, and sum by
//! parts: H + sum Q changes in step n by -sum_j lambda_j (d_{j,n+1} - d_{j,n-1})/2. In each term lambda_j d_{j,n+1} = 0, lambda_j >= 0
//! and d_{j,n-1} <= 0, so that it is lambda_j d_{j,n-1}/2 <= 0. H is positive as u_n'K u_{n+1} = h'K h - dt^2 v'K v/4 with h the mean of
//! both, and Q_j likewise for 4 m >= dt^2 s. A buffer whose contact has been open for two steps (g_n, g_{n+1} <= 0) is put
//! back to rest: that drops its Q >= 0 and leaves d <= 0. A start that is penetrated by g0 > 0 begins with the buffer pressed
//! in, q = g0, which is energy put in. QED
//!
//! From rest (Q = 0) the bodies alone have gained nothing at any time. Nothing is assumed about G = Z'M^-1 Z, nor that the
//! contacts share one rate s/m.
//!
//! # The mass that the step needs
//! Where a step exceeds 2 sqrt(m/s), as for r = inf (m = 0), the buffer has m = dt^2 s/4 instead, the least with which the
//! theorem holds. So dt_c is the limit at *every* penalty, and at r = inf the contact is the trapezoidal rule: a spring
//! with the mass m = beta dt^2 s makes central differences into Newmark's scheme for the contact force alone,
//! lambda_n = s (beta g_{n+1} + (1 - 2 beta) g_n + beta g_{n-1}). That is what any mass penalty does, with
//! beta = 1/(4 r C^2).
//!
//! # What is lost
//! A landing takes two steps: one ends at d = 0, the next one at the velocity of the buffer. What the contact node loses
//! is its energy relative to the body, O(h) of the whole, as in any plastic impact of a node. An opening loses nothing until
//! the buffer is put to rest.

use super::impulses::{Buffer, Steps};
use super::{CentralDifference, Facts, Lagrange, Motion, Scheme, System};
use crate::error::Refusal;
use crate::pencil::{Penalty, Pencil};
use crate::spectrum::{Engine, Evidence, Step, StepLimit, Uncertified};

/// Central differences with buffers of the penalty mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Buffered;

impl Scheme for Buffered {
    fn facts(&self) -> Facts {
        Facts {
            name: "buffered",
            title: "central difference, buffered",
            gains_nothing: true,
            reaction: "(s q + m Z'M^-1 (f - K u))/(1 + m mu) while closed",
            closed_limit: "the larger one of 2/omega_max of (K, M) and of (K + K_p, M + M_p)",
            source: "this crate; forward increments after Carpenter, Taylor, Katona 1991",
            ..CentralDifference::FACTS
        }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        let Penalty { rate, .. } = system.penalty;
        // s/m is one number for the scene: at most 4/dt^2.
        let rate = rate.min(4.0 / (system.time_step * system.time_step));
        let buffer = |scale: f64| {
            let (stiffness, _) = system.penalty.of(scale);
            Buffer::new(stiffness, stiffness / rate, rate)
        };
        let buffers = system.pencil.gaps().iter().map(|gap| buffer(gap.scale)).collect();
        Ok(Box::new(Steps::start(Lagrange, buffers, &system, u, v)?))
    }

    fn limit<'a>(
        &self,
        _pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Ok(Box::new(Larger(spectrum)))
    }
}

/// The larger one of the steps with and without contact: with the mass max(m, dt^2 s/4) a closed contact is stable where
/// 4 M - dt^2 K + max(4 m - dt^2 s, 0) Z W Z' is positive. Beyond the contact-free step the mass grows with the step, and the
/// motion slowly where it is heavy: that step is given as a lower bound.
struct Larger<'a>(Box<dyn Engine + 'a>);

impl StepLimit for Larger<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Step, Uncertified> {
        let free = self.0.enclose(&Penalty::NONE, None)?;
        let closed = self.0.enclose(penalty, start)?;
        Ok(if closed.upper < free.lower { Step::proven(closed) } else { Step::at_least(free) })
    }

    /// The mass does not depend on the step where the closed contact stands more than the open one: l < l_free = f(0) needs
    /// l = f(s - l m) with s < l m (f as in `convex`).
    fn growth(&self, _penalty: &Penalty, step: &Step, excess: f64) -> Option<f64> {
        (step.evidence == Evidence::Proven).then(|| 2.0 * excess.acosh())
    }

    fn costs_nothing(&self, _penalty: &Penalty) -> bool {
        true
    }
}
