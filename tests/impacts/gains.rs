//! What contacts that open and close give to the bodies, measured on vectors and on no number that a scheme keeps.

use bipenalty::impact::{Encounter, Passage};
use bipenalty::pencil::Gap;
use bipenalty::schemes::{Motion, SchemeName};

use super::random::{self, Random};

/// The leapfrog energy v'Mv/2 + u_{n-1}'K u_n/2 - f'(u_{n-1} + u_n)/2 of the bodies.
fn leapfrog(encounter: &Encounter, before: &[f64], motion: &dyn Motion) -> f64 {
    let (pencil, state) = (encounter.pencil(), motion.state());
    let work = |u: &[f64]| encounter.load().iter().zip(u).map(|(f, u)| f * u).sum::<f64>();
    0.5 * (kinetic(encounter, motion) + pencil.stiffness().strain(before, &state.displacement)
        - work(before)
        - work(&state.displacement))
}

/// v'Mv, twice the kinetic energy at mid-step.
fn kinetic(encounter: &Encounter, motion: &dyn Motion) -> f64 {
    let velocity = &motion.state().velocity;
    encounter.pencil().mass().quadratic(velocity, velocity)
}

/// |f|'|u|: the numbers of which the work of the load is a sum.
fn work_done(encounter: &Encounter, motion: &dyn Motion) -> f64 {
    encounter.load().iter().zip(&motion.state().displacement).map(|(f, u)| (f * u).abs()).sum()
}

/// What a passage has shown.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    /// max over n of H_n - H_0, over the largest kinetic energy of the bodies.
    gain: f64,
    /// The largest distance of H_n - H_0 from minus the work that the scheme has summed up, over the same.
    balance: f64,
    switches: u64,
}

fn watch(encounter: &Encounter, scheme: SchemeName, (beta_s, ratio, c): (f64, f64, f64), steps: u64) -> Seen {
    let penalty = encounter.penalty(beta_s, ratio);
    let duration = c * encounter.critical_step() * steps as f64;
    let passage = Passage::new(encounter.clone(), scheme, penalty, c, duration).unwrap();
    let mut motion = passage.prepare(false).unwrap();
    let mut before: Vec<f64> = motion.state().velocity.iter().map(|v| -passage.time_step() * v).collect();
    let start = leapfrog(encounter, &before, &*motion);
    let (mut seen, mut size) = (Seen::default(), start);
    for _ in 0..steps {
        before.copy_from_slice(&motion.state().displacement);
        motion.step();
        let change = leapfrog(encounter, &before, &*motion) - start;
        size = size.max(kinetic(encounter, &*motion)).max(work_done(encounter, &*motion));
        seen.gain = seen.gain.max(change / size);
        seen.balance = seen.balance.max((change + motion.state().balance_work).abs() / size);
    }
    seen.switches = motion.state().switches;
    seen
}

/// Displacements grow by flight in proportion to the steps n, so that each of n steps rounds by n units.
fn rounding(steps: u64) -> f64 {
    f64::EPSILON * (steps * steps) as f64
}

const STEPS: u64 = 300;

/// The encounter of a case, two meshes to a row of bars, and beta_s from 1/10 to 1e12.
fn encounter(random: &mut Random, case: usize) -> (Encounter, f64) {
    let mass = random::mass(random);
    let encounter =
        if case.is_multiple_of(3) { random::bars(random, mass) } else { random::mesh(random, mass) };
    (encounter, 10_f64.powf(random.between(-1.0, 12.0)))
}

/// The ratio with which r omega^2 is a quarter of the contact-free l_max: the largest that leaves the predictor-corrector
/// the contact-free step at every penalty. 1/4 where the contact-free l_max is the reference.
fn quarter(encounter: &Encounter) -> f64 {
    1.0 / (encounter.critical_step().powi(2) * encounter.pencil().reference())
}

/// The premise of the predictor-corrector: contacts open at the start and one step before it, g_0 - dt Z'v <= 0.
fn open_before(encounter: &Encounter, c: f64) -> Encounter {
    let dt = c * encounter.critical_step();
    let gap = |gap: &Gap| gap.initial.min(dt * gap.column.dot(encounter.velocity()));
    let gaps: Vec<f64> = encounter.pencil().gaps().iter().map(gap).collect();
    encounter.clone().with_gaps(&gaps).unwrap()
}

#[test]
fn three_schemes_gain_nothing_in_a_thousand_random_impacts_of_meshes() {
    use SchemeName::{Buffered, Lagrange, PredictorCorrector};
    let mut random = Random(7);
    let mut switches = 0;
    for case in 0..1500 {
        let (encounter, beta_s) = encounter(&mut random, case);
        let ratio = random.one(&[0.05, 0.25, 0.6, 1.0, 3.0, f64::INFINITY]);
        let c: f64 = random.one(&[0.3, 0.5, 0.77, 0.9, 0.99, 0.99, 0.9999]);
        let cases = [
            (Buffered, ratio, c),
            (Lagrange, ratio, c),
            (PredictorCorrector, quarter(&encounter), c.min(0.99)),
        ];
        for (scheme, ratio, c) in cases {
            assert!(scheme.facts().gains_nothing);
            let encounter =
                if scheme == PredictorCorrector { open_before(&encounter, c) } else { encounter.clone() };
            let seen = watch(&encounter, scheme, (beta_s, ratio, c), STEPS);
            let what = format!("{case} {} {beta_s:e} {ratio} {c} {seen:?}", scheme.name());
            assert!(seen.gain <= rounding(STEPS), "{what}");
            assert!(seen.balance <= rounding(STEPS), "{what}");
            switches += seen.switches;
        }
    }
    println!("{switches} switches");
    assert!(switches > 30_000, "{switches}");
}

/// The schemes of which nothing is proven, in the same impacts: how many gain more than a thousandth, and the most.
#[test]
fn the_other_schemes_do_gain() {
    use SchemeName::{CentralDifference, MoreauJean, PaoliSchatzman, Park};
    for scheme in [CentralDifference, Park, MoreauJean, PaoliSchatzman] {
        assert!(!scheme.facts().gains_nothing);
        for c in [0.5, 0.99] {
            let mut random = Random(7);
            let gain = |case: usize| {
                let (encounter, beta_s) = encounter(&mut random, case);
                watch(&encounter, scheme, (beta_s, quarter(&encounter).max(1.0), c), STEPS).gain
            };
            let gains: Vec<f64> = (0..200).map(gain).collect();
            let (count, most) =
                (gains.iter().filter(|g| **g > 1e-3).count(), gains.iter().fold(0.0, |a: f64, b| a.max(*b)));
            println!("{:20} C = {c}: {count} of 200 gain, at most {most:.3}", scheme.name());
            assert!(c == 0.5 || count > 4, "{} {count}", scheme.name());
        }
    }
}
