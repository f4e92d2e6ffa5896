//! The measurements that matter as a table in Markdown.

use super::{Family, Measurement, Status};

/// The sizes in the tables, or the largest below.
const EIGENVALUE_SIZE: usize = 1000;
const STEPPING_SIZE: usize = 400;

/// The eigenvalues of 1000 elements and the impacts of 400 with lumped mass at C = 0.5. `machine` says what the times were
/// taken on.
pub fn markdown(measurements: &[Measurement], machine: &str) -> String {
    let eigenvalues = of_size(measurements, Family::Eigenvalue, EIGENVALUE_SIZE);
    let mut impacts = of_size(measurements, Family::Stepping, STEPPING_SIZE);
    impacts.retain(|m| m.problem.contains("-lumped-") && m.method.ends_with("C=0.5"));
    let size = |of: &[&Measurement]| of.first().map_or(0, |m| m.size);
    format!(
        "Times on {machine}.\n\nLargest eigenvalue of {} elements: time, error of the critical step (> 0: too large, \
         unsafe). In bold what nothing beats.\n\n{}\nImpacts, {} elements in the first bar: time, rms error.\n\n{}",
        size(&eigenvalues),
        pivot(&eigenvalues, "method", |m| &m.method, |m| &m.problem),
        size(&impacts),
        pivot(&impacts, "problem", |m| &m.problem, |m| &m.method),
    )
}

/// The measurements of a family at `size`, or at the largest size below it.
fn of_size(measurements: &[Measurement], family: Family, size: usize) -> Vec<&Measurement> {
    let of = || measurements.iter().filter(|m| m.family == family);
    let size = of().map(|m| m.size).filter(|known| *known <= size).max();
    of().filter(|m| Some(m.size) == size).collect()
}

/// One row for each `line`, one column for each `column`.
fn pivot(
    measurements: &[&Measurement],
    corner: &str,
    line: impl Fn(&Measurement) -> &str,
    column: impl Fn(&Measurement) -> &str,
) -> String {
    let lines = distinct(measurements.iter().map(|m| line(m)));
    let columns = distinct(measurements.iter().map(|m| column(m)));
    let mut text = format!("| {corner} | {} |\n|---|{}\n", columns.join(" | "), "---|".repeat(columns.len()));
    for name in lines {
        let at = |at: &&str| measurements.iter().find(|m| line(m) == name && column(m) == *at);
        let cells: Vec<String> =
            columns.iter().map(|column| at(column).map_or_else(|| "–".to_owned(), |m| cell(m))).collect();
        text += &format!("| {name} | {} |\n", cells.join(" | "));
    }
    text
}

/// The items in their order, each once.
pub fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for item in items {
        if !found.contains(&item) {
            found.push(item);
        }
    }
    found
}

fn cell(measurement: &Measurement) -> String {
    match (&measurement.status, measurement.error, measurement.seconds) {
        (Status::Done, Some(error), Some(seconds)) => {
            let sign = if measurement.family == Family::Eigenvalue && error > 0.0 { "+" } else { "" };
            let text = format!("{}, {sign}{error:.1e}", duration(seconds));
            if measurement.on_front { format!("**{text}**") } else { text }
        }
        (status, ..) => status.to_string(),
    }
}

/// Three digits and a unit.
fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-6 => (s * 1e9, "ns"),
        s if s < 1e-3 => (s * 1e6, "µs"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    if value < 10.0 { format!("{value:.2} {unit}") } else { format!("{value:.0} {unit}") }
}
