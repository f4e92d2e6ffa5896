//! The pencil of any mesh: K, M and the contacts, checked once.

use super::vectors::dot;
use crate::error::Refusal;
use crate::sparse::{Csr, SparseVector};

/// The mass matrix M, symmetric positive definite.
#[derive(Debug, Clone, PartialEq)]
pub enum Mass {
    /// A lumped mass matrix: its diagonal.
    Diagonal(Vec<f64>),
    /// Any other, stored whole.
    Sparse(Csr),
}

/// One contact: its gap z'u and its scale w, so that the stiffness penalty is s_j = beta_s w_j.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaledGap {
    /// z_j.
    pub gap: SparseVector,
    /// w_j > 0.
    pub scale: f64,
}

/// K, M and P = sum_j w_j z_j z_j' of a mesh.
#[derive(Debug, Clone)]
pub struct MeshPencil {
    stiffness: Csr,
    mass: Mass,
    contacts: Vec<ScaledGap>,
    /// diag(M), which scales rows and bounds rounding.
    diagonal: Vec<f64>,
}

impl MeshPencil {
    /// The pencil of a stiffness matrix (symmetric semidefinite, stored whole), a mass matrix and contacts.
    ///
    /// That K is semidefinite is not needed by any bound for t >= 0 or t < 0 alike; that M is definite is proven
    /// where a bound is proven, since u M - K - t P is then semidefinite for one u and for every larger one.
    ///
    /// # Errors
    /// Sizes that do not fit, numbers that are not finite, matrices that are not symmetric to the last bit, a mass
    /// that is not positive on the diagonal, a gap without entries, a scale that is not positive.
    pub fn new(stiffness: Csr, mass: Mass, contacts: Vec<ScaledGap>) -> Result<Self, Refusal> {
        let n = stiffness.rows();
        check_symmetric("stiffness matrix", &stiffness, n)?;
        let diagonal = match &mass {
            Mass::Diagonal(diagonal) => diagonal.clone(),
            Mass::Sparse(mass) => {
                check_symmetric("mass matrix", mass, n)?;
                (0..n).map(|i| mass.get(i, i)).collect()
            }
        };
        if diagonal.len() != n {
            return Err(Refusal::new(
                "mass matrix",
                format!("{} rows", diagonal.len()),
                format!("{n} rows, as the stiffness matrix has"),
            ));
        }
        if let Some(i) = diagonal.iter().position(|m| !(*m > 0.0 && m.is_finite())) {
            return Err(Refusal::new(
                format!("mass matrix, row {}", i + 1),
                diagonal[i],
                "a positive diagonal",
            ));
        }
        for (j, contact) in contacts.iter().enumerate() {
            check_contact(j, contact, n)?;
        }
        Ok(Self { stiffness, mass, contacts, diagonal })
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.diagonal.len()
    }

    /// K.
    pub fn stiffness(&self) -> &Csr {
        &self.stiffness
    }

    /// M.
    pub fn mass(&self) -> &Mass {
        &self.mass
    }

    /// The contacts.
    pub fn contacts(&self) -> &[ScaledGap] {
        &self.contacts
    }

    /// diag(M).
    pub fn mass_diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// y = (a K + t P) x.
    pub fn multiply(&self, a: f64, t: f64, x: &[f64], y: &mut [f64]) {
        if a == 0.0 {
            y.fill(0.0);
        } else {
            self.stiffness.multiply(x, y);
            if a != 1.0 {
                y.iter_mut().for_each(|y| *y *= a);
            }
        }
        if t != 0.0 {
            for contact in &self.contacts {
                contact.gap.add_to(t * contact.scale * contact.gap.dot(x), y);
            }
        }
    }

    /// y = M x.
    pub fn multiply_mass(&self, x: &[f64], y: &mut [f64]) {
        match &self.mass {
            Mass::Diagonal(m) => y.iter_mut().zip(x).zip(m).for_each(|((y, x), m)| *y = m * x),
            Mass::Sparse(m) => m.multiply(x, y),
        }
    }

    /// The Rayleigh quotients x'Kx/x'Mx and x'Px/x'Mx, in plain arithmetic.
    pub fn quotients(&self, x: &[f64]) -> (f64, f64) {
        let mut y = vec![0.0; self.size()];
        self.multiply_mass(x, &mut y);
        let mass = dot(x, &y);
        self.stiffness.multiply(x, &mut y);
        let penalty: f64 = self.contacts.iter().map(|c| c.scale * c.gap.dot(x).powi(2)).sum();
        (dot(x, &y) / mass, penalty / mass)
    }
}

fn check_symmetric(name: &str, matrix: &Csr, n: usize) -> Result<(), Refusal> {
    if matrix.rows() != n || matrix.columns() != n {
        let sizes = format!("{} x {}", matrix.rows(), matrix.columns());
        return Err(Refusal::new(name, sizes, format!("{n} x {n}")));
    }
    for i in 0..n {
        let (columns, values) = matrix.row(i);
        for (column, value) in columns.iter().zip(values) {
            let place = || format!("{name}, row {}, column {}", i + 1, column + 1);
            if !value.is_finite() {
                return Err(Refusal::new(place(), value, "finite numbers"));
            }
            let mirrored = matrix.get(*column as usize, i);
            if *value != mirrored {
                return Err(Refusal::new(
                    place(),
                    value,
                    format!("a symmetric matrix; its mirror image is {mirrored}"),
                ));
            }
        }
    }
    Ok(())
}

fn check_contact(j: usize, contact: &ScaledGap, n: usize) -> Result<(), Refusal> {
    let place = format!("contact {}", j + 1);
    if !(contact.scale > 0.0 && contact.scale.is_finite()) {
        return Err(Refusal::new(place, contact.scale, "a positive scale"));
    }
    let entries = &contact.gap.0;
    if !entries.iter().any(|(_, z)| *z != 0.0) {
        return Err(Refusal::new(place, "a gap without entries", "at least one entry that is not zero"));
    }
    match entries.iter().find(|(i, z)| *i as usize >= n || !z.is_finite()) {
        Some((i, z)) => {
            Err(Refusal::new(place, format!("{z} at {}", i + 1), format!("finite entries at 1 to {n}")))
        }
        None => Ok(()),
    }
}
