//! The moments of the gaps, for small steps: where the two poles of the characteristic function lie far from the
//! spectrum its partial fractions cancel, but its power series has positive terms only.
//!
//! ```text
//! (a + b x)/(c_0 - c_1 x - b x^2) = sum_k s_k x^k      s_k = (c_1 s_(k-1) + b s_(k-2))/c_0      s_0 = a/c_0
//! W = dt_c^2 sum_k s_k mu_k      mu_k = Z'M^-1 (dt_c^2 K M^-1)^k Z      (x <= 4)
//! ```

use crate::pencil::{BarRows, ChainPencil, EndGap, Tridiagonal};
use crate::spectrum::UNIT_ROUNDOFF;

/// Moments that are kept. With 4 c_1 + 16 b <= c_0/4 two more terms gain a factor of 4 at least: 2^-60 is left.
const COUNT: usize = 60;

/// mu_k in units of the contact-free l_max, 1/kg.
#[derive(Debug)]
pub(super) struct Moments(Vec<Tridiagonal>);

/// What a unit force at one contact moves: the bars that touch it, which no others couple to; of a lumped one only the
/// nodes that the kept powers of M^-1 K reach.
struct Reach {
    /// The first of its nodes.
    first: usize,
    stiffness: Tridiagonal,
    mass: Tridiagonal,
    /// (M^-1 K)^i M^-1 z.
    state: Vec<f64>,
}

impl Reach {
    fn new(pencil: &ChainPencil<'_>, gap: &EndGap) -> Self {
        let touched = |bar: &&BarRows| gap.nodes().any(|node| bar.nodes.contains(&node));
        let bars = || pencil.bars().iter().filter(touched);
        let mut first = bars().map(|bar| bar.nodes.start).min().unwrap_or(0);
        let mut end = bars().map(|bar| bar.nodes.end).max().unwrap_or(pencil.size());
        if pencil.mass().off_diagonal.iter().all(|off| *off == 0.0) {
            let (low, high) = gap.nodes().fold((usize::MAX, 0), |(l, h), node| (l.min(node), h.max(node)));
            first = first.max(low.saturating_sub(COUNT));
            end = end.min(high + 1 + COUNT);
        }
        let part = |a: &Tridiagonal| Tridiagonal {
            diagonal: a.diagonal[first..end].to_vec(),
            off_diagonal: a.off_diagonal[first..end - 1].to_vec(),
        };
        let (stiffness, mass) = (part(pencil.stiffness()), part(pencil.mass()));
        // The bars are uncoupled, so the two nodes of a pair may carry the same sign, as in the flexibility.
        let mut state = vec![0.0; end - first];
        gap.nodes().for_each(|node| state[node - first] = 1.0);
        solve(&mass, &mut state);
        Self { first, stiffness, mass, state }
    }

    /// state <- factor M^-1 K state.
    fn advance(&mut self, factor: f64) {
        let mut force = vec![0.0; self.state.len()];
        self.stiffness.multiply(&self.state, &mut force);
        force.iter_mut().for_each(|f| *f *= factor);
        solve(&self.mass, &mut force);
        self.state = force;
    }

    /// x'y over the nodes of both, y an image of its own state.
    fn dot(&self, other: &Self, image: &[f64]) -> f64 {
        let start = self.first.max(other.first);
        let (own, others) = (start - self.first, start - other.first);
        let pairs = image.iter().skip(own).zip(other.state.iter().skip(others));
        pairs.map(|(a, b)| a * b).sum()
    }
}

impl Moments {
    /// The moments of the gaps of `pencil`, with dt_c^2 = `squared_step`.
    pub(super) fn new(pencil: ChainPencil<'_>, squared_step: f64) -> Self {
        let mut reaches: Vec<Reach> = pencil.gaps().iter().map(|gap| Reach::new(&pencil, gap)).collect();
        let mut moments = Vec::with_capacity(COUNT);
        while moments.len() < COUNT {
            moments.push(products(&reaches, 1.0, |reach| &reach.mass));
            moments.push(products(&reaches, squared_step, |reach| &reach.stiffness));
            reaches.iter_mut().for_each(|reach| reach.advance(squared_step));
        }
        Self(moments)
    }

    /// sum_k s_k mu_k, 1/kg, with its error put to the side of `sign`: each power of M^-1 K is taken as off by 64 unit
    /// roundoffs, for the elimination of M (8, enlarged by its condition of at most 3) and the product. That is an estimate:
    /// the error is one of 4^k mu_0 rather than of mu_k, so that enclosures of small steps rest on it and on tests, not on
    /// a proof.
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
fn products(reaches: &[Reach], factor: f64, matrix: impl Fn(&Reach) -> &Tridiagonal) -> Tridiagonal {
    let mut found = Tridiagonal::default();
    for (j, reach) in reaches.iter().enumerate() {
        let mut image = vec![0.0; reach.state.len()];
        matrix(reach).multiply(&reach.state, &mut image);
        found.diagonal.push(factor * reach.dot(reach, &image));
        found.off_diagonal.extend(reaches.get(j + 1).map(|next| factor * reach.dot(next, &image)));
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
