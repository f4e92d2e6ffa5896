//! Bodies of any kind on their way to each other: a pencil with gaps, initial velocities and loads.
//!
//! A mesh brings its matrices, contacts and the velocities of its bodies; a row of bars its model; anything else a
//! [`Pencil`]. Contact is unilateral at every gap.

use super::Mesh;
use super::run::contact_free_step;
use crate::error::Refusal;
use crate::mesh::{Elements, HELD};
use crate::pencil::{Gap, Penalty, Pencil};
use crate::stability::Model;

/// Bodies, how they move at the start, and what pulls at them. Cheap to clone but for the vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct Encounter {
    pub(super) pencil: Pencil,
    pub(super) velocity: Vec<f64>,
    pub(super) load: Vec<f64>,
    pub(super) critical_step: f64,
}

impl Encounter {
    /// The encounter of `pencil` from u = 0 and v (m/s), under constant nodal forces f (N; empty for none). `critical_step`
    /// (s) is 2/omega_max without contact or less: what C = dt/dt_cr is measured in, and what the Park scheme refers to.
    ///
    /// # Errors
    /// Vectors that do not fit the pencil, numbers that are not finite, a step that is not positive.
    pub fn new(
        pencil: Pencil,
        velocity: Vec<f64>,
        load: Vec<f64>,
        critical_step: f64,
    ) -> Result<Self, Refusal> {
        let n = pencil.size();
        for (place, vector, allowed) in [
            ("velocity", &velocity, format!("{n} finite numbers")),
            ("load", &load, format!("no number, or {n} finite numbers")),
        ] {
            let fits = vector.len() == n || (place == "load" && vector.is_empty());
            if !fits || vector.iter().any(|x| !x.is_finite()) {
                return Err(Refusal::new(place, format!("{} numbers", vector.len()), allowed));
            }
        }
        if !(critical_step > 0.0 && critical_step.is_finite()) {
            return Err(Refusal::new("critical step", critical_step, "a positive finite number (s)"));
        }
        Ok(Self { pencil, velocity, load, critical_step })
    }

    /// The bars of a model as its scene has them thrown.
    ///
    /// # Errors
    /// A contact-free limit that is not certified.
    pub fn of_bars(model: &Model) -> Result<Self, Refusal> {
        let mesh = Mesh::new(model.scene());
        Self::new(model.pencil(), mesh.velocity(), mesh.load(), contact_free_step(model)?)
    }

    /// The same bodies with other initial gaps g0, m, one a contact; negative where open.
    ///
    /// # Errors
    /// A number of gaps that is not that of the contacts, and gaps that are not finite.
    pub fn with_gaps(self, initial: &[f64]) -> Result<Self, Refusal> {
        let known = self.pencil.gaps();
        if initial.len() != known.len() || initial.iter().any(|gap| !gap.is_finite()) {
            let allowed = format!("{} finite numbers, one a contact", known.len());
            return Err(Refusal::new("initial gaps", format!("{initial:?}"), allowed));
        }
        let gaps = known.iter().zip(initial).map(|(gap, initial)| Gap { initial: *initial, ..gap.clone() });
        Ok(Self { pencil: self.pencil.with_gaps(gaps.collect()), ..self })
    }

    /// The same bodies with another initial velocity, m/s.
    ///
    /// # Errors
    /// As [`Encounter::new`].
    pub fn with_velocity(self, velocity: Vec<f64>) -> Result<Self, Refusal> {
        Self::new(self.pencil, velocity, self.load, self.critical_step)
    }

    /// The same bodies under other constant nodal forces, N; empty for none.
    ///
    /// # Errors
    /// As [`Encounter::new`].
    pub fn with_load(self, load: Vec<f64>) -> Result<Self, Refusal> {
        Self::new(self.pencil, self.velocity, load, self.critical_step)
    }

    /// f, N; empty for none.
    pub fn load(&self) -> &[f64] {
        &self.load
    }

    /// K, M and the contacts.
    pub fn pencil(&self) -> &Pencil {
        &self.pencil
    }

    /// The initial velocity, m/s.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// dt_cr, s.
    pub fn critical_step(&self) -> f64 {
        self.critical_step
    }

    /// The penalty of all contacts for (beta_s, r).
    pub fn penalty(&self, beta_s: f64, ratio: f64) -> Penalty {
        Penalty { stiffness: beta_s, rate: ratio * self.pencil.reference(), ..Penalty::NONE }
    }
}

/// A vector of one value for each body and direction on the free unknowns.
pub(super) fn of_unknowns(elements: &Elements, of: impl Fn(usize) -> [f64; 3]) -> Vec<f64> {
    let d = elements.dimension;
    let mut vector = Vec::with_capacity(elements.unknowns());
    for (body, ends) in elements.first.windows(2).enumerate() {
        let value = of(body);
        let dofs = &elements.dofs[ends[0].0 * d..ends[1].0 * d];
        let free = dofs.iter().enumerate().filter(|(_, dof)| **dof != HELD);
        vector.extend(free.map(|(at, _)| value[at % d]));
    }
    vector
}

/// M b: without the share of supports, which take it themselves.
pub(super) fn weight(pencil: &Pencil, acceleration: &[f64]) -> Vec<f64> {
    let mut load = vec![0.0; pencil.size()];
    pencil.mass().multiply(acceleration, &mut load);
    load
}
