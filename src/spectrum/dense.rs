//! The dense engine: the pencil in gap coordinates, reduced to standard form with faer.
//!
//! Summed into K, a pair contact s (u_a - u_b)^2 drowns the common motion of its nodes: at s = 1e16 K nothing of K is
//! left. So one unknown of each gap is replaced by the gap itself, the lightest that no other gap moves: for a pair the
//! lighter node, u_b = u_a - q or u_a = u_b + q. The contact then sits on one diagonal entry, and the copied entries of the
//! lighter node disturb the heavier one by no more than rounding of l_max. A gap all of whose unknowns are shared with
//! others is summed; what that loses the enclosure shows.

use faer::Mat;

use super::proof;
use super::{Enclosure, Engine, Sturm, Uncertified, WIDEST_ENCLOSURE};
use crate::error::Refusal;
use crate::pencil::{Gap, Matrix, Penalty, PenaltyMass, Pencil};
use crate::symmetric::{Cholesky, eigenvalues};

/// More nodes than this are refused for the dense engine: one matrix would take over 3 GB and a point hours.
pub const MAX_DENSE_NODES: usize = 20_000;

/// The engine `dense`: O(n^3) operations and 16 n^2 bytes a point.
#[derive(Debug)]
pub struct Dense<'a> {
    pencil: &'a Pencil,
    sturm: Option<Sturm<'a>>,
}

impl<'a> Dense<'a> {
    /// The engine for `pencil`.
    ///
    /// # Errors
    /// Refuses more than [`MAX_DENSE_NODES`] unknowns.
    pub fn new(pencil: &'a Pencil) -> Result<Self, Refusal> {
        if pencil.size() > MAX_DENSE_NODES {
            let allowed = format!("at most {MAX_DENSE_NODES} nodes, or auto");
            return Err(Refusal::new("engine", format!("dense with {} nodes", pencil.size()), allowed));
        }
        Ok(Self { pencil, sturm: pencil.chain().map(Sturm::new) })
    }
}

impl Engine for Dense<'_> {
    fn name(&self) -> &'static str {
        "dense"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Enclosure, Uncertified> {
        let (k, m) = with_gaps_last(self.pencil, penalty);
        let Some(sturm) = &self.sturm else { return proof::enclose(&k, &m, roundings(self.pencil)) };
        // The error of the dense reduction has no sharp constant, so the value is proven by two Sturm counts; they
        // leave a tenth of the widest enclosure to the margin of their own rounding. Without a factor or without
        // convergence there is no value: NaN, which no certificate accepts.
        let value = largest(k, m).unwrap_or(f64::NAN);
        sturm.verify(penalty, value, 0.45 * WIDEST_ENCLOSURE)
    }
}

/// Unit roundoffs that an entry in gap coordinates has lost: each entry of the longest column adds one product and sum
/// on either side, the contact 3 more.
pub(super) fn roundings(pencil: &Pencil) -> f64 {
    let longest = pencil.gaps().iter().map(|gap| gap.column.0.len()).max().unwrap_or(0);
    (4 * longest + 8) as f64
}

/// K + K_p and M + M_p, dense n x n, with the [`replaced`] unknown of every gap that has one replaced by the gap.
pub fn in_gap_coordinates(
    pencil: &Pencil,
    penalty: &Penalty,
    replaced: &[Option<usize>],
) -> (Mat<f64>, Mat<f64>) {
    let mut k = dense(pencil.stiffness());
    let mut m = dense(pencil.mass());
    // The sizes of the terms of a gap: s, m and what the diagonalised form adds to each node instead of m.
    let terms = |gap: &Gap| {
        let (s, mass) = penalty.of(gap.scale);
        let spread = penalty.form == PenaltyMass::Diagonalised && gap.column.0.len() > 1;
        if spread { (s, 0.0, mass) } else { (s, mass, 0.0) }
    };
    for (gap, replaced) in pencil.gaps().iter().zip(replaced) {
        let (s, mass, spread) = terms(gap);
        let entries = || gap.column.0.iter().map(|(i, z)| (*i as usize, *z));
        let all: f64 = entries().map(|(_, z)| z.abs()).sum();
        entries().for_each(|(i, z)| m[(i, i)] += z.abs() * all * spread);
        if replaced.is_none() {
            for ((i, a), (j, b)) in entries().flat_map(|a| entries().map(move |b| (a, b))) {
                k[(i, j)] += s * a * b;
                m[(i, j)] += mass * a * b;
            }
        }
    }
    for (gap, node) in pencil.gaps().iter().zip(replaced).filter_map(|(gap, node)| Some((gap, (*node)?))) {
        // x_node = (q - sum z_i x_i)/z: a column of the congruence for each other entry.
        let own = gap.column.0.iter().find(|(i, _)| *i as usize == node).map_or(1.0, |(_, z)| *z);
        for (i, z) in gap.column.0.iter().filter(|(i, _)| *i as usize != node) {
            for matrix in [&mut k, &mut m] {
                add_row_and_column(matrix, node, *i as usize, -z / own);
            }
        }
        for matrix in [&mut k, &mut m] {
            scale_row_and_column(matrix, node, own.abs());
        }
    }
    for (gap, node) in pencil.gaps().iter().zip(replaced).filter_map(|(gap, node)| Some((gap, (*node)?))) {
        let (s, mass, _) = terms(gap);
        k[(node, node)] += s;
        m[(node, node)] += mass;
    }
    (k, m)
}

/// The unknown that each gap replaces: the lightest that no other gap moves.
pub fn replaced(pencil: &Pencil) -> Vec<Option<usize>> {
    let mut moved_by = vec![0_u32; pencil.size()];
    pencil.gaps().iter().flat_map(|gap| &gap.column.0).for_each(|(i, _)| moved_by[*i as usize] += 1);
    let lightest = |gap: &Gap| {
        let own = gap.column.0.iter().map(|(i, _)| *i as usize).filter(|i| moved_by[*i] == 1);
        own.reduce(|a, b| if pencil.mass().diagonal(b) < pencil.mass().diagonal(a) { b } else { a })
    };
    pencil.gaps().iter().map(lightest).collect()
}

/// As [`in_gap_coordinates`], with the gaps behind all other nodes. The tridiagonal reduction carries a gap that it
/// meets on its way, nearly decoupled by its penalties, past every later node, at a unit of rounding of l_max each;
/// at the end it stays where it is.
pub fn with_gaps_last(pencil: &Pencil, penalty: &Penalty) -> (Mat<f64>, Mat<f64>) {
    let replaced = replaced(pencil);
    let gaps: Vec<usize> = replaced.iter().copied().flatten().collect();
    let others = (0..pencil.size()).filter(|node| !gaps.contains(node));
    let order: Vec<usize> = others.chain(gaps.iter().copied()).collect();
    let ordered = |a: Mat<f64>| Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(order[i], order[j])]);
    let (k, m) = in_gap_coordinates(pencil, penalty, &replaced);
    (ordered(k), ordered(m))
}

/// The congruence u_node = q + factor u_kept: row and column `node` times `factor` are added to row and column `kept`.
/// The sign of q only flips the sign of its off-diagonal entries, which leaves the spectrum alone.
fn add_row_and_column(matrix: &mut Mat<f64>, node: usize, kept: usize, factor: f64) {
    for j in 0..matrix.ncols() {
        matrix[(kept, j)] += factor * matrix[(node, j)];
    }
    for i in 0..matrix.nrows() {
        matrix[(i, kept)] += factor * matrix[(i, node)];
    }
}

/// Row and column `node` over `divisor`.
fn scale_row_and_column(matrix: &mut Mat<f64>, node: usize, divisor: f64) {
    if divisor == 1.0 {
        return;
    }
    for i in 0..matrix.nrows() {
        matrix[(i, node)] /= divisor;
        matrix[(node, i)] /= divisor;
    }
}

fn dense(matrix: &Matrix) -> Mat<f64> {
    let n = matrix.size();
    let mut full = Mat::zeros(n, n);
    for i in 0..n {
        matrix.row(i).for_each(|(j, a)| full[(i, j)] = a);
    }
    full
}

/// The largest eigenvalue of K x = l M x.
fn largest(k: Mat<f64>, m: Mat<f64>) -> Option<f64> {
    eigenvalues(&Cholesky::new(m)?.standard_form(k))?.last().copied()
}
