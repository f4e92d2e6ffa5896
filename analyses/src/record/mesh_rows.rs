//! Rows of what a rule or a proof says of the step of a mesh, beside what it is.

use serde::Serialize;

use super::Number;

/// One estimate of a critical step beside the enclosed one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshRow {
    /// `elements`, `sizes`, `bounds`, `rules` or `scales`.
    pub study: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// The element of the upper body.
    pub element: &'static str,
    /// Unknowns.
    pub unknowns: usize,
    /// Contacts.
    pub contacts: usize,
    /// What is varied: the size of the upper cells over that of the lower, elements along an edge of a patch, or the penalty
    /// scale; empty where that is beta_s.
    pub parameter: Option<Number>,
    /// beta_s.
    pub stiffness_penalty: Number,
    /// r.
    pub ratio: Number,
    /// What tells the step: `exact`, or a rule.
    pub estimate: &'static str,
    /// The estimated step, s; of `exact` the proven lower bound.
    pub step: Number,
    /// Bounds of the critical step, s.
    pub step_lower: Number,
    /// See `step_lower`.
    pub step_upper: Number,
    /// `step`/`step_lower` - 1: above 0 the rule is too bold, below it wastes. 0 of `exact`.
    pub error: Number,
    /// `step` over the contact-free step.
    pub relative_step: Number,
    /// c dt/h of `step` with the speed c of pressure waves and the edge h of a cell of the upper body; empty where there is no
    /// one cell.
    pub courant: Option<Number>,
}

impl MeshRow {
    /// Whether a step that is proven to be stable is one.
    pub fn holds(&self) -> bool {
        !matches!(self.estimate, "patches" | "element") || self.step.0 <= self.step_upper.0
    }
}
