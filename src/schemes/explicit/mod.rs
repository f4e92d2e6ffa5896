//! Other explicit schemes, with the contact in the internal force: how large a step each stands, and what a step costs.
//!
//! ```text
//! (M + M_p) a = f - (K + K_p) u
//! ```
//! is a sum of undamped modes, each of which a scheme multiplies by a small matrix of w = (omega dt)^2 alone. So the limit with
//! closed contacts is dt = Omega/omega_max, Omega the largest omega dt up to which no eigenvalue of that matrix leaves the unit
//! circle, whatever the bars, the mesh and the contacts: the limit of central differences times Omega/2, at the price of as many
//! forces a step as the scheme evaluates. What each scheme gains in steps it may lose in forces.
//!
//! Omega is derived for each from its matrix by the conditions of Jury (the polynomial z^2 - T z + D has both roots in the closed
//! unit disc exactly when |D| <= 1 and 1 +- T + D >= 0; z^3 + a_2 z^2 + a_1 z + a_0 when |a_0| <= 1, p(1) >= 0, -p(-1) >= 0 and
//! 1 - a_0^2 >= |a_1 - a_0 a_2|, all but the first of them strict or approached by polynomials for which they are) over the whole
//! range of its parameter that is accepted. There are no islands of instability below it: where a scheme has some, its parameter is
//! refused.
//!
//! ```
//! use bipenalty::schemes::explicit::{ExplicitName, ExplicitScheme};
//! let noh_bathe = "noh-bathe".parse::<ExplicitName>()?.with(None)?;
//! assert!((noh_bathe.largest() - 3.7450).abs() < 1e-4 && noh_bathe.facts().evaluations == 2);
//! assert!(ExplicitName::NohBathe.with(Some(0.8)).is_err()); // an island of instability below its limit
//! # Ok::<(), bipenalty::error::Refusal>(())
//! ```

mod chung_lee;
mod cost;
mod generalised_alpha;
mod name;
mod noh_bathe;
mod tchamwa_wielgosz;

pub use cost::{Cost, CostCurve};
pub use name::ExplicitName;

use crate::error::Refusal;
use crate::spectrum::{Engine, OfSpectrum};

/// An explicit scheme with the contact in its internal force, whatever its parameter.
#[derive(Debug, Clone, Copy)]
pub struct ExplicitFacts {
    /// The name in records.
    pub name: &'static str,
    /// The name in a chart.
    pub title: &'static str,
    /// The symbol of its parameter, dimensionless.
    pub parameter: &'static str,
    /// The value of the parameter that is taken where none is given.
    pub usual: f64,
    /// The values that are accepted, ends included: for these Omega is proven.
    pub allowed: (f64, f64),
    /// Internal forces K u evaluated in a step.
    pub evaluations: usize,
    /// Order of accuracy in dt with the usual value.
    pub order: usize,
    /// Omega = (omega dt) at the limit, as a formula.
    pub formula: &'static str,
    /// Where the scheme is defined.
    pub source: &'static str,
    /// 4/Omega^2 by the parameter, at most 7 unit roundoffs off.
    pub factor: fn(parameter: f64) -> f64,
    /// Numbers in a state: 2 of (u, dt v), 3 of (u, dt v, dt^2 a).
    pub states: usize,
    /// The state after a step of an undamped mode with (omega dt)^2 = w, as the scheme defines it.
    pub step: fn(parameter: f64, w: f64, state: &[f64]) -> Vec<f64>,
}

/// An explicit scheme with its parameter.
#[derive(Debug, Clone, Copy)]
pub struct ExplicitScheme {
    facts: &'static ExplicitFacts,
    parameter: f64,
}

impl ExplicitScheme {
    /// The scheme with this parameter.
    ///
    /// # Errors
    /// A parameter for which the limit is not proven.
    pub fn new(facts: &'static ExplicitFacts, parameter: f64) -> Result<Self, Refusal> {
        let (low, high) = facts.allowed;
        if (low..=high).contains(&parameter) {
            return Ok(Self { facts, parameter });
        }
        let allowed = format!("a number from {low} to {high}, for which its limit is proven");
        Err(Refusal::new(format!("{}, {}", facts.name, facts.parameter), parameter, allowed))
    }

    /// What is known of it.
    pub fn facts(&self) -> &'static ExplicitFacts {
        self.facts
    }

    /// Its parameter.
    pub fn parameter(&self) -> f64 {
        self.parameter
    }

    /// 4/Omega^2: the limit is 4/dt^2 = factor omega_max^2.
    fn factor(&self) -> f64 {
        (self.facts.factor)(self.parameter)
    }

    /// One step of an undamped mode, see [`ExplicitFacts::step`].
    pub fn step(&self, w: f64, state: &[f64]) -> Vec<f64> {
        (self.facts.step)(self.parameter, w, state)
    }

    /// Omega, the largest stable omega dt, rad.
    pub fn largest(&self) -> f64 {
        2.0 / self.factor().sqrt()
    }

    /// The amplification matrix at (omega dt)^2 = w by rows.
    pub fn amplification(&self, w: f64) -> Vec<Vec<f64>> {
        let n = self.facts.states;
        let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<_>>();
        let columns: Vec<Vec<f64>> = (0..n).map(|j| self.step(w, &unit(j))).collect();
        (0..n).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
    }

    /// The limit of closed contacts, from an engine of their spectrum.
    pub fn limit<'a>(&self, spectrum: Box<dyn Engine + 'a>) -> OfSpectrum<'a> {
        let factor = self.factor();
        OfSpectrum { spectrum, of: Box::new(move |l| factor * l) }
    }
}
