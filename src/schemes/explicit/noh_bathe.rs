//! Two sub-steps, p dt and (1 - p) dt, the second of which damps.
//!
//! ```text
//! u_p = u + p dt v + (p dt)^2/2 a           a_p = M^-1 (f - K u_p)      v_p = v + p dt/2 (a + a_p)
//! u'  = u_p + s dt v_p + (s dt)^2/2 a_p     a'  = M^-1 (f - K u')       v' = v_p + s dt (q_0 a + (1/2 + q_1) a_p + q_2 a')
//! s = 1 - p      q_1 = (1 - 2p)/(2 p s)      q_2 = 1/2 - p q_1      q_0 = 1/2 - q_1 - q_2
//! ```
//! With w = (omega dt)^2 the matrix of (u, dt v) has
//!
//! ```text
//! D         = 1 - w^2 s^2 (2p - 1)/4
//! 1 - T + D = w (4 - w (3p - 1) s)/4
//! 1 + T + D = (16 - 4 w + w^2 s (4p^2 - 3p + 1))/4
//! ```
//! D <= 1 needs p >= 1/2. The second is not negative up to w = 4/((3p - 1) s): at Omega the multiplier is +1. The third has no zero
//! if s (4p^2 - 3p + 1) >= 1/4, that is for 1/2 <= p <= 3/4, where it touches zero at both ends; for p > 3/4 there is an island of
//! instability at -1 below Omega. D >= -1 up to Omega since 2 (2p - 1) <= (3p - 1)^2. At p = 1/2 the sub-steps are those of central
//! differences, Omega = 4; the least Omega is 2 sqrt(3) = 3.46, at p = 2/3.

use super::ExplicitFacts;

/// The explicit scheme of Noh and Bathe with the first sub-step p dt. Below 1/2 it grows at every step; above 3/4 it is
/// unstable in an interval below its limit.
pub(super) static FACTS: ExplicitFacts = ExplicitFacts {
    name: "noh-bathe",
    title: "Noh-Bathe",
    parameter: "p",
    usual: 0.54,
    allowed: (0.5, 0.75),
    evaluations: 2,
    order: 2,
    formula: "2/sqrt((3p - 1)(1 - p))",
    source: "Noh, Bathe, Comput. Struct. 129 (2013)",
    factor: |p| (3.0 * p - 1.0) * (1.0 - p),
    states: 2,
    step,
};

fn step(p: f64, w: f64, state: &[f64]) -> Vec<f64> {
    let s = 1.0 - p;
    let q1 = (1.0 - 2.0 * p) / (2.0 * p * s);
    let q2 = 0.5 - p * q1;
    let q0 = 0.5 - q1 - q2;
    let (u, v) = (state[0], state[1]);
    let a = -w * u;
    let u_p = u + p * v + 0.5 * p * p * a;
    let a_p = -w * u_p;
    let v_p = v + 0.5 * p * (a + a_p);
    let u_end = u_p + s * v_p + 0.5 * s * s * a_p;
    let a_end = -w * u_end;
    vec![u_end, v_p + s * (q0 * a + (0.5 + q1) * a_p + q2 * a_end)]
}
