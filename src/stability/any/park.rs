//! The Park scheme on any mesh: its limit by the flexibility of the closed contacts.
//!
//! The theorem beside the scheme's limit of bars (`schemes::park`) holds for any mesh, mass and contacts: with alpha = dt/dt_c < 1
//! the scheme is stable exactly when C^-1 - W(alpha) is semidefinite. Every form of W is besides a convex function of alpha, so that
//! some flexibilities tell those of all steps ([`Flexibilities`]). The scheme takes dt_c as a number: here 2/l_c^(1/2), l_c the proven
//! upper bound of l_max(K, M), so that no mode lies above 4/dt_c^2; it is the step that [`verify`](crate::verify) gives the scheme.

use super::asking::Asking;
use super::curve::{Found, pairs, step};
use super::mesh::MeshModel;
use crate::convex::{Asked, Curve, Enclosed, Flexibilities, Poles, Prover, Share};
use crate::error::Refusal;
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::schemes::{Fractions, Park};
use crate::spectrum::{Enclosure, Step, Uncertified};
use crate::stability::Grid;

/// Contacts of which the flexibility, a full matrix, is computed: a column takes a hundred products, and each point some
/// factorisations of that size.
const MOST_CONTACTS: usize = 1000;

/// K + e l_c M is proven to be semidefinite: no more is needed beside b l_c M with b > 1/2.
const SEMIDEFINITE: f64 = 1e-9;

/// The engine in records.
const ENGINE: &str = "convex-flexibility";

impl MeshModel {
    /// Refuses what has no limit of the Park scheme.
    pub(super) fn check_park(&self) -> Result<(), Refusal> {
        let contacts = self.pencil().contacts().len();
        if contacts <= MOST_CONTACTS {
            return Ok(());
        }
        let value = format!("park with the {contacts} contacts of scene {}", self.name());
        let allowed = format!("at most {MOST_CONTACTS} contacts, or spectrum, central-difference, predictor-corrector");
        Err(Refusal::new("limit", value, allowed))
    }

    pub(super) fn park(
        &self,
        grid: &Grid,
        asking: &Asking,
        reference: f64,
        scheme: Park,
    ) -> Result<Found, Refusal> {
        let width = asking.width(grid.len());
        self.with_flexibilities(asking, scheme, |curve, flexibilities, free| {
            let error = self.reference_error(curve);
            let free = step(free, asking, curve.prover());
            let at = |(r, b): (Ratio, StiffnessPenalty)| {
                let free = free?;
                if b.get() == 0.0 || self.pencil().contacts().is_empty() {
                    return Ok(free);
                }
                let rate = r.get() * reference;
                let rates = (rate, rate * (1.0 + error + 2.0 * f64::EPSILON));
                let share = flexibilities.limit(1.0 / b.get(), rates, width - 8.0 * f64::EPSILON);
                of_share(share, flexibilities.top(), free.l, width)
            };
            Ok(Found { steps: pairs(grid).map(at).collect(), engine: ENGINE, error })
        })
    }

    /// Hands on the curve, the flexibilities of the scheme, and the contact-free limit as closely as it can be enclosed.
    pub(super) fn with_flexibilities<R>(
        &self,
        asking: &Asking,
        scheme: Park,
        use_them: impl FnOnce(
            &mut Curve,
            &mut Flexibilities,
            std::result::Result<Enclosed, crate::convex::TooWide>,
        ) -> Result<R, Refusal>,
    ) -> Result<R, Refusal> {
        self.with_curve(asking, |curve| {
            let free = curve.enclose_to(&[Asked { stiffness: 0.0, mass: 0.0 }], Asking::FEW);
            let free = free.into_iter().next();
            let free = free.ok_or_else(|| Refusal::new("point", "none", "one"))?;
            let (Ok(enclosed) | Err(crate::convex::TooWide { enclosed, .. })) = free;
            let top = enclosed.upper;
            if !(top > 0.0 && top.is_finite()) {
                return Err(Refusal::new("limit", "park", "a contact-free limit that is enclosed"));
            }
            let condition = self.semidefinite(curve.prover(), top)?;
            let mut flexibilities = self
                .flexibilities
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
                .take()
                .filter(|known| known.0 == scheme && known.1.top().to_bits() == top.to_bits())
                .map_or_else(|| Flexibilities::new(self.pencil(), top, condition, poles(scheme)), |known| known.1);
            let used = use_them(curve, &mut flexibilities, free);
            *self.flexibilities.lock().unwrap_or_else(std::sync::PoisonError::into_inner) =
                Some((scheme, flexibilities));
            used
        })
    }

    /// q with M >= diag(M)/q, for a stiffness that is proven to be semidefinite.
    fn semidefinite(&self, prover: &Prover, top: f64) -> Result<f64, Refusal> {
        if !prover.resists(SEMIDEFINITE * top) {
            let value = format!("park with a stiffness whose l_min(K, M) was not proven to exceed {:e}", -SEMIDEFINITE * top);
            return Err(Refusal::new("limit", value, "a stiffness matrix that is positive semidefinite"));
        }
        let condition = prover.condition(self.pencil().mass().is_diagonal());
        let value = "park with a mass matrix whose condition in its diagonal was not proven";
        condition.ok_or_else(|| Refusal::new("limit", value, "a mass matrix that is positive definite"))
    }
}

fn poles(scheme: Park) -> Box<dyn Fn(f64) -> Poles + Send> {
    Box::new(move |alpha| {
        let Fractions { above, below, gain, loss } = scheme.fractions(alpha);
        Poles { above, below, gain, loss }
    })
}

/// l = l_c/alpha^2; where the contact-free mesh limits, its own.
fn of_share(share: Share, top: f64, free: Enclosure, width: f64) -> Result<Step, Uncertified> {
    let Share { stable, unstable } = share;
    let rounding = 4.0 * f64::EPSILON;
    let lower = if unstable >= 1.0 { free.lower } else { top / (unstable * unstable) * (1.0 - rounding) };
    let upper = top / (stable * stable) * (1.0 + rounding);
    if stable > 0.0 && (upper / lower).sqrt() - 1.0 <= width {
        return Ok(Step::proven(Enclosure { value: lower, lower, upper }));
    }
    Err(Uncertified { value: lower, width: upper / lower - 1.0 })
}
