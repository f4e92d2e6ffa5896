//! Error against run time: the errors are right, the claims are held, the references are what their generator makes, and
//! each check can fail.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use bipenalty::fem::MassMatrix;
use bipenalty::schemes::SchemeName;
use precision::{
    Clock, EIGENPROBLEMS, ExactEigenvalues, Impactproblem, Measurement, Method, SIZES, Status,
    measure_eigenvalues, measure_impacts,
};

/// Times are not looked at: no repeats beyond the least, no run beyond a tenth of a second.
const CLOCK: Clock = Clock { limit: 0.1, budget: 0.0 };

fn eigenvalues(exact: &ExactEigenvalues, methods: &[Method]) -> Vec<Measurement> {
    let of = |name| measure_eigenvalues(name, &SIZES[..3], methods, exact, &CLOCK, &|| ()).unwrap();
    EIGENPROBLEMS.into_iter().flat_map(of).collect()
}

fn claiming() -> Vec<Method> {
    Method::ALL.iter().copied().filter(|method| method.claim().is_some()).collect()
}

#[test]
fn every_engine_holds_what_it_claims() {
    for m in eigenvalues(&ExactEigenvalues::built_in(), &claiming()) {
        let not_uniform = m.problem == "random-consistent" && m.method.starts_with("closed-form");
        match &m.status {
            Status::Failed(why) => assert!(not_uniform && why == "the elements of the bar differ", "{m:?}"),
            Status::TimedOut(_) => assert!(m.method == "dense" || m.method == "lapack", "{m:?}"),
            status => assert_eq!(*status, Status::Done, "{m:?}"),
        }
    }
}

/// Each reference off by 4e-13 in l, twice what an engine claims: every engine that gave a value is now called wrong.
#[test]
fn no_engine_holds_against_a_perturbed_reference() {
    let text = ExactEigenvalues::built_in().text();
    let perturb = |line: &str| {
        let field: Vec<&str> = line.split(',').collect();
        let value = field[2].parse::<f64>().map(|l| format!("{:?}", l * (1.0 + 4e-13)));
        value.map_or_else(|_| line.to_owned(), |l| [field[0], field[1], &l, "0.0"].join(","))
    };
    let perturbed: String = text.lines().map(|line| perturb(line) + "\n").collect();
    let measured = eigenvalues(&ExactEigenvalues::read(&perturbed), &claiming());
    let blind: Vec<_> = measured.iter().filter(|m| m.status == Status::Done).collect();
    assert!(blind.is_empty(), "{blind:#?}");
    assert!(measured.iter().filter(|m| matches!(m.status, Status::Wrong(_))).count() > 30);
}

/// Bounds give a step that is too small, iterations one that is too large; up to some roundings of the sums.
#[test]
fn bounds_are_safe_and_iterations_are_not() {
    let iterations = [Method::Power(30), Method::Power(300), Method::Lanczos(20), Method::Lanczos(80)];
    let rounding = 1e-14;
    let exact = ExactEigenvalues::built_in();
    let bounds = eigenvalues(&exact, &[Method::ElementBound, Method::Gershgorin]);
    assert!(bounds.iter().filter_map(|m| m.error).all(|error| error <= rounding), "{bounds:#?}");
    assert!(bounds.iter().filter_map(|m| m.error).any(|error| error < -1e-3));
    // Pure penalty: no element bounds it.
    let unbounded = |m: &&Measurement| m.problem == "stiff-lumped" && m.method == "element bound";
    assert!(bounds.iter().filter(unbounded).all(|m| m.status == Status::Failed("no bound".to_owned())));
    let iterated = eigenvalues(&exact, &iterations);
    assert!(iterated.iter().filter_map(|m| m.error).all(|error| error >= -rounding), "{iterated:#?}");
    assert!(iterated.iter().filter_map(|m| m.error).any(|error| error > 1e-4));
    // As many Lanczos steps as nodes: exact, but for the loss of orthogonality that a largest Ritz value does not feel.
    let small = iterated.iter().filter(|m| m.size == 10 && m.method.starts_with("Lanczos"));
    assert!(small.into_iter().all(|m| m.error.unwrap().abs() < rounding), "{iterated:#?}");
}

/// LAPACK's own routines on the summed matrices: backward stable, so that l errs by a few n u of the largest entry.
#[cfg(feature = "lapack")]
#[test]
fn lapack_routines_are_right() {
    let measured = eigenvalues(&ExactEigenvalues::built_in(), &[Method::Dsygvx, Method::Dsbgvx]);
    for m in measured.iter().filter(|m| m.status == Status::Done) {
        let allowed = 64.0 * m.size as f64 * f64::EPSILON;
        assert!(m.error.unwrap().abs() <= allowed, "{m:?}");
    }
    assert!(measured.iter().filter(|m| m.status == Status::Done).count() >= 16, "{measured:#?}");
}

/// The errors that analyses/peers/work_precision.py, written from the textbook, finds for the lumped Signorini impact of
/// 100 elements at C = 1/2.
#[test]
fn errors_of_impacts_are_those_of_an_independent_script() {
    let expected = [
        (
            SchemeName::PredictorCorrector,
            [0.045_472_588_037_754_45, 0.093_676_741_665_746_74, 0.007_475_489_926_560_834],
        ),
        (
            SchemeName::CentralDifference,
            [0.669_694_721_649_799_6, 0.159_265_816_255_263_5, 0.009_582_683_664_785_667],
        ),
    ];
    for (scheme, errors) in expected {
        let impact = Impactproblem::new("signorini", MassMatrix::LUMPED, scheme, 100, 0.5).unwrap();
        let found = impact.errors().unwrap().unwrap();
        for ((quantity, found), expected) in found.named().into_iter().zip(errors) {
            // 600 steps of 64 roundings each, whose gaps beta_s = 1e4 magnifies into forces.
            let allowed = 600.0 * 64.0 * 1e4 * f64::EPSILON;
            assert!(
                (found / expected - 1.0).abs() < allowed,
                "{scheme:?} {quantity}: {found} instead of {expected}"
            );
        }
    }
}

#[test]
fn what_blows_up_stays_in_the_table() {
    let impact = |courant| {
        let scheme = SchemeName::PredictorCorrector;
        Impactproblem::new("signorini", MassMatrix::LUMPED, scheme, 50, courant).unwrap()
    };
    let rows = measure_impacts(&[impact(0.5), impact(1.5)], &CLOCK, &|| ()).unwrap();
    assert_eq!(rows.len(), 6);
    assert!(rows[..3].iter().all(|m| m.status == Status::Done && m.point().is_some()));
    assert!(rows[3..].iter().all(|m| matches!(&m.status, Status::Failed(why) if why.starts_with("blew up"))));
    assert!(rows[3..].iter().all(|m| m.point().is_none()));
}

#[test]
fn a_run_that_would_take_too_long_is_not_made() {
    let exact = ExactEigenvalues::built_in();
    let clock = Clock { limit: 1e-9, budget: 0.0 };
    let rows = measure_eigenvalues("wall-consistent", &SIZES[..2], &[Method::Dense], &exact, &clock, &|| ())
        .unwrap();
    assert_eq!(rows[0].status, Status::Done);
    assert!(matches!(rows[1].status, Status::TimedOut(_)) && rows[1].point().is_none());
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

/// `None`, said aloud, where there is no Python.
fn spectra(table: &str, file: &Path, every: usize) -> Option<Output> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut command = Command::new(&python);
    command.arg(data("spectra.py")).args([table, "--every", &every.to_string(), "--check"]).arg(file);
    let output = command.output();
    if output.is_err() {
        eprintln!("SKIPPED: {python} is not here, so no reference was made anew");
    }
    output.ok()
}

#[test]
fn a_sample_of_the_spectra_is_what_the_generator_makes() {
    for (table, every) in [("critical_courant", 97), ("work_precision", 6)] {
        let Some(output) = spectra(table, &data(&format!("{table}.csv")), every) else { return };
        let told =
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && told.contains("all agree"), "{told}");
    }
}

/// Each column of a reference in turn, in the digits beyond f64 and in the f64: the generator says no.
#[test]
fn the_generator_refuses_a_perturbed_table() {
    let cases = [
        ("critical_courant", "0.577350269189625764509148780502", "0.577350269189625764509148780602"),
        ("critical_courant", "3.46410161513775458705489268301", "3.46410161513775458705489268401"),
        ("work_precision", "1.1789888349343517e-15", "1.1789888349443517e-15"),
        ("work_precision", "17.336282908921984", "17.336282908921987"),
    ];
    for (table, right, wrong) in cases {
        let text = std::fs::read_to_string(data(&format!("{table}.csv"))).unwrap();
        assert!(text.contains(right), "{right} is gone from {table}");
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{table}-{}.csv", std::process::id()));
        std::fs::write(&path, text.replacen(right, wrong, 1)).unwrap();
        // Only the first row is made anew.
        let output = spectra(table, &path, 100_000);
        std::fs::remove_file(&path).unwrap();
        let Some(output) = output else { return };
        assert!(!output.status.success(), "{table}: {wrong} was taken for {right}");
    }
}

#[test]
fn the_tool_prints_the_promised_columns() {
    let tool = env!("CARGO_BIN_EXE_work-precision");
    let arguments = ["--quick", "--peers", "none", "--stdout", "csv", "--quiet"];
    let output =
        Command::new(tool).args(arguments).current_dir(env!("CARGO_TARGET_TMPDIR")).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("family,problem,method,size,error,seconds,evaluations,status"), "{text}");
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 4 * 3 * Method::ALL.len() + 3 * 3 * 3 * 3 * 3);
    for row in &rows {
        let done = row[7] == "done";
        assert!(done == row[4].parse::<f64>().is_ok() && done == row[5].parse::<f64>().is_ok(), "{row:?}");
        assert!(!done || row[5].parse::<f64>().unwrap() > 0.0, "{row:?}");
    }
    assert!(rows.iter().any(|row| row[8] == "true"));
}

#[test]
fn peers_that_are_not_there_are_refused() {
    let tool = env!("CARGO_BIN_EXE_work-precision");
    let output = Command::new(tool).args(["--peers", "/no/python", "--quick"]).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("--peers: /no/python") && output.stdout.is_empty(), "{message}");
}
