//! Impacts of meshes and matrices as users of `contact-impact`, `verify-limits` and `impact-studies` meet them.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use std::fmt::Write;

use bipenalty::fem::MassMatrix;
use bipenalty::impact::Encounter;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Matrix;
use bipenalty::scene::built_in;
use bipenalty::stability::Model;
use tool::{Outcome, Scratch, run_program};

const IMPACT: &str = env!("CARGO_BIN_EXE_contact-impact");
const VERIFY: &str = env!("CARGO_BIN_EXE_verify-limits");
const STUDIES: &str = env!("CARGO_BIN_EXE_impact-studies");

fn run(program: &str, scratch: &Scratch, arguments: &str) -> Outcome {
    run_program(program, scratch, &arguments.split_whitespace().collect::<Vec<_>>())
}

fn column(csv: &str, name: &str) -> Vec<String> {
    let mut lines = csv.lines();
    let at = lines.next().unwrap().split(',').position(|known| known == name);
    let at = at.unwrap_or_else(|| panic!("no column {name} in {csv}"));
    lines.map(|line| line.split(',').nth(at).unwrap().to_owned()).collect()
}

fn numbers(csv: &str, name: &str) -> Vec<f64> {
    column(csv, name).iter().map(|text| text.parse().unwrap()).collect()
}

fn text(scratch: &Scratch, file: &str) -> String {
    String::from_utf8(scratch.read(file)).unwrap()
}

/// max |a - b| over max |a|.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
}

/// A block held at its sides, cut into 3 x 20 squares.
const BLOCK: &str = r#"name = "block"
dimension = 2
plane = "strain"
[[body]]
name = "block"
box = [0.6, 4.0]
cells = [3, 20]
element = "quad4"
youngs_modulus = 52.0
poissons_ratio = 0.3
density = 0.7
velocity = [0.0, -0.1]
[[contact]]
surfaces = ["block.bottom", "wall"]
[[hold]]
surface = "block.left"
directions = ["x"]
[[hold]]
surface = "block.right"
directions = ["x"]
[impact]
duration = 1.5
gaps = [0.02]
"#;

/// The bar in which it moves: E (1 - nu)/((1 + nu)(1 - 2 nu)) = 70.
const BAR: &str = r#"name = "bar"
[ends]
left = "wall"
[[bar]]
length = 4.0
elements = 20
youngs_modulus = 70.0
density = 0.7
area = 0.6
velocity = -0.1
[impact]
duration = 1.5
gaps = [0.02]
"#;

#[test]
fn a_block_that_moves_as_a_bar_has_its_history_and_its_exact_force() {
    let scratch = Scratch::new("impact-block");
    scratch.write("block.toml", BLOCK);
    scratch.write("bar.toml", BAR);
    let options =
        "--mass lumped --beta-s 1 --scheme lagrange,moreau-jean --time-step 0.005 --format csv -q --out out";
    for scene in ["block.toml", "bar.toml"] {
        run(IMPACT, &scratch, &format!("{scene} {options}")).succeeded();
        std::fs::rename(scratch.path().join("out/summary.csv"), scratch.path().join(format!("{scene}.csv")))
            .unwrap();
    }
    for scheme in ["lagrange", "moreau-jean"] {
        let [block, bar] =
            ["block", "bar"].map(|name| text(&scratch, &format!("out/{name}-lumped-{scheme}-beta1-r1.csv")));
        for name in ["time", "contact_force", "kinetic_energy", "strain_energy"] {
            let found = distance(&numbers(&bar, name), &numbers(&block, name));
            assert!(found < 1e-10, "{scheme} {name} {found:e}");
        }
        // rho c A v while the wave is on its way.
        let exact = numbers(&block, "exact_force");
        let closed = exact.iter().filter(|force| **force > 0.0).count();
        assert!(exact.iter().all(|f| *f == 0.0 || (f - 0.7 * 10.0 * 0.6 * 0.1).abs() < 1e-12), "{exact:?}");
        assert!((closed as f64 * 0.005 - 0.8).abs() < 0.02, "{closed}");
    }
    // The errors of both are one.
    for name in ["force_error", "overshoot", "variation"] {
        let [block, bar] =
            ["block.toml.csv", "bar.toml.csv"].map(|file| numbers(&text(&scratch, file), name));
        assert!(distance(&bar, &block) < 1e-8, "{name} {bar:?} {block:?}");
    }
}

/// The matrices of a built-in scene as files, with its velocities.
fn as_matrices(scratch: &Scratch, name: &str) {
    let scene = built_in(name).unwrap().unwrap().with_elements(10).unwrap();
    let model = Model::new(scene.clone(), MassMatrix::LUMPED, PenaltyMass::Consistent);
    let bars = Encounter::of_bars(&model).unwrap();
    let pencil = bars.pencil();
    let n = pencil.size();
    let coordinate = |matrix: &Matrix| {
        let entries: Vec<String> = (0..n)
            .flat_map(|i| matrix.row(i).map(move |(j, x)| format!("{} {} {x:e}\n", i + 1, j + 1)))
            .collect();
        format!(
            "%%MatrixMarket matrix coordinate real general\n{n} {n} {}\n{}",
            entries.len(),
            entries.concat()
        )
    };
    let array = |x: &[f64]| {
        let lines: String = x.iter().map(|x| format!("{x:e}\n")).collect();
        format!("%%MatrixMarket matrix array real general\n{} 1\n{lines}", x.len())
    };
    scratch.write("K.mtx", coordinate(pencil.stiffness()));
    scratch.write("M.mtx", coordinate(pencil.mass()));
    let mut gaps = String::new();
    for (j, gap) in pencil.gaps().iter().enumerate() {
        gap.column.0.iter().for_each(|(i, z)| writeln!(gaps, "{} {} {z:e}", i + 1, j + 1).unwrap());
    }
    let (k, count) = (pencil.gaps().len(), gaps.lines().count());
    scratch.write("Z.mtx", format!("%%MatrixMarket matrix coordinate real general\n{n} {k} {count}\n{gaps}"));
    scratch.write("w.mtx", array(&pencil.gaps().iter().map(|gap| gap.scale).collect::<Vec<_>>()));
    scratch.write("v.mtx", array(bars.velocity()));
    scratch.write(
        "own.toml",
        format!(
            "name = \"own\"\n[matrices]\nstiffness = \"K.mtx\"\nmass = \"M.mtx\"\ngaps = \"Z.mtx\"\nscales = \"w.mtx\"\n\
             reference = {:e}\n[impact]\nduration = {:e}\nvelocity = \"v.mtx\"\n",
            pencil.reference(),
            scene.impact().unwrap().duration
        ),
    );
}

#[test]
fn bars_as_matrices_give_the_same_histories() {
    let scratch = Scratch::new("impact-matrices");
    for name in ["signorini", "hunek"] {
        as_matrices(&scratch, name);
        let step = if name == "signorini" { 0.005 } else { 0.004 };
        let options = format!(
            "--beta-s 1,1e4,1e12 --scheme predictor-corrector,park,buffered,lagrange --time-step {step} --format csv -q --out out"
        );
        run(IMPACT, &scratch, &format!("{name} --elements 10 --mass lumped {options}")).succeeded();
        run(IMPACT, &scratch, &format!("own.toml {options}")).succeeded();
        for scheme in ["predictor-corrector", "park", "buffered", "lagrange"] {
            for beta_s in ["1", "1e4", "1e12"] {
                let bar = text(&scratch, &format!("out/{name}-lumped-{scheme}-beta{beta_s}-r1.csv"));
                let own = text(&scratch, &format!("out/own-given-{scheme}-beta{beta_s}-r1.csv"));
                for column in ["contact_force", "kinetic_energy", "strain_energy", "penalty_energy", "loss"] {
                    let found = distance(&numbers(&bar, column), &numbers(&own, column));
                    // Energies of a stiff penalty and losses are small beside what they are made of.
                    let allowed = if column == "contact_force" { 1e-9 } else { 1e-7 };
                    assert!(found.is_nan() || found < allowed, "{name} {scheme} {beta_s} {column} {found:e}");
                }
            }
        }
    }
}

/// Two blocks whose nodes do not meet, thrown at each other.
fn blocks(scratch: &Scratch) {
    let body = |name: &str, cells: &str, origin: f64, velocity: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nbox = [1.0, 0.5]\ncells = {cells}\norigin = [0.0, {origin:?}]\nelement = \"quad4\"\n\
             youngs_modulus = 1.0\npoissons_ratio = 0.3\ndensity = 1.0\nvelocity = [0.0, {velocity:?}]\n"
        )
    };
    let text = format!(
        "name = \"blocks\"\ndimension = 2\nplane = \"strain\"\n{}{}[[contact]]\nsurfaces = [\"upper.bottom\", \"lower.top\"]\n\
         [[hold]]\nsurface = \"lower.bottom\"\ndirections = [\"x\", \"y\"]\n[impact]\nduration = 4.0\n",
        body("lower", "[4, 2]", 0.0, 0.0),
        body("upper", "[5, 2]", 0.5, -0.1),
    );
    scratch.write("blocks.toml", text);
}

#[test]
fn histories_close_their_balance_and_sum_their_contacts() {
    let scratch = Scratch::new("impact-balance");
    blocks(&scratch);
    run(IMPACT, &scratch, "blocks.toml --beta-s 1e3 --every 3 --format csv,json -q --out out").succeeded();
    for scheme in ["central-difference", "predictor-corrector", "park"] {
        let stem = format!("out/blocks-lumped-{scheme}-beta1e3-r1");
        let (rows, contacts) =
            (text(&scratch, &format!("{stem}.csv")), text(&scratch, &format!("{stem}-contacts.csv")));
        let sum = |signs: [(&str, f64); 5]| {
            let mut all = vec![0.0; numbers(&rows, "time").len()];
            for (name, sign) in signs {
                all.iter_mut().zip(numbers(&rows, name)).for_each(|(sum, x)| *sum += sign * x);
            }
            all
        };
        let balance = sum([
            ("kinetic_energy", 1.0),
            ("strain_energy", 1.0),
            ("penalty_energy", 1.0),
            ("loss", 1.0),
            ("body_work", -1.0),
        ]);
        let start = balance[0];
        assert!(balance.iter().all(|b| (b / start - 1.0).abs() < 1e-12), "{scheme} {balance:?}");
        let forces = numbers(&contacts, "contact_force");
        let k = column(&contacts, "contact").iter().map(|j| j.parse::<usize>().unwrap()).max().unwrap();
        assert_eq!(k, 6);
        let sums: Vec<f64> = forces.chunks(k).map(|row| row.iter().sum()).collect();
        assert!(distance(&numbers(&rows, "contact_force"), &sums) < 1e-14, "{scheme}");
        let gaps: Vec<f64> = numbers(&contacts, "gap")
            .chunks(k)
            .map(|row| row.iter().copied().fold(f64::MIN, f64::max))
            .collect();
        assert_eq!(numbers(&rows, "largest_gap"), gaps);
    }
    let places = text(&scratch, "out/blocks-lumped-places.csv");
    assert_eq!(numbers(&places, "x"), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0].map(|x: f64| x));
    assert!(column(&places, "second").iter().all(|name| name == "lower.top"));
}

#[test]
fn frames_hold_displacement_velocity_stress_and_gap() {
    let scratch = Scratch::new("impact-frames");
    blocks(&scratch);
    let options =
        "--scheme predictor-corrector --beta-s 10 --every 4 --frame-every 3 --format csv,vtu -q --out out";
    run(IMPACT, &scratch, &format!("blocks.toml {options}")).succeeded();
    let stem = "out/blocks-lumped-predictor-corrector-beta10-r1";
    let rows = numbers(&text(&scratch, &format!("{stem}.csv")), "time");
    let frames: Vec<String> = scratch.files().into_iter().filter(|file| file.ends_with(".vtu")).collect();
    assert_eq!(frames.len(), rows.len().div_ceil(3));
    let collection = text(&scratch, &format!("{stem}.pvd"));
    assert_eq!(collection.matches("<DataSet").count(), frames.len());
    assert!(collection.contains(&format!("timestep=\"{}\"", rows[3])));
    let first = text(&scratch, &frames[0]);
    for field in ["displacement", "velocity", "gap", "contact_force", "stress", "von_mises"] {
        assert!(first.contains(&format!("Name=\"{field}\"")), "{field}");
    }
    // Nothing is strained at the start, and the upper block moves.
    let values = |text: &str, name: &str| -> Vec<f64> {
        let rest = &text[text.find(&format!("Name=\"{name}\"")).unwrap()..];
        let data = &rest[rest.find('>').unwrap() + 1..rest.find("</DataArray>").unwrap()];
        data.split_whitespace().map(|x| x.parse().unwrap()).collect()
    };
    assert!(values(&first, "von_mises").iter().all(|x| *x == 0.0));
    let velocity = values(&first, "velocity");
    assert_eq!(velocity.len(), 3 * (5 * 3 + 6 * 3));
    assert_eq!(velocity.iter().filter(|v| **v == -0.1).count(), 18);
    let middle = text(&scratch, &frames[frames.len() / 4]);
    assert!(values(&middle, "von_mises").iter().any(|x| *x > 1e-3), "nothing is pressed");
}

#[test]
fn what_cannot_be_done_is_refused_with_its_place() {
    let scratch = Scratch::new("impact-refusals");
    blocks(&scratch);
    scratch.write("still.toml", BLOCK.split("[impact]").next().unwrap());
    as_matrices(&scratch, "signorini");
    scratch.write("short.mtx", "%%MatrixMarket matrix array real general\n2 1\n1.0\n1.0\n");
    let own = text(&scratch, "own.toml").replace("velocity = \"v.mtx\"", "velocity = \"short.mtx\"");
    scratch.write("short.toml", own);
    for (arguments, place) in [
        ("signorini --format vtu", "--format"),
        ("own.toml --beta-s 1 --frame-every 0", "--frame-every"),
        ("blocks.toml --time-step -1", "--time-step"),
        ("blocks.toml --fraction 0", "--fraction"),
        ("blocks.toml --every 0", "--every"),
        (
            "blocks.toml --scheme mass-redistribution --mass consistent --relative-courant -2",
            "--relative-courant",
        ),
        ("still.toml", "impact"),
        ("short.toml", "short.mtx"),
        ("blocks.toml --time-step 1e-30", "duration"),
    ] {
        let outcome = run(IMPACT, &scratch, arguments);
        assert_eq!(outcome.status, 2, "{arguments}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(place), "{arguments}: {}", outcome.stderr);
        assert!(!scratch.path().join("figures").exists(), "{arguments}");
    }
    let explained = run(IMPACT, &scratch, "blocks.toml --beta-s 1 --explain").succeeded();
    assert!(explained.contains("bytes") && explained.contains("56 unknowns, 6 contacts"), "{explained}");
}

#[test]
fn a_share_of_the_limit_is_one_of_the_limit_of_each_scheme() {
    let scratch = Scratch::new("impact-fraction");
    let options = "signorini --elements 10 --mass lumped --beta-s 1e6 --scheme central-difference,predictor-corrector,lagrange";
    let csv = run(IMPACT, &scratch, &format!("{options} --fraction 0.9 --stdout csv -q")).succeeded();
    let found = numbers(&csv, "relative_courant");
    // At r = 1 the predictor-corrector stands C = 1/2 where beta_s is large: C^2 = 1/(2 beta_s) + 1/4.
    for (found, limit) in found.iter().zip([1.0, (0.25 + 0.5e-6_f64).sqrt(), 1.0]) {
        assert!((found / (0.9 * limit) - 1.0).abs() < 1e-9, "{found} {limit}");
    }
}

#[test]
fn opening_contact_of_a_mesh_is_measured_below_its_limit() {
    let scratch = Scratch::new("impact-opening");
    blocks(&scratch);
    let options = "blocks.toml --contact opening --beta-s 10,1e4 --ratio 0.25,1 --fraction 0.5,0.99 \
                   --scheme central-difference,predictor-corrector,buffered --format csv -q --out out";
    run(VERIFY, &scratch, options).succeeded();
    let is = |name: &&String| name.contains("opening-blocks") && name.ends_with(".csv");
    let rows = text(&scratch, scratch.files().iter().find(is).unwrap());
    assert_eq!(rows.lines().count(), 1 + 3 * 2 * 2 * 2);
    let (schemes, gains, steps) =
        (column(&rows, "scheme"), numbers(&rows, "energy_gain"), numbers(&rows, "steps"));
    let proven = |scheme: &String| scheme != "central-difference";
    for ((scheme, gain), steps) in schemes.iter().zip(&gains).zip(steps) {
        assert!(!proven(scheme) || *gain <= 4.0 * f64::EPSILON * steps, "{scheme} {gain}");
    }
    let central = schemes.iter().zip(&gains).filter(|(scheme, _)| !proven(scheme));
    assert!(central.map(|(_, gain)| *gain).fold(0.0, f64::max) > 1e-3, "central differences gain nothing?");
    assert!(column(&rows, "elements").iter().all(|n| n == "18"));
    let own = run(VERIFY, &scratch, "still.toml --contact opening --beta-s 1");
    assert_eq!(own.status, 2);
}

#[test]
fn the_studies_of_impact_show_what_the_readme_says() {
    let scratch = Scratch::new("impact-studies");
    let csv = run(STUDIES, &scratch, "--quick penalty oscillation --stdout csv -q").succeeded();
    let rows: Vec<(String, String, f64)> = column(&csv, "study")
        .into_iter()
        .zip(column(&csv, "scheme"))
        .zip(numbers(&csv, "force_error"))
        .map(|((study, scheme), error)| (study, scheme, error))
        .collect();
    let of = |scheme: &str| -> Vec<f64> {
        rows.iter().filter(|row| row.0 == "penalty" && row.1 == scheme).map(|row| row.2).collect()
    };
    for scheme in ["predictor-corrector", "park"] {
        let (errors, central) = (of(scheme), of("central-difference"));
        assert!((errors[1] - errors[2]).abs() < 1e-3, "{scheme} depends on a large beta_s: {errors:?}");
        assert!(errors[1] < 0.5 * central[1], "{scheme} {errors:?} {central:?}");
    }
}
