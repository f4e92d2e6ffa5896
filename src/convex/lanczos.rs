//! The largest algebraic eigenvalue of (a K + t P, M): Lanczos with thick restarts.
//!
//! Wu, Simon, SIAM J. Matrix Anal. Appl. 22 (2000); Stewart's Krylov-Schur for symmetric matrices. The basis V is M-orthonormal, every
//! new vector is orthogonalised against all of it, and H = V'(aK + tP)V is kept in full, so that a restart with the
//! best Ritz vectors needs no bookkeeping. Each step multiplies by A - c M with c the last diagonal entry of H: the space is the
//! same, and what is to be taken out of the product is hardly longer than what is left. A second pass of orthogonalisation is
//! made where the first has cancelled: without it the basis loses its orthogonality by a factor a step, and the search its
//! vector. Nothing proven depends on it, since every vector is judged by its own Rayleigh quotient.

use faer::Mat;

use super::operator::Operator;
use super::vectors::{combine, project, pseudo_random, subtract};
use crate::symmetric;

/// How to look for an eigenvalue.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// Vectors in the basis before a restart.
    pub basis: usize,
    /// |A x - theta M x| in the norm of M^-1, as a part of theta, at which to stop.
    pub tolerance: f64,
    /// Products after which to give up.
    pub most_products: usize,
    /// Whether to search among the vectors with closed gaps, Z'x = 0, only: the limit t -> -infinity.
    pub closed: bool,
}

/// A Ritz pair: the best found.
#[derive(Debug, Clone)]
pub struct Ritz {
    /// The Ritz value; a lower bound of the largest eigenvalue up to rounding.
    pub value: f64,
    /// Its vector, x'Mx = 1.
    pub vector: Vec<f64>,
    /// |A x - value M x| in the norm of M^-1: some eigenvalue is no farther away.
    pub residual: f64,
    /// Whether the tolerance was reached.
    pub converged: bool,
}

/// Vectors that a restart keeps, of a basis of m: the usual half.
fn kept(m: usize) -> usize {
    (m / 2).max(1)
}

/// The largest algebraic eigenvalue of (a K + t P, M) for (a, t), from a start vector or a pseudo-random one.
pub fn largest(operator: &Operator, combination: (f64, f64), start: Option<&[f64]>, search: &Search) -> Ritz {
    let n = operator.pencil().size();
    let mut basis = vec![first_vector(operator, start, search.closed)];
    let most = search.basis.min(n).max(1);
    let mut h = Mat::<f64>::zeros(most, most);
    let begin = operator.products();
    let mut image = vec![0.0; n];
    let mut shift = 0.0;
    loop {
        let j = basis.len() - 1;
        operator.multiply(combination, &basis[j], &mut image);
        operator.take_mass(shift, &basis[j], &mut image);
        let column = project(&basis, &image);
        column.iter().enumerate().for_each(|(i, value)| (h[(i, j)], h[(j, i)]) = (*value, *value));
        h[(j, j)] += shift;
        shift = h[(j, j)];
        let mut next = image.clone();
        operator.solve_mass(&mut next);
        if search.closed {
            operator.close_gaps(&mut next);
        }
        subtract(&basis, &column, &mut next);
        let length = orthonormal(operator, &basis, &column, &mut next);
        let (full, spent) = (basis.len() == most, operator.products() - begin >= search.most_products);
        let exhausted = length == 0.0;
        if full || spent || exhausted || basis.len() % 5 == 0 {
            let (values, vectors) = eigen(h.as_ref().submatrix(0, 0, j + 1, j + 1).to_owned());
            let y: Vec<f64> = (0..=j).map(|i| vectors[(i, j)]).collect();
            let residual = length * y[j].abs();
            let converged = residual <= search.tolerance * values[j].abs() || exhausted;
            if converged || spent {
                return Ritz { value: values[j], vector: combine(&basis, &y), residual, converged };
            }
            if full {
                let keep = kept(most).min(most - 1);
                if keep == 0 {
                    return Ritz { value: values[j], vector: combine(&basis, &y), residual, converged };
                }
                basis = rotated(&basis, &vectors, keep);
                h.fill(0.0);
                (0..keep).for_each(|i| h[(i, i)] = values[j - i]);
            }
        }
        basis.push(next);
    }
}

fn first_vector(operator: &Operator, start: Option<&[f64]>, closed: bool) -> Vec<f64> {
    let n = operator.pencil().size();
    let mut v = pseudo_random(n, 1);
    // M-sized noise: as many units of each unknown as its mass makes a unit of energy.
    v.iter_mut().zip(operator.pencil().mass_diagonal()).for_each(|(v, m)| *v /= m.sqrt());
    if let Some(start) = start {
        // A start within one class of symmetry would stay there; a little noise opens the others.
        operator.normalise(&mut v);
        v.iter_mut().zip(start).for_each(|(v, x)| *v = x + 1e-3 * *v);
    }
    if closed {
        operator.close_gaps(&mut v);
    }
    operator.normalise(&mut v);
    v
}

/// Normalises `next`, orthogonalised once already by `column`; the length it had, 0 if nothing was left.
fn orthonormal(operator: &Operator, basis: &[Vec<f64>], column: &[f64], next: &mut [f64]) -> f64 {
    let removed = column.iter().map(|h| h * h).sum::<f64>().sqrt();
    let mut length = operator.normalise(next);
    // One pass leaves the error of the basis times removed/length, step by step: where that exceeds sqrt(2), a second pass
    // brings it back to rounding (Parlett, The Symmetric Eigenvalue Problem, 6.9: twice is enough).
    if length < std::f64::consts::FRAC_1_SQRT_2 * removed {
        let mut image = vec![0.0; next.len()];
        operator.pencil().multiply_mass(next, &mut image);
        subtract(basis, &project(basis, &image), next);
        length *= operator.normalise(next);
    }
    let nothing = basis.len() as f64 * f64::EPSILON * removed;
    if length <= 4.0 * nothing || !length.is_finite() { 0.0 } else { length }
}

/// The Ritz vectors of the `keep` largest values, which stand last in `vectors`.
fn rotated(basis: &[Vec<f64>], vectors: &Mat<f64>, keep: usize) -> Vec<Vec<f64>> {
    let m = basis.len();
    (0..keep)
        .map(|i| combine(basis, &(0..m).map(|row| vectors[(row, m - 1 - i)]).collect::<Vec<_>>()))
        .collect()
}

/// Eigenvalues, ascending, and eigenvectors of a small symmetric matrix.
pub(super) fn eigen(matrix: Mat<f64>) -> (Vec<f64>, Mat<f64>) {
    let n = matrix.nrows();
    // Without convergence (never seen) the last unit vector: a poor candidate, judged like any other.
    symmetric::eigen(&matrix)
        .unwrap_or_else(|| ((0..n).map(|i| matrix[(i, i)]).collect(), Mat::identity(n, n)))
}

/// The smallest and the largest eigenvalue of a tridiagonal matrix, by the signs of its pivots (Givens), to rounding.
pub(super) fn tridiagonal_ends(own: &[f64], beside: &[f64]) -> (f64, f64) {
    let off = |i: usize| beside.get(i).map_or(0.0, |b| b.abs());
    let reach = |i: usize| off(i) + if i > 0 { off(i - 1) } else { 0.0 };
    let ends = own.iter().enumerate().map(|(i, a)| (a - reach(i), a + reach(i)));
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (a, b)| (l.min(a), h.max(b)));
    // Whether sign (l - T) is positive definite.
    let definite = |l: f64, sign: f64| {
        let mut pivot = sign * (l - own[0]);
        for (i, a) in own.iter().enumerate().skip(1) {
            if pivot <= 0.0 {
                return false;
            }
            pivot = sign * (l - a) - off(i - 1) * off(i - 1) / pivot;
        }
        pivot > 0.0
    };
    let halve = |mut out: f64, mut inside: f64, sign: f64| {
        // 64 halvings pass the last digit of the size of the matrix.
        for _ in 0..64 {
            let middle = 0.5 * (out + inside);
            if definite(middle, sign) { out = middle } else { inside = middle }
        }
        out
    };
    (halve(low, high, -1.0), halve(high, low, 1.0))
}
