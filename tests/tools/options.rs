//! Every option that `--help` of a tool shows is used here, and its effect is looked at, not only its exit status.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use std::collections::BTreeSet;
use std::path::Path;

#[path = "options/uses.rs"]
mod uses;

use tool::{Outcome, Scratch, run_program};
use uses::Seen::{All, Column, Holds, Other, Refused};
use uses::{BAR, IMPACT, POINTS, USES, column};

/// The tools, each with arguments that make a run of a moment.
const TOOLS: [(&str, &str, &str); 11] = [
    ("stability-map", env!("CARGO_BIN_EXE_stability-map"), POINTS),
    ("optimal-ratio", env!("CARGO_BIN_EXE_optimal-ratio"), POINTS),
    ("scheme-limits", env!("CARGO_BIN_EXE_scheme-limits"), BAR),
    ("contact-impact", env!("CARGO_BIN_EXE_contact-impact"), IMPACT),
    ("verify-limits", env!("CARGO_BIN_EXE_verify-limits"), POINTS),
    ("mesh-limits", env!("CARGO_BIN_EXE_mesh-limits"), "rules --quick"),
    ("impact-studies", env!("CARGO_BIN_EXE_impact-studies"), "penalty --quick"),
    ("extreme-cases", env!("CARGO_BIN_EXE_extreme-cases"), "density"),
    ("work-precision", env!("CARGO_BIN_EXE_work-precision"), "--quick --peers none"),
    ("step-speed", env!("CARGO_BIN_EXE_step-speed"), ""),
    ("map-speed", env!("CARGO_BIN_EXE_map-speed"), ""),
];

/// The options that mean the same in every tool that has them.
const SHARED: [&str; 10] = [
    "--out",
    "--format",
    "--width",
    "--stdout",
    "--threads",
    "--explain",
    "--quiet",
    "--completions",
    "--help",
    "--version",
];

/// The options of how figures look, the same ones in every tool, with a run of `stability-map` and a value that changes it.
const STYLE: [(&str, &str, &str); 12] = [
    ("--style", "s.toml", CURVES),
    ("--title", "own", CURVES),
    ("--no-title", "", CURVES),
    ("--x-label", "across", CURVES),
    ("--y-label", "up", CURVES),
    ("--x-limits", "0.5:7", CURVES),
    ("--y-limits", "0.5:7", CURVES),
    ("--levels", "0.9", MAP),
    ("--colour-map", "grey", MAP),
    ("--tags", "", PANELS),
    ("--text", "text", CURVES),
    ("--overlay", "", PANELS),
];
const CURVES: &str = "signorini --elements 2 --mass lumped --beta-s 1,2,4 --ratio 1,2";
const MAP: &str = "signorini --elements 2 --mass lumped --beta-s log:0.1:10:13 --ratio log:0.1:10:13";
const PANELS: &str = "signorini symmetric --elements 2 --mass lumped --beta-s 1,2,4 --ratio 2 --overlay";

fn is_style(option: &str) -> bool {
    STYLE.iter().any(|(style, ..)| *style == option)
}

#[test]
fn every_option_of_style_changes_the_drawing() {
    for (option, value, sample) in STYLE {
        let scratch = Scratch::new(&format!("style{option}"));
        scratch.write("s.toml", "title = \"from a file\"\n");
        let drawn = |arguments: &str| {
            let arguments = format!("{arguments} --format svg --out out -q");
            run("stability-map", &scratch, &arguments).succeeded();
            let all: Vec<_> = scratch.files().into_iter().map(|file| (scratch.read(&file), file)).collect();
            std::fs::remove_dir_all(scratch.path().join("out")).unwrap();
            all
        };
        let without = sample.replace(option, "");
        assert!(drawn(&without) != drawn(&format!("{without} {option} {value}")), "{option} does nothing");
    }
}

/// Runs whose figures have a logarithmic axis across or up, of every tool that draws.
const LOGARITHMIC: [(&str, &str, &str); 10] = [
    ("stability-map", "signorini --elements 2 --mass lumped --beta-s log:0.1:10:5 --ratio 1,2", "x"),
    ("stability-map", MAP, "y"),
    ("optimal-ratio", "signorini --elements 2 --mass lumped --beta-s log:1:1e4:3", "x"),
    ("scheme-limits", "signorini --elements 2 --mass lumped", "y"),
    ("scheme-limits", "signorini --elements 2 --mass lumped --per-force --beta-s log:1:100:5", "x"),
    ("contact-impact", "signorini --elements 3 --mass lumped --beta-s 1", "y"),
    ("verify-limits", "signorini --elements 2 --mass lumped --beta-s log:1:10:3 --ratio 1", "x"),
    ("mesh-limits", "rules --quick", "y"),
    ("impact-studies", "penalty --quick", "x"),
    ("work-precision", "--quick --peers none", "y"),
];

#[test]
fn what_cannot_be_drawn_is_refused_before_anything_is_written() {
    for (tool, arguments, axis) in LOGARITHMIC {
        let scratch = Scratch::new(&format!("undrawn-{tool}"));
        scratch.write("limits.toml", format!("{axis}_limits = [0, 10]\n"));
        for style in [format!("--{axis}-limits 0:10"), "--style limits.toml".to_owned()] {
            let out = run(tool, &scratch, &format!("{arguments} {style}"));
            assert!(
                out.status == 2 && out.stderr.contains("cannot show 0"),
                "{tool} {style}: {}",
                out.stderr
            );
            assert_eq!(scratch.files(), Vec::<String>::new(), "{tool} {style}");
            // What draws nothing has no axes.
            assert!(
                tool != "stability-map"
                    || run(tool, &scratch, &format!("{arguments} {style} --stdout csv")).status == 0
            );
        }
    }
    let scratch = Scratch::new("undrawn-shape");
    scratch.write("titles.toml", "title = [\"one\", \"two\", \"three\"]\n");
    let long = format!("--x-label {}", "x".repeat(200));
    let wrong = [
        (PANELS.replace(" --overlay", ""), "--style titles.toml", "3 titles"),
        (format!("signorini symmetric {}", &MAP["signorini ".len()..]), "--overlay", "maps"),
        (CURVES.to_owned(), "--x-limits 100:200", "nothing lies within"),
        (CURVES.to_owned(), long.as_str(), "shorten it"),
    ];
    for (arguments, style, why) in wrong {
        let out = run("stability-map", &scratch, &format!("{arguments} {style}"));
        assert!(out.status == 2 && out.stderr.contains(why), "{style}: {} {}", out.status, out.stderr);
        assert_eq!(scratch.files(), Vec::<String>::new(), "{style}");
    }
}

fn program(tool: &str) -> &'static str {
    TOOLS.iter().find(|(name, ..)| *name == tool).unwrap_or_else(|| panic!("{tool} is not in TOOLS")).1
}

fn run(tool: &str, scratch: &Scratch, arguments: &str) -> Outcome {
    run_program(program(tool), scratch, &arguments.split_whitespace().collect::<Vec<_>>())
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
    assert_eq!(names.collect::<BTreeSet<_>>(), known, "add the new tool to TOOLS in tests/tools/options.rs");
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
        for option in shown.iter().filter(|o| !SHARED.contains(&o.as_str()) && !is_style(o)) {
            if !used.contains(option.as_str()) {
                wrong.push(format!(
                    "{tool} --help shows {option}, which nothing uses: add to USES in tests/options/uses.rs\n    \
                     (\"{tool}\", \"{option}\", \"<arguments with {option}>\", Column(\"<column>\", &[\"<values>\"])),\n\
                     or another Seen that shows its effect"
                ));
            }
        }
        for option in used.iter().filter(|option| !shown.contains(**option)) {
            wrong.push(format!(
                "{tool} --help shows no {option}: take it out of USES in tests/options/uses.rs"
            ));
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
        "--width" => {
            for (width, millimetres) in [("single", "90mm"), ("double", "190mm")] {
                go(&format!("{sample} --width {width} --format svg --out out -q")).succeeded();
                for file in scratch.files() {
                    let svg = String::from_utf8(scratch.read(&file)).unwrap();
                    assert!(svg.contains(&format!("width=\"{millimetres}\"")), "{place}: {file}");
                }
            }
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
            // The records of work-precision are times, of which no two are the same.
            assert!(one == two || tool == "work-precision", "{place}");
            let refused = go(&format!("{sample} --threads 0"));
            assert!(refused.status == 2 && refused.stderr.contains("1 to 1024"), "{}", refused.stderr);
        }
        "--explain" => {
            let text = go(&format!("{sample} --explain")).succeeded();
            let words: Vec<&str> = text.split_whitespace().collect();
            assert!(words.join(" ").contains("left out"), "{place}: {text}");
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
            assert!(help.contains(&format!("Usage: {tool}")), "{place}: {help}");
            let (_, examples) =
                help.split_once("Examples:\n").unwrap_or_else(|| panic!("{place}: no examples"));
            for line in examples.lines().filter(|line| !line.is_empty()) {
                // What is longer than 100 characters is broken, and can't be copied.
                assert!(line.starts_with(&format!("  {tool}")), "{place}: a broken example: {line:?}");
            }
        }
        "--version" => {
            assert_eq!(go("--version").succeeded(), format!("{tool} {}\n", env!("CARGO_PKG_VERSION")));
        }
        _ => panic!("{option} is in SHARED and not looked at"),
    }
}
