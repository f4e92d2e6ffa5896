//! Bisection on the sign of the pivots of the tridiagonal pencil: slow, simple, right for every scene.

use std::cell::Cell;

use super::{Chain, Enclosure, Engine, Segment, Uncertified, bisect, certify, sturm_backward_error};
use crate::pencil::{Gap, Penalty, Pencil};

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
        let mut pivot = self.stiffness[0] - l * self.mass[0] + carried;
        let inner = self.stiffness[1..].iter().zip(&self.mass[1..]);
        let beside = self.stiffness_off.iter().zip(self.mass_off);
        for ((k, m), (k_off, m_off)) in inner.zip(beside) {
            if pivot.is_nan() || pivot >= 0.0 {
                return None;
            }
            let off = k_off - l * m_off;
            pivot = (k - l * m) - off * (off / pivot);
        }
        Some(pivot)
    }
}

/// The rows of `pencil`, cut where a contact joins two nodes.
pub(super) fn rows(pencil: &Pencil) -> Chain<Rows<'_>> {
    let (k, m) = (pencil.stiffness(), pencil.mass());
    let mut cuts = vec![0];
    let (mut left_wall, mut right_wall) = (false, false);
    for (i, gap) in pencil.gaps().iter().enumerate() {
        match *gap {
            Gap::Pair { left } => cuts.push(left + 1),
            Gap::Wall { node: 0 } if i == 0 && pencil.size() > 1 => left_wall = true,
            Gap::Wall { .. } => right_wall = true,
        }
    }
    cuts.push(pencil.size());
    let segments = cuts.windows(2).map(|cut| Rows {
        stiffness: &k.diagonal[cut[0]..cut[1]],
        stiffness_off: &k.off_diagonal[cut[0]..cut[1] - 1],
        mass: &m.diagonal[cut[0]..cut[1]],
        mass_off: &m.off_diagonal[cut[0]..cut[1] - 1],
    });
    Chain { segments: segments.collect(), left_wall, right_wall }
}

/// The engine `sturm`: about 53 eliminations of n rows for one eigenvalue.
#[derive(Debug)]
pub struct Sturm<'a> {
    pencil: &'a Pencil,
    chain: Chain<Rows<'a>>,
}

impl<'a> Sturm<'a> {
    /// The engine for `pencil`.
    pub fn new(pencil: &'a Pencil) -> Self {
        Self { pencil, chain: rows(pencil) }
    }

    /// Whether every eigenvalue lies below l: the Sturm count of eigenvalues at or above l is zero.
    pub fn is_above_spectrum(&self, penalties: &[Penalty], l: f64) -> bool {
        self.chain.is_above_spectrum(penalties, l)
    }

    /// Proves by two Sturm counts, each with the margin of its rounding, that `value` is l_max to within `spread`.
    ///
    /// # Errors
    /// [`Uncertified`] if a count contradicts the value or the interval is too wide.
    pub fn verify(&self, penalties: &[Penalty], value: f64, spread: f64) -> Result<Enclosure, Uncertified> {
        let kappa = sturm_backward_error(self.pencil, penalties, value);
        let (low, high) = (value * (1.0 - spread), value * (1.0 + spread));
        if self.is_above_spectrum(penalties, low) || !self.is_above_spectrum(penalties, high) {
            return Err(Uncertified { value, width: f64::INFINITY });
        }
        certify(Enclosure { value, lower: low * (1.0 - kappa), upper: high * (1.0 + kappa) })
    }

    /// Eliminations of the pencil that [`Engine::enclose`] takes.
    pub fn eliminations(&self, penalties: &[Penalty]) -> u64 {
        let count = Cell::new(0);
        self.bracket(penalties, |l| {
            count.set(count.get() + 1);
            self.is_above_spectrum(penalties, l)
        });
        count.get()
    }

    fn bracket(&self, penalties: &[Penalty], above: impl Fn(f64) -> bool) -> (f64, f64) {
        let (mut low, mut high) = (self.pencil.lower_bound(penalties), self.pencil.upper_bound(penalties));
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

    fn estimate(&self, penalties: &[Penalty], _start: Option<f64>) -> f64 {
        let (low, high) = self.bracket(penalties, |l| self.is_above_spectrum(penalties, l));
        low + 0.5 * (high - low)
    }

    fn enclose(&self, penalties: &[Penalty], _start: Option<f64>) -> Result<Enclosure, Uncertified> {
        let (low, high) = self.bracket(penalties, |l| self.is_above_spectrum(penalties, l));
        let kappa = sturm_backward_error(self.pencil, penalties, low);
        certify(Enclosure::from_bracket(low, high, kappa))
    }
}
