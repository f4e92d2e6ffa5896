//! What a uniform bar makes of l, compressed: polynomials serve better than sines and logarithms.
//!
//! **Inside the band** T has poles. With v = 1 - l/omega_e^2 > 0 and n phi = z, the free far end leaves T = -EA/h sqrt(L x v) tan z, with its first pole
//! at v_1, where z = pi/2 and the bar resonates with its contact end held. With xi = v/v_1,
//!
//! ```text
//! sqrt(L x v) tan z = S xi H(xi)/(1 - xi)      S = sqrt(L) 2n v_1/sqrt(1 + slope)      H(0) = 1
//! ```
//! H is nearly a straight line (1 to 8/pi^2 for a long bar), analytic up to the next pole, v_3 at z = 3 pi/2: its
//! Chebyshev coefficients fall like rho^-k, where the ellipse of rho ends in v_3 (rho = 34 for a long bar). An error e of
//! H moves v by no more than e xi (1 - xi) v_1, since the equation c (1 - xi) = S xi H falls at least as fast as its
//! last term alone.
//!
//! **Above the band** n theta = reach sqrt(y) P(y), where P is analytic up to y = -1 and needed only until tanh(n theta) is 1
//! in f64: for a long bar over a short stretch.

use std::f64::consts::FRAC_PI_2;

use crate::spectrum::chebyshev;

/// Coefficients of H, and of P.
const TERMS: usize = 12;
const ANGLE_TERMS: usize = 7;

/// -T/(EA/h) inside the band, for a bar with a free far end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// v_1.
    held: f64,
    /// S.
    scale: f64,
    /// H in powers of t = 2 xi - 1.
    coefficients: [f64; TERMS],
}

impl Band {
    /// `None` where the series leaves out more than rounding does: below 4 elements (consistent) or 3 (lumped).
    /// `factor` is L, `slope` that of D in the formulas of a uniform bar.
    pub fn new(elements: f64, factor: f64, slope: f64) -> Option<Self> {
        if elements < 3.0 {
            return None;
        }
        let held = fall_at(FRAC_PI_2 / elements, slope);
        let pole = 2.0 * fall_at(3.0 * FRAC_PI_2 / elements, slope) / held - 1.0;
        let rho = pole + (pole * pole - 1.0).sqrt();
        if rho.powi(-(TERMS as i32)) * held > f64::EPSILON / 4.0 {
            return None;
        }
        let scale = 2.0 * elements * (factor / (1.0 + slope)).sqrt() * held;
        let end = (0.5 * FRAC_PI_2 / elements).sin();
        let sample = |t: f64| {
            let (xi, rest) = (0.5 * (1.0 + t), 0.5 * (1.0 - t));
            let v = xi * held;
            let sin = (v / (1.0 + slope * (1.0 - v))).sqrt();
            // pi/2 - z from sin^2(phi_1/2) - sin^2(phi/2) = sin((phi_1 - phi)/2) sin((phi_1 + phi)/2), which does not
            // cancel at the pole.
            let squares = rest * held * (1.0 + slope * end * end) * (1.0 + slope * sin * sin) / (1.0 + slope);
            let away = 2.0 * elements * (squares / (0.5 * FRAC_PI_2 / elements + sin.asin()).sin()).asin();
            (factor * (1.0 - v) * v).sqrt() / away.tan() * rest / (xi * scale)
        };
        Some(Self { held, scale, coefficients: powers(&chebyshev(sample)) })
    }

    /// v of l_max, the first root of sqrt(L x v) tan z = `depth` - b_mass v; `None` if the iteration has not settled.
    ///
    /// Halley's method in xi on (1 - i xi)(1 - xi) - f xi H, all forces divided by depth, which may be near f64::MAX.
    /// The guess takes for H a line, within 0.4 % for a long bar, which leaves a quadratic.
    #[inline]
    pub fn root(&self, depth: f64, b_mass: f64) -> Option<f64> {
        const GUESS: f64 = -0.19;
        let (f, i) = (self.scale / depth, b_mass / depth * self.held);
        let sum = 1.0 + i + f;
        let gap = (sum * sum - 4.0 * (i + GUESS * f)).sqrt();
        let mut xi = 2.0 / (sum + gap);
        for _ in 0..8 {
            let (h, h_slope, h_bend) = self.h(xi);
            let value = (1.0 - i * xi) * (1.0 - xi) - f * xi * h;
            let fall = 1.0 + i - 2.0 * i * xi + f * (h + xi * h_slope);
            let bend = 2.0 * i - f * (2.0 * h_slope + xi * h_bend);
            let step = value * fall / (fall * fall - 0.5 * value * bend);
            xi += step;
            // The next step would be about step^3 (bend/fall)^2/4, with bend < sum and fall about gap.
            if step.abs() * (step * sum) * (step * sum) * self.held <= gap * gap * f64::EPSILON / 16.0 {
                // The other root has xi > 1 or c < 0.
                let first = xi.max(i * xi) <= 1.0 + 4.0 * f64::EPSILON;
                return first.then_some(xi * self.held);
            }
        }
        None
    }

    /// H, H' and H'' at xi.
    #[inline]
    fn h(&self, xi: f64) -> (f64, f64, f64) {
        let t = 2.0 * xi - 1.0;
        let (mut value, mut slope, mut bend) = (0.0, 0.0, 0.0);
        for c in self.coefficients.iter().rev() {
            bend = bend * t + slope;
            slope = slope * t + value;
            value = value * t + c;
        }
        (value, 2.0 * slope, 8.0 * bend)
    }
}

/// n theta above the band as a function of y = l/omega_e^2 - 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle {
    /// n theta/sqrt(y) near y = 0.
    reach: f64,
    /// 2 over the y from which on tanh(n theta) = 1.
    scale: f64,
    /// P in powers of t = scale y - 1.
    coefficients: [f64; ANGLE_TERMS],
}

impl Angle {
    /// For 0 <= y <= `saturated`; `None` where the series leaves out more than rounding does: below some 60 to 100
    /// elements.
    pub fn new(elements: f64, slope: f64, saturated: f64) -> Option<Self> {
        let pole = 2.0 / saturated + 1.0;
        let rho = pole + (pole * pole - 1.0).sqrt();
        if rho.powi(-(ANGLE_TERMS as i32)) > f64::EPSILON / 4.0 {
            return None;
        }
        let reach = 2.0 * elements / (1.0 + slope).sqrt();
        let sample = |t: f64| {
            let y = 0.5 * (1.0 + t) * saturated;
            2.0 * elements * (y / (1.0 + slope * (1.0 + y))).sqrt().asinh() / (reach * y.sqrt())
        };
        Some(Self { reach, scale: 2.0 / saturated, coefficients: powers(&chebyshev(sample)) })
    }

    /// n theta and its derivative by y.
    #[inline]
    pub fn at(&self, y: f64) -> (f64, f64) {
        let t = self.scale * y - 1.0;
        let (mut value, mut slope) = (0.0, 0.0);
        for c in self.coefficients.iter().rev() {
            slope = slope * t + value;
            value = value * t + c;
        }
        let start = self.reach * y.sqrt();
        (start * value, start * (0.5 * value / y + self.scale * slope))
    }
}

/// v = -y at phi: sin^2(phi/2) = v/(1 + slope (1 - v)) solved for v.
pub fn fall_at(phi: f64, slope: f64) -> f64 {
    let sin2 = (0.5 * phi).sin().powi(2);
    sin2 * (1.0 + slope) / (1.0 + slope * sin2)
}

/// The coefficients of powers of t from those of Chebyshev polynomials, by T_(k+1) = 2 t T_k - T_(k-1).
fn powers<const N: usize>(chebyshev: &[f64; N]) -> [f64; N] {
    let mut sum = [0.0; N];
    let (mut last, mut this) = ([0.0; N], [0.0; N]);
    this[0] = 1.0;
    for (k, c) in chebyshev.iter().enumerate() {
        (0..N).for_each(|j| sum[j] += c * this[j]);
        let doubling = if k == 0 { 1.0 } else { 2.0 };
        let next = std::array::from_fn(|j| if j == 0 { 0.0 } else { doubling * this[j - 1] } - last[j]);
        (last, this) = (this, next);
    }
    sum
}
