//! What the gaps of a row of bars yield under unit contact forces, on either side of the spectrum.
//!
//! ```text
//! F = Z'(k K + m M)^-1 Z      k K + m M positive definite
//! ```
//! is -Phi(l) for k = -1, m = l above the spectrum, Phi(l) for k = 1, m = -l below it, and G = Z'M^-1 Z for k = 0,
//! m = 1. The bars are uncoupled without their contacts, so F couples only contacts of one bar: it is tridiagonal, and
//! one or two eliminations of the rows of each bar give it, the entries of its diagonal as sums of positive numbers.

use crate::pencil::{BarRows, ChainPencil, Tridiagonal, last_pivot};

/// The gaps of `pencil` under unit contact forces.
#[derive(Debug, Clone)]
pub struct Flexibility<'a> {
    pencil: ChainPencil<'a>,
}

impl<'a> Flexibility<'a> {
    /// The flexibility of the gaps of `pencil`.
    pub fn new(pencil: ChainPencil<'a>) -> Self {
        Self { pencil }
    }

    /// Whether every contact joins bodies of a single node.
    pub fn has_single_nodes_only(&self) -> bool {
        self.pencil.bars().iter().all(|bar| bar.nodes.len() == 1)
    }

    /// Z'(k K + m M)^-1 Z, contacts x contacts; `None` if a pivot is not positive.
    pub fn of(&self, k: f64, m: f64) -> Option<Tridiagonal> {
        let mut flexibility = Tridiagonal::zeros(self.pencil.gaps().len());
        for BarRows { nodes, left, right } in self.pencil.bars() {
            if let Some(contact) = right {
                let (pivot, passed_on) = self.eliminate(nodes.clone(), k, m)?;
                flexibility.diagonal[*contact] += 1.0 / pivot;
                if left.is_some() {
                    flexibility.off_diagonal[contact - 1] = passed_on / pivot;
                }
            }
            if let Some(contact) = left {
                let (pivot, _) = self.eliminate(nodes.clone().rev(), k, m)?;
                flexibility.diagonal[*contact] += 1.0 / pivot;
            }
        }
        Some(flexibility)
    }

    /// Eliminates `nodes` towards the last of them: its pivot, and the product of -b/d on the way, the force that
    /// arrives of a unit force at the first node.
    fn eliminate(&self, mut nodes: impl Iterator<Item = usize>, k: f64, m: f64) -> Option<(f64, f64)> {
        let (stiffness, mass) = (self.pencil.stiffness(), self.pencil.mass());
        let own = |i: usize| k * stiffness.diagonal[i] + m * mass.diagonal[i];
        let (mut passed_on, mut before) = (1.0, nodes.next()?);
        let first = own(before);
        let rows = nodes.map(|i| {
            let beside = i.min(std::mem::replace(&mut before, i));
            (own(i), k * stiffness.off_diagonal[beside] + m * mass.off_diagonal[beside])
        });
        let pivot = last_pivot(first, rows, |pivot, share| {
            passed_on *= -share;
            pivot > 0.0
        })?;
        (pivot > 0.0).then_some((pivot, passed_on))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::pencil::{Bounds, Gap, Matrix, Pencil};
    use crate::sparse::SparseVector;

    #[test]
    fn the_flexibility_of_one_bar_on_a_wall_is_that_of_its_secular_function() {
        let (k, m) = (1e3, 5e-4);
        let matrix =
            |diagonal: f64, off: f64| Tridiagonal { diagonal: vec![diagonal; 2], off_diagonal: vec![off] };
        let bounds = Bounds { stiffness: 2.0 * k / m, mass: 1.0 };
        let gap = Gap { column: SparseVector(vec![(1, 1.0)]), scale: k, initial: 0.0 };
        let (stiffness, mass) = (Matrix::Chain(matrix(k, -k)), Matrix::Diagonal(vec![m; 2]));
        let pencil = Pencil::new(stiffness, mass, vec![gap], bounds, bounds.stiffness).unwrap();
        let flexibility = Flexibility::new(pencil.chain().unwrap());
        let l = 3.0 * bounds.stiffness;
        // (l M - K) = [ l m - k, k; k, l m - k ]
        let expected = (l * m - k) / ((l * m - k).powi(2) - k * k);
        let found = flexibility.of(-1.0, l).unwrap();
        assert!((found.diagonal[0] / expected - 1.0).abs() < 8.0 * f64::EPSILON);
        assert!(flexibility.of(-1.0, 0.5 * bounds.stiffness).is_none());
    }
}
