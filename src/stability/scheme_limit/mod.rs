//! How large a step the predictor-corrector and the Park scheme stand while every contact is closed.
//!
//! Both see the contact only through the stiffness that its mass leaves, s' = s/(1 + m mu) with mu = Z'M^-1 Z: the
//! contact acts as M^-1 Z C Z', C = (S^-1 + a G)^-1 with G = Z'M^-1 Z, S diagonal (one entry a contact) and one factor
//! a = m/s = 1/(r omega_e^2) for the scene, so that C is symmetric and positive definite. Since
//! 1/s' = 1/s + mu/(r omega_e^2), a map over (beta_s, r) is one function of s' alone. The limit is the largest step up
//! to which no multiplier of the amplification matrix leaves the unit circle. Like a spectrum's it is given as
//! l = 4/dt^2, so that dt = 2/sqrt(l).
//!
//! # Predictor-corrector
//! The displacements obey
//!
//! ```text
//! (M + Z k Z') u_{n+1} - 2 M u_n + M u_{n-1} + dt^2 K u_n = 0      k = dt^2 (C^-1 - dt^2 G)^-1
//! ```
//! *Sufficient.* Let k >= 0 and x be a mode with the multiplier z. Then (m + c) z^2 - (2 m - dt^2 e) z + m = 0 with the
//! numbers m = x*Mx > 0, c = x*Z k Z'x >= 0, e = x*Kx >= 0. Its coefficients are real, and both its roots lie in the
//! closed unit disc exactly when m <= m + c and dt^2 e <= 4 m + c. So the scheme is stable as long as
//!
//! ```text
//! dt^2 lambda_max(C G) < 1  (k >= 0)      and      dt^2 K <= 4 M + Z k Z'
//! ```
//! the second of which holds whenever dt <= 2/sqrt(l_max(K, M)).
//!
//! *Necessary.* If the second inequality fails, the symmetric matrix of the quadratic has a negative eigenvalue at
//! z = -1 and none for z -> -inf: a real multiplier lies beyond -1. If k < 0 (contacts alike, so that k is a number),
//! each mode with a complex multiplier and Z'x != 0 has |z|^2 = m/(m + c) > 1. That such a mode exists needs a node that
//! no contact holds; single masses on contacts stand more, dt^2 s' mu = 4/3 at rest, and are refused here. Contacts that are not alike damp
//! each other's unstable modes: dt^2 lambda_max(C G) <= 1 is then sufficient, but the limit lies above it, by up to 24 % of the
//! step in some 160 random scenes of two and three bars, where complex multipliers cross the circle at an angle that no
//! formula gives. They are refused, rather than given a bound in the name of a limit.
//!
//! So one contact limits the step to dt^2 s' mu = 1,
//!
//! ```text
//! dt^2 = m/s + 1/(s mu) = 1/(r omega_e^2) + 1/(s mu)       (lumped bar on a wall: C^2 = 1/(4 r) + 1/(2 beta_s))
//! ```
//! *The ratio 1/4.* The step is at least 2/omega_e for every beta_s exactly when 1/(r omega_e^2) >= 4/omega_e^2, that
//! is r <= 1/4, for any mass matrix, mesh and material. For one beta_s, r may rise to
//! l_n/(4 omega_e^2) / (1 - l_n/(4 s mu)), with l_n the contact-free l_max; any r will do when 4 s mu <= l_n.
//!
//! *Beyond the contact-free step.* When 4 s' mu < l_n the closed contact slows the top mode down (z = -1 has 4 M + Z k Z'
//! for M), and the limit, which is what is reported, may exceed 2/sqrt(l_n). In a run the contact opens, and then
//! 2/sqrt(l_n) binds all the same. In l the condition reads l M - K + t(l) Z Z' >= 0 with t = s' l/(l - 4 s' mu), which is
//! convex: over an interval t lies above its tangent, and a matrix affine in l is definite between two points at
//! which it is. So intervals without a loss of stability are excluded by two signs each, from l_n downwards.
//!
//! *Islands.* For dt^2 s' mu -> 1 k grows without bound and may hold the top mode again: beyond a first loss the scheme
//! can be stable once more, up to dt^2 s' mu = 1 ([`SchemeLimit::islands`]). One lumped element on a wall with beta_s = 0.28
//! and r = inf is stable to 1.098 contact-free steps, and again from 1.300 to 1.336. All islands lie between the
//! contact-free step and dt^2 s' mu = 1. Below the former there is no loss; above the latter k < 0, and one contact leaves
//! no stable step: on the unit circle z = exp(i phi) the characteristic function F = 1 + k z Z'(dt^2 K - L M)^-1 Z,
//! L = 2 - 2 cos(phi), is real only at F = 1, at z = 1 and at z = -1. With p modes below L = 4 and o beyond it that move
//! the gap the argument of F turns between neighbouring poles by their distance less pi, and of the 2(p + o)
//! multipliers at most o + 2 (for p = 0, o + 1) lie inside: p + o >= 2 leaves one outside at least. Contacts that are
//! alike have been looked at only (`tests/scheme_limits.rs`).
//!
//! dt^2 s' mu = 1 is at once the choice that takes the predicted penetration out within the step, the
//! zero-penetration contact of Kwon, Kim, Cho, Gonzalez (Int. J. Numer. Meth. Eng. 2025, doi 10.1002/nme.70119). Ratios of
//! bi-penalties for the spectrum were derived by Hetherington, Rodriguez-Ferran, Askes (2012, 2013).
//!
//! # Park
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
//!
//! # Not offered
//! The diagonalised mass penalty of a pair: (M + M_p)^-1 Z is then no multiple of M^-1 Z, and s' loses its meaning.

mod growth;
mod moments;
mod park;
mod predictor_corrector;

use crate::error::Refusal;
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::pencil::{ChainPencil, Penalty, PenaltyMass, Pencil, Scale, Terms};
use crate::schemes::SchemeName as Scheme;
use crate::spectrum::{Enclosure, Engine, Flexibility, Step, StepLimit, UNIT_ROUNDOFF, Uncertified, certify};

/// The limit of the predictor-corrector or the Park scheme with closed contacts, as l = 4/dt^2.
pub struct SchemeLimit<'a> {
    scheme: Scheme,
    theta: f64,
    pencil: ChainPencil<'a>,
    flexibility: Flexibility<'a>,
    /// G = Z'M^-1 Z, diagonal and beside it, 1/kg.
    compliance: crate::pencil::Tridiagonal,
    spectrum: Box<dyn Engine + 'a>,
    contact_free: Enclosure,
    /// Of the Park scheme.
    moments: Option<moments::Moments>,
}

/// Relative error of a computed z'M^-1 z: the entries of M move by 8 unit roundoffs, and no vector sees the sum of
/// their absolute values more than 3 times as large as M itself.
const COMPLIANCE_ERROR: f64 = 32.0 * UNIT_ROUNDOFF;

impl<'a> SchemeLimit<'a> {
    /// The limit of `scheme` (averaging `theta` for Park) for `pencil`, whose spectrum the engine knows.
    ///
    /// # Errors
    /// A pencil that is no chain; for the predictor-corrector contacts that are not alike, bodies of a single node and
    /// contact at every node; a contact-free l_max that cannot be certified.
    pub fn new(
        pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
        scheme: Scheme,
        theta: f64,
    ) -> Result<Self, Refusal> {
        let no_chain = || Refusal::new("limit", scheme.name(), "a row of bars");
        let chain = pencil.chain().ok_or_else(no_chain)?;
        let uncertified = |e| Refusal::new("limit", e, "scenes whose contact-free limit is certified");
        let contact_free = spectrum.enclose(&Penalty::NONE, None).map_err(uncertified)?;
        let flexibility = Flexibility::new(chain);
        let compliance = flexibility.of(0.0, 1.0).unwrap_or_default();
        let moments =
            (scheme == Scheme::Park).then(|| moments::Moments::new(chain, 4.0 / contact_free.value));
        let limit =
            Self { moments, scheme, theta, pencil: chain, flexibility, compliance, spectrum, contact_free };
        limit.check()?;
        Ok(limit)
    }

    /// Refuses what the limits are not derived for.
    fn check(&self) -> Result<(), Refusal> {
        let refuse = |value: &str, allowed: &str| Err(Refusal::new("limit", value, allowed));
        if self.spectrum.condensed().is_none() {
            return refuse(self.spectrum.name(), "an engine of bars");
        }
        if self.scheme == Scheme::PredictorCorrector {
            if self.flexibility.has_single_nodes_only() {
                let value = format!("{} with contact between single nodes", self.scheme.name());
                return refuse(&value, "bodies with at least two moving nodes");
            }
            if self.pencil.size() <= self.pencil.gaps().len() {
                let value = format!("{} with contact at every node", self.scheme.name());
                return refuse(&value, "bodies with a node that no contact holds");
            }
            if !self.contacts_are_alike() {
                let value = format!("{} with unlike contacts", self.scheme.name());
                let allowed =
                    "one contact, or contacts of equal stiffness and nodal mass that no bar couples";
                return refuse(&value, allowed);
            }
        }
        Ok(())
    }

    /// Whether C G is a multiple of the identity, to the rounding of its entries.
    fn contacts_are_alike(&self) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= 2.0 * COMPLIANCE_ERROR * a.abs().max(b.abs());
        let (own, beside) = (&self.compliance.diagonal, &self.compliance.off_diagonal);
        let uncoupled = beside.iter().all(|g| g.abs() <= UNIT_ROUNDOFF * own[0]);
        let scales = self.pencil.scales().windows(2).all(|pair| close(pair[0].stiffness, pair[1].stiffness));
        uncoupled && scales && own.windows(2).all(|pair| close(pair[0], pair[1]))
    }

    /// The scheme.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// The contact-free l_max; Park's dt_c is 2/sqrt of it.
    pub fn contact_free(&self) -> Enclosure {
        self.contact_free
    }

    /// 4 s' mu, rad^2/s^2, the largest over the contacts: the l at which dt^2 s' mu = 1.
    fn contact_eigenvalue(&self, terms: &[Terms]) -> f64 {
        let own = self.compliance.diagonal.iter().zip(terms);
        own.map(|(mu, p)| {
            if p.stiffness == 0.0 { 0.0 } else { 4.0 / (1.0 / (p.stiffness * mu) + p.mass / p.stiffness) }
        })
        .fold(0.0, f64::max)
    }

    /// Whether the closed contacts are proven to cost no step against the contact-free scene.
    pub fn costs_nothing(&self, penalty: &Penalty) -> bool {
        let q = self.contact_eigenvalue(&self.pencil.terms(penalty)) * (1.0 + 2.0 * COMPLIANCE_ERROR);
        q == 0.0 || (self.scheme == Scheme::PredictorCorrector && q <= self.contact_free.lower)
    }

    /// The largest ratio that costs no step at beta_s, as the theory has it; `None` if none costs any.
    /// Predictor-corrector: 1/r = omega_e^2 (4/l_n - 1/(s mu)); Park: 0, each ratio costs.
    pub fn expected_ratio(&self, beta_s: StiffnessPenalty) -> Option<f64> {
        let (scale, mu) = (self.pencil.scales().first()?, self.compliance.diagonal[0]);
        let stiffness = beta_s.get() * scale.stiffness;
        if self.scheme == Scheme::Park {
            return (stiffness > 0.0).then_some(0.0);
        }
        let left = 4.0 / self.contact_free.value - 1.0 / (stiffness * mu);
        (left > 0.0).then(|| 1.0 / (self.pencil.pencil().reference() * left))
    }

    /// The ratio with which dt^2 s' mu = 1 at dt = `relative_courant` times the contact-free step: the contact of
    /// zero penetration (Kwon et al. 2025), 1/r = omega_e^2 (dt^2 - 1/(s mu)). The predictor-corrector is then run on
    /// the verge of its limit.
    ///
    /// # Errors
    /// Refuses a step outside (0, 1], unlike contacts, and a beta_s so small that not even a pure penalty reaches
    /// dt^2 s' mu = 1: beta_s EA/h <= 1/(mu dt^2).
    pub fn plastic_ratio(&self, beta_s: StiffnessPenalty, relative_courant: f64) -> Result<Ratio, Refusal> {
        if !(relative_courant > 0.0 && relative_courant <= 1.0) {
            return Err(Refusal::new("relative Courant number", relative_courant, "a number in (0, 1]"));
        }
        let Some(scale) = self.pencil.scales().first().filter(|_| self.contacts_are_alike()) else {
            return Err(Refusal::new("ratio", "plastic", "a scene whose contacts are alike"));
        };
        let mu = self.compliance.diagonal[0];
        let squared_step = 4.0 * relative_courant * relative_courant / self.contact_free.value;
        let left = squared_step - 1.0 / (beta_s.get() * scale.stiffness * mu);
        if left <= COMPLIANCE_ERROR * squared_step {
            let least = 1.0 / (mu * squared_step * scale.stiffness);
            let value = format!("plastic with beta_s = {:e}", beta_s.get());
            return Err(Refusal::new("ratio", value, format!("beta_s above {least:e} at this step")));
        }
        Ratio::new(1.0 / (self.pencil.pencil().reference() * left))
    }

    /// The points (beta_s, r) whose limit is l satisfy 1/(beta_s k_e) + mu/(r omega_e^2) = W: this W, m/N, for a scene
    /// with one contact and l at least the contact-free l_max.
    pub fn effective_flexibility(&self, l: f64) -> Option<f64> {
        if self.compliance.diagonal.len() != 1 || l < self.contact_free.value {
            return None;
        }
        match self.scheme {
            Scheme::Park => self.park_flexibility((self.contact_free.value / l).sqrt()),
            _ => Some(4.0 * self.compliance.diagonal[0] / l),
        }
    }

    /// mu of the first contact, 1/kg.
    pub fn compliance(&self) -> f64 {
        self.compliance.diagonal.first().copied().unwrap_or(0.0)
    }
}

impl SchemeLimit<'_> {
    fn of_terms(&self, terms: &[Terms]) -> Result<Enclosure, Uncertified> {
        if self.contact_eigenvalue(terms) == 0.0 {
            return certify(self.contact_free);
        }
        match self.scheme {
            Scheme::Park => self.enclose_park(terms),
            _ => self.enclose_predictor_corrector(terms),
        }
    }
}

impl StepLimit for SchemeLimit<'_> {
    fn name(&self) -> &'static str {
        match self.scheme {
            Scheme::Park => "multiplier-minus-one",
            _ => "closed-form",
        }
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Step, Uncertified> {
        let spread = |scale: &Scale| penalty.form == PenaltyMass::Diagonalised && scale.pair;
        if self.pencil.scales().iter().any(spread) {
            return Err(Uncertified { value: f64::NAN, width: f64::INFINITY });
        }
        penalty.with_terms(self.pencil.scales(), |terms| self.of_terms(terms)).map(Step::proven)
    }

    fn growth(&self, penalty: &Penalty, step: &Step, excess: f64) -> Option<f64> {
        let relative = excess * (self.contact_free.value / step.l.value).sqrt();
        self.growth_at(penalty, relative).map(f64::ln_1p)
    }

    fn islands(&self, penalty: &Penalty) -> Vec<(f64, f64)> {
        self.islands_of(&self.pencil.terms(penalty))
    }

    /// The Park scheme meets a stiff contact with the displacement that velocities have made in a step, dt/dt_c of what
    /// they make in the modes of the bars.
    fn share(&self, step: &Step) -> f64 {
        match self.scheme {
            Scheme::Park => (self.contact_free.value / step.l.value).sqrt().min(1.0),
            Scheme::CentralDifference | Scheme::PredictorCorrector => 1.0,
        }
    }
}
