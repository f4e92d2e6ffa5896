//! Matrices and meshes as a pencil that schemes step on.

use super::mesh::MeshModel;
use crate::error::Refusal;
use crate::pencil::{Bounds, Matrix, Pencil};

/// M is tried to exceed diag(M)/q for q up to this power of 2: consistent masses of the elements at hand need 2^3 to 2^6.
const MOST_HALVINGS: i32 = 12;

impl MeshModel {
    /// The pencil with its contacts at rest, and bounds of rounding that its matrices prove.
    ///
    /// # Errors
    /// As [`Pencil::new`]; a mass so near to singular that no bound is found.
    pub fn stepping_pencil(&self) -> Result<Pencil, Refusal> {
        let (stiffness, mass, gaps) = self.matrices();
        let diagonal = self.pencil().mass_diagonal();
        let reference = self.reference()?;
        let own = Bounds::of_lumped(stiffness, diagonal).stiffness;
        let heirs = self.mesh().map(|elements| elements.heirs(gaps)).transpose()?;
        let pencil = |q: f64, rows: f64| {
            let bounds = Bounds { stiffness: own * q, mass: (rows * q).max(1.0) };
            let pencil =
                Pencil::new(stiffness.clone(), mass.clone(), gaps.to_vec(), bounds, reference)?.at_rest();
            Ok(match &heirs {
                Some(heirs) => pencil.with_heirs(heirs.clone()),
                None => pencil,
            })
        };
        if mass.is_diagonal() {
            return pencil(1.0, 1.0);
        }
        let rows = largest_row(mass, diagonal);
        let mut found = pencil(2.0, rows);
        for power in 2..=MOST_HALVINGS {
            if found.is_ok() {
                break;
            }
            found = pencil(f64::from(power).exp2(), rows);
        }
        found
    }
}

/// max_i sum_j |m_ij|/m_ii.
fn largest_row(mass: &Matrix, diagonal: &[f64]) -> f64 {
    let row = |i: usize| mass.row(i).map(|(_, m)| m.abs()).sum::<f64>() / diagonal[i];
    (0..mass.size()).map(row).fold(1.0, f64::max)
}
