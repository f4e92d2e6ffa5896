//! The meeting point of elements and everything that works on matrices: a symmetric pencil with contact terms.
//!
//! ```text
//! K + K_p - l (M + M_p)      K_p = beta_s P      M_p = K_p/(r omega^2)      P = sum_j w_j z_j z_j'      l = omega^2
//! ```
//! K and M (n x n, positive semidefinite and definite) come from any linear mesh. z_j is the gap of contact j, w_j its
//! scale, and omega one reference frequency: so a [`Penalty`] is two numbers for all contacts together. The contact terms
//! are kept apart from K and M: summed, `K_nn + s` would lose K at s = 1e16 K, and a map needs K and M only once.
//!
//! A row of bars can do more than any mesh: its pencil has a [`ChainPencil`], the type that such algorithms ask for.
//!
//! ```
//! use bipenalty::pencil::{Bounds, Gap, Matrix, Pencil};
//! use bipenalty::sparse::{Csr, SparseVector};
//! // Two masses of 1 kg on a spring of 1 N/m; the second may touch a wall. Rows of |K| sum to 2 N/m.
//! let k = Csr::from_triplets(2, 2, &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)]);
//! let gap = Gap { column: SparseVector(vec![(1, 1.0)]), scale: 1.0, initial: 0.0 };
//! let bounds = Bounds { stiffness: 2.0, mass: 1.0 };
//! let pencil = Pencil::new(Matrix::Sparse(k), Matrix::Diagonal(vec![1.0; 2]), vec![gap], bounds, 2.0)?;
//! assert_eq!((pencil.size(), pencil.gaps().len()), (2, 1));
//! # Ok::<(), bipenalty::error::Refusal>(())
//! ```

mod blocks;
mod bounds;
mod chain;
mod check;
mod heirs;
mod matrix;
mod penalty;

use std::sync::Arc;

pub use bounds::Bounds;
pub use chain::{BarRows, ChainPencil, EndGap, Scale, contact_sum};
pub use heirs::Heirs;
pub use matrix::{Matrix, Tridiagonal, last_pivot};
pub use penalty::{Penalty, PenaltyMass, Terms};

pub(crate) use check::{gaps as check_gaps, matrices as check_matrices};

use crate::error::Refusal;
use crate::sparse::SparseVector;

/// A contact: where it acts, and what its penalty is measured in.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// z, dimensionless: the gap is g = z'u + g0, positive in penetration.
    pub column: SparseVector,
    /// w, N/m: the stiffness penalty is s = beta_s w.
    pub scale: f64,
    /// g0, m: minus the initial distance.
    pub initial: f64,
}

/// The contact-free pencil (K, M), its contacts, and bounds of its entries. Cheap to clone: the matrices are shared.
#[derive(Debug, Clone, PartialEq)]
pub struct Pencil(Arc<Parts>);

#[derive(Debug, PartialEq)]
struct Parts {
    stiffness: Matrix,
    mass: Matrix,
    gaps: Vec<Gap>,
    bounds: Bounds,
    reference: f64,
    cuts: Option<chain::Cuts>,
    heirs: Option<Heirs>,
}

impl Pencil {
    /// The pencil of K (N/m) and M (kg), n x n, with its contacts; those of a chain run from left to right. `reference`
    /// is omega^2, rad^2/s^2, in which the ratio of the penalty mass is measured.
    ///
    /// # Errors
    /// Sizes that do not fit, entries that are not finite, a matrix that is not symmetric, a mass that is not positive
    /// definite, `bounds` that do not hold, a gap that is empty, zero or out of range, a scale or a reference that is not
    /// positive.
    pub fn new(
        stiffness: Matrix,
        mass: Matrix,
        gaps: Vec<Gap>,
        bounds: Bounds,
        reference: f64,
    ) -> Result<Self, Refusal> {
        let pencil = Self::of_checked_elements(stiffness, mass, gaps, bounds, reference)?;
        bounds.check(pencil.stiffness(), pencil.mass())?;
        Ok(pencil)
    }

    /// As [`Pencil::new`] for matrices whose bounds are those of their elements.
    pub(crate) fn of_checked_elements(
        stiffness: Matrix,
        mass: Matrix,
        gaps: Vec<Gap>,
        bounds: Bounds,
        reference: f64,
    ) -> Result<Self, Refusal> {
        check::matrices(&stiffness, &mass)?;
        check::gaps(&gaps, stiffness.size())?;
        check::positive("reference", reference, "rad^2/s^2")?;
        Ok(Self::of_elements(stiffness, mass, gaps, bounds, reference))
    }

    /// The pencil of matrices that were assembled from elements, each of which is known to obey `bounds` and to have a
    /// positive definite mass: sums of them do too.
    pub(crate) fn of_elements(
        stiffness: Matrix,
        mass: Matrix,
        gaps: Vec<Gap>,
        bounds: Bounds,
        reference: f64,
    ) -> Self {
        let mass = match (&stiffness, mass) {
            (Matrix::Chain(k), Matrix::Diagonal(diagonal)) => {
                Matrix::Chain(Tridiagonal { diagonal, off_diagonal: vec![0.0; k.off_diagonal.len()] })
            }
            (_, mass) => mass,
        };
        let cuts = match (&stiffness, &mass) {
            (Matrix::Chain(k), Matrix::Chain(m)) => chain::Cuts::new(k, m, &gaps, bounds.stiffness),
            _ => None,
        };
        Self(Arc::new(Parts { stiffness, mass, gaps, bounds, reference, cuts, heirs: None }))
    }

    /// Number of unknowns n.
    pub fn size(&self) -> usize {
        self.0.stiffness.size()
    }

    /// K, N/m.
    pub fn stiffness(&self) -> &Matrix {
        &self.0.stiffness
    }

    /// M, kg.
    pub fn mass(&self) -> &Matrix {
        &self.0.mass
    }

    /// The contacts.
    pub fn gaps(&self) -> &[Gap] {
        &self.0.gaps
    }

    /// Bounds of the entries of K and M relative to M; no contact-free eigenvalue exceeds that of K.
    pub fn bounds(&self) -> Bounds {
        self.0.bounds
    }

    /// omega^2, rad^2/s^2: the penalty of ratio r has the rate r omega^2.
    pub fn reference(&self) -> f64 {
        self.0.reference
    }

    /// The same matrices and contacts, closed at rest: g0 = 0.
    pub fn at_rest(&self) -> Self {
        let gaps = self.0.gaps.iter().map(|gap| Gap { initial: 0.0, ..gap.clone() }).collect();
        self.with_gaps(gaps)
    }

    /// The same matrices with gaps that have been checked.
    pub(crate) fn with_gaps(&self, gaps: Vec<Gap>) -> Self {
        let parts = &*self.0;
        let (stiffness, mass) = (parts.stiffness.clone(), parts.mass.clone());
        let pencil = Self::of_elements(stiffness, mass, gaps, parts.bounds, parts.reference);
        // Columns do not change with g0, and with them the nodes in contact.
        parts.heirs.clone().map_or(pencil.clone(), |heirs| pencil.with_heirs(heirs))
    }

    /// The same pencil with what its mesh knows of the nodes in contact.
    pub(crate) fn with_heirs(self, heirs: Heirs) -> Self {
        let parts = &*self.0;
        Self(Arc::new(Parts {
            stiffness: parts.stiffness.clone(),
            mass: parts.mass.clone(),
            gaps: parts.gaps.clone(),
            cuts: None,
            heirs: Some(heirs),
            ..*parts
        }))
    }

    /// Where the mass of nodes in contact may go, of meshes.
    pub fn heirs(&self) -> Option<&Heirs> {
        self.0.heirs.as_ref()
    }

    /// The same stiffness with another positive definite mass, and bounds that are no longer known to hold.
    pub(crate) fn with_mass(&self, mass: Matrix) -> Self {
        let parts = &*self.0;
        Self::of_elements(parts.stiffness.clone(), mass, parts.gaps.clone(), parts.bounds, parts.reference)
    }

    /// The pencil as a row of bars, if it is one.
    pub fn chain(&self) -> Option<ChainPencil<'_>> {
        match (&self.0.stiffness, &self.0.mass, &self.0.cuts) {
            (Matrix::Chain(stiffness), Matrix::Chain(mass), Some(cuts)) => {
                Some(ChainPencil { pencil: self, stiffness, mass, cuts })
            }
            _ => None,
        }
    }
}
