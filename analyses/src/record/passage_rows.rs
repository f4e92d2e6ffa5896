//! Rows of impacts of matrices and meshes, whose contacts are many.

use serde::Serialize;

use super::rows::softest_penalties;
use super::{HistoryRow, ImpactRow, Number};
use bipenalty::impact::{Comparison, Outcome, Passage, Summary};
use bipenalty::mesh::Place;
use bipenalty::pencil::Gap;
use bipenalty::schemes::Motion;

/// One step of all contacts together. In every row kinetic + strain + penalty energy + loss - body work is what it is in the
/// first, to rounding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PassageRow {
    /// s.
    pub time: Number,
    /// The sum of lambda over the contacts, N, positive in compression: the force between two bodies or on a wall where all
    /// contacts have one direction.
    pub contact_force: Number,
    /// The exact one, N; empty without an exact solution.
    pub exact_force: Option<Number>,
    /// The largest g, m, positive in penetration.
    pub largest_gap: Number,
    /// Contacts that are closed.
    pub closed: usize,
    /// J.
    pub kinetic_energy: Number,
    /// J.
    pub strain_energy: Number,
    /// Work that the bodies have done on the contacts, J.
    pub contact_work: Number,
    /// Held by the penalties of the closed contacts, J.
    pub penalty_energy: Number,
    /// Work of the loads since u = 0, J.
    pub body_work: Number,
    /// Lost by the scheme, J; negative is a gain.
    pub loss: Number,
}

impl PassageRow {
    /// The row of a motion that is synchronised.
    pub fn of(time: f64, motion: &mut dyn Motion, comparison: Option<&Comparison>) -> Self {
        let energy = motion.energy();
        let state = motion.state();
        Self {
            time: Number(time),
            contact_force: Number(state.force.iter().sum()),
            exact_force: comparison.map(|comparison| Number(comparison.expected(time))),
            largest_gap: Number(state.gap.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
            closed: state.closed.iter().filter(|closed| **closed).count(),
            kinetic_energy: Number(energy.kinetic),
            strain_energy: Number(energy.strain),
            contact_work: Number(energy.contact_work),
            penalty_energy: Number(energy.penalty),
            body_work: Number(energy.body_work),
            loss: Number(energy.loss),
        }
    }

    /// What a chart of histories draws of it: the resultant, and the largest gap in m.
    pub fn drawn(&self) -> HistoryRow {
        HistoryRow {
            time: self.time,
            contact_force: self.contact_force,
            relative_gap: self.largest_gap,
            kinetic_energy: self.kinetic_energy,
            strain_energy: self.strain_energy,
            contact_work: self.contact_work,
            penalty_energy: self.penalty_energy,
            body_work: self.body_work,
            loss: self.loss,
        }
    }
}

/// One contact at one step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContactRow {
    /// s.
    pub time: Number,
    /// From 1, in the order of the scene.
    pub contact: usize,
    /// lambda, N, positive in compression.
    pub contact_force: Number,
    /// g, m, positive in penetration.
    pub gap: Number,
}

impl ContactRow {
    /// The rows of a motion that is synchronised, contact by contact.
    pub fn of(time: f64, motion: &dyn Motion) -> impl Iterator<Item = Self> {
        let state = motion.state();
        let pairs = state.force.iter().zip(&state.gap).enumerate();
        pairs.map(move |(j, (force, gap))| Self {
            time: Number(time),
            contact: j + 1,
            contact_force: Number(*force),
            gap: Number(*gap),
        })
    }
}

/// Where a contact is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaceRow {
    /// From 1, in the order of the scene.
    pub contact: usize,
    /// m; empty for matrices, whose places nobody knows.
    pub x: Option<Number>,
    /// m.
    pub y: Option<Number>,
    /// m; empty in the plane.
    pub z: Option<Number>,
    /// The surface whose node it is, and what it touches.
    pub first: String,
    /// See `first`.
    pub second: String,
    /// w, N/m: what beta_s multiplies.
    pub scale: Number,
    /// g0, m, negative where open.
    pub initial_gap: Number,
}

impl PlaceRow {
    /// The rows of all contacts.
    pub fn of(gaps: &[Gap], places: Option<&[Place]>) -> Vec<Self> {
        let row = |(j, gap): (usize, &Gap)| {
            let place = places.and_then(|places| places.get(j));
            let at = |i: usize| Some(Number(place.filter(|place| i < place.dimension)?.coordinates[i]));
            let surface = |i: usize| place.map_or(String::new(), |place| place.surfaces[i].clone());
            Self {
                contact: j + 1,
                x: at(0),
                y: at(1),
                z: at(2),
                first: surface(0),
                second: surface(1),
                scale: Number(gap.scale),
                initial_gap: Number(gap.initial),
            }
        };
        gaps.iter().enumerate().map(row).collect()
    }
}

impl ImpactRow {
    /// The line of a passage with penalties (beta_s, r), compared with an exact solution where there is one.
    pub fn of_passage(
        (scene, mass): (&str, &str),
        passage: &Passage,
        (beta_s, ratio): (f64, f64),
        outcome: &Outcome,
        comparison: Option<Comparison>,
    ) -> Self {
        let accuracy = comparison.map(Comparison::finish).unwrap_or_default();
        let summary = Summary::new(accuracy, outcome.kept(), outcome.switches);
        let courant = passage.time_step() / passage.encounter().critical_step();
        let penalties = softest_penalties(passage.encounter().pencil(), beta_s, ratio);
        Self {
            scene: scene.to_owned(),
            mass: mass.to_owned(),
            scheme: passage.scheme().facts().name,
            stiffness_penalty: Number(beta_s),
            ratio: Number(ratio),
            relative_courant: Number(courant),
            time_step: Number(passage.time_step()),
            penalty_stiffness: penalties.map(|(stiffness, _)| stiffness),
            penalty_mass: penalties.map(|(_, mass)| mass),
            ..Self::measured(&summary, outcome.steps, outcome.ending)
        }
    }
}
