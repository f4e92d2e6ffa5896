//! Every form of the flexibility of closed contacts is a convex function of the step.
//!
//! A mode with x = l dt_c^2 in [0, 4] has the term phi = N/D of W, with w = theta alpha (1 - alpha^2)/6,
//! N = alpha^2/2 + w (1 + x/2) and D = 2 - x (N - w) > 0. With y = x/4 the numerator of its second derivative is a polynomial,
//!
//! ```text
//! phi'' D^3 = 4 + 12 a^2 y - 4 a t - 4 a t y + 8 a t y^2 - (4/3) a^3 t y - 20 a^3 t y^2
//!           + t^2 ((8/9) y^2 + (16/9) y^3 - (8/3) a^2 y^2 - (16/3) a^2 y^3 + (16/3) a^4 y^2 + 8 a^4 y^3 - (8/9) a^6 y^3)
//! ```
//! a = alpha, t = theta. Its Bernstein coefficients on [0, 1]^3 are not negative, and so is no value of it there.

use super::Park;
use crate::double_double::Real;

/// 9 times the coefficients: (powers of a, t, y; value).
const TERMS: [([usize; 3], i64); 14] = [
    ([0, 0, 0], 36),
    ([2, 0, 1], 108),
    ([1, 1, 0], -36),
    ([1, 1, 1], -36),
    ([1, 1, 2], 72),
    ([3, 1, 1], -12),
    ([3, 1, 2], -180),
    ([0, 2, 2], 8),
    ([0, 2, 3], 16),
    ([2, 2, 2], -24),
    ([2, 2, 3], -48),
    ([4, 2, 2], 48),
    ([4, 2, 3], 72),
    ([6, 2, 3], -8),
];

/// Degrees in a, t, y.
const DEGREES: [usize; 3] = [6, 2, 3];

fn binomial(n: usize, k: usize) -> i64 {
    (0..k).fold(1, |product, i| product * (n - i) as i64 / (i as i64 + 1))
}

/// The Bernstein coefficient sum over j <= i of a_j C(i, j)/C(n, j), times 9 * 60^3, exactly: 60 is a multiple of C(n, j).
#[test]
fn bernstein_coefficients_are_not_negative() {
    let share = |i: usize, j: usize, n: usize| if j > i { 0 } else { 60 * binomial(i, j) / binomial(n, j) };
    for a in 0..=6 {
        for t in 0..=2 {
            for y in 0..=3 {
                let term = |(powers, value): &([usize; 3], i64)| {
                    let [p, q, s] = *powers;
                    value * share(a, p, DEGREES[0]) * share(t, q, DEGREES[1]) * share(y, s, DEGREES[2])
                };
                let coefficient: i64 = TERMS.iter().map(term).sum();
                assert!(coefficient >= 0, "{a} {t} {y}: {coefficient}");
            }
        }
    }
}

/// The polynomial is the second derivative of the fractions that limits are made of.
#[test]
fn the_polynomial_is_that_of_the_fractions() {
    for (alpha, theta, y) in [(0.3, 0.5, 0.7), (0.6, 1.0, 0.9), (0.05, 0.25, 0.2), (0.8, 0.8, 0.95)] {
        let park = Park::new(theta).unwrap();
        let phi = |alpha: f64| {
            let f = park.fractions(alpha);
            // l = y l_c, in units of dt_c^2 = 4/l_c.
            let above = f.gain.value() / (f.above.value() - y);
            0.25 * (above - f.below.map_or(0.0, |below| f.loss.value() / (below.value() + y)))
        };
        let h = 1e-3;
        let second = (phi(alpha + h) - 2.0 * phi(alpha) + phi(alpha - h)) / (h * h);
        let w = theta * alpha * (1.0 - alpha * alpha) / 6.0;
        let n = 0.5 * alpha * alpha + w * (1.0 + 2.0 * y);
        let d = 2.0 - 4.0 * y * (n - w);
        let term = |(powers, value): &([usize; 3], i64)| {
            let power = |x: f64, p: usize| x.powi(p as i32);
            *value as f64 / 9.0 * power(alpha, powers[0]) * power(theta, powers[1]) * power(y, powers[2])
        };
        let polynomial: f64 = TERMS.iter().map(term).sum();
        assert!((phi(alpha) - n / d).abs() < 1e-12 * phi(alpha), "{alpha} {theta} {y}");
        assert!(
            (second * d.powi(3) / polynomial - 1.0).abs() < 1e-3,
            "{alpha} {theta} {y}: {second} {polynomial}"
        );
    }
}
