//! The schemes and the runs: exact waves, energy, the paper's impact problems, and arithmetic that keeps its digits.

#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Ending, Exact, Mesh, Observer, Recording, Run, Summary};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Penalty;
use bipenalty::scene::{Bar, End, Impact, Scene, built_in};
use bipenalty::schemes::{CentralDifference, ContactRule, Park, Scheme, SchemeName, System};
use bipenalty::stability::Model;

#[path = "stepping/coupled.rs"]
mod coupled;
#[path = "stepping/digits.rs"]
mod digits;
#[path = "stepping/energy.rs"]
mod energy;
#[path = "stepping/limits.rs"]
mod limits;
#[path = "stepping/meshes.rs"]
mod meshes;
#[path = "stepping/opening.rs"]
mod opening;
#[path = "stepping/scheme_limits.rs"]
mod scheme_limits;

const MASSES: [MassMatrix; 3] = [MassMatrix::LUMPED, MassMatrix::AVERAGED, MassMatrix::CONSISTENT];

fn run(scene: &str, mass: MassMatrix, scheme: SchemeName, beta_s: f64, ratio: f64) -> Run {
    let model = Model::new(built_in(scene).unwrap().unwrap(), mass, PenaltyMass::Consistent);
    Run::new(model, scheme, StiffnessPenalty::new(beta_s).unwrap(), Ratio::new(ratio).unwrap()).unwrap()
}

fn summary(run: &Run) -> Summary {
    let history = run.execute(&Recording::default(), None).unwrap();
    assert_eq!(history.ending, Ending::Finished);
    Summary::of(run, &history)
}

fn unit_bar(elements: usize, velocity: f64) -> Bar {
    Bar { velocity, ..Bar::unit(elements) }
}

#[test]
fn a_square_wave_is_exact_at_the_limit_of_the_lumped_bar() {
    // C = 1: u(x_i, t_n) = F(i - n) + F(i + n), the free ends being mirrors; period 2N steps. F is a ramp, so that
    // velocity and stress are square waves.
    let elements = 50_usize;
    let scene = Scene::new("free", End::Free, vec![unit_bar(elements, 0.0)], End::Free, None).unwrap();
    let pencil = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent).pencil();
    let system = System {
        pencil: &pencil,
        penalty: Penalty::NONE,
        load: Vec::new(),
        time_step: 1.0,
        critical_step: 1.0,
        rule: ContactRule::HeldOpen,
        account: false,
    };
    let ramp = |i: i64| {
        let period = 2 * elements as i64;
        let folded = i.rem_euclid(period).min((-i).rem_euclid(period));
        (folded as f64).clamp(10.0, 20.0)
    };
    let wave = |n: i64, i: usize| 0.5 * (ramp(i as i64 - n) + ramp(i as i64 + n));
    let start: Vec<f64> = (0..=elements).map(|i| wave(0, i)).collect();
    let mut motion = CentralDifference.start(system, start, vec![0.0; elements + 1]).unwrap();
    let steps = 100_000;
    for n in 1..=steps {
        motion.step();
        if n % 9_973 == 0 || n == steps {
            let error = (0..=elements)
                .map(|i| (motion.state().displacement[i] - wave(n, i)).abs())
                .fold(0.0, f64::max);
            assert!(error <= 8.0 * f64::EPSILON * n as f64, "step {n}: {error:e}");
        }
    }
}

#[test]
fn signorini_penetrates_as_predicted_at_every_penalty() {
    for mass in MASSES {
        for beta_s in [1.0, 1e4, 1e8, 1e12] {
            let found = summary(&run("signorini", mass, SchemeName::PredictorCorrector, beta_s, 1.0));
            let gap = found.steady_relative_gap.unwrap();
            let error = gap * beta_s / 1e-3 - 1.0;
            assert!(error.abs() <= 5e-3, "{} {beta_s:e}: {gap:e}", mass.name());
        }
    }
}

#[test]
fn the_contact_force_is_as_good_as_promised_and_does_not_depend_on_a_large_penalty() {
    for scheme in [SchemeName::PredictorCorrector, SchemeName::Park] {
        let error = |scene: &str, beta_s: f64| {
            summary(&run(scene, MassMatrix::LUMPED, scheme, beta_s, 1.0)).force_error.unwrap()
        };
        let reference = error("signorini", 1e8);
        for beta_s in [1e4, 1e8, 1e12, 1e16] {
            let found = error("signorini", beta_s);
            println!("{} {beta_s:e}: {found:.6}", scheme.name());
            assert!(found <= 0.05, "{} {beta_s:e}: {found}", scheme.name());
            assert!(
                beta_s < 1e8 || (found / reference - 1.0).abs() <= 1e-6,
                "{beta_s:e}: {found} {reference}"
            );
            let found = error("hunek", beta_s);
            assert!(found <= 0.085, "hunek {} {beta_s:e}: {found}", scheme.name());
        }
    }
}

#[test]
fn the_bouncing_bar_is_followed_over_its_period() {
    for scheme in [SchemeName::PredictorCorrector, SchemeName::Park] {
        let run = run("bouncing-bar", MassMatrix::LUMPED, scheme, 1e8, 1.0);
        let found = summary(&run);
        assert!(found.force_error.unwrap() <= 0.05, "{}: {found:?}", scheme.name());
        assert!((found.energy_ratio.unwrap() - 1.0).abs() <= 0.02, "{}: {found:?}", scheme.name());
        assert_eq!(found.switches, 4);
    }
}

/// u of a free bar at rest that falls: the body force must give every node the same acceleration, exactly.
#[test]
fn free_fall_is_exact_for_every_mass_matrix_and_scheme() {
    for mass in MASSES {
        for scheme in SchemeName::ALL {
            let run = run("bouncing-bar", mass, scheme, 1.0, 1.0).with_duration(0.9).unwrap();
            let mut motion = run.prepare(false).unwrap();
            for _ in 0..run.steps() {
                motion.step();
            }
            let (n, dt) = (run.steps() as f64, run.time_step());
            // The predictor-corrector scheme is half a step ahead: n (n + 1)/2 instead of n^2/2.
            let half = if scheme == SchemeName::PredictorCorrector { n * (n + 1.0) } else { n * n };
            let exact = 10.0 * dt * dt * half / 2.0;
            // The node at the wall has no mass under redistribution: its weight hangs on its spring.
            let massless = usize::from(scheme == SchemeName::MassRedistribution);
            let displacement = &motion.state().displacement;
            for u in &displacement[..displacement.len() - massless] {
                assert!(
                    (u / exact - 1.0).abs() <= 4.0 * f64::EPSILON * n,
                    "{} {}: {u} {exact}",
                    mass.name(),
                    scheme.name()
                );
            }
        }
    }
}

/// Three bars between two walls, thrown at each other.
fn row(mirrored: bool) -> Scene {
    let bar = |elements, velocity| Bar { length: 0.1 * elements as f64, ..unit_bar(elements, velocity) };
    let bars = vec![bar(4, 0.4), bar(1, 0.0), bar(6, -0.7)];
    let impact = Impact { duration: 6.0, gaps: vec![0.05, 0.02, 0.0, 0.1], gravity: 0.3 };
    let scene = Scene::new("row", End::Wall, bars, End::Wall, Some(impact)).unwrap();
    if mirrored { scene.mirrored() } else { scene }
}

#[test]
fn several_contacts_open_and_close_the_same_in_a_mirror() {
    for mass in MASSES {
        // Mass redistribution refuses the bar of one element between two contacts.
        for scheme in SchemeName::ALL.into_iter().filter(|name| *name != SchemeName::MassRedistribution) {
            let histories = [false, true].map(|mirrored| {
                let model = Model::new(row(mirrored), mass, PenaltyMass::Consistent);
                let beta_s = StiffnessPenalty::new(3.0).unwrap();
                let run = Run::new(model, scheme, beta_s, Ratio::OPTIMAL).unwrap();
                let run = run.with_relative_courant(0.2).unwrap();
                run.execute(
                    &Recording { every: 1, energies: true, compare: false, stress_times: Vec::new() },
                    None,
                )
                .unwrap()
            });
            let [history, mirror] = &histories;
            assert!(history.switches > 8, "{} {}: {}", mass.name(), scheme.name(), history.switches);
            for contact in 0..4 {
                let peak = history.forces(contact).fold(0.0, f64::max);
                assert!(peak > 0.0, "contact {contact} never closed");
                let pairs = history.forces(contact).zip(mirror.forces(3 - contact));
                let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(
                    worst <= 1e-9 * peak,
                    "{} {} {contact}: {worst:e} {peak}",
                    mass.name(),
                    scheme.name()
                );
            }
            let allowed = 4.0 * f64::EPSILON * history.steps as f64 * energy::largest_energy(history);
            assert!(
                history.imbalance() <= allowed,
                "{} {}: {:e}",
                mass.name(),
                scheme.name(),
                history.imbalance()
            );
        }
    }
}

#[test]
fn what_is_recorded_does_not_change_the_run() {
    for mass in MASSES {
        for scheme in SchemeName::ALL {
            let run = run("hunek", mass, scheme, 1e4, 1.0);
            let dense = Recording { every: 1, energies: true, compare: true, stress_times: vec![0.05, 0.3] };
            let sparse = Recording { every: 1000, energies: false, compare: true, stress_times: vec![0.3] };
            let (dense, sparse) = (run.execute(&dense, None).unwrap(), run.execute(&sparse, None).unwrap());
            assert_eq!(dense.stress[1], sparse.stress[0], "{} {}", mass.name(), scheme.name());
            assert_eq!(dense.force.last(), sparse.force.last());
            assert_eq!(dense.switches, sparse.switches);
            assert_eq!(dense.first_and_last[1].kinetic, sparse.first_and_last[1].kinetic);
        }
    }
}

#[test]
fn a_run_that_blows_up_or_is_stopped_says_when() {
    let run = run("signorini", MassMatrix::LUMPED, SchemeName::CentralDifference, 10.0, 1.0);
    let wild = run.clone().with_relative_courant(1.1).unwrap().with_duration(30.0).unwrap();
    let history = wild.execute(&Recording::default(), None).unwrap();
    let Ending::BlewUp { step, time } = history.ending else { panic!("{:?}", history.ending) };
    let summary = Summary::of(&wild, &history);
    let numbers = (summary.force_error, summary.steady_relative_gap, summary.energy_ratio);
    assert_eq!(numbers, (None, None, None), "errors of noise");
    assert!(step > 0 && step < wild.steps() && (time - step as f64 * wild.time_step()).abs() < 1e-12);
    let stop = std::sync::atomic::AtomicBool::new(true);
    let mut told = Vec::new();
    let mut report = |done, all| told.push((done, all));
    let progress = Observer { stop: &stop, report: &mut report };
    let history = run.execute(&Recording::default(), Some(progress)).unwrap();
    assert_eq!(history.ending, Ending::Stopped { step: 0, time: 0.0 });
    assert_eq!(told, [(0, run.steps())]);
}

#[test]
fn impossible_runs_are_refused_before_they_start() {
    let good = run("signorini", MassMatrix::LUMPED, SchemeName::Park, 1.0, 1.0);
    for c in [0.0, -0.5, f64::NAN, f64::INFINITY] {
        assert!(good.clone().with_relative_courant(c).is_err(), "{c}");
    }
    for theta in [-0.1, 1.1, f64::NAN] {
        assert!(Park::new(theta).is_err(), "{theta}");
    }
    for duration in [0.0, f64::NAN, f64::INFINITY] {
        assert!(good.clone().with_duration(duration).is_err(), "{duration}");
    }
    let refused = |run: &Run, recording: Recording| run.execute(&recording, None).unwrap_err().place;
    assert_eq!(refused(&good, Recording { every: 0, ..Recording::default() }), "steps between records");
    // Duration and step count together, in whichever order they were given.
    let (small, long) = (good.clone().with_relative_courant(1e-9), good.clone().with_duration(1e9));
    for run in [small.unwrap(), long.clone().unwrap()] {
        assert_eq!(refused(&run, Recording::default()), "duration");
    }
    assert!(long.unwrap().with_duration(1.0).unwrap().check(&Recording::default()).is_ok());
    // The run ends at 0.3 s.
    for time in [-0.1, 0.31, f64::NAN] {
        assert_eq!(
            refused(&good, Recording { stress_times: vec![0.1, time], ..Recording::default() }),
            "stress time"
        );
    }
}

#[test]
fn stress_and_velocity_of_the_exact_solution_are_derivatives_of_its_displacement() {
    let scene = built_in("bouncing-bar").unwrap().unwrap();
    let exact = Exact::of(&scene, 16.0 / 3.0).unwrap();
    let d = 1e-5;
    for (x, t) in [(3.0, 1.23), (8.8, 1.4), (5.0, 2.0), (9.9, 4.1), (0.7, 5.0)] {
        let u = |x, t| exact.displacement(0, x, t).unwrap();
        let strain = (u(x + d, t) - u(x - d, t)) / (2.0 * d);
        let velocity = (u(x, t + d) - u(x, t - d)) / (2.0 * d);
        assert!((900.0 * strain - exact.stress(0, x, t).unwrap()).abs() < 1e-6, "{x} {t}");
        assert!((velocity - exact.velocity(0, x, t).unwrap()).abs() < 1e-6, "{x} {t}");
    }
    assert_eq!(Mesh::new(&scene).nodes(), 101);
}
