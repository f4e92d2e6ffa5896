//! A point of the map, and what is known about it.

use crate::error::Error;

/// A point asked for: l = f(s - l m), that is l_max(K + s P, M + m P).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// s = beta_s.
    pub stiffness: f64,
    /// m = beta_s/(r omega^2); 0 for r = infinity.
    pub mass: f64,
}

impl Asked {
    /// The point of a map: beta_s and r, with the reference omega^2 in rad^2/s^2.
    pub fn of(beta_s: f64, ratio: f64, reference: f64) -> Self {
        Self { stiffness: beta_s, mass: beta_s / (ratio * reference) }
    }

    /// A t just below s - l m, where f(t) <= l is to be proven for an l that is right to four roundings. Where l m is
    /// large they move t so far that f(t) would lie above l by more than any tolerance; and f does not decrease, so that
    /// a smaller t proves as much.
    pub(super) fn place(self, l: f64) -> f64 {
        let product = l * self.mass;
        self.stiffness - product - 8.0 * f64::EPSILON * product.abs()
    }
}

/// An enclosure of an eigenvalue l = omega^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosed {
    /// Proven lower bound.
    pub lower: f64,
    /// Proven upper bound; infinite where none was found.
    pub upper: f64,
}

impl Enclosed {
    /// Relative width of the time step 2/sqrt(l).
    pub fn step_width(&self) -> f64 {
        if self.lower > 0.0 { (self.upper / self.lower).sqrt() - 1.0 } else { f64::INFINITY }
    }

    /// The enclosure, if the step is enclosed to `tolerance`.
    pub(super) fn within(self, tolerance: f64) -> Result<Self, TooWide> {
        if self.step_width() <= tolerance { Ok(self) } else { Err(TooWide { enclosed: self, tolerance }) }
    }
}

/// A point whose step could not be enclosed to the width asked for.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the step was enclosed to {:e} relative only, by l_max from {:e} to {:e} rad^2/s^2; asked for was {tolerance:e}",
    .enclosed.step_width(), .enclosed.lower, .enclosed.upper
)]
pub struct TooWide {
    /// What is proven.
    pub enclosed: Enclosed,
    /// The relative width asked for.
    pub tolerance: f64,
}

impl From<TooWide> for Error {
    fn from(wide: TooWide) -> Self {
        let Enclosed { lower, upper } = wide.enclosed;
        Self::Uncertified { lower, upper, message: wide.to_string() }
    }
}
