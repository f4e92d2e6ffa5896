//! Impacts at the ends of velocity, gap and stiffness penalty: force and gap after a few steps of a bar of 8 unit
//! elements before a wall, at C = 1/2 with r = 1, against the textbook formulas in extended precision.
//!
//! The allowed error is 64 N u after N steps: about 64 roundings reach a node in a step, and a stable step passes them on
//! without growth.

use super::case::{Case, Found};
use super::short;
use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Ending, Recording, Run, Summary};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{Bar, End, Impact, Scene};
use bipenalty::schemes::SchemeName;
use bipenalty::spectrum::UNIT_ROUNDOFF;
use bipenalty::stability::Model;

const ELEMENTS: usize = 8;

/// A short impact.
#[derive(Debug, Clone)]
struct Shot {
    name: String,
    scheme: SchemeName,
    gamma: f64,
    beta_s: f64,
    /// Initial distance of the wall, m; negative in penetration.
    distance: f64,
    /// Initial velocity, m/s.
    velocity: f64,
    steps: usize,
}

/// The extreme impacts.
pub(super) fn cases() -> Vec<Case> {
    SchemeName::PAPER.into_iter().flat_map(shots).flat_map(Shot::cases).collect()
}

fn shots(scheme: SchemeName) -> Vec<Shot> {
    let name = scheme.name();
    let shot = |what: &str, beta_s, distance, velocity, steps| Shot {
        name: format!("{what}-{name}"),
        scheme,
        gamma: 1.0,
        beta_s,
        distance,
        velocity,
        steps,
    };
    let mut shots = Vec::new();
    for gamma in [0.0, 1.0] {
        let stiff = shot("", 1e16, 0.0, 0.1, 12);
        shots.push(Shot { name: format!("stiffest-contact-{name}-gamma-{}", short(gamma)), gamma, ..stiff });
    }
    shots.push(shot("grazing-contact", 1e4, 1e-300, 1e-300, 12));
    shots.push(shot("penetration-at-rest", 1e4, -1e-300, 0.0, 5));
    shots.push(shot("distance-at-rest", 1e4, 1e-300, 0.0, 12));
    for velocity in [1e-150, 1e150] {
        shots.push(shot(&format!("impact-at-{}", short(velocity)), 1e4, 0.0, velocity, 12));
    }
    shots
}

impl Shot {
    /// Force and gap at the end.
    fn cases(self) -> [Case; 2] {
        let name = self.name.clone();
        let scheme = self.scheme.name();
        let other = self.clone();
        let case = |quantity, compute| Case {
            name: name.clone(),
            quantity,
            by: scheme,
            formula: "64 N u",
            refusal: None,
            compute,
        };
        [
            case("contact force", Box::new(move || self.run().map(|(force, _)| self.found(force)))),
            case("gap", Box::new(move || other.run().map(|(_, gap)| other.found(gap)))),
        ]
    }

    fn found(&self, value: f64) -> Found {
        Found { value, allowed: 64.0 * self.steps as f64 * UNIT_ROUNDOFF, enclosure: None }
    }

    /// Contact force, N, and gap, m, at the end.
    fn run(&self) -> Result<(f64, f64), String> {
        let run = run(self.scheme, self.gamma, self.beta_s, self.distance, self.velocity)?;
        let duration = self.steps as f64 * run.time_step();
        let run = run.with_duration(duration).map_err(text)?;
        let history = run.execute(&Recording::default(), None).map_err(text)?;
        if history.ending != Ending::Finished {
            return Err(format!("the run ended as {:?}", history.ending));
        }
        let summary = Summary::of(&run, &history);
        let numbers = [summary.force_error, summary.steady_relative_gap, summary.energy_ratio];
        if let Some(number) = numbers.iter().flatten().find(|number| !number.is_finite()) {
            return Err(format!("the summary holds {number}: {summary:?}"));
        }
        let last = |values: Option<f64>| values.ok_or_else(|| "no row".to_owned());
        // Elements of length 1: g/h is g.
        Ok((last(history.forces(0).last())?, last(history.relative_gaps(0).last())?))
    }
}

/// The bar of 8 unit elements before a wall.
pub(super) fn run(
    scheme: SchemeName,
    gamma: f64,
    beta_s: f64,
    distance: f64,
    velocity: f64,
) -> Result<Run, String> {
    let bar = Bar { velocity, ..Bar::unit(ELEMENTS) };
    let impact = Impact { duration: 1.0, gaps: vec![distance], gravity: 0.0 };
    let scene = Scene::new("shot", End::Free, vec![bar], End::Wall, Some(impact)).map_err(text)?;
    let mass = MassMatrix::new(gamma).map_err(text)?;
    let model = Model::new(scene, mass, PenaltyMass::Consistent);
    let beta_s = StiffnessPenalty::new(beta_s).map_err(text)?;
    Run::new(model, scheme, beta_s, Ratio::OPTIMAL).map_err(text)
}

fn text(error: impl ToString) -> String {
    error.to_string()
}
