//! Sparse matrices and vectors of any mesh: compressed rows, as scipy's CSR.
//!
//! A symmetric matrix is stored whole, so that a row is its column and a product needs one pass. Column indices are
//! 32 bits wide: a product is bound by memory, and reads 12 bytes an entry.

use std::fmt::{Debug, Formatter};
use std::ops::{Add, Deref};
use std::sync::Arc;

use rayon::prelude::*;

use crate::double_double::{Dd, Real};

/// Rows that one task of a parallel product takes.
const ROWS: usize = 4096;

/// Entries that a matrix owns, or that it shares with another owner, such as an array of another language: millions of
/// them need not be copied.
#[derive(Clone)]
pub enum Entries<T> {
    /// Of this matrix alone.
    Owned(Vec<T>),
    /// Of somebody else, who must not change them.
    Shared(Arc<dyn AsRef<[T]> + Send + Sync>),
}

impl<T> Deref for Entries<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match self {
            Self::Owned(entries) => entries,
            Self::Shared(entries) => (**entries).as_ref(),
        }
    }
}

impl<T> Default for Entries<T> {
    fn default() -> Self {
        Self::Owned(Vec::new())
    }
}

impl<T> From<Vec<T>> for Entries<T> {
    fn from(entries: Vec<T>) -> Self {
        Self::Owned(entries)
    }
}

impl<T: PartialEq> PartialEq for Entries<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: Debug> Debug for Entries<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        (**self).fmt(f)
    }
}

/// A sparse matrix by rows, `rows` x `columns`; the columns of each row ascend and occur once.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Csr {
    columns: usize,
    /// Where each row starts in `indices` and `values`; one more at the end.
    starts: Vec<usize>,
    /// Columns.
    indices: Entries<u32>,
    values: Entries<f64>,
}

/// A sparse column, such as the gap z of one contact: (index, entry) with ascending indices.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SparseVector(pub Vec<(u32, f64)>);

impl SparseVector {
    /// z'x.
    pub fn dot(&self, x: &[f64]) -> f64 {
        self.0.iter().map(|(i, z)| z * x[*i as usize]).sum()
    }

    /// x += factor z.
    pub fn add_to(&self, factor: f64, x: &mut [f64]) {
        self.0.iter().for_each(|(i, z)| x[*i as usize] += factor * z);
    }
}

impl Csr {
    /// The matrix of entries (row, column, value) in any order; those of the same place are added.
    ///
    /// Every row must be below `rows`, every column below `columns`, and `columns` at most 2^32.
    pub fn from_triplets(rows: usize, columns: usize, entries: &[(u32, u32, f64)]) -> Self {
        let mut starts = vec![0_usize; rows + 1];
        entries.iter().for_each(|(row, ..)| starts[*row as usize + 1] += 1);
        (0..rows).for_each(|row| starts[row + 1] += starts[row]);
        let mut next = starts.clone();
        let mut sorted = vec![(0_u32, 0.0); entries.len()];
        for (row, column, value) in entries {
            sorted[next[*row as usize]] = (*column, *value);
            next[*row as usize] += 1;
        }
        let (mut indices, mut values) =
            (Vec::with_capacity(entries.len()), Vec::with_capacity(entries.len()));
        let mut ends = vec![0];
        for row in 0..rows {
            let entries = &mut sorted[starts[row]..starts[row + 1]];
            entries.sort_by_key(|(column, _)| *column);
            push_row(entries, &mut indices, &mut values);
            ends.push(indices.len());
        }
        Self::from_parts(columns, ends, indices, values)
    }

    /// The matrix of `columns` columns whose row i has the entries `starts[i]..starts[i + 1]`; in each row the columns
    /// ascend and occur once.
    pub fn from_parts(
        columns: usize,
        starts: Vec<usize>,
        indices: impl Into<Entries<u32>>,
        values: impl Into<Entries<f64>>,
    ) -> Self {
        Self { columns, starts, indices: indices.into(), values: values.into() }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of stored entries.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether no entry is stored.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Columns and values of a row.
    pub fn row(&self, row: usize) -> (&[u32], &[f64]) {
        let range = self.starts[row]..self.starts[row + 1];
        (&self.indices[range.clone()], &self.values[range])
    }

    /// Row starts, columns and values: what a factorisation or a foreign package reads.
    pub fn parts(&self) -> (&[usize], &[u32], &[f64]) {
        (&self.starts, &self.indices, &self.values)
    }

    /// The entry at a place, 0 where none is stored.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let (columns, values) = self.row(row);
        columns.binary_search(&(column as u32)).map_or(0.0, |at| values[at])
    }

    /// y = A x, rows in parallel; the result does not depend on the number of threads.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        let (starts, indices, entries) = self.parts();
        y.par_chunks_mut(ROWS).enumerate().for_each(|(chunk, y)| {
            let first = chunk * ROWS;
            for (i, y) in y.iter_mut().enumerate() {
                let range = starts[first + i]..starts[first + i + 1];
                let row = indices[range.clone()].iter().zip(&entries[range]);
                *y = row.map(|(column, value)| value * x[*column as usize]).sum();
            }
        });
    }

    /// x'A y, summed with twice the digits: the square of a large translation, which a stiffness takes out again, leaves
    /// nothing of its rounding. Rows in parallel; the result does not depend on the number of threads.
    pub fn quadratic(&self, x: &[f64], y: &[f64]) -> f64 {
        let sum = |(task, rows): (usize, &[f64])| {
            let mut sum = Dd::from(0.0);
            for (x, i) in rows.iter().zip(task * ROWS..) {
                let (columns, values) = self.row(i);
                sum = sum + Dd::from(*x) * Dd::dot(values, columns, y);
            }
            sum
        };
        let sums: Vec<Dd> = x.par_chunks(ROWS).enumerate().map(sum).collect();
        sums.into_iter().fold(Dd::from(0.0), Dd::add).value()
    }
}

/// Appends the entries of a row whose columns ascend; equal ones are added.
fn push_row(entries: &[(u32, f64)], indices: &mut Vec<u32>, values: &mut Vec<f64>) {
    let start = indices.len();
    for (column, value) in entries {
        match (indices[start..].last(), values.last_mut()) {
            (Some(last), Some(sum)) if last == column => *sum += value,
            _ => {
                indices.push(*column);
                values.push(*value);
            }
        }
    }
}

/// The scale of a gap z: over the parts z_b that it has on the bodies `body_of` (of each unknown), the smallest
/// z_b'K z_b/(z_b'z_b)^2, N/m: EA/h of the element at the end of a bar. `None` for a gap without entries.
///
/// K couples no unknowns of different bodies.
pub fn gap_scale(k: &Csr, gap: &SparseVector, body_of: impl Fn(u32) -> usize) -> Option<f64> {
    let mut parts: Vec<(usize, f64, f64)> = Vec::new();
    for (i, z) in &gap.0 {
        let energy: f64 = gap.0.iter().map(|(j, other)| z * k.get(*i as usize, *j as usize) * other).sum();
        let body = body_of(*i);
        match parts.iter_mut().find(|part| part.0 == body) {
            Some(part) => (part.1, part.2) = (part.1 + energy, part.2 + z * z),
            None => parts.push((body, energy, z * z)),
        }
    }
    parts.iter().map(|(_, energy, square)| energy / (square * square)).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triplets_in_any_order_add_up_and_multiply() {
        let entries = [(1, 2, 5.0), (0, 0, 1.0), (1, 0, 2.0), (1, 2, 0.5), (2, 1, -3.0)];
        let a = Csr::from_triplets(3, 3, &entries);
        assert_eq!((a.rows(), a.len(), a.get(1, 2), a.get(2, 2)), (3, 4, 5.5, 0.0));
        let mut y = [f64::NAN; 3];
        a.multiply(&[1.0, 10.0, 100.0], &mut y);
        assert_eq!(y, [1.0, 552.0, -30.0]);
        let mut x = [0.0; 3];
        SparseVector(vec![(0, 2.0), (2, -1.0)]).add_to(3.0, &mut x);
        assert_eq!((x, SparseVector(vec![(2, 2.0)]).dot(&x)), ([6.0, 0.0, -3.0], -6.0));
    }
}
