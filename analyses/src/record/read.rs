//! Reading records back from the CSV files that a run has written, every cell checked.

use std::path::Path;

use super::{LOWER_BOUND, Number, OptimalRatioRow, PROVEN, StabilityRow};
use crate::error::{Error, Refusal, Result};
use bipenalty::schemes::SchemeName;

const STABILITY: [&str; 12] = [
    "scene",
    "mass",
    "gamma",
    "elements",
    "limit",
    "stiffness_penalty",
    "ratio",
    "omega_max",
    "critical_courant",
    "lower",
    "upper",
    "engine",
];
const OPTIMAL_RATIO: [&str; 10] = [
    "scene",
    "mass",
    "gamma",
    "elements",
    "limit",
    "stiffness_penalty",
    "optimal_ratio",
    "lower",
    "upper",
    "holds",
];

/// What a result may be, in words and as a test.
type Kind = (&'static str, fn(f64) -> bool);
const POSITIVE: Kind = ("a positive number, or nothing", |value| value > 0.0);
const NOT_NEGATIVE: Kind = ("a number of at least 0, or nothing", |value| value >= 0.0);

/// The rows of a file that `stability-map` or `scheme-limits` has written, also before there were steps in seconds and
/// evidence in it. Further columns are left alone.
///
/// # Errors
/// A file that cannot be read; a column that is missing; the first cell with a value that no such row has, by its line.
pub fn stability_rows(file: &Path) -> Result<Vec<StabilityRow>> {
    rows(file, &STABILITY, |cells| {
        Ok(StabilityRow {
            scene: cells.word("scene")?,
            mass: cells.word("mass")?,
            gamma: cells.gamma()?,
            elements: cells.elements()?,
            limit: cells.limit()?,
            stiffness_penalty: cells.stiffness_penalty()?,
            ratio: cells.number("ratio", "a number above 0, or inf", |r| r > 0.0)?,
            omega_max: cells.result("omega_max", POSITIVE)?,
            critical_courant: cells.enclosed(["critical_courant", "lower", "upper"], POSITIVE)?,
            lower: cells.result("lower", POSITIVE)?,
            upper: cells.bound("upper", POSITIVE)?,
            engine: cells.word("engine")?,
            critical_step: cells.enclosed(["critical_step", "step_lower", "step_upper"], POSITIVE)?,
            step_lower: cells.result("step_lower", POSITIVE)?,
            step_upper: cells.bound("step_upper", POSITIVE)?,
            evidence: cells.evidence()?,
        })
    })
}

/// The rows of a file that `optimal-ratio` or `scheme-limits` has written.
///
/// # Errors
/// As [`stability_rows`].
pub fn optimal_ratio_rows(file: &Path) -> Result<Vec<OptimalRatioRow>> {
    rows(file, &OPTIMAL_RATIO, |cells| {
        Ok(OptimalRatioRow {
            scene: cells.word("scene")?,
            mass: cells.word("mass")?,
            gamma: cells.gamma()?,
            elements: cells.elements()?,
            limit: cells.limit()?,
            stiffness_penalty: cells.stiffness_penalty()?,
            optimal_ratio: cells.enclosed(["optimal_ratio", "lower", "upper"], NOT_NEGATIVE)?,
            lower: cells.result("lower", NOT_NEGATIVE)?,
            upper: cells.bound("upper", NOT_NEGATIVE)?,
            holds: cells.parsed("holds", "true or false", |word| word.parse().ok())?,
        })
    })
}

fn rows<R>(
    file: &Path,
    required: &[&'static str],
    row: impl Fn(&Cells) -> Result<R, Refusal>,
) -> Result<Vec<R>> {
    let bytes = std::fs::read(file);
    let bytes = bytes.map_err(|source| Error::File { path: file.to_owned(), wanted: "read", source })?;
    let place = |line: u64| format!("{}, line {line}", file.display());
    let unreadable = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        Refusal::new(place(line), error, format!("rows of {} columns or more, as in line 1", required.len()))
    };
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let header = reader.headers().map_err(unreadable)?;
    let columns: Vec<String> = header.iter().map(str::to_owned).collect();
    if required.iter().any(|column| !columns.iter().any(|found| found == column)) {
        let found = header.iter().collect::<Vec<_>>().join(",");
        return Err(Refusal::new(
            place(1),
            format!("{found:?}"),
            format!("the columns {}", required.join(",")),
        )
        .into());
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        let place = place(record.position().map_or(0, csv::Position::line));
        rows.push(row(&Cells { place, columns: &columns, record })?);
    }
    if rows.is_empty() {
        return Err(Refusal::new(place(2), "the end of the file", "at least one row").into());
    }
    Ok(rows)
}

/// The cells of one row.
struct Cells<'a> {
    place: String,
    columns: &'a [String],
    record: csv::StringRecord,
}

impl Cells<'_> {
    fn text(&self, column: &str) -> &str {
        let index = self.columns.iter().position(|known| *known == column);
        index.and_then(|index| self.record.get(index)).unwrap_or_default()
    }

    fn parsed<V>(
        &self,
        column: &str,
        allowed: &str,
        parse: impl Fn(&str) -> Option<V>,
    ) -> Result<V, Refusal> {
        let text = self.text(column);
        let refused = || Refusal::new(format!("{}, {column}", self.place), format!("{text:?}"), allowed);
        parse(text).ok_or_else(refused)
    }

    fn word(&self, column: &str) -> Result<String, Refusal> {
        self.parsed(column, "a word", |text| (!text.is_empty()).then(|| text.to_owned()))
    }

    fn number(&self, column: &str, allowed: &str, holds: impl Fn(f64) -> bool) -> Result<Number, Refusal> {
        self.parsed(column, allowed, |text| text.parse().ok().filter(|value| holds(*value)).map(Number))
    }

    /// A finite number of this kind, or none where nothing was found.
    fn result(&self, column: &str, (allowed, holds): Kind) -> Result<Option<Number>, Refusal> {
        if self.text(column).is_empty() {
            return Ok(None);
        }
        self.number(column, allowed, |value| holds(value) && value.is_finite()).map(Some)
    }

    /// As [`Self::result`], or infinite.
    fn bound(&self, column: &str, kind: Kind) -> Result<Option<Number>, Refusal> {
        match self.text(column) {
            "inf" => Ok(Some(Number(f64::INFINITY))),
            _ => self.result(column, kind),
        }
    }

    /// What stands behind C_r; where there is no such column, what its bounds tell.
    fn evidence(&self) -> Result<String, Refusal> {
        let there = |column| !self.text(column).is_empty();
        let evidence = match (there("critical_courant"), there("lower")) {
            (true, _) => PROVEN,
            (false, true) => LOWER_BOUND,
            (false, false) => "",
        };
        if self.columns.iter().any(|column| column == "evidence") {
            let allowed = format!("{evidence:?} beside such bounds");
            self.parsed("evidence", &allowed, |text| (text == evidence).then_some(()))?;
        }
        Ok(evidence.to_owned())
    }

    /// A result that lies between a lower and an upper bound; all three are there or none, or the bounds
    /// alone, the upper one infinite if none is known.
    fn enclosed(&self, columns: [&str; 3], kind: Kind) -> Result<Option<Number>, Refusal> {
        let [column, low, high] = columns;
        let (value, lower) = (self.result(column, kind)?.map(|x| x.0), self.result(low, kind)?.map(|x| x.0));
        let holds = match (value, lower, self.bound(high, kind)?.map(|x| x.0)) {
            (Some(value), Some(lower), Some(upper)) => lower <= value && value <= upper && upper.is_finite(),
            (None, Some(lower), Some(upper)) => lower <= upper,
            (None, None, None) => true,
            _ => false,
        };
        self.parsed(column, "a number from lower to upper, or none of the three", |_| {
            holds.then_some(value.map(Number))
        })
    }

    fn gamma(&self) -> Result<Number, Refusal> {
        self.number("gamma", "a number in [0, 1]", |gamma| (0.0..=1.0).contains(&gamma))
    }

    fn elements(&self) -> Result<usize, Refusal> {
        self.parsed("elements", "an integer of at least 1", |text| text.parse().ok().filter(|n| *n >= 1))
    }

    fn stiffness_penalty(&self) -> Result<Number, Refusal> {
        let allowed = "a finite number of at least 0";
        self.number("stiffness_penalty", allowed, |beta_s| beta_s >= 0.0 && beta_s.is_finite())
    }

    fn limit(&self) -> Result<&'static str, Refusal> {
        const SCHEMES: [SchemeName; 3] =
            [SchemeName::CentralDifference, SchemeName::PredictorCorrector, SchemeName::Park];
        let names = SCHEMES.map(SchemeName::name);
        let known = || names.into_iter().chain(["spectrum"]);
        let allowed = known().collect::<Vec<_>>().join(", ");
        self.parsed("limit", &allowed, |text| known().find(|name| *name == text))
    }
}
