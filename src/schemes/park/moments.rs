//! The moments of the gaps, for small steps: where the two poles of the characteristic function lie far from the
//! spectrum its partial fractions cancel, but its power series has positive terms only.
//!
//! ```text
//! (a + b x)/(c_0 - c_1 x - b x^2) = sum_k s_k x^k      s_k = (c_1 s_(k-1) + b s_(k-2))/c_0      s_0 = a/c_0
//! W = dt_c^2 sum_k s_k mu_k      mu_k = Z'M^-1 (dt_c^2 K M^-1)^k Z      (x <= 4)
//! ```

use crate::pencil::{ChainPencil, EndGap, Tridiagonal};
use crate::spectrum::UNIT_ROUNDOFF;

/// Moments that are kept. With 4 c_1 + 16 b <= c_0/4 two more terms gain a factor of 4 at least: 2^-60 is left.
const COUNT: usize = 60;

/// mu_k in units of the contact-free l_max, 1/kg.
#[derive(Debug)]
pub(super) struct Moments(Vec<Tridiagonal>);

impl Moments {
    /// The moments of the gaps of `pencil`, with dt_c^2 = `squared_step`.
    pub(super) fn new(pencil: ChainPencil<'_>, squared_step: f64) -> Self {
        let (k, m) = (pencil.stiffness(), pencil.mass());
        // The bars are uncoupled, so the two nodes of a pair may carry the same sign, as in the flexibility.
        let column = |gap: &EndGap| {
            let mut z = vec![0.0; pencil.size()];
            gap.nodes().for_each(|node| z[node] = 1.0);
            solve(m, &mut z);
            z
        };
        let mut states: Vec<Vec<f64>> = pencil.gaps().iter().map(column).collect();
        let mut moments = Vec::with_capacity(COUNT);
        while moments.len() < COUNT {
            moments.push(products(m, &states, 1.0));
            moments.push(products(k, &states, squared_step));
            for state in &mut states {
                let mut force = vec![0.0; state.len()];
                k.multiply(state, &mut force);
                force.iter_mut().for_each(|f| *f *= squared_step);
                solve(m, &mut force);
                *state = force;
            }
        }
        Self(moments)
    }

    /// sum_k s_k mu_k, 1/kg, with its error put to the side of `sign`: each power of M^-1 K is taken as off by 64 unit
    /// roundoffs, for the elimination of M (8, enlarged by its condition of at most 3) and the product.
    pub(super) fn series(&self, [a, b, c0, c1]: [f64; 4], sign: f64) -> Tridiagonal {
        let contacts = self.0[0].diagonal.len();
        let mut sum = Tridiagonal {
            diagonal: vec![0.0; contacts],
            off_diagonal: vec![0.0; self.0[0].off_diagonal.len()],
        };
        let (mut before, mut s) = (0.0, a / c0);
        for (k, moment) in self.0.iter().enumerate() {
            let factor = s * (1.0 + sign * 64.0 * UNIT_ROUNDOFF * (k + 1) as f64);
            sum.diagonal.iter_mut().zip(&moment.diagonal).for_each(|(sum, mu)| *sum += factor * mu);
            sum.off_diagonal.iter_mut().zip(&moment.off_diagonal).for_each(|(sum, mu)| *sum += s * mu);
            let first = if k == 0 { b } else { b * before };
            (before, s) = (s, (c1 * s + first) / c0);
        }
        sum
    }
}

/// factor x_i'A x_j of neighbouring states.
fn products(matrix: &Tridiagonal, states: &[Vec<f64>], factor: f64) -> Tridiagonal {
    let mut image = vec![0.0; matrix.diagonal.len()];
    let mut found = Tridiagonal::default();
    for (j, state) in states.iter().enumerate() {
        matrix.multiply(state, &mut image);
        let with = |other: &Vec<f64>| factor * other.iter().zip(&image).map(|(a, b)| a * b).sum::<f64>();
        found.diagonal.push(with(state));
        found.off_diagonal.extend(states.get(j + 1).map(with));
    }
    found
}

/// x = A^-1 x for a positive definite A.
fn solve(matrix: &Tridiagonal, x: &mut [f64]) {
    let n = x.len();
    let off = &matrix.off_diagonal;
    let mut pivots = matrix.diagonal.clone();
    for i in 1..n {
        let share = off[i - 1] / pivots[i - 1];
        pivots[i] -= off[i - 1] * share;
        x[i] -= share * x[i - 1];
    }
    for i in (0..n).rev() {
        let beyond = if i + 1 < n { off[i] * x[i + 1] } else { 0.0 };
        x[i] = (x[i] - beyond) / pivots[i];
    }
}
