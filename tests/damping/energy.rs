//! What damped steps keep account of.

use bipenalty::damping::Damping;
use bipenalty::fem::MassMatrix;
use bipenalty::pencil::Penalty;
use bipenalty::scene::End;
use bipenalty::schemes::{ContactRule, DampedCentralDifference, Scheme, SchemeName, System, damped};
use bipenalty::spectrum::engine;

use crate::numbers::Numbers;
use crate::scenes;

/// kinetic + strain + penalty + loss - W is the same in every step while contacts stay closed or open and close.
#[test]
fn the_balance_of_energies_is_kept() {
    let mut numbers = Numbers(23);
    for case in 0..60 {
        let (pencil, mut penalty) = scenes::bars(&mut numbers);
        penalty.stiffness = penalty.stiffness.min(1e2);
        let damping = scenes::damping(&mut numbers, &pencil);
        let names = [SchemeName::CentralDifference, SchemeName::PredictorCorrector];
        let scheme = damped(names[case / 2 % 2], damping).unwrap();
        let limit = scheme.limit(&pencil, engine(&pencil).unwrap()).unwrap().enclose(&penalty, None).unwrap();
        let n = pencil.size();
        let system = System {
            pencil: &pencil,
            penalty,
            load: (0..n).map(|i| 0.1 * (i as f64).sin()).collect(),
            time_step: 0.4 * limit.lower(),
            critical_step: limit.lower(),
            rule: if case % 2 == 0 { ContactRule::Unilateral } else { ContactRule::HeldClosed },
            account: true,
        };
        let velocity = (0..n).map(|_| numbers.between(-1.0, 1.0)).collect();
        let mut motion = scheme.start(system, vec![0.0; n], velocity).unwrap();
        let first = motion.energy();
        let mut largest = first.stored().abs();
        for step in 0..300 {
            motion.step();
            let energy = motion.energy();
            largest = largest.max(energy.stored()).max(energy.loss.abs()).max(energy.body_work.abs());
            let off = energy.balance() - first.balance();
            assert!(off.abs() < 1e-10 * largest, "case {case}, step {step}: {off:e} of {largest}");
        }
    }
}

/// Free bodies damped by their mass lose velocity as (1 - A h) a step.
#[test]
fn mass_damping_slows_a_rigid_motion() {
    let pencil = scenes::model(End::Free, 5, MassMatrix::CONSISTENT, End::Free).pencil();
    let scheme = DampedCentralDifference::new(Damping::new(0.3, 0.0, 0.0).unwrap());
    let n = pencil.size();
    let system = System {
        pencil: &pencil,
        penalty: Penalty::NONE,
        load: Vec::new(),
        time_step: 0.01,
        critical_step: 1.0,
        rule: ContactRule::HeldOpen,
        account: true,
    };
    let mut motion = scheme.start(system, vec![0.0; n], vec![1.0; n]).unwrap();
    (0..10).for_each(|_| motion.step());
    // v_{-1/2} = 1 + A h/2.
    let expected = (1.0 + 0.0015) * (1.0 - 0.003_f64).powi(10);
    assert!((motion.state().velocity[0] - expected).abs() < 1e-13);
}
