//! The rows that users' scripts read. Names and order of the fields are a promise.

use serde::{Serialize, Serializer};

use bipenalty::spectrum::Uncertified;
use bipenalty::stability::{CriticalStep, Curve, Model, OptimalRatio};

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

/// One point of a stability map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StabilityRow {
    /// Name of the scene.
    pub scene: String,
    /// `lumped`, `averaged`, `consistent`, or gamma.
    pub mass: String,
    /// gamma of the mass matrix.
    pub gamma: Number,
    /// Elements of all bars.
    pub elements: usize,
    /// Whose limit: the spectrum's or a scheme's.
    pub limit: &'static str,
    /// beta_s.
    pub stiffness_penalty: Number,
    /// r.
    pub ratio: Number,
    /// omega_max, rad/s; empty for a limit other than the spectrum's, and where nothing could be certified.
    pub omega_max: Option<Number>,
    /// C_r = c0 dt_cr/h of the reference element; empty where it could not be certified or is known from below only.
    pub critical_courant: Option<Number>,
    /// Proven lower bound of C_r.
    pub lower: Option<Number>,
    /// Proven upper bound of C_r; infinite where none is known.
    pub upper: Option<Number>,
    /// The engine that found the value; "not certified" is appended where it could not be proven.
    pub engine: String,
    /// dt_cr, s; empty as `critical_courant`.
    pub critical_step: Option<Number>,
    /// Proven lower bound of dt_cr, s.
    pub step_lower: Option<Number>,
    /// Proven upper bound of dt_cr, s; infinite where none is known.
    pub step_upper: Option<Number>,
    /// [`PROVEN`] for an enclosed limit, [`LOWER_BOUND`], or empty where nothing could be certified.
    pub evidence: String,
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
    pub fn of(model: &Model, limit: &'static str, curves: &[Curve]) -> Vec<Self> {
        let rows = curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve.ratio, point)));
        rows.map(|(ratio, point)| {
            let engine = point.engine;
            let step: Result<CriticalStep, Uncertified> = point.step;
            let number = |f: fn(CriticalStep) -> f64| step.ok().map(|step| Number(f(step)));
            let found = step.ok().filter(|step| !step.is_lower_bound()).map(|step| step.critical_courant);
            // A root and a quotient more than in C_r.
            let margin = 2.0 * f64::EPSILON;
            let seconds = |courant: f64, kept: f64| Number(model.time_step(courant) * kept);
            let evidence = match step {
                Ok(step) if step.is_lower_bound() => LOWER_BOUND,
                Ok(_) => PROVEN,
                Err(_) => "",
            };
            Self {
                scene: model.scene().name().to_owned(),
                mass: model.mass().name(),
                gamma: Number(model.mass().gamma()),
                elements: model.scene().elements(),
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
                evidence: evidence.to_owned(),
            }
        })
        .collect()
    }
}

/// One optimal ratio.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimalRatioRow {
    /// Name of the scene.
    pub scene: String,
    /// `lumped`, `averaged`, `consistent`, or gamma.
    pub mass: String,
    /// gamma of the mass matrix.
    pub gamma: Number,
    /// Elements of all bars.
    pub elements: usize,
    /// Whose limit.
    pub limit: &'static str,
    /// beta_s.
    pub stiffness_penalty: Number,
    /// The largest r that costs no time step; empty where no ratio provably costs one, and where the limit is known from
    /// below only.
    pub optimal_ratio: Option<Number>,
    /// Proven lower bound.
    pub lower: Option<Number>,
    /// Proven upper bound; infinite where the limit is known from below only.
    pub upper: Option<Number>,
    /// Whether the enclosure contains the expected ratio, where one is found and expected.
    pub holds: bool,
}

impl OptimalRatioRow {
    /// The row of `found` at beta_s for a limit, held against the `expected` ratio; `None` if no ratio should cost a
    /// step.
    pub fn new(
        model: &Model,
        limit: &'static str,
        beta_s: f64,
        found: Option<OptimalRatio>,
        expected: Option<f64>,
    ) -> Self {
        let contains = |found: OptimalRatio| match expected {
            // Nothing is expected of a limit that is known from below only.
            None if found.upper.is_infinite() => true,
            Some(expected) => found.lower <= expected && expected <= found.upper,
            None => false,
        };
        Self {
            scene: model.scene().name().to_owned(),
            mass: model.mass().name(),
            gamma: Number(model.mass().gamma()),
            elements: model.scene().elements(),
            limit,
            stiffness_penalty: Number(beta_s),
            optimal_ratio: found.filter(|found| found.upper.is_finite()).map(|found| Number(found.value)),
            lower: found.map(|found| Number(found.lower)),
            upper: found.map(|found| Number(found.upper)),
            holds: found.is_none_or(contains),
        }
    }
}
