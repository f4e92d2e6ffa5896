//! What the files of an impact say by themselves: energies that close, runs that gain, errors of every step.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use tool::{Scratch, run_program};

const CONTACT_IMPACT: &str = env!("CARGO_BIN_EXE_contact-impact");

/// The cells of a CSV text by name of column; quoted cells have no comma here.
fn column<'a>(csv: &'a str, name: &str) -> Vec<&'a str> {
    let at = csv.lines().next().unwrap().split(',').position(|known| known == name).expect(name);
    csv.lines().skip(1).map(|line| line.split(',').nth(at).unwrap()).collect()
}

fn numbers(csv: &str, name: &str) -> Vec<f64> {
    column(csv, name).iter().map(|cell| cell.parse().unwrap()).collect()
}

fn impact(scratch: &Scratch, arguments: &str) -> String {
    let words: Vec<&str> = arguments.split_whitespace().collect();
    run_program(CONTACT_IMPACT, scratch, &words).succeeded()
}

/// From the file alone, with the bar of the bouncing-bar scene for gravity and hunek for two bars. Each step rounds the
/// sums of the balance, so that it may drift by 4 epsilon a step of the largest of them.
#[test]
fn the_balance_closes_from_the_file_alone() {
    let scratch = Scratch::new("balance");
    let schemes = ["central-difference", "predictor-corrector", "park"];
    for scene in ["signorini", "hunek", "bouncing-bar"] {
        for mass in ["lumped", "consistent"] {
            impact(
                &scratch,
                &format!("{scene} --mass {mass} --beta-s 1,1e4 --every 7 --format csv --out out -q"),
            );
            for (scheme, beta_s) in schemes.iter().flat_map(|scheme| [(scheme, "1"), (scheme, "1e4")]) {
                let name = format!("out/{scene}-{mass}-{scheme}-beta{beta_s}-r1.csv");
                let csv = String::from_utf8(scratch.read(&name)).unwrap();
                let terms = ["kinetic_energy", "strain_energy", "penalty_energy", "loss", "body_work"];
                let terms = terms.map(|term| numbers(&csv, term));
                let largest = terms.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
                let balance = |i: usize| terms[..4].iter().map(|term| term[i]).sum::<f64>() - terms[4][i];
                let rows = terms[0].len();
                let allowed = 4.0 * f64::EPSILON * (7 * rows) as f64 * largest;
                let worst = (0..rows).map(|i| (balance(i) - balance(0)).abs()).fold(0.0, f64::max);
                assert!(rows > 80 && worst <= allowed, "{name}: {worst:e} > {allowed:e} in {rows} rows");
                assert!(terms[2].iter().any(|held| *held > 0.0), "{name}: no contact");
                assert_eq!(terms[4].iter().any(|work| *work != 0.0), scene == "bouncing-bar", "{name}");
            }
        }
    }
}

/// Central differences at 0.95 of the linear limit of the striker gain; the predictor-corrector at r = 1/4 does not.
#[test]
fn a_run_that_gains_energy_says_so() {
    let scratch = Scratch::new("gain");
    let striker = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/striker-on-rod.toml");
    let usual = "--mass lumped --beta-s 10,1e4 --relative-courant 0.95 --stdout csv";
    let words = |rest: &str| format!("{striker} {usual} {rest}");
    let gained = words("--ratio 1 --scheme central-difference");
    let out = run_program(CONTACT_IMPACT, &scratch, &gained.split(' ').collect::<Vec<_>>());
    assert_eq!(out.status, 0, "{}", out.stderr);
    let endings = ["finished with 5.0 times its energy", "finished with 31.2 times its energy"];
    assert_eq!(column(&out.stdout, "ending"), endings);
    assert!(
        out.stderr.contains("2 of 2 runs ended with more energy than they were given, from contact"),
        "{}",
        out.stderr
    );
    let kept = words("--ratio 0.25 --scheme predictor-corrector");
    let out = run_program(CONTACT_IMPACT, &scratch, &kept.split(' ').collect::<Vec<_>>());
    assert_eq!(column(&out.stdout, "ending"), ["finished"; 2]);
    assert!(!out.stderr.contains("more energy"), "{}", out.stderr);
    // A sum that swings above its start while contact has added nothing is not called a gain.
    let swings =
        "signorini --mass lumped --beta-s 1e4 --relative-courant 0.95 --stdout csv --scheme buffered";
    let out = run_program(CONTACT_IMPACT, &scratch, &swings.split(' ').collect::<Vec<_>>());
    assert_eq!(column(&out.stdout, "ending"), ["finished with 1.00098 times its energy (none from contact)"]);
    assert!(!out.stderr.contains("more energy"), "{}", out.stderr);
}

/// A bar that never touches keeps its energy to rounding: no gain is seen where there is none.
#[test]
fn rounding_is_no_gain() {
    let scratch = Scratch::new("rounding");
    let csv =
        impact(&scratch, "bouncing-bar --mass lumped,consistent --beta-s 1e4 --duration 0.9 --stdout csv -q");
    assert_eq!(column(&csv, "ending"), ["finished"; 6], "{csv}");
    assert_eq!(column(&csv, "switches"), ["0"; 6]);
}

/// Errors are those of every step: how sparse the rows are changes no digit.
#[test]
fn sparse_rows_change_no_error() {
    let scratch = Scratch::new("sparse");
    let row = |every: &str| {
        impact(
            &scratch,
            &format!(
                "signorini hunek --mass lumped --beta-s 1e4 --every {every} --out {every} --format csv -q"
            ),
        );
        String::from_utf8(scratch.read(&format!("{every}/summary.csv"))).unwrap()
    };
    let dense = row("1");
    assert!(numbers(&dense, "force_error").iter().all(|error| *error > 0.0));
    for every in ["50", "18446744073709551615"] {
        assert_eq!(row(every), dense);
    }
}

/// What central differences store in a closed contact, s g^2/2 + m w^2/2, from the gaps of the file: w at the time of a row is
/// the mean of the gap rates on either side. The balance alone would close without it, as the loss is what it leaves.
#[test]
fn the_contact_stores_what_its_gaps_say() {
    let scratch = Scratch::new("stored");
    impact(
        &scratch,
        "signorini --mass lumped --beta-s 1,10 --scheme central-difference --format csv --out out -q",
    );
    for beta_s in [1.0, 10.0] {
        let csv = scratch.read(&format!("out/signorini-lumped-central-difference-beta{beta_s}-r1.csv"));
        let csv = String::from_utf8(csv).unwrap();
        let [time, gap, stored] = ["time", "relative_gap", "penalty_energy"].map(|name| numbers(&csv, name));
        // h = 0.1 m, EA/h = 1e3 N/m, c0 = 100 m/s: omega_e^2 = 4 (c0/h)^2.
        let (length, stiffness) = (0.1, 1e3 * beta_s);
        let mass = stiffness / 4e6;
        let largest = stored.iter().copied().fold(0.0, f64::max);
        let mut moving = 0;
        for i in 1..gap.len() - 1 {
            if gap[i - 1..=i + 1].iter().any(|gap| *gap <= 0.0) {
                continue;
            }
            let rate = length * (gap[i + 1] - gap[i - 1]) / (time[i + 1] - time[i - 1]);
            let [spring, inertia] = [0.5 * stiffness * (length * gap[i]).powi(2), 0.5 * mass * rate * rate];
            // A gap, its rate and their squares: some 20 roundings, of a rate of the size of g/dt.
            assert!((stored[i] - spring - inertia).abs() <= 1e-12 * largest, "row {i} of {beta_s}");
            moving += usize::from(inertia > 1e-3 * largest);
        }
        assert!(moving > 10, "{beta_s}: {moving} rows");
    }
}
