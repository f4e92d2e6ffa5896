//! The energies of a motion, and the balance that each scheme keeps exactly.
//!
//! At the time of u, with lambda the reactions and W the work of the body forces f'(u - u_0):
//!
//! ```text
//! kinetic + strain + penalty + loss - W = constant
//! loss = balance_work - penalty + shadow
//! ```
//! with a shadow and weights of the work of the contacts that each scheme states beside its step. They follow from the
//! scheme by summation by parts; the loss is computed from accelerations and reactions, not as what is left over.

/// The energies of a motion, J. Their sum at a time swings about what the scheme keeps by the shadow, O(dt^2 omega^2) of it: it
/// may be above its start although contact has added nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// v'M v/2 at the time of u.
    pub kinetic: f64,
    /// u'K u/2.
    pub strain: f64,
    /// Stored in closed contacts.
    pub penalty: f64,
    /// Work that the bodies have done on the contacts since the start: the integral of lambda dg.
    pub contact_work: f64,
    /// f'u, whose change is the work of the body forces.
    pub body_work: f64,
    /// What contact has added since the start to the energy that the scheme keeps without it: -balance_work.
    pub gained: f64,
    /// Algorithmic loss; negative is a gain.
    pub loss: f64,
}

impl Energy {
    /// kinetic + strain + penalty: what a perfect scheme would only exchange with the body forces.
    pub fn stored(&self) -> f64 {
        self.kinetic + self.strain + self.penalty
    }

    /// kinetic + strain + penalty + loss - f'u, constant in every run.
    pub fn balance(&self) -> f64 {
        self.stored() + self.loss - self.body_work
    }
}
