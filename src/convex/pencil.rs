//! The pencil of any mesh as the curve needs it: K, M and the contacts, and nothing of how large they are.

use std::sync::Arc;

use super::vectors::dot;
use crate::error::Refusal;
use crate::pencil::{Gap, Matrix, Pencil, check_gaps, check_matrices};

/// K, M and P = sum_j w_j z_j z_j' of a mesh. Unlike a [`Pencil`] it needs no bounds of its entries, since the curve
/// proves its own, and no reference, since f(0) is that of a mesh.
/// Cheap to clone: the matrices are shared.
#[derive(Debug, Clone)]
pub struct MeshPencil(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    stiffness: Matrix,
    mass: Matrix,
    contacts: Vec<Gap>,
    /// diag(M), which scales rows and bounds rounding.
    diagonal: Vec<f64>,
}

impl From<&Pencil> for MeshPencil {
    fn from(pencil: &Pencil) -> Self {
        Self::of_checked(pencil.stiffness().clone(), pencil.mass().clone(), pencil.gaps().to_vec())
    }
}

impl MeshPencil {
    /// The pencil of a stiffness matrix (symmetric), a mass matrix and contacts.
    ///
    /// That K is semidefinite is not needed by any bound for t >= 0 or t < 0 alike; that M is definite is proven
    /// where a bound is proven, since u M - K - t P is then semidefinite for one u and for every larger one.
    ///
    /// # Errors
    /// Sizes that do not fit, numbers that are not finite, matrices that are not symmetric to the last bit, a mass
    /// that is not positive on the diagonal, a gap that is empty, zero or out of range, a scale that is not positive.
    pub fn new(stiffness: Matrix, mass: Matrix, contacts: Vec<Gap>) -> Result<Self, Refusal> {
        check_matrices(&stiffness, &mass)?;
        check_gaps(&contacts, stiffness.size())?;
        Ok(Self::of_checked(stiffness, mass, contacts))
    }

    fn of_checked(stiffness: Matrix, mass: Matrix, contacts: Vec<Gap>) -> Self {
        let diagonal = (0..mass.size()).map(|i| mass.diagonal(i)).collect();
        Self(Arc::new(Parts { stiffness, mass, contacts, diagonal }))
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.0.diagonal.len()
    }

    /// K.
    pub fn stiffness(&self) -> &Matrix {
        &self.0.stiffness
    }

    /// M.
    pub fn mass(&self) -> &Matrix {
        &self.0.mass
    }

    /// The contacts.
    pub fn contacts(&self) -> &[Gap] {
        &self.0.contacts
    }

    /// diag(M).
    pub fn mass_diagonal(&self) -> &[f64] {
        &self.0.diagonal
    }

    /// y = (a K + t P) x.
    pub fn multiply(&self, a: f64, t: f64, x: &[f64], y: &mut [f64]) {
        if a == 0.0 {
            y.fill(0.0);
        } else {
            self.0.stiffness.multiply(x, y);
            if a != 1.0 {
                y.iter_mut().for_each(|y| *y *= a);
            }
        }
        if t != 0.0 {
            for contact in &self.0.contacts {
                contact.column.add_to(t * contact.scale * contact.column.dot(x), y);
            }
        }
    }

    /// y = M x.
    pub fn multiply_mass(&self, x: &[f64], y: &mut [f64]) {
        self.0.mass.multiply(x, y);
    }

    /// The Rayleigh quotients x'Kx/x'Mx and x'Px/x'Mx, in plain arithmetic.
    pub fn quotients(&self, x: &[f64]) -> (f64, f64) {
        let mut y = vec![0.0; self.size()];
        self.multiply_mass(x, &mut y);
        let mass = dot(x, &y);
        self.0.stiffness.multiply(x, &mut y);
        let penalty: f64 = self.0.contacts.iter().map(|c| c.scale * c.column.dot(x).powi(2)).sum();
        (dot(x, &y) / mass, penalty / mass)
    }
}
