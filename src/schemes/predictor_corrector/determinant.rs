//! Where the product of all multipliers proves growth.
//!
//! A step is v -= dt M^-1 K u, v -= dt M^-1 Z C Z'(u + dt v), u += dt v: two shears of determinant 1, and one that takes v to
//! (I - dt^2 M^-1 Z C Z') v. So the multipliers have the product
//!
//! ```text
//! det(I - dt^2 C G) = prod_i (1 - dt^2 v_i)      1/v_i = a + 1/(beta_s g_i)      g_i the eigenvalues of W^1/2 G W^1/2
//! ```
//! at any step, for any mesh, mass matrix and contacts. Where its modulus exceeds 1 a multiplier is outside the unit circle:
//! the limit, up to which none is, lies below each such step. With one contact it is dt^2 v > 2.

use crate::spectrum::{UNIT_ROUNDOFF, bisect};

/// Contacts for which the intervals between the roots 1/v_i are looked at one by one; of more, only the step beyond which
/// each factor exceeds 1.
const FEW: usize = 64;

/// Intervals that hold the g_i, from the largest down, rad^2/s^2.
pub(super) struct Determinant(Vec<(f64, f64)>);

impl Determinant {
    /// For eigenvalues in rising order, each off by `error` of the largest.
    pub fn new(values: &[f64], error: f64) -> Self {
        let off = error * values.last().copied().unwrap_or(0.0);
        let least = values.first().map_or(0.0, |g| g - off);
        if values.len() > FEW {
            return Self::above(least);
        }
        Self(values.iter().rev().map(|g| ((g - off).max(0.0), g + off)).collect())
    }

    /// For eigenvalues of at least `least`: a factor that exceeds 1 may count as 1.
    pub fn above(least: f64) -> Self {
        Self(vec![(least.max(0.0), f64::INFINITY)])
    }

    /// The smallest dt^2 found that is proven to be unstable with these beta_s and r omega^2, s^2; infinite if there is
    /// none.
    pub fn unstable_from(&self, stiffness: f64, rate: f64) -> f64 {
        let slack = 8.0 * UNIT_ROUNDOFF;
        let of = |g: f64, sign: f64| (1.0 + sign * slack) / (1.0 / (stiffness * g) + 1.0 / rate);
        let rates: Vec<(f64, f64)> =
            self.0.iter().map(|(low, high)| (of(*low, -1.0), of(*high, 1.0))).collect();
        let exceeds = |square: f64| logarithm(&rates, square) > 0.0;
        for (i, (low, _)) in rates.iter().enumerate() {
            let next = rates.get(i + 1).map_or(0.0, |(_, high)| *high);
            let (from, to) = (1.0 / low, if next > 0.0 { 1.0 / next } else { 4.0 / low });
            if from.is_infinite() || from >= to {
                continue;
            }
            // ln|prod| is concave between two roots.
            let falls = |square: f64| rates.iter().map(|(v, _)| v / (square * v - 1.0)).sum::<f64>() < 0.0;
            let highest = if next > 0.0 { bisect(from, to, falls).0 } else { to };
            if exceeds(highest) {
                return bisect(from, highest, exceeds).1;
            }
        }
        f64::INFINITY
    }
}

/// No more than ln prod_i |1 - square v_i| for v_i in these intervals.
fn logarithm(rates: &[(f64, f64)], square: f64) -> f64 {
    let factor = |(low, high): &(f64, f64)| {
        let least = (square * low - 1.0).max(1.0 - square * high).max(0.0);
        let logarithm = least.ln();
        // Three roundings of the factor and one of its logarithm, and of the sum one a term.
        logarithm - 4.0 * UNIT_ROUNDOFF * (1.0 + rates.len() as f64) * (1.0 + logarithm.abs())
    };
    rates.iter().map(factor).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two(second: f64) -> Determinant {
        Determinant::new(&[second, 1.0], 1e-15)
    }

    #[test]
    fn one_contact_grows_from_twice_its_own_step() {
        let one = Determinant::new(&[4.0], 1e-15);
        assert!((one.unstable_from(0.25, f64::INFINITY) - 2.0).abs() < 1e-13);
        // 1/v = a + 1/(beta_s g)
        assert!((one.unstable_from(0.25, 1.0) - 4.0).abs() < 1e-13);
    }

    #[test]
    fn a_second_contact_is_waited_for_only_where_it_damps_enough() {
        // (s - 1)(1 - s/100) exceeds 1 between the roots.
        let s = two(0.01).unstable_from(1.0, f64::INFINITY);
        assert!(((s - 1.0) * (1.0 - 0.01 * s) - 1.0).abs() < 1e-12 && s < 2.1, "{s}");
        // (s - 1)(1 - s/2) <= 1/8: only beyond both roots, (s - 1)(s/2 - 1) = 1 at s = 3.
        assert!((two(0.5).unstable_from(1.0, f64::INFINITY) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn many_contacts_grow_where_each_alone_would() {
        let many: Vec<f64> = (1..=100).map(f64::from).collect();
        assert!((Determinant::new(&many, 1e-15).unstable_from(1.0, f64::INFINITY) - 2.0).abs() < 1e-12);
        assert!(two(0.0).unstable_from(0.0, f64::INFINITY).is_infinite());
    }
}
