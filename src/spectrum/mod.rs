//! The largest eigenvalue l_max = omega_max^2 of a [`Pencil`] with its contact terms, and the evidence for it.
//!
//! Engines of a row of bars: [`Sturm`] (bisection on the sign of the pivots) and [`Secular`] (one scalar function for all
//! penalties); of any pencil: [`Dense`] (faer) and, with the feature `lapack`, an independent oracle. Krylov and power
//! estimates err on the unsafe side, a time step too large, so no engine returns a bare number: each answer is enclosed.

mod chain;
mod dense;
mod flexibility;
#[cfg(feature = "lapack")]
pub mod lapack;
mod proof;
mod root;
mod secular;
mod step;
mod sturm;

pub use chain::{Chain, Segment};
pub(crate) use dense::with_gaps_last;
pub use dense::{Dense, MAX_DENSE_NODES};
pub use flexibility::{Flexibility, OfGaps, reach};
pub use root::{bisect, find_sign_change};
pub use secular::Secular;
pub(crate) use secular::chebyshev;
pub use step::{Evidence, OfSpectrum, Spectrum, Step, StepLimit};
pub use sturm::Sturm;

use crate::error::{Error, Refusal};
use crate::pencil::{ChainPencil, Penalty, Pencil, Terms};

/// Unit roundoff of f64, 2^-53.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// The widest relative enclosure of l_max that counts as certified: the critical step, which goes with its square
/// root, is then certified to 1e-13.
pub const WIDEST_ENCLOSURE: f64 = 2e-13;

/// A largest eigenvalue and the interval that is proven to hold the exact one of the pencil as stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    /// The best value, rad^2/s^2.
    pub value: f64,
    /// No exact value lies below this.
    pub lower: f64,
    /// No exact value lies above this.
    pub upper: f64,
}

impl Enclosure {
    /// From a bracket of the computed sign change and the relative backward error kappa of the sign: a computed
    /// sign at l is the exact one at some l' with |l' - l| <= kappa l.
    pub fn from_bracket(low: f64, high: f64, kappa: f64) -> Self {
        let value = low + 0.5 * (high - low);
        Self { value, lower: low * (1.0 - kappa), upper: high * (1.0 + kappa) }
    }

    /// (upper - lower)/value.
    pub fn relative_width(&self) -> f64 {
        (self.upper - self.lower) / self.value
    }
}

/// An eigenvalue that could not be enclosed tightly enough to be quoted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "l_max = {value:e} rad^2/s^2 was enclosed to {width:e} relative only: wider than a certificate of {WIDEST_ENCLOSURE:e} or \
     the width asked for allows"
)]
pub struct Uncertified {
    /// The value that was found, rad^2/s^2; of the convex curve its proven lower bound, with the upper one at value (1 + width).
    pub value: f64,
    /// The relative width that was reached; infinite when the check contradicted the value.
    pub width: f64,
}

impl From<Uncertified> for Error {
    /// Without a width nothing is proven; with one the value lies anywhere between the ends.
    fn from(uncertified: Uncertified) -> Self {
        let Uncertified { value, width } = uncertified;
        let (lower, upper) = match width.is_finite() {
            true => (value * (1.0 - width), value * (1.0 + width)),
            false => (0.0, f64::INFINITY),
        };
        Self::Uncertified { lower, upper, message: uncertified.to_string() }
    }
}

/// One way to the largest eigenvalue of one pencil, for any penalty of its contacts.
///
/// `start` may hand on a nearby eigenvalue, such as the neighbour's on a map; it changes the cost, and the value by no
/// more than the enclosure.
pub trait Engine: Sync {
    /// The name in records.
    fn name(&self) -> &'static str;

    /// l_max with its enclosure.
    ///
    /// # Errors
    /// [`Uncertified`] if the enclosure is wider than the engine promises or contradicts the value.
    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Enclosure, Uncertified>;

    /// As [`Engine::enclose`], with the name of the engine that found it: one that asks others names the last of them.
    fn enclose_by(
        &self,
        penalty: &Penalty,
        start: Option<f64>,
    ) -> (Result<Enclosure, Uncertified>, &'static str) {
        (self.enclose(penalty, start), self.name())
    }

    /// The sign of the spectrum, if the engine has it for contacts of any stiffness and mass.
    fn condensed(&self) -> Option<&dyn Condensed> {
        None
    }
}

/// A row of bars reduced to its contacts.
pub trait Condensed: Sync {
    /// Whether every eigenvalue lies below l with these contacts, of any sign.
    fn is_above(&self, terms: &[Terms], l: f64) -> bool;

    /// The relative distance that rounding may shift the root of this sign near l, contacts aside.
    fn rounding(&self, l: f64) -> f64;
}

/// The engine for a pencil of which nothing else is known: [`Secular`] for a chain, [`Dense`] for other matrices.
///
/// # Errors
/// As [`Dense::new`].
pub fn engine(pencil: &Pencil) -> Result<Box<dyn Engine + '_>, Refusal> {
    Ok(match pencil.chain() {
        Some(chain) => Box::new(Secular::new(chain)),
        None => Box::new(Dense::new(pencil)?),
    })
}

/// The relative backward error of the sign of the computed last pivot of K - l M with its contacts.
///
/// Every pivot is the exact pivot of a pencil whose entries differ by at most 8 unit roundoffs: forming an entry of
/// K - l M takes 2 roundings, the step b (b/d) and its subtraction 3, a contact d (c/(d+c)) 4, and errors of a pivot
/// pass as relative errors to the entries of its row. With |K| <= B (M + M_p) (B the stiffness bound),
/// s z z' <= C (M + M_p) (C the contact bound) and |M| <= c M, c <= 3 (the pencil's [`Bounds`](crate::pencil::Bounds)),
/// that moves the eigenvalue by at most 8u (3 l + B + C).
pub fn sturm_backward_error(pencil: ChainPencil<'_>, terms: &[Terms], l: f64) -> f64 {
    sign_error(pencil, pencil.stiffness_bound(terms) + pencil.contact_bound(terms), l)
}

/// The same with a bound of the stiffness, contacts included, relative to the mass.
fn sign_error(pencil: ChainPencil<'_>, stiffness: f64, l: f64) -> f64 {
    8.0 * UNIT_ROUNDOFF * (pencil.pencil().bounds().mass.max(3.0) + stiffness / l)
}

/// Refuses an enclosure that is too wide or does not hold its own value.
pub fn certify(enclosure: Enclosure) -> Result<Enclosure, Uncertified> {
    let width = enclosure.relative_width();
    let holds = enclosure.lower <= enclosure.value && enclosure.value <= enclosure.upper;
    if holds && width <= WIDEST_ENCLOSURE {
        Ok(enclosure)
    } else {
        let width = if holds { width } else { f64::INFINITY };
        Err(Uncertified { value: enclosure.value, width })
    }
}
