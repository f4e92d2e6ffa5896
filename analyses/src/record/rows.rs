//! The rows that users' scripts read. Names and order of the fields are a promise.

use serde::{Serialize, Serializer};

use super::columns::columns;
use super::read::{NOT_NEGATIVE, POSITIVE};
use crate::error::Refusal;
use bipenalty::pencil::Pencil;
use bipenalty::spectrum::{Evidence, Uncertified};
use bipenalty::stability::{AnyModel, CriticalStep, Curve, Model, OptimalRatio};

/// A number that may be infinite: written as the number, or as `inf`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number(pub f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            finite if finite.is_finite() => serializer.serialize_f64(finite),
            other => serializer.collect_str(&other),
        }
    }
}

/// What every row says of its model.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    scene: String,
    mass: String,
    gamma: Option<Number>,
    elements: Option<usize>,
    /// C_r/dt_cr, 1/s.
    rate: f64,
    /// The smallest scale of the contacts, N/m, if there are any.
    scale: Option<f64>,
    /// omega_ref^2, rad^2/s^2.
    reference: f64,
}

/// The mass matrix of a scene that brings its own.
pub const GIVEN: &str = "given";

impl Subject {
    /// Of bars.
    pub fn of_bars(model: &Model) -> Self {
        Self {
            scene: model.scene().name().to_owned(),
            mass: model.mass().name(),
            gamma: Some(Number(model.mass().gamma())),
            elements: Some(model.scene().elements()),
            rate: model.reference_rate().sqrt(),
            scale: model.scales().iter().map(|scale| scale.stiffness).reduce(f64::min),
            reference: model.reference_eigenvalue(),
        }
    }

    /// Of any model.
    ///
    /// # Errors
    /// As [`AnyModel::reference`].
    pub fn of(model: &AnyModel) -> Result<Self, Refusal> {
        if let AnyModel::Bars(model) = model {
            return Ok(Self::of_bars(model));
        }
        let reference = model.reference()?;
        Ok(Self {
            scene: model.name().to_owned(),
            mass: model.mass().map_or(GIVEN.to_owned(), |mass| mass.name()),
            gamma: model.mass().map(|mass| Number(mass.gamma())),
            elements: model.elements(),
            rate: 0.5 * reference.sqrt(),
            scale: model.smallest_scale(),
            reference,
        })
    }

    /// dt, s, of a Courant number.
    pub fn seconds(&self, courant: f64) -> f64 {
        courant / self.rate
    }

    /// s, N/m, and m = s/(r omega_ref^2), kg, of the softest contact; `None` without contacts.
    pub fn penalties(&self, beta_s: f64, ratio: f64) -> Option<(Number, Number)> {
        Some(penalties_in_si(self.scale?, self.reference, beta_s, ratio))
    }

    /// The smallest scale of the contacts, N/m: what beta_s multiplies there. `None` without contacts.
    pub fn scale(&self) -> Option<f64> {
        self.scale
    }
}

/// s, N/m, and m = s/(r omega_ref^2), kg, of the softest contact of `pencil`; `None` without contacts.
pub(super) fn softest_penalties(pencil: &Pencil, beta_s: f64, ratio: f64) -> Option<(Number, Number)> {
    let scale = pencil.gaps().iter().map(|gap| gap.scale).reduce(f64::min)?;
    Some(penalties_in_si(scale, pencil.reference(), beta_s, ratio))
}

fn penalties_in_si(scale: f64, reference: f64, beta_s: f64, ratio: f64) -> (Number, Number) {
    let stiffness = scale * beta_s;
    (Number(stiffness), Number(stiffness / (ratio * reference)))
}

columns! {
    /// One point of a stability map.
    StabilityRow, 12 required:
    /// Name of the scene.
    scene: String = word(),
    /// `lumped`, `averaged`, `consistent`, gamma, or [`GIVEN`] for matrices that bring their own.
    mass: String = word(),
    /// gamma of the mass matrix; empty for matrices.
    gamma: Option<Number> = gamma(),
    /// Elements of all bars or bodies; empty for matrices.
    elements: Option<usize> = elements(),
    /// Whose limit: the spectrum's or a scheme's.
    limit: &'static str = limit(),
    /// beta_s.
    stiffness_penalty: Number = stiffness_penalty(),
    /// r.
    ratio: Number = ratio(),
    /// omega_max, rad/s; empty for a limit other than the spectrum's, and where nothing could be certified.
    omega_max: Option<Number> = result(POSITIVE),
    /// C_r: for bars c0 dt_cr/h of the reference element, for matrices and meshes omega_ref dt_cr/2; empty where it could
    /// not be certified or is known from below only.
    critical_courant: Option<Number> = enclosed(["lower", "upper"], POSITIVE),
    /// Lower bound of C_r.
    lower: Option<Number> = result(POSITIVE),
    /// Upper bound of C_r; infinite where none is known.
    upper: Option<Number> = bound(POSITIVE),
    /// The engine that found the value; "not certified" is appended where it could not be proven.
    engine: String = word(),
    /// dt_cr, s; empty as `critical_courant`.
    critical_step: Option<Number> = enclosed(["step_lower", "step_upper"], POSITIVE),
    /// Lower bound of dt_cr, s.
    step_lower: Option<Number> = result(POSITIVE),
    /// Upper bound of dt_cr, s; infinite where none is known.
    step_upper: Option<Number> = bound(POSITIVE),
    /// [`PROVEN`] for an enclosed limit, [`LOWER_BOUND`], the probability that the enclosure is wrong, or empty where nothing
    /// could be certified.
    evidence: String = evidence(),
    /// s = beta_s w, N/m, of the contact of smallest scale w, the softest; empty without contacts.
    penalty_stiffness: Option<Number> = result(NOT_NEGATIVE),
    /// m = s/(r omega_ref^2), kg, of the same contact.
    penalty_mass: Option<Number> = result(NOT_NEGATIVE),
}

/// The evidence of a limit that lies between its bounds.
pub const PROVEN: &str = "proven";
/// The evidence of a limit that may lie anywhere above `lower`.
pub const LOWER_BOUND: &str = "lower bound";

impl StabilityRow {
    /// C_r, or its lower bound where that is all that is known: up to there every step is stable.
    pub fn stable_courant(&self) -> Option<f64> {
        self.critical_courant.or(self.lower).map(|courant| courant.0)
    }

    /// Whether C_r is known from below only.
    pub fn is_lower_bound(&self) -> bool {
        self.critical_courant.is_none() && self.lower.is_some()
    }

    /// The rows of `curves`, curve by curve.
    pub fn of(subject: &Subject, limit: &'static str, curves: &[Curve]) -> Vec<Self> {
        let rows = curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve.ratio, point)));
        rows.map(|(ratio, point)| {
            let engine = point.engine;
            let step: Result<CriticalStep, Uncertified> = point.step;
            let penalties = subject.penalties(point.stiffness_penalty.get(), ratio.get());
            let number = |f: fn(CriticalStep) -> f64| step.ok().map(|step| Number(f(step)));
            let found = step.ok().filter(|step| !step.is_lower_bound()).map(|step| step.critical_courant);
            // A root and a quotient more than in C_r.
            let margin = 2.0 * f64::EPSILON;
            let seconds = |courant: f64, kept: f64| Number(courant / subject.rate * kept);
            let evidence = match step.map(|step| step.evidence) {
                Ok(Evidence::LowerBound) => LOWER_BOUND.to_owned(),
                Ok(Evidence::Proven) => PROVEN.to_owned(),
                Ok(Evidence::Probability(wrong)) => format!("{wrong:e}"),
                Err(_) => String::new(),
            };
            Self {
                scene: subject.scene.clone(),
                mass: subject.mass.clone(),
                gamma: subject.gamma,
                elements: subject.elements,
                limit,
                stiffness_penalty: Number(point.stiffness_penalty.get()),
                ratio: Number(ratio.get()),
                omega_max: if limit == "spectrum" { number(|s| s.omega_max) } else { None },
                critical_courant: found.map(Number),
                lower: number(|s| s.lower),
                upper: number(|s| s.upper),
                engine: if step.is_ok() { engine.to_owned() } else { format!("{engine}, not certified") },
                critical_step: found.map(|courant| seconds(courant, 1.0)),
                step_lower: step.ok().map(|step| seconds(step.lower, 1.0 - margin)),
                step_upper: step.ok().map(|step| seconds(step.upper, 1.0 + margin)),
                evidence,
                penalty_stiffness: penalties.map(|(stiffness, _)| stiffness),
                penalty_mass: penalties.map(|(_, mass)| mass),
            }
        })
        .collect()
    }
}

columns! {
    /// One optimal ratio.
    OptimalRatioRow, 10 required:
    /// Name of the scene.
    scene: String = word(),
    /// As in [`StabilityRow`].
    mass: String = word(),
    /// gamma of the mass matrix; empty for matrices.
    gamma: Option<Number> = gamma(),
    /// Elements of all bars or bodies; empty for matrices.
    elements: Option<usize> = elements(),
    /// Whose limit.
    limit: &'static str = limit(),
    /// beta_s.
    stiffness_penalty: Number = stiffness_penalty(),
    /// The largest r that costs no time step; empty where no ratio provably costs one, and where the limit is known from
    /// below only.
    optimal_ratio: Option<Number> = enclosed(["lower", "upper"], NOT_NEGATIVE),
    /// Proven lower bound.
    lower: Option<Number> = result(NOT_NEGATIVE),
    /// Proven upper bound; infinite where the limit is known from below only.
    upper: Option<Number> = bound(NOT_NEGATIVE),
    /// Whether the enclosure contains the expected ratio, where one is found and expected.
    holds: bool = truth(),
    /// The contact-free step that is kept, s: its lower bound.
    contact_free_step: Option<Number> = result(POSITIVE),
    /// s = beta_s w, N/m, of the contact of smallest scale w, the softest.
    penalty_stiffness: Option<Number> = result(NOT_NEGATIVE),
    /// m = s/(r omega_ref^2), kg, of the same contact at r = `lower`: as little as is proven to cost nothing.
    penalty_mass: Option<Number> = result(NOT_NEGATIVE),
}

impl OptimalRatioRow {
    /// The row of `found` at beta_s for a limit, held against the `expected` ratio, `None` if no ratio should cost a
    /// step; `contact_free_step` in s.
    pub fn new(
        subject: &Subject,
        limit: &'static str,
        beta_s: f64,
        found: Option<OptimalRatio>,
        expected: Option<f64>,
        contact_free_step: Option<f64>,
    ) -> Self {
        let stiffness = subject.scale.map(|scale| beta_s * scale);
        let mass = |(s, r): (f64, f64)| Number(s / (r * subject.reference));
        let contains = |found: OptimalRatio| match expected {
            // Nothing is expected of a limit that is known from below only.
            None if found.upper.is_infinite() => true,
            Some(expected) => found.lower <= expected && expected <= found.upper,
            None => false,
        };
        Self {
            scene: subject.scene.clone(),
            mass: subject.mass.clone(),
            gamma: subject.gamma,
            elements: subject.elements,
            limit,
            stiffness_penalty: Number(beta_s),
            optimal_ratio: found.filter(|found| found.upper.is_finite()).map(|found| Number(found.value)),
            lower: found.map(|found| Number(found.lower)),
            upper: found.map(|found| Number(found.upper)),
            holds: found.is_none_or(contains),
            contact_free_step: contact_free_step.map(Number),
            penalty_stiffness: stiffness.map(Number),
            penalty_mass: stiffness.zip(found.map(|found| found.lower)).filter(|(_, r)| *r > 0.0).map(mass),
        }
    }
}
