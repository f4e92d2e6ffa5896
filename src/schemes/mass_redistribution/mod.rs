//! Central differences with no mass at the contact: the mass redistribution method (Khenous, Laborde, Renard, Eur. J. Mech.
//! A 27, 2008; semi-explicit as in Doyen, Ern, Piperno, SIAM J. Sci. Comput. 33, 2011).
//!
//! The mass of the contact unknowns goes to their neighbours in the body that move in the same direction, in equal parts: no mass is
//! negative, and the whole keeps its mass (not its centre, which moves by less than an element). What is left of a contact
//! unknown are springs: at each step it is where forces balance, and the reaction is found with it ([`super::Equilibrium`]),
//!
//! ```text
//! M' a = f - K u - Z lambda      in rows of contact unknowns 0 = f - K u - Z lambda      0 <= lambda   perpendicular to   g_n <= 0
//! ```
//! No penalty. The inner unknowns see a potential that is convex and has a continuous slope, the minimum over the contact
//! unknowns of u'Ku/2 - f'u: nothing jumps when a contact opens or closes. Its second derivative is at most K of the inner
//! unknowns, and M' >= M there, so that the contact-free step of (K, M) is stable with contacts held open or closed; that
//! opening and closing gains nothing is not proven.
//!
//! Offered for bars and meshes, whose directions are known; of other matrices where no entry beside the diagonal of the rows in
//! question is positive, which one direction has; not for consistent masses of elements of second order, whose corners would give away
//! less than nothing. The flexibility of the contacts is a full matrix of their number.

mod mass;
mod motion;

use motion::Steps;

use super::rigid::ContactFree;
use super::{CentralDifference, Facts, Motion, Scheme, System};
use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::spectrum::{Engine, StepLimit};

/// Central differences with the mass of the contact nodes moved into the bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MassRedistribution;

impl Scheme for MassRedistribution {
    fn facts(&self) -> Facts {
        Facts {
            name: "mass-redistribution",
            title: "mass redistribution",
            gains_nothing: false,
            reaction: "0 <= lambda perpendicular to g_n <= 0, in balance with the springs of the node",
            closed_limit: "2/omega_max of (K, M) or more",
            source: "Khenous, Laborde, Renard 2008; Doyen, Ern, Piperno 2011",
            ..CentralDifference::FACTS
        }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        Ok(Box::new(Steps::start(&system, u, v)?))
    }

    fn limit<'a>(
        &self,
        _pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Ok(Box::new(ContactFree(spectrum)))
    }
}
