//! Impacts of meshes beside those of bars and beside exact solutions.

use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Encounter, Exact, Passage, Record, Recording, Run};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{Bar, End, Impact, Scene, built_in};
use bipenalty::schemes::SchemeName;
use bipenalty::stability::Model;

use super::conformance::{as_mesh, place};
use super::random::of_mesh;

/// max |a - b| over max |a|.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
}

/// Three bars between a free end and a wall.
fn row() -> Scene {
    let bar = |elements, velocity| Bar {
        length: 0.1 * elements as f64,
        elements,
        youngs_modulus: 1.0,
        density: 1.0,
        area: 1.0,
        velocity,
    };
    let impact = Impact { duration: 6.0, gaps: vec![0.02, 0.0, 0.1], gravity: 0.3 };
    Scene::new("row", End::Free, vec![bar(4, 0.4), bar(1, 0.0), bar(6, -0.7)], End::Wall, Some(impact))
        .unwrap()
}

/// The history of a run of bars is that of their encounter, digit for digit, and of the same matrices without the structure
/// of bars to rounding. Central differences magnify it by hundreds of switches: fewer steps are asked of them.
#[test]
fn bars_as_meshes_give_the_same_histories() {
    for scene in [built_in("signorini").unwrap().unwrap(), built_in("hunek").unwrap().unwrap(), row()] {
        for mass in [MassMatrix::LUMPED, MassMatrix::CONSISTENT] {
            for beta_s in [1.0, 1e4, 1e12] {
                let model = Model::new(scene.clone(), mass, PenaltyMass::Consistent);
                for scheme in SchemeName::ALL {
                    // It refuses the bar of one element between two contacts.
                    if scheme == SchemeName::MassRedistribution && scene.name() == "row" {
                        continue;
                    }
                    let (beta, ratio) = (StiffnessPenalty::new(beta_s).unwrap(), Ratio::OPTIMAL);
                    let run = Run::new(model.clone(), scheme, beta, ratio).unwrap();
                    let steps = if scheme == SchemeName::CentralDifference { 60 } else { run.steps() };
                    let run = run.clone().with_duration(steps as f64 * run.time_step()).unwrap();
                    let history =
                        run.execute(&Recording { energies: true, ..Recording::default() }, None).unwrap();
                    let bars = Encounter::of_bars(&model).unwrap();
                    let pencil = as_mesh(bars.pencil());
                    let n = pencil.size();
                    let mut velocity = vec![0.0; n];
                    let mut load = if bars.load().is_empty() { Vec::new() } else { vec![0.0; n] };
                    for i in 0..n {
                        velocity[place(i, n)] = bars.velocity()[i];
                        if let Some(f) = bars.load().get(i) {
                            load[place(i, n)] = *f;
                        }
                    }
                    let mesh = Encounter::new(pencil, velocity, load, bars.critical_step()).unwrap();
                    let passed = |encounter: Encounter| {
                        let penalty = encounter.penalty(beta_s, 1.0);
                        Passage::new(encounter, scheme, penalty, 0.5, run.duration())
                            .unwrap()
                            .execute(1, None, |_, _| ())
                            .unwrap()
                    };
                    let (of_bars, of_mesh) = (passed(bars), passed(mesh));
                    let what =
                        format!("{} {} {} {beta_s:e}", model.scene().name(), mass.name(), scheme.name());
                    assert_eq!(history.force, of_bars.force, "{what}");
                    assert_eq!(history.energy, of_bars.energy, "{what}");
                    assert_eq!(of_bars.time.len(), of_mesh.time.len());
                    let found = [
                        distance(&of_bars.force, &of_mesh.force),
                        distance(&of_bars.gap, &of_mesh.gap),
                        (of_bars.energy.last().unwrap().stored() / of_mesh.energy.last().unwrap().stored()
                            - 1.0)
                            .abs(),
                    ];
                    let allowed = if scheme == SchemeName::CentralDifference && of_bars.switches > 30 {
                        1e-3
                    } else {
                        1e-9
                    };
                    assert!(
                        found.iter().all(|d| *d <= allowed),
                        "{what} {found:?}, {} switches",
                        of_bars.switches
                    );
                    assert!(
                        of_mesh.imbalance()
                            <= 4.0 * f64::EPSILON * of_mesh.steps as f64 * of_mesh.largest_energy(),
                        "{what}"
                    );
                }
            }
        }
    }
}

/// Central differences find what they are asked for in the next step otherwise, in one pass: the same bytes.
#[test]
fn looking_at_central_differences_changes_nothing() {
    let bars = |scene: Scene| {
        Encounter::of_bars(&Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent)).unwrap()
    };
    let free = Scene::new("free", End::Free, vec![Bar::unit(40)], End::Free, None).unwrap();
    let velocity = (0..41).map(|i| f64::from(i * 37 % 11)).collect();
    let free = bars(free).with_velocity(velocity).unwrap();
    for encounter in [free, bars(row()), block(0.01, [40, 60], MassMatrix::LUMPED)] {
        let motion = || {
            let penalty = encounter.penalty(10.0, 1.0);
            let passage = Passage::new(encounter.clone(), SchemeName::CentralDifference, penalty, 0.9, 1.0);
            passage.unwrap().prepare(false).unwrap()
        };
        let (mut seen, mut unseen) = (motion(), motion());
        for _ in 0..500 {
            seen.synchronise();
            seen.step();
            unseen.step();
        }
        let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
        let (seen, unseen) = (seen.state(), unseen.state());
        assert_eq!(bits(&seen.displacement), bits(&unseen.displacement));
        assert_eq!(bits(&seen.velocity), bits(&unseen.velocity));
        assert_eq!(bits(&seen.gap), bits(&unseen.gap));
        assert!(seen.displacement.iter().all(|u| *u != 0.0));
    }
}

/// A block of 40 x 3 squares, held at its sides, that hits a wall at once: a bar of the modulus of plane strain waves.
fn block(gap: f64, cells: [usize; 2], mass: MassMatrix) -> Encounter {
    let text = format!(
        "name = \"block\"\ndimension = 2\nplane = \"strain\"\n[[body]]\nname = \"block\"\nbox = [0.6, 8.0]\ncells = {cells:?}\n\
         element = \"quad4\"\nyoungs_modulus = 52.0\npoissons_ratio = 0.3\ndensity = 0.7\nvelocity = [0.0, -0.1]\n\
         [[contact]]\nsurfaces = [\"block.bottom\", \"wall\"]\n\
         [[hold]]\nsurface = \"block.left\"\ndirections = [\"x\"]\n[[hold]]\nsurface = \"block.right\"\ndirections = [\"x\"]\n\
         [impact]\nduration = 1.0\ngaps = [{gap:?}]\n"
    );
    of_mesh(&text, mass)
}

/// The same as a bar: E (1 - nu)/((1 + nu)(1 - 2 nu)).
fn bar(gap: f64, elements: usize) -> Scene {
    let modulus = 52.0 * 0.7 / (1.3 * 0.4);
    let bar = Bar { length: 8.0, elements, youngs_modulus: modulus, density: 0.7, area: 0.6, velocity: 0.1 };
    let impact = Impact { duration: 3.0, gaps: vec![gap], gravity: 0.0 };
    Scene::new("bar", End::Free, vec![bar], End::Wall, Some(impact)).unwrap()
}

#[test]
fn a_block_held_at_its_sides_is_a_bar() {
    let (gap, cells) = (0.05, [3, 40]);
    let block = block(gap, cells, MassMatrix::LUMPED);
    let scene = bar(gap, 40);
    let model = Model::new(scene.clone(), MassMatrix::LUMPED, PenaltyMass::Consistent);
    let exact = Exact::of(&scene, 3.0).unwrap();
    // Without penalty the same step gives the same motion: plane waves of the block are those of the bar.
    let passage = |encounter: Encounter, scheme, step: f64, at: (f64, f64)| {
        let penalty = encounter.penalty(at.0, at.1);
        let c = step / encounter.critical_step();
        Passage::new(encounter, scheme, penalty, c, 3.0).unwrap().execute(1, None, |_, _| ()).unwrap()
    };
    let step = 0.5 * block.critical_step();
    let thin = Encounter::of_bars(&model).unwrap();
    let without = [
        SchemeName::Lagrange,
        SchemeName::MoreauJean,
        SchemeName::PaoliSchatzman,
        SchemeName::MassRedistribution,
    ];
    for scheme in without {
        let (a, b) = (
            passage(block.clone(), scheme, step, (0.0, 1.0)),
            passage(thin.clone(), scheme, step, (0.0, 1.0)),
        );
        let found = distance(&b.force, &a.resultant());
        println!("{}: {found:e}", scheme.name());
        assert!(found < 1e-10, "{} {found:e}", scheme.name());
    }
    // With the stiffness and the mass of all contacts of the bar, spread as the block spreads them.
    let scales = |encounter: &Encounter| encounter.pencil().gaps().iter().map(|gap| gap.scale).sum::<f64>();
    let share = scales(&thin) / scales(&block);
    let rates = thin.pencil().reference() / block.pencil().reference();
    // The Park scheme looks at the contact-free step, which the block has of other waves.
    let alike = Encounter::new(
        thin.pencil().clone(),
        thin.velocity().to_vec(),
        thin.load().to_vec(),
        block.critical_step(),
    );
    let alike = alike.unwrap();
    for scheme in [SchemeName::PredictorCorrector, SchemeName::Park, SchemeName::Buffered] {
        for (beta_s, ratio) in [(1.0, 1.0), (1e4, 1.0), (1e4, 0.5), (1e12, 1.0)] {
            let step = 0.4 * block.critical_step();
            let (a, b) = (
                passage(block.clone(), scheme, step, (share * beta_s, rates * ratio)),
                passage(alike.clone(), scheme, step, (beta_s, ratio)),
            );
            let found = distance(&b.force, &a.resultant());
            println!("{} {beta_s:e} {ratio}: {found:e}", scheme.name());
            assert!(found < 1e-9, "{} {beta_s:e} {ratio}: {found:e}", scheme.name());
        }
    }
    let schemes = [SchemeName::PredictorCorrector, SchemeName::Buffered, SchemeName::Lagrange];
    for scheme in schemes.into_iter().chain([SchemeName::MassRedistribution]) {
        let record = passage(block.clone(), scheme, step, (1e4, 1.0));
        let squares = record.time.iter().zip(record.resultant()).map(|(t, f)| (f - exact.force(*t)).powi(2));
        let rms = (squares.sum::<f64>() / record.time.len() as f64).sqrt() / exact.peak_force();
        println!("{}: rms {rms:.4}", scheme.name());
        assert!(rms < 0.1, "{} {rms}", scheme.name());
    }
}

/// Two blocks whose nodes do not meet, the lower one held below, the upper one falling under gravity: it bounces on.
fn bouncing(mass: MassMatrix, gravity: f64) -> Encounter {
    let body = |name: &str, cells: [usize; 2], origin: f64, velocity: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nbox = [1.0, 0.5]\ncells = {cells:?}\norigin = [0.0, {origin:?}]\nelement = \"quad4\"\n\
             youngs_modulus = 1.0\npoissons_ratio = 0.3\ndensity = 1.0\nvelocity = [0.0, {velocity:?}]\n"
        )
    };
    let text = format!(
        "name = \"blocks\"\ndimension = 2\nplane = \"strain\"\n{}{}[[contact]]\nsurfaces = [\"upper.bottom\", \"lower.top\"]\n\
         [[hold]]\nsurface = \"lower.bottom\"\ndirections = [\"x\", \"y\"]\n[[hold]]\nsurface = \"upper.left\"\ndirections = [\"x\"]\n\
         [impact]\nduration = 4.0\ngravity = [0.0, {gravity:?}]\n",
        body("lower", [3, 2], 0.0, 0.0),
        body("upper", [4, 2], 0.5, -0.1),
    );
    of_mesh(&text, mass)
}

/// kinetic + strain + penalty + loss - work keeps its value over 1e5 steps of a block that bounces on another one. Central
/// differences throw it a thousand times its height, where the squares of displacements are 1e4 times the energy.
#[test]
fn the_energy_balance_of_every_scheme_holds_over_a_hundred_thousand_steps() {
    for mass in [MassMatrix::LUMPED, MassMatrix::CONSISTENT] {
        let blocks = bouncing(mass, -0.01);
        for scheme in SchemeName::ALL {
            let steps: &[f64] = match scheme {
                SchemeName::CentralDifference => &[0.3, 0.37, 0.409, 0.449, 0.45],
                SchemeName::PredictorCorrector => &[0.9],
                _ => &[0.45],
            };
            let ratio = if scheme == SchemeName::PredictorCorrector { 0.25 } else { 1.0 };
            let penalties: &[f64] =
                if scheme == SchemeName::CentralDifference { &[1.0, 10.0, 100.0, 1e4] } else { &[100.0] };
            for (c, beta_s) in steps.iter().flat_map(|c| penalties.iter().map(move |beta_s| (*c, *beta_s))) {
                let duration = 100_000.0 * c * blocks.critical_step();
                let passage =
                    Passage::new(blocks.clone(), scheme, blocks.penalty(beta_s, ratio), c, duration);
                let record = passage.unwrap().execute(7, None, |_, _| ()).unwrap();
                let found = record.imbalance() / record.largest_energy();
                let what = format!("{} {} C = {c} beta_s = {beta_s}", mass.name(), scheme.name());
                println!("{what}: {found:.1e}, {} switches, {:?}", record.switches, record.ending);
                assert!(record.switches > 100 && record.steps >= 100_000, "{what} {}", record.switches);
                assert!(found <= 1e-12, "{what} {found:e}");
            }
        }
    }
}

/// dt^2 = a takes the gap of the predictor-corrector to zero like 1/beta_s on a mesh; another step leaves (a - dt^2) G lambda.
#[test]
fn the_gap_vanishes_like_one_over_the_penalty_at_the_step_of_zero_penetration() {
    for mass in [MassMatrix::LUMPED, MassMatrix::CONSISTENT] {
        let blocks = bouncing(mass, 0.0);
        let deepest = |beta_s: f64, ratio: f64, c: f64| {
            let passage = Passage::new(
                blocks.clone(),
                SchemeName::PredictorCorrector,
                blocks.penalty(beta_s, ratio),
                c,
                2.0,
            );
            let record = passage.unwrap().execute(1, None, |_, _| ()).unwrap();
            record.gap.iter().copied().fold(0.0, f64::max)
        };
        // The reference is that of the contact-free mesh, so that dt^2 = a at C = 1/(2 sqrt r).
        for (ratio, c) in [(1.0, 0.5), (4.0, 0.25)] {
            let [small, large] = [1e4, 1e8].map(|beta_s| deepest(beta_s, ratio, c));
            println!("{} r = {ratio} C = {c}: {small:.3e} {large:.3e}", mass.name());
            assert!((large / small / 1e-4 - 1.0).abs() < 0.2, "{small:e} {large:e}");
            let off = [1e4, 1e8].map(|beta_s| deepest(beta_s, ratio, 0.8 * c));
            assert!((off[1] / off[0] - 1.0).abs() < 0.2, "{off:?}");
        }
    }
}

/// Where the penalty is large, forces no longer depend on it: 1e12 agrees with 1e8 to some hundred times 1e-8, while the
/// textbook form would leave 1e-4 of noise.
#[test]
fn forces_and_gaps_of_meshes_do_not_cancel_at_a_large_penalty() {
    for mass in [MassMatrix::LUMPED, MassMatrix::CONSISTENT] {
        let block = block(0.01, [4, 6], mass);
        for scheme in [SchemeName::PredictorCorrector, SchemeName::Park, SchemeName::Buffered] {
            let record = |beta_s: f64| {
                let passage =
                    Passage::new(block.clone(), scheme, block.penalty(beta_s, 1.0), 0.3, 0.5).unwrap();
                passage.execute(1, None, |_, _| ()).unwrap()
            };
            let (large, huge) = (record(1e8), record(1e12));
            // The penetration of the other two is that of the step, 1 - 4 r C^2, and not of the penalty.
            let power = if scheme == SchemeName::Buffered { 1.0 } else { 0.0 };
            let closed = |record: &Record, beta_s: f64| {
                record.gap.iter().map(|gap| gap.max(0.0) * beta_s.powf(power)).collect::<Vec<f64>>()
            };
            let (force, gap) =
                (distance(&large.force, &huge.force), distance(&closed(&large, 1e8), &closed(&huge, 1e12)));
            println!("{} {}: force {force:.1e} gap {gap:.1e}", mass.name(), scheme.name());
            assert!(force < 1e-5 && gap < 1e-5, "{} {} {force:e} {gap:e}", mass.name(), scheme.name());
        }
    }
}
