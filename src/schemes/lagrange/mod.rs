//! Central differences with Lagrange multipliers by forward increments (Carpenter, Taylor, Katona, Int. J. Numer. Meth.
//! Eng. 32, 1991): the contact condition is that of the *next* displacement.
//!
//! ```text
//! M (v_{n+1/2} - v_{n-1/2}) = dt (f - K u_n - Z lambda_n)      0 <= lambda_n   perpendicular to   g_{n+1} <= 0
//! ```
//! The paper finds lambda by Gauss-Seidel sweeps; here the complementarity problem is solved, directly where no two contacts
//! act on each other. No penalty: beta_s and r have no effect. It is [`Buffered`](super::Buffered) with stops that do not
//! move, and what is proven there holds here: *for dt < dt_c the leapfrog energy never grows*, for any number of contacts,
//! any mass matrix and any sequence of openings, since each contact adds lambda_n (g_{n-1} - g_{n+1})/2 = lambda_n g_{n-1}/2 <= 0.
//! The scheme of Paoli and Schatzman with the restitution 0 is the same one.

use super::impulses::{Buffer, ForwardIncrement, Steps};
use super::rigid::ContactFree;
use super::{ContactSearch, Facts, Motion, Onset, Scheme, System};
use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::spectrum::{Engine, StepLimit};

/// Central differences with Lagrange multipliers by forward increments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lagrange;

impl Scheme for Lagrange {
    fn facts(&self) -> Facts {
        Facts {
            name: "lagrange",
            title: "Lagrange, forward increments",
            solves: 1,
            order: 2,
            search: ContactSearch::StartOfStep,
            onset: Onset::SquareRoot,
            gains_nothing: true,
            reaction: "0 <= lambda perpendicular to g_{n+1} <= 0",
            closed_limit: "2/omega_max of (K, M) or more",
            source: "Carpenter, Taylor, Katona 1991",
        }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        let buffers = vec![Buffer::RIGID; system.pencil.gaps().len()];
        Ok(Box::new(Steps::start(ForwardIncrement, buffers, &system, u, v)?))
    }

    fn limit<'a>(
        &self,
        _pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Ok(Box::new(ContactFree(spectrum)))
    }
}
