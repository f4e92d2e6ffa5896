//! The largest penalty ratio that costs no time step against the contact-free scene.
//!
//! The mediant inequality on the Rayleigh quotient gives l_max(K + K_p, M + M_p) <= max(l_max(K, M), r omega_e^2) for
//! any mesh, so every r <= r* = l_max(K, M)/omega_e^2 is free of cost, for every beta_s. When the top mode moves a
//! gap of the stiffest contact, a larger r costs a step at once: r* is the optimum, 1 for a bar with free ends.

use super::{Model, UniformBar};
use crate::error::Refusal;
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::pencil::Penalty;
use crate::scene::{Bar, End};
use crate::spectrum::{Enclosure, Evidence, StepLimit, Uncertified, bisect};

/// The optimal ratio at one beta_s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OptimalRatio {
    /// beta_s.
    pub stiffness_penalty: StiffnessPenalty,
    /// The largest ratio without cost, as found; `lower` where the limit is known from below only.
    pub value: f64,
    /// Proven: this ratio costs nothing (mediant inequality on the certified contact-free l_max).
    pub lower: f64,
    /// Proven: this ratio costs a step (the enclosures of the two l_max are apart); infinite where the limit is known from
    /// below only.
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
    /// The expectation for `model`, whose contact-free `limit` is that of the spectrum.
    ///
    /// # Errors
    /// Passes on an eigenvalue that could not be certified.
    pub fn of(model: &Model, limit: &dyn StepLimit) -> Result<Self, Uncertified> {
        let contact_free = limit.enclose(&Penalty::NONE, None)?.l;
        Ok(Self { contact_free, element_eigenvalue: model.reference_eigenvalue() })
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
    limit: &dyn StepLimit,
    expectation: &Expectation,
    beta_s: StiffnessPenalty,
) -> Result<Option<OptimalRatio>, Uncertified> {
    let free = expectation.contact_free;
    let penalised = |r: Ratio| limit.enclose(&model.penalty(beta_s, r), None).map(|step| step.l);
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

/// The same for the limit of a scheme: the largest r whose limit is not below the contact-free one, between one that
/// is proven to cost nothing ([`StepLimit::costs_nothing`]) and one whose enclosure lies apart. Park: 0 and no lower
/// bound where every ratio costs.
///
/// # Errors
/// Passes on a limit that could not be certified.
pub fn optimal_scheme_ratio(
    model: &Model,
    limit: &dyn StepLimit,
    beta_s: StiffnessPenalty,
) -> Result<Option<OptimalRatio>, Uncertified> {
    let free = limit.enclose(&Penalty::NONE, None)?.l;
    let penalised = |r: Ratio| limit.enclose(&model.penalty(beta_s, r), None).map(|step| step.l);
    let with = |r: f64, test: &dyn Fn(Ratio) -> bool| Ratio::new(r).is_ok_and(test);
    let costs = |r: f64| with(r, &|r| penalised(r).is_ok_and(|l| l.lower > free.upper));
    let may_cost = |r: f64| !with(r, &|r| limit.costs_nothing(&model.penalty(beta_s, r)));
    let at_one = limit.enclose(&model.penalty(beta_s, Ratio::OPTIMAL), None)?;
    if at_one.evidence == Evidence::LowerBound && may_cost(LARGEST_RATIO) {
        let lower =
            if may_cost(SMALLEST_RATIO) { 0.0 } else { bisect(SMALLEST_RATIO, LARGEST_RATIO, may_cost).0 };
        let upper = f64::INFINITY;
        return Ok(Some(OptimalRatio { stiffness_penalty: beta_s, value: lower, lower, upper }));
    }
    if !costs(LARGEST_RATIO) {
        return Ok(None);
    }
    let (_, upper) = bisect(SMALLEST_RATIO, LARGEST_RATIO, costs);
    let lower = if may_cost(SMALLEST_RATIO) { 0.0 } else { bisect(SMALLEST_RATIO, upper, may_cost).0 };
    let value = if lower == 0.0 { 0.0 } else { value_between(&penalised, free.value, lower, upper) };
    Ok(Some(OptimalRatio { stiffness_penalty: beta_s, value, lower, upper }))
}

/// The smallest ratio that is searched for the limit of a scheme.
const SMALLEST_RATIO: f64 = 1e-12;

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

/// Which bar has the highest contact-free frequency, and so governs r*, and which bar scales the penalty mass.
pub fn governing_bar(model: &Model) -> String {
    let (scene, mass) = (model.scene(), model.mass());
    let last = scene.bars().len() - 1;
    let fixed = |i: usize| (i == 0 && scene.left() == End::Fixed, i == last && scene.right() == End::Fixed);
    let top = |(i, bar): (usize, &Bar)| UniformBar::new(bar, mass, fixed(i).0, fixed(i).1).top_eigenvalue();
    let tops: Vec<f64> = scene.bars().iter().enumerate().map(top).collect();
    let highest = tops.iter().copied().fold(0.0, f64::max);
    // Frequencies that agree to rounding govern together.
    let governs = |top: &f64| *top >= highest * (1.0 - 16.0 * f64::EPSILON);
    let bars: Vec<String> =
        tops.iter().enumerate().filter(|(_, top)| governs(top)).map(|(i, _)| (i + 1).to_string()).collect();
    match bars.len() {
        n if n == scene.bars().len() && n > 1 => "all bars alike".to_owned(),
        1 => format!("the elements of bar {}", bars[0]),
        _ => format!("the elements of bars {}", bars.join(" and ")),
    }
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
