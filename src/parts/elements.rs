//! The elements of a mesh by their matrices.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::convex::{self, patches::ElementMatrices};
use crate::error::Refusal;
use crate::memory;
use crate::mesh::{self, HELD};

/// The elements of a mesh as patches and parts take them: the matrices of translates once.
///
/// # Errors
/// A Jacobian determinant that is not positive; matrices of elements that are all different, beyond memory.
pub fn elements(mesh: &mesh::Elements) -> Result<convex::Elements, Refusal> {
    let mut numbers: HashMap<usize, usize> = HashMap::new();
    let mut different = Vec::new();
    for e in 0..mesh.len() {
        let alike = mesh.alike(e);
        numbers.entry(alike).or_insert_with(|| {
            different.push(alike);
            different.len() - 1
        });
    }
    let size = |e: &usize| (mesh.nodes(*e).len() * mesh.dimension) as u64;
    let bytes: u64 = different.iter().map(|e| 16 * size(e) * size(e)).sum();
    let count = format!("{} elements that differ", different.len());
    memory::require(("patches", &count), "matrices", bytes, |_| "a mesh file of fewer elements".to_owned())?;
    let shapes = different.par_iter().map(|e| shape(mesh, *e)).collect::<Result<_, Refusal>>()?;
    let unknowns = |e: usize| mesh.dofs(e).iter().map(|dof| (*dof != HELD).then_some(*dof)).collect();
    let elements = (0..mesh.len()).map(|e| (numbers[&mesh.alike(e)], unknowns(e))).collect();
    Ok(convex::Elements { shapes, elements })
}

/// K_e, and the mass of each direction.
fn shape(mesh: &mesh::Elements, e: usize) -> Result<ElementMatrices, Refusal> {
    let (stiffness, nodal) = mesh.matrices(e)?;
    let (n, d) = (mesh.nodes(e).len(), mesh.dimension);
    let size = n * d;
    let mut mass = vec![0.0; size * size];
    for (at, m) in nodal.iter().enumerate() {
        let (a, b) = (at / n, at % n);
        (0..d).for_each(|i| mass[(a * d + i) * size + b * d + i] = *m);
    }
    Ok(ElementMatrices { stiffness, mass })
}
