//! Explicit time schemes with bi-penalty contact: one step each, on vectors, without allocation for bars.
//!
//! A [`Scheme`] is a value with its parameters; it starts a [`Motion`] of a [`System`] of matrices and contacts, and knows
//! the largest step that closed contact lets it make. Each has a folder of its own: facts, state and step, energy, limit.
//! [`Body`], [`State`], [`Operator`] and [`Contacts`] are what they share, and what a scheme of one's own is made of.
//! Beside the schemes of the paper there are [`Buffered`], central differences whose contact mass pays for what it takes, and
//! schemes without penalty: [`Lagrange`], [`MoreauJean`], [`PaoliSchatzman`], [`MassRedistribution`]. All but the last share
//! `impulses`; the last solves at each step what [`StaticContact`] solves for bodies at rest.
//! Sources: Kolman, Kopačka, González, Cho, Park, Math. Comput. Simulat. 189 (2021), 4.3 to 4.5 ("the paper"); Park, Lim,
//! Huh, Int. J. Numer. Meth. Eng. 91 (2012); Cho, Park, Huh, Comput. Mech. 52 (2013).
//!
//! ```
//! use bipenalty::schemes::{ContactSearch, Park, Scheme, SchemeName};
//! // What distinguishes the schemes is one table.
//! assert_eq!(Park::new(0.5)?.facts().search, ContactSearch::Predictor);
//! assert_eq!("central-difference".parse(), Ok(SchemeName::CentralDifference));
//! # Ok::<(), bipenalty::error::Refusal>(())
//! ```

mod body;
mod buffered;
mod central_difference;
mod closed;
mod complementarity;
mod contact;
mod damped;
mod energy;
pub mod explicit;
mod flexible;
mod impulses;
mod inertia;
mod kernels;
mod lagrange;
mod mass_redistribution;
mod moreau_jean;
mod name;
mod nodes;
mod operator;
mod paoli_schatzman;
mod park;
mod predictor_corrector;
mod rigid;
mod rows;
mod state;
mod statics;
mod twisted;

use std::fmt::Debug;

pub use body::{Body, System};
pub use buffered::Buffered;
pub use central_difference::CentralDifference;
pub use contact::Contacts;
pub use damped::{DampedBound, DampedCentralDifference, DampedPredictorCorrector, damped, damped_limit};
pub use energy::Energy;
pub use lagrange::Lagrange;
pub use mass_redistribution::MassRedistribution;
pub use moreau_jean::MoreauJean;
pub use name::SchemeName;
pub use operator::Operator;
pub use paoli_schatzman::PaoliSchatzman;
pub use park::{Fractions, Park};
pub use predictor_corrector::{ClosedLimit, PredictorCorrector};
pub use state::{ContactRule, State};
pub use statics::{Equilibrium, StaticContact};

use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::spectrum::{Engine, StepLimit};

/// When a scheme looks for contact, which is also the time of the force it reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactSearch {
    /// On the displacement at the start of the step.
    StartOfStep,
    /// On the predicted displacement at the end of the step.
    Predictor,
}

/// How fast a motion grows just above the limit, at the relative distance e from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Onset {
    /// By 2 sqrt(2 e) a step, as without damping.
    SquareRoot,
    /// By about e a step: the scheme damps what reaches the contact.
    Linear,
}

/// What is known of a scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// The name in records.
    pub name: &'static str,
    /// The name in a chart.
    pub title: &'static str,
    /// Products M^-1 (f - K u) in a step.
    pub solves: usize,
    /// Order of accuracy in dt of a smooth contact-free motion as its records give it.
    pub order: usize,
    /// When contact is searched.
    pub search: ContactSearch,
    /// How growth begins above the limit.
    pub onset: Onset,
    /// Whether contacts that open and close are proven to add no energy below the limit, or what bounds it from below, in
    /// exact arithmetic and from an open start; see `verify::opening`.
    pub gains_nothing: bool,
    /// lambda, the reaction that enters the momentum balance.
    pub reaction: &'static str,
    /// The largest stable step while the contact is closed and nothing else limits it.
    pub closed_limit: &'static str,
    /// Where the scheme is defined.
    pub source: &'static str,
}

/// An explicit time scheme with its parameters.
pub trait Scheme: Debug + Send + Sync {
    /// What is known of it. mu = Z'M^-1 Z, s' = s/(1 + m mu).
    fn facts(&self) -> Facts;

    /// The motion of `system` from u (m) and v (m/s), n entries each.
    ///
    /// # Errors
    /// Refuses a step that is not positive and finite and what the scheme is not made for.
    fn start(
        &self,
        system: System<'_>,
        displacement: Vec<f64>,
        velocity: Vec<f64>,
    ) -> Result<Box<dyn Motion>, Refusal>;

    /// The Park scheme, if this is it: the one scheme whose limit on any mesh is told by the flexibility of the contacts.
    fn as_park(&self) -> Option<Park> {
        None
    }

    /// The largest step while every contact of `pencil` is closed; `spectrum` is an engine of the same pencil.
    ///
    /// # Errors
    /// Refuses what the limit is not derived for.
    fn limit<'a>(
        &self,
        pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal>;
}

/// A motion in time steps.
pub trait Motion {
    /// One step.
    fn step(&mut self);

    /// Brings forces and accelerations to the time of u, where a step leaves them behind. Nothing is computed twice and
    /// no result changes.
    fn synchronise(&mut self) {}

    /// Displacements, gaps, forces; the latter belong to the time of u after [`Motion::synchronise`].
    fn state(&self) -> &State;

    /// v at the time of u, m/s, into `velocity`; the motion must be synchronised.
    fn velocity(&self, velocity: &mut [f64]) {
        velocity.copy_from_slice(&self.state().velocity);
    }

    /// The energies at the time of u; synchronises.
    fn energy(&mut self) -> Energy;
}
