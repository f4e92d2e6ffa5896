//! The largest eigenvalue of a dense pencil, proven without any structure.
//!
//! *From below*: the Rayleigh quotient of a computed eigenvector, less its rounding. *From above*: u M - K has a Cholesky
//! factor. In floating point a factor shows that the matrix is at least minus n (n + 1) u times its diagonal (Demmel 1989;
//! Rump, BIT 46, 2006); this and the rounding of the entries are taken off the diagonal before.

use faer::{Mat, MatRef};

use super::{Enclosure, UNIT_ROUNDOFF, Uncertified};
use crate::symmetric::{Cholesky, eigen};

/// The widest relative enclosure that counts as certified without the structure of a chain: that of the critical step is
/// half of it.
pub const WIDEST_DENSE_ENCLOSURE: f64 = 1e-9;

/// l_max of (K, M), whose entries carry `roundings` unit roundoffs of the pencil they stand for.
pub(super) fn enclose(k: &Mat<f64>, m: &Mat<f64>, roundings: f64) -> Result<Enclosure, Uncertified> {
    let unknown = Uncertified { value: f64::NAN, width: f64::INFINITY };
    let (value, x) = top_mode(k, m).ok_or(unknown)?;
    let lower = rayleigh_bound(k.as_ref(), m.as_ref(), &x, roundings);
    let n = k.nrows() as f64;
    // The bound of the factor with that of the entries, |A_ij| <= sqrt(A_ii A_jj).
    let rounding = 2.0 * UNIT_ROUNDOFF * n * (n + 1.0 + roundings);
    let mut spread = rounding;
    while spread < WIDEST_DENSE_ENCLOSURE {
        let u = value * (1.0 + spread);
        let shifted = |i: usize, j: usize| {
            let entry = u * m[(i, j)] - k[(i, j)];
            if i == j { entry - rounding * (u * m[(i, i)] + k[(i, i)].abs()) } else { entry }
        };
        let positive = Cholesky::new(Mat::from_fn(k.nrows(), k.ncols(), shifted)).is_some();
        if positive && lower <= value && u - lower <= WIDEST_DENSE_ENCLOSURE * value {
            return Ok(Enclosure { value, lower, upper: u });
        }
        spread *= 2.0;
    }
    Err(Uncertified { value, width: f64::INFINITY })
}

/// The largest eigenvalue and its vector.
fn top_mode(k: &Mat<f64>, m: &Mat<f64>) -> Option<(f64, Vec<f64>)> {
    let factor = Cholesky::new(m.clone())?;
    let (values, mut shapes) = eigen(&factor.standard_form(k.clone()))?;
    let last = k.nrows() - 1;
    factor.turn_back(shapes.get_mut(.., last..));
    Some((values[last], (0..=last).map(|i| shapes[(i, last)]).collect()))
}

/// x'Kx/x'Mx less what its sums and the entries have lost: n + `roundings` + 2 unit roundoffs of every term.
fn rayleigh_bound(k: MatRef<'_, f64>, m: MatRef<'_, f64>, x: &[f64], roundings: f64) -> f64 {
    let form = |a: MatRef<'_, f64>| {
        let (mut sum, mut size) = (0.0, 0.0);
        for j in 0..x.len() {
            for i in 0..x.len() {
                let term = a[(i, j)] * x[i] * x[j];
                sum += term;
                size += term.abs();
            }
        }
        (sum, size)
    };
    let ((stiffness, all_stiffness), (mass, all_mass)) = (form(k), form(m));
    let n = x.len() as f64;
    let lost = UNIT_ROUNDOFF * (n * n + roundings + 2.0);
    (stiffness - lost * all_stiffness) / (mass + lost * all_mass)
}
