//! Rows of limits that were confirmed by stepping.

use serde::Serialize;

use super::{GIVEN, Number};
use bipenalty::schemes::Scheme;
use bipenalty::stability::AnyModel;
use bipenalty::verify::{Confirmation, PenaltyPoint};

/// A predicted limit beside the one that stepping found; Courant numbers are c0 dt/h of the reference element of bars, and
/// omega_ref dt/2 of matrices and meshes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerifyRow {
    /// Name of the scene.
    pub scene: String,
    /// `lumped`, `averaged`, `consistent`, gamma, or [`GIVEN`] for matrices that bring their own.
    pub mass: String,
    /// gamma of the mass matrix; empty for matrices.
    pub gamma: Option<Number>,
    /// Elements of all bars or bodies; empty for matrices.
    pub elements: Option<usize>,
    /// Name of the scheme.
    pub scheme: &'static str,
    /// `closed`: the contacts are held closed; `opening`: they open and close, see [`VerifyRow::opening`].
    pub contact: &'static str,
    /// beta_s.
    pub stiffness_penalty: Number,
    /// r.
    pub ratio: Number,
    /// The predicted limit; empty where there is none.
    pub predicted: Option<Number>,
    /// The Courant number just below the limit, whose trial did not grow, found by stepping alone; 0 if every step grew.
    pub stable_at: Number,
    /// The next one that is tried, whose trial did.
    pub unstable_at: Number,
    /// Steps of a stable trial: by scheme and tolerance alone.
    pub steps: u64,
    /// Growth at `unstable_at`, ln of the factor a step.
    pub growth: Number,
    /// Whether the prediction lies within the tolerance of the bracket; unknown without a prediction, and where the
    /// predicted growth needs more than `steps` to be seen and no trial below the prediction grew.
    pub agrees: Option<bool>,
    /// Predicted growth at (1 + tolerance) times the predicted limit, ln of the factor a step.
    pub predicted_growth: Option<Number>,
    /// Steps of a trial that would show it.
    pub steps_needed: Option<Number>,
    /// Courant numbers between which the scheme is predicted to be stable again above its limit, `low-high`, with blanks
    /// between; empty if there are none.
    pub islands: String,
}

impl VerifyRow {
    /// The row of one point with contacts held closed.
    pub fn new(
        model: &AnyModel,
        scheme: &dyn Scheme,
        point: PenaltyPoint,
        confirmation: &Confirmation,
    ) -> Self {
        let Confirmation { predicted, found, agrees } = confirmation;
        let predicted = predicted.as_ref();
        let islands = predicted.iter().flat_map(|predicted| &predicted.islands);
        let islands = islands.map(|(low, high)| format!("{low:.6}-{high:.6}"));
        Self {
            scene: model.name().to_owned(),
            mass: model.mass().map_or_else(|| GIVEN.to_owned(), |mass| mass.name()),
            gamma: model.mass().map(|mass| Number(mass.gamma())),
            elements: model.elements(),
            scheme: scheme.facts().name,
            contact: "closed",
            stiffness_penalty: Number(point.stiffness_penalty.get()),
            ratio: Number(point.ratio.get()),
            predicted: predicted.map(|predicted| Number(predicted.courant)),
            stable_at: Number(found.stable_at),
            unstable_at: Number(found.unstable_at),
            steps: found.steps,
            growth: Number(found.growth),
            agrees: *agrees,
            predicted_growth: predicted.and_then(|predicted| predicted.growth).map(Number),
            steps_needed: predicted.and_then(|predicted| predicted.steps_needed).map(Number),
            islands: islands.collect::<Vec<_>>().join(" "),
        }
    }
}
