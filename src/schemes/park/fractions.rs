//! alpha = dt/dt_c at which the multiplier -1 of the Park scheme appears: its characteristic function by poles.
//!
//! In units of dt_c the characteristic function of a real multiplier z <= -1 has, mode by mode, the term
//!
//! ```text
//! (a + b x)/(c_0 - c_1 x - b x^2)      x = l dt_c^2      c_0 = 1 - z      c_1 = alpha^2 z/(z - 1)
//! a = c_1 + w      b = w (1 + alpha (z+1)/(z-1))/2      w = theta alpha (1 - alpha^2)/6
//! ```
//! With q = c_1/2 + sqrt(c_1^2/4 + b c_0) its poles are c_0/q > 0 and -q/b < 0, and with e = b c_0/q its partial
//! fractions are p/(c_0/q - x) - v/(x + q/b), p = (a + e)/(e + q), v = (e - w)/(e + q) >= 0, as a - q = w - e. For small
//! steps both poles are far and their terms cancel, to the share alpha^(1/2) of either.

use crate::double_double::Real;

/// The partial fractions of the characteristic function.
///
/// At z = -1 w takes 5 roundings, q at most 16, e and the poles 24. There e = w/q and q <= 0.6, so that e - w is
/// less than 2.5 times as inexact as e: the fractions take fewer than `ROUNDINGS`.
#[derive(Debug, Clone, Copy)]
pub struct Fractions<T> {
    /// The pole above the spectrum over l_n.
    pub above: T,
    /// Minus the pole below zero over l_n; `None` without pullback.
    pub below: Option<T>,
    /// p.
    pub gain: T,
    /// v.
    pub loss: T,
}

/// w and [a, b, c_0, c_1] for the multiplier -1 - `growth`.
pub(super) fn coefficients<T: Real>(theta: f64, alpha: f64, growth: f64) -> (T, [T; 4]) {
    let [theta, alpha, growth, one] = [theta, alpha, growth, 1.0].map(T::from);
    let w = theta * alpha * (one - alpha) * (one + alpha) / T::from(6.0);
    let c0 = T::from(2.0) + growth;
    let c1 = alpha * alpha * ((one + growth) / c0);
    let b = w * (one + alpha * (growth / c0)) / T::from(2.0);
    (w, [c1 + w, b, c0, c1])
}

impl<T: Real> Fractions<T> {
    /// More than any of the fractions and poles takes.
    pub(super) const ROUNDINGS: f64 = 128.0;

    /// For the multiplier -1 - `growth`.
    pub(super) fn new(theta: f64, alpha: f64, growth: f64) -> Self {
        let (w, [a, b, c0, c1]) = coefficients::<T>(theta, alpha, growth);
        let half = c1 / T::from(2.0);
        let q = half + hypotenuse(half, (b * c0).sqrt());
        let e = b * (c0 / q);
        let loss = if e > w { (e - w) / (e + q) } else { T::from(0.0) };
        // Over l_n: x = 4 l/l_n.
        let quarter = T::from(0.25);
        Self {
            above: quarter * c0 / q,
            below: (b > T::from(0.0)).then(|| quarter * q / b),
            gain: (a + e) / (e + q),
            loss,
        }
    }
}

/// (x^2 + y^2)^(1/2) of positive numbers, without their squares.
fn hypotenuse<T: Real>(x: T, y: T) -> T {
    let (small, large) = if x < y { (x, y) } else { (y, x) };
    let share = small / large;
    large * (T::from(1.0) + share * share).sqrt()
}
