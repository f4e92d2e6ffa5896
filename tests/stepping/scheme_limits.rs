//! The limits of the predictor-corrector and the Park scheme with closed contact, by stepping.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::schemes::Scheme;
use bipenalty::stability::{Model, SchemeLimit};
use bipenalty::verify::{Confirmation, Point, Predictor, VISIBLE_GROWTH, confirm};
use rayon::prelude::*;

use super::common::numbers::Numbers;

const TOLERANCE: f64 = 1e-4;

/// What is stepped at one point.
struct Case {
    model: Model,
    theta: f64,
    at: Point,
}

/// Free bodies, fixed ends, unequal bars; every ratio from 1/30 to the pure penalty, eight decades of beta_s.
fn case(numbers: &mut Numbers) -> Case {
    let model = Model::new(numbers.scene(), numbers.mass(), PenaltyMass::Consistent);
    let (beta_s, ratio) = (10f64.powf(numbers.between(-2.0, 6.0)), 10f64.powf(numbers.between(-1.5, 1.5)));
    let ratio = numbers.one_of(&[ratio, ratio, 0.25, 1.0, f64::INFINITY]);
    let theta = numbers.one_of(&[0.0, 0.25, 0.5, 0.75, 1.0]);
    let at = Point {
        stiffness_penalty: StiffnessPenalty::new(beta_s).unwrap(),
        ratio: Ratio::new(ratio).unwrap(),
    };
    Case { model, theta, at }
}

/// Whether prediction and stepping agree; `None` where growth above the limit is too slow to be seen.
fn agrees(case: &Case, scheme: Scheme) -> Option<bool> {
    let Case { model, theta, at } = case;
    let pencil = model.pencil();
    let predictor = Predictor::new(model, &pencil, scheme, *theta).unwrap();
    let predicted = predictor.at(*at, TOLERANCE);
    if !predicted.is_visible() {
        println!("{scheme:?} {at:?}: growth {:?}, {:?} steps", predicted.growth, predicted.steps_needed);
        return None;
    }
    let Confirmation { found, agrees: verdict, .. } = confirm(&predictor, *at, TOLERANCE).unwrap();
    if verdict != Some(true) {
        println!("{scheme:?} theta = {theta} {at:?} {model:?}: {predicted:?}, found {found:?}");
    }
    verdict
}

#[test]
fn stepping_confirms_the_limits_of_two_hundred_random_points() {
    let mut numbers = Numbers(7);
    let cases: Vec<Case> = (0..200).map(|_| case(&mut numbers)).collect();
    for (scheme, least) in [(Scheme::PredictorCorrector, 120), (Scheme::Park, 190)] {
        let verdicts: Vec<_> = cases.par_iter().map(|case| agrees(case, scheme)).collect();
        let unseen = verdicts.iter().filter(|verdict| verdict.is_none()).count();
        println!("{scheme:?}: {} seen, {unseen} grow by less than {VISIBLE_GROWTH:e} a step", 200 - unseen);
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
            let scheme = Scheme::PredictorCorrector;
            let predictor = Predictor::new(&model, &pencil, scheme, 0.5).unwrap();
            // r is measured in the frequency of the elements; here in that of the contact-free bars.
            let top = SchemeLimit::new(&model, &pencil, scheme, 0.5).unwrap().contact_free().value;
            let (free, r) = (model.critical_courant(top), top / model.reference_eigenvalue());
            for (factor, kept) in [(0.25, 1.0), (0.26, (0.25_f64 / 0.26).sqrt())] {
                let at = Point {
                    stiffness_penalty: StiffnessPenalty::new(1e7).unwrap(),
                    ratio: Ratio::new(factor * r).unwrap(),
                };
                let predicted = predictor.at(at, TOLERANCE);
                assert!(
                    (predicted.courant / (kept * free) - 1.0).abs() < 1e-5,
                    "{predicted:?} {kept} {free}"
                );
                let found = confirm(&predictor, at, TOLERANCE).unwrap().found;
                println!("gamma = {gamma}, r = {}: {predicted:?}, {found:?}", factor * r);
                if predicted.is_visible() {
                    assert!(found.agrees(kept * free, TOLERANCE), "{found:?} is not {kept} of {free}");
                }
            }
        }
    }
}
