//! Contacts that a bar couples, under penalties as stiff as anyone will use.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Penalty;
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::schemes::{CentralDifference, ContactRule, Scheme, SchemeName, System};
use bipenalty::stability::Model;
use bipenalty::verify::{PenaltyPoint, Predictor, confirm};
use rayon::prelude::*;

use super::common::numbers::Numbers;

fn element(youngs_modulus: f64, density: f64, area: f64) -> Bar {
    Bar { length: 1.0, elements: 1, youngs_modulus, density, area, velocity: 0.0 }
}

/// One consistent element between two walls. Of each contact q = dt^2 s mu is below 1, of both together up to 1.5: there
/// a rounding that sets gap, gap rate and the gap before apart would grow by 1.4 a step.
#[test]
fn central_differences_of_coupled_contacts_keep_their_energy() {
    let scene = Scene::new("pressed", End::Wall, vec![element(1.0, 1.0, 1.0)], End::Wall, None).unwrap();
    let model = Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent);
    let (pencil, beta_s) = (model.pencil(), 1e4);
    // G = 1/m [4 2; 2 4] with m = rho h A = 1 and gaps -u_1, u_2.
    for largest in [0.9, 1.1, 1.4] {
        let system = System {
            pencil: &pencil,
            penalty: Penalty { stiffness: beta_s, ..Penalty::NONE },
            load: Vec::new(),
            time_step: (largest / (6.0 * beta_s)).sqrt(),
            critical_step: 1.0,
            rule: ContactRule::HeldClosed,
            account: false,
        };
        let mut motion = CentralDifference.start(system, vec![0.0; 2], vec![0.3, 1.0]).unwrap();
        let start = motion.energy().stored();
        let most = (0..2000).map(|_| {
            motion.step();
            motion.energy().stored() / start
        });
        let most = most.fold(0.0, f64::max);
        println!("q = {largest}: at most {most} of the energy");
        // dt^2 l <= 4 (largest/4)(1 + 2/beta_s): the size of a mode stays below 1/(1 - dt^2 l/4) of its start.
        assert!(most <= 1.0 / (1.0 - 0.26 * largest), "q = {largest}: {most}");
    }
}

/// Two to four bars, one or two elements between contacts, beta_s from 1e2 to 1e12, r from 0.1 to inf.
#[test]
fn stepping_finds_the_limits_of_stiff_coupled_contacts() {
    let mut numbers = Numbers(31);
    let points: Vec<_> = (0..48).map(|_| stiff(&mut numbers)).collect();
    let verdicts: Vec<_> = points.par_iter().flat_map_iter(judge).collect();
    let count = |verdict| verdicts.iter().filter(|found| **found == verdict).count();
    println!("{} agree, {} are not judged", count(Some(true)), count(None));
    assert_eq!(count(Some(false)), 0);
    assert!(count(Some(true)) > 2 * count(None));
}

fn stiff(numbers: &mut Numbers) -> (Model, f64, PenaltyPoint) {
    let bars = (0..2 + (3.0 * numbers.next()) as usize).map(|_| {
        let mut any = || 10f64.powf(numbers.between(-1.5, 1.5));
        let (bar, elements) = (element(any(), any(), any()), 1 + usize::from(any() > 1.0));
        Bar { elements, length: elements as f64, ..bar }
    });
    let bars = bars.collect();
    let ends = [End::Free, End::Wall];
    let scene = Scene::new("row", numbers.one_of(&ends), bars, numbers.one_of(&ends), None).unwrap();
    let mass = MassMatrix::new(numbers.one_of(&[0.0, 0.5, 1.0])).unwrap();
    let at = PenaltyPoint {
        stiffness_penalty: StiffnessPenalty::new(10f64.powf(numbers.between(2.0, 12.0))).unwrap(),
        ratio: Ratio::new(numbers.one_of(&[0.1, 0.25, 0.5, 0.9, 1.0, 4.0, f64::INFINITY])).unwrap(),
    };
    (Model::new(scene, mass, PenaltyMass::Consistent), numbers.one_of(&[0.0, 0.5, 1.0]), at)
}

fn judge((model, theta, at): &(Model, f64, PenaltyPoint)) -> Vec<Option<bool>> {
    let pencil = model.pencil();
    let tolerances = [1e-2, 1e-4, 1e-6].map(|tolerance| (SchemeName::CentralDifference, tolerance));
    let others = [SchemeName::PredictorCorrector, SchemeName::Park].map(|scheme| (scheme, 1e-2));
    let verdict = |(scheme, tolerance): (SchemeName, f64)| {
        let scheme = &*scheme.with_theta(*theta).unwrap();
        let predicted = Predictor::new(model, &pencil, scheme).unwrap().at(*at, tolerance).unwrap();
        let found = confirm(model, scheme, *at, tolerance, Some(predicted.clone())).unwrap();
        if found.agrees == Some(false) {
            println!("{scheme:?} to {tolerance}, {at:?}, {model:?}: {predicted:?}, {:?}", found.found);
        }
        found.agrees
    };
    tolerances.into_iter().chain(others).map(verdict).collect()
}
