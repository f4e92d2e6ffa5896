//! The rows of what a scheme costs: how far one evaluation of the internal force gets.

use super::columns::columns;
use super::read::{NOT_NEGATIVE, POSITIVE};
use super::{Number, StabilityRow};

columns! {
    /// The limit of one scheme at one point, and what it pays for it.
    CostRow, 17 required:
    /// Name of the scene.
    scene: String = word(),
    /// As in [`StabilityRow`].
    mass: String = word(),
    /// gamma of the mass matrix; empty for matrices.
    gamma: Option<Number> = gamma(),
    /// Elements of all bars or bodies; empty for matrices.
    elements: Option<usize> = elements(),
    /// The scheme.
    limit: &'static str = limit(),
    /// Its parameter: theta of Park's, that of the other schemes by its name in their sources; empty where it has none.
    parameter: Option<Number> = result(NOT_NEGATIVE),
    /// Products M^-1 (f - K u) in a step.
    evaluations: usize = count(),
    /// beta_s.
    stiffness_penalty: Number = stiffness_penalty(),
    /// r.
    ratio: Number = ratio(),
    /// C_r as in [`StabilityRow`].
    critical_courant: Option<Number> = enclosed(["lower", "upper"], POSITIVE),
    /// Lower bound of C_r.
    lower: Option<Number> = result(POSITIVE),
    /// Upper bound of C_r; infinite where none is known.
    upper: Option<Number> = bound(POSITIVE),
    /// The engine that found the value.
    engine: String = word(),
    /// Lower bound of dt_cr, s.
    step_lower: Option<Number> = result(POSITIVE),
    /// step_lower/evaluations, s: the time that one force buys.
    step_per_force: Option<Number> = result(POSITIVE),
    /// The fewest forces for a time, over those of central differences without contact: C_0 evaluations/C_r, with the lower
    /// bound where C_r is known from below only.
    cost: Option<Number> = result(POSITIVE),
    /// As in [`StabilityRow`].
    evidence: String = evidence(),
    /// s = beta_s times the smallest scale of the contacts, N/m.
    penalty_stiffness: Option<Number> = result(NOT_NEGATIVE),
}

/// What a scheme is taken with and what a step of it costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Price {
    /// Its parameter, if it has one.
    pub parameter: Option<f64>,
    /// Products M^-1 (f - K u) in a step.
    pub evaluations: usize,
    /// C_r of central differences without contact.
    pub contact_free: f64,
}

impl CostRow {
    /// What the limit of `row` costs at this price.
    pub fn new(row: StabilityRow, price: Price) -> Self {
        let forces = price.evaluations as f64;
        let courant = row.stable_courant();
        Self {
            parameter: price.parameter.map(Number),
            evaluations: price.evaluations,
            step_per_force: row.step_lower.map(|step| Number(step.0 / forces)),
            cost: courant.map(|courant| Number(price.contact_free * forces / courant)),
            scene: row.scene,
            mass: row.mass,
            gamma: row.gamma,
            elements: row.elements,
            limit: row.limit,
            stiffness_penalty: row.stiffness_penalty,
            ratio: row.ratio,
            critical_courant: row.critical_courant,
            lower: row.lower,
            upper: row.upper,
            engine: row.engine,
            step_lower: row.step_lower,
            evidence: row.evidence,
            penalty_stiffness: row.penalty_stiffness,
        }
    }
}
