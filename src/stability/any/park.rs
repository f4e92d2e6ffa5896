//! The Park scheme on any mesh: its limit by the flexibility of the closed contacts.
//!
//! The theorem beside the scheme's limit of bars (`schemes::park`) holds for any mesh, mass and contacts: with alpha = dt/dt_c < 1
//! the scheme is stable exactly when C^-1 - W(alpha) is semidefinite. Every form of W is besides a convex function of alpha, so that
//! some flexibilities tell those of all steps ([`Flexibilities`]). The scheme takes dt_c as a number: here 2/l_c^(1/2), l_c the proven
//! upper bound of l_max(K, M), so that no mode lies above 4/dt_c^2; it is the step that [`verify`](crate::verify) gives the scheme.

use super::asking::Asking;
use super::curve::{Found, pairs, step};
use super::largest::{Largest, MARGIN, at_most};
use super::mesh::MeshModel;
use crate::convex::{Asked, Curve, Enclosed, Flexibilities, Given, Poles, Prover, Share, TooWide};
use crate::error::{Refusal, Result};
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::schemes::{Fractions, Park};
use crate::spectrum::{Enclosure, Step, Uncertified};
use crate::stability::Grid;

/// Contacts of which the flexibility, a full matrix, is computed: a column takes a hundred products, and each point some
/// factorisations of that size.
const MOST_CONTACTS: usize = 1000;

/// K + e l_c M is proven to be semidefinite: no more is needed beside b l_c M with b > 1/2.
const SEMIDEFINITE: f64 = 1e-9;

/// Ratios at which a cost is looked for, and how closely the step is enclosed for that.
const RATIOS: [f64; 3] = [1e-2, 1.0, f64::INFINITY];
const LOSS: f64 = 1e-6;

/// What a question for the other of the two is asked with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fixed {
    /// r.
    Ratio(f64),
    /// beta_s.
    Penalty(f64),
}

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
        let allowed =
            format!("at most {MOST_CONTACTS} contacts, or spectrum, central-difference, predictor-corrector");
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
                // What the reference is not known to is part of the width.
                let left = (width - 2.0 * error).max(0.5 * width) - 16.0 * f64::EPSILON;
                let share = flexibilities.limit(1.0 / b.get(), rates, left);
                of_share(share, flexibilities.top(), free.l, width)
            };
            Ok(Found { steps: pairs(grid).map(at).collect(), engine: ENGINE, error })
        })
    }

    /// A ratio that is proven to cost a step at beta_s > 0, the smallest of a few; `None` where none is.
    pub(super) fn costly_ratio_of_park(
        &self,
        asking: &Asking,
        scheme: Park,
        beta_s: f64,
    ) -> Result<Option<f64>> {
        let reference = self.reference()?;
        let found = self.with_flexibilities(asking, scheme, |_, flexibilities, _| {
            let mut costs = |ratio: &f64| {
                let rate = ratio * reference;
                flexibilities.limit(1.0 / beta_s, (rate, rate), LOSS).unstable < 1.0
            };
            Ok(RATIOS.into_iter().find(|ratio| costs(ratio)))
        })?;
        Ok(found)
    }

    /// The largest beta_s or ratio that stands l = 4/dt^2: `None` where that is beyond the contact-free limit already.
    pub(super) fn largest_of_park(
        &self,
        l: f64,
        asking: &Asking,
        scheme: Park,
        fixed: Fixed,
    ) -> Result<Option<Largest>> {
        let reference = self.reference()?;
        let found = self.with_flexibilities(asking, scheme, |curve, flexibilities, free| {
            let (Ok(Enclosed { lower, .. }) | Err(TooWide { enclosed: Enclosed { lower, .. }, .. })) = free;
            if l < lower * (1.0 - MARGIN) {
                return Ok(None);
            }
            let alpha = (flexibilities.top() / l).sqrt();
            // Between the bounds of the contact-free limit nothing is known.
            if alpha * (1.0 + MARGIN) >= 1.0 {
                return Ok(Some(at_most(0.0)));
            }
            let error = self.reference_error(curve) + MARGIN;
            let (given, unit) = match fixed {
                Fixed::Ratio(r) => {
                    ([Given::Rate(r * reference * (1.0 + error)), Given::Rate(r * reference)], 1.0)
                }
                Fixed::Penalty(0.0) => return Ok(Some(Largest::ANY)),
                Fixed::Penalty(b) => ([Given::Softness(1.0 / b); 2], reference),
            };
            let above = flexibilities.least(alpha * (1.0 + MARGIN), given[0], asking.width(1)).0;
            let below = flexibilities.least(alpha * (1.0 - MARGIN), given[1], asking.width(1)).1;
            let of = |x: f64, margin: f64| (1.0 + margin) / (x * unit);
            let lower = of(above, -error);
            Ok(Some(Largest { value: lower, lower, upper: of(below, error) }))
        })?;
        Ok(found)
    }

    /// Hands on the curve, the flexibilities of the scheme, and the contact-free limit as closely as it can be enclosed.
    pub(super) fn with_flexibilities<R>(
        &self,
        asking: &Asking,
        scheme: Park,
        use_them: impl FnOnce(
            &mut Curve,
            &mut Flexibilities,
            std::result::Result<Enclosed, TooWide>,
        ) -> Result<R, Refusal>,
    ) -> Result<R, Refusal> {
        self.with_curve(asking, |curve| {
            let free = curve.enclose_to(&[Asked { stiffness: 0.0, mass: 0.0 }], Asking::FEW);
            let free = free.into_iter().next();
            let free = free.ok_or_else(|| Refusal::new("point", "none", "one"))?;
            let (Ok(enclosed) | Err(TooWide { enclosed, .. })) = free;
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
                .map_or_else(
                    || Flexibilities::new(self.pencil(), top, condition, poles(scheme)),
                    |known| known.1,
                );
            let used = use_them(curve, &mut flexibilities, free);
            *self.flexibilities.lock().unwrap_or_else(std::sync::PoisonError::into_inner) =
                Some((scheme, flexibilities));
            used
        })
    }

    /// q with M >= diag(M)/q, for a stiffness that is proven to be semidefinite.
    fn semidefinite(&self, prover: &Prover, top: f64) -> Result<f64, Refusal> {
        if !prover.resists(SEMIDEFINITE * top) {
            let value = format!(
                "park with a stiffness whose l_min(K, M) was not proven to exceed {:e}",
                -SEMIDEFINITE * top
            );
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
