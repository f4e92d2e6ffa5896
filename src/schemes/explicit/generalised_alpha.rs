//! Equilibrium between two accelerations, with the force at the start of the step.
//!
//! ```text
//! M ((1 - alpha) a' + alpha a) = f - K u
//! u' = u + dt v + dt^2 ((1/2 - beta) a + beta a')      v' = v + dt ((1 - gamma) a + gamma a')
//! alpha = (2 rho - 1)/(1 + rho)      beta = (5 - 3 rho)/((1 + rho)^2 (2 - rho))      gamma = 3/2 - alpha
//! ```
//! rho in [0, 1] is the modulus of the multipliers where they become real. With w = (omega dt)^2, the matrix of
//! (u, dt v, dt^2 a) and d = (2 - rho)^2 (1 + rho)
//!
//! ```text
//! p(1) = w (1 + rho)/(2 - rho)
//! -p(-1) d = (1 - rho) (12 (2 - rho)(1 + rho) - w (rho^2 - 5 rho + 10))
//! (1 - a_0) d = (1 - rho) (3 (2 - rho)(1 + rho) - w (1 - rho)^2)
//! (1 + a_0) d = w (1 - rho)^3 + (2 - rho)(1 + rho)^2
//! (1 - a_0^2 - (a_1 - a_0 a_2)) d = w^2 (1 - rho)^3
//! (1 - a_0^2 + (a_1 - a_0 a_2)) d^2 = (1 - rho) q(w)
//! q(w) = 6 (2 - rho)^2 (1 + rho)^3 + 4 (rho - 2)(rho - 1)^2 (rho + 1)(2 rho - 1) w - (1 - rho)^2 (6 - 6 rho + 3 rho^2 - rho^3) w^2
//! ```
//! It is stable up to Omega^2 = 12 (2 - rho)(1 + rho)/(rho^2 - 5 rho + 10), where the multiplier is -1: there 1 - a_0 >= 0 says
//! (rho - 2)(rho + 1) <= 0, and q, which is concave in w, is positive at both ends, at Omega it is
//! 54 (2 - rho)^4 (1 + rho)^5/(rho^2 - 5 rho + 10)^2. At rho = 1 these are central differences and a multiplier -1 that belongs to a alone:
//! an acceleration once wrong stays so. At rho = 1/2 they are the scheme of Chung and Lee with beta = 28/27.

use super::ExplicitFacts;

/// The explicit generalised-alpha scheme of Hulbert and Chung, without damping, with the modulus rho_b of the multipliers
/// where they become real.
pub(super) static FACTS: ExplicitFacts = ExplicitFacts {
    name: "generalised-alpha",
    title: "explicit generalised-alpha",
    parameter: "rho_b",
    usual: 0.8,
    allowed: (0.0, 1.0),
    evaluations: 1,
    order: 2,
    formula: "sqrt(12 (2 - rho)(1 + rho)/(rho^2 - 5 rho + 10))",
    source: "Hulbert, Chung, Comput. Methods Appl. Mech. Eng. 137 (1996)",
    factor: |rho| (10.0 - rho * (5.0 - rho)) / (6.0 + 3.0 * (rho * (1.0 - rho))),
    states: 3,
    step,
};

fn step(rho: f64, w: f64, state: &[f64]) -> Vec<f64> {
    let alpha = (2.0 * rho - 1.0) / (1.0 + rho);
    let beta = (5.0 - 3.0 * rho) / ((1.0 + rho) * (1.0 + rho) * (2.0 - rho));
    let a = (-w * state[0] - alpha * state[2]) / (1.0 - alpha);
    newmark(state, a, beta, 1.5 - alpha)
}

/// (u, dt v, dt^2 a) after a step to the acceleration `a`, by beta and gamma of Newmark.
pub(super) fn newmark(state: &[f64], a: f64, beta: f64, gamma: f64) -> Vec<f64> {
    let (u, v, old) = (state[0], state[1], state[2]);
    vec![u + v + (0.5 - beta) * old + beta * a, v + (1.0 - gamma) * old + gamma * a, a]
}
