//! Bisection on the sign of the pivots of the tridiagonal pencil: slow, simple, right for every scene.

use std::cell::Cell;

use super::{
    Chain, Condensed, Enclosure, Engine, Segment, Uncertified, bisect, certify, sign_error,
    sturm_backward_error,
};
use crate::pencil::{ChainPencil, Penalty, Terms, last_pivot};

/// The nodes of one bar, as rows of the tridiagonal pencil. An elimination costs n divisions.
#[derive(Debug, Clone)]
pub(super) struct Rows<'a> {
    pub stiffness: &'a [f64],
    pub stiffness_off: &'a [f64],
    pub mass: &'a [f64],
    pub mass_off: &'a [f64],
}

impl Segment for Rows<'_> {
    fn condense(&self, l: f64, carried: f64) -> Option<f64> {
        let first = self.stiffness[0] - l * self.mass[0] + carried;
        let inner = self.stiffness[1..].iter().zip(&self.mass[1..]);
        let beside = self.stiffness_off.iter().zip(self.mass_off);
        let rows = inner.zip(beside).map(|((k, m), (k_off, m_off))| (k - l * m, k_off - l * m_off));
        last_pivot(first, rows, |pivot, _| pivot < 0.0)
    }
}

/// The rows of `pencil`, cut where a contact joins two nodes.
pub(super) fn rows(pencil: ChainPencil<'_>) -> Chain<Rows<'_>> {
    let (k, m) = (pencil.stiffness(), pencil.mass());
    let segments = pencil.bars().iter().map(|bar| {
        let (nodes, beside) = (bar.nodes.clone(), bar.nodes.start..bar.nodes.end - 1);
        Rows {
            stiffness: &k.diagonal[nodes.clone()],
            stiffness_off: &k.off_diagonal[beside.clone()],
            mass: &m.diagonal[nodes],
            mass_off: &m.off_diagonal[beside],
        }
    });
    let bars = pencil.bars();
    let (first, last) = (&bars[0], &bars[bars.len() - 1]);
    Chain { segments: segments.collect(), left_wall: first.left.is_some(), right_wall: last.right.is_some() }
}

/// The engine `sturm`: about 53 eliminations of n rows for one eigenvalue.
#[derive(Debug)]
pub struct Sturm<'a> {
    pencil: ChainPencil<'a>,
    chain: Chain<Rows<'a>>,
}

impl<'a> Sturm<'a> {
    /// The engine for `pencil`.
    pub fn new(pencil: ChainPencil<'a>) -> Self {
        Self { pencil, chain: rows(pencil) }
    }

    /// Whether every eigenvalue lies below l: the Sturm count of eigenvalues at or above l is zero.
    pub fn is_above_spectrum(&self, penalty: &Penalty, l: f64) -> bool {
        self.chain.is_above_spectrum(&self.pencil.terms(penalty), l)
    }

    /// Proves by two Sturm counts, each with the margin of its rounding, that `value` is l_max to within `spread`.
    ///
    /// # Errors
    /// [`Uncertified`] if a count contradicts the value or the interval is too wide.
    pub fn verify(&self, penalty: &Penalty, value: f64, spread: f64) -> Result<Enclosure, Uncertified> {
        let terms = self.pencil.terms(penalty);
        let kappa = sturm_backward_error(self.pencil, &terms, value);
        let (low, high) = (value * (1.0 - spread), value * (1.0 + spread));
        if self.chain.is_above_spectrum(&terms, low) || !self.chain.is_above_spectrum(&terms, high) {
            return Err(Uncertified { value, width: f64::INFINITY });
        }
        certify(Enclosure { value, lower: low * (1.0 - kappa), upper: high * (1.0 + kappa) })
    }

    /// Eliminations of the pencil that [`Engine::enclose`] takes.
    pub fn eliminations(&self, penalty: &Penalty) -> u64 {
        let (count, terms) = (Cell::new(0), self.pencil.terms(penalty));
        self.bracket(&terms, |l| {
            count.set(count.get() + 1);
            self.chain.is_above_spectrum(&terms, l)
        });
        count.get()
    }

    fn bracket(&self, terms: &[Terms], above: impl Fn(f64) -> bool) -> (f64, f64) {
        let (mut low, mut high) = (self.pencil.lower_bound(terms), self.pencil.upper_bound(terms));
        // The bounds hold exactly; rounding may put them a few units on the wrong side.
        while above(low) {
            low *= 0.5;
        }
        let mut widening = 64.0 * f64::EPSILON;
        while !above(high) && high < f64::MAX {
            high *= 1.0 + widening;
            widening *= 2.0;
        }
        bisect(low, high, above)
    }
}

impl Engine for Sturm<'_> {
    fn name(&self) -> &'static str {
        "sturm"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Enclosure, Uncertified> {
        let terms = self.pencil.terms(penalty);
        let (low, high) = self.bracket(&terms, |l| self.chain.is_above_spectrum(&terms, l));
        let kappa = sturm_backward_error(self.pencil, &terms, low);
        certify(Enclosure::from_bracket(low, high, kappa))
    }

    fn condensed(&self) -> Option<&dyn Condensed> {
        Some(self)
    }
}

impl Condensed for Sturm<'_> {
    fn is_above(&self, terms: &[Terms], l: f64) -> bool {
        self.chain.is_above_spectrum(terms, l)
    }

    fn rounding(&self, l: f64) -> f64 {
        sign_error(self.pencil, self.pencil.pencil().bounds().stiffness, l)
    }
}
