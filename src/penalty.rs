//! The bi-penalty: a stiffness penalty s and a matching mass penalty m (paper, (21) to (24)).
//!
//! ```text
//! s = beta_s EA/h      m = beta_m rho h A/2      r = (1+2g)/6 beta_s/beta_m      =>      m = s/(r omega_e^2)
//! ```
//! r = 1 is the optimum M_p = K_p/omega_e^2 (32), r = inf the pure penalty method, beta_s = 0 contact-free. Between
//! unequal elements s takes the smaller EA/h. omega_e is one number for the scene, the largest element frequency at its
//! contacts: M_p = K_p/(r omega_e^2), as (29) to (32) have it. A factor for each contact would make the contact operator of
//! the predictor-corrector and the Park scheme unsymmetric wherever a bar couples two contacts, and the closed contacts
//! flutter at every step.
//!
//! ```
//! use bipenalty::penalty::{Ratio, StiffnessPenalty};
//! assert_eq!(Ratio::new(1.0)?, Ratio::OPTIMAL);
//! assert_eq!(Ratio::new(f64::INFINITY)?, Ratio::PURE_PENALTY);
//! assert!(Ratio::new(0.0).is_err() && StiffnessPenalty::new(-1.0).is_err());
//! # Ok::<(), bipenalty::error::Refusal>(())
//! ```

pub use crate::pencil::PenaltyMass;

use crate::error::Refusal;
use crate::pencil::Penalty;

/// The stiffness penalty beta_s >= 0, dimensionless, finite.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct StiffnessPenalty(f64);

impl StiffnessPenalty {
    /// beta_s.
    ///
    /// # Errors
    /// Refuses a negative, infinite or undefined value.
    pub fn new(beta_s: f64) -> Result<Self, Refusal> {
        if beta_s >= 0.0 && beta_s.is_finite() {
            Ok(Self(beta_s + 0.0))
        } else {
            Err(Refusal::new("beta_s", beta_s, "a finite number of at least 0"))
        }
    }

    /// The number beta_s.
    pub fn get(self) -> f64 {
        self.0
    }
}

/// The penalty ratio r > 0; infinity is the pure penalty method.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Ratio(f64);

impl Ratio {
    /// r = 1, the optimum of the paper.
    pub const OPTIMAL: Self = Self(1.0);
    /// No mass penalty.
    pub const PURE_PENALTY: Self = Self(f64::INFINITY);

    /// r.
    ///
    /// # Errors
    /// Refuses r <= 0 and an undefined value: the mass penalty would be infinite or negative.
    pub fn new(ratio: f64) -> Result<Self, Refusal> {
        if ratio > 0.0 { Ok(Self(ratio)) } else { Err(Refusal::new("r", ratio, "a positive number, or inf")) }
    }

    /// The number r.
    pub fn get(self) -> f64 {
        self.0
    }
}

/// Refuses the corner of a grid that f64 cannot hold: s, s/r, m of a contact of scale w (N/m) and beta_s omega^2 (the size
/// of omega_max^2 without a mass penalty) must be normal numbers with room for a sum. `reference` is omega^2.
///
/// # Errors
/// Names the quantity that overflows or underflows, with the beta_s and r that cause it.
pub fn check(scale: f64, reference: f64, beta_s: StiffnessPenalty, ratio: Ratio) -> Result<(), Refusal> {
    let (b, r) = (beta_s.get(), ratio.get());
    if b == 0.0 {
        return Ok(());
    }
    let penalty = Penalty { stiffness: b, rate: r * reference, form: PenaltyMass::Consistent };
    let (stiffness, mass) = penalty.of(scale);
    let mut needed = vec![("penalty stiffness s (N/m)", stiffness)];
    if r.is_finite() {
        needed.push(("penalty mass m (kg)", mass));
        needed.push(("s/r (N/m)", stiffness / r));
    } else {
        needed.push(("beta_s omega_e^2 (rad^2/s^2)", b * reference));
    }
    let held = f64::MIN_POSITIVE..=f64::MAX / 256.0;
    match needed.into_iter().find(|(_, value)| !held.contains(value)) {
        None => Ok(()),
        Some((quantity, value)) => Err(Refusal::new(
            "beta_s, ratio",
            format!("beta_s = {b:e} with r = {r:e} makes {quantity} = {value:e}, which"),
            format!("combinations that keep it within {:e} and {:e}", held.start(), held.end()),
        )),
    }
}
