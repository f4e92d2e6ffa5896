//! Arrays of numpy as matrices of the library, without copying their entries.
#![allow(unsafe_code)]

use std::sync::Arc;

use bipenalty::error::Refusal;
use bipenalty::pencil::{Gap, Matrix};
use bipenalty::sparse::{Csr, Entries, SparseVector};
use numpy::{Element, IntoPyArray as _, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::refused;

/// The entries of an array, which is kept alive for as long as they are.
struct Foreign<T> {
    _array: Py<PyArray1<T>>,
    first: *const T,
    length: usize,
}

// SAFETY: the entries are plain numbers that are only read, and the array that holds them lives as long as this.
unsafe impl<T: Sync> Send for Foreign<T> {}
// SAFETY: as above.
unsafe impl<T: Sync> Sync for Foreign<T> {}

impl<T> AsRef<[T]> for Foreign<T> {
    fn as_ref(&self) -> &[T] {
        // SAFETY: `shared` took both from a contiguous, aligned slice of the array, and numpy moves no entries of an array
        // that somebody refers to (but for `resize(refcheck=False)`, which says so).
        unsafe { std::slice::from_raw_parts(self.first, self.length) }
    }
}

/// The entries of a contiguous array, shared with it.
fn shared<T: Element + Sync + 'static>(array: &PyReadonlyArray1<'_, T>) -> PyResult<Entries<T>> {
    let slice = array.as_slice().map_err(|e| PyValueError::new_err(e.to_string()))?;
    let (first, length) = (slice.as_ptr(), slice.len());
    Ok(Entries::Shared(Arc::new(Foreign { _array: (**array).clone().unbind(), first, length })))
}

/// A matrix in compressed rows, as scipy has it: its shape, where its rows start, the columns and the values.
#[derive(FromPyObject)]
pub struct Rows<'py>(
    (usize, usize),
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, u32>,
    PyReadonlyArray1<'py, f64>,
);

impl Rows<'_> {
    /// The matrix called `name`, which shares columns and values with the arrays.
    ///
    /// # Errors
    /// Starts that are not those of the rows; columns that are out of range, do not ascend or occur twice.
    pub fn matrix(&self, name: &str) -> PyResult<Csr> {
        let Self((rows, columns), starts, indices, values) = self;
        let (indices, values) = (shared(indices)?, shared(values)?);
        let starts: Vec<i64> = starts.as_array().to_vec();
        let wrong = |what: &str, value: String, allowed: String| {
            Err(refused(Refusal::new(format!("{name}, {what}"), value, allowed)))
        };
        let stored = indices.len() as i64;
        let ends = (starts.first().copied(), starts.last().copied());
        if starts.len() != rows + 1
            || ends != (Some(0), Some(stored))
            || starts.windows(2).any(|pair| pair[0] > pair[1])
            || values.len() != indices.len()
        {
            let value = format!("{} starts from {ends:?}, {} values", starts.len(), values.len());
            let allowed =
                format!("{} ascending starts from 0 to {stored}, as many values as columns", rows + 1);
            return wrong("indptr", value, allowed);
        }
        // All between 0 and the number of entries, as was seen.
        let starts: Vec<usize> = starts.into_iter().map(|start| start as usize).collect();
        for (row, range) in starts.windows(2).enumerate() {
            let found = &indices[range[0]..range[1]];
            let last = found.last().is_some_and(|last| *last as usize >= *columns);
            if last || found.windows(2).any(|pair| pair[0] >= pair[1]) {
                let allowed = format!("ascending columns below {columns}, each once");
                return wrong(&format!("row {row}"), format!("{found:?}"), allowed);
            }
        }
        Ok(Csr::from_parts(*columns, starts, indices, values))
    }

    /// The mass: a diagonal where nothing else is stored.
    ///
    /// # Errors
    /// As [`Rows::matrix`].
    pub fn mass(&self) -> PyResult<Matrix> {
        let matrix = self.matrix("mass")?;
        let (_, columns, values) = matrix.parts();
        let is_diagonal = matrix.rows() == values.len()
            && matrix.columns() == values.len()
            && columns.iter().enumerate().all(|(row, column)| *column as usize == row);
        Ok(if is_diagonal { Matrix::Diagonal(values.to_vec()) } else { Matrix::Sparse(matrix) })
    }

    /// The gaps on `size` unknowns, which are the rows of Z'; zeros are left out.
    ///
    /// # Errors
    /// As [`Rows::matrix`]; a Z of another size.
    pub fn gaps(&self, size: usize) -> PyResult<Vec<SparseVector>> {
        let matrix = self.matrix("gaps")?;
        if matrix.columns() != size {
            let value = format!("{} x {}", matrix.columns(), matrix.rows());
            return Err(refused(Refusal::new(
                "gaps",
                value,
                format!("{size} x k, as the stiffness has rows"),
            )));
        }
        let gap = |at: usize| {
            let (rows, values) = matrix.row(at);
            let entries = rows.iter().zip(values).filter(|(_, z)| **z != 0.0);
            SparseVector(entries.map(|(row, z)| (*row, *z)).collect())
        };
        Ok((0..matrix.rows()).map(gap).collect())
    }
}

/// A mass matrix, or the diagonal of one.
#[derive(FromPyObject)]
pub enum MassOrRows<'py> {
    Diagonal(PyReadonlyArray1<'py, f64>),
    Rows(Rows<'py>),
}

/// Starts, columns and values of the rows of a matrix, and its shape.
type OwnRows<'py> =
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>, (usize, usize));

/// K, M and Z by rows, and the scales.
pub type Parts<'py> = (OwnRows<'py>, OwnRows<'py>, OwnRows<'py>, Bound<'py, PyArray1<f64>>);

/// Matrices and contacts as arrays of their own; scales in N/m.
pub fn parts<'py>(py: Python<'py>, stiffness: &Matrix, mass: &Matrix, gaps: &[Gap]) -> Parts<'py> {
    let size = stiffness.size();
    let own = |rows: Vec<Vec<(usize, f64)>>, columns: usize| {
        let mut starts = vec![0_i64];
        starts.extend(rows.iter().scan(0, |sum, row| {
            *sum += row.len() as i64;
            Some(*sum)
        }));
        let shape = (rows.len(), columns);
        let entries: Vec<(usize, f64)> = rows.concat();
        let indices: Vec<i64> = entries.iter().map(|(column, _)| *column as i64).collect();
        let values: Vec<f64> = entries.iter().map(|(_, value)| *value).collect();
        (starts.into_pyarray(py), indices.into_pyarray(py), values.into_pyarray(py), shape)
    };
    let whole =
        |matrix: &Matrix| (0..size).map(|i| matrix.row(i).filter(|(_, a)| *a != 0.0).collect()).collect();
    let mut z = vec![Vec::new(); size];
    for (j, gap) in gaps.iter().enumerate() {
        gap.column.0.iter().for_each(|(i, value)| z[*i as usize].push((j, *value)));
    }
    let scales: Vec<f64> = gaps.iter().map(|gap| gap.scale).collect();
    (own(whole(stiffness), size), own(whole(mass), size), own(z, gaps.len()), scales.into_pyarray(py))
}

/// A sum over the bits of matrices: another one where an entry was changed.
pub fn fingerprint(matrices: &[&Matrix]) -> u64 {
    let mix = |sum: u64, word: u64| (sum ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
    let sparse = |sum: u64, matrix: &Csr| {
        let (_, columns, values) = matrix.parts();
        let sum = columns.iter().fold(sum, |sum, column| mix(sum, u64::from(*column)));
        values.iter().fold(sum, |sum, value| mix(sum, value.to_bits()))
    };
    matrices.iter().fold(0, |sum, matrix| match matrix {
        Matrix::Sparse(matrix) => sparse(sum, matrix),
        // Not shared.
        Matrix::Chain(_) | Matrix::Diagonal(_) => sum,
    })
}
