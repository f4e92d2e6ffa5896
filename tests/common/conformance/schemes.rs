//! What every scheme must do, whatever its order, damping and contact algorithm.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::{Penalty, Pencil};
use bipenalty::scene::{Bar, End, Impact, Scene};
use bipenalty::schemes::{ContactRule, Motion, Scheme, System};
use bipenalty::spectrum::Engine as _;
use bipenalty::stability::Model;
use bipenalty::verify::{PenaltyPoint, Predictor, confirm};

use super::{as_mesh, place};

const MASSES: [MassMatrix; 2] = [MassMatrix::LUMPED, MassMatrix::CONSISTENT];

fn on_a_wall(elements: usize, mass: MassMatrix, distance: f64) -> Model {
    let impact = Impact { duration: 1.0, gaps: vec![distance], gravity: 0.0 };
    let scene = Scene::new("wall", End::Free, vec![Bar::unit(elements)], End::Wall, Some(impact)).unwrap();
    Model::new(scene, mass, PenaltyMass::Consistent)
}

fn penalty(model: &Model, beta_s: f64, ratio: f64) -> Penalty {
    model.penalty(StiffnessPenalty::new(beta_s).unwrap(), Ratio::new(ratio).unwrap())
}

/// dt_c of the model, s.
fn critical_step(model: &Model) -> f64 {
    2.0 / model.closed_form().enclose(&Penalty::NONE, None).unwrap().value.sqrt()
}

fn system<'a>(pencil: &'a Pencil, model: &Model, penalty: Penalty, dt: f64, rule: ContactRule) -> System<'a> {
    let critical_step = critical_step(model);
    System { pencil, penalty, load: Vec::new(), time_step: dt, critical_step, rule, account: false }
}

fn start(scheme: &dyn Scheme, system: System<'_>, u: Vec<f64>, v: Vec<f64>) -> Box<dyn Motion> {
    scheme.start(system, u, v).unwrap_or_else(|refusal| panic!("{}: {refusal}", scheme.facts().name))
}

/// From one step to half of it and a quarter, the displacements of a smooth contact-free motion differ by 2^order.
pub fn converges(scheme: &dyn Scheme) {
    for mass in MASSES {
        let model = on_a_wall(8, mass, 1.0);
        let (pencil, n) = (model.pencil(), 9);
        let shape: Vec<f64> = (0..n).map(|i| (std::f64::consts::PI * i as f64 / 8.0).cos()).collect();
        let at = |steps: u32| {
            let dt = 8.0 / f64::from(steps);
            // What a scheme refers to becomes finer with the step, as on a finer mesh.
            let system = System {
                critical_step: 2.0 * dt,
                ..system(&pencil, &model, Penalty::NONE, dt, ContactRule::HeldOpen)
            };
            let mut motion = start(scheme, system, shape.clone(), vec![0.0; n]);
            (0..steps).for_each(|_| motion.step());
            motion.state().displacement.clone()
        };
        let [coarse, middle, fine] = [1600, 3200, 6400].map(at);
        let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let order = (distance(&coarse, &middle) / distance(&middle, &fine)).log2();
        let facts = scheme.facts();
        assert!((order - facts.order as f64).abs() < 0.1, "{} {}: order {order}", facts.name, mass.name());
    }
}

/// g = Z'u + g0 to rounding, closed exactly where forces are, and the contact opens and closes.
pub fn keeps_its_gaps(scheme: &dyn Scheme) {
    for mass in MASSES {
        let model = on_a_wall(6, mass, 0.01);
        let (pencil, n) = (model.pencil(), 7);
        let dt = 0.3 * critical_step(&model);
        let penalty = penalty(&model, 3.0, 1.0);
        let system = system(&pencil, &model, penalty, dt, ContactRule::Unilateral);
        let mut motion = start(scheme, system, vec![0.0; n], vec![0.1; n]);
        let mut pressed = false;
        for _ in 0..300 {
            motion.step();
            motion.synchronise();
            let state = motion.state();
            let gap = state.displacement[n - 1] - 0.01;
            assert!(
                (state.gap[0] - gap).abs() < 1e-12,
                "{}: {} is not {gap}",
                scheme.facts().name,
                state.gap[0]
            );
            assert!(
                state.closed[0] || state.force[0] == 0.0,
                "{}: an open contact pulls",
                scheme.facts().name
            );
            pressed |= state.force[0] > 0.0;
        }
        assert!(pressed && motion.state().switches >= 2 && motion.state().steps == 300);
    }
}

/// The structure of bars is an economy: the same matrices in another order move alike.
pub fn moves_alike(scheme: &dyn Scheme) {
    for mass in MASSES {
        let impact = Impact { duration: 1.0, gaps: vec![0.02, 0.0], gravity: 0.0 };
        let scene =
            Scene::new("row", End::Free, vec![Bar::unit(3), Bar::unit(4)], End::Wall, Some(impact)).unwrap();
        let model = Model::new(scene, mass, PenaltyMass::Consistent);
        let pencil = model.pencil();
        let (mesh, n, dt) = (as_mesh(&pencil), pencil.size(), 0.2 * critical_step(&model));
        let penalty = penalty(&model, 5.0, 1.0);
        let velocity: Vec<f64> = (0..n).map(|i| if i < 4 { 0.1 } else { -0.05 }).collect();
        let moved: Vec<f64> = (0..n).map(|i| velocity[(0..n).find(|j| place(*j, n) == i).unwrap()]).collect();
        let begin = |pencil: &Pencil, v: Vec<f64>| {
            start(scheme, system(pencil, &model, penalty, dt, ContactRule::Unilateral), vec![0.0; n], v)
        };
        let (mut chain, mut other) = (begin(&pencil, velocity), begin(&mesh, moved));
        for step in 0..400 {
            chain.step();
            other.step();
            for i in 0..n {
                let (a, b) = (chain.state().displacement[i], other.state().displacement[place(i, n)]);
                // Rounding grows with the steps and with each contact that opens.
                assert!((a - b).abs() < 1e-9, "{} {} step {step}: {a} {b}", scheme.facts().name, mass.name());
            }
        }
        assert!(chain.state().switches > 2);
    }
}

/// Steps grow just above the limit that the scheme states, and not below it.
pub fn has_its_limit(scheme: &dyn Scheme) {
    let mut confirmed = 0;
    for mass in MASSES {
        let model = on_a_wall(4, mass, 0.0);
        let pencil = model.pencil();
        let predictor = Predictor::new(&model, &pencil, scheme).unwrap();
        for (beta_s, ratio) in [(0.0, 1.0), (1.0, 1.0), (30.0, 2.0), (1e3, f64::INFINITY)] {
            let ratio = Ratio::new(ratio).unwrap();
            let point = PenaltyPoint { stiffness_penalty: StiffnessPenalty::new(beta_s).unwrap(), ratio };
            let predicted = predictor.at(point, 1e-3).unwrap();
            let found = confirm(&model, scheme, point, 1e-3, Some(predicted)).unwrap();
            assert_ne!(found.agrees, Some(false), "{} {}: {found:?}", scheme.facts().name, mass.name());
            confirmed += usize::from(found.agrees == Some(true));
        }
    }
    assert!(confirmed >= 4, "{}: {confirmed} of 8 points tell anything", scheme.facts().name);
}
