//! One case: what it computes, and the verdict on it.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::measurement::number;

/// What a case has computed, or should have.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// A number; of a reference the exact value, rounded to f64.
    Value(f64),
    /// A refusal: its message; of a reference the quantity that the message must name.
    Refused(String),
}

/// A number, or `refused: ` with the message.
impl Serialize for Answer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Value(value) => number(&Some(*value), serializer),
            Self::Refused(text) => serializer.collect_str(&format_args!("refused: {text}")),
        }
    }
}

/// What a case has found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The value, in the unit of the quantity.
    pub value: f64,
    /// The relative error that rounding may cause.
    pub allowed: f64,
    /// The interval that is claimed to hold the exact value, if one is claimed.
    pub enclosure: Option<(f64, f64)>,
}

/// What a case computes: a number, or why there is none.
type Compute = Box<dyn Fn() -> Result<Found, String> + Send + Sync>;

/// One extreme case of one quantity.
pub struct Case {
    /// Made of the inputs, such as `beta-s-1e300-r-2`.
    pub name: String,
    /// What is computed, such as `critical Courant number`.
    pub quantity: &'static str,
    /// What computes it: an engine or a scheme; empty for a refusal.
    pub by: &'static str,
    /// The allowed relative error in words of u = 2^-53; empty for a refusal.
    pub formula: &'static str,
    /// The quantity that the refusal must name; `None` where the reference is a number.
    pub refusal: Option<&'static str>,
    pub(super) compute: Compute,
}

impl fmt::Debug for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}, {} ({})", self.name, self.quantity, self.by)
    }
}

/// A case with its verdict: a row of the records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Checked {
    /// Name of the case.
    pub case: String,
    /// The quantity, with what computed it.
    pub quantity: String,
    /// What came out.
    pub computed: Answer,
    /// What should have come out.
    pub reference: Answer,
    /// |computed - reference|/|reference|; infinite where the reference is 0 and the value is not; none
    /// for a refusal.
    #[serde(serialize_with = "number")]
    pub relative_error: Option<f64>,
    /// The largest that is allowed.
    #[serde(serialize_with = "number")]
    pub allowed: Option<f64>,
    /// Whether the case holds.
    pub holds: bool,
    /// The formula of `allowed` in u = 2^-53; empty for a refusal.
    #[serde(rename = "allowed_formula")]
    pub formula: &'static str,
}

impl Case {
    /// Computes, and compares with `reference`.
    pub fn check(&self, reference: &Answer) -> Checked {
        let by = if self.by.is_empty() { String::new() } else { format!(" ({})", self.by) };
        let checked = Checked {
            case: self.name.clone(),
            quantity: format!("{}{by}", self.quantity),
            computed: Answer::Value(f64::NAN),
            reference: reference.clone(),
            relative_error: None,
            allowed: None,
            formula: self.formula,
            holds: false,
        };
        match ((self.compute)(), reference) {
            (Ok(found), Answer::Value(exact)) => {
                let error = relative_error(found.value, *exact);
                Checked {
                    computed: Answer::Value(found.value),
                    relative_error: Some(error),
                    allowed: Some(found.allowed),
                    holds: error <= found.allowed && found.encloses(*exact),
                    ..checked
                }
            }
            (Ok(found), Answer::Refused(_)) => Checked { computed: Answer::Value(found.value), ..checked },
            (Err(message), Answer::Refused(quantity)) => {
                let holds = message.contains(quantity.as_str());
                Checked { computed: Answer::Refused(message), holds, ..checked }
            }
            (Err(message), Answer::Value(_)) => Checked { computed: Answer::Refused(message), ..checked },
        }
    }
}

impl Found {
    /// Whether the claimed interval holds `exact`. It is proven for the data as stored, whose rounding moves the exact
    /// value by less than what is allowed.
    fn encloses(&self, exact: f64) -> bool {
        let margin = self.allowed * exact.abs();
        self.enclosure.is_none_or(|(lower, upper)| lower - margin <= exact && exact <= upper + margin)
    }
}

fn relative_error(value: f64, exact: f64) -> f64 {
    match (value == exact, exact == 0.0) {
        (true, _) => 0.0,
        (false, true) => f64::INFINITY,
        (false, false) => ((value - exact) / exact).abs(),
    }
}
