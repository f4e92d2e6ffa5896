//! The limits of the predictor-corrector and the Park scheme with closed contact, by stepping.

use bipenalty::error::Refusal;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::{Penalty, Pencil};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::schemes::{
    Body, CentralDifference, Energy, Facts, Motion, Onset, PredictorCorrector, Scheme, SchemeName, State,
    System,
};
use bipenalty::spectrum::{Engine, StepLimit};
use bipenalty::stability::Model;
use bipenalty::verify::{Confirmation, PenaltyPoint, Predictor, Search, confirm, limit_from};
use rayon::prelude::*;

use super::common::numbers::Numbers;

const TOLERANCE: f64 = 1e-4;

/// What is stepped at one point.
struct Case {
    model: Model,
    theta: f64,
    at: PenaltyPoint,
}

/// Free bodies, fixed ends, unequal bars; every ratio from 1/30 to the pure penalty, eight decades of beta_s.
fn case(numbers: &mut Numbers) -> Case {
    let model = Model::new(numbers.scene(), numbers.mass(), PenaltyMass::Consistent);
    let (beta_s, ratio) = (10f64.powf(numbers.between(-2.0, 6.0)), 10f64.powf(numbers.between(-1.5, 1.5)));
    let ratio = numbers.one_of(&[ratio, ratio, 0.25, 1.0, f64::INFINITY]);
    let theta = numbers.one_of(&[0.0, 0.25, 0.5, 0.75, 1.0]);
    let at = PenaltyPoint {
        stiffness_penalty: StiffnessPenalty::new(beta_s).unwrap(),
        ratio: Ratio::new(ratio).unwrap(),
    };
    Case { model, theta, at }
}

/// Whether prediction and stepping agree; `None` where growth above the limit is too slow to be seen.
fn agrees(case: &Case, scheme: SchemeName) -> Option<bool> {
    let Case { model, theta, at } = case;
    let pencil = model.pencil();
    let scheme = scheme.with_theta(*theta).unwrap();
    let predictor = Predictor::new(model, &pencil, &*scheme).unwrap();
    let predicted = predictor.at(*at, TOLERANCE).unwrap();
    let Confirmation { found, agrees: verdict, .. } =
        confirm(model, &*scheme, *at, TOLERANCE, Some(predicted.clone())).unwrap();
    if verdict != Some(true) {
        println!("{scheme:?} theta = {theta} {at:?} {model:?}: {predicted:?}, found {found:?}");
    }
    verdict
}

#[test]
fn stepping_confirms_the_limits_of_two_hundred_random_points() {
    let mut numbers = Numbers(7);
    let cases: Vec<Case> = (0..200).map(|_| case(&mut numbers)).collect();
    for (scheme, least) in [(SchemeName::PredictorCorrector, 120), (SchemeName::Park, 190)] {
        let verdicts: Vec<_> = cases.par_iter().map(|case| agrees(case, scheme)).collect();
        let unseen = verdicts.iter().filter(|verdict| verdict.is_none()).count();
        println!("{scheme:?}: {} seen, {unseen} grow too slowly", 200 - unseen);
        assert!(!verdicts.contains(&Some(false)), "{scheme:?} disagrees");
        assert!(200 - unseen >= least, "{scheme:?}: {unseen} not seen");
    }
}

/// r = 1/4 keeps the contact-free step of the predictor-corrector, r = 0.26 does not: C^2 = 1/(4 r) for large beta_s.
#[test]
fn a_quarter_keeps_the_contact_free_step_and_a_little_more_does_not() {
    let mut numbers = Numbers(5);
    for gamma in [0.0, 0.5, 1.0] {
        for _ in 0..4 {
            let model = Model::new(numbers.scene(), MassMatrix::new(gamma).unwrap(), PenaltyMass::Consistent);
            let pencil = model.pencil();
            let scheme = &PredictorCorrector;
            let predictor = Predictor::new(&model, &pencil, scheme).unwrap();
            // r is measured in the frequency of the elements; here in that of the contact-free bars.
            let top = predictor.contact_free();
            let (free, r) = (model.critical_courant(top), top / model.reference_eigenvalue());
            for (factor, kept) in [(0.25, 1.0), (0.26, (0.25_f64 / 0.26).sqrt())] {
                let at = PenaltyPoint {
                    stiffness_penalty: StiffnessPenalty::new(1e7).unwrap(),
                    ratio: Ratio::new(factor * r).unwrap(),
                };
                let predicted = predictor.at(at, TOLERANCE).unwrap();
                assert!(
                    (predicted.courant / (kept * free) - 1.0).abs() < 1e-5,
                    "{predicted:?} {kept} {free}"
                );
                let found = confirm(&model, scheme, at, TOLERANCE, Some(predicted.clone())).unwrap().found;
                println!("gamma = {gamma}, r = {}: {predicted:?}, {found:?}", factor * r);
                if predicted.is_visible(Search::to(TOLERANCE, scheme).unwrap().steps) {
                    assert!(found.agrees(kept * free, TOLERANCE), "{found:?} is not {kept} of {free}");
                }
            }
        }
    }
}

/// A search that begins at a wrong prediction ends where one does that begins at the right one, to the last bit.
#[test]
fn wrong_predictions_do_not_move_what_stepping_finds() {
    let mut numbers = Numbers(11);
    let cases: Vec<Case> = (0..12).map(|_| case(&mut numbers)).collect();
    for scheme in SchemeName::ALL {
        cases.par_iter().for_each(|Case { model, theta, at }| {
            let pencil = model.pencil();
            let scheme = &*scheme.with_theta(*theta).unwrap();
            let search = Search::to(1e-3, scheme).unwrap();
            let right = Predictor::new(model, &pencil, scheme).unwrap().at(*at, 1e-3).unwrap().courant;
            let from = |first: f64| {
                let penalty = model.penalty(at.stiffness_penalty, at.ratio);
                let found = limit_from(first, model, scheme, penalty, &search).unwrap();
                (found.stable_at.to_bits(), found.unstable_at.to_bits())
            };
            for factor in [0.3, 0.99, 1.01, 3.0] {
                assert_eq!(from(right), from(factor * right), "{scheme:?} {factor} {theta} {at:?} {model:?}");
            }
        });
    }
}

/// Central differences with a circulatory force: two equal bodies, each pushed by what the other's displacement is, with
/// opposite signs. Every mode flutters, at every step.
#[derive(Debug)]
struct Circulatory;

struct Fluttering {
    body: Body,
    state: State,
    kick: Vec<f64>,
}

impl Scheme for Circulatory {
    fn facts(&self) -> Facts {
        Facts { onset: Onset::Linear, ..CentralDifference.facts() }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        let body = Body::new(&system, system.time_step)?;
        let state = State::new(&body.contacts, u, v, body.dt);
        Ok(Box::new(Fluttering { kick: vec![0.0; body.pencil.size()], body, state }))
    }

    fn limit<'a>(&self, _: &'a Pencil, _: Box<dyn Engine + 'a>) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        Err(Refusal::new("limit", "circulatory", "a scheme with a limit"))
    }
}

impl Motion for Fluttering {
    fn step(&mut self) {
        let Self { body, state, kick } = self;
        body.operator.apply(&state.displacement, kick);
        let half = kick.len() / 2;
        for i in 0..half {
            kick[i] += 0.01 * body.dt * state.displacement[i + half];
            kick[i + half] -= 0.01 * body.dt * state.displacement[i];
        }
        body.operator.drift(body.dt, kick, &mut state.velocity, &mut state.displacement);
        state.steps += 1;
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn energy(&mut self) -> Energy {
        self.body.energy(&self.state, &self.state.velocity)
    }
}

/// There is no limit to be found between the steps that grow fast enough to be seen and those that do not.
#[test]
fn flutter_has_no_stable_step() {
    let bar = Bar::unit(3);
    let scene = Scene::new("flutter", End::Free, vec![bar.clone(), bar], End::Free, None).unwrap();
    let model = Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent);
    let search = Search::to(1e-3, &Circulatory).unwrap();
    for first in [0.05, 0.40659, 1.0] {
        let found = limit_from(first, &model, &Circulatory, Penalty::NONE, &search).unwrap();
        println!("from {first}: {found:?}");
        assert_eq!(found.stable_at, 0.0, "{found:?}");
    }
}
