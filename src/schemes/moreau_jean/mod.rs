//! Central differences with impacts at the level of velocities: the time stepping of Moreau (in Nonsmooth Mechanics and
//! Applications, CISM 302, 1988) and Jean (Comput. Methods Appl. Mech. Eng. 177, 1999) with an explicit rule of
//! quadrature, as in Doyen, Ern, Piperno, SIAM J. Sci. Comput. 33 (2011) and Fekak, Brun, Gravouil, Depale, Comput. Mech.
//! 60 (2017).
//!
//! ```text
//! M (v_{n+1/2} - v_{n-1/2}) = dt (f - K u_n - Z lambda_n)
//! g_n >= 0:   0 <= lambda_n   perpendicular to   y + e x <= 0      x, y = Z'v_{n-1/2}, Z'v_{n+1/2}
//! ```
//! An open contact is not looked at, so that the penetration of the step that closes stays, O(dt). No penalty.
//!
//! *Energy.* A step adds -dt lambda (x + y)/2 = -dt lambda x (1 - e)/2: an impact, x >= 0, gains nothing. A contact that was
//! about to open, x < 0, and is pressed back within the step may gain: not proven, and seen (`tests/impacts`).

use super::impulses::{Landing, Law};
use super::rigid::{Restitution, RigidLaw};
use super::{CentralDifference, Facts};
use crate::error::Refusal;

/// Central differences with impacts of velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoreauJean {
    restitution: Restitution,
}

impl MoreauJean {
    /// e = 0, the usual choice for deformable bodies.
    pub const USUAL: Self = Self { restitution: Restitution::NONE };

    /// With the restitution e.
    ///
    /// # Errors
    /// Refuses an e outside [0, 1).
    pub fn new(e: f64) -> Result<Self, Refusal> {
        Ok(Self { restitution: Restitution::new(e)? })
    }
}

impl Law for MoreauJean {
    fn landing(&self, gap: f64, rate: f64, dt: f64) -> Option<Landing> {
        let after = -self.restitution.get() * rate;
        (gap >= 0.0).then_some(Landing { rate: after, gap: gap + dt * after })
    }
}

impl RigidLaw for MoreauJean {
    fn facts(&self) -> Facts {
        Facts {
            name: "moreau-jean",
            title: "Moreau-Jean",
            gains_nothing: false,
            reaction: "0 <= lambda perpendicular to Z'(v_{n+1/2} + e v_{n-1/2}) <= 0 where g_n >= 0",
            closed_limit: "2/omega_max of (K, M) or more",
            source: "Moreau 1988; Jean 1999; Fekak, Brun, Gravouil, Depale 2017",
            ..CentralDifference::FACTS
        }
    }
}
