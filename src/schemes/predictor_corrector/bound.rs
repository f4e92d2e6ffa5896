//! A step that is stable for any mesh, mass matrix and contacts: dt <= dt_c and
//!
//! ```text
//! dt^2 <= a + 1/l_max(S G) = 1/(r omega^2) + 1/(beta_s l_max(P, M))      P = sum_j w_j z_j z_j'
//! ```
//! by the sufficient half of the proof for bars ([`ClosedLimit`](super::ClosedLimit)), which uses nothing of them. The
//! limit itself may lie above, as contacts that are not alike damp each other's unstable modes, but not above the first
//! step at which the product of all multipliers exceeds 1 ([`Determinant`]). The step is a
//! [lower bound](crate::spectrum::Evidence::LowerBound) with an upper one.

use faer::Mat;

use super::determinant::Determinant;
use crate::error::Refusal;
use crate::pencil::{Penalty, PenaltyMass, Pencil, last_pivot};
use crate::schemes::Contacts;
use crate::schemes::closed::{COMPLIANCE_ERROR, ClosedContacts, contact_free};
use crate::spectrum::{Enclosure, Engine, Step, StepLimit, UNIT_ROUNDOFF, Uncertified, bisect};
use crate::symmetric::eigenvalues;

/// Contacts of bars of which all eigenvalues are computed.
const MOST_CONTACTS: usize = 300;

/// The lower bound of the limit for any pencil.
pub(in crate::schemes) struct Bound {
    contact_free: Enclosure,
    /// l_max(P, M), rad^2/s^2: that of W^1/2 G W^1/2, k x k, and its relative error.
    contact: f64,
    error: f64,
    determinant: Determinant,
    spreads_mass: bool,
}

impl Bound {
    /// For `pencil`, whose spectrum the engine knows.
    ///
    /// # Errors
    /// A contact-free l_max that cannot be certified, and a mass that has no factor.
    pub fn new(pencil: &Pencil, spectrum: Box<dyn Engine + '_>) -> Result<Self, Refusal> {
        Self::beside(pencil, contact_free(&*spectrum)?)
    }

    /// For `pencil`, whose bodies allow 4/dt^2 = `contact_free`.
    ///
    /// # Errors
    /// A mass that has no factor.
    pub fn beside(pencil: &Pencil, contact_free: Enclosure) -> Result<Self, Refusal> {
        let contacts = Contacts::new(pencil, &Penalty::NONE)?;
        let (k, n) = (contacts.len(), pencil.size() as f64);
        let root = |j: usize| pencil.gaps()[j].scale.sqrt();
        let scaled = Mat::from_fn(k, k, |i, j| root(i) * contacts.compliance_between(i, j) * root(j));
        let eigenvalues = eigenvalues(&scaled).unwrap_or_default();
        // A factor of M is exact for one that differs by n (n + 1) u diag(M), and diag(M) <= c M; a diagonal one takes a
        // rounding. The eigenvalues of a k x k matrix take some k^2 more.
        let factor = if pencil.mass().is_diagonal() { 4.0 } else { pencil.bounds().mass * n * (n + 1.0) };
        let error = UNIT_ROUNDOFF * (factor + 8.0 * (k * k) as f64 + 16.0);
        Ok(Self {
            contact_free,
            contact: eigenvalues.last().copied().unwrap_or(0.0),
            error,
            determinant: Determinant::new(&eigenvalues, error),
            spreads_mass: spreads_mass(pencil),
        })
    }

    /// For the closed contacts of a row of bars: W^1/2 G W^1/2 is tridiagonal, and the sign of its pivots tells where
    /// l_max(P, M) is.
    pub fn of_bars(closed: &ClosedContacts) -> Self {
        let (own, beside) = (&closed.compliance.diagonal, &closed.compliance.off_diagonal);
        let pencil = closed.pencil.pencil();
        let scale = |j: usize| pencil.gaps()[j].scale;
        let diagonal: Vec<f64> = own.iter().enumerate().map(|(j, g)| scale(j) * g).collect();
        let couple = |(j, g): (usize, &f64)| scale(j).sqrt() * g * scale(j + 1).sqrt();
        let off: Vec<f64> = beside.iter().enumerate().map(couple).collect();
        let lies_above = |l: f64| {
            let rows = diagonal.iter().skip(1).zip(&off).map(|(own, off)| (l - own, *off));
            let first = diagonal.first().copied().unwrap_or(0.0);
            last_pivot(l - first, rows, |pivot, _| pivot > 0.0).is_some_and(|last| last > 0.0)
        };
        // Each contact is coupled to two at most, by no more than the root of the product of their own entries.
        let largest = diagonal.iter().copied().fold(0.0, f64::max);
        let (_, contact) = bisect(largest, 3.0 * largest, lies_above);
        // An entry is in error by COMPLIANCE_ERROR, its scaling by 4 roundings, and a pivot by 4 more of l and of the
        // entry beside it (Kahan: as exact pivots of entries so moved). Three entries of a row of at most l each.
        let error = 3.0 * (COMPLIANCE_ERROR + 8.0 * UNIT_ROUNDOFF) + 16.0 * UNIT_ROUNDOFF;
        let k = diagonal.len();
        let determinant = if k > MOST_CONTACTS {
            // D^1/2 M^-1 D^1/2 has the condition c at most, D = diag(M), and so has what its contacts see of a bar: G is
            // no less than its diagonal over c.
            let least = diagonal.iter().copied().fold(f64::INFINITY, f64::min);
            Determinant::above(least / pencil.bounds().mass * (1.0 - error))
        } else {
            let entry = |i: usize, j: usize| match i.abs_diff(j) {
                0 => diagonal[i],
                1 => off[i.min(j)],
                _ => 0.0,
            };
            let eigenvalues = eigenvalues(&Mat::from_fn(k, k, entry));
            let more = 8.0 * UNIT_ROUNDOFF * (k * k) as f64;
            Determinant::new(&eigenvalues.unwrap_or_default(), error + more)
        };
        let (contact_free, spreads_mass) = (closed.contact_free, spreads_mass(pencil));
        Self { contact_free, contact, error, determinant, spreads_mass }
    }

    /// 4/(a + 1/(beta_s l_max(P, M))), rad^2/s^2, with its error.
    ///
    /// # Errors
    /// The diagonalised mass penalty of a pair.
    pub fn of_contacts(&self, penalty: &Penalty) -> Result<Enclosure, Uncertified> {
        if penalty.form == PenaltyMass::Diagonalised && self.spreads_mass {
            return Err(Uncertified { value: f64::NAN, width: f64::INFINITY });
        }
        let value = self.contact_eigenvalue(penalty);
        Ok(Enclosure { value, lower: value * (1.0 - self.error), upper: value * (1.0 + self.error) })
    }

    /// 4/(a + 1/(beta_s l_max(P, M))), rad^2/s^2.
    fn contact_eigenvalue(&self, penalty: &Penalty) -> f64 {
        let own = penalty.stiffness * self.contact;
        if own == 0.0 { 0.0 } else { 4.0 / (1.0 / own + 1.0 / penalty.rate) }
    }
}

/// Whether the diagonalised mass penalty couples what the gaps do not.
fn spreads_mass(pencil: &Pencil) -> bool {
    pencil.gaps().iter().any(|gap| gap.column.0.len() > 1)
}

impl StepLimit for Bound {
    fn name(&self) -> &'static str {
        "closed-form bound"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Step, Uncertified> {
        let (q, free) = (self.of_contacts(penalty)?, self.contact_free);
        if q.value == 0.0 {
            return Ok(Step::proven(free));
        }
        let (value, upper) = (free.value.max(q.value), free.upper.max(q.upper));
        let lower = 4.0 / self.determinant.unstable_from(penalty.stiffness, penalty.rate);
        let lower = lower * (1.0 - 4.0 * UNIT_ROUNDOFF);
        Ok(Step::between(Enclosure { value, lower, upper }))
    }

    fn costs_nothing(&self, penalty: &Penalty) -> bool {
        self.contact_eigenvalue(penalty) * (1.0 + self.error) <= self.contact_free.lower
    }
}
