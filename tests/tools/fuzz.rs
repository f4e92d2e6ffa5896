//! What users type, at random: scene files, ranges and whole command lines are taken or refused in words, never with a panic.
//! PROPTEST_CASES and PROPTEST_RNG_SEED widen the search.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;
#[path = "common/tool.rs"]
mod tool;

use std::cell::{Cell, RefCell};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use bipenalty::error::Error;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{BUILT_IN, Scene, load};
use bipenalty::spectrum::Engine as _;
use bipenalty::stability::{Model, Sweep};
use common::config;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tool::Scratch;

/// Numbers as TOML and as options may hold them, sensible and not.
fn any_number() -> impl Strategy<Value = String> {
    const ODD: &[&str] = &[
        "0",
        "-0.0",
        "1",
        "-1",
        "0.5",
        "1e-300",
        "1e300",
        "1e308",
        "5e-324",
        "inf",
        "-inf",
        "nan",
        "NaN",
        "1e999",
        "1_0",
        "0x10",
        "100000000",
        "100000001",
        "9223372036854775807",
        "-9223372036854775808",
        "1e",
        "1.",
        "+3",
        "1979-05-27",
        "",
        "true",
    ];
    prop_oneof![
        proptest::sample::select(ODD).prop_map(str::to_owned),
        any::<f64>().prop_map(|x| x.to_string()),
        (-320.0..320.0).prop_map(|x: f64| format!("1e{x:.0}")),
        any::<i64>().prop_map(|i| i.to_string()),
        (1..30).prop_map(|i: i32| i.to_string()),
    ]
}

/// One change of a scene file, line by line.
#[derive(Debug, Clone)]
enum Change {
    /// Another value for the key of a line.
    Value(usize, String),
    /// Another key.
    Key(usize, String),
    Remove(usize),
    Repeat(usize),
    Insert(usize, String),
    /// The file ends in the middle of this byte.
    Cut(usize),
}

fn any_change() -> impl Strategy<Value = Change> {
    const KEYS: &[&str] = &[
        "name", "length", "elements", "density", "area", "velocity", "gaps", "gravity", "duration", "left",
        "colour", "", "\"\"", "a.b", "é",
    ];
    let values = || {
        prop_oneof![
            4 => any_number(),
            1 => "\\PC{0,12}",
            1 => proptest::collection::vec(any_number(), 0..4).prop_map(|list| format!("[{}]", list.join(", "))),
            1 => proptest::sample::select(&["\"free\"", "\"fixed\"", "\"wall\"", "\"\"", "{}", "[]", "'x'"][..])
                .prop_map(str::to_owned),
        ]
    };
    const LINES: &[&str] = &[
        "[impact]",
        "[[bar]]",
        "[bar]",
        "[ends]",
        "[[impact]]",
        "gaps = [0.0, 0.0]",
        "gravity = 1e300",
        "left = \"wall\"",
        "]",
        "\u{feff}",
        "=",
        "\"",
        "bar = []",
        "impact = 3",
    ];
    let at = || 0..40_usize;
    prop_oneof![
        6 => (at(), values()).prop_map(|(i, value)| Change::Value(i, value)),
        1 => (at(), proptest::sample::select(KEYS)).prop_map(|(i, key)| Change::Key(i, key.to_owned())),
        1 => at().prop_map(Change::Remove),
        1 => at().prop_map(Change::Repeat),
        2 => (at(), proptest::sample::select(LINES)).prop_map(|(i, line)| Change::Insert(i, line.to_owned())),
        1 => (at(), "\\PC{0,20}").prop_map(|(i, line)| Change::Insert(i, line)),
        1 => (0..600_usize).prop_map(Change::Cut),
    ]
}

fn changed(text: &str, changes: &[Change]) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut cut = None;
    for change in changes {
        let at = |i: usize| i % lines.len().max(1);
        match change.clone() {
            Change::Cut(at) => cut = Some(at),
            Change::Insert(i, line) => lines.insert(at(i), line),
            _ if lines.is_empty() => (),
            Change::Value(i, value) => {
                let i = at(i);
                let key = lines[i].split('=').next().unwrap().to_owned();
                lines[i] = format!("{key}= {value}");
            }
            Change::Key(i, key) => {
                let i = at(i);
                let value = lines[i].split_once('=').map_or("1", |(_, value)| value).to_owned();
                lines[i] = format!("{key} ={value}");
            }
            Change::Remove(i) => drop(lines.remove(at(i))),
            Change::Repeat(i) => lines.insert(at(i), lines[at(i)].clone()),
        }
    }
    let text = lines.join("\n");
    let end = cut.unwrap_or(usize::MAX).min(text.len());
    String::from_utf8_lossy(&text.as_bytes()[..end]).into_owned()
}

/// The message names the file and a line that it has.
fn check_message(message: &str, path: &str, text: &str) -> Result<(), TestCaseError> {
    let line = message.strip_prefix(path).and_then(|rest| rest.strip_prefix(", line ")).and_then(|rest| {
        let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
        digits.parse::<usize>().ok()
    });
    let lines = text.split('\n').count();
    prop_assert!(line.is_some_and(|line| (1..=lines).contains(&line)), "{message}\nof\n{text}");
    Ok(())
}

/// What is accepted can be worked with: a limit comes out, or words.
fn check_scene(scene: Scene) -> Result<(), TestCaseError> {
    let model = Model::new(scene, MassMatrix::AVERAGED, PenaltyMass::Consistent);
    let (beta_s, ratio) = (StiffnessPenalty::new(10.0).unwrap(), Ratio::new(2.0).unwrap());
    if model.check(beta_s, ratio).is_err() {
        return Ok(());
    }
    let engine = model.closed_form();
    if let Ok(l) = engine.enclose(&model.penalty(beta_s, ratio), None) {
        let step = model.critical_step(l);
        prop_assert!(step.lower <= step.critical_courant && step.critical_courant <= step.upper, "{step:?}");
        prop_assert!(step.lower > 0.0 && step.upper.is_finite(), "{step:?}");
    }
    Ok(())
}

#[test]
fn any_scene_file_is_read_or_refused_with_its_line() {
    let scratch = Scratch::new("fuzz-scene");
    let path = scratch.path().join("scene.toml").to_str().unwrap().to_owned();
    let strategy = (0..BUILT_IN.len(), proptest::collection::vec(any_change(), 0..4));
    let (read, refused) = (Cell::new(0), Cell::new(0));
    let outcome = TestRunner::new(config(2000)).run(&strategy, |(i, changes)| {
        let text = changed(BUILT_IN[i].1, &changes);
        scratch.write("scene.toml", &text);
        let loaded = load(&path);
        refused.set(refused.get() + usize::from(loaded.is_err()));
        match loaded {
            Ok(scene) => {
                read.set(read.get() + 1);
                check_scene(scene)
            }
            Err(Error::Refused(refusal)) => {
                prop_assert!(!refusal.value.is_empty() && !refusal.allowed.is_empty(), "{refusal}");
                check_message(&refusal.to_string(), &path, &text)
            }
            Err(error @ Error::SceneFile { .. }) => check_message(&error.to_string(), &path, &text),
            Err(other) => Err(TestCaseError::fail(format!("{other}\nof\n{text}"))),
        }
    });
    outcome.unwrap();
    // A search that only meets refusals, or none, has missed its aim.
    assert!(read.get() > 100 && refused.get() > 100, "{} read, {} refused", read.get(), refused.get());
}

/// Range specifications of up to five parts. Counts stay below 1e5 or are refused: more would only take memory.
fn any_range() -> impl Strategy<Value = String> {
    let kind = proptest::sample::select(&["lin", "log", "", "LIN", "cube"][..]);
    let count = prop_oneof![
        (0..2000_i64).prop_map(|n| n.to_string()),
        Just("1e3".to_owned()),
        Just("1e12".to_owned()),
        Just("2.5".to_owned())
    ];
    let range =
        (kind, any_number(), any_number(), count).prop_map(|(kind, a, b, n)| format!("{kind}:{a}:{b}:{n}"));
    let ordered =
        (any::<bool>(), -300.0..300.0, 0.0..300.0_f64, 2..500_usize).prop_map(|(log, low, more, n)| {
            let high = f64::min(low + more + 0.01, 308.0);
            format!("{}:1e{low:.0}:1e{:.0}:{n}", if log { "log" } else { "lin" }, high.max(low + 1.0))
        });
    let list = proptest::collection::vec(any_number(), 0..5).prop_map(|list| list.join(","));
    prop_oneof![3 => range, 3 => ordered, 3 => list, 1 => "\\PC{0,20}"]
}

#[test]
fn any_range_is_an_axis_or_refused() {
    TestRunner::new(config(4000))
        .run(&any_range(), |text| {
            match text.parse::<Sweep>() {
                Ok(axis) => {
                    prop_assert!(!axis.values.is_empty(), "{text}");
                    if text.contains(':') {
                        prop_assert!(axis.values.iter().all(|x| x.is_finite()), "{text}: {:?}", axis.values);
                        prop_assert!(axis.values.is_sorted(), "{text}: {:?}", axis.values);
                    }
                }
                Err(refusal) => {
                    prop_assert!(
                        !refusal.allowed.is_empty() && !refusal.place.is_empty(),
                        "{text}: {refusal}"
                    );
                }
            }
            Ok(())
        })
        .unwrap();
}

/// A tool, and what keeps its runs short.
const TOOLS: [(&str, &[&str]); 7] = [
    (env!("CARGO_BIN_EXE_stability-map"), &[]),
    (env!("CARGO_BIN_EXE_optimal-ratio"), &[]),
    (env!("CARGO_BIN_EXE_contact-impact"), &[]),
    (env!("CARGO_BIN_EXE_scheme-limits"), &["--explain"]),
    (env!("CARGO_BIN_EXE_verify-limits"), &["--explain"]),
    (env!("CARGO_BIN_EXE_extreme-cases"), &["--explain"]),
    (env!("CARGO_BIN_EXE_work-precision"), &["--explain"]),
];

/// Option values, most of them sensible, so that some command lines as a whole are.
const OPTIONS: [(&str, &[&str]); 17] = [
    ("--elements", &["1", "2", "7", "20", "0", "-1", "1e3", "x"]),
    ("--mass", &["lumped", "averaged,consistent", "0.25", "1.5", "heavy", ""]),
    ("--beta-s", &["0,1", "1e4", "lin:0:10:3", "log:1e-3:1e300:4", "-1", "inf", "log:0:1:3", "1:2"]),
    ("--ratio", &["1", "0.5,inf", "log:0.1:10:3", "0", "nan", "plastic"]),
    ("--limit", &["spectrum", "central-difference", "predictor-corrector", "park", "sky"]),
    ("--engine", &["auto", "closed-form", "secular", "sturm", "dense", "lapack", "steam"]),
    ("--scheme", &["park", "central-difference,predictor-corrector", "newmark"]),
    ("--relative-courant", &["0.5", "0.1", "1.5", "0", "1e-300", "nan"]),
    ("--theta", &["0", "0.5", "1", "2", "-1"]),
    ("--duration", &["0.01", "0.1", "0", "inf"]),
    ("--stress-at", &["0", "0.01", "-1", "nan", "1e300"]),
    ("--tolerance", &["1e-3", "0", "2", "nan"]),
    ("--penalty-mass", &["consistent", "diagonalised", "none"]),
    ("--stdout", &["csv", "json", "xml"]),
    ("--format", &["csv", "json,csv", "gif"]),
    ("--threads", &["1", "2", "0"]),
    ("--peers", &["none"]),
];

#[derive(Debug, Clone)]
struct CommandLine {
    tool: usize,
    words: Vec<String>,
}

fn any_command_line() -> impl Strategy<Value = CommandLine> {
    let option =
        (0..OPTIONS.len(), any::<proptest::sample::Index>(), any::<bool>()).prop_map(|(i, value, joined)| {
            let (name, values) = OPTIONS[i];
            let value = values[value.index(values.len())];
            if joined { vec![format!("{name}={value}")] } else { vec![name.to_owned(), value.to_owned()] }
        });
    let garbage = prop_oneof![
        "\\PC{0,8}",
        any_number(),
        Just("--quiet".to_owned()),
        Just("--explain".to_owned()),
        Just("--".to_owned())
    ];
    let option = prop_oneof![9 => option, 1 => garbage.prop_map(|word| vec![word])];
    let scene = proptest::sample::select(
        &["signorini", "symmetric", "hunek", "bouncing-bar", "missing.toml", "bars.toml"][..],
    );
    let options = proptest::collection::vec(option, 0..5);
    (0..TOOLS.len(), proptest::option::weighted(0.9, scene), options).prop_map(|(tool, scene, options)| {
        let mut words: Vec<String> = TOOLS[tool].1.iter().map(|word| (*word).to_owned()).collect();
        words.extend(scene.map(str::to_owned));
        // What is not asked for takes long; a later option of the same name is refused as a repetition, which is fine.
        let asked = |name: &str| options.iter().flatten().any(|word| word.starts_with(name));
        if !asked("--beta-s") && TOOLS[tool].1.is_empty() {
            words.extend(["--beta-s", "1,1e4"].map(str::to_owned));
        }
        words.extend(options.into_iter().flatten());
        CommandLine { tool, words }
    })
}

/// Runs a command line for at most half a minute.
fn run(scratch: &Scratch, line: &CommandLine) -> (Option<i32>, String, String) {
    let (out, err) = (scratch.path().with_extension("out"), scratch.path().with_extension("err"));
    let file = |path: &std::path::Path| Stdio::from(std::fs::File::create(path).unwrap());
    let mut command = Command::new(TOOLS[line.tool].0);
    command.args(&line.words).current_dir(scratch.path()).stdin(Stdio::null());
    let mut child = command.stdout(file(&out)).stderr(file(&err)).spawn().unwrap();
    let begun = Instant::now();
    let status = loop {
        match child.try_wait().unwrap() {
            Some(status) => break status.code(),
            None if begun.elapsed() > Duration::from_secs(30) => {
                child.kill().unwrap();
                child.wait().unwrap();
                break None;
            }
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    };
    let read = |path| String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    (status, read(out), read(err))
}

#[test]
fn any_command_line_ends_with_a_status_that_is_promised() {
    let scratch = Scratch::new("fuzz-options");
    scratch.write("bars.toml", tool::scene("bars", "left = \"wall\"", &["elements = 3", "density = 2.0"]));
    let seen = RefCell::new([0_usize; 3]);
    TestRunner::new(config(250))
        .run(&any_command_line(), |line| {
            let (status, stdout, stderr) = run(&scratch, &line);
            let name = TOOLS[line.tool].0.rsplit('/').next().unwrap();
            let told = format!("{name} {:?}\nstatus {status:?}\n{stderr}", line.words);
            let files = scratch.files();
            let _ = std::fs::remove_dir_all(scratch.path().join("figures"));
            prop_assert!(matches!(status, Some(0..=2)), "{told}");
            prop_assert!(!stderr.contains("panicked"), "{told}");
            seen.borrow_mut()[status.unwrap() as usize] += 1;
            let silent = line.words.iter().any(|word| word == "--explain" || word.starts_with("--stdout"));
            if status == Some(2) {
                prop_assert!(files.is_empty() && stdout.is_empty(), "{told} left {files:?} and\n{stdout}");
                prop_assert!(stderr.contains("error: "), "{told}");
            }
            if silent {
                prop_assert!(files.is_empty(), "{told} left {files:?}");
            }
            for number in ["NaN", "nan"] {
                let of = stdout.split(|c: char| !c.is_alphanumeric()).any(|word| word == number);
                prop_assert!(!of, "{told} printed\n{stdout}");
            }
            Ok(())
        })
        .unwrap();
    let [done, _, refused] = *seen.borrow();
    assert!(done > 20 && refused > 20, "{done} done, {refused} refused");
}

/// Found by the search: runs without contact have no penetration to draw.
#[test]
fn runs_without_penetration_are_no_error() {
    let scratch = Scratch::new("fuzz-found");
    let contact_impact = TOOLS.iter().position(|(tool, _)| tool.ends_with("contact-impact")).unwrap();
    for arguments in ["--duration 0.001", "--beta-s 1e4 --ratio inf --scheme predictor-corrector"] {
        let words = format!("signorini --mass lumped {arguments}");
        let words = words.split(' ').map(str::to_owned).collect();
        let (status, _, stderr) = run(&scratch, &CommandLine { tool: contact_impact, words });
        assert!(matches!(status, Some(0 | 1)), "{arguments}: {status:?} {stderr}");
    }
}
