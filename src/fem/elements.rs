//! Elements of any kind: what a mesh is assembled from when it is no row of bars.

use crate::error::Refusal;
use crate::pencil::{Bounds, Gap, Matrix, Pencil};
use crate::sparse::Csr;

/// A linear element: the unknowns that it joins, and its matrices.
pub trait FiniteElement {
    /// The unknowns, p of them.
    fn unknowns(&self) -> Vec<u32>;

    /// K_e (N/m) and M_e (kg), p x p, symmetric, row by row.
    fn matrices(&self) -> (Vec<f64>, Vec<f64>);
}

/// The pencil of `size` unknowns with its contacts. The bounds are the largest of the elements', since what each element
/// obeys, their sum does; the reference is omega^2 of the ratio, rad^2/s^2, or without one the bound of the stiffness.
///
/// # Errors
/// An element whose matrices have the wrong size, are not symmetric and finite, or whose mass is not positive definite; an
/// unknown that no element reaches; what [`Pencil::new`] refuses of gaps and reference.
pub fn assemble_elements(
    size: usize,
    elements: &[&dyn FiniteElement],
    gaps: Vec<Gap>,
    reference: Option<f64>,
) -> Result<Pencil, Refusal> {
    let (mut stiffness, mut mass) = (Vec::new(), Vec::new());
    let mut bounds = Bounds { stiffness: f64::MIN_POSITIVE, mass: 1.0 };
    for (e, element) in elements.iter().enumerate() {
        let (unknowns, (k, m)) = (element.unknowns(), element.matrices());
        let own = Bounds::of_element(&k, &m, unknowns.len()).ok_or_else(|| {
            let allowed =
                "symmetric finite matrices of the size of the unknowns, and a positive definite mass";
            Refusal::new(format!("element {e}"), "its matrices", allowed)
        })?;
        if let Some(outside) = unknowns.iter().find(|i| **i as usize >= size) {
            return Err(Refusal::new(format!("element {e}"), outside, format!("unknowns below {size}")));
        }
        bounds = bounds.or(own);
        for (entries, matrix) in [(&k, &mut stiffness), (&m, &mut mass)] {
            let places = unknowns.iter().flat_map(|i| unknowns.iter().map(move |j| (*i, *j)));
            let nonzero = places.zip(entries).filter(|((i, j), a)| i == j || **a != 0.0);
            matrix.extend(nonzero.map(|((i, j), a)| (i, j, *a)));
        }
    }
    let (k, m) = (Csr::from_triplets(size, size, &stiffness), Csr::from_triplets(size, size, &mass));
    let lumped = m.len() == size && (0..size).all(|i| m.get(i, i) != 0.0);
    let m =
        if lumped { Matrix::Diagonal((0..size).map(|i| m.get(i, i)).collect()) } else { Matrix::Sparse(m) };
    Pencil::of_checked_elements(Matrix::Sparse(k), m, gaps, bounds, reference.unwrap_or(bounds.stiffness))
}
