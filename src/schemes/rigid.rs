//! What the schemes without penalty share: rigid stops, a restitution, and a limit that closed contact does not lower.

use super::impulses::{Buffer, Law, Steps};
use super::{Facts, Motion, Scheme, System};
use crate::error::Refusal;
use crate::pencil::{Penalty, Pencil};
use crate::spectrum::{Engine, Step, StepLimit, Uncertified};

/// A law for rigid stops, which makes a scheme.
pub(super) trait RigidLaw: Law + Copy + 'static {
    /// See [`Scheme::facts`].
    fn facts(&self) -> Facts;
}

impl<L: RigidLaw> Scheme for L {
    fn facts(&self) -> Facts {
        RigidLaw::facts(self)
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        let buffers = vec![Buffer::RIGID; system.pencil.gaps().len()];
        Ok(Box::new(Steps::start(*self, buffers, &system, u, v)?))
    }

    fn limit<'a>(
        &self,
        _pencil: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Ok(Box::new(ContactFree(spectrum)))
    }
}

/// Of the gap (Paoli, Schatzman) or of the gap rate (Moreau, Jean) that an impact gives back, in [0, 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Restitution(f64);

impl Restitution {
    pub const NONE: Self = Self(0.0);
    pub const HALF: Self = Self(0.5);

    pub fn new(e: f64) -> Result<Self, Refusal> {
        let held = (0.0..1.0).contains(&e);
        held.then_some(Self(e)).ok_or_else(|| Refusal::new("restitution", e, "a number in [0, 1)"))
    }

    pub fn get(self) -> f64 {
        self.0
    }
}

/// The limit without contact. Closed contacts hold Z'u to a motion of its own, of multipliers e^(1/2) and less, and what is
/// left are central differences of K and M on fewer unknowns: by interlacing their limit is no smaller.
pub(super) struct ContactFree<'a>(pub Box<dyn Engine + 'a>);

impl StepLimit for ContactFree<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn enclose(&self, _penalty: &Penalty, start: Option<f64>) -> Result<Step, Uncertified> {
        self.0.enclose(&Penalty::NONE, start).map(Step::at_least)
    }

    fn costs_nothing(&self, _penalty: &Penalty) -> bool {
        true
    }
}
