//! alpha = dt/dt_c at which the multiplier -1 of the Park scheme appears.
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

use super::{COMPLIANCE_ERROR, SchemeLimit};
use crate::pencil::{Penalty, Tridiagonal};
use crate::spectrum::{Enclosure, UNIT_ROUNDOFF, Uncertified, WIDEST_ENCLOSURE, certify, find_sign_change};

/// The partial fractions of the characteristic function.
#[derive(Debug, Clone, Copy)]
struct Fractions {
    /// The pole above the spectrum over l_n.
    above: f64,
    /// Minus the pole below zero over l_n; infinite without pullback.
    below: f64,
    /// p.
    gain: f64,
    /// v.
    loss: f64,
    /// a, b, c_0, c_1.
    coefficients: [f64; 4],
}

/// w and [a, b, c_0, c_1] for the multiplier -1 - `growth`.
fn coefficients(theta: f64, alpha: f64, growth: f64) -> (f64, [f64; 4]) {
    let w = theta * alpha * (1.0 - alpha) * (1.0 + alpha) / 6.0;
    let c0 = 2.0 + growth;
    let c1 = alpha * alpha * ((1.0 + growth) / c0);
    let b = 0.5 * w * (1.0 + alpha * (growth / c0));
    (w, [c1 + w, b, c0, c1])
}

impl Fractions {
    /// For the multiplier -1 - `growth`.
    fn new(theta: f64, alpha: f64, growth: f64) -> Self {
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
    fn is_far(&self) -> bool {
        let [_, b, c0, c1] = self.coefficients;
        4.0 * c1 + 16.0 * b <= 0.25 * c0
    }
}

/// Which way the errors of W are tilted.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Tilt {
    None,
    /// W as large as its error allows: a stable sign is proven.
    Pessimistic,
    /// W as small as its error allows: an unstable sign is proven.
    Optimistic,
}

impl Tilt {
    fn sign(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Pessimistic => 1.0,
            Self::Optimistic => -1.0,
        }
    }
}

impl SchemeLimit<'_> {
    pub(super) fn enclose_park(&self, penalties: &[Penalty]) -> Result<Enclosure, Uncertified> {
        let free = self.contact_free;
        // The theorem needs one factor m/s for all contacts; each is formed with at most 4 roundings.
        let factors = || penalties.iter().map(|p| p.mass / p.stiffness);
        let (least, most) = (factors().fold(f64::INFINITY, f64::min), factors().fold(0.0, f64::max));
        if most > least * (1.0 + 8.0 * UNIT_ROUNDOFF) {
            return Err(Uncertified { value: free.value, width: f64::INFINITY });
        }
        let alpha = self.park_alpha(penalties);
        // Two signs with the error of W on the right side prove the value; the interval widens until they do.
        let mut spread = 4.0 * f64::EPSILON;
        while spread < WIDEST_ENCLOSURE {
            let (low, high) = (alpha * (1.0 - spread), (alpha * (1.0 + spread)).min(1.0));
            let stable = self.margin(penalties, low, 0.0, Tilt::Pessimistic) > 0.0;
            let (l_low, l_high) = (free.value / (high * high), free.value / (low * low));
            if stable && (high == 1.0 || self.margin(penalties, high, 0.0, Tilt::Optimistic) < 0.0) {
                let rounding = 4.0 * f64::EPSILON;
                // At dt_c the contact-free scheme itself ends, at the exact l_n.
                let lower = if high == 1.0 { free.lower } else { l_low * (1.0 - rounding) };
                let value = free.value / (alpha * alpha);
                return certify(Enclosure { value, lower, upper: l_high * (1.0 + rounding) });
            }
            spread *= 1.25;
        }
        Err(Uncertified { value: free.value / (alpha * alpha), width: f64::INFINITY })
    }

    /// The alpha in (0, 1] at which the margin changes sign.
    fn park_alpha(&self, penalties: &[Penalty]) -> f64 {
        let deficit = |alpha: f64| -self.margin(penalties, alpha, 0.0, Tilt::None);
        let mut high = (1.0, deficit(1.0));
        if high.1 < 0.0 {
            return 1.0;
        }
        let mut low = (0.5, deficit(0.5));
        while low.1 >= 0.0 && low.0 > f64::MIN_POSITIVE {
            // W falls at least like alpha: the drop that this allows, twice over. Next to a pole W is so large that the
            // drop would leave f64 behind the root; a millionth at a time leads back.
            high = low;
            let drop = 0.5 * (1.0 - low.1) / (1.0 + low.1);
            let alpha = low.0 * drop.clamp(1e-6, 0.5);
            low = (alpha, deficit(alpha));
        }
        let (low, high) = find_sign_change(low, high, 2.0 * f64::EPSILON, deficit);
        low + 0.5 * (high - low)
    }

    /// |z| - 1 > 0 of the real multiplier beyond -1 at dt = `alpha` dt_c: the growth in a step just above the limit.
    /// 0 below the limit. Beyond dt_c that of the top mode, if no contact moves it.
    pub(super) fn park_growth(&self, penalties: &[Penalty], alpha: f64) -> Option<f64> {
        let margin = |growth: f64| {
            if alpha > 1.0 {
                self.top_margin(alpha, growth)
            } else {
                self.margin(penalties, alpha, growth, Tilt::None)
            }
        };
        let touched = self.contact_eigenvalue(penalties) > 0.0;
        if alpha > 1.0 && touched && self.park_alpha(penalties) < 1.0 {
            return None;
        }
        if margin(0.0) >= 0.0 {
            return Some(0.0);
        }
        let (mut low, mut high) = (f64::EPSILON * f64::EPSILON, f64::EPSILON);
        while margin(high) < 0.0 && high < f64::MAX {
            (low, high) = (high, 4.0 * high);
        }
        let (low, high) =
            find_sign_change((low, margin(low)), (high, margin(high)), f64::EPSILON.sqrt(), margin);
        Some(low + 0.5 * (high - low))
    }

    /// c_0 - c_1 x - b x^2 of the contact-free top mode, x = 4.
    fn top_margin(&self, alpha: f64, growth: f64) -> f64 {
        let (_, [_, b, c0, c1]) = coefficients(self.theta, alpha, growth);
        c0 - 4.0 * c1 - 16.0 * b
    }

    /// W of the single contact at alpha, m/N.
    pub(super) fn park_flexibility(&self, alpha: f64) -> Option<f64> {
        let (gained, lost) = self.sides(Fractions::new(self.theta, alpha, 0.0), Tilt::None)?;
        Some(gained.diagonal[0] - lost.diagonal[0])
    }

    /// p F(above) and v F(below), m/N; `None` if the upper pole is not above the spectrum.
    fn sides(&self, fractions: Fractions, tilt: Tilt) -> Option<(Tridiagonal, Tridiagonal)> {
        let (free, sign) = (self.contact_free, tilt.sign());
        let error = |l: f64| self.pole_error(l);
        if let (true, Some(moments)) = (fractions.is_far(), &self.moments) {
            // Twice the error on the diagonal stands for that beside it.
            let several = if self.compliance.diagonal.len() > 1 { 2.0 } else { 1.0 };
            let mut gained = moments.series(fractions.coefficients, several * sign);
            let squared_step = 4.0 / free.value;
            gained.diagonal.iter_mut().chain(&mut gained.off_diagonal).for_each(|w| *w *= squared_step);
            let lost = Tridiagonal {
                diagonal: vec![0.0; gained.diagonal.len()],
                off_diagonal: vec![0.0; gained.off_diagonal.len()],
            };
            return Some((gained, lost));
        }
        let upper = free.value * fractions.above;
        let mut gained = self.flexibility.of(-1.0, upper * (1.0 - sign * error(upper)))?;
        let mut lost = Tridiagonal {
            diagonal: vec![0.0; gained.diagonal.len()],
            off_diagonal: vec![0.0; gained.off_diagonal.len()],
        };
        let lower = free.value * fractions.below;
        if fractions.loss > 0.0 && lower.is_finite() {
            lost = self.flexibility.of(1.0, lower * (1.0 + sign * error(lower)))?;
        }
        let scale = |side: &mut Tridiagonal, factor: f64| {
            side.diagonal.iter_mut().chain(&mut side.off_diagonal).for_each(|entry| *entry *= factor);
        };
        scale(&mut gained, fractions.gain);
        scale(&mut lost, fractions.loss);
        Some((gained, lost))
    }

    /// The last pivot of C^-1 - W over the sum of what it is made of, in [-1, 1]: positive while the multiplier
    /// -1 - `growth` lies beyond the spectrum; -1 if an earlier pivot is not positive. C^-1 = S^-1 + a G.
    ///
    /// C^-1 - W is a sum of positive semidefinite parts T = S^-1, a G, p F and -v F, each tridiagonal and put together bar
    /// by bar. If an entry of a part is off by e (T_ii T_jj)^(1/2), the part is off by no more than
    /// e (sum T_ii^(1/2) |y_i|)^2 <= 2 e sum T_ii y_i^2 at most, for the one or two contacts of a bar. So the errors of
    /// the entries beside the diagonal are borne by the diagonal, and its last pivot proves a sign.
    fn margin(&self, penalties: &[Penalty], alpha: f64, growth: f64, tilt: Tilt) -> f64 {
        let fractions = Fractions::new(self.theta, alpha, growth);
        let Some((gained, lost)) = self.sides(fractions, tilt) else { return -1.0 };
        let sign = tilt.sign();
        let (entries, upper, lower) = self.relative_errors(fractions);
        let factor = penalties.iter().map(|p| p.mass / p.stiffness).fold(0.0, f64::max);
        let (own, beside) = (&self.compliance.diagonal, &self.compliance.off_diagonal);
        let (mut carried, mut margin) = (0.0, -1.0);
        for (j, p) in penalties.iter().enumerate() {
            let inverse = 1.0 / p.stiffness + factor * own[j];
            let error = entries * inverse + upper * gained.diagonal[j] + lower * lost.diagonal[j];
            let pivot = inverse - gained.diagonal[j] + lost.diagonal[j] - sign * error - carried;
            margin = pivot / (inverse + gained.diagonal[j] + lost.diagonal[j] + carried);
            if j + 1 == penalties.len() {
                break;
            }
            if pivot.is_nan() || pivot <= 0.0 {
                return -1.0;
            }
            let off = factor * beside[j] - gained.off_diagonal[j] + lost.off_diagonal[j];
            carried = off * (off / pivot);
        }
        margin
    }

    /// Errors of the diagonal that stand for those of S^-1 + a G, of p F(above) and of v F(below), relative.
    ///
    /// The fractions take fewer than 16 roundings, mu as many as it has and 4 more, the pivots of the margin fewer than 8.
    /// The entries of a bar between two contacts come of two eliminations, each exact for a matrix that differs by e, in
    /// units of l M ([`Self::pole_error`]): beside the shift of the pole, F(above) may be off by e l/(l - l_n) twice over,
    /// and F(below), where K + l M >= l M, by e twice over.
    fn relative_errors(&self, fractions: Fractions) -> (f64, f64, f64) {
        let coupled = self.compliance.diagonal.len() > 1;
        let entries = COMPLIANCE_ERROR + 20.0 * UNIT_ROUNDOFF;
        if !coupled {
            return (entries, entries, entries);
        }
        let entries = 2.0 * entries + 8.0 * UNIT_ROUNDOFF;
        if fractions.is_far() {
            return (entries, entries, entries);
        }
        let free = self.contact_free;
        let (above, below) = (free.value * fractions.above, free.value * fractions.below);
        let distance = (above - free.upper) / above;
        let mixed = 2.0 * self.pole_error(above) / distance;
        (entries, entries + mixed, entries + 2.0 * self.pole_error(below))
    }

    /// Relative error of a pole l: the elimination moves it by 8 unit roundoffs of 3 l + B, as |M| <= 3 M, the pole takes 8
    /// more.
    fn pole_error(&self, l: f64) -> f64 {
        8.0 * UNIT_ROUNDOFF * (4.0 + self.pencil.element_bound() / l)
    }
}
