//! Unknowns at rest, with contacts that push and never pull.
//!
//! ```text
//! 0 = f - K u - Z lambda   in the rows of these unknowns      0 <= lambda   perpendicular to   g = Z'u + g0 <= 0
//! ```
//! All other unknowns are where they are. Without contact the unknowns were at u_c + K_cc^-1 (f - K u)_c, and gaps g there; then
//! W lambda - g >= 0, W = Z_c' K_cc^-1 Z_c, is a linear complementarity problem. The minimum over these unknowns of u'Ku/2 - f'u
//! under g <= 0 is a convex function of the others with a continuous slope, and its second derivative is at most K of them.

use faer::linalg::solvers::{Llt, Solve};
use faer::sparse::linalg::solvers::Llt as SparseLlt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{ColMut, Mat, Side};

use super::ContactRule;
use super::complementarity::Complementarity;
use crate::error::Refusal;
use crate::pencil::{Gap, Matrix};
use crate::sparse::SparseVector;

/// A row of K as sum_j k_ij (u_j - u_i) + ground u_i: a translation along an only direction gives no force at all.
#[derive(Debug, Clone)]
struct Row {
    unknown: usize,
    beside: Vec<(usize, f64)>,
    ground: f64,
}

impl Row {
    fn force(&self, u: &[f64]) -> f64 {
        let here = u[self.unknown];
        self.beside.iter().map(|(j, k)| k * (u[*j] - here)).sum::<f64>() + self.ground * here
    }
}

/// Where some unknowns of a pencil are at rest, for any place of the others.
#[derive(Debug, Clone)]
pub struct Equilibrium {
    rows: Vec<Row>,
    gaps: Vec<Gap>,
    /// z_j at the unknowns at rest, by their number among these.
    columns: Vec<SparseVector>,
    factor: SparseLlt<usize, f64>,
    law: Complementarity,
    all: Vec<bool>,
    right: Vec<f64>,
}

impl Equilibrium {
    /// `unknowns` at rest, ascending, under K (N/m) and contacts.
    ///
    /// # Errors
    /// A contact at none of these unknowns; unknowns that move without strain; contacts that say the same twice.
    pub fn new(stiffness: &Matrix, gaps: &[Gap], unknowns: &[usize]) -> Result<Self, Refusal> {
        let mut local = vec![u32::MAX; stiffness.size()];
        unknowns.iter().enumerate().for_each(|(at, i)| local[*i] = at as u32);
        let columns: Vec<SparseVector> = gaps.iter().map(|gap| within(&gap.column, &local)).collect();
        if let Some(j) = columns.iter().position(|column| column.0.is_empty()) {
            let (place, allowed) = (format!("contact {}", j + 1), "a contact at an unknown that may move");
            return Err(Refusal::new(place, "all its unknowns prescribed", allowed));
        }
        let factor = factor(stiffness, unknowns, &local)?;
        let law = Complementarity::of(flexibility(&factor, &columns, unknowns.len())?);
        let row = |i: &usize| {
            let beside = stiffness.row(*i).filter(|(j, k)| j != i && *k != 0.0);
            let beside: Vec<(usize, f64)> = beside.collect();
            let ground = stiffness.diagonal(*i) + beside.iter().map(|(_, k)| k).sum::<f64>();
            Row { unknown: *i, beside, ground }
        };
        let rows = unknowns.iter().map(row).collect();
        let (all, right) = (vec![true; gaps.len()], vec![0.0; unknowns.len()]);
        Ok(Self { rows, gaps: gaps.to_vec(), columns, factor, law, all, right })
    }

    /// Moves the unknowns of u (m) to where they rest under the nodal forces f (`load`, N, as long as u, or empty for none).
    /// lambda (`force`, N) and the gaps (m), 0 where a contact is closed.
    pub fn settle(
        &mut self,
        load: &[f64],
        rule: ContactRule,
        u: &mut [f64],
        force: &mut [f64],
        gap: &mut [f64],
    ) {
        for (right, row) in self.right.iter_mut().zip(&self.rows) {
            *right = load.get(row.unknown).copied().unwrap_or(0.0) - row.force(u);
        }
        self.move_by_right(u, 1.0);
        let across = |gap: &Gap, u: &[f64]| gap.column.dot(u) + gap.initial;
        gap.iter_mut().zip(&self.gaps).for_each(|(g, of)| *g = across(of, u));
        match rule {
            ContactRule::Unilateral => self.law.push(gap, &self.all, force),
            ContactRule::HeldClosed => self.law.hold(gap, &self.all, force),
            ContactRule::HeldOpen => force.fill(0.0),
        }
        self.right.fill(0.0);
        for (column, lambda) in self.columns.iter().zip(&*force).filter(|(_, lambda)| **lambda != 0.0) {
            column.0.iter().for_each(|(at, z)| self.right[*at as usize] += z * lambda);
        }
        self.move_by_right(u, -1.0);
        for (j, g) in gap.iter_mut().enumerate() {
            let closed = force[j] != 0.0 || rule == ContactRule::HeldClosed;
            *g = if closed { 0.0 } else { across(&self.gaps[j], u) };
        }
    }

    /// u_c += sign K_cc^-1 `right`.
    fn move_by_right(&mut self, u: &mut [f64], sign: f64) {
        if !self.right.is_empty() {
            self.factor.solve_in_place(ColMut::from_slice_mut(&mut self.right).as_mat_mut());
        }
        self.rows.iter().zip(&self.right).for_each(|(row, by)| u[row.unknown] += sign * by);
    }
}

/// The entries of z at the unknowns that have a number here.
fn within(z: &SparseVector, local: &[u32]) -> SparseVector {
    let entry = |(i, z): &(u32, f64)| (local[*i as usize], *z);
    SparseVector(z.0.iter().map(entry).filter(|(at, _)| *at != u32::MAX).collect())
}

/// The Cholesky factor of K_cc.
fn factor(k: &Matrix, unknowns: &[usize], local: &[u32]) -> Result<SparseLlt<usize, f64>, Refusal> {
    let refused = |why: String| {
        Refusal::new(
            "unknowns at rest",
            why,
            "a stiffness that resists every motion of them, and fits into memory",
        )
    };
    let lower = |(at, i): (usize, &usize)| {
        let row = k.row(*i).filter(|(j, _)| local[*j] != u32::MAX);
        row.map(move |(j, k)| Triplet::new(at, local[j] as usize, k)).filter(|t| t.col <= t.row)
    };
    let triplets: Vec<_> = unknowns.iter().enumerate().flat_map(lower).collect();
    let (n, why) = (unknowns.len(), |e: &dyn std::fmt::Debug| refused(format!("{e:?}")));
    let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets);
    matrix.map_err(|e| why(&e))?.sp_cholesky(Side::Lower).map_err(|e| why(&e))
}

/// W = Z_c' K_cc^-1 Z_c, m/N.
fn flexibility(
    factor: &SparseLlt<usize, f64>,
    columns: &[SparseVector],
    n: usize,
) -> Result<Mat<f64>, Refusal> {
    let k = columns.len();
    let mut w = Mat::zeros(k, k);
    let mut x = vec![0.0; n];
    for (j, column) in columns.iter().enumerate() {
        x.fill(0.0);
        column.0.iter().for_each(|(at, z)| x[*at as usize] = *z);
        factor.solve_in_place(ColMut::from_slice_mut(&mut x).as_mat_mut());
        (0..k).for_each(|i| w[(i, j)] = columns[i].dot(&x));
    }
    let symmetric = Mat::from_fn(k, k, |i, j| 0.5 * (w[(i, j)] + w[(j, i)]));
    if k > 0 && Llt::new(symmetric.as_ref(), Side::Lower).is_err() {
        let allowed = "gaps none of which is a combination of others";
        return Err(Refusal::new("contacts", format!("{k} that depend on each other"), allowed));
    }
    Ok(symmetric)
}
