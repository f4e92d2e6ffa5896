//! The limit of the Park scheme with closed contacts, as l = 4/dt^2.
//!
//! At z = -1 with alpha = dt/dt_c, w = theta dt_c^2 alpha (1 - alpha^2)/6, b = w dt_c^2/2, a = dt^2/2 + w the scheme leaves
//! (2 M - dt^2/2 K - b K M^-1 K) u = (a + b K M^-1) Z C Z' u, so that
//!
//! ```text
//! det(I - C W) = 0      W(dt) = sum_i (Z'x_i)(Z'x_i)' (a + b l_i)/(2 - dt^2 l_i/2 - b l_i^2)
//! ```
//! The denominator has one root above l_n and one below 0; the partial fractions express W by Z'(K - l M)^-1 Z at the
//! two, an elimination of the rows each ([`Flexibility`](crate::spectrum::Flexibility)); for small steps a power series
//! with positive terms does. With dt_c = 2/sqrt(l_n), l_n as
//! computed, and theta in [0, 1] every term of W increases with alpha in (0, 1): the numerator does, since
//! d/d alpha (a + b l) >= dt_c^2 [alpha + theta (1 - 3 alpha^2)(1 + 2 x)/6] > 0 with x = l/l_n in [0, 1], and the
//! denominator decreases likewise. So C W reaches its first eigenvalue 1 once, and never again falls below.
//!
//! *Theorem.* For any mesh and any number of contacts with one factor a, the scheme is stable at dt < dt_c exactly when
//! l_max(C W(dt)) <= 1, growth of rigid motion in time apart: there is one limit, and no stable island above it below dt_c.
//!
//! *Proof.* Eliminated to displacements, a multiplier z that is not one of the contact-free scheme satisfies
//! det(C^-1 + V(z)) = 0 with V(z) = sum_i (Z'x_i)(Z'x_i)' P(l_i), P = N/D, and with B = b, A = 2 alpha,
//!
//! ```text
//! N = z (dt^2 + B (1 + alpha) l + w) - (B (1 - alpha) l + w)
//! D = (z - 1)^2 + z l (dt^2 + B (1 + alpha) l) - B (1 - alpha) l^2             V(-1) = -W
//! ```
//! Let z = exp(i phi), 0 < phi < pi, theta > 0, c = cos phi, s = sin phi > 0, h = 1 - exp(-i phi), |h|^2 = 2 (1 - c),
//! n = dt^2 + w h, q = 2 alpha + (1 - alpha) h. Then N/z = n + B l q, D/z = -|h|^2 + l dt^2 + B l^2 q, P(0) = -n/|h|^2.
//! First, Im(1/P(0)) = -|h|^2 Im(1/n) = |h|^2 w s/|n|^2 > 0. Second, Im(P(l)/P(0)) >= 0 for all l >= 0: it has the sign of
//! J = Im(conj(N/z) n D/z), and as Im(conj(q) n) = -s dt^2 (1 - alpha) e with e = 1 - theta (1 + alpha)/3 in [1/3, 1],
//!
//! ```text
//! J = B l (1 - alpha) s { l |n|^2 + B l^2 Re(conj(q) n) - e dt^2 [-2 (1 - c) + l dt^2 + B l^2 (2 alpha + (1 - alpha)(1 - c))] }
//! ```
//! which is not negative, since |n|^2 >= dt^4, Re(conj(q) n) >= dt^2 (2 alpha + (1 - alpha)(1 - c)) and e <= 1. (D has no
//! zero there: Im(D/z) = B l^2 (1 - alpha) s > 0 for l > 0.) So for every y != 0
//! Im[(y*C^-1 y + y*V(z) y)/P(0)] = Im(1/P(0)) y*C^-1 y + sum_i |(Z'x_i)'y|^2 Im(P(l_i)/P(0)) > 0, and z is no multiplier.
//! Now let C grow from 0 as tau C, tau from 0 to 1. For small tau the multipliers are inside but those of rigid motion:
//! where a contact sees it, z = 1 splits into |z|^2 = 1 - tau v w + O(tau^(3/2)) with v > 0; where none does, it stays. z = 1
//! is a multiplier of nothing else, as K x = 0 and Z'x = 0 follow. So a multiplier can leave only through -1, which takes
//! l_max(C W) = 1/tau. If l_max(C W) > 1, C^-1 + V(z) is indefinite at z = -1 and positive definite for z -> -inf, without
//! a pole between them: a real multiplier lies beyond -1. For theta = 0 the scheme is central differences with
//! K + Z C Z', whose limit is the same determinant. With a factor for each contact C is unsymmetric, and the theorem fails.
//!
//! Beyond dt_c the contact-free scheme itself is unstable until its multiplier -1 returns at 3/(2 theta) dt_c: for
//! theta = 1 a weak contact on few elements is stable again from 1.49 to 1.57 dt_c.
//!
//! For large s' the Park limit falls like 1/s' (theta > 0: W ~ w for small steps), faster than the 1/sqrt(s') of the others;
//! and every contact that moves the top mode costs step at every ratio, since W grows without bound at dt_c.

use super::fractions::{Fractions, coefficients};
use super::moments::Moments;
use crate::error::Refusal;
use crate::pencil::{Penalty, Pencil, Terms, Tridiagonal};
use crate::schemes::closed::{COMPLIANCE_ERROR, ClosedContacts};
use crate::spectrum::{
    Enclosure, Engine, Step, StepLimit, UNIT_ROUNDOFF, Uncertified, WIDEST_ENCLOSURE, certify,
    find_sign_change,
};

/// The limit of the Park scheme for a row of bars.
pub(super) struct ParkLimit<'a> {
    closed: ClosedContacts<'a>,
    theta: f64,
    moments: Moments,
}

impl<'a> ParkLimit<'a> {
    /// The limit for `pencil`, whose spectrum the engine knows.
    ///
    /// # Errors
    /// A pencil that is no chain, and a contact-free l_max that cannot be certified.
    pub fn new(pencil: &'a Pencil, spectrum: Box<dyn Engine + 'a>, theta: f64) -> Result<Self, Refusal> {
        let closed = ClosedContacts::new(pencil, spectrum, "park")?;
        let moments = Moments::new(closed.pencil, 4.0 / closed.contact_free.value);
        Ok(Self { closed, theta, moments })
    }
}

impl StepLimit for ParkLimit<'_> {
    fn name(&self) -> &'static str {
        "multiplier-minus-one"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Step, Uncertified> {
        self.closed.with_terms(penalty, |terms| self.of_terms(terms)).map(Step::proven)
    }

    /// `None` for a step beyond dt_c with a contact that moves the top mode.
    fn growth(&self, penalty: &Penalty, step: &Step, excess: f64) -> Option<f64> {
        let relative = excess * (self.closed.contact_free.value / step.l.value).sqrt();
        self.growth_at(&self.closed.pencil.terms(penalty), relative).map(f64::ln_1p)
    }

    /// The scheme meets a stiff contact with the displacement that velocities have made in a step, dt/dt_c of what they
    /// make in the modes of the bars.
    fn share(&self, step: &Step) -> f64 {
        (self.closed.contact_free.value / step.l.value).sqrt().min(1.0)
    }

    /// Only what does not act at all.
    fn costs_nothing(&self, penalty: &Penalty) -> bool {
        self.closed.contact_eigenvalue(&self.closed.pencil.terms(penalty)) == 0.0
    }

    /// 0: each ratio costs.
    fn expected_ratio(&self, beta_s: f64) -> Option<f64> {
        let stiffness = beta_s * self.closed.pencil.scales().first()?.stiffness;
        (stiffness > 0.0).then_some(0.0)
    }

    fn line(&self, l: f64) -> Option<(f64, f64)> {
        if self.closed.compliance.diagonal.len() != 1 || l < self.closed.contact_free.value {
            return None;
        }
        let w = self.effective_flexibility((self.closed.contact_free.value / l).sqrt())?;
        Some((w, self.closed.first_compliance()))
    }
}

/// Which way the errors of W are tilted.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Tilt {
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

impl ParkLimit<'_> {
    fn of_terms(&self, terms: &[Terms]) -> Result<Enclosure, Uncertified> {
        let free = self.closed.contact_free;
        if self.closed.contact_eigenvalue(terms) == 0.0 {
            return certify(free);
        }
        let alpha = self.alpha(terms);
        // Two signs with the error of W on the right side prove the value; the interval widens until they do.
        let mut spread = 4.0 * f64::EPSILON;
        while spread < WIDEST_ENCLOSURE {
            let (low, high) = (alpha * (1.0 - spread), (alpha * (1.0 + spread)).min(1.0));
            let stable = self.margin(terms, low, 0.0, Tilt::Pessimistic) > 0.0;
            let (l_low, l_high) = (free.value / (high * high), free.value / (low * low));
            if stable && (high == 1.0 || self.margin(terms, high, 0.0, Tilt::Optimistic) < 0.0) {
                let rounding = 4.0 * f64::EPSILON;
                // At dt_c the contact-free scheme itself ends, at the exact l_n.
                let lower = if high == 1.0 { free.lower } else { l_low * (1.0 - rounding) };
                let value = free.value / (alpha * alpha);
                return certify(Enclosure { value, lower, upper: l_high * (1.0 + rounding) });
            }
            spread *= 1.25;
        }
        Err(Uncertified { value: free.value / (alpha * alpha), width: f64::INFINITY })
    }

    /// The alpha in (0, 1] at which the margin changes sign.
    fn alpha(&self, terms: &[Terms]) -> f64 {
        let deficit = |alpha: f64| -self.margin(terms, alpha, 0.0, Tilt::None);
        let mut high = (1.0, deficit(1.0));
        if high.1 < 0.0 {
            return 1.0;
        }
        let mut low = (0.5, deficit(0.5));
        while low.1 >= 0.0 && low.0 > f64::MIN_POSITIVE {
            // W falls at least like alpha: the drop that this allows, twice over. Next to a pole W is so large that the
            // drop would leave f64 behind the root; a millionth at a time leads back.
            high = low;
            let drop = 0.5 * (1.0 - low.1) / (1.0 + low.1);
            let alpha = low.0 * drop.clamp(1e-6, 0.5);
            low = (alpha, deficit(alpha));
        }
        let (low, high) = find_sign_change(low, high, 2.0 * f64::EPSILON, deficit);
        low + 0.5 * (high - low)
    }

    /// |z| - 1 > 0 of the real multiplier beyond -1 at dt = `alpha` dt_c: the growth in a step just above the limit.
    /// 0 below the limit. Beyond dt_c that of the top mode, if no contact moves it.
    fn growth_at(&self, terms: &[Terms], alpha: f64) -> Option<f64> {
        let margin = |growth: f64| {
            if alpha > 1.0 {
                self.top_margin(alpha, growth)
            } else {
                self.margin(terms, alpha, growth, Tilt::None)
            }
        };
        let touched = self.closed.contact_eigenvalue(terms) > 0.0;
        if alpha > 1.0 && touched && self.alpha(terms) < 1.0 {
            return None;
        }
        if margin(0.0) >= 0.0 {
            return Some(0.0);
        }
        let (mut low, mut high) = (f64::EPSILON * f64::EPSILON, f64::EPSILON);
        while margin(high) < 0.0 && high < f64::MAX {
            (low, high) = (high, 4.0 * high);
        }
        let (low, high) =
            find_sign_change((low, margin(low)), (high, margin(high)), f64::EPSILON.sqrt(), margin);
        Some(low + 0.5 * (high - low))
    }

    /// c_0 - c_1 x - b x^2 of the contact-free top mode, x = 4.
    fn top_margin(&self, alpha: f64, growth: f64) -> f64 {
        let (_, [_, b, c0, c1]) = coefficients(self.theta, alpha, growth);
        c0 - 4.0 * c1 - 16.0 * b
    }

    /// W of the single contact at alpha, m/N.
    fn effective_flexibility(&self, alpha: f64) -> Option<f64> {
        let (gained, lost) = self.sides(Fractions::new(self.theta, alpha, 0.0), Tilt::None)?;
        Some(gained.diagonal[0] - lost.diagonal[0])
    }

    /// p F(above) and v F(below), m/N; `None` if the upper pole is not above the spectrum.
    fn sides(&self, fractions: Fractions, tilt: Tilt) -> Option<(Tridiagonal, Tridiagonal)> {
        let (free, sign) = (self.closed.contact_free, tilt.sign());
        let error = |l: f64| self.pole_error(l);
        if fractions.is_far() {
            // Twice the error on the diagonal stands for that beside it.
            let several = if self.closed.compliance.diagonal.len() > 1 { 2.0 } else { 1.0 };
            let mut gained = self.moments.series(fractions.coefficients, several * sign);
            let squared_step = 4.0 / free.value;
            gained.diagonal.iter_mut().chain(&mut gained.off_diagonal).for_each(|w| *w *= squared_step);
            let lost = Tridiagonal::zeros(gained.diagonal.len());
            return Some((gained, lost));
        }
        let upper = free.value * fractions.above;
        let mut gained = self.closed.flexibility.of(-1.0, upper * (1.0 - sign * error(upper)))?;
        let mut lost = Tridiagonal::zeros(gained.diagonal.len());
        let lower = free.value * fractions.below;
        if fractions.loss > 0.0 && lower.is_finite() {
            lost = self.closed.flexibility.of(1.0, lower * (1.0 + sign * error(lower)))?;
        }
        let scale = |side: &mut Tridiagonal, factor: f64| {
            side.diagonal.iter_mut().chain(&mut side.off_diagonal).for_each(|entry| *entry *= factor);
        };
        scale(&mut gained, fractions.gain);
        scale(&mut lost, fractions.loss);
        Some((gained, lost))
    }

    /// The last pivot of C^-1 - W over the sum of what it is made of, in [-1, 1]: positive while the multiplier
    /// -1 - `growth` lies beyond the spectrum; -1 if an earlier pivot is not positive. C^-1 = S^-1 + a G.
    ///
    /// C^-1 - W is a sum of positive semidefinite parts T = S^-1, a G, p F and -v F, each tridiagonal and put together bar
    /// by bar. If an entry of a part is off by e (T_ii T_jj)^(1/2), the part is off by no more than
    /// e (sum T_ii^(1/2) |y_i|)^2 <= 2 e sum T_ii y_i^2 at most, for the one or two contacts of a bar. So the errors of
    /// the entries beside the diagonal are borne by the diagonal, and its last pivot proves a sign.
    fn margin(&self, terms: &[Terms], alpha: f64, growth: f64, tilt: Tilt) -> f64 {
        let fractions = Fractions::new(self.theta, alpha, growth);
        let Some((gained, lost)) = self.sides(fractions, tilt) else { return -1.0 };
        let sign = tilt.sign();
        let (entries, upper, lower) = self.relative_errors(fractions);
        let factor = terms.iter().map(|p| p.mass / p.stiffness).fold(0.0, f64::max);
        let (own, beside) = (&self.closed.compliance.diagonal, &self.closed.compliance.off_diagonal);
        let (mut carried, mut margin) = (0.0, -1.0);
        for (j, p) in terms.iter().enumerate() {
            let inverse = 1.0 / p.stiffness + factor * own[j];
            let error = entries * inverse + upper * gained.diagonal[j] + lower * lost.diagonal[j];
            let pivot = inverse - gained.diagonal[j] + lost.diagonal[j] - sign * error - carried;
            margin = pivot / (inverse + gained.diagonal[j] + lost.diagonal[j] + carried);
            if j + 1 == terms.len() {
                break;
            }
            if pivot.is_nan() || pivot <= 0.0 {
                return -1.0;
            }
            let off = factor * beside[j] - gained.off_diagonal[j] + lost.off_diagonal[j];
            carried = off * (off / pivot);
        }
        margin
    }

    /// Errors of the diagonal that stand for those of S^-1 + a G, of p F(above) and of v F(below), relative.
    ///
    /// The fractions take fewer than 16 roundings, mu as many as it has and 4 more, the pivots of the margin fewer than 8.
    /// The entries of a bar between two contacts come of two eliminations, each exact for a matrix that differs by e, in
    /// units of l M ([`Self::pole_error`]): beside the shift of the pole, F(above) may be off by e l/(l - l_n) twice over,
    /// and F(below), where K + l M >= l M, by e twice over.
    fn relative_errors(&self, fractions: Fractions) -> (f64, f64, f64) {
        let coupled = self.closed.compliance.diagonal.len() > 1;
        let entries = COMPLIANCE_ERROR + 20.0 * UNIT_ROUNDOFF;
        if !coupled {
            return (entries, entries, entries);
        }
        let entries = 2.0 * entries + 8.0 * UNIT_ROUNDOFF;
        if fractions.is_far() {
            return (entries, entries, entries);
        }
        let free = self.closed.contact_free;
        let (above, below) = (free.value * fractions.above, free.value * fractions.below);
        let distance = (above - free.upper) / above;
        let mixed = 2.0 * self.pole_error(above) / distance;
        (entries, entries + mixed, entries + 2.0 * self.pole_error(below))
    }

    /// Relative error of a pole l: the elimination moves it by 8 unit roundoffs of 3 l + B, as |M| <= 3 M, the pole takes 8
    /// more.
    fn pole_error(&self, l: f64) -> f64 {
        8.0 * UNIT_ROUNDOFF * (4.0 + self.closed.pencil.pencil().bounds().stiffness / l)
    }
}
