//! The engine `lapack`: an oracle that shares no eigenvalue code with the other engines, and LAPACK's own routines for
//! the largest eigenvalue alone, to be timed beside them. Needs the feature `lapack`.

use faer::Mat;
use lapack::{dsbgvx, dsygvx};
use nalgebra::DMatrix;
use nalgebra_lapack::{Cholesky, SymmetricEigen};

use super::dense::{in_gap_coordinates, replaced, with_gaps_last};
use super::{Enclosure, Engine, Sturm, Uncertified, WIDEST_ENCLOSURE};
use crate::pencil::{ChainPencil, Penalty, Pencil, Tridiagonal};

/// The engine `lapack`: Cholesky factor, reduction to standard form and `dsyev`; O(n^3) operations a point.
#[derive(Debug)]
pub struct Lapack<'a> {
    pencil: ChainPencil<'a>,
    sturm: Sturm<'a>,
}

impl<'a> Lapack<'a> {
    /// The engine for `pencil`, whose Sturm counts prove it.
    pub fn new(pencil: ChainPencil<'a>) -> Self {
        Self { pencil, sturm: Sturm::new(pencil) }
    }
}

impl Engine for Lapack<'_> {
    fn name(&self) -> &'static str {
        "lapack"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Enclosure, Uncertified> {
        let (k, m) = with_gaps_last(self.pencil.pencil(), penalty);
        // Without a factor or without convergence there is no value: NaN, which no certificate accepts. As for the
        // engine `dense`: two Sturm counts, which leave a tenth of the widest enclosure to their rounding.
        let value = largest(columns(k), columns(m)).unwrap_or(f64::NAN);
        self.sturm.verify(penalty, value, 0.45 * WIDEST_ENCLOSURE)
    }
}

fn columns(a: Mat<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)])
}

/// A tridiagonal matrix with all its zeros, n x n.
pub fn full(matrix: &Tridiagonal) -> DMatrix<f64> {
    let n = matrix.diagonal.len();
    DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => matrix.diagonal[i],
        1 => matrix.off_diagonal[i.min(j)],
        _ => 0.0,
    })
}

/// K + K_p and M + M_p, dense n x n, in gap coordinates (the gap is a node of its own), in the order of the row.
pub fn gap_matrices(pencil: &Pencil, penalty: &Penalty) -> (DMatrix<f64>, DMatrix<f64>) {
    let (k, m) = in_gap_coordinates(pencil, penalty, &replaced(pencil));
    (columns(k), columns(m))
}

/// The largest eigenvalue of K x = l M x through L^-1 K L^-T, M = L L'. With eigenvectors, because the call of
/// nalgebra-lapack that leaves them out hands LAPACK an illegal argument.
fn largest(mut k: DMatrix<f64>, m: DMatrix<f64>) -> Option<f64> {
    let lower = Cholesky::new(m)?.unpack();
    if !lower.solve_lower_triangular_mut(&mut k) {
        return None;
    }
    k.transpose_mut();
    if !lower.solve_lower_triangular_mut(&mut k) {
        return None;
    }
    SymmetricEigen::try_new(k).map(|eigen| eigen.eigenvalues.max())
}

/// The lower half of a symmetric band matrix as LAPACK stores it: entry (i, j), i >= j, at `i - j + j (width + 1)`.
#[derive(Debug, Clone, PartialEq)]
pub struct BandMatrix {
    /// n.
    size: usize,
    /// Number of diagonals below the main one.
    width: usize,
    entries: Vec<f64>,
}

impl BandMatrix {
    /// The band of a symmetric matrix, no wider than its outermost entry that is not zero. A single contact has
    /// width 2 in gap coordinates.
    pub fn of(matrix: &DMatrix<f64>) -> Self {
        let size = matrix.nrows();
        let lower = |j: usize| (j..size).filter(move |i| matrix[(*i, j)] != 0.0).map(move |i| i - j);
        let width = (0..size).flat_map(lower).max().unwrap_or(0);
        let mut entries = vec![0.0; size * (width + 1)];
        for j in 0..size {
            for i in j..size.min(j + width + 1) {
                entries[i - j + j * (width + 1)] = matrix[(i, j)];
            }
        }
        Self { size, width, entries }
    }

    /// The band of a tridiagonal matrix.
    pub fn tridiagonal(matrix: &Tridiagonal) -> Self {
        let below = matrix.off_diagonal.iter().copied().chain([0.0]);
        let entries = matrix.diagonal.iter().copied().zip(below).flat_map(|(on, below)| [on, below]);
        Self { size: matrix.diagonal.len(), width: 1, entries: entries.collect() }
    }
}

/// The largest eigenvalue of K x = l M x by `dsygvx` (reduction to tridiagonal form, bisection for one eigenvalue).
/// `None` if M has no factor or the routine does not converge.
#[allow(unsafe_code)]
pub fn dsygvx_largest(mut k: DMatrix<f64>, mut m: DMatrix<f64>) -> Option<f64> {
    let size = k.nrows();
    assert!(size > 0 && k.shape() == (size, size) && m.shape() == (size, size));
    let n = i32::try_from(size).ok()?;
    let (mut found, mut info) = (0, 0);
    let (mut values, mut vectors) = (vec![f64::NAN; size], [f64::NAN]);
    let mut work = vec![0.0; 34 * size];
    let (mut iwork, mut failed) = (vec![0; 5 * size], vec![0; size]);
    // SAFETY: k and m are contiguous n x n columns with leading dimension n; w and ifail hold n, iwork 5n and work
    // lwork = 34n >= 8n entries, all alive through the call; z is not referenced without eigenvectors (jobz = N).
    unsafe {
        dsygvx(
            &[1],
            b'N',
            b'I',
            b'L',
            n,
            k.as_mut_slice(),
            n,
            m.as_mut_slice(),
            n,
            0.0,
            0.0,
            n,
            n,
            0.0,
            &mut found,
            &mut values,
            &mut vectors,
            1,
            &mut work,
            34 * n,
            &mut iwork,
            &mut failed,
            &mut info,
        );
    }
    (info == 0 && found == 1).then_some(values[0])
}

/// The largest eigenvalue of K x = l M x by `dsbgvx` (split Cholesky within the band, bisection for one eigenvalue).
/// `None` if M has no factor, is wider than K, or the routine does not converge.
#[allow(unsafe_code)]
pub fn dsbgvx_largest(mut k: BandMatrix, mut m: BandMatrix) -> Option<f64> {
    let size = k.size;
    assert!(size > 0 && m.size == size);
    if m.width > k.width {
        return None;
    }
    let (n, ka, kb) = (i32::try_from(size).ok()?, k.width as i32, m.width as i32);
    let (mut found, mut info) = (0, 0);
    let (mut values, mut vectors, mut reduction) = (vec![f64::NAN; size], [f64::NAN], [f64::NAN]);
    let mut work = vec![0.0; 7 * size];
    let (mut iwork, mut failed) = (vec![0; 5 * size], vec![0; size]);
    // SAFETY: ab and bb hold n columns of ka + 1 and kb + 1 <= ka + 1 entries, as `BandMatrix::of` lays them out; w and ifail
    // hold n, work 7n and iwork 5n entries, all alive through the call; q and z are not referenced (jobz = N).
    unsafe {
        dsbgvx(
            b'N',
            b'I',
            b'L',
            n,
            ka,
            kb,
            &mut k.entries,
            ka + 1,
            &mut m.entries,
            kb + 1,
            &mut reduction,
            1,
            0.0,
            0.0,
            n,
            n,
            0.0,
            &mut found,
            &mut values,
            &mut vectors,
            1,
            &mut work,
            &mut iwork,
            &mut failed,
            &mut info,
        );
    }
    (info == 0 && found == 1).then_some(values[0])
}
