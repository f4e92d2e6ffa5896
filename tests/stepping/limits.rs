//! Limits found by stepping against the certified limits of the spectrum and the closed forms of the schemes.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{End, Scene, built_in};
use bipenalty::schemes::{CentralDifference, Park, PredictorCorrector};
use bipenalty::stability::Model;
use bipenalty::verify::{Point, Search, largest_stable_courant, limits};

use super::{MASSES, unit_bar};

fn point(beta_s: f64, ratio: f64) -> Point {
    Point { stiffness_penalty: StiffnessPenalty::new(beta_s).unwrap(), ratio: Ratio::new(ratio).unwrap() }
}

fn model(scene: &str, elements: usize, mass: MassMatrix) -> Model {
    let scene = built_in(scene).unwrap().unwrap().with_elements(elements).unwrap();
    Model::new(scene, mass, PenaltyMass::Consistent)
}

fn predicted(model: &Model, point: Point) -> f64 {
    let penalty = model.penalty(point.stiffness_penalty, point.ratio);
    model.critical_courant(model.closed_form().unproven(&penalty))
}

/// The largest relative distance between prediction and the middle of the bracket.
fn worst(model: &Model, points: &[Point], tolerance: f64) -> f64 {
    let search = Search::to(tolerance, &CentralDifference).unwrap();
    let found = limits(model, &CentralDifference, points, &search).unwrap();
    let error = |(point, limit): (&Point, &bipenalty::verify::Limit)| {
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
fn predictor_corrector_limit(model: &Model, at: Point) -> f64 {
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
    let check = |model: &Model, at: Point, expected: f64| {
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

#[test]
fn impossible_searches_are_refused() {
    for tolerance in [0.0, -1.0, f64::NAN, 0.5, 1e-13] {
        assert!(Search::to(tolerance, &CentralDifference).is_err(), "{tolerance}");
    }
    assert!(Search::to(1e-8, &Park::USUAL).is_err());
}
