//! A step that is stable for any mesh, mass matrix and contacts: dt <= dt_c and
//!
//! ```text
//! dt^2 <= a + 1/l_max(S G) = 1/(r omega^2) + 1/(beta_s l_max(P, M))      P = sum_j w_j z_j z_j'
//! ```
//! by the sufficient half of the proof for bars ([`ClosedLimit`](super::ClosedLimit)), which uses nothing of them. The
//! limit itself may lie above: contacts that are not alike damp each other's unstable modes.

use faer::{Mat, Side};

use crate::error::Refusal;
use crate::pencil::{Penalty, PenaltyMass, Pencil};
use crate::schemes::Contacts;
use crate::schemes::closed::contact_free;
use crate::spectrum::{Enclosure, Engine, Step, StepLimit, UNIT_ROUNDOFF, Uncertified};

/// The lower bound of the limit for any pencil.
pub(super) struct Bound {
    contact_free: Enclosure,
    /// l_max(P, M), rad^2/s^2: that of W^1/2 G W^1/2, k x k, and its relative error.
    contact: f64,
    error: f64,
    spreads_mass: bool,
}

impl Bound {
    /// For `pencil`, whose spectrum the engine knows.
    ///
    /// # Errors
    /// A contact-free l_max that cannot be certified, and a mass that has no factor.
    pub fn new(pencil: &Pencil, spectrum: Box<dyn Engine + '_>) -> Result<Self, Refusal> {
        let contacts = Contacts::new(pencil, &Penalty::NONE)?;
        let (k, n) = (contacts.len(), pencil.size() as f64);
        let root = |j: usize| pencil.gaps()[j].scale.sqrt();
        let scaled = Mat::from_fn(k, k, |i, j| root(i) * contacts.compliance_between(i, j) * root(j));
        let eigenvalues = scaled.self_adjoint_eigenvalues(Side::Lower).unwrap_or_default();
        // A factor of M is exact for one that differs by n (n + 1) u diag(M), and diag(M) <= c M; a diagonal one takes a
        // rounding. The eigenvalues of a k x k matrix take some k^2 more.
        let factor = if pencil.mass().is_diagonal() { 4.0 } else { pencil.bounds().mass * n * (n + 1.0) };
        let error = UNIT_ROUNDOFF * (factor + 8.0 * (k * k) as f64 + 16.0);
        Ok(Self {
            contact_free: contact_free(&*spectrum)?,
            contact: eigenvalues.last().copied().unwrap_or(0.0),
            error,
            spreads_mass: pencil.gaps().iter().any(|gap| gap.column.0.len() > 1),
        })
    }

    /// 4/(a + 1/(beta_s l_max(P, M))), rad^2/s^2.
    fn contact_eigenvalue(&self, penalty: &Penalty) -> f64 {
        let own = penalty.stiffness * self.contact;
        if own == 0.0 { 0.0 } else { 4.0 / (1.0 / own + 1.0 / penalty.rate) }
    }
}

impl StepLimit for Bound {
    fn name(&self) -> &'static str {
        "closed-form bound"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Step, Uncertified> {
        if penalty.form == PenaltyMass::Diagonalised && self.spreads_mass {
            return Err(Uncertified { value: f64::NAN, width: f64::INFINITY });
        }
        let (q, free) = (self.contact_eigenvalue(penalty), self.contact_free);
        let upper = free.upper.max(q * (1.0 + self.error));
        Ok(Step::at_least(Enclosure { value: free.value.max(q), lower: free.lower, upper }))
    }

    fn costs_nothing(&self, penalty: &Penalty) -> bool {
        self.contact_eigenvalue(penalty) * (1.0 + self.error) <= self.contact_free.lower
    }
}
