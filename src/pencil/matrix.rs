//! Symmetric matrices in the forms that meshes give them.

use std::ops::{Div, Mul, Sub};

use crate::sparse::Csr;

/// A symmetric tridiagonal matrix, n x n.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tridiagonal {
    /// The n diagonal entries.
    pub diagonal: Vec<f64>,
    /// The n - 1 entries beside the diagonal.
    pub off_diagonal: Vec<f64>,
}

impl Tridiagonal {
    /// The zero matrix of n rows.
    pub fn zeros(n: usize) -> Self {
        Self { diagonal: vec![0.0; n], off_diagonal: vec![0.0; n.saturating_sub(1)] }
    }

    /// The entry left of the diagonal of row i, 0 in the first row.
    #[inline]
    pub fn left(&self, i: usize) -> f64 {
        if i > 0 { self.off_diagonal[i - 1] } else { 0.0 }
    }

    /// The entry right of the diagonal of row i, 0 in the last row.
    #[inline]
    pub fn right(&self, i: usize) -> f64 {
        self.off_diagonal.get(i).copied().unwrap_or(0.0)
    }

    /// y = A x, with x and y of length n.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        let n = self.diagonal.len();
        for i in 0..n {
            let left = if i > 0 { self.off_diagonal[i - 1] * x[i - 1] } else { 0.0 };
            let right = if i + 1 < n { self.off_diagonal[i] * x[i + 1] } else { 0.0 };
            y[i] = left + self.diagonal[i] * x[i] + right;
        }
    }

    fn quadratic(&self, x: &[f64], y: &[f64]) -> f64 {
        let own: f64 = (0..x.len()).map(|i| self.diagonal[i] * x[i] * y[i]).sum();
        let cross = |(i, off): (usize, &f64)| off * (x[i] * y[i + 1] + x[i + 1] * y[i]);
        own + self.off_diagonal.iter().enumerate().map(cross).sum::<f64>()
    }

    fn strain(&self, x: &[f64], y: &[f64]) -> f64 {
        let spring = |(i, off): (usize, &f64)| -off * (x[i + 1] - x[i]) * (y[i + 1] - y[i]);
        let springs: f64 = self.off_diagonal.iter().enumerate().map(spring).sum();
        let ground = |i: usize| (self.diagonal[i] + self.left(i) + self.right(i)) * x[i] * y[i];
        springs + (0..x.len()).map(ground).sum::<f64>()
    }
}

/// The last pivot of the elimination of rows one after another, from the pivot of the `first`. The others come as (own
/// entry, entry b beside the row before); a pivot d is followed by own - b (b/d). `None` as soon as `passes` says no to
/// a pivot and its share b/d, which it sees before the pivot is used.
#[inline]
pub fn last_pivot<T: Copy + Sub<Output = T> + Mul<Output = T> + Div<Output = T>>(
    first: T,
    rows: impl Iterator<Item = (T, T)>,
    mut passes: impl FnMut(T, T) -> bool,
) -> Option<T> {
    let mut pivot = first;
    for (own, off) in rows {
        let share = off / pivot;
        if !passes(pivot, share) {
            return None;
        }
        pivot = own - off * share;
    }
    Some(pivot)
}

/// A symmetric matrix, n x n.
#[derive(Debug, Clone, PartialEq)]
pub enum Matrix {
    /// Of a row of bars.
    Chain(Tridiagonal),
    /// Lumped.
    Diagonal(Vec<f64>),
    /// Of any mesh, both halves stored.
    Sparse(Csr),
}

impl Matrix {
    /// n.
    pub fn size(&self) -> usize {
        match self {
            Self::Chain(a) => a.diagonal.len(),
            Self::Diagonal(d) => d.len(),
            Self::Sparse(a) => a.rows(),
        }
    }

    /// Whether no entry off the diagonal differs from zero.
    pub fn is_diagonal(&self) -> bool {
        match self {
            Self::Chain(a) => a.off_diagonal.iter().all(|off| *off == 0.0),
            Self::Diagonal(_) => true,
            Self::Sparse(_) => (0..self.size()).all(|i| self.row(i).all(|(j, a)| i == j || a == 0.0)),
        }
    }

    /// The entry at (i, i).
    pub fn diagonal(&self, i: usize) -> f64 {
        match self {
            Self::Chain(a) => a.diagonal[i],
            Self::Diagonal(d) => d[i],
            Self::Sparse(a) => a.get(i, i),
        }
    }

    /// Columns and entries of row i, ascending.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (near, (columns, values)) = match self {
            Self::Chain(a) => {
                let left = (i > 0).then(|| (i - 1, a.left(i)));
                let right = (i + 1 < a.diagonal.len()).then(|| (i + 1, a.right(i)));
                ([left, Some((i, a.diagonal[i])), right], (&[][..], &[][..]))
            }
            Self::Diagonal(d) => ([Some((i, d[i])), None, None], (&[][..], &[][..])),
            Self::Sparse(a) => ([None; 3], a.row(i)),
        };
        let sparse = columns.iter().zip(values).map(|(j, a)| (*j as usize, *a));
        near.into_iter().flatten().chain(sparse)
    }

    /// y = A x; rows of a sparse matrix in parallel, with a result that does not depend on the number of threads.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        match self {
            Self::Chain(a) => a.multiply(x, y),
            Self::Diagonal(d) => y.iter_mut().zip(d).zip(x).for_each(|((y, d), x)| *y = d * x),
            Self::Sparse(a) => a.multiply(x, y),
        }
    }

    /// x'A y.
    pub fn quadratic(&self, x: &[f64], y: &[f64]) -> f64 {
        match self {
            Self::Chain(a) => a.quadratic(x, y),
            Self::Diagonal(d) => (0..x.len()).map(|i| d[i] * x[i] * y[i]).sum(),
            Self::Sparse(_) => {
                (0..x.len()).map(|i| x[i] * self.row(i).map(|(j, a)| a * y[j]).sum::<f64>()).sum()
            }
        }
    }

    /// x'A y without cancellation: what a rigid translation makes of it is far below what rounding would leave of numbers that
    /// grow with its square. Tridiagonal matrices are summed by differences, sparse ones with twice the digits.
    pub fn strain(&self, x: &[f64], y: &[f64]) -> f64 {
        match self {
            Self::Chain(a) => a.strain(x, y),
            Self::Diagonal(_) => self.quadratic(x, y),
            Self::Sparse(a) => a.quadratic(x, y),
        }
    }
}
