//! Every option that `--help` of a tool shows is used here, and its effect is looked at, not only its exit status.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use std::collections::BTreeSet;
use std::path::Path;

use Seen::{All, Column, Holds, Other, Refused};
use tool::{Outcome, Scratch, run_program};

/// The tools, each with arguments that make a run of a moment.
const TOOLS: [(&str, &str, &str); 8] = [
    ("stability-map", env!("CARGO_BIN_EXE_stability-map"), POINTS),
    ("optimal-ratio", env!("CARGO_BIN_EXE_optimal-ratio"), POINTS),
    ("scheme-limits", env!("CARGO_BIN_EXE_scheme-limits"), BAR),
    ("contact-impact", env!("CARGO_BIN_EXE_contact-impact"), IMPACT),
    ("verify-limits", env!("CARGO_BIN_EXE_verify-limits"), POINTS),
    ("extreme-cases", env!("CARGO_BIN_EXE_extreme-cases"), "density"),
    ("step-speed", env!("CARGO_BIN_EXE_step-speed"), ""),
    ("map-speed", env!("CARGO_BIN_EXE_map-speed"), ""),
];

const BAR: &str = "signorini --elements 2 --mass lumped";
const POINTS: &str = "signorini --elements 2 --mass lumped --beta-s 1,2";
const IMPACT: &str = "signorini --elements 4 --mass lumped --beta-s 1 --scheme park";

/// What a run must show; the records are those of `--stdout csv`.
#[derive(Clone, Copy)]
enum Seen {
    /// This column of the records has these values, row by row.
    Column(&'static str, &'static [&'static str]),
    /// This column has this value in every row.
    All(&'static str, &'static str),
    /// The records are others than those of the run with these arguments.
    Other(&'static str),
    /// Exit status 2 and a message with this word.
    Refused(&'static str),
    /// With `--out there --format csv`, the files pass.
    Holds(fn(&Scratch)),
}

/// tool, option, all arguments, what must be seen.
const USES: &[(&str, &str, &str, Seen)] = &[
    (
        "stability-map",
        "--elements",
        "hunek --elements 3 --mass lumped --beta-s 1 --ratio 1",
        Column("elements", &["9"]),
    ),
    (
        "stability-map",
        "--mass",
        "signorini --mass 0.3,lumped --beta-s 1 --ratio 1",
        Column("gamma", &["0.3", "1.0"]),
    ),
    (
        "stability-map",
        "--penalty-mass",
        "symmetric --mass lumped --beta-s 5 --ratio 0.5 --penalty-mass diagonalised",
        Other("symmetric --mass lumped --beta-s 5 --ratio 0.5"),
    ),
    (
        "stability-map",
        "--beta-s",
        "signorini --mass lumped --beta-s lin:1:3:3 --ratio 1",
        Column("stiffness_penalty", &["1.0", "2.0", "3.0"]),
    ),
    (
        "stability-map",
        "--ratio",
        "signorini --mass lumped --beta-s 1 --ratio 3,inf",
        Column("ratio", &["3.0", "inf"]),
    ),
    (
        "stability-map",
        "--relative-courant",
        "signorini --mass lumped --limit predictor-corrector --beta-s 1e3 --ratio plastic --relative-courant 0.25",
        Holds(|scratch| {
            // dt^2 s' mu = 1 at this step: eight roundings on the way to the limit that is printed.
            let records = text(scratch, "there/signorini-lumped.csv");
            let courant: f64 = column(&records, "critical_courant")[0].parse().unwrap();
            assert!((courant / 0.25 - 1.0).abs() < 8.0 * f64::EPSILON, "{courant}");
        }),
    ),
    (
        "stability-map",
        "--limit",
        "signorini --mass lumped --beta-s 1 --ratio 1 --limit park",
        Column("limit", &["park"]),
    ),
    (
        "stability-map",
        "--theta",
        "signorini --mass lumped --beta-s 1 --ratio 1 --limit park --theta 0",
        Other("signorini --mass lumped --beta-s 1 --ratio 1 --limit park"),
    ),
    (
        "stability-map",
        "--engine",
        "signorini --mass lumped --beta-s 1 --ratio 2 --engine sturm",
        Column("engine", &["sturm"]),
    ),
    (
        "optimal-ratio",
        "--elements",
        "hunek --elements 3 --mass lumped --beta-s 1",
        Column("elements", &["9"]),
    ),
    ("optimal-ratio", "--mass", "signorini --mass 0.3,lumped --beta-s 1", Column("gamma", &["0.3", "1.0"])),
    (
        "optimal-ratio",
        "--penalty-mass",
        "symmetric --elements 2 --mass lumped --beta-s 1 --penalty-mass diagonalised",
        Other("symmetric --elements 2 --mass lumped --beta-s 1"),
    ),
    (
        "optimal-ratio",
        "--beta-s",
        "signorini --mass lumped --beta-s lin:1:3:3",
        Column("stiffness_penalty", &["1.0", "2.0", "3.0"]),
    ),
    (
        "optimal-ratio",
        "--limit",
        "signorini --mass lumped --beta-s 1e3 --limit predictor-corrector",
        Column("limit", &["predictor-corrector"]),
    ),
    // Every ratio costs the Park scheme a step, whatever theta: the refusal of a wrong one shows that it is read.
    (
        "optimal-ratio",
        "--theta",
        "signorini --mass lumped --beta-s 1 --limit park --theta 2",
        Refused("theta"),
    ),
    ("optimal-ratio", "--engine", "signorini --mass lumped --beta-s 1 --engine dense", All("holds", "true")),
    ("scheme-limits", "--elements", "hunek --elements 1 --mass lumped", All("elements", "3")),
    ("scheme-limits", "--mass", "signorini --elements 2 --mass 0.3", All("gamma", "0.3")),
    (
        "scheme-limits",
        "--penalty-mass",
        "symmetric --elements 2 --mass lumped --penalty-mass diagonalised",
        Refused("diagonalised"),
    ),
    ("scheme-limits", "--theta", "signorini --elements 2 --mass lumped --theta 0", Other(BAR)),
    (
        "contact-impact",
        "--elements",
        "signorini --elements 3 --mass lumped --beta-s 1 --scheme park",
        Column("steps", &["18"]),
    ),
    (
        "contact-impact",
        "--mass",
        "signorini --elements 4 --mass 0.3,lumped --beta-s 1 --scheme park",
        Column("mass", &["0.3", "lumped"]),
    ),
    (
        "contact-impact",
        "--beta-s",
        "signorini --elements 4 --mass lumped --beta-s 1,1e3 --scheme park",
        Column("stiffness_penalty", &["1.0", "1000.0"]),
    ),
    (
        "contact-impact",
        "--ratio",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --ratio 2,3",
        Column("ratio", &["2.0", "3.0"]),
    ),
    (
        "contact-impact",
        "--scheme",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme predictor-corrector,park",
        Column("scheme", &["predictor-corrector", "park"]),
    ),
    // T = 0.3 s, h/c0 = 0.025 s: 12 steps at C = 1, 48 at C = 1/4.
    (
        "contact-impact",
        "--relative-courant",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --relative-courant 0.25",
        Column("steps", &["48"]),
    ),
    (
        "contact-impact",
        "--theta",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --theta 1",
        Other(IMPACT),
    ),
    (
        "contact-impact",
        "--duration",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --duration 0.1",
        Column("steps", &["8"]),
    ),
    (
        "contact-impact",
        "--stress-at",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --stress-at 0.1",
        Holds(|scratch| assert_eq!(stress_times(scratch), ["0.1"; 4])),
    ),
    (
        "contact-impact",
        "--every",
        "signorini --elements 4 --mass lumped --beta-s 1 --scheme park --every 10",
        Holds(|scratch| {
            let history = text(scratch, "there/signorini-lumped-park-beta1-r1.csv");
            assert_eq!(column(&history, "time"), ["0.0", "0.125", "0.25", "0.30000000000000004"]);
        }),
    ),
    (
        "verify-limits",
        "--elements",
        "hunek --elements 2 --mass lumped --beta-s 1 --ratio 1",
        Column("elements", &["6"]),
    ),
    (
        "verify-limits",
        "--mass",
        "signorini --elements 1 --mass 0.3,lumped --beta-s 1 --ratio 1",
        Column("gamma", &["0.3", "1.0"]),
    ),
    (
        "verify-limits",
        "--beta-s",
        "signorini --elements 1 --mass lumped --beta-s 1,2 --ratio 1",
        Column("stiffness_penalty", &["1.0", "2.0"]),
    ),
    (
        "verify-limits",
        "--ratio",
        "signorini --elements 1 --mass lumped --beta-s 1 --ratio 2,inf",
        Column("ratio", &["2.0", "inf"]),
    ),
    (
        "verify-limits",
        "--scheme",
        "signorini --elements 1 --mass lumped --beta-s 1 --ratio 1 --scheme central-difference",
        Column("scheme", &["central-difference"]),
    ),
    (
        "verify-limits",
        "--penalty-mass",
        "symmetric --elements 1 --mass lumped --beta-s 1 --ratio 1 --penalty-mass diagonalised",
        Refused("diagonalised"),
    ),
    (
        "verify-limits",
        "--tolerance",
        "signorini --elements 1 --mass lumped --beta-s 1 --ratio 2 --tolerance 1e-2",
        Other("signorini --elements 1 --mass lumped --beta-s 1 --ratio 2"),
    ),
    ("step-speed", "--repeats", "--repeats 0", Refused("--repeats")),
    ("map-speed", "--points", "--points 1", Refused("2 to")),
];

/// The options that mean the same in every tool that has them.
const SHARED: [&str; 9] = [
    "--out",
    "--format",
    "--stdout",
    "--threads",
    "--explain",
    "--quiet",
    "--completions",
    "--help",
    "--version",
];

fn program(tool: &str) -> &'static str {
    TOOLS.iter().find(|(name, ..)| *name == tool).unwrap_or_else(|| panic!("{tool} is not in TOOLS")).1
}

fn run(tool: &str, scratch: &Scratch, arguments: &str) -> Outcome {
    run_program(program(tool), scratch, &arguments.split_whitespace().collect::<Vec<_>>())
}

fn text(scratch: &Scratch, file: &str) -> String {
    String::from_utf8(scratch.read(file)).unwrap()
}

/// A column of a CSV without quoted commas.
fn column<'a>(csv: &'a str, name: &str) -> Vec<&'a str> {
    let mut lines = csv.lines();
    let header = lines.next().unwrap_or_else(|| panic!("no records"));
    let at = header.split(',').position(|known| known == name).unwrap_or_else(|| panic!("{name}: {header}"));
    lines.map(|line| line.split(',').nth(at).unwrap()).collect()
}

/// The long options that `--help` shows, by the lines that begin with one.
fn shown(tool: &str, scratch: &Scratch) -> BTreeSet<String> {
    let help = run(tool, scratch, "--help").succeeded();
    let option = |line: &str| {
        let line = line.trim_start();
        let long = if line.starts_with("--") { line } else { line.strip_prefix('-')?.split_once(", ")?.1 };
        let end = long.find(|c: char| !(c.is_ascii_alphanumeric() || c == '-')).unwrap_or(long.len());
        long.starts_with("--").then(|| long[..end].to_owned())
    };
    help.lines().filter_map(option).collect()
}

#[test]
fn every_tool_is_here() {
    let manifest = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let names = manifest["bin"].as_array().unwrap().iter().map(|bin| bin["name"].as_str().unwrap());
    let known: BTreeSet<&str> = TOOLS.iter().map(|(name, ..)| *name).collect();
    assert_eq!(names.collect::<BTreeSet<_>>(), known, "add the new tool to TOOLS in tests/options.rs");
}

#[test]
fn every_option_of_help_has_a_use() {
    let scratch = Scratch::new("uses");
    let mut wrong = Vec::new();
    for (tool, ..) in TOOLS {
        let shown = shown(tool, &scratch);
        assert!(shown.len() >= 3, "{tool}: {shown:?}");
        let used: BTreeSet<&str> =
            USES.iter().filter(|(of, ..)| *of == tool).map(|(_, option, ..)| *option).collect();
        for option in shown.iter().filter(|option| !SHARED.contains(&option.as_str())) {
            if !used.contains(option.as_str()) {
                wrong.push(format!(
                    "{tool} --help shows {option}, which nothing uses: add to USES in tests/options.rs\n    \
                     (\"{tool}\", \"{option}\", \"<arguments with {option}>\", Column(\"<column>\", &[\"<values>\"])),\n\
                     or another Seen that shows its effect"
                ));
            }
        }
        for option in used.iter().filter(|option| !shown.contains(**option)) {
            wrong.push(format!("{tool} --help shows no {option}: take it out of USES in tests/options.rs"));
        }
    }
    for (tool, option, arguments, _) in USES {
        if !arguments.contains(option) {
            wrong.push(format!("the use of {option} of {tool} does not use it: {arguments}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_option_does_what_it_says() {
    for (i, (tool, option, arguments, seen)) in USES.iter().enumerate() {
        let scratch = Scratch::new(&format!("use-{i}"));
        let place = format!("{tool} {arguments}");
        let records =
            |arguments: &str| run(tool, &scratch, &format!("{arguments} --stdout csv -q")).succeeded();
        match seen {
            Column(name, values) => assert_eq!(column(&records(arguments), name), *values, "{place}"),
            All(name, value) => {
                let records = records(arguments);
                let column = column(&records, name);
                assert!(
                    !column.is_empty() && column.iter().all(|found| found == value),
                    "{place}: {column:?}"
                );
            }
            Other(without) => {
                assert_ne!(records(arguments), records(without), "{place}: {option} does nothing")
            }
            Refused(word) => {
                let out = run(tool, &scratch, arguments);
                assert!(
                    out.status == 2 && out.stderr.contains(word),
                    "{place}: {} {}",
                    out.status,
                    out.stderr
                );
            }
            Holds(check) => {
                let out = run(tool, &scratch, &format!("{arguments} --format csv --out there -q"));
                assert_eq!(out.succeeded(), "", "{place}");
                check(&scratch);
            }
        }
    }
}

#[test]
fn the_shared_options_mean_the_same_everywhere() {
    for (tool, _, sample) in TOOLS {
        let scratch = Scratch::new(&format!("shared-{tool}"));
        let shown = shown(tool, &scratch);
        for option in SHARED.iter().filter(|option| shown.contains(**option)) {
            let scratch = Scratch::new(&format!("shared-{tool}{option}"));
            shared(tool, option, sample, &scratch, &shown);
        }
        for option in ["--completions", "--help", "--version"] {
            assert!(shown.contains(option), "{tool} has no {option}");
        }
    }
}

/// One shared option of one tool.
fn shared(tool: &str, option: &str, sample: &str, scratch: &Scratch, shown: &BTreeSet<String>) {
    let go = |arguments: &str| run(tool, scratch, arguments);
    let place = format!("{tool} {option}");
    match option {
        "--out" => {
            assert_eq!(go(&format!("{sample} --out a/b --format csv -q")).succeeded(), "");
            let files = scratch.files();
            assert!(
                !files.is_empty() && files.iter().all(|file| file.starts_with("a/b/")),
                "{place}: {files:?}"
            );
        }
        "--format" => {
            go(&format!("{sample} --format json,svg --out out -q")).succeeded();
            let files = scratch.files();
            assert!(files.iter().any(|file| file.ends_with(".json")), "{place}: {files:?}");
            assert!(files.iter().all(|file| file.ends_with(".json") || file.ends_with(".svg")), "{files:?}");
        }
        "--stdout" => {
            let csv = go(&format!("{sample} --stdout csv -q")).succeeded();
            let json = go(&format!("{sample} --stdout json -q")).succeeded();
            let json: serde_json::Value = serde_json::from_str(&json).unwrap();
            let rows = json["rows"].as_array().unwrap().len();
            assert!(rows > 0 && csv.lines().count() == rows + 1, "{place}: {csv}");
            assert_eq!(scratch.files(), Vec::<String>::new(), "{place} wrote files");
        }
        "--threads" => {
            let [one, two] =
                [1, 2].map(|n| go(&format!("{sample} --stdout csv -q --threads {n}")).succeeded());
            assert_eq!(one, two, "{place}");
            let refused = go(&format!("{sample} --threads 0"));
            assert!(refused.status == 2 && refused.stderr.contains("1 to 1024"), "{}", refused.stderr);
        }
        "--explain" => {
            let text = go(&format!("{sample} --explain")).succeeded();
            assert!(text.contains("left out"), "{place}: {text}");
            assert_eq!(scratch.files(), Vec::<String>::new(), "{place} wrote files");
        }
        "--quiet" => {
            assert_eq!(go(&format!("{sample} --stdout csv --quiet")).stderr, "");
            assert_ne!(go(&format!("{sample} --stdout csv")).stderr, "", "{tool} has no summary");
        }
        "--completions" => {
            for shell in ["bash", "zsh", "fish"] {
                let script = go(&format!("--completions {shell}")).succeeded();
                for word in shown.iter().map(|option| option.trim_start_matches('-')).chain([tool]) {
                    assert!(script.contains(word), "{place} {shell}: no {word}");
                }
            }
            assert_eq!(go("--completions tcsh").status, 2);
        }
        "--help" => {
            let help = go("--help").succeeded();
            for word in [&format!("Usage: {tool}"), "Examples:", &format!("\n  {tool}")] {
                assert!(help.contains(word), "{place}: no {word:?}");
            }
        }
        "--version" => {
            assert_eq!(go("--version").succeeded(), format!("{tool} {}\n", env!("CARGO_PKG_VERSION")));
        }
        _ => panic!("{option} is in SHARED and not looked at"),
    }
}

/// The times of the stress rows of the sample impact.
fn stress_times(scratch: &Scratch) -> Vec<String> {
    let records = text(scratch, "there/signorini-lumped-park-beta1-r1-stress.csv");
    column(&records, "time").into_iter().map(str::to_owned).collect()
}
