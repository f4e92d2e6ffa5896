//! Steps that lagging damping allows: against amplification matrices, against exact definiteness, and by stepping.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::{AtomicUsize, Ordering};

#[path = "damping/amplification.rs"]
mod amplification;
#[path = "common/conformance/mod.rs"]
#[macro_use]
mod conformance;
#[path = "common/definite.rs"]
mod definite;
#[path = "common/double_double.rs"]
mod double_double;
#[path = "damping/energy.rs"]
mod energy;
#[path = "damping/exact.rs"]
mod exact;
#[path = "damping/meshes.rs"]
mod meshes;
#[path = "common/numbers.rs"]
mod numbers;
#[path = "damping/predictor_corrector.rs"]
mod predictor_corrector;
#[path = "damping/scenes.rs"]
mod scenes;

use bipenalty::damping::{DampedLimit, Damping};
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::{Bounds, Matrix, Penalty, Pencil};
use bipenalty::scene::End;
use bipenalty::schemes::{
    DampedCentralDifference, DampedPredictorCorrector, SchemeName, damped, damped_limit,
};
use bipenalty::spectrum::{Dense, Enclosure, Engine, Evidence, StepLimit, Sturm, Uncertified, engine};

scheme_conformance! {
    undamped => DampedCentralDifference::default();
    by_mass => DampedCentralDifference::new(Damping::new(0.05, 0.0, 0.0).unwrap());
    by_stiffness => DampedCentralDifference::new(Damping::new(0.0, 0.2, 0.0).unwrap());
    by_contact => DampedCentralDifference::new(Damping::new(0.0, 0.0, 0.1).unwrap());
    by_all => DampedCentralDifference::new(Damping::new(0.1, 0.05, 0.3).unwrap());
    predicted_undamped => DampedPredictorCorrector::default();
    predicted_by_bodies => DampedPredictorCorrector::new(Damping::new(0.1, 0.05, 0.0).unwrap());
    predicted_by_all => DampedPredictorCorrector::new(Damping::new(0.1, 0.05, 0.3).unwrap());
}

fn damping(mass: f64, stiffness: f64, contact: f64) -> Damping {
    Damping::new(mass, stiffness, contact).unwrap()
}

/// A mass on a spring: h = (2/omega)(sqrt(1 + xi^2) - xi), also where 1 + xi^2 is xi^2.
#[test]
fn one_mode_has_the_textbook_limit() {
    let (k, m) = (3.0_f64, 0.7);
    let bounds = Bounds { stiffness: k / m * (1.0 + 1e-15), mass: 1.0 };
    let pencil = Pencil::new(Matrix::Diagonal(vec![k]), Matrix::Diagonal(vec![m]), Vec::new(), bounds, k / m);
    let pencil = pencil.unwrap();
    let omega = (k / m).sqrt();
    for xi in [0.0, 1e-9, 1e-3, 0.1, 1.0, 30.0, 1e4, 1e9] {
        // 2/omega (sqrt(1 + xi^2) - xi) without its cancellation.
        let expected = 2.0 / omega / (f64::hypot(1.0, xi) + xi);
        for damping in [damping(2.0 * xi * omega, 0.0, 0.0), damping(0.0, 2.0 * xi / omega, 0.0)] {
            let limit = DampedLimit::new(&pencil, Box::new(Dense::new(&pencil).unwrap()), damping);
            let step = limit.enclose(&Penalty::NONE, None).unwrap();
            assert_eq!(step.evidence, Evidence::Proven, "{damping:?}");
            let slack = 8.0 * f64::EPSILON;
            assert!(step.lower() * (1.0 - slack) <= expected && expected <= step.upper() * (1.0 + slack));
            assert!((step.seconds() / expected - 1.0).abs() < 1e-12, "{damping:?}: {step:?} {expected}");
        }
    }
}

/// No damping is the engine's own enclosure, digit for digit.
#[test]
fn without_damping_it_is_the_spectrum() {
    let mut numbers = numbers::Numbers(3);
    for _ in 0..20 {
        let (pencil, penalty) = scenes::bars(&mut numbers);
        let own = engine(&pencil).unwrap().enclose(&penalty, None).unwrap();
        let limit = DampedLimit::new(&pencil, engine(&pencil).unwrap(), Damping::NONE);
        assert_eq!(limit.enclose(&penalty, None).unwrap().l, own);
    }
}

/// Any engine finds the same, and more damping of any kind never allows a larger step.
#[test]
fn engines_agree_and_damping_never_helps() {
    let mut numbers = numbers::Numbers(17);
    for _ in 0..60 {
        let (pencil, penalty) = scenes::bars(&mut numbers);
        let damping = scenes::damping(&mut numbers, &pencil);
        let of =
            |damping: Damping, engine| DampedLimit::new(&pencil, engine, damping).enclose(&penalty, None);
        let chain = pencil.chain().unwrap();
        let found = of(damping, engine(&pencil).unwrap()).unwrap();
        let other = of(damping, Box::new(Sturm::new(chain))).unwrap();
        assert!(found.l.lower <= other.l.upper && other.l.lower <= found.l.upper, "{found:?} {other:?}");
        // The engine certifies 2e-13 of l_max, of which l has at most the double.
        assert!(found.l.relative_width() < 4.1e-13 && found.l.lower <= found.l.value, "{found:?}");
        for (i, factor) in [(0, 1.5), (1, 1.5), (2, 1.5)] {
            let mut parts = [damping.mass(), damping.stiffness(), damping.contact()];
            parts[i] *= factor;
            let more = Damping::new(parts[0], parts[1], parts[2]).unwrap();
            let less = of(more, engine(&pencil).unwrap()).unwrap();
            assert!(less.lower() <= found.upper(), "{damping:?} {more:?}: {found:?} {less:?}");
        }
    }
}

/// Contacts that hold every unknown, with masses far above those of the bar: the limit may lie above 2/A, and only
/// that much is said.
#[test]
fn where_contacts_hold_all_only_a_lower_bound_is_known() {
    let between = |elements| scenes::model(End::Wall, elements, MassMatrix::LUMPED, End::Wall);
    let model = between(1);
    let (pencil, rate) = (model.pencil(), 1e-4 * model.reference_eigenvalue());
    let penalty = Penalty { stiffness: 10.0, rate, form: PenaltyMass::Consistent };
    let heavy = damping(100.0, 0.0, 0.0);
    let limit = DampedLimit::new(&pencil, engine(&pencil).unwrap(), heavy);
    let step = limit.enclose(&penalty, None).unwrap();
    assert_eq!((step.evidence, step.upper()), (Evidence::LowerBound, f64::INFINITY));
    assert!((step.lower() * 100.0 / 2.0 - 1.0).abs() < 1e-14, "{step:?}");
    let roots = amplification::Roots::new(&pencil, &penalty, heavy);
    assert!(roots.is_stable(step.lower()) && roots.is_stable(1.5 * step.lower()));
    // An inner node, and the limit is known; so near to A that only its rounding is left.
    let pencil = between(2).pencil();
    for mass in [100.0, 1e10] {
        let limit = DampedLimit::new(&pencil, engine(&pencil).unwrap(), damping(mass, 0.0, 0.0));
        let step = limit.enclose(&penalty, None).unwrap();
        assert!(step.evidence == Evidence::Proven && step.upper() <= 2.0 / mass * (1.0 + 1e-14), "{step:?}");
        assert!(step.lower() <= step.seconds() && step.seconds() <= step.upper());
    }
}

#[test]
fn what_is_not_derived_is_refused() {
    for (mass, stiffness, contact) in [(-1.0, 0.0, 0.0), (0.0, f64::NAN, 0.0), (0.0, 0.0, f64::INFINITY)] {
        let refusal = Damping::new(mass, stiffness, contact).unwrap_err();
        assert!(
            refusal.place.starts_with("damping, ") && refusal.allowed.contains("at least 0"),
            "{refusal}"
        );
    }
    let mut numbers = numbers::Numbers(5);
    let (pencil, _) = scenes::bars(&mut numbers);
    let of = |scheme, damping| damped_limit(scheme, &pencil, engine(&pencil).unwrap(), damping);
    let refusal = of(SchemeName::Park, damping(1.0, 0.0, 0.0)).err().unwrap();
    assert!(refusal.value.contains("not derived"), "{refusal}");
    assert!(of(SchemeName::Park, Damping::NONE).is_ok());
    assert!(
        damped(SchemeName::Park, damping(1.0, 0.0, 0.0)).unwrap_err().allowed.contains("without damping")
    );
    for name in SchemeName::ALL {
        assert_eq!(damped(name, Damping::NONE).unwrap().facts(), name.facts());
    }
    let scheme = damped(SchemeName::PredictorCorrector, damping(0.0, 0.0, 1.0)).unwrap();
    assert_eq!(scheme.facts().name, "damped-predictor-corrector");
}

/// An engine that counts what it is asked.
struct Counting<'a>(Box<dyn Engine + 'a>, &'a AtomicUsize);

impl Engine for Counting<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Enclosure, Uncertified> {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.enclose(penalty, start)
    }
}

#[test]
fn a_limit_takes_a_handful_of_undamped_ones() {
    let (mut numbers, count) = (numbers::Numbers(31), AtomicUsize::new(0));
    let (mut most, points) = (0, 300);
    for _ in 0..points {
        let (pencil, penalty) = scenes::bars(&mut numbers);
        let damping = scenes::damping(&mut numbers, &pencil);
        let before = count.load(Ordering::Relaxed);
        let counting = Box::new(Counting(engine(&pencil).unwrap(), &count));
        DampedLimit::new(&pencil, counting, damping).enclose(&penalty, None).unwrap();
        most = most.max(count.load(Ordering::Relaxed) - before);
    }
    let mean = count.load(Ordering::Relaxed) as f64 / f64::from(points);
    println!("{mean} undamped limits in the mean, {most} at most");
    assert!(mean < 9.0 && most < 40, "{mean} {most}");
}

/// The undamped problem of a step tells whether the step is stable.
#[test]
fn an_equivalent_undamped_problem_decides() {
    let mut numbers = numbers::Numbers(37);
    for _ in 0..60 {
        let (pencil, penalty) = scenes::bars(&mut numbers);
        let damping = scenes::damping(&mut numbers, &pencil);
        let limit = DampedLimit::new(&pencil, engine(&pencil).unwrap(), damping);
        let step = limit.enclose(&penalty, None).unwrap();
        for share in [0.3, 0.99, 1.0 - 1e-9, 1.0 + 1e-9, 1.01, 3.0] {
            let Some(undamped) = damping.equivalent(share * step.seconds()) else {
                assert!(share > 1.0 && share * step.seconds() * damping.mass() >= 2.0);
                continue;
            };
            let found = engine(&pencil).unwrap().enclose(&undamped.penalty(&penalty), None).unwrap();
            let allowed = 2.0 / found.value.sqrt();
            assert_eq!(allowed > undamped.time_step(), share < 1.0, "{damping:?} {penalty:?} at {share}");
        }
    }
}
