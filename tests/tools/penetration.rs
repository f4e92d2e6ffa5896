//! The numbers of `analyses/PAPER.md` on penetration, the contact force and the penalty matrices, computed again.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;

use std::collections::HashMap;
use std::process::Command;

use bipenalty::fem::MassMatrix;
use bipenalty::scene::{End, Scene};
use common::scenes::{bar, model, penalty};

/// The rows of `contact-impact signorini` with these options, by column.
fn impacts(options: &str) -> Vec<HashMap<String, String>> {
    let arguments = format!("signorini {options} --stdout csv -q");
    let out = Command::new(env!("CARGO_BIN_EXE_contact-impact")).args(arguments.split(' ')).output().unwrap();
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let text = String::from_utf8(out.stdout).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().unwrap();
    lines.map(|fields| header.iter().cloned().zip(fields).collect()).collect()
}

fn number(row: &HashMap<String, String>, name: &str) -> f64 {
    row[name].parse().unwrap_or_else(|_| panic!("{name} is {:?}", row[name]))
}

/// Steady g/h at lambda = 0.1 N, EA = 100 N, gamma = 1 (mu/omega_e^2 = h/(2 EA)) or 0 (mu/omega_e^2 = h/(EA 2 sqrt 3) on a
/// long bar): 1e-3 (1/beta_s + kept mu' (1/r - 4 C^2)), mu' = mu EA/(h omega_e^2); the predicted gap has C = 0.
#[test]
fn the_gap_tends_to_what_the_theorem_says() {
    for (mass, share) in [("lumped", 0.5), ("consistent", 0.5 / 3f64.sqrt())] {
        for (ratio, courant) in [(1.0, 0.25), (1.0, 0.4), (1.0, 0.5), (0.25, 0.25), (0.25, 0.5)] {
            let options = format!(
                "--mass {mass} --scheme predictor-corrector,park --ratio {ratio} --relative-courant {courant} \
                 --beta-s 1,1e4,1e8,1e12"
            );
            let rows = impacts(&options);
            assert_eq!(rows.len(), 8);
            for row in rows {
                let corrected = if row["scheme"] == "park" { 0.0 } else { 4.0 * courant * courant };
                let beta_s = number(&row, "stiffness_penalty");
                let expected = 1e-3 * (1.0 / beta_s + share * (1.0 / ratio - corrected));
                let found = number(&row, "steady_relative_gap");
                // The force is steady to some 1e-4 when the gap is read: its waves have not all left.
                let error = (found / expected - 1.0).abs();
                assert!(
                    error < 2e-4,
                    "{mass}, r = {ratio}, C = {courant}: {found:e}, not {expected:e}: {row:?}"
                );
            }
        }
    }
}

/// Force errors of the mass matrices at beta_s = 1e12, r = 1, C = 1/2, as the table quotes them.
#[test]
fn force_errors_of_the_mass_matrices_are_those_quoted() {
    let rows = impacts(
        "--mass lumped,averaged,consistent --scheme predictor-corrector,park --ratio 1 --beta-s 1e12",
    );
    let found: Vec<String> = rows.iter().map(|row| format!("{:.3}", number(row, "force_error"))).collect();
    let page = include_str!("../../analyses/PAPER.md");
    let quoted = format!(
        "predictor-corrector {}, {}, {}; Park {}, {}, {}",
        found[0], found[2], found[4], found[1], found[3], found[5]
    );
    assert!(page.contains(&quoted), "PAPER.md does not say: {quoted}");
}

/// The sensitivity d ln C_r/d ln beta_s of the table, from points 1 % apart.
#[test]
fn sensitivities_are_those_quoted() {
    let arguments = "signorini --mass lumped --beta-s 10,10.1,1e6,1.01e6 --ratio 1,inf --stdout csv -q";
    let out = Command::new(env!("CARGO_BIN_EXE_stability-map")).args(arguments.split(' ')).output().unwrap();
    let text = String::from_utf8(out.stdout).unwrap();
    let column = text.lines().next().unwrap().split(',').position(|name| name == "critical_courant").unwrap();
    let courant: Vec<f64> =
        text.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect();
    let slope = |i: usize| (courant[i + 1] / courant[i]).ln() / 1.01f64.ln();
    assert!(slope(0).abs() < 1e-13 && slope(2).abs() < 1e-13, "r = 1: {}, {}", slope(0), slope(2));
    let quoted = format!("−{:.2} at β_s = 10 and −{:.2} at 1e6", -slope(4), -slope(6));
    assert!(include_str!("../../analyses/PAPER.md").contains(&quoted), "PAPER.md does not say: {quoted}");
}

/// M_p adds mass against a wall, m = beta_m rho h A/2, and none between two bars; at r = 1 its terms leave the top mode
/// alone: K x = omega_e^2 M x for x = 1, -1, 1, .. and s = omega_e^2 m.
#[test]
fn the_mass_penalty_has_mass_at_a_wall_and_keeps_the_top_mode() {
    let one = |n: usize| bar(n as f64, n, 1.0, 1.0, 1.0);
    let wall = Scene::new("wall", End::Free, vec![one(6)], End::Wall, None).unwrap();
    let pair = Scene::new("pair", End::Free, vec![one(3), one(2)], End::Free, None).unwrap();
    for gamma in [0.0, 0.5, 1.0] {
        for (scene, z) in
            [(&wall, vec![0., 0., 0., 0., 0., 0., 1.]), (&pair, vec![0., 0., 0., 1., -1., 0., 0.])]
        {
            let model = model(scene, MassMatrix::new(gamma).unwrap());
            let (pencil, penalty) = (model.pencil(), penalty(&model, 10.0, 1.0).terms(model.scales()[0]));
            // rho h A = EA/h = 1 here; beta_m = (1 + 2 gamma)/6 beta_s/r.
            let expected = 0.5 * (1.0 + 2.0 * gamma) / 6.0 * 10.0;
            assert!((penalty.mass / expected - 1.0).abs() < 4.0 * f64::EPSILON);
            let rigid = z.iter().sum::<f64>();
            let added = penalty.mass * rigid * rigid;
            assert_eq!(added > 0.0, std::ptr::eq(scene, &wall));
            let l = penalty.stiffness / penalty.mass;
            // The contact nodes of the pair, 3 and 4, move against each other as well.
            let top: Vec<f64> = (0..7).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
            let (mut kx, mut mx) = (vec![0.0; 7], vec![0.0; 7]);
            pencil.stiffness().multiply(&top, &mut kx);
            pencil.mass().multiply(&top, &mut mx);
            for (k, m) in kx.iter().zip(&mx) {
                // Some ten roundings of the largest entry, 4.
                assert!((k - l * m).abs() < 40.0 * f64::EPSILON, "gamma = {gamma}: {k} and {}", l * m);
            }
        }
    }
}
