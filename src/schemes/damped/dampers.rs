//! What A M + B K do to a motion.

use crate::damping::Damping;
use crate::pencil::Pencil;
use crate::schemes::{Body, State};

/// The dampers of the bodies.
#[derive(Debug, Clone)]
pub(super) struct Dampers {
    damping: Damping,
    /// u + B v, m.
    moved: Vec<f64>,
    /// Energy that they have taken, J, if it is wanted.
    pub dissipated: f64,
}

impl Dampers {
    /// Of n unknowns.
    pub fn new(damping: Damping, n: usize) -> Self {
        Self { damping, moved: vec![0.0; n], dissipated: 0.0 }
    }

    /// c, s.
    pub fn contact(&self) -> f64 {
        self.damping.contact()
    }

    /// h M^-1 (f - K u - (A M + B K) v), for an operator of scale h.
    pub fn kick(&mut self, body: &Body, state: &State, kick: &mut [f64]) {
        let (stiffness, lag) = (self.damping.stiffness(), self.damping.mass() * body.dt);
        for (moved, (u, v)) in self.moved.iter_mut().zip(state.displacement.iter().zip(&state.velocity)) {
            *moved = u + stiffness * v;
        }
        body.operator.apply(&self.moved, kick);
        kick.iter_mut().zip(&state.velocity).for_each(|(kick, v)| *kick -= lag * v);
    }

    /// x'(A M + B K) y, W for velocities.
    pub fn power(&self, pencil: &Pencil, x: &[f64], y: &[f64]) -> f64 {
        let (mass, stiffness) = (pencil.mass().quadratic(x, y), pencil.stiffness().strain(x, y));
        self.damping.mass() * mass + self.damping.stiffness() * stiffness
    }

    /// A vector of n to write into.
    pub fn scratch(&mut self) -> &mut Vec<f64> {
        &mut self.moved
    }
}
