//! What the gaps of a row of bars yield under unit contact forces, on either side of the spectrum.
//!
//! ```text
//! F = Z'(k K + m M)^-1 Z      k K + m M positive definite
//! ```
//! is -Phi(l) for k = -1, m = l above the spectrum, Phi(l) for k = 1, m = -l below it, and G = Z'M^-1 Z for k = 0,
//! m = 1. The bars are uncoupled without their contacts, so F couples only contacts of one bar: it is tridiagonal, and
//! one or two eliminations of the rows of each bar give it, the entries of its diagonal as sums of positive numbers.

use crate::pencil::{Gap, Pencil, Tridiagonal};

/// The gaps of `pencil` under unit contact forces.
#[derive(Debug, Clone)]
pub struct Flexibility<'a> {
    pencil: &'a Pencil,
    bars: Vec<Bar>,
}

/// The rows of one bar and the contacts at its ends.
#[derive(Debug, Clone)]
struct Bar {
    first: usize,
    last: usize,
    left_contact: Option<usize>,
    right_contact: Option<usize>,
}

impl<'a> Flexibility<'a> {
    /// The flexibility of the gaps of `pencil`.
    pub fn new(pencil: &'a Pencil) -> Self {
        let mut bars =
            vec![Bar { first: 0, last: pencil.size() - 1, left_contact: None, right_contact: None }];
        for (contact, gap) in pencil.gaps().iter().enumerate() {
            let last = bars.len() - 1;
            match *gap {
                Gap::Wall { node: 0 } if contact == 0 && pencil.size() > 1 => bars[0].left_contact = Some(0),
                Gap::Wall { .. } => bars[last].right_contact = Some(contact),
                Gap::Pair { left } => {
                    let end = std::mem::replace(&mut bars[last].last, left);
                    bars[last].right_contact = Some(contact);
                    let left_contact = Some(contact);
                    bars.push(Bar { first: left + 1, last: end, left_contact, right_contact: None });
                }
            }
        }
        Self { pencil, bars }
    }

    /// Whether every contact joins bodies of a single node.
    pub fn has_single_nodes_only(&self) -> bool {
        self.bars.iter().all(|bar| bar.first == bar.last)
    }

    /// Z'(k K + m M)^-1 Z, contacts x contacts; `None` if a pivot is not positive.
    pub fn of(&self, k: f64, m: f64) -> Option<Tridiagonal> {
        let contacts = self.pencil.gaps().len();
        let mut flexibility = Tridiagonal {
            diagonal: vec![0.0; contacts],
            off_diagonal: vec![0.0; contacts.saturating_sub(1)],
        };
        for bar in &self.bars {
            if let Some(contact) = bar.right_contact {
                let (pivot, passed_on) = self.eliminate(bar.first..=bar.last, k, m)?;
                flexibility.diagonal[contact] += 1.0 / pivot;
                if bar.left_contact.is_some() {
                    flexibility.off_diagonal[contact - 1] = passed_on / pivot;
                }
            }
            if let Some(contact) = bar.left_contact {
                let (pivot, _) = self.eliminate((bar.first..=bar.last).rev(), k, m)?;
                flexibility.diagonal[contact] += 1.0 / pivot;
            }
        }
        Some(flexibility)
    }

    /// Eliminates `nodes` towards the last of them: its pivot, and the product of -b/d on the way, the force that
    /// arrives of a unit force at the first node.
    fn eliminate(&self, nodes: impl Iterator<Item = usize>, k: f64, m: f64) -> Option<(f64, f64)> {
        let (stiffness, mass) = (self.pencil.stiffness(), self.pencil.mass());
        let (mut pivot, mut passed_on, mut before) = (f64::INFINITY, 1.0, None::<usize>);
        for i in nodes {
            let own = k * stiffness.diagonal[i] + m * mass.diagonal[i];
            pivot = match before {
                None => own,
                Some(j) => {
                    let beside = i.min(j);
                    let off = k * stiffness.off_diagonal[beside] + m * mass.off_diagonal[beside];
                    let share = off / pivot;
                    passed_on *= -share;
                    own - off * share
                }
            };
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            before = Some(i);
        }
        Some((pivot, passed_on))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flexibility_of_one_bar_on_a_wall_is_that_of_its_secular_function() {
        let (k, m) = (1e3, 5e-4);
        let matrix =
            |diagonal: f64, off: f64| Tridiagonal { diagonal: vec![diagonal; 2], off_diagonal: vec![off] };
        let pencil = Pencil::new(matrix(k, -k), matrix(m, 0.0), vec![Gap::Wall { node: 1 }], 2.0 * k / m);
        let l = 3.0 * pencil.element_bound();
        // (l M - K) = [ l m - k, k; k, l m - k ]
        let expected = (l * m - k) / ((l * m - k).powi(2) - k * k);
        let found = Flexibility::new(&pencil).of(-1.0, l).unwrap();
        assert!((found.diagonal[0] / expected - 1.0).abs() < 8.0 * f64::EPSILON);
        assert!(Flexibility::new(&pencil).of(-1.0, 0.5 * pencil.element_bound()).is_none());
    }
}
