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
//! steps both poles are far and their terms cancel; there the power series takes over.

/// The partial fractions of the characteristic function.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fractions {
    /// The pole above the spectrum over l_n.
    pub above: f64,
    /// Minus the pole below zero over l_n; infinite without pullback.
    pub below: f64,
    /// p.
    pub gain: f64,
    /// v.
    pub loss: f64,
    /// a, b, c_0, c_1.
    pub coefficients: [f64; 4],
}

/// w and [a, b, c_0, c_1] for the multiplier -1 - `growth`.
pub(super) fn coefficients(theta: f64, alpha: f64, growth: f64) -> (f64, [f64; 4]) {
    let w = theta * alpha * (1.0 - alpha) * (1.0 + alpha) / 6.0;
    let c0 = 2.0 + growth;
    let c1 = alpha * alpha * ((1.0 + growth) / c0);
    let b = 0.5 * w * (1.0 + alpha * (growth / c0));
    (w, [c1 + w, b, c0, c1])
}

impl Fractions {
    /// For the multiplier -1 - `growth`.
    pub fn new(theta: f64, alpha: f64, growth: f64) -> Self {
        let (w, coefficients) = coefficients(theta, alpha, growth);
        let [a, b, c0, c1] = coefficients;
        let q = 0.5 * c1 + (0.5 * c1).hypot((b * c0).sqrt());
        let e = b * (c0 / q);
        // Over l_n: x = 4 l/l_n.
        Self {
            above: 0.25 * c0 / q,
            below: 0.25 * q / b,
            gain: (a + e) / (e + q),
            loss: (e - w).max(0.0) / (e + q),
            coefficients,
        }
    }

    /// Whether the poles are so far from the spectrum that the power series is the better form.
    pub fn is_far(&self) -> bool {
        let [_, b, c0, c1] = self.coefficients;
        4.0 * c1 + 16.0 * b <= 0.25 * c0
    }
}
