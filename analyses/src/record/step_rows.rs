//! Rows of a time step that is held against the limits.

use serde::Serialize;

use super::rows::Subject;
use super::{Number, StabilityRow};
use bipenalty::stability::Largest;

/// A step at one point (beta_s, r): whether it is within the limit there, and what the step stands along both axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepRow {
    /// Name of the scene.
    pub scene: String,
    /// As in [`StabilityRow`].
    pub mass: String,
    /// gamma of the mass matrix; empty for matrices.
    pub gamma: Option<Number>,
    /// Elements of all bars or bodies; empty for matrices.
    pub elements: Option<usize>,
    /// Whose limit.
    pub limit: &'static str,
    /// dt, s.
    pub time_step: Number,
    /// beta_s; 0 without contact.
    pub stiffness_penalty: Number,
    /// r.
    pub ratio: Number,
    /// Whether dt is within the limit of this point; empty where the enclosure does not tell.
    pub within: Option<bool>,
    /// `step_lower`/dt - 1: how much larger the step could be; negative beyond the limit.
    pub margin: Option<Number>,
    /// Lower bound of dt_cr, s.
    pub step_lower: Option<Number>,
    /// Upper bound of dt_cr, s; infinite where none is known.
    pub step_upper: Option<Number>,
    /// As in [`StabilityRow`].
    pub evidence: String,
    /// The largest beta_s that the step stands at this ratio, `inf` where any will do; empty where not even beta_s = 0 is.
    pub largest_stiffness_penalty: Option<Number>,
    /// The step is proven to be within the limit up to this beta_s.
    pub largest_stiffness_penalty_lower: Option<Number>,
    /// The step is proven to be beyond the limit from this beta_s on; `inf` where that is not known.
    pub largest_stiffness_penalty_upper: Option<Number>,
    /// `largest_stiffness_penalty_lower` times the smallest scale of the contacts, N/m.
    pub largest_penalty_stiffness: Option<Number>,
    /// The largest ratio that the step stands at this beta_s, `inf` where any will do.
    pub largest_ratio: Option<Number>,
    /// The step is proven to be within the limit up to this ratio.
    pub largest_ratio_lower: Option<Number>,
    /// The step is proven to be beyond the limit from this ratio on; `inf` where that is not known.
    pub largest_ratio_upper: Option<Number>,
}

impl StepRow {
    /// `time_step`, s, held against the limit of `row`, a point of the subject's map.
    pub fn new(
        subject: &Subject,
        row: &StabilityRow,
        time_step: f64,
        penalty: Option<Largest>,
        ratio: Option<Largest>,
    ) -> Self {
        let StabilityRow { step_lower, step_upper, .. } = *row;
        let within = match (step_lower, step_upper) {
            (Some(lower), _) if time_step <= lower.0 => Some(true),
            (_, Some(upper)) if time_step > upper.0 => Some(false),
            _ => None,
        };
        let number = |of: Option<Largest>, part: fn(Largest) -> f64| of.map(|found| Number(part(found)));
        let stiffness = |scale: f64| Some(Number(penalty?.lower * scale));
        Self {
            scene: row.scene.clone(),
            mass: row.mass.clone(),
            gamma: row.gamma,
            elements: row.elements,
            limit: row.limit,
            time_step: Number(time_step),
            stiffness_penalty: row.stiffness_penalty,
            ratio: row.ratio,
            within,
            margin: step_lower.map(|lower| Number(lower.0 / time_step - 1.0)),
            step_lower,
            step_upper,
            evidence: row.evidence.clone(),
            largest_stiffness_penalty: number(penalty, |found| found.value),
            largest_stiffness_penalty_lower: number(penalty, |found| found.lower),
            largest_stiffness_penalty_upper: number(penalty, |found| found.upper),
            largest_penalty_stiffness: subject.scale().and_then(stiffness),
            largest_ratio: number(ratio, |found| found.value),
            largest_ratio_lower: number(ratio, |found| found.lower),
            largest_ratio_upper: number(ratio, |found| found.upper),
        }
    }
}
