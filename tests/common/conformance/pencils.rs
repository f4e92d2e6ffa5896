//! What every pencil must do: its bounds hold, its spectrum is enclosed, and steps find the same limit.

use bipenalty::pencil::{Penalty, Pencil};
use bipenalty::schemes::{CentralDifference, ContactRule, PredictorCorrector, Scheme, System};
use bipenalty::spectrum::{Dense, Engine, Evidence, engine};

/// Penalties from none to stiff, of ratios below, at and above the neutral one.
fn penalties(pencil: &Pencil) -> Vec<Penalty> {
    let of =
        |stiffness: f64, ratio: f64| Penalty { stiffness, rate: ratio * pencil.reference(), ..Penalty::NONE };
    vec![Penalty::NONE, of(0.3, 1.0), of(10.0, 0.5), of(100.0, 1.0), of(1e4, f64::INFINITY)]
}

fn l_max(pencil: &Pencil, penalty: &Penalty) -> f64 {
    let found = Dense::new(pencil).unwrap().enclose(penalty, None).unwrap();
    assert!(found.lower <= found.value && found.value <= found.upper);
    found.value
}

/// |x|'|K||x| <= B x'Mx and |x|'|M||x| <= c x'Mx for vectors that alternate, cluster or stand alone; the mediant bound.
pub fn check(pencil: &Pencil) {
    let (n, bounds) = (pencil.size(), pencil.bounds());
    for k in 0..40_u64 {
        let x: Vec<f64> = (0..n).map(|i| ((k * k + 7) as f64 * (i + 1) as f64 * 0.731).sin()).collect();
        let sizes = |a: &bipenalty::pencil::Matrix| -> f64 {
            (0..n)
                .flat_map(|i| a.row(i).map(move |(j, a)| (i, j, a)))
                .map(|(i, j, a)| (a * x[i] * x[j]).abs())
                .sum()
        };
        let inertia = pencil.mass().quadratic(&x, &x) * (1.0 + 1e-12);
        assert!(
            sizes(pencil.stiffness()) <= bounds.stiffness * inertia,
            "B = {} is too small",
            bounds.stiffness
        );
        assert!(sizes(pencil.mass()) <= bounds.mass * inertia, "c = {} is too small", bounds.mass);
    }
    let free = l_max(pencil, &Penalty::NONE);
    assert!(free <= bounds.stiffness * (1.0 + 1e-12));
    for penalty in penalties(pencil) {
        let found = l_max(pencil, &penalty);
        assert!(found <= free.max(penalty.rate) * (1.0 + 1e-9), "{penalty:?}: {found} above the mediant");
    }
}

/// Growth of the kinetic energy in 2000 steps of dt with the contacts held closed.
fn grown(pencil: &Pencil, scheme: &dyn Scheme, penalty: Penalty, dt: f64) -> f64 {
    let (n, critical_step) = (pencil.size(), 2.0 / l_max(pencil, &Penalty::NONE).sqrt());
    let rule = ContactRule::HeldClosed;
    let system =
        System { pencil, penalty, load: Vec::new(), time_step: dt, critical_step, rule, account: false };
    let velocity: Vec<f64> = (0..n).map(|i| ((i * i + 1) as f64).sin()).collect();
    let mut motion = scheme.start(system, vec![0.0; n], velocity.clone()).unwrap();
    (0..2000).for_each(|_| motion.step());
    let energy = |v: &[f64]| pencil.mass().quadratic(v, v);
    energy(&motion.state().velocity) / energy(&velocity)
}

/// Held closed, central differences grow just above 2/omega_max, and not just below.
pub fn steps_to_the_limit(pencil: &Pencil) {
    for penalty in penalties(pencil) {
        let limit = 2.0 / l_max(pencil, &penalty).sqrt();
        let (below, above) =
            [0.999, 1.001].map(|c| grown(pencil, &CentralDifference, penalty, c * limit)).into();
        // Below by 1e-3 amplitudes reach 1/sqrt(8e-3); above, 2000 steps grow by e^178.
        assert!(below < 1e6, "{penalty:?} grows below its limit");
        assert!(above.is_nan() || above >= 1e12, "{penalty:?} does not grow above its limit");
    }
}

/// What is proven for any mesh: the predictor-corrector does not grow up to the bound of its limit.
pub fn keeps_the_bound(pencil: &Pencil) {
    let limit = PredictorCorrector.limit(pencil, engine(pencil).unwrap()).unwrap();
    for penalty in penalties(pencil) {
        let step = limit.enclose(&penalty, None).unwrap();
        if penalty.stiffness == 0.0 {
            assert_eq!(
                step.evidence,
                Evidence::Proven,
                "without a contact its limit is the contact-free one"
            );
        } else {
            assert!(step.evidence == Evidence::LowerBound && step.lower() < step.upper());
            let growth =
                grown(pencil, &PredictorCorrector, penalty, 1.01 * step.upper().min(1e3 * step.lower()));
            assert!(growth.is_nan() || growth >= 1e12, "{penalty:?}: stable above {step:?}");
        }
        let growth = grown(pencil, &PredictorCorrector, penalty, 0.999 * step.lower());
        assert!(growth < 1e6, "{penalty:?}: grows by {growth:e} below {}", step.lower());
        // No more than a few times too small: it is the limit where contacts are alike.
        let growth = grown(pencil, &PredictorCorrector, penalty, 3.0 * step.lower());
        assert!(growth.is_nan() || growth >= 1e12, "{penalty:?}: three times the bound is stable");
    }
}
