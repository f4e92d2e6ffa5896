//! Inputs that are too large or too much alike: refused with what they need, or answered by another engine.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use tool::{Scratch, run};

/// Identical bars have eigenvalues closer together than the closed form rounds. Every point of every such row must be
/// certified, each by the engine that is named, and the values are those of the Sturm engine.
#[test]
fn auto_certifies_rows_of_identical_bars() {
    let scratch = Scratch::new("identical");
    let mut fell_back = 0;
    for (bars, elements, contrast) in [(36, 4, 1.0), (36, 1, 1.0), (150, 2, 1.0), (24, 3, 1e9)] {
        let bar = |i: usize| {
            let stiffness = if i.is_multiple_of(2) { 1.0 } else { contrast };
            format!("elements = {elements}\nyoungs_modulus = {stiffness:e}")
        };
        let texts: Vec<String> = (0..bars).map(bar).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        scratch.write("many.toml", tool::scene("many", "", &texts));
        let arguments = "many.toml --beta-s 0.1,1,1e4,1e8 --ratio 0.5,1,2,inf --stdout csv -q";
        let found = run(&scratch, arguments).succeeded();
        let sturm = run(&scratch, &format!("{arguments} --engine sturm")).succeeded();
        for (found, sturm) in found.lines().zip(sturm.lines()).skip(1) {
            let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
            let (found, sturm) = (cells(found), cells(sturm));
            let number = |cells: &[String], i: usize| cells[i].parse::<f64>().expect("not certified");
            assert!(["closed-form", "sturm"].contains(&found[11].as_str()), "{found:?}");
            fell_back += usize::from(found[11] == "sturm");
            let apart = number(&found, 9) > number(&sturm, 10) || number(&sturm, 9) > number(&found, 10);
            assert!(!apart, "{found:?} {sturm:?}");
        }
    }
    assert!(fell_back > 0, "nothing to fall back for");
}

/// Runs a tool with at most `kilobytes` of address space.
#[cfg(target_os = "linux")]
fn confined(scratch: &Scratch, kilobytes: u64, tool: &str, arguments: &str) -> tool::Outcome {
    let command = format!("ulimit -v {kilobytes}; exec {tool} {arguments}");
    tool::run_program("bash", scratch, &["-c", &command])
}

#[cfg(target_os = "linux")]
#[test]
fn what_the_memory_does_not_hold_is_refused_with_its_bytes() {
    let impact = env!("CARGO_BIN_EXE_contact-impact");
    let scratch = Scratch::new("memory");
    let cases = [
        (
            impact,
            "signorini --elements 100000000 --scheme park --mass lumped --beta-s 1",
            "scene signorini, elements",
        ),
        (impact, "signorini --duration 40000 --scheme park --mass lumped --beta-s 1", "--every"),
        (tool::TOOL, "signorini --mass lumped --beta-s lin:0:10:100000000 --ratio 1", "--beta-s"),
        (
            tool::TOOL,
            "signorini --mass lumped --beta-s lin:0:10:10000 --ratio lin:1:2:10000",
            "--beta-s, --ratio",
        ),
        (tool::TOOL, "signorini --elements 100000000 --mass lumped --engine sturm --beta-s 1", "elements"),
        (tool::TOOL, "signorini --elements 100000000 --mass lumped --limit park --beta-s 1", "elements"),
    ];
    for kilobytes in [1_000_000, 8_000_000] {
        for (tool, arguments, place) in &cases {
            let out = confined(&scratch, kilobytes, tool, arguments);
            assert_eq!(out.status, 2, "{arguments}: {}", out.stderr);
            for word in [place, "bytes of memory", "available", "allowed: at "] {
                assert!(out.stderr.contains(word), "{arguments}: no {word:?} in {}", out.stderr);
            }
            assert_eq!(scratch.files(), Vec::<String>::new(), "{arguments}");
        }
    }
}

/// What a refusal allows is then done.
#[cfg(target_os = "linux")]
#[test]
fn what_is_allowed_instead_fits() {
    let impact = env!("CARGO_BIN_EXE_contact-impact");
    let scratch = Scratch::new("allowed");
    let long = "signorini --duration 400 --scheme park --mass lumped --beta-s 1 --format csv,json,record,svg --out out";
    let refused = confined(&scratch, 700_000, impact, long);
    assert_eq!(refused.status, 2, "{}", refused.stderr);
    let (_, allowed) = refused.stderr.split_once("allowed: at least ").expect("a number of steps");
    let every = allowed.split(' ').next().unwrap();
    let out = confined(&scratch, 700_000, impact, &format!("{long} --every {every} --quiet"));
    assert_eq!(out.status, 0, "{}", out.stderr);
}

/// A matrix of 701 rows that the dense engine reduces, and a consistent mass of 20,000 that a step solves with: sizes at which
/// faer shares the work among the threads it is given, and returns other last digits for another number of them.
#[test]
fn no_number_depends_on_the_threads() {
    let scratch = Scratch::new("threads");
    let scene = include_str!("../../analyses/scenes/bricks.toml");
    let fine = scene.replace("[8, 4, 8]", "[20, 10, 20]").replace("[5, 5, 5]", "[12, 12, 12]");
    scratch.write("bricks.toml", fine);
    let dense = "signorini --elements 700 --mass consistent --beta-s 10 --ratio 2 --engine dense";
    let steps = "bricks.toml --scheme central-difference --mass consistent --beta-s 1 --duration 2e-6";
    for (tool, arguments) in
        [(env!("CARGO_BIN_EXE_stability-map"), dense), (env!("CARGO_BIN_EXE_contact-impact"), steps)]
    {
        let with = |threads: usize| {
            let words = format!("{arguments} --stdout csv -q --threads {threads}");
            tool::run_program(tool, &scratch, &words.split_whitespace().collect::<Vec<_>>()).succeeded()
        };
        assert_eq!(with(1), with(2), "{arguments}");
    }
}
