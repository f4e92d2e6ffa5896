//! The rows of the extreme cases and of error against run time.

use serde::{Serialize, Serializer};

use super::Number;
use precision::{Checked, Computed, Measurement, Reference};

/// A number, or the word `refused: ` with a message or a quantity.
#[derive(Debug, Clone, PartialEq)]
pub enum NumberOrRefusal {
    /// A number.
    Number(Number),
    /// Why there is none.
    Refused(String),
}

impl Serialize for NumberOrRefusal {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => number.serialize(serializer),
            Self::Refused(text) => serializer.collect_str(&format_args!("refused: {text}")),
        }
    }
}

/// One extreme case with its verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExtremeRow {
    /// Name of the case.
    pub case: String,
    /// What was computed, and by what.
    pub quantity: String,
    /// What came out: a number or a refusal.
    pub computed: NumberOrRefusal,
    /// What should have come out: a number, or the quantity that the refusal must name.
    pub reference: NumberOrRefusal,
    /// |computed - reference|/|reference|; empty for a refusal.
    pub relative_error: Option<Number>,
    /// The largest relative error allowed; empty for a refusal.
    pub allowed: Option<Number>,
    /// Whether the case holds.
    pub holds: bool,
    /// The formula of `allowed` in u = 2^-53; empty for a refusal.
    pub allowed_formula: &'static str,
}

impl ExtremeRow {
    /// The row of `checked`.
    pub fn new(checked: &Checked) -> Self {
        Self {
            case: checked.case.clone(),
            quantity: checked.quantity.clone(),
            computed: match &checked.computed {
                Computed::Value(value) => NumberOrRefusal::Number(Number(*value)),
                Computed::Refused(message) => NumberOrRefusal::Refused(message.clone()),
            },
            reference: match &checked.reference {
                Reference::Value(value) => NumberOrRefusal::Number(Number(*value)),
                Reference::Refused(quantity) => NumberOrRefusal::Refused(quantity.clone()),
            },
            relative_error: checked.relative_error.map(Number),
            allowed: checked.allowed.map(Number),
            holds: checked.holds,
            allowed_formula: checked.formula,
        }
    }
}

/// Error and run time of one method on one problem. What has no number is empty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorkRow {
    /// `eigenvalue` or `stepping`.
    pub family: &'static str,
    /// The problem; of an impact scene, mass matrix and quantity.
    pub problem: String,
    /// The method with its setting.
    pub method: String,
    /// Elements of all bars (eigenvalues), of the first bar (impacts).
    pub size: usize,
    /// Relative error of the critical step, positive where the step is too large; rms error of an impact.
    pub error: Option<Number>,
    /// Smallest time of the runs, s.
    pub seconds: Option<Number>,
    /// Products with the matrices or eliminations of them.
    pub evaluations: Option<u64>,
    /// `done`, `failed: ..`, `timed out: ..` or `wrong: ..`.
    pub status: String,
    /// Whether nothing is as right and as quick on this problem (eigenvalues: of this size).
    pub on_front: bool,
}

impl WorkRow {
    /// The row of `measurement`.
    pub fn new(measurement: &Measurement) -> Self {
        Self {
            family: measurement.family.name(),
            problem: measurement.problem.clone(),
            method: measurement.method.clone(),
            size: measurement.size,
            error: measurement.error.map(Number),
            seconds: measurement.seconds.map(Number),
            evaluations: measurement.evaluations,
            status: measurement.status.to_string(),
            on_front: measurement.on_front,
        }
    }

    /// (seconds, |error|) of a measurement that is done.
    pub fn point(&self) -> Option<(f64, f64)> {
        (self.status == "done").then_some((self.seconds?.0, self.error?.0.abs()))
    }
}
