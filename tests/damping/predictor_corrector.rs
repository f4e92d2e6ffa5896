//! The bound of the damped predictor-corrector, by the roots of its steps.

use bipenalty::damping::Damping;
use bipenalty::pencil::Penalty;
use bipenalty::schemes::{PredictorCorrector, Scheme, SchemeName, damped_limit};
use bipenalty::spectrum::{Evidence, engine};
use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};

use crate::amplification::{contacts, full};
use crate::numbers::Numbers;
use crate::scenes;

/// The largest modulus of the multipliers of a step as it is defined, rigid motion left out.
fn radius(pencil: &bipenalty::pencil::Pencil, penalty: &Penalty, damping: Damping, h: f64) -> f64 {
    let n = pencil.size();
    let (k, m) = (full(pencil.stiffness()), full(pencil.mass()));
    let kp = contacts(pencil.gaps(), n, |gap| penalty.of(gap.scale).0);
    let mp = contacts(pencil.gaps(), n, |gap| penalty.of(gap.scale).1);
    let bodies = PartialPivLu::new(m.as_ref());
    let closed = PartialPivLu::new((&m + &mp).as_ref());
    let basis = |part: usize| Mat::from_fn(n, 2 * n, |i, j| f64::from(u8::from(j == part * n + i)));
    // The state is (u, h v).
    let (u, v) = (basis(0), basis(1));
    let c = &m * damping.mass() + &k * damping.stiffness();
    let predicted_v = &v - bodies.solve(&k * &u * (h * h) + &c * &v * h);
    let predicted = &u + &predicted_v;
    let force = &kp * (&predicted * (h * h) + &predicted_v * (damping.contact() * h));
    let v = &predicted_v - closed.solve(force);
    let u = &u + &v;
    let matrix = Mat::from_fn(2 * n, 2 * n, |i, j| if i < n { u[(i, j)] } else { v[(i - n, j)] });
    let roots = matrix.eigenvalues().unwrap();
    let moduli = roots.iter().filter(|z| (z.re - 1.0).hypot(z.im) > 1e-4).map(|z| z.re.hypot(z.im));
    moduli.fold(0.0, f64::max)
}

#[test]
fn no_root_leaves_below_the_bound() {
    let mut numbers = Numbers(41);
    let mut sharp = 0;
    for case in 0..120 {
        let (pencil, mut penalty) = scenes::bars(&mut numbers);
        penalty.stiffness = penalty.stiffness.max(1e-2);
        let damping = scenes::damping(&mut numbers, &pencil);
        let spectrum = engine(&pencil).unwrap();
        let limit = damped_limit(SchemeName::PredictorCorrector, &pencil, spectrum, damping).unwrap();
        let step = limit.enclose(&penalty, None).unwrap();
        let held = pencil.gaps().is_empty() || damping.is_none();
        assert!(held || step.evidence == Evidence::LowerBound);
        for share in [0.1, 0.5, 0.9, 0.99, 1.0] {
            let z = radius(&pencil, &penalty, damping, share * step.lower());
            assert!(
                z <= 1.0 + 1e-7,
                "case {case}: |z| = {z} at {share} of {step:?}, {penalty:?}, {damping:?}"
            );
        }
        sharp += usize::from(radius(&pencil, &penalty, damping, 1.05 * step.lower()) > 1.0 + 1e-7);
    }
    println!("unstable 5 % above the bound: {sharp} of 120");
    assert!(sharp > 30, "the bound says little: {sharp}");
}

/// With a damping that is next to nothing it is the bound of the scheme itself.
#[test]
fn little_damping_changes_little() {
    let mut numbers = Numbers(43);
    for _ in 0..30 {
        let (pencil, penalty) = scenes::bars(&mut numbers);
        let little = 1e-12 / pencil.reference().sqrt();
        let damping = Damping::new(0.0, little, little).unwrap();
        let of = |limit: &dyn bipenalty::spectrum::StepLimit| limit.enclose(&penalty, None).unwrap();
        let spectrum = || engine(&pencil).unwrap();
        let damped = damped_limit(SchemeName::PredictorCorrector, &pencil, spectrum(), damping).unwrap();
        let own = of(&*PredictorCorrector.limit(&pencil, spectrum()).unwrap());
        let damped = of(&*damped);
        assert!(damped.lower() <= own.upper() * (1.0 + 1e-12), "{damped:?} {own:?}");
        if own.evidence == Evidence::LowerBound {
            assert!((damped.lower() / own.lower() - 1.0).abs() < 1e-5, "{damped:?} {own:?}");
        }
    }
}
