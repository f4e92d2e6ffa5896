//! Contact that opens and closes: the energy it gains beside another program's, and the scheme that gains none.

use bipenalty::impact::Run;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{End, Impact, Scene, built_in};
use bipenalty::schemes::{ContactRule, SchemeName};
use bipenalty::stability::Model;
use bipenalty::verify::PenaltyPoint;
use bipenalty::verify::opening::{Gain, LinearLimit, Load, energy_gain, energy_put_in, is_proven};

use super::energy::leapfrog_energy;
use super::{MASSES, unit_bar};
use bipenalty::fem::MassMatrix;
use bipenalty::pencil::Terms;

/// The run of a built-in scene under a load at C.
fn loaded(
    scene: Scene,
    load: Load,
    mass: MassMatrix,
    scheme: SchemeName,
    (beta_s, ratio, c): (f64, f64, f64),
) -> Run {
    let model = load.on(&Model::new(scene, mass, PenaltyMass::Consistent)).unwrap().unwrap();
    let (beta_s, ratio) = (StiffnessPenalty::new(beta_s).unwrap(), Ratio::new(ratio).unwrap());
    Run::new(model, scheme, beta_s, ratio).unwrap().with_relative_courant(c).unwrap()
}

fn gain(scene: &str, load: Load, mass: MassMatrix, scheme: SchemeName, at: (f64, f64, f64)) -> Gain {
    energy_gain(&loaded(built_in(scene).unwrap().unwrap(), load, mass, scheme, at), load).unwrap()
}

/// Gains and switches of another program, a few lines in the units h = E A = rho A = 1 that share nothing with the crate; with
/// 64-bit mantissas it gives the same ten digits. The order of every sum differs, and what rounding (1e-16) sets apart
/// hundreds of switches may magnify: 1e-8 is asked for.
#[test]
fn gains_agree_with_another_program() {
    use SchemeName::{CentralDifference as Cd, Park, PredictorCorrector as Pc};
    let (lumped, consistent) = (MassMatrix::LUMPED, MassMatrix::CONSISTENT);
    let cases = [
        (Load::Impact, Cd, lumped, (1.0, 1.0, 0.5), 2.241132900893e-3, 2),
        (Load::Impact, Cd, consistent, (1.0, 1.0, 0.5), 7.698879313141e-4, 2),
        (Load::Impact, Cd, lumped, (1e4, 1.0, 0.99), 1.171945071577e-1, 204),
        (Load::Impact, Cd, consistent, (1e4, 1.0, 0.99), 1.911300033171e1, 350),
        (Load::Impact, Pc, lumped, (1e4, 1.0, 0.9), 8.450890059695, 128),
        (Load::Impact, Pc, lumped, (10.0, 1.0, 0.7), 4.093515651040e-3, 256),
        (Load::Impact, Park, lumped, (1e4, 1.0, 0.65), 1.789099913471e-4, 4),
        (Load::Sustained, Cd, lumped, (1.0, 1.0, 0.5), 1.555840851793e-2, 51),
        (Load::Sustained, Cd, consistent, (1.0, 1.0, 0.5), 7.354153336748e-3, 51),
        (Load::Sustained, Pc, lumped, (10.0, f64::INFINITY, 0.2), 0.0, 65),
    ];
    for (load, scheme, mass, at, expected, switches) in cases {
        let found = gain("signorini", load, mass, scheme, at);
        let what = format!("{} {} {} {at:?}: {found:?}", load.name(), mass.name(), scheme.name());
        assert!((found.energy_gain - expected).abs() <= 1e-8 * expected, "{what}");
        assert_eq!(found.switches, switches, "{what}");
    }
}

/// What is known of the impact at beta_s = 1e4, r = 1: energy at the end over the start, by that program.
#[test]
fn inside_the_linear_limit_of_the_spectrum_an_impact_may_gain_and_does() {
    use SchemeName::{CentralDifference, PredictorCorrector};
    for (scheme, mass, c, expected) in [
        (CentralDifference, MassMatrix::LUMPED, 0.99, 1.0828113),
        (CentralDifference, MassMatrix::CONSISTENT, 0.99, 18.3715),
        (PredictorCorrector, MassMatrix::LUMPED, 0.9, 9.45089),
        (PredictorCorrector, MassMatrix::LUMPED, 0.5, 0.99499999),
    ] {
        let found = gain("signorini", Load::Impact, mass, scheme, (1e4, 1.0, c));
        // The references have six digits of the gain.
        assert!((found.energy_ratio / expected - 1.0).abs() <= 1e-5, "{} {c}: {found:?}", scheme.name());
    }
}

/// The gain is that of the leapfrog energy v'Mv/2 + u_{n-1}'K u_n/2 of the bars, formed here from vectors.
#[test]
fn the_gain_is_that_of_the_energy_which_open_contact_keeps() {
    for mass in MASSES {
        let at = (1e4, 1.0, 0.9);
        let scene = built_in("signorini").unwrap().unwrap();
        let run = loaded(scene, Load::Impact, mass, SchemeName::PredictorCorrector, at);
        let found = energy_gain(&run, Load::Impact).unwrap();
        let pencil = run.model().pencil();
        let mut motion = run.prepare(false).unwrap();
        let start = energy_put_in(&run, Load::Impact).unwrap();
        let mut largest: f64 = 0.0;
        for _ in 0..run.steps() {
            let before = motion.state().displacement.clone();
            motion.step();
            let now = leapfrog_energy(&pencil, Terms::default(), &before, motion.state(), [0.0; 2], 1.0);
            largest = largest.max(now / start - 1.0);
        }
        assert!(found.energy_gain > 1.0);
        // Rounding of `steps` sums of works, and of one sum over the bar.
        let allowed = 16.0 * f64::EPSILON * run.steps() as f64 * largest;
        assert!((found.energy_gain - largest).abs() <= allowed, "{}: {found:?} {largest}", mass.name());
    }
}

/// Contact that is held open does no work, and held closed the reactions of the predictor-corrector and the Park scheme
/// have a potential: their work is what the contact stores. Rounding adds `steps` terms.
#[test]
fn without_switches_nothing_is_gained() {
    for mass in MASSES {
        for scheme in SchemeName::ALL {
            for (rule, c) in [(ContactRule::HeldOpen, 0.9), (ContactRule::HeldClosed, 0.45)] {
                let scene = built_in("signorini").unwrap().unwrap();
                let run = loaded(scene, Load::Impact, mass, scheme, (1e4, 1.0, c)).with_rule(rule);
                let found = energy_gain(&run, Load::Impact).unwrap();
                assert_eq!(found.switches, 0);
                if rule == ContactRule::HeldOpen || scheme != SchemeName::CentralDifference {
                    let allowed = 4.0 * f64::EPSILON * found.steps as f64;
                    assert!(found.energy_gain <= allowed, "{} {rule:?} {found:?}", scheme.name());
                }
            }
        }
    }
}

/// The theorem of `verify::opening`: one contact, any mass, any penalty, any load, up to the last digit before the limit.
#[test]
fn the_predictor_corrector_gains_nothing_below_its_limit() {
    let scheme = SchemeName::PredictorCorrector;
    let mut switches = 0;
    for name in ["signorini", "hunek"] {
        let scene = built_in(name).unwrap().unwrap().with_elements(20).unwrap();
        for mass in MASSES {
            let model = Model::new(scene.clone(), mass, PenaltyMass::Consistent);
            let pencil = model.pencil();
            let limit = LinearLimit::new(&model, &pencil, scheme.scheme()).unwrap();
            for beta_s in [0.3, 1.0, 30.0, 1e4, 1e8] {
                for ratio in [0.05, 0.25, 0.6, 1.0, 3.0] {
                    let point = PenaltyPoint {
                        stiffness_penalty: StiffnessPenalty::new(beta_s).unwrap(),
                        ratio: Ratio::new(ratio).unwrap(),
                    };
                    for fraction in [0.3, 0.77, 0.999_999] {
                        for load in Load::ALL {
                            let at = (beta_s, ratio, fraction * limit.relative(point).unwrap());
                            let run = loaded(scene.clone(), load, mass, scheme, at);
                            let found = energy_gain(&run, load).unwrap();
                            let allowed = 4.0 * f64::EPSILON * found.steps as f64;
                            assert!(found.energy_gain <= allowed, "{name} {} {at:?} {found:?}", mass.name());
                            switches += found.switches;
                        }
                    }
                }
            }
        }
    }
    assert!(switches > 10_000, "{switches}");
}

/// Where the theorem speaks: no contact may be closed at the start or a step before, be it one of three.
#[test]
fn the_theorem_asks_for_open_contacts() {
    let proven = |speeds: [f64; 3], gaps: Vec<f64>, scheme: SchemeName| {
        let bars = speeds.map(|v| unit_bar(2, v)).to_vec();
        let impact = Impact { duration: 1.0, gaps, gravity: 0.0 };
        let scene = Scene::new("three", End::Free, bars, End::Wall, Some(impact)).unwrap();
        let model = Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent);
        is_proven(&model, scheme.scheme())
    };
    let predictor_corrector = SchemeName::PredictorCorrector;
    assert!(proven([3.0, 2.0, 1.0], vec![0.0, 0.1, 0.0], predictor_corrector));
    assert!(!proven([3.0, 2.0, 1.0], vec![0.0, -0.1, 0.0], predictor_corrector));
    assert!(!proven([3.0, 1.0, 2.0], vec![0.0; 3], predictor_corrector));
    assert!(!proven([3.0, 2.0, -1.0], vec![0.0; 3], predictor_corrector));
    assert!(!proven([3.0, 2.0, 1.0], vec![0.0; 3], SchemeName::CentralDifference));
}

/// A bar thrown at speed v and pressed by b = v c/L: kinetic rho A L v^2/2, and 4 V with V = rho A L (b L/c)^2/6. Its
/// mirror image is the same problem; rows that are free or held at both ends cannot be pressed.
#[test]
fn the_sustained_load_puts_in_what_it_says() {
    let thrown = |left, right, velocity| {
        let impact = Impact { duration: 1.0, gaps: Vec::new(), gravity: 0.0 };
        Scene::new("thrown", left, vec![unit_bar(30, velocity)], right, Some(impact)).unwrap()
    };
    let at = (10.0, 1.0, 0.3);
    let of = |scene| {
        let run = loaded(scene, Load::Sustained, MassMatrix::LUMPED, SchemeName::PredictorCorrector, at);
        (energy_put_in(&run, Load::Sustained).unwrap(), energy_gain(&run, Load::Sustained).unwrap())
    };
    let (energy, found) = of(thrown(End::Free, End::Wall, 0.2));
    let expected = 30.0 * 0.04 * (0.5 + 4.0 / 6.0);
    assert!((energy / expected - 1.0).abs() <= 64.0 * f64::EPSILON, "{energy} {expected}");
    assert!(found.switches > 4 && found.energy_ratio < 1.0, "{found:?}");
    let (mirrored_energy, mirrored) = of(thrown(End::Wall, End::Free, -0.2));
    // Sums over the bar are taken in another order.
    assert!((mirrored_energy / energy - 1.0).abs() <= 64.0 * f64::EPSILON);
    assert!((mirrored.energy_ratio - found.energy_ratio).abs() <= 1e-9, "{found:?} {mirrored:?}");
    assert_eq!(mirrored.switches, found.switches);
    for (left, right) in [(End::Free, End::Free), (End::Wall, End::Wall)] {
        let model = Model::new(thrown(left, right, 0.2), MassMatrix::LUMPED, PenaltyMass::Consistent);
        assert!(Load::Sustained.on(&model).unwrap().is_none());
    }
    let still =
        loaded(thrown(End::Free, End::Wall, 0.0), Load::Impact, MassMatrix::LUMPED, SchemeName::Park, at);
    assert!(energy_gain(&still, Load::Impact).unwrap_err().to_string().contains("J put in"));
}
