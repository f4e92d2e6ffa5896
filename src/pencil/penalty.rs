//! The penalty of all contacts as two numbers, and what it makes of one contact.

use super::Scale;

/// The form of the mass penalty M_p.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PenaltyMass {
    /// M_p = m z z'.
    #[default]
    Consistent,
    /// Row sums of |M_p| (paper 4.4): m on the node of a wall, 2m on each node of a pair. The exception: no multiple of
    /// K_p, and offered for spectra only.
    Diagonalised,
}

/// The penalty of all closed contacts: K_p = stiffness P and M_p = K_p/rate, P = sum_j w_j z_j z_j'.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penalty {
    /// beta_s, dimensionless: s_j = beta_s w_j.
    pub stiffness: f64,
    /// r omega^2, rad^2/s^2: m_j = s_j/rate; infinite for the pure stiffness penalty.
    pub rate: f64,
    /// How the mass is distributed.
    pub form: PenaltyMass,
}

impl Penalty {
    /// Open contacts.
    pub const NONE: Self = Self { stiffness: 0.0, rate: f64::INFINITY, form: PenaltyMass::Consistent };

    /// s and m of a contact of scale w (N/m): N/m and kg.
    #[inline]
    pub fn of(&self, scale: f64) -> (f64, f64) {
        let stiffness = self.stiffness * scale;
        (stiffness, stiffness / self.rate)
    }

    /// What the penalty makes of one contact of a chain.
    #[inline]
    pub fn terms(&self, scale: Scale) -> Terms {
        let (stiffness, mass) = self.of(scale.stiffness);
        match (self.form, scale.pair) {
            (PenaltyMass::Diagonalised, true) => Terms { stiffness, mass: 0.0, nodal_mass: 2.0 * mass },
            (PenaltyMass::Diagonalised, false) | (PenaltyMass::Consistent, _) => {
                Terms { stiffness, mass, nodal_mass: 0.0 }
            }
        }
    }

    /// Hands the terms of all contacts to `use_them`; without an allocation for one contact, since a map asks at every
    /// point.
    #[inline]
    pub fn with_terms<R>(&self, scales: &[Scale], use_them: impl FnOnce(&[Terms]) -> R) -> R {
        match scales {
            [] => use_them(&[]),
            [scale] => use_them(&[self.terms(*scale)]),
            several => use_them(&several.iter().map(|scale| self.terms(*scale)).collect::<Vec<_>>()),
        }
    }
}

impl Default for Penalty {
    fn default() -> Self {
        Self::NONE
    }
}

/// What the closing of one contact adds to the pencil.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Terms {
    /// s, N/m, multiplies z z' in the stiffness.
    pub stiffness: f64,
    /// m, kg, multiplies z z' in the mass.
    pub mass: f64,
    /// d, kg, added to the mass of each node of the contact: the diagonalised mass penalty.
    pub nodal_mass: f64,
}

impl Terms {
    /// c(l) = s - l m, the dynamic stiffness of the contact.
    #[inline]
    pub fn dynamic_stiffness(&self, l: f64) -> f64 {
        self.stiffness - l * self.mass
    }
}
