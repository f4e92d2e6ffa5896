//! What the gaps of a row of bars yield under unit contact forces, on either side of the spectrum.
//!
//! ```text
//! F = Z'(k K + m M)^-1 Z      k K + m M positive definite
//! ```
//! is -Phi(l) for k = -1, m = l above the spectrum, Phi(l) for k = 1, m = -l below it, and G = Z'M^-1 Z for k = 0,
//! m = 1. The bars are uncoupled without their contacts, so F couples only contacts of one bar: it is tridiagonal, and
//! one or two eliminations of the rows of each bar give it, the entries of its diagonal as sums of positive numbers.

//!
//! *Reach.* A contact sees no further than the matrix Q = k K + m M is conditioned. Let q_1 D <= Q <= q_2 D for a diagonal
//! D > 0. The best polynomial p of degree d has |1 - x p(x)| <= 2 s^(d+1) on [q_1, q_2], s = (v - 1)/(v + 1),
//! v = (q_2/q_1)^(1/2) (Chebyshev), so that Z'Q^-1 Z differs from Z'p Z by no more than 2 s^(d+1) of the geometric mean of
//! its own diagonal. A walk of d <= 2 R - 1 steps that returns to the end of a bar passes its last R nodes only: cut
//! behind them, where the same bounds hold of what is left, a bar yields the same to 4 s^(2R), and of a bar of more than
//! 2 R nodes the ends do not see each other to 2 s^(2R). As s <= exp(-2/v), R >= 20 v makes it less than 2^-113.

use crate::double_double::Real;
use crate::pencil::{BarRows, ChainPencil, last_pivot};

/// The gaps of `pencil` under unit contact forces.
#[derive(Debug, Clone)]
pub struct Flexibility<'a> {
    pencil: ChainPencil<'a>,
}

/// A symmetric tridiagonal matrix of the contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct OfGaps<T> {
    /// Each contact under its own force.
    pub diagonal: Vec<T>,
    /// Each contact under the force of the next.
    pub off_diagonal: Vec<T>,
}

impl<T: Real> OfGaps<T> {
    /// Zeros for some contacts.
    pub fn zeros(contacts: usize) -> Self {
        let zeros = |n: usize| vec![T::from(0.0); n];
        Self { diagonal: zeros(contacts), off_diagonal: zeros(contacts.saturating_sub(1)) }
    }

    /// The matrix times `factor`.
    #[must_use]
    pub fn times(mut self, factor: T) -> Self {
        self.diagonal.iter_mut().chain(&mut self.off_diagonal).for_each(|a| *a = *a * factor);
        self
    }
}

/// The nodes behind which a contact sees nothing, to 2^-113, of a matrix of this condition q_2/q_1; all of them if it has
/// none.
pub fn reach(condition: f64) -> usize {
    // A cast saturates.
    if condition >= 1.0 { (20.0 * condition.sqrt()).ceil() as usize + 1 } else { usize::MAX / 2 }
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

    /// Z'(k K + m M)^-1 Z, contacts x contacts, of bars cut behind `reach` nodes; `None` if a pivot is not positive.
    pub fn of<T: Real>(&self, k: f64, m: T, reach: usize) -> Option<OfGaps<T>> {
        let mut flexibility = OfGaps::zeros(self.pencil.gaps().len());
        for BarRows { nodes, left, right } in self.pencil.bars() {
            let is_cut = nodes.len().div_ceil(2) > reach;
            let kept = if is_cut { reach } else { nodes.len() };
            let mut add = |contact: usize, pivot: T| {
                flexibility.diagonal[contact] = flexibility.diagonal[contact] + T::from(1.0) / pivot;
            };
            if let Some(contact) = right {
                let (pivot, passed_on) = self.eliminate(nodes.end - kept..nodes.end, k, m)?;
                add(*contact, pivot);
                if left.is_some() && !is_cut {
                    flexibility.off_diagonal[contact - 1] = passed_on / pivot;
                }
            }
            if let Some(contact) = left {
                let (pivot, _) = self.eliminate((nodes.start..nodes.start + kept).rev(), k, m)?;
                add(*contact, pivot);
            }
        }
        Some(flexibility)
    }

    /// Eliminates `nodes` towards the last of them: its pivot, and the product of -b/d on the way, the force that
    /// arrives of a unit force at the first node.
    fn eliminate<T: Real>(&self, mut nodes: impl Iterator<Item = usize>, k: f64, m: T) -> Option<(T, T)> {
        let (stiffness, mass) = (self.pencil.stiffness(), self.pencil.mass());
        let entry = |stiffness: f64, mass: f64| T::from(k * stiffness) + m * T::from(mass);
        let own = |i: usize| entry(stiffness.diagonal[i], mass.diagonal[i]);
        let (mut passed_on, mut before) = (T::from(1.0), nodes.next()?);
        let first = own(before);
        let rows = nodes.map(|i| {
            let beside = i.min(std::mem::replace(&mut before, i));
            (own(i), entry(stiffness.off_diagonal[beside], mass.off_diagonal[beside]))
        });
        let zero = T::from(0.0);
        let pivot = last_pivot(first, rows, |pivot, share| {
            passed_on = -(passed_on * share);
            pivot > zero
        })?;
        (pivot > zero).then_some((pivot, passed_on))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::double_double::Dd;
    use crate::pencil::{Bounds, Gap, Matrix, Pencil, Tridiagonal};
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
        let found = flexibility.of(-1.0, l, usize::MAX).unwrap();
        assert!((found.diagonal[0] / expected - 1.0).abs() < 8.0 * f64::EPSILON);
        assert!(flexibility.of(-1.0, 0.5 * bounds.stiffness, usize::MAX).is_none());
    }

    #[test]
    fn a_long_bar_yields_the_same_cut_where_its_contacts_see_no_further() {
        let (n, k, m) = (300, 1.0, 1.0 / 6.0);
        let matrix = |end: f64, off: f64| {
            let mut diagonal = vec![2.0 * end; n];
            (diagonal[0], diagonal[n - 1]) = (end, end);
            Tridiagonal { diagonal, off_diagonal: vec![off; n - 1] }
        };
        let bounds = Bounds { stiffness: 12.0 * k, mass: 3.0 };
        let gap = |node: u32| Gap { column: SparseVector(vec![(node, 1.0)]), scale: k, initial: 0.0 };
        let (stiffness, mass) = (Matrix::Chain(matrix(k, -k)), Matrix::Chain(matrix(2.0 * m, m)));
        let gaps = vec![gap(0), gap(n as u32 - 1)];
        let pencil = Pencil::new(stiffness, mass, gaps, bounds, bounds.stiffness).unwrap();
        let flexibility = Flexibility::new(pencil.chain().unwrap());
        for (sign, l, condition) in [(0.0, 1.0, 3.0), (-1.0, 18.0, 9.0), (1.0, 24.0, 4.5)] {
            let whole = flexibility.of(sign, Dd::from(l), usize::MAX).unwrap();
            let cut = flexibility.of(sign, Dd::from(l), reach(condition)).unwrap();
            assert!(2 * reach(condition) < n && cut.off_diagonal[0].hi == 0.0);
            for (whole, cut) in whole.diagonal.iter().zip(&cut.diagonal) {
                let difference = ((*whole - *cut) / *whole).hi.abs();
                // And n eliminations, whose errors die out like the reach.
                assert!(difference < 64.0 * Dd::ROUNDOFF, "{difference:e}");
            }
            assert!((whole.off_diagonal[0] / whole.diagonal[0]).hi.abs() < 2f64.powi(-112));
            let short = flexibility.of(sign, Dd::from(l), reach(condition) / 3).unwrap();
            assert_ne!(short.diagonal[0], whole.diagonal[0]);
        }
    }
}
