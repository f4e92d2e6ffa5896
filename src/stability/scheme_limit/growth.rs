//! How fast an unstable step grows just above the limit: |z| - 1 of the largest multiplier, as far as it is predicted.

use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, Par, Side};

use super::SchemeLimit;
use super::predictor_corrector::Definite;
use crate::pencil::{Gap, Penalty, Tridiagonal};
use crate::schemes::Scheme;
use crate::spectrum::bisect;

impl SchemeLimit<'_> {
    /// |z| - 1 at dt = `relative_courant` times the contact-free step: 0 where the scheme is stable, `None` where no
    /// formula is at hand (several contacts of the predictor-corrector, a Park step beyond dt_c).
    ///
    /// A real multiplier beyond -1 is found to rounding. Between dt^2 s' mu = 1 and about 4/3 the predictor-corrector
    /// has complex ones only; the largest grows by v dt^2 (dt^2 s' mu - 1)/(2 s'), to first order, with v the largest
    /// residue of T(l) = -1/phi(l), at the modes x_h that hold the gap: v = (x_h'(K - l_h M) z)^2. For large s' that is
    /// far below what a run can show.
    pub fn growth(&self, penalties: &[Penalty], relative_courant: f64) -> Option<f64> {
        if self.scheme() == Scheme::Park {
            return (relative_courant <= 1.0).then(|| self.park_growth(penalties, relative_courant));
        }
        let squared_step = 4.0 * relative_courant * relative_courant / self.contact_free.value;
        let (mu, q) = (self.compliance(), self.contact_eigenvalue(penalties));
        let plasticity = 0.25 * q * squared_step;
        let definite = Definite { limit: self, q, mu };
        let real = real_growth(&definite, plasticity / mu / (1.0 - plasticity), squared_step);
        if real.is_some() || plasticity <= 1.0 {
            return Some(real.unwrap_or(0.0));
        }
        let residue = self.largest_residue()?;
        Some(residue * squared_step * (plasticity - 1.0) / (0.5 * q / mu))
    }

    /// The largest residue -v of T at its poles, N rad^2/(m s^2); one contact only.
    fn largest_residue(&self) -> Option<f64> {
        let [gap] = self.pencil.gaps() else { return None };
        let (k, m) =
            (in_gap_coordinates(self.pencil.stiffness(), *gap), in_gap_coordinates(self.pencil.mass(), *gap));
        let n = k.nrows() - 1;
        let factor = Llt::new(m.get(..n, ..n), Side::Lower).ok()?;
        let mut reduced = k.get(..n, ..n).to_owned();
        solve_lower_triangular_in_place(factor.L(), reduced.as_mut(), Par::Seq);
        let mut reduced = reduced.transpose().to_owned();
        solve_lower_triangular_in_place(factor.L(), reduced.as_mut(), Par::Seq);
        let modes = reduced.self_adjoint_eigen(Side::Lower).ok()?;
        let mut shapes = modes.U().to_owned();
        solve_upper_triangular_in_place(factor.L().transpose(), shapes.as_mut(), Par::Seq);
        let residue = |h: usize| {
            let l = modes.S().column_vector()[h];
            let coupling = |i: usize| shapes[(i, h)] * (k[(i, n)] - l * m[(i, n)]);
            (0..n).map(coupling).sum::<f64>().powi(2)
        };
        Some((0..n).map(residue).fold(0.0, f64::max))
    }
}

/// The growth of a real multiplier -1 - g: l M - K + k (1 + g)/dt^2 Z Z' at l = (2 + g)^2/(dt^2 (1 + g)) changes its
/// inertia there. `None` if it does not.
fn real_growth(definite: &Definite, k: f64, squared_step: f64) -> Option<f64> {
    let holds = |g: f64| {
        let l = (2.0 + g) * ((2.0 + g) / (1.0 + g)) / squared_step;
        definite.holds(l, k * (1.0 + g) / squared_step)
    };
    // For large g the sign is that of M + Z k Z'.
    let at_rest = holds(0.0);
    let far = k > 0.0;
    if at_rest == far {
        return None;
    }
    let mut high = f64::EPSILON;
    while holds(high) == at_rest && high < 1e30 {
        high *= 4.0;
    }
    let (low, high) = bisect(0.25 * high, high, |g| holds(g) == far);
    Some(low + 0.5 * (high - low))
}

/// A matrix with the gap of one contact as its last coordinate: the node of a wall, or in place of the right node of
/// a pair q = u_left - u_right.
fn in_gap_coordinates(matrix: &Tridiagonal, gap: Gap) -> Mat<f64> {
    let n = matrix.diagonal.len();
    let gap_node = match gap {
        Gap::Wall { node } => node,
        Gap::Pair { left } => left + 1,
    };
    let at = |i: usize, j: usize| match i.abs_diff(j) {
        0 => matrix.diagonal[i],
        1 => matrix.off_diagonal[i.min(j)],
        _ => 0.0,
    };
    // Column c of the change of coordinates: the node that it moves, with its neighbour across the contact.
    let moved = |c: usize| -> Vec<(usize, f64)> {
        if c + 1 == n {
            let sign = if matches!(gap, Gap::Wall { .. }) { 1.0 } else { -1.0 };
            return vec![(gap_node, sign)];
        }
        let node = if c < gap_node { c } else { c + 1 };
        match gap {
            Gap::Pair { left } if node == left => vec![(left, 1.0), (gap_node, 1.0)],
            _ => vec![(node, 1.0)],
        }
    };
    let columns: Vec<_> = (0..n).map(moved).collect();
    Mat::from_fn(n, n, |a, b| {
        let pairs = columns[a].iter().flat_map(|x| columns[b].iter().map(move |y| (x, y)));
        pairs.map(|((i, x), (j, y))| x * y * at(*i, *j)).sum()
    })
}
