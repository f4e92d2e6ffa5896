//! What a run leaves behind: typed rows, written as CSV or JSON, and where they come from.
//!
//! ```
//! use analyses::record::{Number, csv};
//! # #[derive(serde::Serialize)]
//! struct Row { ratio: Number }
//! assert_eq!(csv([Row { ratio: Number(f64::INFINITY) }])?, b"ratio\ninf\n");
//! # Ok::<(), analyses::error::Error>(())
//! ```

mod columns;
mod cost_rows;
mod field_rows;
mod figure_record;
mod impact_rows;
mod mesh_rows;
mod opening_rows;
mod origin;
mod passage_rows;
mod provenance;
mod read;
mod rows;
mod step_rows;
mod study_rows;
mod table;
mod verify_rows;

pub use cost_rows::{CostRow, Price};
pub use field_rows::{ElementRow, SurfaceRow};
pub use figure_record::{Check, DataFile, FigureRecord};
pub use impact_rows::{HistoryRow, ImpactRow, StressRow};
pub use mesh_rows::MeshRow;
pub use opening_rows::{OpeningRow, Recommendation, scans};
pub use origin::Origin;
pub use passage_rows::{ContactRow, PassageRow, PlaceRow};
pub use provenance::Provenance;
pub use read::{cost_rows, optimal_ratio_rows, stability_rows};
pub use rows::{GIVEN, LOWER_BOUND, Number, OptimalRatioRow, PROVEN, StabilityRow, Subject};
pub use step_rows::StepRow;
pub use study_rows::StudyRow;
pub use table::Table;
pub use verify_rows::VerifyRow;

use serde::Serialize;

use crate::error::{Error, Result};

/// Rows as CSV with a header line. Numbers read back to the same f64; infinity is `inf`, an unknown value empty.
///
/// # Errors
/// Only if a row cannot be serialised, which no row of this crate does.
pub fn csv<R: Serialize>(rows: impl IntoIterator<Item = R>) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let failed = |error: &dyn std::fmt::Display| Error::Record(error.to_string());
    for row in rows {
        writer.serialize(row).map_err(|e| failed(&e))?;
    }
    writer.into_inner().map_err(|e| failed(&e))
}

/// Rows with their provenance as JSON: `{"provenance": .., "rows": [..]}`. Infinity is the string `"inf"`, an unknown
/// value `null`.
///
/// # Errors
/// As [`csv()`].
pub fn json<R: Serialize>(provenance: &Provenance, rows: impl IntoIterator<Item = R>) -> Result<Vec<u8>> {
    #[derive(Serialize)]
    struct Document<'a, R> {
        provenance: &'a Provenance,
        rows: Vec<R>,
    }
    pretty(&Document { provenance, rows: rows.into_iter().collect() })
}

/// The record of a figure as JSON.
///
/// # Errors
/// As [`csv()`].
pub fn figure_json(record: &FigureRecord) -> Result<Vec<u8>> {
    pretty(record)
}

fn pretty(document: &impl Serialize) -> Result<Vec<u8>> {
    let mut text = serde_json::to_vec_pretty(document).map_err(|e| Error::Record(e.to_string()))?;
    text.push(b'\n');
    Ok(text)
}
