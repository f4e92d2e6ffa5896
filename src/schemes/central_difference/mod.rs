//! Central differences with M + M_p in the closed contact.

mod motion;

use motion::Steps;

use super::{ContactSearch, Facts, Motion, Onset, Scheme, System};
use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::spectrum::{Engine, Spectrum, StepLimit};

/// The central difference scheme (paper, 4.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CentralDifference;

impl CentralDifference {
    pub(super) const FACTS: Facts = Facts {
        name: "central-difference",
        title: "central difference",
        solves: 1,
        order: 2,
        search: ContactSearch::StartOfStep,
        onset: Onset::SquareRoot,
        gains_nothing: false,
        reaction: "(s g + m Z'M^-1 (f - K u))/(1 + m mu)",
        closed_limit: "2/omega_max of (K + K_p, M + M_p)",
        source: "Kolman et al. 2021, 4.3",
    };
}

impl Scheme for CentralDifference {
    fn facts(&self) -> Facts {
        Self::FACTS
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        Ok(Box::new(Steps::start(&system, u, v)?))
    }

    fn limit<'a>(
        &self,
        _pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Ok(Box::new(Spectrum(spectrum)))
    }
}
