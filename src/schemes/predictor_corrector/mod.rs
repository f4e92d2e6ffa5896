//! The stabilised predictor-corrector scheme of the paper.

mod bound;
mod definite;
mod determinant;
mod growth;
mod limit;
mod motion;

pub(super) use bound::Bound;
pub use limit::ClosedLimit;
use motion::Steps;
pub(super) use motion::energy;

use super::closed::ClosedContacts;
use super::{ContactSearch, Facts, Motion, Onset, Scheme, System};
use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::spectrum::{Engine, StepLimit};

/// The stabilised predictor-corrector scheme (paper, 4.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PredictorCorrector;

impl Scheme for PredictorCorrector {
    fn facts(&self) -> Facts {
        Facts {
            name: "predictor-corrector",
            title: "predictor-corrector",
            solves: 1,
            order: 1,
            search: ContactSearch::Predictor,
            onset: Onset::Linear,
            gains_nothing: true,
            reaction: "s g_pred/(1 + m mu)",
            closed_limit: "dt^2 s' mu = 1",
            source: "Kolman et al. 2021, 4.4",
        }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        Ok(Box::new(Steps::start(&system, u, v)?))
    }

    fn limit<'a>(
        &self,
        pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        if pencil.chain().is_none() || spectrum.condensed().is_none() {
            return Ok(Box::new(Bound::new(pencil, spectrum)?));
        }
        let closed = ClosedContacts::new(pencil, spectrum, self.facts().name)?;
        match ClosedLimit::check(&closed) {
            Ok(()) => Ok(Box::new(ClosedLimit { closed })),
            Err(_) => Ok(Box::new(Bound::of_bars(&closed))),
        }
    }
}
