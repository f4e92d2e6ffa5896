//! What matrices must be before anything is computed with them.

use rayon::prelude::*;

use super::reader::{Entries, Form};
use crate::error::Refusal;
use crate::pencil::Matrix;
use crate::sparse::{Csr, SparseVector};

/// Entries (i, j) and (j, i) of a symmetric matrix differ by the rounding of the sums they came from: each entry is a sum
/// of one term an element, at most about 2^8 of them, each rounded relative to the diagonal, which bounds it.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

/// The stiffness: square and symmetric.
pub(super) fn stiffness(file: &Entries) -> Result<Csr, Refusal> {
    square(file, file.rows)?;
    symmetric(file)
}

fn square(file: &Entries, size: usize) -> Result<(), Refusal> {
    if (file.rows, file.columns) == (size, size) && size > 0 {
        return Ok(());
    }
    let allowed = if size == 0 { "at least one unknown".to_owned() } else { format!("{size} x {size}") };
    Err(Refusal::new(file.place(sizes_line(file)), format!("{} x {}", file.rows, file.columns), allowed))
}

/// The line of the sizes is above the first entry.
fn sizes_line(file: &Entries) -> u32 {
    file.lines.first().map_or(1, |line| line.saturating_sub(1).max(1))
}

/// The whole matrix, made symmetric to the last bit.
fn symmetric(file: &Entries) -> Result<Csr, Refusal> {
    let read = Csr::from_triplets(file.rows, file.columns, &file.whole());
    if file.symmetric {
        return Ok(read);
    }
    let place = |row: u32, column: u32| file.place(file.line_of(row, column));
    Ok(symmetrised(&read, place)?.unwrap_or(read))
}

/// The mean of a square matrix and its mirror; `None` if they are the same to the last bit. `place` names an entry.
///
/// # Errors
/// Entries that differ from their mirror by more than rounding.
pub(super) fn symmetrised(read: &Csr, place: impl Fn(u32, u32) -> String) -> Result<Option<Csr>, Refusal> {
    let differs = |row: usize| {
        let (columns, values) = read.row(row);
        columns.iter().zip(values).any(|(column, value)| read.get(*column as usize, row) != *value)
    };
    if !(0..read.rows()).into_par_iter().any(differs) {
        return Ok(None);
    }
    let mut mean = Vec::with_capacity(read.len());
    for row in 0..read.rows() {
        let (columns, values) = read.row(row);
        for (column, value) in columns.iter().zip(values) {
            let other = read.get(*column as usize, row);
            let scale = (read.get(row, row) * read.get(*column as usize, *column as usize)).abs().sqrt();
            let allowed = ROUNDING * scale.max(value.abs()).max(other.abs());
            if (value - other).abs() > allowed {
                let value = format!("entry ({}, {}) = {value}", row + 1, column + 1);
                let allowed =
                    format!("a symmetric matrix: its mirror is {other}, the difference may be {allowed:e}");
                return Err(Refusal::new(place(row as u32, *column), value, allowed));
            }
            mean.push((row as u32, *column, 0.5 * (value + other)));
            // A mirror that is not stored has no turn of its own; one that is stored as 0 has.
            if read.row(*column as usize).0.binary_search(&(row as u32)).is_err() {
                mean.push((*column, row as u32, 0.5 * value));
            }
        }
    }
    Ok(Some(Csr::from_triplets(read.rows(), read.columns(), &mean)))
}

/// The mass: n x n symmetric or its diagonal as n x 1, with a positive diagonal.
pub(super) fn mass(file: &Entries, stiffness: &Entries) -> Result<Matrix, Refusal> {
    let size = stiffness.rows;
    if file.form == Form::MatrixMarket && file.columns == 1 && size > 1 && file.rows == size {
        let mut diagonal = vec![0.0; size];
        file.entries.iter().for_each(|(row, _, value)| diagonal[*row as usize] += value);
        return positive(file, &diagonal, |row| (row, 0)).map(|()| Matrix::Diagonal(diagonal));
    }
    square(file, size)?;
    if let (Some(own), Some(wanted)) = (&file.labels, &stiffness.labels)
        && let Some(((node, dof), (known, direction))) =
            own.iter().zip(wanted).find(|(own, wanted)| own != wanted)
    {
        let value = format!("node {node}, dof {dof}");
        let allowed =
            format!("the unknowns of {}: here node {known}, dof {direction}", stiffness.path.display());
        return Err(Refusal::new(file.path.display().to_string(), value, allowed));
    }
    let matrix = symmetric(file)?;
    let diagonal: Vec<f64> = (0..size).map(|row| matrix.get(row, row)).collect();
    positive(file, &diagonal, |row| (row, row))?;
    if let Some((row, column, value)) = too_large(&matrix, &diagonal) {
        let value = format!("entry ({}, {}) = {value}", row + 1, column + 1);
        let allowed = "a positive definite mass: m_ij^2 < m_ii m_jj";
        return Err(Refusal::new(file.place(file.line_of(row, column)), value, allowed));
    }
    let is_diagonal = matrix.len() == size;
    Ok(if is_diagonal { Matrix::Diagonal(diagonal) } else { Matrix::Sparse(matrix) })
}

/// An entry that no definite matrix has: m_ij^2 >= m_ii m_jj.
fn too_large(matrix: &Csr, diagonal: &[f64]) -> Option<(u32, u32, f64)> {
    (0..matrix.rows()).find_map(|row| {
        let (columns, values) = matrix.row(row);
        let mut off = columns.iter().zip(values).filter(|(column, _)| **column as usize != row);
        let large = |(column, value): &(&u32, &f64)| {
            value.abs() >= diagonal[row].sqrt() * diagonal[**column as usize].sqrt()
        };
        off.find(large).map(|(column, value)| (row as u32, *column, *value))
    })
}

fn positive(file: &Entries, diagonal: &[f64], entry: impl Fn(u32) -> (u32, u32)) -> Result<(), Refusal> {
    let Some(row) = diagonal.iter().position(|m| *m <= 0.0) else { return Ok(()) };
    let (i, j) = entry(row as u32);
    let value = format!("mass {} of unknown {}", diagonal[row], row + 1);
    Err(Refusal::new(file.place(file.line_of(i, j)), value, "a mass above 0 for every unknown"))
}

/// The gaps: n x k, no column zero.
pub(super) fn gaps(file: &Entries, size: usize) -> Result<Vec<SparseVector>, Refusal> {
    if file.form != Form::MatrixMarket || file.rows != size || file.columns == 0 {
        let value = format!("{} x {}", file.rows, file.columns);
        let allowed = format!("{size} x k in Matrix Market form, a column a contact");
        return Err(Refusal::new(file.place(sizes_line(file)), value, allowed));
    }
    let mut entries = file.whole();
    entries.iter_mut().for_each(|(row, column, _)| std::mem::swap(row, column));
    let transposed = Csr::from_triplets(file.columns, size, &entries);
    let column = |at: usize| {
        let (rows, values) = transposed.row(at);
        let entries = rows.iter().zip(values).filter(|(_, z)| **z != 0.0);
        let gap: Vec<(u32, f64)> = entries.map(|(row, z)| (*row, *z)).collect();
        if gap.is_empty() {
            let line = file.entries.iter().position(|(_, j, _)| *j as usize == at).map(|i| file.lines[i]);
            let place = file.place(line.unwrap_or_else(|| sizes_line(file)));
            return Err(Refusal::new(
                place,
                format!("column {} without an entry", at + 1),
                "a gap that moves: z other than 0",
            ));
        }
        Ok(SparseVector(gap))
    };
    (0..file.columns).map(column).collect()
}

/// A vector: `count` x 1.
pub(super) fn vector(file: &Entries, count: usize) -> Result<Vec<f64>, Refusal> {
    if file.form != Form::MatrixMarket || (file.rows, file.columns) != (count, 1) {
        let value = format!("{} x {}", file.rows, file.columns);
        return Err(Refusal::new(
            file.place(sizes_line(file)),
            value,
            format!("{count} x 1 in Matrix Market form"),
        ));
    }
    let mut vector = vec![0.0; count];
    file.entries.iter().for_each(|(row, _, value)| vector[*row as usize] += value);
    Ok(vector)
}

/// The scales: k x 1, positive.
pub(super) fn scales(file: &Entries, count: usize) -> Result<Vec<f64>, Refusal> {
    let scales = vector(file, count)?;
    match scales.iter().position(|w| *w <= 0.0) {
        None => Ok(scales),
        Some(at) => {
            let place = file.place(file.line_of(at as u32, 0));
            Err(Refusal::new(
                place,
                format!("scale {} of contact {}", scales[at], at + 1),
                "a number above 0, N/m",
            ))
        }
    }
}
