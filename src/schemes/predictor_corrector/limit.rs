//! The limit of the predictor-corrector with closed contacts, as l = 4/dt^2.
//!
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
//! the second of which holds whenever dt <= 2/sqrt(l_max(K, M)). With one factor a for the scene C^-1 = S^-1 + a G, and
//! the first is one number for any contacts, mesh and mass matrix:
//!
//! ```text
//! dt^2 < a + 1/l_max(S G) = 1/(r omega_e^2) + 1/(beta_s l_max(P, M))      P = sum_j w_j z_j z_j', s_j = beta_s w_j
//! ```
//! At equality k is infinite on a subspace, where the contact closes with zero gap; multipliers are continuous, so that
//! the step itself is stable too. l_max(S G) is no less than s_j mu_j of any contact, and more where a bar couples
//! contacts: dt^2 s'_j mu_j <= 1 contact by contact is not enough. Two consistent elements in a row on a wall grow at the
//! largest such step, which is 1.22 times too large (`tests/scheme_limits/coupled.rs`).
//!
//! *Necessary.* If the second inequality fails, the symmetric matrix of the quadratic has a negative eigenvalue at
//! z = -1 and none for z -> -inf: a real multiplier lies beyond -1. If k < 0 (contacts alike, so that k is a number),
//! each mode with a complex multiplier and Z'x != 0 has |z|^2 = m/(m + c) > 1. That such a mode exists needs a node that
//! no contact holds; single masses on contacts stand more, dt^2 s' mu = 4/3 at rest. Contacts that are not alike damp
//! each other's unstable modes: dt^2 lambda_max(C G) <= 1 is then sufficient only, and the limit lies above it, by up to 24 % of
//! the step in some 160 random scenes of two and three bars, where complex multipliers cross the circle at an angle that no
//! formula gives. For these, for single masses and for contact at every node the scheme gives the step of the sufficient
//! half, min(dt_c, (a + 1/l_max(S G))^1/2), as what it is: a lower bound
//! ([`Evidence::LowerBound`](crate::spectrum::Evidence::LowerBound)), with an upper one from the product of all multipliers,
//! det(I - dt^2 C G).
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
//! can be stable once more, up to dt^2 s' mu = 1 ([`StepLimit::islands`]). One lumped element on a wall with beta_s = 0.28
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

use super::definite::{Definite, RESOLUTION};
use crate::error::Refusal;
use crate::pencil::{Penalty, Pencil, Terms};
use crate::schemes::closed::{COMPLIANCE_ERROR, ClosedContacts};
use crate::spectrum::{Enclosure, Engine, Step, StepLimit, UNIT_ROUNDOFF, Uncertified, certify};

/// The limit of the predictor-corrector for a row of bars.
pub struct ClosedLimit<'a> {
    pub(super) closed: ClosedContacts<'a>,
}

impl<'a> ClosedLimit<'a> {
    /// The limit for `pencil`, whose spectrum the engine knows.
    ///
    /// # Errors
    /// A pencil that is no chain, contacts that are not alike, bodies of a single node and contact at every node; a
    /// contact-free l_max that cannot be certified.
    pub fn new(pencil: &'a Pencil, spectrum: Box<dyn Engine + 'a>) -> Result<Self, Refusal> {
        let closed = ClosedContacts::new(pencil, spectrum, "predictor-corrector")?;
        Self::check(&closed)?;
        Ok(Self { closed })
    }

    /// Refuses contacts of which only a lower bound of the limit is known.
    pub(super) fn check(closed: &ClosedContacts) -> Result<(), Refusal> {
        let refuse = |what: &str, allowed: &str| {
            Err(Refusal::new("limit", format!("predictor-corrector with {what}"), allowed))
        };
        let ClosedContacts { pencil, flexibility, .. } = closed;
        if flexibility.has_single_nodes_only() {
            return refuse("contact between single nodes", "bodies with at least two moving nodes");
        }
        if pencil.size() <= pencil.gaps().len() {
            return refuse("contact at every node", "bodies with a node that no contact holds");
        }
        if !contacts_are_alike(closed) {
            let allowed = "one contact, or contacts of equal stiffness and nodal mass that no bar couples";
            return refuse("unlike contacts", allowed);
        }
        Ok(())
    }

    /// The ratio with which dt^2 s' mu = 1 at dt = `relative_courant` times the contact-free step: the contact of
    /// zero penetration (Kwon et al. 2025), 1/r = omega^2 (dt^2 - 1/(s mu)). The scheme is then run on the verge of its
    /// limit.
    ///
    /// # Errors
    /// Refuses a step outside (0, 1], a scene without contact, and a beta_s so small that not even a pure penalty reaches
    /// dt^2 s' mu = 1: beta_s EA/h <= 1/(mu dt^2).
    pub fn plastic_ratio(&self, beta_s: f64, relative_courant: f64) -> Result<f64, Refusal> {
        if !(relative_courant > 0.0 && relative_courant <= 1.0) {
            return Err(Refusal::new("relative Courant number", relative_courant, "a number in (0, 1]"));
        }
        let Some(scale) = self.closed.pencil.scales().first() else {
            return Err(Refusal::new("ratio", "plastic", "a scene with a contact"));
        };
        let mu = self.closed.first_compliance();
        let squared_step = 4.0 * relative_courant * relative_courant / self.closed.contact_free.value;
        let left = squared_step - 1.0 / (beta_s * scale.stiffness * mu);
        if left <= COMPLIANCE_ERROR * squared_step {
            let least = 1.0 / (mu * squared_step * scale.stiffness);
            let value = format!("plastic with beta_s = {beta_s:e}");
            return Err(Refusal::new("ratio", value, format!("beta_s above {least:e} at this step")));
        }
        Ok(1.0 / (self.closed.pencil.pencil().reference() * left))
    }

    fn of_terms(&self, terms: &[Terms]) -> Result<Enclosure, Uncertified> {
        let (q, free) = (self.closed.contact_eigenvalue(terms), self.closed.contact_free);
        if q == 0.0 {
            return certify(free);
        }
        // 4 s' mu takes 5 roundings beside those of mu.
        let kappa = COMPLIANCE_ERROR + 6.0 * UNIT_ROUNDOFF;
        let explicit = Enclosure { value: q, lower: q * (1.0 - kappa), upper: q * (1.0 + kappa) };
        if explicit.lower >= free.upper {
            return certify(explicit);
        }
        if q >= free.lower {
            return certify(Enclosure {
                value: q.max(free.value),
                lower: explicit.lower.min(free.lower),
                upper: explicit.upper.max(free.upper),
            });
        }
        let definite = self.definite(q);
        match definite.last_loss(q, free.upper, 0) {
            None => certify(explicit),
            Some((low, high)) => definite.prove(low, high, explicit.lower),
        }
    }

    pub(super) fn definite(&self, q: f64) -> Definite<'_> {
        Definite { closed: &self.closed, q, mu: self.closed.first_compliance() }
    }
}

/// Whether C G is a multiple of the identity, to the rounding of its entries.
fn contacts_are_alike(closed: &ClosedContacts) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() <= 2.0 * COMPLIANCE_ERROR * a.abs().max(b.abs());
    let ClosedContacts { compliance, pencil, .. } = closed;
    let (own, beside) = (&compliance.diagonal, &compliance.off_diagonal);
    let uncoupled = beside.iter().all(|g| g.abs() <= UNIT_ROUNDOFF * own[0]);
    let scales = pencil.scales().windows(2).all(|pair| close(pair[0].stiffness, pair[1].stiffness));
    uncoupled && scales && own.windows(2).all(|pair| close(pair[0], pair[1]))
}

impl StepLimit for ClosedLimit<'_> {
    fn name(&self) -> &'static str {
        "closed-form"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Step, Uncertified> {
        self.closed.with_terms(penalty, |terms| self.of_terms(terms)).map(Step::proven)
    }

    fn growth(&self, penalty: &Penalty, step: &Step, excess: f64) -> Option<f64> {
        let relative = excess * (self.closed.contact_free.value / step.l.value).sqrt();
        self.growth_at(&self.closed.pencil.terms(penalty), relative).map(f64::ln_1p)
    }

    /// Each proven from end to end and as wide as it can be to 1e-9. They lie between the contact-free step and
    /// dt^2 s' mu = 1, where the contact of growing effective stiffness k = dt^2 s'/(1 - dt^2 s' mu) holds the top mode.
    /// When the contact opens they are no more.
    fn islands(&self, penalty: &Penalty) -> Vec<(f64, f64)> {
        let terms = self.closed.pencil.terms(penalty);
        let q = self.closed.contact_eigenvalue(&terms);
        let Ok(limit) = self.of_terms(&terms) else { return Vec::new() };
        if q == 0.0 || limit.lower >= self.closed.contact_free.lower {
            return Vec::new();
        }
        let mut found = Vec::new();
        self.definite(q).stable_within(q * (1.0 + RESOLUTION), limit.lower, &mut found);
        found.iter().map(|(low, high)| (*high, *low)).collect()
    }

    fn costs_nothing(&self, penalty: &Penalty) -> bool {
        let q = self.closed.contact_eigenvalue(&self.closed.pencil.terms(penalty));
        q * (1.0 + 2.0 * COMPLIANCE_ERROR) <= self.closed.contact_free.lower
    }

    /// 1/r = omega^2 (4/l_n - 1/(s mu)).
    fn expected_ratio(&self, beta_s: f64) -> Option<f64> {
        let stiffness = beta_s * self.closed.pencil.scales().first()?.stiffness;
        let left = 4.0 / self.closed.contact_free.value - 1.0 / (stiffness * self.closed.first_compliance());
        (left > 0.0).then(|| 1.0 / (self.closed.pencil.pencil().reference() * left))
    }

    fn line(&self, l: f64) -> Option<(f64, f64)> {
        let mu = self.closed.first_compliance();
        let alone = self.closed.compliance.diagonal.len() == 1 && l >= self.closed.contact_free.value;
        alone.then_some((4.0 * mu / l, mu))
    }
}
