//! Limits by stepping alone, beside the predicted ones.

use std::sync::Arc;

use bipenalty::error::{Refusal, Result};
use bipenalty::schemes::Scheme;
use bipenalty::stability::{AnyModel, Asking, Grid, LimitOf};
use bipenalty::verify::{PenaltyPoint, Prediction, confirm_any, predict_any};

/// The predicted limit, a stable and an unstable step, s; steps of a trial; growth; whether the prediction agrees.
pub type SteppedTuple = ([f64; 3], u64, f64, Option<bool>);

/// The limit of a scheme by stepping, beside the predicted one: NaN where none is derived.
///
/// # Errors
/// What a trial refuses; a predicted limit that could not be enclosed.
pub fn stepped(
    model: &AnyModel,
    scheme: &Arc<dyn Scheme>,
    limit: LimitOf,
    point: PenaltyPoint,
    tolerance: f64,
) -> Result<SteppedTuple> {
    let predicted = predicted(model, scheme, limit, point, tolerance).ok();
    let courant = predicted.as_ref().map_or(f64::NAN, |predicted| predicted.courant);
    let confirmed = confirm_any(model, &**scheme, point, tolerance, predicted)?;
    let found = confirmed.found;
    let seconds = |courant: f64| model.time_step(courant);
    let seconds = [seconds(courant)?, seconds(found.stable_at)?, seconds(found.unstable_at)?];
    Ok((seconds, found.steps, found.growth, confirmed.agrees))
}

fn predicted(
    model: &AnyModel,
    scheme: &Arc<dyn Scheme>,
    limit: LimitOf,
    point: PenaltyPoint,
    tolerance: f64,
) -> Result<Prediction> {
    if let (AnyModel::Mesh(_), LimitOf::Damped(_)) = (model, &limit) {
        let asking = Asking { limit, ..Asking::default() };
        let step = model.critical_step(point.stiffness_penalty.get(), point.ratio.get(), &asking)?.step?;
        let (courant, evidence) = (step.critical_courant, step.evidence);
        return Ok(Prediction { courant, evidence, growth: None, steps_needed: None, islands: Vec::new() });
    }
    let grid = Grid { stiffness_penalties: vec![point.stiffness_penalty], ratios: vec![point.ratio] };
    let none = || Refusal::new("grid", "no point", "one");
    Ok(predict_any(model, scheme, &grid, tolerance).pop().ok_or_else(none)??)
}
