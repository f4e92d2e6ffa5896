//! The largest Ritz value of a span, and far below t = 0 too.
//!
//! There H = S - |t| B'B, with S = V'KV, B = W^1/2 Z'V, holds values of S beside values |t| mu, and an eigensolver leaves eps |t| mu of
//! them. The singular vectors of B tell both apart: among those that hold the gaps closed, f, the others follow by s,
//!
//! ```text
//! y_s = (l + |t| sigma_s^2 - S_ss)^-1 S_sf y_f      (S_ff - |t| sigma_f^2 + S_fs (l + |t| sigma_s^2 - S_ss)^-1 S_sf) y_f = l y_f
//! ```
//! where the inverse is that of a matrix which is nearly diagonal, and hardly depends on l. Whatever y is, its quotient is a bound.

use faer::Mat;

use super::lanczos::eigen;
use crate::symmetric::Cholesky;

/// Where |t| mu exceeds S by this, its rounding is larger than a part of 1e-11 of S.
const FAR: f64 = 1e5;

/// A vector opens gaps where |t| sigma^2 exceeds S by this: the inverse is diagonal to this part.
const OPEN: f64 = 1e4;

/// The y of the largest y'(S + t B'B) y/y'y, `s` being S, `penalty` the matrix B'B and `gaps` a B.
pub(super) fn largest(s: &Mat<f64>, penalty: &Mat<f64>, t: f64, gaps: impl FnOnce() -> Mat<f64>) -> Vec<f64> {
    let k = s.nrows();
    let most = |a: &Mat<f64>| (0..k).map(|i| a[(i, i)].abs()).fold(0.0, f64::max);
    if -t * most(penalty) > FAR * most(s)
        && let Some(y) = far(s, gaps(), -t, most(s))
    {
        return y;
    }
    let (_, vectors) = eigen(Mat::from_fn(k, k, |i, j| s[(i, j)] + t * penalty[(i, j)]));
    (0..k).map(|i| vectors[(i, k - 1)]).collect()
}

fn far(s: &Mat<f64>, b: Mat<f64>, t: f64, size: f64) -> Option<Vec<f64>> {
    let k = s.nrows();
    let b = if b.nrows() > k { b.qr().thin_R().to_owned() } else { b };
    let found = b.svd().ok()?;
    let v = found.V();
    let sigma = |i: usize| if i < b.nrows() { t * found.S()[i] * found.S()[i] } else { 0.0 };
    let open = (0..k).take_while(|i| sigma(*i) > OPEN * size).count();
    if open == 0 || open == k {
        return None;
    }
    let turned = v.transpose() * s * v;
    let part = |rows: usize, columns: usize, i0: usize, j0: usize| {
        Mat::from_fn(rows, columns, |i, j| turned[(i0 + i, j0 + j)])
    };
    let (shut, coupling) = (part(k - open, k - open, open, open), part(open, k - open, 0, open));
    let mut value = shut[(0, 0)];
    let mut y = None;
    // The value enters beside OPEN times its size: the second round leaves the square of its part.
    for _ in 0..2 {
        let stiff =
            Mat::from_fn(open, open, |i, j| (if i == j { value + sigma(i) } else { 0.0 }) - turned[(i, j)]);
        let mut response = coupling.clone();
        Cholesky::new(stiff)?.solve_columns(response.as_mut());
        let added = coupling.transpose() * &response;
        let whole = Mat::from_fn(k - open, k - open, |i, j| {
            shut[(i, j)] + 0.5 * (added[(i, j)] + added[(j, i)]) - if i == j { sigma(open + i) } else { 0.0 }
        });
        let (values, vectors) = eigen(whole);
        value = values[k - open - 1];
        let closed = Mat::from_fn(k - open, 1, |i, _| vectors[(i, k - open - 1)]);
        let follows = &response * &closed;
        let all = Mat::from_fn(k, 1, |i, _| if i < open { follows[(i, 0)] } else { closed[(i - open, 0)] });
        y = Some(v * all);
    }
    let y = y?;
    let length = (0..k).map(|i| y[(i, 0)] * y[(i, 0)]).sum::<f64>().sqrt();
    Some((0..k).map(|i| y[(i, 0)] / length).collect())
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    /// S = [2 1; 1 3] and one gap along the first vector, in a basis turned by 1 radian: f(t) -> 3 as the gap closes like 1/t, and
    /// y = (1/(3 + |t| - 2), 1) to the first order.
    #[test]
    fn gaps_close_like_one_over_t() {
        let (c, s) = (1_f64.cos(), 1_f64.sin());
        let q = Mat::from_fn(2, 2, |i, j| [[c, -s], [s, c]][i][j]);
        let stiffness = &q * Mat::from_fn(2, 2, |i, j| [[2.0, 1.0], [1.0, 3.0]][i][j]) * q.transpose();
        let gaps = Mat::from_fn(1, 1, |_, _| 1.0) * Mat::from_fn(1, 2, |_, j| [c, s][j]);
        let penalty = gaps.transpose() * &gaps;
        for t in [1e3, 1e6, 1e9, 1e12] {
            let y = super::largest(&stiffness, &penalty, -t, || gaps.clone());
            let (gap, other) = (c * y[0] + s * y[1], c * y[1] - s * y[0]);
            let part = gap / other * (t + 1.0);
            assert!((part - 1.0).abs() < 1e-15 * t + 2.0 / t, "{t:e}: {part}");
        }
    }
}
