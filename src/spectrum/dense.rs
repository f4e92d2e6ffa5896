//! The dense engine: the pencil in gap coordinates, reduced to standard form with faer.
//!
//! Summed into K, a pair contact s (u_a - u_b)^2 drowns the common motion of its nodes: at s = 1e16 K nothing of K is
//! left. So the lighter node of each pair is replaced by the gap itself, u_b = u_a - q or u_a = u_b + q: the contact
//! then sits on one diagonal entry, and the copied entries of the lighter node disturb the heavier one by no more
//! than rounding of l_max.

use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par, Side};

use super::{Enclosure, Engine, Sturm, Uncertified, WIDEST_ENCLOSURE};
use crate::pencil::{Gap, Penalty, Pencil, Tridiagonal};

/// More nodes than this are refused for the dense engine: one matrix would take over 3 GB and a point hours.
pub const MAX_DENSE_NODES: usize = 20_000;

/// The engine `dense`: O(n^3) operations and 16 n^2 bytes a point.
#[derive(Debug)]
pub struct Dense<'a> {
    pencil: &'a Pencil,
    sturm: Sturm<'a>,
}

impl<'a> Dense<'a> {
    /// The engine for `pencil`.
    pub fn new(pencil: &'a Pencil) -> Self {
        Self { pencil, sturm: Sturm::new(pencil) }
    }
}

impl Engine for Dense<'_> {
    fn name(&self) -> &'static str {
        "dense"
    }

    fn estimate(&self, penalties: &[Penalty], _start: Option<f64>) -> f64 {
        let (k, m) = with_gaps_last(self.pencil, penalties);
        // Without a factor or without convergence there is no value: NaN, which no certificate accepts.
        largest(k, &m).unwrap_or(f64::NAN)
    }

    fn enclose(&self, penalties: &[Penalty], _start: Option<f64>) -> Result<Enclosure, Uncertified> {
        // The error of the dense reduction has no sharp constant, so the value is proven by two Sturm counts; they
        // leave a tenth of the widest enclosure to the margin of their own rounding.
        self.sturm.verify(penalties, self.estimate(penalties, None), 0.45 * WIDEST_ENCLOSURE)
    }
}

/// K + K_p and M + M_p, dense n x n, with the lighter node of every pair replaced by the gap.
pub fn in_gap_coordinates(pencil: &Pencil, penalties: &[Penalty]) -> (Mat<f64>, Mat<f64>) {
    let mut k = dense(pencil.stiffness());
    let mut m = dense(pencil.mass());
    for (gap, p) in pencil.gaps().iter().zip(penalties) {
        for node in gap.nodes() {
            m[(node, node)] += p.nodal_mass;
        }
    }
    let gap_nodes: Vec<usize> = pencil.gaps().iter().map(|gap| eliminated(gap, pencil)).collect();
    for (gap, node) in pencil.gaps().iter().zip(&gap_nodes) {
        if let Gap::Pair { left } = *gap {
            let kept = 2 * left + 1 - node;
            for matrix in [&mut k, &mut m] {
                add_row_and_column(matrix, *node, kept);
            }
        }
    }
    for (node, p) in gap_nodes.iter().zip(penalties) {
        k[(*node, *node)] += p.stiffness;
        m[(*node, *node)] += p.mass;
    }
    (k, m)
}

/// The node that the gap replaces: the lighter one of a pair.
fn eliminated(gap: &Gap, pencil: &Pencil) -> usize {
    let mass = &pencil.mass().diagonal;
    match *gap {
        Gap::Wall { node } => node,
        Gap::Pair { left } if mass[left] <= mass[left + 1] => left,
        Gap::Pair { left } => left + 1,
    }
}

/// As [`in_gap_coordinates`], with the gaps behind all other nodes. The tridiagonal reduction carries a gap that it
/// meets on its way, nearly decoupled by its penalties, past every later node, at a unit of rounding of l_max each;
/// at the end it stays where it is.
pub fn with_gaps_last(pencil: &Pencil, penalties: &[Penalty]) -> (Mat<f64>, Mat<f64>) {
    let gaps: Vec<usize> = pencil.gaps().iter().map(|gap| eliminated(gap, pencil)).collect();
    let others = (0..pencil.size()).filter(|node| !gaps.contains(node));
    let order: Vec<usize> = others.chain(gaps.iter().copied()).collect();
    let ordered = |a: Mat<f64>| Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(order[i], order[j])]);
    let (k, m) = in_gap_coordinates(pencil, penalties);
    (ordered(k), ordered(m))
}

/// The congruence u_node = u_kept +- q: row and column `node` are added to row and column `kept`. The sign of q only
/// flips the sign of the off-diagonal entries of q, which leaves the spectrum alone.
fn add_row_and_column(matrix: &mut Mat<f64>, node: usize, kept: usize) {
    for j in 0..matrix.ncols() {
        matrix[(kept, j)] += matrix[(node, j)];
    }
    for i in 0..matrix.nrows() {
        matrix[(i, kept)] += matrix[(i, node)];
    }
}

fn dense(matrix: &Tridiagonal) -> Mat<f64> {
    let n = matrix.diagonal.len();
    Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => matrix.diagonal[i],
        1 => matrix.off_diagonal[i.min(j)],
        _ => 0.0,
    })
}

/// The largest eigenvalue of K x = l M x through L^-1 K L^-T, M = L L'.
fn largest(mut k: Mat<f64>, m: &Mat<f64>) -> Option<f64> {
    let factor = Llt::new(m.as_ref(), Side::Lower).ok()?;
    let lower = factor.L();
    solve_lower_triangular_in_place(lower, k.as_mut(), Par::Seq);
    let mut transposed = k.transpose().to_owned();
    solve_lower_triangular_in_place(lower, transposed.as_mut(), Par::Seq);
    let eigenvalues = transposed.self_adjoint_eigenvalues(Side::Lower).ok()?;
    eigenvalues.last().copied()
}
