//! What a pencil refuses, by place and value.

use super::{Gap, Matrix};
use crate::error::Refusal;

/// Equal sizes of at least 1, finite and symmetric entries, a positive diagonal of the mass.
pub(crate) fn matrices(stiffness: &Matrix, mass: &Matrix) -> Result<(), Refusal> {
    let n = stiffness.size();
    if n == 0 {
        return Err(Refusal::new("stiffness", "a matrix without a row", "at least one unknown"));
    }
    for (name, matrix) in [("stiffness", stiffness), ("mass", mass)] {
        let columns = match matrix {
            Matrix::Chain(a) => a.off_diagonal.len() + 1,
            Matrix::Diagonal(d) => d.len(),
            Matrix::Sparse(a) => a.columns(),
        };
        if (matrix.size(), columns) != (n, n) {
            let value = format!("{} x {columns}", matrix.size());
            return Err(Refusal::new(name, value, format!("{n} x {n}, as the stiffness has rows")));
        }
        for i in 0..n {
            row(name, matrix, i)?;
        }
    }
    match (0..n).find(|i| mass.diagonal(*i) <= 0.0) {
        Some(i) => Err(Refusal::new(format!("mass, row {i}"), mass.diagonal(i), "a positive diagonal (kg)")),
        None => Ok(()),
    }
}

fn row(name: &str, matrix: &Matrix, i: usize) -> Result<(), Refusal> {
    for (j, a) in matrix.row(i) {
        let place = || format!("{name}, row {i}, column {j}");
        if !a.is_finite() {
            return Err(Refusal::new(place(), a, "finite entries"));
        }
        if let Matrix::Sparse(sparse) = matrix
            && sparse.get(j, i) != a
        {
            let allowed = format!("a symmetric matrix: {:e} as in row {j}, column {i}", sparse.get(j, i));
            return Err(Refusal::new(place(), format!("{a:e}"), allowed));
        }
    }
    Ok(())
}

/// Columns that exist and are not zero, positive scales.
pub(crate) fn gaps(gaps: &[Gap], n: usize) -> Result<(), Refusal> {
    for (j, gap) in gaps.iter().enumerate() {
        let place = |what: &str| format!("gap {j}, {what}");
        let entries = &gap.column.0;
        if entries.is_empty() {
            return Err(Refusal::new(place("column"), "no entry", "at least one"));
        }
        for (k, (i, z)) in entries.iter().enumerate() {
            if *i as usize >= n {
                return Err(Refusal::new(
                    place("column"),
                    format!("index {i}"),
                    format!("indices below {n}"),
                ));
            }
            if k > 0 && entries[k - 1].0 >= *i {
                return Err(Refusal::new(place("column"), format!("index {i}"), "ascending indices"));
            }
            if !z.is_finite() || *z == 0.0 {
                return Err(Refusal::new(place("column"), z, "finite entries other than 0"));
            }
        }
        positive(&place("scale"), gap.scale, "N/m")?;
        if !gap.initial.is_finite() {
            return Err(Refusal::new(place("initial"), gap.initial, "a finite number (m)"));
        }
    }
    Ok(())
}

pub(super) fn positive(place: &str, value: f64, unit: &str) -> Result<(), Refusal> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Refusal::new(place, value, format!("a positive finite number ({unit})")))
}
