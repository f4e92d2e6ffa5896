//! What the limits of the predictor-corrector and the Park scheme share: closed contacts of a row of bars.
//!
//! Both see the contact only through the stiffness that its mass leaves, s' = s/(1 + m mu) with mu = Z'M^-1 Z: the
//! contact acts as M^-1 Z C Z', C = (S^-1 + a G)^-1 with G = Z'M^-1 Z, S diagonal (one entry a contact) and one factor
//! a = m/s = 1/(r omega_e^2) for the scene, so that C is symmetric and positive definite. Since
//! 1/s' = 1/s + mu/(r omega_e^2), a map over (beta_s, r) is one function of s' alone. The limit is the largest step up
//! to which no multiplier of the amplification matrix leaves the unit circle. Like a spectrum's it is given as
//! l = 4/dt^2, so that dt = 2/sqrt(l).
//!
//! Not offered: the diagonalised mass penalty of a pair. (M + M_p)^-1 Z is then no multiple of M^-1 Z, and s' loses its
//! meaning.

use crate::error::Refusal;
use crate::pencil::{ChainPencil, Penalty, PenaltyMass, Pencil, Scale, Terms, Tridiagonal};
use crate::spectrum::{Enclosure, Engine, Flexibility, UNIT_ROUNDOFF, Uncertified};

/// Relative error of a computed z'M^-1 z: the entries of M move by 8 unit roundoffs, and no vector sees the sum of
/// their absolute values more than 3 times as large as M itself.
pub(super) const COMPLIANCE_ERROR: f64 = 32.0 * UNIT_ROUNDOFF;

/// The closed contacts of a row of bars.
pub(super) struct ClosedContacts<'a> {
    pub pencil: ChainPencil<'a>,
    pub flexibility: Flexibility<'a>,
    /// G = Z'M^-1 Z, diagonal and beside it, 1/kg.
    pub compliance: Tridiagonal,
    spectrum: Box<dyn Engine + 'a>,
    /// The contact-free l_max; Park's dt_c is 2/sqrt of it.
    pub contact_free: Enclosure,
}

impl<'a> ClosedContacts<'a> {
    /// Those of `pencil`, whose spectrum the engine knows; `name` is that of the scheme.
    pub fn new(pencil: &'a Pencil, spectrum: Box<dyn Engine + 'a>, name: &str) -> Result<Self, Refusal> {
        let no_chain = || Refusal::new("limit", name, "a row of bars, and an engine of bars");
        let chain = pencil.chain().filter(|_| spectrum.condensed().is_some()).ok_or_else(no_chain)?;
        let contact_free = contact_free(&*spectrum)?;
        let flexibility = Flexibility::new(chain);
        let compliance = flexibility.of(0.0, 1.0, usize::MAX).map_or_else(Tridiagonal::default, |g| {
            Tridiagonal { diagonal: g.diagonal, off_diagonal: g.off_diagonal }
        });
        Ok(Self { pencil: chain, flexibility, compliance, spectrum, contact_free })
    }

    /// Hands on what the penalty makes of each contact.
    ///
    /// # Errors
    /// The diagonalised mass penalty of a pair, which has no limit here.
    pub fn with_terms<R>(
        &self,
        penalty: &Penalty,
        use_them: impl FnOnce(&[Terms]) -> Result<R, Uncertified>,
    ) -> Result<R, Uncertified> {
        let spread = |scale: &Scale| penalty.form == PenaltyMass::Diagonalised && scale.pair;
        if self.pencil.scales().iter().any(spread) {
            return Err(Uncertified { value: f64::NAN, width: f64::INFINITY });
        }
        penalty.with_terms(self.pencil.scales(), use_them)
    }

    /// Whether every eigenvalue lies below l with these contacts.
    pub fn is_above(&self, terms: &[Terms], l: f64) -> bool {
        self.spectrum.condensed().is_some_and(|bars| bars.is_above(terms, l))
    }

    /// Relative error of l that stands for the rounding of this sign.
    pub fn rounding(&self, l: f64) -> f64 {
        self.spectrum.condensed().map_or(f64::INFINITY, |bars| bars.rounding(l))
    }

    /// 4 s' mu, rad^2/s^2, the largest over the contacts: the l at which dt^2 s' mu = 1.
    pub fn contact_eigenvalue(&self, terms: &[Terms]) -> f64 {
        let own = self.compliance.diagonal.iter().zip(terms);
        own.map(|(mu, p)| {
            if p.stiffness == 0.0 { 0.0 } else { 4.0 / (1.0 / (p.stiffness * mu) + p.mass / p.stiffness) }
        })
        .fold(0.0, f64::max)
    }

    /// mu of the first contact, 1/kg.
    pub fn first_compliance(&self) -> f64 {
        self.compliance.diagonal.first().copied().unwrap_or(0.0)
    }
}

/// The certified l_max without contact.
pub(super) fn contact_free(spectrum: &dyn Engine) -> Result<Enclosure, Refusal> {
    let uncertified = |e| Refusal::new("limit", e, "scenes whose contact-free limit is certified");
    spectrum.enclose(&Penalty::NONE, None).map_err(uncertified)
}
