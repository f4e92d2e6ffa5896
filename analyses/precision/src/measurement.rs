//! What was measured of one method on one problem, and which measurements no other beats.

use std::collections::HashMap;
use std::fmt;

use serde::{Deserialize, Serialize, Serializer};

use bipenalty::spectrum::UNIT_ROUNDOFF;

/// The kind of problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    /// The largest eigenvalue of a pencil.
    Eigenvalue,
    /// An impact, stepped in time.
    Stepping,
}

/// How a measurement ended; in records `done`, `failed: ..`, `timed out: ..` or `wrong: ..`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Status {
    /// With an error and a time.
    Done,
    /// The method gives nothing for this problem; why.
    Failed(String),
    /// The run took or would take longer than is sensible; what is known of it.
    TimedOut(String),
    /// There is a value, but it is further off than the method claims.
    Wrong(String),
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Done => f.write_str("done"),
            Self::Failed(why) => write!(f, "failed: {why}"),
            Self::TimedOut(why) => write!(f, "timed out: {why}"),
            Self::Wrong(why) => write!(f, "wrong: {why}"),
        }
    }
}

impl From<Status> for String {
    fn from(status: Status) -> Self {
        status.to_string()
    }
}

impl TryFrom<String> for Status {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        match text.split_once(": ") {
            None if text == "done" => Ok(Self::Done),
            Some(("failed", why)) => Ok(Self::Failed(why.to_owned())),
            Some(("timed out", why)) => Ok(Self::TimedOut(why.to_owned())),
            Some(("wrong", why)) => Ok(Self::Wrong(why.to_owned())),
            _ => Err(format!("no status: {text:?}")),
        }
    }
}

/// Writes a number, or nothing; what JSON has not, such as infinity, as a word.
pub(super) fn number<S: Serializer>(number: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match number {
        Some(other) if !other.is_finite() => serializer.collect_str(other),
        number => number.serialize(serializer),
    }
}

/// Error and run time of one method on one problem of one size: a row of the records, written and read. What has no number
/// is empty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Which kind of problem.
    pub family: Family,
    /// The problem; of an impact with the quantity whose error is meant.
    pub problem: String,
    /// The method with its setting.
    pub method: String,
    /// Elements of all bars (eigenvalues), of the first bar (impacts).
    pub size: usize,
    /// Eigenvalues: (dt - exact)/exact of the critical step, positive where it is too large, which is unsafe. Impacts:
    /// the rms error over the run in units of its scale, see [`super::ImpactErrors`].
    #[serde(serialize_with = "number")]
    pub error: Option<f64>,
    /// Smallest time of the runs, s.
    #[serde(serialize_with = "number")]
    pub seconds: Option<f64>,
    /// Products with the matrices or eliminations of them, where a method counts them.
    pub evaluations: Option<u64>,
    /// How it ended.
    pub status: Status,
    /// Whether no other method is as right and as quick; see [`mark_front`].
    #[serde(default)]
    pub on_front: bool,
}

impl Measurement {
    /// One without numbers.
    pub fn without_value(family: Family, problem: &str, method: &str, size: usize, status: Status) -> Self {
        Self {
            family,
            problem: problem.to_owned(),
            method: method.to_owned(),
            size,
            error: None,
            seconds: None,
            evaluations: None,
            status,
            on_front: false,
        }
    }

    /// (seconds, |error|) of a measurement that is done.
    pub fn point(&self) -> Option<(f64, f64)> {
        (self.status == Status::Done).then_some((self.seconds?, self.error?.abs()))
    }

    /// What it competes in: eigenvalues at one size, impacts at any.
    fn race(&self) -> (Family, &str, usize) {
        let size = if self.family == Family::Eigenvalue { self.size } else { 0 };
        (self.family, &self.problem, size)
    }
}

/// Marks what is on the Pareto front of its problem: everything that is quicker errs more, by over 1 %. Errors below the
/// unit roundoff count as that, since a result in f64 is no better but by chance.
pub fn mark_front(measurements: &mut [Measurement]) {
    const DISTINCT: f64 = 0.99;
    let mut races: HashMap<(Family, String, usize), Vec<usize>> = HashMap::new();
    for (i, measurement) in measurements.iter_mut().enumerate() {
        measurement.on_front = false;
        if measurement.point().is_some() {
            let (family, problem, size) = measurement.race();
            races.entry((family, problem.to_owned(), size)).or_default().push(i);
        }
    }
    for mut race in races.into_values() {
        let point = |i: usize| {
            let (seconds, error) = measurements[i].point().unwrap_or((f64::INFINITY, f64::INFINITY));
            (seconds, error.max(UNIT_ROUNDOFF))
        };
        // By time, then error: on the front is what is more right than everything quicker.
        race.sort_by(|a, b| {
            let ((ta, ea), (tb, eb)) = (point(*a), point(*b));
            ta.total_cmp(&tb).then(ea.total_cmp(&eb))
        });
        let mut best = f64::INFINITY;
        race.retain(|i| {
            let error = point(*i).1;
            let better = error < DISTINCT * best;
            best = best.min(error);
            better
        });
        race.into_iter().for_each(|i| measurements[i].on_front = true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(size: usize, error: f64, seconds: f64) -> Measurement {
        let blank = Measurement::without_value(Family::Eigenvalue, "p", "m", size, Status::Done);
        Measurement { error: Some(error), seconds: Some(seconds), ..blank }
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let mut all = vec![
            measured(10, 1e-3, 1.0),
            measured(10, -1e-5, 2.0),
            measured(10, 1e-4, 3.0),    // slower and less right than the one before
            measured(10, 1e-5, 2.5),    // as right, slower
            measured(10, 9.95e-6, 8.0), // more right by less than 1 %
            measured(10, 1e-16, 9.0),
            measured(10, 0.0, 9.5),  // by chance
            measured(20, 1.0, 99.0), // alone in its size
            Measurement { status: Status::Wrong("off".to_owned()), ..measured(10, 0.0, 0.1) },
        ];
        mark_front(&mut all);
        let marks: Vec<bool> = all.iter().map(|m| m.on_front).collect();
        assert_eq!(marks, [true, true, false, false, false, true, false, true, false]);
    }

    #[test]
    fn a_status_reads_back() {
        let why = || "a: b".to_owned();
        for status in [Status::Done, Status::Failed(why()), Status::TimedOut(why()), Status::Wrong(why())] {
            assert_eq!(Status::try_from(status.to_string()), Ok(status));
        }
        assert!(Status::try_from("excellent".to_owned()).is_err());
    }
}
