//! What every curve of a pencil begins with: f(0), the square of the largest frequency without contact.

use super::curve::Options;
use super::lanczos::{Search, largest};
use super::operator::Operator;
use super::pencil::MeshPencil;
use super::subspace::Subspace;
use crate::error::Refusal;

/// |A x - theta M x| over theta of mu and f(0): no eigenvalue is farther off, and most are nearer by the square, over their
/// distance to the next. One number, so that f(0) does not depend on what is asked afterwards: it is the reference of
/// meshes.
pub(super) const TOLERANCE: f64 = 1e-8;

/// How closely f(0) is proven by a factorisation, as a width of the step: what is left widens every enclosure of a point.
pub(super) const CLOSEST: f64 = 1e-11;

/// How mu and f(0) are looked for.
pub(super) fn search(options: &Options) -> Search {
    Search { basis: options.basis, tolerance: TOLERANCE, most_products: options.most_products, closed: false }
}

/// The top of the contact-free pencil, found once for all provers.
#[derive(Debug, Clone)]
pub struct Start {
    pub(super) operator: Operator,
    pub(super) vector: Vec<f64>,
    mesh: f64,
}

impl Start {
    /// Finds the top vector of (K, M); the factor of M may take `options.memory` bytes.
    ///
    /// # Errors
    /// M is not positive definite, or its factor needs more memory.
    pub fn new(pencil: &MeshPencil, options: &Options) -> Result<Self, Refusal> {
        let operator = Operator::new(pencil, options.memory)?;
        let vector = largest(&operator, (1.0, 0.0), None, &search(options)).vector;
        let mut subspace = Subspace::new(pencil);
        subspace.add(&operator, &vector);
        let mesh = subspace.span().line(&subspace.span().ritz(0.0)).at(0.0);
        Ok(Self { operator, vector, mesh })
    }

    /// f(0) from below; the error is that of a Ritz value whose vector is right to some `TOLERANCE`.
    pub fn mesh(&self) -> f64 {
        self.mesh
    }
}
