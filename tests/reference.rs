//! Every engine against the 80-digit values of `tests/data/critical_courant.csv`, made by Sturm bisection in
//! extended precision (`tests/data/README.md`): bars of unit elements, three scenes, three mass matrices.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{Bar, End, Impact, Scene};
use bipenalty::stability::{EngineName, Model};

struct Row {
    scene: String,
    elements: usize,
    gamma: f64,
    beta_s: f64,
    ratio: f64,
    critical_courant: f64,
    line: usize,
}

fn rows() -> Vec<Row> {
    let text = include_str!("data/critical_courant.csv");
    let row = |(i, line): (usize, &str)| {
        let field: Vec<&str> = line.split(',').collect();
        let number = |k: usize| field[k].parse().unwrap();
        Row {
            scene: field[0].to_owned(),
            elements: field[1].parse().unwrap(),
            gamma: number(2),
            beta_s: number(3),
            ratio: number(4),
            critical_courant: number(5),
            line: i + 2,
        }
    };
    text.lines().skip(1).enumerate().map(row).collect()
}

/// The scene of a row with E = rho = A = h = 1.
fn unit_scene(name: &str, elements: usize) -> Scene {
    let bar = Bar::unit;
    let n = elements;
    let (bars, right) = match name {
        "signorini" => (vec![bar(n)], End::Wall),
        "symmetric" => (vec![bar(n), bar(n)], End::Free),
        "hunek" => (vec![bar(n), bar(2 * n)], End::Fixed),
        other => panic!("unknown scene {other}"),
    };
    Scene::new(name, End::Free, bars, right, None::<Impact>).unwrap()
}

/// The relative error of `engine` in each row, against the reference as `alter` makes it; infinite where the enclosure
/// does not hold the reference.
fn errors(engine: EngineName, alter: impl Fn(f64) -> f64) -> Vec<(f64, usize)> {
    let error = |row: Row| {
        let mass = MassMatrix::new(row.gamma).unwrap();
        let model = Model::new(unit_scene(&row.scene, row.elements), mass, PenaltyMass::Consistent);
        let pencil = model.pencil();
        let penalties =
            model.penalty(StiffnessPenalty::new(row.beta_s).unwrap(), Ratio::new(row.ratio).unwrap());
        let step = model.engine(engine, &pencil).unwrap().enclose(&penalties, None);
        let step = model.critical_step(step.unwrap_or_else(|e| panic!("line {}: {e}", row.line)));
        let exact = alter(row.critical_courant);
        let held = step.lower <= exact && exact <= step.upper;
        (if held { (step.critical_courant / exact - 1.0).abs() } else { f64::INFINITY }, row.line)
    };
    rows().into_iter().map(error).collect()
}

fn check(engine: EngineName, allowed: f64) {
    let errors = errors(engine, |exact| exact);
    assert_eq!(errors.len(), 1728);
    let (error, line) = errors.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    println!("{engine:?}: worst relative error {error:e} in line {line}");
    assert!(error <= allowed, "{engine:?}: {error:e} > {allowed:e} in line {line}");
}

/// Each reference off by three times the allowed error: no row holds.
#[test]
fn no_row_holds_against_a_perturbed_value() {
    let allowed = 4e-15;
    for engine in [EngineName::Sturm, EngineName::Secular, EngineName::ClosedForm] {
        for sign in [-1.0, 1.0] {
            let errors = errors(engine, |exact| exact * (1.0 + sign * 3.0 * allowed));
            let blind: Vec<_> = errors.into_iter().filter(|(error, _)| *error <= allowed).collect();
            assert!(blind.is_empty(), "{engine:?}: {blind:?}");
        }
    }
}

#[test]
fn sturm_reproduces_the_80_digit_values() {
    check(EngineName::Sturm, 4e-15);
}

#[test]
fn secular_reproduces_the_80_digit_values() {
    check(EngineName::Secular, 4e-15);
}

#[test]
fn closed_form_reproduces_the_80_digit_values() {
    check(EngineName::ClosedForm, 4e-15);
}

#[test]
fn dense_reproduces_the_80_digit_values() {
    check(EngineName::Dense, 1e-14);
}

#[cfg(feature = "lapack")]
#[test]
fn lapack_reproduces_the_80_digit_values() {
    check(EngineName::Lapack, 1e-14);
}
