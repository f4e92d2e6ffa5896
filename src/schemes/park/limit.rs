//! The limit of the Park scheme with closed contacts, as l = 4/dt^2.
//!
//! At z = -1 with alpha = dt/dt_c, w = theta dt_c^2 alpha (1 - alpha^2)/6, b = w dt_c^2/2, a = dt^2/2 + w the scheme leaves
//! (2 M - dt^2/2 K - b K M^-1 K) u = (a + b K M^-1) Z C Z' u, so that
//!
//! ```text
//! det(I - C W) = 0      W(dt) = sum_i (Z'x_i)(Z'x_i)' (a + b l_i)/(2 - dt^2 l_i/2 - b l_i^2)
//! ```
//! The denominator has one root above l_n and one below 0; the partial fractions express W by Z'(K - l M)^-1 Z at the
//! two, an elimination of the rows each ([`Flexibility`](crate::spectrum::Flexibility)). For small steps the two cancel:
//! f64 finds the root, and two signs in double-double arithmetic prove it. With dt_c = 2/sqrt(l_n), l_n as
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

use super::fractions::coefficients;
use super::sign::{Sign, Tilt};
use crate::double_double::{Dd, Real};
use crate::error::Refusal;
use crate::pencil::{Penalty, Pencil};
use crate::schemes::closed::ClosedContacts;
use crate::spectrum::{Enclosure, Engine, Step, StepLimit, Uncertified, certify, find_sign_change};

/// Half the width of the enclosure of alpha, relative: what a root found in f64 is off by where nothing cancels.
const SPREAD: f64 = 16.0 * f64::EPSILON;

/// Products of alpha^4 are held in double-double arithmetic.
const SMALLEST: f64 = 1e-50;

/// The limit of the Park scheme for a row of bars.
pub(super) struct ParkLimit<'a> {
    closed: ClosedContacts<'a>,
    theta: f64,
    /// Finds.
    sign: Option<Sign<f64>>,
    /// Proves.
    proof: Option<Sign<Dd>>,
}

impl<'a> ParkLimit<'a> {
    /// The limit for `pencil`, whose spectrum the engine knows.
    ///
    /// # Errors
    /// A pencil that is no chain, and a contact-free l_max that cannot be certified.
    pub fn new(pencil: &'a Pencil, spectrum: Box<dyn Engine + 'a>, theta: f64) -> Result<Self, Refusal> {
        let closed = ClosedContacts::new(pencil, spectrum, "park")?;
        let (sign, proof) = (Sign::new(&closed, theta), Sign::new(&closed, theta));
        Ok(Self { closed, theta, sign, proof })
    }
}

impl StepLimit for ParkLimit<'_> {
    fn name(&self) -> &'static str {
        "multiplier-minus-one"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Step, Uncertified> {
        self.closed.with_terms(penalty, |_| self.of_penalty(penalty)).map(Step::proven)
    }

    /// `None` for a step beyond dt_c with a contact that moves the top mode.
    fn growth(&self, penalty: &Penalty, step: &Step, excess: f64) -> Option<f64> {
        let relative = excess * (self.closed.contact_free.value / step.l.value).sqrt();
        self.growth_at(penalty, relative).map(f64::ln_1p)
    }

    /// The scheme meets a stiff contact with the displacement that velocities have made in a step, dt/dt_c of what they
    /// make in the modes of the bars.
    fn share(&self, step: &Step) -> f64 {
        (self.closed.contact_free.value / step.l.value).sqrt().min(1.0)
    }

    /// Only what does not act at all.
    fn costs_nothing(&self, penalty: &Penalty) -> bool {
        !self.acts(penalty)
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
        let alpha = (self.closed.contact_free.value / l).sqrt();
        let w = self.proof.as_ref()?.effective_flexibility(&self.closed, alpha)?;
        Some((w, self.closed.first_compliance()))
    }
}

impl ParkLimit<'_> {
    fn acts(&self, penalty: &Penalty) -> bool {
        self.closed.contact_eigenvalue(&self.closed.pencil.terms(penalty)) > 0.0
    }

    fn of_penalty(&self, penalty: &Penalty) -> Result<Enclosure, Uncertified> {
        let free = self.closed.contact_free;
        if !self.acts(penalty) {
            return certify(free);
        }
        let unheld = || Uncertified { value: f64::NAN, width: f64::INFINITY };
        let (sign, proof) = self.sign.as_ref().zip(self.proof.as_ref()).ok_or_else(unheld)?;
        let found = self.alpha(sign, penalty);
        self.prove(proof, penalty, found).or_else(|_| {
            // Where the fractions cancel f64 has lost digits.
            self.prove(proof, penalty, self.near(proof, penalty, found))
        })
    }

    /// The enclosure of the root `alpha`, if the signs on either side are proven.
    fn prove(&self, proof: &Sign<Dd>, penalty: &Penalty, alpha: f64) -> Result<Enclosure, Uncertified> {
        let free = self.closed.contact_free;
        let (low, high) = (alpha * (1.0 - SPREAD), (alpha * (1.0 + SPREAD)).min(1.0));
        let margin = |alpha: f64, tilt: Tilt| proof.margin(&self.closed, penalty, alpha, 0.0, tilt);
        let value = free.value / (alpha * alpha);
        let holds = low > SMALLEST
            && margin(low, Tilt::Pessimistic) > 0.0
            && (high == 1.0 || margin(high, Tilt::Optimistic) < 0.0);
        if !holds {
            return Err(Uncertified { value, width: f64::INFINITY });
        }
        let rounding = 4.0 * f64::EPSILON;
        // At dt_c the contact-free scheme itself ends, at the exact l_n.
        let lower = if high == 1.0 { free.lower } else { free.value / (high * high) * (1.0 - rounding) };
        certify(Enclosure { value, lower, upper: free.value / (low * low) * (1.0 + rounding) })
    }

    /// The alpha in (0, 1] at which the margin changes sign.
    fn alpha<T: Real>(&self, sign: &Sign<T>, penalty: &Penalty) -> f64 {
        let deficit = |alpha: f64| -sign.margin(&self.closed, penalty, alpha, 0.0, Tilt::None);
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

    /// The same next to `found`.
    fn near<T: Real>(&self, sign: &Sign<T>, penalty: &Penalty, found: f64) -> f64 {
        let deficit = |alpha: f64| -sign.margin(&self.closed, penalty, alpha, 0.0, Tilt::None);
        let at = |alpha: f64| (alpha, deficit(alpha));
        let (mut low, mut high) = (at(found), at(found));
        let mut distance = SPREAD;
        while low.1 >= 0.0 && low.0 > SMALLEST {
            (low, high) = (at(low.0 * (1.0 - distance)), low);
            distance = (8.0 * distance).min(0.5);
        }
        distance = SPREAD;
        while high.1 < 0.0 && high.0 < 1.0 {
            (low, high) = (high, at((high.0 * (1.0 + distance)).min(1.0)));
            distance *= 8.0;
        }
        if high.1 < 0.0 {
            return 1.0;
        }
        let (low, high) = find_sign_change(low, high, 2.0 * f64::EPSILON, deficit);
        low + 0.5 * (high - low)
    }

    /// |z| - 1 > 0 of the real multiplier beyond -1 at dt = `alpha` dt_c: the growth in a step just above the limit.
    /// 0 below the limit. Beyond dt_c that of the top mode, if no contact moves it.
    fn growth_at(&self, penalty: &Penalty, alpha: f64) -> Option<f64> {
        let (sign, proof) = (self.sign.as_ref()?, self.proof.as_ref()?);
        let margin = |growth: f64| {
            if alpha > 1.0 {
                self.top_margin(alpha, growth)
            } else {
                proof.margin(&self.closed, penalty, alpha, growth, Tilt::None)
            }
        };
        if alpha > 1.0 && self.acts(penalty) && self.alpha(sign, penalty) < 1.0 {
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
        let (_, [_, b, c0, c1]) = coefficients::<f64>(self.theta, alpha, growth);
        c0 - 4.0 * c1 - 16.0 * b
    }
}
