//! A step of the damped predictor-corrector that is stable, for any mesh, mass matrix and contacts.
//!
//! a_pred = M^-1 (f - K u - D v) with D = A M + B K and v half a step behind, v_pred = v + h a_pred, u_pred = u + h v_pred,
//! and the contact acts on both, f_c = -K_p (u_pred + c v_pred), through (M + M_p)^-1. With G = Z'M^-1 Z,
//! C = (S^-1 + a G)^-1, a = 1/(r omega^2), b = h^2 + c h and k = b (C^-1 - b G)^-1 the displacements obey
//!
//! ```text
//! (M + Z k Z') u_{n+1} - (2 M - h^2 K - h D + e Z k Z') u_n + (M - h D) u_{n-1} = 0      e = c h/b in [0, 1)
//! ```
//! since h v_pred = u_pred - u_n and u_{n+1} = u_pred - M^-1 Z C Z' (b u_pred - c h u_n).
//!
//! *Sufficient.* Let k >= 0. A mode x with the multiplier z obeys (m + k) z^2 - (2 m - h^2 l - h d + e k) z + m - h d = 0 with
//! the numbers m, k, l and d of M, Z k Z', K and D. Both roots lie in the closed unit disc when |m - h d| <= m + k,
//! (1 - e) k + h^2 l >= 0 and 4 m - 2 h d - h^2 l + (1 + e) k >= 0: all of them if 4 m - 2 h d - h^2 l >= 0, the limit of damped
//! central differences without contact. k >= 0 as long as b l_max(C G) < 1. So
//!
//! ```text
//! h <= h* of (K, M) damped by D      and      h^2 + c h <= 1/(r omega^2) + 1/(beta_s l_max(P, M))
//! ```
//! (at equality k is infinite on a subspace; multipliers are continuous). Beyond, damping may keep the scheme stable, so that
//! the step is a [lower bound](crate::spectrum::Evidence::LowerBound).

use crate::damping::{DampedLimit, Damping};
use crate::error::Refusal;
use crate::pencil::{Penalty, Pencil};
use crate::schemes::predictor_corrector::Bound as Undamped;
use crate::spectrum::{Enclosure, Engine, Step, StepLimit, Uncertified};

/// The lower bound of the limit of the damped predictor-corrector.
pub struct DampedBound {
    contact: Undamped,
    /// l = 4/h^2 of the damped bodies without contact.
    bodies: Enclosure,
    lag: f64,
}

impl DampedBound {
    /// For `pencil`, whose spectrum the engine knows.
    ///
    /// # Errors
    /// As the undamped bound; a limit of the damped bodies that cannot be certified.
    pub fn new<'a>(
        pencil: &Pencil,
        spectrum: Box<dyn Engine + 'a>,
        damping: Damping,
    ) -> Result<Self, Refusal> {
        let bodies = DampedLimit::new(pencil, spectrum, damping.of_bodies()).enclose(&Penalty::NONE, None);
        let uncertified = |e| Refusal::new("limit", e, "scenes whose contact-free limit is certified");
        let bodies = bodies.map_err(uncertified)?.l;
        Ok(Self { contact: Undamped::beside(pencil, bodies)?, bodies, lag: damping.contact() })
    }

    /// 4/h^2 of h^2 + c h = b_max = 4/q: with y = 2/h, y^2 = q (1 + c y/2).
    fn contact_rate(&self, q: f64) -> f64 {
        let half = 0.25 * self.lag * q;
        (half + (half * half + q).sqrt()).powi(2)
    }
}

impl StepLimit for DampedBound {
    fn name(&self) -> &'static str {
        "closed-form bound"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Step, Uncertified> {
        let q = self.contact.of_contacts(penalty)?;
        if q.value == 0.0 {
            return Ok(Step::proven(self.bodies));
        }
        // Six roundings; the root follows q by no more than its own relative change, doubled.
        let rounding = 1.0 + 8.0 * f64::EPSILON;
        let upper = self.bodies.upper.max(self.contact_rate(q.upper) * rounding);
        let value = self.bodies.value.max(self.contact_rate(q.value));
        Ok(Step::at_least(Enclosure { value, lower: self.bodies.lower, upper }))
    }
}
