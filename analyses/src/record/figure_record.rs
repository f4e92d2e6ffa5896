//! The record of a figure: by which command, from which build, of what, and which checks hold.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Origin, Provenance, Table};

/// What lies beside every figure as `<figure>.record.json`; no path and no user name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FigureRecord {
    /// Name of the figure.
    pub figure: String,
    /// The pictures.
    pub files: Vec<String>,
    /// Printed width, mm.
    pub width_mm: f64,
    /// Version of this crate.
    pub version: &'static str,
    /// Program, revision, platform and command.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// Of a figure that was drawn again: the runs that have computed its rows. Program and command above only drew them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub computed: Option<Vec<Origin>>,
    /// What is shown: the distinct words of the columns that say so, such as `scene` and `engine`.
    #[serde(flatten)]
    pub subject: BTreeMap<String, Vec<String>>,
    /// The rows that the figure shows.
    pub data: Vec<DataFile>,
    /// What was checked of them.
    pub checks: Vec<Check>,
    /// Of a figure that was drawn again: why rows could not be computed anew to be held against.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unchecked: Vec<String>,
    /// Whether every check holds.
    pub holds: bool,
    /// From the start of the run to this figure, s.
    pub seconds: f64,
}

/// A file of rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataFile {
    /// Name of the CSV file.
    pub file: String,
    /// Number of rows.
    pub rows: usize,
}

/// A statement about each row, and of how many it is true.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// The statement.
    pub check: String,
    /// Rows it speaks of.
    pub rows: usize,
    /// Rows it is true of.
    pub holds: usize,
}

/// Columns that say what a row is about.
const SUBJECT: [&str; 10] =
    ["scene", "mass", "elements", "limit", "scheme", "contact", "engine", "family", "problem", "method"];
/// The bound that a certified value has, and one that could not be certified has not.
const BOUND: &str = "lower";

impl FigureRecord {
    /// The record of `figure`, drawn from `data`; `about` are rows that say more of the same runs.
    pub fn new(
        figure: &str,
        width_mm: f64,
        provenance: Provenance,
        data: &[Table],
        about: Option<&Table>,
    ) -> Self {
        let all = || data.iter().chain(about);
        let mut subject: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for name in SUBJECT {
            for (table, words) in all().filter_map(|table| Some((table, table.column(name)?))) {
                let known = subject.entry(name.to_owned()).or_default();
                // An engine is named for what it has certified.
                let bounds = table.column(BOUND).filter(|_| name == "engine").unwrap_or_default();
                let counts = |row: usize| bounds.get(row).is_none_or(|bound| !bound.is_empty());
                for (row, word) in words.into_iter().enumerate() {
                    if counts(row) && !known.iter().any(|other| other == word) {
                        known.push(word.to_owned());
                    }
                }
            }
        }
        let checks: Vec<Check> = all().flat_map(|table| checks(table, CERTIFIED)).collect();
        Self {
            figure: figure.to_owned(),
            files: Vec::new(),
            width_mm,
            version: env!("CARGO_PKG_VERSION"),
            provenance,
            computed: None,
            subject,
            data: data.iter().map(|t| DataFile { file: t.file.clone(), rows: t.rows.len() }).collect(),
            holds: checks.iter().all(|check| check.holds == check.rows),
            checks,
            unchecked: Vec::new(),
            seconds: 0.0,
        }
    }
}

impl FigureRecord {
    /// The same record of a figure that was drawn again from rows of these runs: what they have certified was only read.
    /// `samples` says of how many rows, computed anew, the same was found.
    pub fn redrawn(mut self, computed: Vec<Origin>, data: &[Table], samples: Check) -> Self {
        self.checks = data.iter().flat_map(|table| checks(table, READ)).chain([samples]).collect();
        self.holds = self.checks.iter().all(|check| check.holds == check.rows);
        Self { computed: Some(computed), ..self }
    }
}

/// What is said of rows whose bounds this run has proven, and of rows whose bounds were read from a file.
const CERTIFIED: &str = "certified";
const READ: &str = "has bounds, not proven again";

/// The columns that say whether a check of a row holds.
const VERDICTS: [&str; 2] = ["holds", "agrees"];

/// What the columns of a table state of its rows: verdicts, enclosures, certificates and endings.
fn checks(table: &Table, bounded: &str) -> Vec<Check> {
    let mut checks = Vec::new();
    for name in VERDICTS {
        // An empty cell is no verdict.
        let cells = table.column(name).unwrap_or_default().into_iter().filter(|cell| !cell.is_empty());
        let cells: Vec<_> = cells.collect();
        if !cells.is_empty() {
            checks.push(count(name.to_owned(), cells, |cell| *cell == "true"));
        }
    }
    if table.column("engine").is_some() {
        let bounds = table.column(BOUND).unwrap_or_default();
        checks.push(count(bounded.to_owned(), bounds, |bound| !bound.is_empty()));
    }
    if let Some(endings) = table.column("ending") {
        checks.push(count("finished".to_owned(), endings, |ending| *ending == "finished"));
    }
    checks.extend(enclosure(table));
    checks
}

/// Whether the value before the columns `lower` and `upper` lies between them.
fn enclosure(table: &Table) -> Option<Check> {
    let lower = table.header.iter().position(|name| name == "lower").filter(|lower| *lower > 0)?;
    let upper = table.header.iter().position(|name| name == "upper")?;
    let (value, low, high) = (table.numbers(lower - 1), table.numbers(lower), table.numbers(upper));
    let rows = value.iter().zip(&low).zip(&high).filter(|((value, _), _)| !value.is_nan());
    let statement = format!("lower <= {} <= upper", table.header[lower - 1]);
    Some(count(statement, rows.collect(), |((value, low), high)| low <= value && value <= high))
}

fn count<C>(check: String, cells: Vec<C>, is_true: impl Fn(&C) -> bool) -> Check {
    Check { check, rows: cells.len(), holds: cells.iter().filter(|cell| is_true(cell)).count() }
}
