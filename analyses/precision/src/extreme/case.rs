//! One case: what it computes, and the verdict on it.

use std::fmt;

/// What a case is held against.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// The exact value, rounded to f64.
    Value(f64),
    /// A refusal whose message names this quantity.
    Refused(String),
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

/// What came out of a case.
#[derive(Debug, Clone, PartialEq)]
pub enum Computed {
    /// A number.
    Value(f64),
    /// The message of a refusal.
    Refused(String),
}

/// A case with its verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// Name of the case.
    pub case: String,
    /// The quantity, with what computed it.
    pub quantity: String,
    /// What came out.
    pub computed: Computed,
    /// What should have come out.
    pub reference: Reference,
    /// |computed - reference|/|reference|; infinite where the reference is 0 and the value is not.
    pub relative_error: Option<f64>,
    /// The largest that is allowed.
    pub allowed: Option<f64>,
    /// The formula of `allowed`.
    pub formula: &'static str,
    /// Whether the case holds.
    pub holds: bool,
}

impl Case {
    /// Computes, and compares with `reference`.
    pub fn check(&self, reference: &Reference) -> Checked {
        let by = if self.by.is_empty() { String::new() } else { format!(" ({})", self.by) };
        let checked = Checked {
            case: self.name.clone(),
            quantity: format!("{}{by}", self.quantity),
            computed: Computed::Value(f64::NAN),
            reference: reference.clone(),
            relative_error: None,
            allowed: None,
            formula: self.formula,
            holds: false,
        };
        match ((self.compute)(), reference) {
            (Ok(found), Reference::Value(exact)) => {
                let error = relative_error(found.value, *exact);
                Checked {
                    computed: Computed::Value(found.value),
                    relative_error: Some(error),
                    allowed: Some(found.allowed),
                    holds: error <= found.allowed && found.encloses(*exact),
                    ..checked
                }
            }
            (Ok(found), Reference::Refused(_)) => {
                Checked { computed: Computed::Value(found.value), ..checked }
            }
            (Err(message), Reference::Refused(quantity)) => {
                let holds = message.contains(quantity.as_str());
                Checked { computed: Computed::Refused(message), holds, ..checked }
            }
            (Err(message), Reference::Value(_)) => {
                Checked { computed: Computed::Refused(message), ..checked }
            }
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
