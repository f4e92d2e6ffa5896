//! The displacement goes a part phi - 1 of dt^2 a further than its velocity.
//!
//! ```text
//! u' = u + dt v + phi dt^2 a      v' = v + dt a      a' = M^-1 (f - K u')
//! ```
//! With w = (omega dt)^2 the matrix of (u, dt v) has D = 1 - (phi - 1) w, 1 - T + D = w and 1 + T + D = 4 - (2 phi - 1) w: stable up
//! to Omega = 2/sqrt(2 phi - 1), where the multiplier is -1, as D >= -1 there: 2 (phi - 1) <= 2 phi - 1. That holds for every
//! phi >= 1; above phi = 2, where Omega is 1.15, nobody takes it.

use super::ExplicitFacts;

/// The explicit scheme of Tchamwa and Wielgosz with the parameter phi, which damps: phi = 1 does not. Below 1 it grows at
/// every step.
pub(super) static FACTS: ExplicitFacts = ExplicitFacts {
    name: "tchamwa-wielgosz",
    title: "Tchamwa-Wielgosz",
    parameter: "phi",
    usual: 1.033,
    allowed: (1.0, 2.0),
    evaluations: 1,
    order: 1,
    formula: "2/sqrt(2 phi - 1)",
    source: "Maheo, Grolleau, Rio, Comptes Rendus Mecanique 337 (2009)",
    factor: |phi| 2.0 * phi - 1.0,
    states: 2,
    step,
};

fn step(phi: f64, w: f64, state: &[f64]) -> Vec<f64> {
    let (u, v) = (state[0], state[1]);
    let a = -w * u;
    vec![u + v + phi * a, v + a]
}
