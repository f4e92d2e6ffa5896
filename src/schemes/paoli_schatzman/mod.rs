//! The scheme of Paoli and Schatzman (RAIRO Model. Math. Anal. Numer. 27, 1993; SIAM J. Numer. Anal. 40, 2002) with
//! central differences: a restitution at the level of displacements.
//!
//! ```text
//! M (u_{n+1} - 2 u_n + u_{n-1})/dt^2 = f - K u_n - Z lambda_n      0 <= lambda_n   perpendicular to   g_{n+1} + e g_{n-1} <= 0
//! ```
//! No penalty. e = 0 is [`Lagrange`](super::Lagrange).
//!
//! *Energy.* A step adds lambda (g_{n-1} - g_{n+1})/2 = (1 + e) lambda g_{n-1}/2, which is a loss as long as g_{n-1} <= 0. For
//! e > 0 the gap after an impact is -e g_{n-1} >= 0, so that the step after the next one may gain what was lost: not proven.

use super::impulses::{Landing, Law};
use super::rigid::{Restitution, RigidLaw};
use super::{CentralDifference, Facts};
use crate::error::Refusal;

/// The scheme of Paoli and Schatzman.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaoliSchatzman {
    restitution: Restitution,
}

impl PaoliSchatzman {
    /// e = 1/2.
    pub const USUAL: Self = Self { restitution: Restitution::HALF };

    /// With the restitution e.
    ///
    /// # Errors
    /// Refuses an e outside [0, 1).
    pub fn new(e: f64) -> Result<Self, Refusal> {
        Ok(Self { restitution: Restitution::new(e)? })
    }
}

impl Law for PaoliSchatzman {
    fn landing(&self, gap: f64, rate: f64, dt: f64) -> Option<Landing> {
        let after = -self.restitution.get() * (gap - dt * rate);
        Some(Landing { rate: (after - gap) / dt, gap: after })
    }
}

impl RigidLaw for PaoliSchatzman {
    fn facts(&self) -> Facts {
        Facts {
            name: "paoli-schatzman",
            title: "Paoli-Schatzman",
            gains_nothing: self.restitution == Restitution::NONE,
            reaction: "0 <= lambda perpendicular to g_{n+1} + e g_{n-1} <= 0",
            closed_limit: "2/omega_max of (K, M) or more",
            source: "Paoli, Schatzman 1993, 2002",
            ..CentralDifference::FACTS
        }
    }
}
