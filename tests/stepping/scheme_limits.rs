//! The limits of the predictor-corrector and the Park scheme with closed contact, by stepping.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::schemes::Scheme;
use bipenalty::stability::{Model, SchemeLimit};
use bipenalty::verify::{Confirmation, Point, Predictor, Search, confirm, limit_from};
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
    let Confirmation { found, agrees: verdict, .. } =
        confirm(model, scheme, *theta, *at, TOLERANCE, Some(predicted.clone())).unwrap();
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
            let scheme = Scheme::PredictorCorrector;
            let predictor = Predictor::new(&model, &pencil, scheme, 0.5).unwrap();
            // r is measured in the frequency of the elements; here in that of the contact-free bars.
            let top = SchemeLimit::new(&model, &pencil, scheme, 0.5).unwrap().contact_free().value;
            let (free, r) = (model.critical_courant(top), top / model.scales()[0].element_eigenvalue);
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
                let found =
                    confirm(&model, scheme, 0.5, at, TOLERANCE, Some(predicted.clone())).unwrap().found;
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
    for scheme in Scheme::ALL {
        cases.par_iter().for_each(|Case { model, theta, at }| {
            let pencil = model.pencil();
            let search = Search::to(1e-3, scheme).unwrap();
            let right = Predictor::new(model, &pencil, scheme, *theta).unwrap().at(*at, 1e-3).courant;
            let from = |first: f64| {
                let penalties = model.penalties(at.stiffness_penalty, at.ratio);
                let found = limit_from(first, model, scheme, *theta, penalties, &search).unwrap();
                (found.stable_at.to_bits(), found.unstable_at.to_bits())
            };
            for factor in [0.3, 0.99, 1.01, 3.0] {
                assert_eq!(from(right), from(factor * right), "{scheme:?} {factor} {theta} {at:?} {model:?}");
            }
        });
    }
}

/// A mass factor of its own for each contact makes coupled contacts circulatory: the bars flutter at every step, and
/// there is no limit to be found between those that grow fast enough to be seen and those that do not.
#[test]
#[ignore = "not reached: theta = 0 ends at a stable_at of 1e-5, where a trial is shorter than a swing of an element"]
fn flutter_has_no_stable_step() {
    let bar = |e: f64, rho: f64, n: usize| Bar {
        length: n as f64,
        elements: n,
        youngs_modulus: e,
        density: rho,
        area: 1.0,
        velocity: 0.0,
    };
    let bars = vec![bar(0.27, 0.064, 1), bar(0.016, 0.055, 1), bar(0.048, 0.035, 3)];
    let scene = Scene::new("flutter", End::Free, bars.clone(), End::Wall, None).unwrap();
    let model = Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent);
    let frequency = |left: usize, right: usize| {
        let of = |bar: &Bar| MassMatrix::CONSISTENT.element_eigenvalue(bar);
        of(&bars[left]).max(of(&bars[right]))
    };
    let (beta_s, ratio) = (StiffnessPenalty::new(1e4).unwrap(), Ratio::new(1.0).unwrap());
    let mut penalties = model.penalties(beta_s, ratio);
    for (penalty, (left, right)) in penalties.iter_mut().zip([(0, 1), (1, 2), (2, 2)]) {
        penalty.mass = penalty.stiffness / frequency(left, right);
    }
    for theta in [0.0, 0.5] {
        let search = Search::to(1e-3, Scheme::Park).unwrap();
        for first in [0.05, 0.40659, 1.0] {
            let found = limit_from(first, &model, Scheme::Park, theta, penalties.clone(), &search).unwrap();
            println!("theta = {theta}, from {first}: {found:?}");
            assert_eq!(found.stable_at, 0.0, "theta = {theta}: {found:?}");
        }
    }
}
