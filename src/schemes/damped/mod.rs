//! Central differences with damping that lags half a step behind, and what damping makes of the other limits.

mod bound;
mod central_difference;
mod dampers;
mod predictor_corrector;

pub use bound::DampedBound;

use std::sync::Arc;

use super::{CentralDifference, Facts, Motion, Onset, PredictorCorrector, Scheme, System};
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
}

impl Scheme for DampedCentralDifference {
    fn facts(&self) -> Facts {
        let undamped = CentralDifference::FACTS;
        // Of a contact-free motion, which sees A and B alone.
        let order = if self.damping.of_bodies().is_none() { undamped.order } else { 1 };
        let onset = if self.damping.is_none() { undamped.onset } else { Onset::Linear };
        Facts {
            name: "damped-central-difference",
            title: "damped central difference",
            order,
            onset,
            reaction: "(s (g + c Z'v) + m Z'M^-1 (f - K u - (A M + B K) v))/(1 + m mu)",
            closed_limit: "4 (M + M_p) - 2 h C - h^2 (K + K_p) >= 0",
            source: "Belytschko, Liu, Moran, Nonlinear Finite Elements, 6.2",
            ..undamped
        }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        Ok(Box::new(central_difference::Steps::start(self.damping, &system, u, v)?))
    }

    fn limit<'a>(
        &self,
        pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Ok(Box::new(DampedLimit::new(pencil, spectrum, self.damping)))
    }
}

/// The predictor-corrector with bodies damped by A M + B K and contacts by c K_p; its limit is known from below, see
/// [`DampedBound`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DampedPredictorCorrector {
    damping: Damping,
}

impl DampedPredictorCorrector {
    /// With C = `damping`; without damping these are the steps of [`PredictorCorrector`].
    pub fn new(damping: Damping) -> Self {
        Self { damping }
    }
}

impl Scheme for DampedPredictorCorrector {
    fn facts(&self) -> Facts {
        Facts {
            name: "damped-predictor-corrector",
            title: "damped predictor-corrector",
            gains_nothing: false,
            reaction: "s (g_pred + c Z'v_pred)/(1 + m mu)",
            closed_limit: "at least where h^2 + c h = 1/s' mu and 4 M - 2 h (A M + B K) - h^2 K >= 0",
            ..PredictorCorrector.facts()
        }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        Ok(Box::new(predictor_corrector::Steps::start(self.damping, &system, u, v)?))
    }

    fn limit<'a>(
        &self,
        pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        damped_limit(SchemeName::PredictorCorrector, pencil, spectrum, self.damping)
    }
}

/// A scheme of this crate damped by C.
///
/// # Errors
/// Damping of other schemes, as [`damped_limit`].
pub fn damped(scheme: SchemeName, damping: Damping) -> Result<Arc<dyn Scheme>, Refusal> {
    match scheme {
        _ if damping.is_none() => Ok(scheme.into()),
        SchemeName::CentralDifference => Ok(Arc::new(DampedCentralDifference::new(damping))),
        SchemeName::PredictorCorrector => Ok(Arc::new(DampedPredictorCorrector::new(damping))),
        other => Err(no_damping(other)),
    }
}

fn no_damping(scheme: SchemeName) -> Refusal {
    let value = format!("{} with damping, whose limit is not derived", scheme.name());
    Refusal::new(
        "damping",
        value,
        "this scheme without damping, or central-difference and predictor-corrector with it",
    )
}

/// What is known of the limit of a scheme of this crate once it is damped by C, contacts closed.
///
/// - Central differences: the limit, [`DampedLimit`].
/// - Predictor-corrector: a step that is stable, below a limit that is not known, as the [derivation](DampedBound) says.
/// - Park: none. Its multipliers leave the unit circle at -1 only because the imaginary part of one function keeps its sign
///   there, and the velocity that C brings in takes this from the proof; no other condition is known.
///
/// # Errors
/// Damping of other schemes, and what the limit of the scheme itself refuses.
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
        other => Err(no_damping(other)),
    }
}
