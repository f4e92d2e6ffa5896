//! Central differences with no mass at the contact: the mass redistribution method (Khenous, Laborde, Renard, Eur. J. Mech.
//! A 27, 2008; semi-explicit as in Doyen, Ern, Piperno, SIAM J. Sci. Comput. 33, 2011).
//!
//! The mass of the contact nodes goes to their neighbours in the body, so that the whole keeps its mass. What is left of a
//! contact node is a spring: at each step it is where forces balance, and the reaction is found with it,
//!
//! ```text
//! M' a = f - K u - Z lambda      in its rows of contact nodes 0 = f - K u - Z lambda      0 <= lambda   perpendicular to   g_n <= 0
//! ```
//! No penalty. All unknowns of a node that carries a gap are massless; of a contact of a node with a face the nodes of both
//! sides. K_cc, their block of K, is constant: one sparse Cholesky factorisation, then two solves and one complementarity
//! problem of W = Z_c'K_cc^-1 Z_c a step.
//!
//! *Who takes the mass over.* Element by element of a mesh: what a lumped element has at massless nodes goes to its other nodes in
//! proportion to what they have of it, in each direction for itself. Bars, and other matrices of one direction (no positive
//! entry beside the diagonal of a contact row): to the neighbours in proportion to their springs. A node whose elements have no
//! other node, as in a single layer between two contacts, is refused. Of a mass matrix that is not diagonal the node gives what it has
//! and what it shares, so that 1'M 1 keeps its value; where that would make a node lighter (consistent mass of tri6 and tet10) it is
//! refused.
//!
//! *Proven.* In each direction the mass of a body without what supports hold stays the same: the shares of a node sum to 1. M' >= M on
//! the inner nodes, since none of them loses mass (checked), and M there is a principal block, so that M' is definite. The centre of
//! mass moves: contact nodes lie at the outside of their elements, and no masses >= 0 added inside keep their first moments.
//! The distance is at most the size of these elements times their share of the mass.
//! The inner nodes see a potential that is convex and has a continuous slope, the least of u'Ku/2 - f'u over all contact nodes
//! in no penetration: nothing jumps when a contact opens or closes. Where its second derivative exists it is at most K of the
//! inner nodes, as the contact nodes may also stay where they are, held closed too; with M' >= M the contact-free step of (K, M) is stable with
//! contacts held open or closed, by interlacing. That opening and closing gains nothing is not proven.
//!
//! *Refused* too: massless nodes that could move without a force, as the two of a triangle about the third, and contacts that are
//! one and the same.

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
