//! M^-1 for every form of M, factored once.

use faer::sparse::Triplet;

use super::twisted::Twisted;
use crate::error::Refusal;
use crate::pencil::Matrix;
use crate::sparse::SparseVector;
use crate::symmetric::SparseCholesky;

/// r -> scale M^-1 r.
#[derive(Debug, Clone)]
pub(super) enum Inertia {
    /// scale/M_ii.
    Lumped(Vec<f64>),
    /// Of a row of bars.
    Bars(Twisted),
    /// Of any other mesh.
    Factored { factor: SparseCholesky, scale: f64 },
}

impl Inertia {
    pub(super) fn new(mass: &Matrix, scale: f64) -> Result<Self, Refusal> {
        let n = mass.size();
        if let Matrix::Chain(mass) = mass {
            return Ok(Self::Bars(Twisted::new(mass, scale)));
        }
        if mass.is_diagonal() {
            return Ok(Self::Lumped((0..n).map(|i| scale / mass.diagonal(i)).collect()));
        }
        let lower =
            |i: usize| mass.row(i).filter(move |(j, _)| *j <= i).map(move |(j, a)| Triplet::new(i, j, a));
        let triplets: Vec<_> = (0..n).flat_map(lower).collect();
        let refused =
            |why: String| Refusal::new("mass", why, "a positive definite matrix that can be factored");
        Ok(Self::Factored { factor: SparseCholesky::new(n, &triplets).map_err(refused)?, scale })
    }

    /// Whether M is diagonal and not that of a row of bars.
    pub(super) fn is_lumped(&self) -> bool {
        matches!(self, Self::Lumped(_))
    }

    /// As [`Self::solve`] for an r that is zero beside `column`.
    pub(super) fn solve_column(&self, column: &SparseVector, r: &mut [f64]) {
        match self {
            Self::Lumped(inverse) => {
                column.0.iter().for_each(|(i, _)| r[*i as usize] *= inverse[*i as usize])
            }
            Self::Bars(_) | Self::Factored { .. } => self.solve(r),
        }
    }

    /// r <- scale M^-1 r.
    pub(super) fn solve(&self, r: &mut [f64]) {
        match self {
            Self::Lumped(inverse) => r.iter_mut().zip(inverse).for_each(|(r, inverse)| *r *= inverse),
            Self::Bars(mass) => mass.solve(r),
            Self::Factored { factor, scale } => {
                factor.solve(r);
                r.iter_mut().for_each(|r| *r *= scale);
            }
        }
    }
}
