//! The bi-penalty: a stiffness penalty s and a matching mass penalty m for each contact (paper, (21) to (24)).
//!
//! ```text
//! s = beta_s EA/h      m = beta_m rho h A/2      r = (1+2g)/6 beta_s/beta_m      =>      m = s/(r omega_e^2)
//! ```
//! r = 1 is the optimum M_p = K_p/omega_e^2 (32), r = inf the pure penalty method, beta_s = 0 contact-free. Between
//! unequal elements s takes the smaller EA/h. omega_e is one number for the scene, the largest element frequency at its
//! contacts ([`reference_bar`]): M_p = K_p/(r omega_e^2), as (29) to (32) have it. A factor for each contact would make
//! the contact operator of the predictor-corrector and the Park scheme unsymmetric wherever a bar couples two contacts,
//! and the closed contacts flutter at every step.
//!
//! ```
//! use bipenalty::penalty::{Ratio, StiffnessPenalty};
//! assert_eq!(Ratio::new(1.0)?, Ratio::OPTIMAL);
//! assert_eq!(Ratio::new(f64::INFINITY)?, Ratio::PURE_PENALTY);
//! assert!(Ratio::new(0.0).is_err() && StiffnessPenalty::new(-1.0).is_err());
//! # Ok::<(), bipenalty::error::Refusal>(())
//! ```

use crate::error::Refusal;
use crate::fem::MassMatrix;
use crate::pencil::Penalty;
use crate::scene::{Bar, ContactSite, Scene};

/// The form of the mass penalty M_p.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PenaltyMass {
    /// M_p = m z z'.
    #[default]
    Consistent,
    /// Row sums of |M_p| (paper 4.4): m on the node of a wall, 2m on each node of a pair.
    Diagonalised,
}

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

/// What the penalty of one contact is measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactScale {
    /// The smaller EA/h of the touching elements, N/m: s = beta_s times this.
    pub stiffness: f64,
    pair: bool,
}

impl ContactScale {
    /// The scales of the contacts of `scene` from left to right.
    pub fn of(scene: &Scene) -> Vec<Self> {
        scene.contact_sites().into_iter().map(|site| Self::at(scene, site)).collect()
    }

    fn at(scene: &Scene, site: ContactSite) -> Self {
        let touching = touching_bars(scene, site);
        let stiffness = touching.iter().map(Bar::element_stiffness).fold(f64::INFINITY, f64::min);
        Self { stiffness, pair: touching.len() == 2 }
    }

    /// The contact terms for (beta_s, r) in a scene of the reference omega_e^2 = `reference`, rad^2/s^2.
    #[inline]
    pub fn penalty(
        &self,
        beta_s: StiffnessPenalty,
        ratio: Ratio,
        reference: f64,
        form: PenaltyMass,
    ) -> Penalty {
        let stiffness = beta_s.get() * self.stiffness;
        let mass = stiffness / (ratio.get() * reference);
        match (form, self.pair) {
            (PenaltyMass::Diagonalised, true) => Penalty { stiffness, mass: 0.0, nodal_mass: 2.0 * mass },
            _ => Penalty { stiffness, mass, nodal_mass: 0.0 },
        }
    }

    /// Refuses the corner of a grid that f64 cannot hold: s, s/r, m and beta_s omega_e^2 (the size of omega_max^2
    /// without a mass penalty) must be normal numbers with room for a sum.
    ///
    /// # Errors
    /// Names the quantity that overflows or underflows, with the beta_s and r that cause it.
    pub fn check(&self, beta_s: StiffnessPenalty, ratio: Ratio, reference: f64) -> Result<(), Refusal> {
        let (b, r) = (beta_s.get(), ratio.get());
        if b == 0.0 {
            return Ok(());
        }
        let p = self.penalty(beta_s, ratio, reference, PenaltyMass::Consistent);
        let mut needed = vec![("penalty stiffness s (N/m)", p.stiffness)];
        if r.is_finite() {
            needed.push(("penalty mass m (kg)", p.mass));
            needed.push(("s/r (N/m)", p.stiffness / r));
        } else {
            needed.push(("beta_s omega_e^2 (rad^2/s^2)", b * reference));
        }
        let held = f64::MIN_POSITIVE..=f64::MAX / 256.0;
        match needed.into_iter().find(|(_, value)| !held.contains(value)) {
            None => Ok(()),
            Some((quantity, value)) => Err(Refusal::new(
                "--beta-s, --ratio",
                format!("beta_s = {b:e} with r = {r:e} makes {quantity} = {value:e}, which"),
                format!("combinations that keep it within {:e} and {:e}", held.start(), held.end()),
            )),
        }
    }
}

/// The bars that touch at `site`.
pub fn touching_bars(scene: &Scene, site: ContactSite) -> &[Bar] {
    let bars = scene.bars();
    match site {
        ContactSite::LeftWall => &bars[..1],
        ContactSite::Between(left) => &bars[left..left + 2],
        ContactSite::RightWall => &bars[bars.len() - 1..],
    }
}

/// The reference element of the Courant number C_r = c0 dt/h and of the mass penalty: of all elements that touch a contact, the one of the
/// highest frequency, the leftmost on a tie. Without a contact, of all elements.
pub fn reference_bar(scene: &Scene, mass: MassMatrix) -> &Bar {
    let sites = scene.contact_sites();
    let touching = sites.iter().flat_map(|site| touching_bars(scene, *site));
    let candidates: Vec<&Bar> =
        if sites.is_empty() { scene.bars().iter().collect() } else { touching.collect() };
    let higher = |best: &'_ Bar, bar: &'_ Bar| mass.element_eigenvalue(bar) > mass.element_eigenvalue(best);
    candidates.iter().skip(1).fold(candidates[0], |best, bar| if higher(best, bar) { bar } else { best })
}
