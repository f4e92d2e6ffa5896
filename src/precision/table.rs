//! The measurements that matter as a table in Markdown.

use super::{Family, Measurement, Status};

/// The size of the eigenvalue problems in the table.
const SIZE: usize = 1000;

/// The eigenvalues of 1000 elements (or of the most there are) and the Pareto fronts of the impacts. `machine` says what
/// the times were taken on.
pub fn markdown(measurements: &[Measurement], machine: &str) -> String {
    let of = |family| measurements.iter().filter(move |m| m.family == family);
    let sizes = || of(Family::Eigenvalue).map(|m| m.size);
    let size = sizes().filter(|size| *size <= SIZE).max().or_else(|| sizes().max()).unwrap_or(SIZE);
    let mut text = format!("Times on {machine}.\n");
    let eigenvalues: Vec<&Measurement> = of(Family::Eigenvalue).filter(|m| m.size == size).collect();
    text += &format!(
        "\nLargest eigenvalue of {size} elements: time and error of the critical step, > 0 unsafe; **front** in bold.\n\n"
    );
    text += &pivot(&eigenvalues, "method", |m| m.method.clone(), |m| m.problem.clone());
    text += "\nOn the Pareto front of the impacts, lumped mass (elements of the first bar: time, error).\n\n";
    let front: Vec<&Measurement> =
        of(Family::Stepping).filter(|m| m.on_front && m.problem.contains("-lumped-")).collect();
    text += &fronts(&front);
    text
}

/// One line a method, one column a problem.
fn pivot(
    measurements: &[&Measurement],
    corner: &str,
    line: impl Fn(&Measurement) -> String,
    column: impl Fn(&Measurement) -> String,
) -> String {
    let lines = distinct(measurements.iter().map(|m| line(m)));
    let columns = distinct(measurements.iter().map(|m| column(m)));
    let mut text = format!("| {corner} | {} |\n|---|{}\n", columns.join(" | "), "---|".repeat(columns.len()));
    for name in &lines {
        let cells: Vec<String> = columns
            .iter()
            .map(|at| {
                let found = measurements.iter().find(|m| line(m) == *name && column(m) == *at);
                found.map_or_else(|| "–".to_owned(), |m| cell(m))
            })
            .collect();
        text += &format!("| {name} | {} |\n", cells.join(" | "));
    }
    text
}

/// One line a problem and scheme.
fn fronts(measurements: &[&Measurement]) -> String {
    let mut text = "| problem | method | elements: time, error |\n|---|---|---|\n".to_owned();
    for (problem, method) in distinct(measurements.iter().map(|m| (m.problem.clone(), m.method.clone()))) {
        let cells: Vec<String> = measurements
            .iter()
            .filter(|m| m.problem == problem && m.method == method)
            .filter_map(|m| {
                let (error, seconds) = m.coordinates()?;
                Some(format!("{}: {}, {error:.1e}", m.size, duration(seconds)))
            })
            .collect();
        text += &format!("| {problem} | {method} | {} |\n", cells.join("; "));
    }
    text
}

fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
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
            let text = format!("{}, {error:+.1e}", duration(seconds));
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
