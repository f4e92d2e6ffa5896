//! The reduction of a pencil to one symmetric matrix.

use bipenalty::convex::MeshPencil;
use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par, Side};

/// L^-1 (a K + t P) L^-T, dense, and M = L L'.
pub fn reduced(pencil: &MeshPencil, a: f64, t: f64) -> (Mat<f64>, Llt<f64>) {
    let n = pencil.size();
    let (mut k, mut m) = (Mat::<f64>::zeros(n, n), Mat::<f64>::zeros(n, n));
    let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
    for j in 0..n {
        x[j] = 1.0;
        pencil.multiply(a, t, &x, &mut y);
        (0..n).for_each(|i| k[(i, j)] = y[i]);
        pencil.multiply_mass(&x, &mut y);
        (0..n).for_each(|i| m[(i, j)] = y[i]);
        x[j] = 0.0;
    }
    let factor = Llt::new(m.as_ref(), Side::Lower).unwrap();
    solve_lower_triangular_in_place(factor.L(), k.as_mut(), Par::Seq);
    let mut k = k.transpose().to_owned();
    solve_lower_triangular_in_place(factor.L(), k.as_mut(), Par::Seq);
    (Mat::from_fn(n, n, |i, j| 0.5 * (k[(i, j)] + k[(j, i)])), factor)
}
