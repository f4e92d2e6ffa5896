//! The references of `tests/data/extreme_cases.csv`, made by `extreme_cases.py` beside it.

use super::{Answer, Case};

const TABLE: &str = include_str!("../../../../tests/data/extreme_cases.csv");

/// Why a case has no reference.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{case}, {quantity}: no reference; allowed: a line of tests/data/extreme_cases.csv with a number")]
pub struct Unreadable {
    /// Name of the case.
    pub case: String,
    /// The quantity that was looked for.
    pub quantity: String,
}

/// The table of references.
#[derive(Debug, Clone)]
pub struct References<'a>(Vec<[&'a str; 4]>);

impl References<'static> {
    /// The table that this crate was built with.
    pub fn built_in() -> Self {
        Self::read(TABLE)
    }
}

impl<'a> References<'a> {
    /// Reads a table with the columns `case,quantity,unit,reference`; lines of another form are no references.
    pub fn read(table: &'a str) -> Self {
        let row = |line: &'a str| {
            let mut fields = line.split(',');
            Some([fields.next()?, fields.next()?, fields.next()?, fields.next()?])
        };
        Self(table.lines().skip(1).filter_map(row).collect())
    }

    /// Case, quantity, unit and value of every line.
    pub fn rows(&self) -> &[[&'a str; 4]] {
        &self.0
    }

    /// What `case` is held against.
    ///
    /// # Errors
    /// [`Unreadable`] if the table has no number for it.
    pub fn of(&self, case: &Case) -> Result<Answer, Unreadable> {
        if let Some(quantity) = case.refusal {
            return Ok(Answer::Refused(quantity.to_owned()));
        }
        let found = self.0.iter().find(|row| row[0] == case.name && row[1] == case.quantity);
        let value = found.and_then(|row| row[3].parse().ok());
        let missing = || Unreadable { case: case.name.clone(), quantity: case.quantity.to_owned() };
        value.map(Answer::Value).ok_or_else(missing)
    }
}
