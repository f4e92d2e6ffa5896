//! The step below which linear stability holds for contact that may be open or closed.

use std::sync::Arc;

use super::{PenaltyPoint, Search, limit_of_any};
use crate::error::{Refusal, Result};
use crate::schemes::{Scheme, SchemeName};
use crate::spectrum::Uncertified;
use crate::stability::{AnyModel, Asking, CriticalStep, LimitOf};

/// The largest linearly stable step of a scheme, the smaller one of closed and of open contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearStep {
    /// s.
    pub seconds: f64,
    /// Over the contact-free step of central differences.
    pub relative: f64,
    /// What it rests on.
    pub basis: Basis,
}

/// What a limit rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// An enclosure of the limit, or a proven lower bound of it.
    Enclosed,
    /// The contact-free limit, which the contacts of this scheme do not lower.
    ContactFree,
    /// Stepping alone: no theorem of this scheme is at hand for this model.
    Stepped,
}

impl Basis {
    /// In words.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Enclosed => "enclosed",
            Self::ContactFree => "contact-free",
            Self::Stepped => "by stepping",
        }
    }
}

/// Limits that only stepping gives are bracketed to this, relative.
pub const STEPPED_TO: f64 = 1e-3;

/// Whether closed contact never lowers the limit: shown beside each of these schemes.
fn costs_nothing(name: &str) -> bool {
    use SchemeName::{Buffered, Lagrange, MassRedistribution, MoreauJean, PaoliSchatzman};
    [Buffered, Lagrange, MoreauJean, PaoliSchatzman, MassRedistribution]
        .iter()
        .any(|scheme| scheme.name() == name)
}

/// The linear limit of `scheme` at a point: of its closed contacts, or without contact where that is smaller.
///
/// # Errors
/// A contact-free limit that is not enclosed; what stepping refuses where nothing else tells.
pub fn linear_step(model: &AnyModel, scheme: &Arc<dyn Scheme>, point: PenaltyPoint) -> Result<LinearStep> {
    let enclosed = |step: std::result::Result<CriticalStep, Uncertified>| {
        step.map_err(|error| Refusal::new(model.name(), error, "points whose limit is enclosed"))
    };
    let unit = model.time_step(1.0)?;
    let free = unit * enclosed(model.contact_free(&Asking::default())?.step)?.lower;
    let of = |seconds: f64, basis| {
        let seconds = seconds.min(free);
        LinearStep { seconds, relative: seconds / free, basis }
    };
    let asking = Asking { limit: LimitOf::Scheme(scheme.clone()), ..Asking::default() };
    let (beta_s, ratio) = (point.stiffness_penalty.get(), point.ratio.get());
    // Of a spectrum: l_max(K + K_p, M + M_p) <= max(l_max(K, M), r omega_ref^2).
    let light = asking.limit.scheme().is_none() && ratio * model.reference()? <= 4.0 / (free * free);
    if light || costs_nothing(scheme.facts().name) {
        return Ok(of(free, Basis::ContactFree));
    }
    match model.critical_step(beta_s, ratio, &asking).map(|found| found.step) {
        Ok(Ok(step)) => Ok(of(unit * step.lower, Basis::Enclosed)),
        _ => {
            let search = Search::to(STEPPED_TO, &**scheme)?;
            Ok(of(limit_of_any(model, &**scheme, point, &search)?.stable_at, Basis::Stepped))
        }
    }
}
