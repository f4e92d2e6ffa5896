//! Central differences with Lagrange multipliers by forward increments (Carpenter, Taylor, Katona, Int. J. Numer. Meth.
//! Eng. 32, 1991): the contact condition is that of the *next* displacement.
//!
//! ```text
//! M (v_{n+1/2} - v_{n-1/2}) = dt (f - K u_n - Z lambda_n)      0 <= lambda_n   perpendicular to   g_{n+1} <= 0
//! ```
//! The paper finds lambda by Gauss-Seidel sweeps; here the complementarity problem is solved, directly where no two contacts
//! act on each other. No penalty: beta_s and r have no effect. It is [`Buffered`](super::Buffered) with stops that do not
//! move, and what is proven there holds here: *for dt < dt_c the leapfrog energy never grows*, for any number of contacts,
//! any mass matrix and any sequence of openings, since each contact adds lambda_n (g_{n-1} - g_{n+1})/2 = lambda_n g_{n-1}/2 <= 0.
//! The scheme of Paoli and Schatzman with the restitution 0 is the same one.

use super::impulses::{Landing, Law};
use super::rigid::RigidLaw;
use super::{CentralDifference, Facts};

/// Central differences with Lagrange multipliers by forward increments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lagrange;

/// The gap is closed at the end of the step, not opened. A contact that was penetrated a step ago, which a start may do, is
/// only thrown back as fast as it came, y = -x.
impl Law for Lagrange {
    fn landing(&self, gap: f64, rate: f64, dt: f64) -> Option<Landing> {
        let was_open = gap - dt * rate <= 4.0 * f64::EPSILON * (gap.abs() + dt * rate.abs());
        Some(match was_open {
            true => Landing { rate: -gap / dt, gap: 0.0 },
            false => Landing { rate: -rate, gap: gap - dt * rate },
        })
    }
}

impl RigidLaw for Lagrange {
    fn facts(&self) -> Facts {
        Facts {
            name: "lagrange",
            title: "Lagrange, forward increments",
            gains_nothing: true,
            reaction: "0 <= lambda perpendicular to g_{n+1} <= 0",
            closed_limit: "2/omega_max of (K, M) or more",
            source: "Carpenter, Taylor, Katona 1991",
            ..CentralDifference::FACTS
        }
    }
}
