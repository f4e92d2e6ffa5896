//! Rows of the studies of impact.

use serde::Serialize;

use super::Number;

/// One impact of the block of the studies, measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StudyRow {
    /// `cells`, `penalty`, `oscillation` or `cost`.
    pub study: &'static str,
    /// Name of the scheme.
    pub scheme: &'static str,
    /// Cells along the block.
    pub cells: usize,
    /// Unknowns.
    pub unknowns: usize,
    /// Contacts.
    pub contacts: usize,
    /// beta_s.
    pub stiffness_penalty: Number,
    /// r.
    pub ratio: Number,
    /// dt over the contact-free step.
    pub relative_courant: Number,
    /// What the limit rests on of which the step is a share: `enclosed`, `contact-free`, `by stepping`; empty where the step is
    /// a share of the contact-free one.
    pub limit: &'static str,
    /// Steps done.
    pub steps: u64,
    /// rms of the resultant minus the exact force, over the peak exact force.
    pub force_error: Option<Number>,
    /// Impulse at the end minus the exact one, over it.
    pub impulse_error: Option<Number>,
    /// The largest force over the largest exact one, minus 1.
    pub overshoot: Option<Number>,
    /// The total variation of the force over that of the exact one.
    pub variation: Option<Number>,
    /// Median of g/h of the most closed contact over the middle half of the contact.
    pub steady_relative_gap: Option<Number>,
    /// Energy at the end over that at the start.
    pub energy_ratio: Option<Number>,
    /// The largest net work of the contacts on the block over the energy at the start: what opening and closing has given.
    pub energy_gain: Number,
    /// How often contacts have opened or closed.
    pub switches: u64,
    /// Time of the steps alone, s; only of `cost`.
    pub seconds: Option<Number>,
}
