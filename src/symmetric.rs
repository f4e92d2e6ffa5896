//! Symmetric matrices: their factors and eigenvalues, by faer, on the thread that asks. Points are computed beside each other
//! already, and the last digits of what faer returns depend on how many threads share the work.

use std::sync::Arc;

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, Triplet};
use faer::{ColMut, Conj, Mat, MatMut, Par, Side};

/// L with L L' = A.
#[derive(Debug, Clone)]
pub(crate) struct Cholesky(Mat<f64>);

impl Cholesky {
    /// The factor of the symmetric `a`, of which the lower triangle is read; `None` where a pivot is not positive.
    pub fn new(mut a: Mat<f64>) -> Option<Self> {
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(a.nrows(), Par::Seq, Default::default());
        let stack = &mut MemBuffer::new(scratch);
        let (plain, params) = (Default::default(), Default::default());
        llt::factor::cholesky_in_place(a.as_mut(), plain, Par::Seq, MemStack::new(stack), params).ok()?;
        Some(Self(a))
    }

    /// A^-1 x, in the place of x.
    pub fn solve(&self, x: &mut [f64]) {
        self.solve_columns(ColMut::from_slice_mut(x).as_mat_mut());
    }

    /// A^-1 X, in the place of X.
    pub fn solve_columns(&self, mut x: MatMut<'_, f64>) {
        solve_lower_triangular_in_place(self.0.as_ref(), x.as_mut(), Par::Seq);
        self.turn_back(x);
    }

    /// L^-1 K L^-T.
    pub fn standard_form(&self, mut k: Mat<f64>) -> Mat<f64> {
        solve_lower_triangular_in_place(self.0.as_ref(), k.as_mut(), Par::Seq);
        let mut transposed = k.transpose().to_owned();
        solve_lower_triangular_in_place(self.0.as_ref(), transposed.as_mut(), Par::Seq);
        transposed
    }

    /// L^-T Y, in the place of Y: the vectors of (K, A) from those of the standard form.
    pub fn turn_back(&self, y: MatMut<'_, f64>) {
        solve_upper_triangular_in_place(self.0.transpose(), y, Par::Seq);
    }
}

/// The eigenvalues of a symmetric matrix, ascending; `None` without convergence.
pub(crate) fn eigenvalues(a: &Mat<f64>) -> Option<Vec<f64>> {
    decompose(a, None)
}

/// The eigenvalues of a symmetric matrix, ascending, and its eigenvectors as columns; `None` without convergence.
pub(crate) fn eigen(a: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let mut vectors = Mat::zeros(a.nrows(), a.nrows());
    Some((decompose(a, Some(vectors.as_mut()))?, vectors))
}

fn decompose(a: &Mat<f64>, vectors: Option<MatMut<'_, f64>>) -> Option<Vec<f64>> {
    let n = a.nrows();
    let wanted = if vectors.is_some() { ComputeEigenvectors::Yes } else { ComputeEigenvectors::No };
    let stack = &mut MemBuffer::new(self_adjoint_evd_scratch::<f64>(n, wanted, Par::Seq, Default::default()));
    let mut values = Diag::zeros(n);
    let (params, stack) = (Default::default(), MemStack::new(stack));
    self_adjoint_evd(a.as_ref(), values.as_mut(), vectors, Par::Seq, stack, params).ok()?;
    Some(values.column_vector().iter().copied().collect())
}

/// L with L L' = A for a sparse A, its rows in an order that leaves L sparse.
#[derive(Debug, Clone)]
pub(crate) struct SparseCholesky {
    symbolic: Arc<SymbolicCholesky<usize>>,
    values: Vec<f64>,
}

impl SparseCholesky {
    /// The factor of the n x n matrix with the entries `lower` on and below its diagonal; those at one place are added up.
    ///
    /// # Errors
    /// What faer says of a pivot that is not positive, or of memory.
    pub fn new(n: usize, lower: &[Triplet<usize, usize, f64>]) -> Result<Self, String> {
        let a =
            SparseColMat::<usize, f64>::try_new_from_triplets(n, n, lower).map_err(|e| format!("{e:?}"))?;
        let symbolic =
            factorize_symbolic_cholesky(a.symbolic(), Side::Lower, Default::default(), Default::default());
        let symbolic = symbolic.map_err(|e| format!("{e:?}"))?;
        let mut values = vec![0.0; symbolic.len_val()];
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|e| format!("{e:?}"))?;
        let (plain, params) = (Default::default(), Default::default());
        let stack = MemStack::new(&mut memory);
        symbolic
            .factorize_numeric_llt(&mut values, a.as_ref(), Side::Lower, plain, Par::Seq, stack, params)
            .map_err(|e| format!("{e:?}"))?;
        Ok(Self { symbolic: Arc::new(symbolic), values })
    }

    /// A^-1 x, in the place of x.
    pub fn solve(&self, x: &mut [f64]) {
        let factor = LltRef::<'_, usize, f64>::new(&self.symbolic, &self.values);
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let x = ColMut::from_slice_mut(x).as_mat_mut();
        factor.solve_in_place_with_conj(Conj::No, x, Par::Seq, MemStack::new(&mut memory));
    }
}
