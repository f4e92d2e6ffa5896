//! How fast an unstable step grows just above the limit: |z| - 1 of the largest multiplier, as far as it is predicted.

use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, Par, Side};

use super::SchemeLimit;
use super::predictor_corrector::Definite;
use crate::pencil::{EndGap, Penalty, Tridiagonal};
use crate::schemes::SchemeName as Scheme;
use crate::spectrum::bisect;

impl SchemeLimit<'_> {
    /// |z| - 1 at dt = `relative_courant` times the contact-free step: 0 where the scheme is stable, `None` where no
    /// formula is at hand (a Park step beyond dt_c with a contact that moves the top mode).
    ///
    /// A real multiplier beyond -1 is found to rounding. Between dt^2 s' mu = 1 and about 4/3 the predictor-corrector
    /// has complex ones only; the largest grows by v dt^2 (dt^2 s' mu - 1)/(2 s'), to first order, with v the largest
    /// residue of T(l) = -1/phi(l), at the modes x_h that hold the gaps: v = |Z'(K - l_h M) x_h|^2. For large s' that is
    /// far below what a run can show.
    pub fn growth_at(&self, penalty: &Penalty, relative_courant: f64) -> Option<f64> {
        let terms = &*self.pencil.terms(penalty);
        if self.scheme() == Scheme::Park {
            return self.park_growth(terms, relative_courant);
        }
        let squared_step = 4.0 * relative_courant * relative_courant / self.contact_free.value;
        let (mu, q) = (self.compliance(), self.contact_eigenvalue(terms));
        let plasticity = 0.25 * q * squared_step;
        let definite = Definite { limit: self, q, mu };
        let k = if q == 0.0 { 0.0 } else { plasticity / mu / (1.0 - plasticity) };
        let real = real_growth(&definite, k, squared_step);
        if real.is_some() || plasticity <= 1.0 {
            return Some(real.unwrap_or(0.0));
        }
        let residue = self.largest_residue()?;
        Some(residue * squared_step * (plasticity - 1.0) / (0.5 * q / mu))
    }

    /// The largest residue -v of T at its poles, N rad^2/(m s^2); of several contacts the trace.
    fn largest_residue(&self) -> Option<f64> {
        let gaps = self.pencil.gaps();
        let (k, m) =
            (in_gap_coordinates(self.pencil.stiffness(), gaps), in_gap_coordinates(self.pencil.mass(), gaps));
        let n = k.nrows() - gaps.len();
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
            let coupling = |i: usize, gap: usize| shapes[(i, h)] * (k[(i, gap)] - l * m[(i, gap)]);
            (n..k.nrows()).map(|gap| (0..n).map(|i| coupling(i, gap)).sum::<f64>().powi(2)).sum()
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
    let far = k >= 0.0;
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

/// A matrix with the gaps as its last coordinates: the node of a wall, or in place of the right node of a pair
/// q = u_left - u_right.
fn in_gap_coordinates(matrix: &Tridiagonal, gaps: &[EndGap]) -> Mat<f64> {
    let n = matrix.diagonal.len();
    let at = |i: usize, j: usize| match i.abs_diff(j) {
        0 => matrix.diagonal[i],
        1 => matrix.off_diagonal[i.min(j)],
        _ => 0.0,
    };
    let gap_column = |gap: &EndGap| match *gap {
        EndGap::Wall { node } => vec![(node, 1.0)],
        EndGap::Pair { left } => vec![(left + 1, -1.0)],
    };
    // Column c of the change of coordinates: the nodes that it moves.
    let last: Vec<Vec<(usize, f64)>> = gaps.iter().map(gap_column).collect();
    let is_last = |node: &usize| last.iter().any(|column| column[0].0 == *node);
    let together = |node: usize| gaps.contains(&EndGap::Pair { left: node });
    let first = (0..n)
        .filter(|node| !is_last(node))
        .map(|node| if together(node) { vec![(node, 1.0), (node + 1, 1.0)] } else { vec![(node, 1.0)] });
    let columns: Vec<_> = first.collect::<Vec<_>>().into_iter().chain(last).collect();
    Mat::from_fn(n, n, |a, b| {
        let pairs = columns[a].iter().flat_map(|x| columns[b].iter().map(move |y| (x, y)));
        pairs.map(|((i, x), (j, y))| x * y * at(*i, *j)).sum()
    })
}
