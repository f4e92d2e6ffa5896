//! How fast an unstable step grows just above the limit: |z| - 1 of the largest multiplier, as far as it is predicted.

use super::definite::Definite;
use super::limit::ClosedLimit;
use crate::pencil::{Penalty, Terms};
use crate::spectrum::{bisect, with_gaps_last};
use crate::symmetric::{Cholesky, eigen};

impl ClosedLimit<'_> {
    /// |z| - 1 at dt = `relative_courant` times the contact-free step: 0 where the scheme is stable.
    ///
    /// A real multiplier beyond -1 is found to rounding. Between dt^2 s' mu = 1 and about 4/3 there are complex ones only;
    /// the largest grows by v dt^2 (dt^2 s' mu - 1)/(2 s'), to first order, with v the largest residue of T(l) = -1/phi(l),
    /// at the modes x_h that hold the gaps: v = |Z'(K - l_h M) x_h|^2. For large s' that is far below what a run can show.
    pub(super) fn growth_at(&self, terms: &[Terms], relative_courant: f64) -> Option<f64> {
        let squared_step = 4.0 * relative_courant * relative_courant / self.closed.contact_free.value;
        let (mu, q) = (self.closed.first_compliance(), self.closed.contact_eigenvalue(terms));
        let plasticity = 0.25 * q * squared_step;
        let k = if q == 0.0 { 0.0 } else { plasticity / mu / (1.0 - plasticity) };
        let real = real_growth(&self.definite(q), k, squared_step);
        if real.is_some() || plasticity <= 1.0 {
            return Some(real.unwrap_or(0.0));
        }
        let residue = self.largest_residue()?;
        Some(residue * squared_step * (plasticity - 1.0) / (0.5 * q / mu))
    }

    /// The largest residue -v of T at its poles, N rad^2/(m s^2); of several contacts the trace.
    fn largest_residue(&self) -> Option<f64> {
        let (k, m) = with_gaps_last(self.closed.pencil.pencil(), &Penalty::NONE);
        let n = k.nrows() - self.closed.pencil.gaps().len();
        let factor = Cholesky::new(m.get(..n, ..n).to_owned())?;
        let (values, mut shapes) = eigen(&factor.standard_form(k.get(..n, ..n).to_owned()))?;
        factor.turn_back(shapes.as_mut());
        let residue = |h: usize| {
            let l = values[h];
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
