//! Limits by stepping alone, beside the predicted ones.

use std::sync::Arc;

use bipenalty::error::Result;
use bipenalty::schemes::Scheme;
use bipenalty::stability::{AnyModel, Asking, LimitOf};
use bipenalty::verify::{PenaltyPoint, Prediction, Predictor, Search, confirm, limit_of_any};

/// The predicted limit, a stable and an unstable step, s; steps of a trial; growth; whether the prediction agrees.
pub type SteppedTuple = ([f64; 3], u64, f64, Option<bool>);

/// The limit of a scheme by stepping, beside the predicted one; of bars the search begins at the prediction.
///
/// # Errors
/// What a trial refuses; a predicted limit that could not be enclosed.
pub fn stepped(
    model: &AnyModel,
    scheme: Arc<dyn Scheme>,
    point: PenaltyPoint,
    tolerance: f64,
) -> Result<SteppedTuple> {
    let (predicted, found, agrees) = match model {
        AnyModel::Bars(bars) => {
            let pencil = bars.pencil();
            let predicted = Predictor::new(bars, &pencil, &*scheme)?.at(point, tolerance)?;
            let confirmed = confirm(bars, &*scheme, point, tolerance, Some(predicted.clone()))?;
            (predicted.courant, confirmed.found, confirmed.agrees)
        }
        AnyModel::Mesh(_) => {
            let search = Search::to(tolerance, &*scheme)?;
            let found = limit_of_any(model, &*scheme, point, &search)?.courant;
            let asking = Asking { limit: LimitOf::Scheme(scheme), ..Asking::default() };
            match model.critical_step(point.stiffness_penalty.get(), point.ratio.get(), &asking) {
                Ok(predicted) => {
                    let step = predicted.step?;
                    let (courant, evidence) = (step.critical_courant, step.evidence);
                    let (growth, steps_needed, islands) = (None, None, Vec::new());
                    let prediction = Prediction { courant, evidence, growth, steps_needed, islands };
                    (courant, found, found.judge(&prediction, tolerance))
                }
                // The limit of this scheme is not derived for meshes.
                Err(_) => (f64::NAN, found, None),
            }
        }
    };
    let seconds = |courant: f64| model.time_step(courant);
    let seconds = [seconds(predicted)?, seconds(found.stable_at)?, seconds(found.unstable_at)?];
    Ok((seconds, found.steps, found.growth, agrees))
}
