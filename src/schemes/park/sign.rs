//! On which side of alpha = dt/dt_c a multiplier lies: the sign of the last pivot of C^-1 - W, in f64 or double-double.

use super::fractions::Fractions;
use crate::double_double::Real;
use crate::pencil::Penalty;
use crate::schemes::closed::ClosedContacts;
use crate::spectrum::{Flexibility, OfGaps, reach};

/// Diagonal entries of K and M that double-double arithmetic holds with room for their products.
const HELD: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// Which way the errors of W are tilted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Tilt {
    /// W as computed.
    None,
    /// W as large as its error allows: a stable sign is proven.
    Pessimistic,
    /// W as small as its error allows: an unstable sign is proven.
    Optimistic,
}

impl Tilt {
    fn sign(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Pessimistic => 1.0,
            Self::Optimistic => -1.0,
        }
    }
}

/// The condition of the Park scheme in the arithmetic T.
pub(super) struct Sign<T> {
    theta: f64,
    /// G = Z'M^-1 Z, 1/kg.
    compliance: OfGaps<T>,
}

/// p F(above) and v F(below), m/N, and what their entries are off by, relative.
struct Sides<T> {
    gained: OfGaps<T>,
    lost: OfGaps<T>,
    errors: [f64; 2],
}

impl<T: Real> Sign<T> {
    /// `None` for numbers too large or too small.
    pub fn new(closed: &ClosedContacts, theta: f64) -> Option<Self> {
        let held = |a: &Vec<f64>| a.iter().all(|a| *a == 0.0 || HELD.contains(a));
        let fits = held(&closed.pencil.stiffness().diagonal) && held(&closed.pencil.mass().diagonal);
        let condition = closed.pencil.pencil().bounds().mass;
        let compliance = Flexibility::new(closed.pencil).of(0.0, T::from(1.0), reach(condition))?;
        fits.then_some(Self { theta, compliance })
    }

    /// W of the single contact at alpha, m/N.
    pub fn effective_flexibility(&self, closed: &ClosedContacts, alpha: f64) -> Option<f64> {
        let sides = self.sides(closed, alpha, 0.0, Tilt::None)?;
        Some((sides.gained.diagonal[0] - sides.lost.diagonal[0]).value())
    }

    fn sides(&self, closed: &ClosedContacts, alpha: f64, growth: f64, tilt: Tilt) -> Option<Sides<T>> {
        let (free, bounds) = (closed.contact_free, closed.pencil.pencil().bounds());
        let fractions = Fractions::<T>::new(self.theta, alpha, growth);
        // Elimination moves a pole by 8 roundings of c l + B, as |M| <= c M; the pole takes some of its own.
        let error = |l: f64| {
            T::ROUNDOFF * (8.0 * (bounds.mass + 1.0 + bounds.stiffness / l) + Fractions::<T>::ROUNDINGS)
        };
        let tilted = |l: T, sign: f64| l * T::from(1.0 + sign * error(l.value()));
        let of = |k: f64, l: T, condition: f64| closed.flexibility.of(k, l, reach(bounds.mass * condition));
        let upper = T::from(free.value) * fractions.above;
        // Half of the distance to the spectrum, so that rounding and tilt are well within it.
        let distance = 0.5 * (upper.value() - free.upper) / upper.value();
        let gained = of(-1.0, tilted(upper, -tilt.sign()), 1.0 / distance)?;
        let mut errors =
            [if distance > 0.0 { 2.0 * error(upper.value()) / distance } else { f64::INFINITY }, 0.0];
        let mut lost = OfGaps::zeros(gained.diagonal.len());
        if let Some(below) = fractions.below {
            let lower = T::from(free.value) * below;
            lost = of(1.0, tilted(lower, tilt.sign()), 1.0 + free.upper / lower.value())?;
            errors[1] = 2.0 * error(lower.value());
        }
        Some(Sides { gained: gained.times(fractions.gain), lost: lost.times(fractions.loss), errors })
    }

    /// The last pivot of C^-1 - W over the sum of what it is made of, in [-1, 1]: positive while the multiplier
    /// -1 - `growth` lies beyond the spectrum; -1 if an earlier pivot is not positive. C^-1 = S^-1 + a G.
    ///
    /// C^-1 - W is a sum of positive semidefinite parts T = S^-1, a G, p F and -v F, each tridiagonal and put together bar
    /// by bar. If an entry of a part is off by e (T_ii T_jj)^(1/2), the part is off by no more than
    /// e (sum T_ii^(1/2) |y_i|)^2 <= 2 e sum T_ii y_i^2 at most, for the one or two contacts of a bar. So the errors of
    /// the entries beside the diagonal are borne by the diagonal, and its last pivot proves a sign.
    ///
    /// The entries of a bar between two contacts come of two eliminations, each exact for a matrix that differs by e, in
    /// units of l M: beside the shift of the pole, F(above) may be off by e l/(l - l_n) twice over, and F(below), where
    /// K + l M >= l M, by e twice over. G is off by 8 (c + 1) roundings, what a bar does not see of itself
    /// ([`Flexibility`]) by less than one, s and a by one each, the pivots of the margin by fewer than 8.
    pub fn margin(
        &self,
        closed: &ClosedContacts,
        penalty: &Penalty,
        alpha: f64,
        growth: f64,
        tilt: Tilt,
    ) -> f64 {
        let Some(Sides { gained, lost, errors }) = self.sides(closed, alpha, growth, tilt) else {
            return -1.0;
        };
        let one = T::from(1.0);
        let factor = if penalty.rate.is_finite() { one / T::from(penalty.rate) } else { T::from(0.0) };
        let scales = closed.pencil.scales();
        let coupled = if scales.len() > 1 { 1.0 } else { 0.0 };
        let mass = closed.pencil.pencil().bounds().mass;
        let entries = 2.0 * T::ROUNDOFF * (8.0 * (mass + 1.0) + 16.0 + Fractions::<T>::ROUNDINGS);
        let [entries, upper, lower] =
            [entries, entries + coupled * errors[0], entries + coupled * errors[1]].map(T::from);
        let (own, beside) = (&self.compliance.diagonal, &self.compliance.off_diagonal);
        let (mut carried, mut margin) = (T::from(0.0), -1.0);
        for (j, scale) in scales.iter().enumerate() {
            let (gain, loss) = (gained.diagonal[j], lost.diagonal[j]);
            let inverse = one / (T::from(penalty.stiffness) * T::from(scale.stiffness)) + factor * own[j];
            let mut pivot = inverse - gain + loss - carried;
            if tilt != Tilt::None {
                pivot = pivot - T::from(tilt.sign()) * (entries * inverse + upper * gain + lower * loss);
            }
            margin = (pivot / (inverse + gain + loss + carried)).value();
            if j + 1 == scales.len() {
                break;
            }
            if margin.is_nan() || margin <= 0.0 {
                return -1.0;
            }
            let off = factor * beside[j] - gained.off_diagonal[j] + lost.off_diagonal[j];
            carried = off * (off / pivot);
        }
        margin
    }
}
