//! Accelerations of the displacement a step before, weighted so that the damping is of second order.
//!
//! ```text
//! a' = M^-1 (f - K u)      u' = u + dt v + dt^2 ((1/2 - beta) a + beta a')      v' = v + dt (3/2 a' - a/2)
//! ```
//! With w = (omega dt)^2 the matrix of (u, dt v, dt^2 a) has p(z) = z^3 + (beta w - 2) z^2 + (1 - 2 (beta - 1) w) z + (beta - 1) w:
//!
//! ```text
//! p(1) = w      -p(-1) = 4 - (4 beta - 3) w      1 - a_0^2 - (a_1 - a_0 a_2) = (beta - 1) w^2
//! 1 - a_0^2 + (a_1 - a_0 a_2) = 2 - (2 beta - 1)(beta - 1) w^2
//! ```
//! so it is stable up to Omega = 2/sqrt(4 beta - 3), where the multiplier is -1: there a_0 = 4 (beta - 1)/(4 beta - 3) < 1 and
//! 8 (2 beta - 1)(beta - 1) <= (4 beta - 3)^2, for every beta >= 1. Up to beta = 28/27 the damping grows with omega dt.

use super::ExplicitFacts;
use super::generalised_alpha::newmark;

/// The explicit scheme of Chung and Lee with the parameter beta, which damps: beta = 1 does not. Below 1 it grows at every
/// step; above 28/27 its authors exclude it.
pub(super) static FACTS: ExplicitFacts = ExplicitFacts {
    name: "chung-lee",
    title: "Chung-Lee",
    parameter: "beta",
    usual: 28.0 / 27.0,
    allowed: (1.0, 28.0 / 27.0),
    evaluations: 1,
    order: 2,
    formula: "2/sqrt(4 beta - 3)",
    source: "Chung, Lee, Int. J. Numer. Meth. Eng. 37 (1994)",
    factor: |beta| 4.0 * beta - 3.0,
    states: 3,
    step,
};

fn step(beta: f64, w: f64, state: &[f64]) -> Vec<f64> {
    newmark(state, -w * state[0], beta, 1.5)
}
