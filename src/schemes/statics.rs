//! Bodies at rest under loads and in contact that pushes and never pulls.

use super::ContactRule;
use super::flexible::{Carried, Flexible};
use crate::error::Refusal;
use crate::pencil::Pencil;

/// The static problem of a pencil, its stiffness factored once:
///
/// ```text
/// K u + Z lambda = f      0 <= lambda   perpendicular to   g = Z'u + g0 + c <= 0
/// ```
/// with K u = f - Z lambda solved by sparse Cholesky and the complementarity problem of W = Z'K^-1 Z by block principal pivoting
/// (Judice, Pires, Comput. Oper. Res. 21, 1994). M has no part in it unless the bodies are carried.
///
/// ```
/// use bipenalty::pencil::{Bounds, Gap, Matrix, Pencil};
/// use bipenalty::schemes::StaticContact;
/// use bipenalty::sparse::{Csr, SparseVector};
/// // A spring of 4 N/m, 0.5 m from a wall, pulled with 3 N: the wall takes 3 - 4 * 0.5.
/// let gap = Gap { column: SparseVector(vec![(0, 1.0)]), scale: 1.0, initial: -0.5 };
/// let bounds = Bounds { stiffness: 4.0, mass: 1.0 };
/// let k = Matrix::Sparse(Csr::from_triplets(1, 1, &[(0, 0, 4.0)]));
/// let pencil = Pencil::new(k, Matrix::Diagonal(vec![1.0]), vec![gap], bounds, 4.0)?;
/// let rest = StaticContact::new(&pencil)?.solve(&[3.0], &[])?;
/// assert_eq!((rest.displacement[0], rest.force[0], rest.gap[0]), (0.5, 1.0, 0.0));
/// # Ok::<(), bipenalty::error::Refusal>(())
/// ```
#[derive(Debug, Clone)]
pub struct StaticContact {
    flexible: Flexible,
    /// g0, m.
    initial: Vec<f64>,
    unknowns: usize,
}

/// Bodies at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// u, m.
    pub displacement: Vec<f64>,
    /// g, m, positive in penetration: 0 where a force acts.
    pub gap: Vec<f64>,
    /// lambda, N.
    pub force: Vec<f64>,
}

impl StaticContact {
    /// Of bodies that their supports hold: K is definite.
    ///
    /// # Errors
    /// A K that does not resist every motion, contacts that depend on each other, more contacts than memory holds.
    pub fn new(pencil: &Pencil) -> Result<Self, Refusal> {
        Self::of(pencil, None)
    }

    /// Of bodies that may move along one rigid motion t (n numbers), K t = 0, and are carried along it by forces of inertia,
    /// which balance loads and contacts: K u + Z lambda = f + b M t, and u is measured from the mean motion, t'M u = 0. This
    /// is a body that falls at a contact slowly.
    ///
    /// # Errors
    /// As [`StaticContact::new`], of K without t; a t that K resists.
    pub fn carried(pencil: &Pencil, motion: &[f64]) -> Result<Self, Refusal> {
        let n = pencil.size();
        let refused = |value: String| {
            Refusal::new("motion", value, format!("{n} finite numbers other than 0 that K does not resist"))
        };
        if motion.len() != n || motion.iter().any(|t| !t.is_finite()) || motion.iter().all(|t| *t == 0.0) {
            return Err(refused(format!("{} numbers", motion.len())));
        }
        for i in 0..n {
            let (mut force, mut size, mut terms) = (0.0, 0.0, 0);
            for (j, k) in pencil.stiffness().row(i) {
                force += k * motion[j];
                size += (k * motion[j]).abs();
                terms += 1;
            }
            // A sum of rounded entries, each a sum over the elements around a node.
            if force.abs() > 64.0 * f64::EPSILON * f64::from(terms) * size {
                return Err(refused(format!("{force:e} N in row {i}")));
            }
        }
        let mut balance = vec![0.0; n];
        pencil.mass().multiply(motion, &mut balance);
        let mass: f64 = balance.iter().zip(motion).map(|(p, t)| p * t).sum();
        balance.iter_mut().for_each(|p| *p /= mass);
        Self::of(pencil, Some(Carried { motion: motion.to_vec(), balance }))
    }

    fn of(pencil: &Pencil, carried: Option<Carried>) -> Result<Self, Refusal> {
        let unknowns: Vec<u32> = (0..pencil.size() as u32).collect();
        let initial = pencil.gaps().iter().map(|gap| gap.initial).collect();
        Ok(Self { flexible: Flexible::new(pencil, &unknowns, carried)?, initial, unknowns: unknowns.len() })
    }

    /// The equilibrium under nodal forces f (N; empty for none) with the bodies moved towards each other by c, which is added
    /// to each gap (m, one a contact; empty for none).
    ///
    /// # Errors
    /// Vectors of another length, numbers that are not finite.
    pub fn solve(&mut self, load: &[f64], closing: &[f64]) -> Result<Equilibrium, Refusal> {
        let k = self.initial.len();
        for (place, vector, count) in [("load", load, self.unknowns), ("closing", closing, k)] {
            if !(vector.is_empty() || vector.len() == count) || vector.iter().any(|x| !x.is_finite()) {
                let allowed = format!("no number, or {count} finite numbers");
                return Err(Refusal::new(place, format!("{} numbers", vector.len()), allowed));
            }
        }
        let mut displacement = if load.is_empty() { vec![0.0; self.unknowns] } else { load.to_vec() };
        self.flexible.apply(&mut displacement);
        let distance = |j: usize| self.initial[j] + closing.get(j).copied().unwrap_or(0.0);
        let gaps = |u: &[f64], flexible: &Flexible| -> Vec<f64> {
            (0..k).map(|j| flexible.across(j, u) + distance(j)).collect()
        };
        let (free, mut force) = (gaps(&displacement, &self.flexible), vec![0.0; k]);
        self.flexible.react(ContactRule::Unilateral, &free, &mut force, &mut displacement);
        let mut gap = gaps(&displacement, &self.flexible);
        gap.iter_mut().zip(&force).filter(|(_, force)| **force > 0.0).for_each(|(gap, _)| *gap = 0.0);
        Ok(Equilibrium { displacement, gap, force })
    }
}
