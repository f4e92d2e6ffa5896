//! The stabilised scheme of Park with pullback and averaging.

#[cfg(test)]
mod convexity;
mod fractions;
mod limit;
mod motion;
mod sign;

pub use fractions::Fractions;
use limit::ParkLimit;
use motion::Steps;

use super::{ContactSearch, Facts, Motion, Onset, Scheme, System};
use crate::double_double::Dd;
use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::spectrum::{Engine, StepLimit};

/// The stabilised Park scheme (paper, 4.5). Its pullback extrapolates to the critical step of the contact-free system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Park {
    theta: f64,
}

impl Park {
    /// theta = 1/2, as in the paper.
    pub const USUAL: Self = Self { theta: 0.5 };

    /// The scheme with theta, the weight of the pullback.
    ///
    /// # Errors
    /// Refuses a theta outside [0, 1].
    pub fn new(theta: f64) -> Result<Self, Refusal> {
        if (0.0..=1.0).contains(&theta) {
            Ok(Self { theta })
        } else {
            Err(Refusal::new("theta", theta, "a number in [0, 1]"))
        }
    }

    /// The flexibility W of closed contacts at the step alpha dt_c, 0 < alpha < 1, by its partial fractions:
    ///
    /// ```text
    /// W = gain Z'(above l_c M - K)^-1 Z - loss Z'(below l_c M + K)^-1 Z      dt_c = 2/l_c^(1/2)
    /// ```
    /// The scheme is stable exactly when 1/s Y^-1 + G/(r omega^2) - W is semidefinite; each form of W is convex in alpha.
    pub fn fractions(self, alpha: f64) -> Fractions<Dd> {
        Fractions::new(self.theta, alpha, 0.0)
    }

    /// theta, dimensionless.
    pub fn theta(self) -> f64 {
        self.theta
    }
}

impl Scheme for Park {
    fn facts(&self) -> Facts {
        Facts {
            name: "park",
            title: "Park",
            solves: 2,
            order: 2,
            search: ContactSearch::Predictor,
            onset: Onset::Linear,
            gains_nothing: false,
            reaction: "s g_pred/(1 + m mu)",
            closed_limit: "a zero of the scheme's characteristic function",
            source: "Park, Lim, Huh 2012; Cho, Park, Huh 2013; Kolman et al. 2021, 4.5",
        }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        Ok(Box::new(Steps::start(*self, &system, u, v)?))
    }

    fn as_park(&self) -> Option<Park> {
        Some(*self)
    }

    fn limit<'a>(
        &self,
        pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Ok(Box::new(ParkLimit::new(pencil, spectrum, self.theta)?))
    }
}
