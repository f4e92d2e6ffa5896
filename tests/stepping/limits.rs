//! Limits found by stepping against the certified limits of the spectrum and the closed forms of the schemes.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{Bar, End, Scene, built_in};
use bipenalty::schemes::{CentralDifference, Park, PredictorCorrector, SchemeName};
use bipenalty::spectrum::Evidence;
use bipenalty::stability::Model;
use bipenalty::verify::{
    PenaltyPoint, Prediction, Predictor, Search, confirm, largest_stable_courant, limits,
};

use super::{MASSES, unit_bar};

fn point(beta_s: f64, ratio: f64) -> PenaltyPoint {
    PenaltyPoint {
        stiffness_penalty: StiffnessPenalty::new(beta_s).unwrap(),
        ratio: Ratio::new(ratio).unwrap(),
    }
}

fn model(scene: &str, elements: usize, mass: MassMatrix) -> Model {
    let scene = built_in(scene).unwrap().unwrap().with_elements(elements).unwrap();
    Model::new(scene, mass, PenaltyMass::Consistent)
}

fn predicted(model: &Model, point: PenaltyPoint) -> f64 {
    let penalty = model.penalty(point.stiffness_penalty, point.ratio);
    model.critical_courant(model.closed_form().unproven(&penalty))
}

/// The largest relative distance between prediction and the middle of the bracket.
fn worst(model: &Model, points: &[PenaltyPoint], tolerance: f64) -> f64 {
    let search = Search::to(tolerance, &CentralDifference).unwrap();
    let found = limits(model, &CentralDifference, points, &search).unwrap();
    let error = |(point, limit): (&PenaltyPoint, &bipenalty::verify::Bracket)| {
        (limit.courant() / predicted(model, *point) - 1.0).abs()
    };
    points.iter().zip(&found).map(error).fold(0.0, f64::max)
}

#[test]
fn central_differences_have_the_limit_of_the_spectrum_on_the_curves_of_the_paper() {
    let ratios = [1.0, 2.0, 3.0, f64::INFINITY];
    let points: Vec<_> =
        ratios.iter().flat_map(|r| (0..=20).map(|i| point(0.5 * f64::from(i), *r))).collect();
    for scene in ["signorini", "symmetric"] {
        for mass in MASSES {
            let error = worst(&model(scene, 1, mass), &points, 4e-7);
            println!("{scene}, {}: {error:.2e}", mass.name());
            assert!(error <= 1e-6, "{scene}, {}: {error:e}", mass.name());
        }
    }
}

#[test]
fn central_differences_have_the_limit_of_the_spectrum_on_a_map() {
    let log = |i: i32, from: f64, to: f64| 10_f64.powf(from + (to - from) * f64::from(i) / 19.0);
    let points: Vec<_> =
        (0..20).flat_map(|i| (0..20).map(move |j| point(log(i, -2.0, 6.0), log(j, -1.0, 3.0)))).collect();
    for mass in MASSES {
        let start = std::time::Instant::now();
        let error = worst(&model("signorini", 100, mass), &points, 5e-5);
        println!("{}: {error:.2e} in {:.1} s", mass.name(), start.elapsed().as_secs_f64());
        assert!(error <= 1e-4, "{}: {error:e}", mass.name());
    }
}

/// dt^2 = m/s + 1/(s mu), or the contact-free limit if that is smaller.
fn predictor_corrector_limit(model: &Model, at: PenaltyPoint) -> f64 {
    let pencil = model.pencil();
    let p = model.penalty(at.stiffness_penalty, at.ratio).terms(model.scales()[0]);
    let dt_squared = p.mass / p.stiffness + 1.0 / (p.stiffness * pencil.chain().unwrap().compliance()[0]);
    let courant = (dt_squared * model.reference_rate()).sqrt();
    courant.min(predicted(model, point(0.0, 1.0)))
}

#[test]
fn the_predictor_corrector_scheme_has_its_own_limit() {
    let scheme = &PredictorCorrector;
    let search = Search::to(1e-4, scheme).unwrap();
    let check = |model: &Model, at: PenaltyPoint, expected: f64| {
        let limit = largest_stable_courant(model, scheme, at, &search).unwrap();
        println!("{} {at:?}: {limit:?}, expected {expected}", model.scene().name());
        assert!(limit.agrees(expected, 1e-4), "{limit:?} instead of {expected}");
    };
    for (beta_s, expected) in [(1.0, 0.8660254), (2.0, 0.5_f64.sqrt()), (10.0, 0.54772256), (1e4, 0.50005)] {
        let model = model("signorini", 4, MassMatrix::LUMPED);
        check(&model, point(beta_s, 1.0), expected);
    }
    // 0.52808 is dt over the contact-free critical step, at which C = 1/sqrt(3).
    check(&model("signorini", 7, MassMatrix::CONSISTENT), point(30.0, 1.0), 0.52808 / 3.0_f64.sqrt());
    for mass in MASSES {
        let model = model("signorini", 10, mass);
        let at = point(1e4, 0.25);
        check(&model, at, predictor_corrector_limit(&model, at));
        let free = predicted(&model, point(0.0, 1.0));
        assert!((predictor_corrector_limit(&model, at) / free - 1.0).abs() < 1e-12);
    }
}

#[test]
fn rigid_motion_of_free_bodies_is_not_growth() {
    let bars = vec![unit_bar(5, 0.0), unit_bar(10, 0.0)];
    let scene = Scene::new("free", End::Free, bars, End::Free, None).unwrap();
    let model = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent);
    let search = Search::to(1e-4, &PredictorCorrector).unwrap();
    let limit = largest_stable_courant(&model, &PredictorCorrector, point(1.0, 1.0), &search).unwrap();
    println!("{limit:?}");
    assert!(limit.agrees(0.5_f64.sqrt(), 1e-4), "{limit:?}");
}

#[test]
fn the_park_scheme_has_its_own_limit() {
    let search = Search::to(1e-4, &Park::USUAL).unwrap();
    let model = model("signorini", 10, MassMatrix::LUMPED);
    let limit = largest_stable_courant(&model, &Park::USUAL, point(1e4, 1.0), &search).unwrap();
    println!("{limit:?}");
    assert!(limit.agrees(0.7072, 1e-4), "{limit:?}");
}

/// A trial of 1e5 steps ends within a swing of the bar here; read as growth, its rise put the limit at 3.49e-6.
#[test]
fn the_beginning_of_a_swing_is_not_growth() {
    let model = model("signorini", 4, MassMatrix::LUMPED);
    let search = Search::to(1e-3, &Park::USUAL).unwrap();
    let limit = largest_stable_courant(&model, &Park::USUAL, point(1e6, f64::INFINITY), &search).unwrap();
    println!("{limit:?}");
    assert!(limit.agrees(5.99989e-6, 1e-3), "{limit:?}");
}

/// Three unlike bars on a wall, whose predictor-corrector limit is known from below only.
#[test]
fn unlike_contacts_have_limits_of_central_differences_and_of_park() {
    let bar = |elements: usize, density: f64| Bar { density, ..Bar::unit(elements) };
    let bars = vec![bar(3, 1.0), bar(1, 4.0), bar(2, 2.0)];
    let scene = Scene::new("three", End::Free, bars, End::Wall, None).unwrap();
    for mass in MASSES {
        let model = Model::new(scene.clone(), mass, PenaltyMass::Consistent);
        let pencil = model.pencil();
        for at in [point(3.0, 1.0), point(300.0, 1.0), point(1e4, f64::INFINITY)] {
            for (scheme, tolerance) in [(SchemeName::CentralDifference, 1e-6), (SchemeName::Park, 1e-4)] {
                let scheme = scheme.with_theta(0.5).unwrap();
                let predicted = Predictor::new(&model, &pencil, &*scheme).unwrap().at(at, tolerance).unwrap();
                assert_eq!(predicted.evidence, Evidence::Proven, "{at:?}");
                let found = confirm(&model, &*scheme, at, tolerance, Some(predicted.clone())).unwrap();
                println!("{} {at:?}: {predicted:?}, {:?}", mass.name(), found.found);
                assert_eq!(found.agrees, Some(true), "{predicted:?}, {:?}", found.found);
                // A prediction that is 1 % off is not confirmed, on either side.
                for factor in [0.99, 1.01] {
                    let wrong = Prediction { courant: factor * predicted.courant, ..predicted.clone() };
                    let judged = confirm(&model, &*scheme, at, tolerance, Some(wrong)).unwrap();
                    assert_eq!((judged.agrees, judged.found.stable_at), (Some(false), found.found.stable_at));
                }
            }
            let scheme = &PredictorCorrector;
            let predictor = Predictor::new(&model, &pencil, scheme).unwrap();
            assert_eq!(predictor.at(at, 1e-4).unwrap().evidence, Evidence::LowerBound);
        }
    }
}

#[test]
fn impossible_searches_are_refused() {
    for tolerance in [0.0, -1.0, f64::NAN, 0.5, 1e-13] {
        assert!(Search::to(tolerance, &CentralDifference).is_err(), "{tolerance}");
    }
    assert!(Search::to(1e-8, &Park::USUAL).is_err());
}
