//! Damping that lags half a step behind, as explicit codes have it, and what it does to the largest stable step.
//!
//! ```text
//! (M + M_p) a_n = f - (K + K_p) u_n - C v_{n-1/2}      v_{n+1/2} = v_{n-1/2} + h a_n      u_{n+1} = u_n + h v_{n+1/2}
//! C = A M + B K + c K_p
//! ```
//! A (1/s) and B (s) are Rayleigh's, c (s) damps the closed contacts. A acts on M alone and B on K alone: neither the mass
//! penalty nor the stiffness penalty is damped by them, so that A, B >= 0 mean the same for every penalty.
//!
//! # The limit
//! Let N = M + M_p > 0, S = K + K_p >= 0 and C >= 0. The step h is stable exactly when
//!
//! ```text
//! D(h) = 4 N - 2 h C - h^2 S >= 0
//! ```
//! *Sufficient.* A mode x with the multiplier z obeys n (z - 1)^2 + h d (z - 1) + h^2 e z = 0 with the numbers n = x*Nx > 0,
//! d = x*Cx >= 0 and e = x*Sx >= 0, that is n z^2 + (h d + h^2 e - 2 n) z + (n - h d) = 0. Its coefficients are real, so both
//! roots lie in the closed unit disc when |n - h d| <= n and the polynomial is not negative at z = 1, where it is h^2 e, and at
//! z = -1, where it is 4 n - 2 h d - h^2 e = x*D(h)x >= 0; which also says h d <= 2 n. *Necessary.* The symmetric matrix
//! N (z - 1)^2 + h C (z - 1) + h^2 S z is D(h) at z = -1 and grows like z^2 N for z -> -infinity: if D(h) has a negative
//! eigenvalue, a real multiplier lies beyond -1. So z = -1 is the only way out.
//!
//! *One interval.* x'D(h)x decreases with h for every x, so that the stable h are an interval (0, h*].
//!
//! # One number decides
//! With y = 2/h, D(h) = h^2 (y^2 N - y C - S), and for y > A
//!
//! ```text
//! D(h) >= 0  exactly when  l_max(K + sigma K_p, M + nu M_p) <= kappa
//! kappa = y (y - A)/(1 + B y)      sigma = (1 + c y)/(1 + B y)      nu = y/(y - A)
//! ```
//! an undamped problem of the same pencil with another penalty, which any engine encloses. (In terms of f(t) = l_max(K + t P, M):
//! f(sigma s - kappa nu m) <= kappa.)
//!
//! *How steep.* For every x, ln of kappa (x'Mx + nu x'M_p x)/(x'Kx + sigma x'K_p x) has the derivative by ln y
//!
//! ```text
//! 2 + (1 - q) A/(y - A) - (1 - p) B y/(1 + B y) - p c y/(1 + c y)  >=  rho = 2 - max(B y/(1 + B y), c y/(1 + c y))  >  1
//! ```
//! p and q the shares of K_p and M_p in the two sums. The least of these functions over all x, ln(kappa/l_max), is as steep. So
//! one enclosure [L, U] of l_max at any y > A encloses the limit y*, if y* > A:
//!
//! ```text
//! min(1, L/kappa)^(1/rho) <= y*/y <= max(1, U/kappa)^(1/rho)
//! ```
//! with rho at the upper end, where it is least. The condition of the limit is 1/rho < 1: damping makes it no less certain.
//!
//! *At A.* y* >= A as soon as some motion is not held by any contact: x'D x = -(1 + B A) x'Kx <= 0 there. Only where
//! contacts hold all unknowns may y* be smaller; then the limit is known from below, 2/A.
//!
//! One mode, xi = (A/omega + B omega)/2: h* = (2/omega)(sqrt(1 + xi^2) - xi).
//!
//! ```
//! use bipenalty::damping::{DampedLimit, Damping};
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
//! use bipenalty::scene::load;
//! use bipenalty::spectrum::StepLimit as _;
//! use bipenalty::stability::Model;
//!
//! let model = Model::new(load("signorini")?, MassMatrix::LUMPED, PenaltyMass::Consistent);
//! let (pencil, omega) = (model.pencil(), model.reference_eigenvalue().sqrt());
//! // A tenth of critical damping at the top frequency, by the stiffness.
//! let damping = Damping::new(0.0, 2.0 * 0.1 / omega, 0.0)?;
//! let limit = DampedLimit::new(&pencil, Box::new(model.auto()), damping);
//! let step = limit.enclose(&model.penalty(StiffnessPenalty::new(0.0)?, Ratio::OPTIMAL), None)?;
//! let expected = 2.0 / omega * (1.01_f64.sqrt() - 0.1);
//! assert!((step.seconds() / expected - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod curve;
mod limit;
mod search;

pub use curve::{DampedCurve, DampedMesh, enclose_damped};
pub use limit::DampedLimit;

use crate::error::Refusal;
use crate::pencil::{Gap, Penalty, PenaltyMass};

/// C = A M + B K + c K_p, the velocity half a step behind.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Damping {
    mass: f64,
    stiffness: f64,
    contact: f64,
}

impl Damping {
    /// C = 0.
    pub const NONE: Self = Self { mass: 0.0, stiffness: 0.0, contact: 0.0 };

    /// A in 1/s, B in s, c in s (N s/m per N/m of K_p).
    ///
    /// # Errors
    /// A number that is negative or not finite: C would not be semidefinite.
    pub fn new(mass: f64, stiffness: f64, contact: f64) -> Result<Self, Refusal> {
        let parts = [("mass", mass, "1/s"), ("stiffness", stiffness, "s"), ("contact", contact, "s")];
        match parts.into_iter().find(|(_, value, _)| !(*value >= 0.0 && value.is_finite())) {
            None => Ok(Self { mass, stiffness, contact }),
            Some((part, value, unit)) => {
                let allowed = format!("a finite number of at least 0 ({unit})");
                Err(Refusal::new(format!("damping, {part}"), value, allowed))
            }
        }
    }

    /// A, 1/s.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// B, s.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// c, s.
    pub fn contact(&self) -> f64 {
        self.contact
    }

    /// Whether C = 0.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// The same without what acts on the contacts: A M + B K.
    pub fn of_bodies(self) -> Self {
        Self { contact: 0.0, ..self }
    }

    /// The undamped problem that decides whether the step dt (s) is stable: a tool that answers for undamped contacts, such
    /// as the largest penalty for a step, so answers for damped ones. `None` unless 2/dt > A, where only contacts that hold all
    /// unknowns could be stable.
    pub fn equivalent(&self, time_step: f64) -> Option<Equivalent> {
        let y = 2.0 / time_step;
        (y > self.mass && y.is_finite()).then(|| self.at(y))
    }

    /// The same at y = 2/dt > A. No entry has more than 5 roundings: y and A are numbers as stored, so that y - A has one.
    fn at(&self, y: f64) -> Equivalent {
        let (free, slow, contact) = (y - self.mass, 1.0 + self.stiffness * y, 1.0 + self.contact * y);
        Equivalent { l: y * (free / slow), stiffness: contact / slow, mass: y / free }
    }

    /// rho at y, a little less than it is.
    fn steepness(&self, y: f64) -> f64 {
        let part = |factor: f64| factor * y / (1.0 + factor * y);
        // Below 2 each: three roundings of a part of at most 1, one of the difference.
        let lost = if self.stiffness > 0.0 || self.contact > 0.0 { 4.0 * f64::EPSILON } else { 0.0 };
        2.0 - part(self.stiffness).max(part(self.contact)) - lost
    }

    /// The y at which kappa = l: the larger root of y^2 - (A + B l) y - l.
    fn place(&self, l: f64) -> f64 {
        let half = 0.5 * (self.mass + self.stiffness * l);
        half + (half * half + l).sqrt()
    }

    /// The least y that is looked at.
    fn floor(&self) -> f64 {
        self.mass * (1.0 + 2.0 * f64::EPSILON)
    }
}

/// An undamped problem that is stable exactly when a damped one is: l_max(K + sigma K_p, M + nu M_p) <= kappa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equivalent {
    /// kappa, rad^2/s^2: 4/dt^2 of the undamped problem.
    pub l: f64,
    /// sigma, which multiplies the stiffness penalty.
    pub stiffness: f64,
    /// nu, which multiplies the mass penalty.
    pub mass: f64,
}

impl Equivalent {
    /// The undamped step, s.
    pub fn time_step(&self) -> f64 {
        2.0 / self.l.sqrt()
    }

    /// The undamped penalty. With the ratio r it has the ratio r sigma/nu; the damped beta_s is the undamped one over sigma.
    pub fn penalty(&self, penalty: &Penalty) -> Penalty {
        let rate = penalty.rate * (self.stiffness / self.mass);
        Penalty { stiffness: penalty.stiffness * self.stiffness, rate, ..*penalty }
    }
}

/// Whether a motion exists that no contact holds: y* >= A.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Unheld {
    /// Fewer contacts than unknowns.
    fewer: bool,
    /// An unknown that no gap moves.
    untouched: bool,
}

impl Unheld {
    fn of(gaps: &[Gap], unknowns: usize) -> Self {
        let mut touched = vec![false; unknowns];
        gaps.iter().flat_map(|gap| &gap.column.0).for_each(|(i, _)| touched[*i as usize] = true);
        Self { fewer: gaps.len() < unknowns, untouched: touched.contains(&false) }
    }

    /// With this form of the mass penalty; the diagonalised one holds every unknown of a gap.
    fn under(self, form: PenaltyMass) -> bool {
        match form {
            PenaltyMass::Consistent => self.fewer || self.untouched,
            PenaltyMass::Diagonalised => self.untouched,
        }
    }
}
