//! The largest penalty ratio that costs no time step against the contact-free scene.
//!
//! The mediant inequality on the Rayleigh quotient gives l_max(K + K_p, M + M_p) <= max(l_max(K, M), r omega_e^2) for
//! any mesh, so every r <= r* = l_max(K, M)/omega_e^2 is free of cost, for every beta_s. When the top mode moves a
//! gap of the stiffest contact, a larger r costs a step at once: r* is the optimum, 1 for a bar with free ends.

use super::Model;
use crate::error::Refusal;
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::spectrum::{Enclosure, Engine, Uncertified, bisect};

/// The optimal ratio at one beta_s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OptimalRatio {
    /// beta_s.
    pub stiffness_penalty: StiffnessPenalty,
    /// The largest ratio without cost, as found.
    pub value: f64,
    /// Proven: this ratio costs nothing (mediant inequality on the certified contact-free l_max).
    pub lower: f64,
    /// Proven: this ratio costs a step (the enclosures of the two l_max are apart).
    pub upper: f64,
}

/// What the search is held against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expectation {
    /// The certified contact-free l_max, rad^2/s^2.
    pub contact_free: Enclosure,
    /// The largest omega_e^2 of the elements that touch a contact, rad^2/s^2.
    pub element_eigenvalue: f64,
}

impl Expectation {
    /// The expectation for `model`, whose eigenvalues `engine` finds.
    ///
    /// # Errors
    /// Passes on an eigenvalue that could not be certified.
    pub fn of(model: &Model, engine: &dyn Engine) -> Result<Self, Uncertified> {
        let contact_free = engine.enclose(&vec![Default::default(); model.scales().len()], None)?;
        let element_eigenvalue = model.scales().iter().map(|s| s.element_eigenvalue).fold(0.0, f64::max);
        Ok(Self { contact_free, element_eigenvalue })
    }

    /// r* = l_max(K, M)/omega_e^2.
    pub fn ratio(&self) -> f64 {
        self.contact_free.value / self.element_eigenvalue
    }

    /// A proven lower bound of r*; omega_e^2 and the quotient carry four roundings.
    fn lower(&self) -> f64 {
        self.contact_free.lower / self.element_eigenvalue * (1.0 - 2.0 * f64::EPSILON)
    }
}

/// The widest ratio that is searched: beyond, a contact that costs nothing is called free of any limit.
const LARGEST_RATIO: f64 = 1e12;

/// Brackets the largest r that costs no step at `beta_s`; `None` if none up to 1e12 provably costs one (beta_s = 0, or
/// so small that its effect is below rounding).
///
/// # Errors
/// Passes on an eigenvalue that could not be certified.
pub fn optimal_ratio(
    model: &Model,
    engine: &dyn Engine,
    expectation: &Expectation,
    beta_s: StiffnessPenalty,
) -> Result<Option<OptimalRatio>, Uncertified> {
    let free = expectation.contact_free;
    let penalised = |r: Ratio| engine.enclose(&model.penalties(beta_s, r), None);
    let costs = |r: f64| match Ratio::new(r).map(penalised) {
        Ok(Ok(l)) => l.lower > free.upper,
        _ => false,
    };
    penalised(Ratio::OPTIMAL)?;
    if !costs(LARGEST_RATIO) {
        return Ok(None);
    }
    let lower = expectation.lower();
    let (_, upper) = bisect(lower, LARGEST_RATIO, costs);
    let value = value_between(&penalised, free.value, lower, upper);
    Ok(Some(OptimalRatio { stiffness_penalty: beta_s, value, lower, upper }))
}

/// The last ratio between proven bounds whose computed l_max does not exceed the computed contact-free one.
fn value_between(
    penalised: &dyn Fn(Ratio) -> Result<Enclosure, Uncertified>,
    free: f64,
    lower: f64,
    upper: f64,
) -> f64 {
    let exceeds = |r: f64| match Ratio::new(r).map(penalised) {
        Ok(Ok(l)) => l.value > free,
        _ => true,
    };
    bisect(lower, upper, exceeds).0
}

/// Refuses a scene without a contact: it has no ratio to optimise.
///
/// # Errors
/// Names the scene.
pub fn check_has_contact(model: &Model) -> Result<(), Refusal> {
    if model.scales().is_empty() {
        return Err(Refusal::new("SCENE", model.scene().name(), "a scene with at least one contact"));
    }
    Ok(())
}
