//! Central differences with damping that lags half a step behind, and what damping makes of the other limits.

mod bound;
mod motion;

pub use bound::DampedBound;
use motion::Steps;

use super::{CentralDifference, ContactSearch, Facts, Motion, Onset, Scheme, System};
use crate::damping::{DampedLimit, Damping};
use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::schemes::SchemeName;
use crate::spectrum::{Engine, StepLimit};

/// (M + M_p) a = f - (K + K_p) u - C v with the velocity v half a step before u; see [`damping`](crate::damping).
///
/// The damper of a contact acts while it is closed, in tension too: its reaction s (g + c Z'v) + m Z'a may pull.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DampedCentralDifference {
    damping: Damping,
}

impl DampedCentralDifference {
    /// With C = `damping`; without damping these are the steps of [`CentralDifference`].
    pub fn new(damping: Damping) -> Self {
        Self { damping }
    }

    /// C.
    pub fn damping(&self) -> Damping {
        self.damping
    }
}

impl Scheme for DampedCentralDifference {
    fn facts(&self) -> Facts {
        let undamped = CentralDifference.facts();
        // Of a contact-free motion, which sees A and B alone.
        let order = if self.damping.of_bodies().is_none() { undamped.order } else { 1 };
        let onset = if self.damping.is_none() { undamped.onset } else { Onset::Linear };
        Facts {
            name: "damped-central-difference",
            title: "damped central difference",
            search: ContactSearch::StartOfStep,
            order,
            onset,
            reaction: "(s (g + c Z'v) + m Z'M^-1 (f - K u - (A M + B K) v))/(1 + m mu)",
            closed_limit: "4 (M + M_p) - 2 h C - h^2 (K + K_p) >= 0",
            source: "Belytschko, Liu, Moran, Nonlinear Finite Elements, 6.2",
            ..undamped
        }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        Ok(Box::new(Steps::start(self.damping, &system, u, v)?))
    }

    fn limit<'a>(
        &self,
        pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Ok(Box::new(DampedLimit::new(pencil, spectrum, self.damping)))
    }
}

/// What is known of the limit of a scheme of this crate once it is damped by C, contacts closed.
///
/// - Central differences: the limit, [`DampedLimit`].
/// - Predictor-corrector: a step that is stable, below a limit that is not known, as the [derivation](DampedBound) says.
/// - Park: none. Its multipliers leave the unit circle at -1 only because the imaginary part of one function keeps its sign
///   there, and the velocity that C brings in takes this from the proof; no other condition is known.
///
/// # Errors
/// The Park scheme with damping, and what the limit of the scheme itself refuses.
pub fn damped_limit<'a>(
    scheme: SchemeName,
    pencil: &'a Pencil,
    spectrum: Box<dyn Engine + 'a>,
    damping: Damping,
) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
    if damping.is_none() {
        return scheme.scheme().limit(pencil, spectrum);
    }
    match scheme {
        SchemeName::CentralDifference => Ok(Box::new(DampedLimit::new(pencil, spectrum, damping))),
        SchemeName::PredictorCorrector => Ok(Box::new(DampedBound::new(pencil, spectrum, damping)?)),
        SchemeName::Park => Err(Refusal::new(
            "damping",
            "the Park scheme with damping, whose limit is not derived",
            "the Park scheme without damping, or central-difference and predictor-corrector with it",
        )),
    }
}
