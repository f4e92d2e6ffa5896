//! A limit of the time step, and the evidence for it.

use super::{Enclosure, Engine, Uncertified};
use crate::pencil::Penalty;

/// What stands behind a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Evidence {
    /// The exact limit lies in the enclosure.
    Proven,
    /// The scheme is stable up to `lower`; its limit lies between there and `upper`, which may be infinite.
    LowerBound,
    /// The exact limit lies in the enclosure except with this probability.
    Probability(f64),
}

/// The largest stable step dt, kept as l = 4/dt^2 (rad^2/s^2): so the limit of a spectrum is its l_max, digit for digit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// 4/dt^2 with its enclosure; its upper end belongs to the smallest step.
    pub l: Enclosure,
    /// What stands behind it.
    pub evidence: Evidence,
}

impl Step {
    /// A limit that is proven to lie in the enclosure.
    pub fn proven(l: Enclosure) -> Self {
        Self { l, evidence: Evidence::Proven }
    }

    /// A step that is stable, below a limit of which nothing else is known.
    pub fn at_least(l: Enclosure) -> Self {
        Self::between(Enclosure { lower: 0.0, ..l })
    }

    /// A step that is stable, below a limit that does not exceed the step of `l.lower`.
    pub fn between(l: Enclosure) -> Self {
        Self { l, evidence: Evidence::LowerBound }
    }

    /// dt, s, as computed.
    pub fn seconds(&self) -> f64 {
        2.0 / self.l.value.sqrt()
    }

    /// A step, s, that does not exceed the limit; division and square root round twice.
    pub fn lower(&self) -> f64 {
        2.0 / self.l.upper.sqrt() * (1.0 - 2.0 * f64::EPSILON)
    }

    /// A step, s, that the limit does not exceed; infinite where none is known.
    pub fn upper(&self) -> f64 {
        2.0 / self.l.lower.sqrt() * (1.0 + 2.0 * f64::EPSILON)
    }
}

/// How large a step may be while every contact is closed, for any penalty: of a spectrum, or of a scheme.
///
/// `start` hands on l of a nearby limit, as for [`Engine`].
pub trait StepLimit: Sync {
    /// The name of what finds it, in records.
    fn name(&self) -> &'static str;

    /// The limit with its evidence.
    ///
    /// # Errors
    /// [`Uncertified`] if it could not be enclosed closely enough.
    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Step, Uncertified>;

    /// As [`StepLimit::enclose`], with the name of what found it, as [`Engine::enclose_by`].
    fn enclose_by(&self, penalty: &Penalty, start: Option<f64>) -> (Result<Step, Uncertified>, &'static str) {
        (self.enclose(penalty, start), self.name())
    }

    /// ln of the largest multiplier at dt = `excess` times the limit `step`, excess > 1: the growth in a step. `None` where
    /// no formula is at hand.
    fn growth(&self, _penalty: &Penalty, _step: &Step, _excess: f64) -> Option<f64> {
        None
    }

    /// Intervals of 4/dt^2, (high, low), with steps above the limit for which the scheme is stable again; empty where none
    /// is known.
    fn islands(&self, _penalty: &Penalty) -> Vec<(f64, f64)> {
        Vec::new()
    }

    /// Whether closed contacts are proven to cost no step against the same pencil without them.
    fn costs_nothing(&self, _penalty: &Penalty) -> bool {
        false
    }

    /// The largest ratio that costs no step at beta_s, as the theory has it; `None` if none costs any or none is known.
    fn expected_ratio(&self, _beta_s: f64) -> Option<f64> {
        None
    }

    /// The points (beta_s, r) whose limit is l, where one number tells them: (W, mu), m/N and 1/kg, of
    /// 1/(beta_s w) + mu/(r omega^2) = W.
    fn line(&self, _l: f64) -> Option<(f64, f64)> {
        None
    }

    /// The share of a start with velocities alone that grows beyond the limit `step`.
    fn share(&self, _step: &Step) -> f64 {
        1.0
    }
}

/// The limit 2/omega_max of a spectrum: of central differences, with any mass.
pub struct Spectrum<'a>(pub Box<dyn Engine + 'a>);

impl StepLimit for Spectrum<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Step, Uncertified> {
        self.enclose_by(penalty, start).0
    }

    fn enclose_by(&self, penalty: &Penalty, start: Option<f64>) -> (Result<Step, Uncertified>, &'static str) {
        let (enclosure, by) = self.0.enclose_by(penalty, start);
        (enclosure.map(Step::proven), by)
    }

    /// Above the limit central differences have the multipliers -exp(+-g), cosh g = 2 excess^2 - 1, which is
    /// g = 2 acosh(excess).
    fn growth(&self, _penalty: &Penalty, _step: &Step, excess: f64) -> Option<f64> {
        Some(2.0 * excess.acosh())
    }
}

/// The limit of a scheme that is an increasing function of the spectrum's, l -> 4/dt^2: a scheme that stands w dt on an
/// undamped mode has 4 l/w^2, mass-proportional damping that lags half a step by the rate c adds c/2 to the root of l + c^2/4.
pub struct OfSpectrum<'a> {
    /// The engine of the spectrum.
    pub spectrum: Box<dyn Engine + 'a>,
    /// The function; it takes fewer than 8 roundings.
    pub of: Box<dyn Fn(f64) -> f64 + Sync + 'a>,
}

impl StepLimit for OfSpectrum<'_> {
    fn name(&self) -> &'static str {
        self.spectrum.name()
    }

    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Step, Uncertified> {
        self.enclose_by(penalty, start).0
    }

    fn enclose_by(
        &self,
        penalty: &Penalty,
        _start: Option<f64>,
    ) -> (Result<Step, Uncertified>, &'static str) {
        let (found, by) = self.spectrum.enclose_by(penalty, None);
        let margin = 4.0 * f64::EPSILON;
        let step = |Enclosure { value, lower, upper }| {
            let (lower, upper) = ((self.of)(lower) * (1.0 - margin), (self.of)(upper) * (1.0 + margin));
            Step::proven(Enclosure { value: (self.of)(value), lower, upper })
        };
        (found.map(step), by)
    }
}
