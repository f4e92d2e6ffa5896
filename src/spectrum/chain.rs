//! A row of uncoupled segments with contacts between them, eliminated from left to right.
//!
//! K - l M with its contacts is negative definite exactly when l lies above the spectrum. Elimination along the row
//! keeps the contact terms apart: where stiffness d meets the contact c in series, the next segment receives
//! d c/(d + c), which stays right to rounding when c exceeds d by 16 orders of magnitude.

use crate::pencil::Terms;

/// A segment between two contacts, reduced to its ends.
pub trait Segment {
    /// The dynamic stiffness K - l M of the right end once everything to its left is eliminated, with the stiffness
    /// `carried` added at the left end. `None` if a pivot on the way is not negative: l is not above the spectrum.
    fn condense(&self, l: f64, carried: f64) -> Option<f64>;
}

/// Segments from left to right and what their row ends at.
#[derive(Debug, Clone)]
pub struct Chain<S> {
    /// The segments; contact i + `left_wall` lies between segments i and i + 1.
    pub segments: Vec<S>,
    /// Whether contact 0 is a wall at the left end.
    pub left_wall: bool,
    /// Whether the last contact is a wall at the right end.
    pub right_wall: bool,
}

impl<S: Segment> Chain<S> {
    /// The last pivot of K - l M with the contacts `terms`; +inf if an earlier pivot is not negative.
    pub fn last_pivot(&self, terms: &[Terms], l: f64) -> f64 {
        let wall = |p: &Terms| p.dynamic_stiffness(l) - l * p.nodal_mass;
        let mut carried = if self.left_wall { wall(&terms[0]) } else { 0.0 };
        let pairs = &terms[usize::from(self.left_wall)..];
        let Some((last, before)) = self.segments.split_last() else { return f64::INFINITY };
        for (segment, p) in before.iter().zip(pairs) {
            let Some(end) = segment.condense(l, carried) else { return f64::INFINITY };
            let nodal = l * p.nodal_mass;
            let (d, c) = (end - nodal, p.dynamic_stiffness(l));
            let pivot = d + c;
            if pivot.is_nan() || pivot >= 0.0 {
                return f64::INFINITY;
            }
            carried = d * (c / pivot) - nodal;
        }
        match last.condense(l, carried) {
            None => f64::INFINITY,
            Some(end) if self.right_wall => end + wall(&terms[terms.len() - 1]),
            Some(end) => end,
        }
    }

    /// Whether every eigenvalue lies below l.
    pub fn is_above_spectrum(&self, terms: &[Terms], l: f64) -> bool {
        self.last_pivot(terms, l) < 0.0
    }
}
