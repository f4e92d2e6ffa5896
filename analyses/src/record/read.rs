//! Reading records back from the CSV files that a run has written, every cell checked.

use std::path::Path;

use super::{CostRow, LOWER_BOUND, Number, OptimalRatioRow, PROVEN, StabilityRow};
use crate::error::{Error, Refusal, Result};
use bipenalty::damping::Damping;
use bipenalty::schemes::explicit::ExplicitName;
use bipenalty::schemes::{SchemeName, damped};

/// A row that can be read back from its file.
pub(super) trait Row: Sized {
    /// The columns in their order.
    const COLUMNS: &'static [&'static str];
    /// How many of them, from the first, are in every file.
    const REQUIRED: usize;

    fn read(cells: &Cells) -> Result<Self, Refusal>;
}

/// What a result may be, in words and as a test.
pub(super) type Kind = (&'static str, fn(f64) -> bool);
pub(super) const POSITIVE: Kind = ("a positive number, or nothing", |value| value > 0.0);
pub(super) const NOT_NEGATIVE: Kind = ("a number of at least 0, or nothing", |value| value >= 0.0);

/// The rows of a file that `stability-map` or `scheme-limits` has written, also before there were steps in seconds and
/// evidence in it. Further columns are left alone.
///
/// # Errors
/// A file that cannot be read; a column that is missing; the first cell with a value that no such row has, by its line.
pub fn stability_rows(file: &Path) -> Result<Vec<StabilityRow>> {
    rows(file)
}

/// The rows of a file that `optimal-ratio` or `scheme-limits` has written.
///
/// # Errors
/// As [`stability_rows`].
pub fn optimal_ratio_rows(file: &Path) -> Result<Vec<OptimalRatioRow>> {
    rows(file)
}

/// The rows of a file that `scheme-limits --per-force` has written.
///
/// # Errors
/// As [`stability_rows`].
pub fn cost_rows(file: &Path) -> Result<Vec<CostRow>> {
    rows(file)
}

fn rows<R: Row>(file: &Path) -> Result<Vec<R>> {
    let required = &R::COLUMNS[..R::REQUIRED];
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
        rows.push(R::read(&Cells { place, columns: &columns, record })?);
    }
    if rows.is_empty() {
        return Err(Refusal::new(place(2), "the end of the file", "at least one row").into());
    }
    Ok(rows)
}

/// The cells of one row.
pub(super) struct Cells<'a> {
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

    pub(super) fn word(&self, column: &str) -> Result<String, Refusal> {
        self.parsed(column, "a word", |text| (!text.is_empty()).then(|| text.to_owned()))
    }

    fn number(&self, column: &str, allowed: &str, holds: impl Fn(f64) -> bool) -> Result<Number, Refusal> {
        self.parsed(column, allowed, |text| text.parse().ok().filter(|value| holds(*value)).map(Number))
    }

    /// A finite number of this kind, or none where nothing was found.
    pub(super) fn result(&self, column: &str, (allowed, holds): Kind) -> Result<Option<Number>, Refusal> {
        if self.text(column).is_empty() {
            return Ok(None);
        }
        self.number(column, allowed, |value| holds(value) && value.is_finite()).map(Some)
    }

    /// As [`Self::result`], or infinite.
    pub(super) fn bound(&self, column: &str, kind: Kind) -> Result<Option<Number>, Refusal> {
        match self.text(column) {
            "inf" => Ok(Some(Number(f64::INFINITY))),
            _ => self.result(column, kind),
        }
    }

    /// What stands behind C_r; where there is no such column, what its bounds tell.
    pub(super) fn evidence(&self, column: &str) -> Result<String, Refusal> {
        let there = |column| !self.text(column).is_empty();
        let evidence = match (there("critical_courant"), there("lower")) {
            (true, _) => PROVEN,
            (false, true) => LOWER_BOUND,
            (false, false) => "",
        };
        if !self.columns.iter().any(|known| known == column) {
            return Ok(evidence.to_owned());
        }
        // An enclosure may be wrong with a probability instead.
        let chance = |text: &str| {
            evidence == PROVEN && text.parse().is_ok_and(|wrong: f64| 0.0 < wrong && wrong < 1.0)
        };
        let allowed = format!("{evidence:?} beside such bounds");
        self.parsed(column, &allowed, |text| (text == evidence || chance(text)).then(|| text.to_owned()))
    }

    /// A result that lies between a lower and an upper bound; all three are there or none, or the bounds
    /// alone, the upper one infinite if none is known.
    pub(super) fn enclosed(
        &self,
        column: &str,
        [low, high]: [&str; 2],
        kind: Kind,
    ) -> Result<Option<Number>, Refusal> {
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

    pub(super) fn gamma(&self, column: &str) -> Result<Option<Number>, Refusal> {
        self.result(column, ("a number in [0, 1], or nothing", |gamma| (0.0..=1.0).contains(&gamma)))
    }

    pub(super) fn elements(&self, column: &str) -> Result<Option<usize>, Refusal> {
        let count = |text: &str| match text {
            "" => Some(None),
            text => text.parse().ok().filter(|n| *n >= 1).map(Some),
        };
        self.parsed(column, "an integer of at least 1, or nothing", count)
    }

    pub(super) fn count(&self, column: &str) -> Result<usize, Refusal> {
        self.parsed(column, "an integer of at least 1", |text| text.parse().ok().filter(|n| *n >= 1))
    }

    pub(super) fn ratio(&self, column: &str) -> Result<Number, Refusal> {
        self.number(column, "a number above 0, or inf", |r| r > 0.0)
    }

    pub(super) fn truth(&self, column: &str) -> Result<bool, Refusal> {
        self.parsed(column, "true or false", |word| word.parse().ok())
    }

    pub(super) fn stiffness_penalty(&self, column: &str) -> Result<Number, Refusal> {
        let allowed = "a finite number of at least 0";
        self.number(column, allowed, |beta_s| beta_s >= 0.0 && beta_s.is_finite())
    }

    pub(super) fn limit(&self, column: &str) -> Result<&'static str, Refusal> {
        let schemes = || SchemeName::PAPER.into_iter();
        // Damped schemes have names of their own.
        let lagging = Damping::new(1.0, 0.0, 0.0)?;
        let damped = schemes().filter_map(|name| Some(damped(name, lagging).ok()?.facts().name));
        let damped: Vec<&'static str> = damped.collect();
        let known = || {
            let others = ExplicitName::ALL.into_iter().map(ExplicitName::name);
            schemes().map(SchemeName::name).chain(["spectrum"]).chain(others).chain(damped.iter().copied())
        };
        let allowed = known().collect::<Vec<_>>().join(", ");
        self.parsed(column, &allowed, |text| known().find(|name| *name == text))
    }
}
