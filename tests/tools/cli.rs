//! The tool as its users meet it: options, records, messages, exit status.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use std::io::Read;
use std::process::{Command, Stdio};

use tool::{Scratch, TOOL, run};

const HEADER: &str = "scene,mass,gamma,elements,limit,stiffness_penalty,ratio,omega_max,critical_courant,lower,\
                      upper,engine,critical_step,step_lower,step_upper,evidence,penalty_stiffness,penalty_mass";

/// The fields of each row of a CSV without quoted commas.
fn rows(csv: &str) -> Vec<Vec<&str>> {
    csv.lines().skip(1).map(|line| line.split(',').collect()).collect()
}

fn number(field: &str) -> f64 {
    field.parse().unwrap_or_else(|_| panic!("{field:?} is not a number"))
}

#[test]
fn the_promised_point_is_right_by_every_engine() {
    let scratch = Scratch::new("promised");
    let command = "signorini --elements 200 --mass lumped --beta-s 10 --ratio 2 --stdout csv";
    for engine in ["auto", "closed-form", "secular", "sturm", "dense"] {
        let arguments = format!("{command} --engine {engine}");
        let csv =
            if engine == "auto" { run(&scratch, command) } else { run(&scratch, &arguments) }.succeeded();
        assert_eq!(csv.lines().next().unwrap(), HEADER);
        let row = &rows(&csv)[0];
        assert_eq!(row[..7], ["signorini", "lumped", "1.0", "200", "spectrum", "10.0", "2.0"]);
        let (courant, lower, upper) = (number(row[8]), number(row[9]), number(row[10]));
        assert!((courant - 0.7891948863055671).abs() <= 1e-14, "{engine}: {courant}");
        assert!(
            lower <= 0.7891948863055671 && 0.7891948863055671 <= upper && upper - lower <= 1e-13,
            "{row:?}"
        );
        // h = 10/200 and c0 = 100: omega = 2 c0/h/C_r, to the three roundings of this line.
        assert!((number(row[7]) * courant / 4000.0 - 1.0).abs() <= 2.0 * f64::EPSILON, "{row:?}");
        assert_eq!(row[11], if engine == "auto" { "closed-form" } else { engine });
    }
    assert_eq!(scratch.files(), Vec::<String>::new());
}

#[test]
fn rows_come_curve_by_curve_and_read_back() {
    let scratch = Scratch::new("rows");
    let command = "symmetric hunek --mass consistent,0.3 --beta-s 1e-3,0.1,1e12 --ratio inf,3,0.7 --stdout";
    let csv = run(&scratch, &format!("{command} csv --quiet")).succeeded();
    let found = rows(&csv);
    assert_eq!(found.len(), 2 * 2 * 3 * 3);
    let mut expected = Vec::new();
    for scene in ["symmetric", "hunek"] {
        for mass in ["consistent", "0.3"] {
            for ratio in ["inf", "3.0", "0.7"] {
                expected.extend([1e-3, 0.1, 1e12].map(|beta_s| (scene, mass, ratio, beta_s)));
            }
        }
    }
    let seen: Vec<_> = found.iter().map(|row| (row[0], row[1], row[6], number(row[5]))).collect();
    assert_eq!(seen, expected);
    let text = run(&scratch, &format!("{command} json --quiet")).succeeded();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["rows"].as_array().unwrap().len(), found.len());
    for (i, name) in HEADER.split(',').enumerate() {
        // From the text itself: serde_json reads numbers, by default, to the last bit but one.
        let key = format!("\"{name}\": ");
        let values = text.lines().filter_map(|line| line.trim().strip_prefix(&key));
        let values: Vec<&str> = values.map(|value| value.trim_matches([',', '"'])).collect();
        assert_eq!(values.len(), found.len(), "{name}");
        for (row, value) in found.iter().zip(values) {
            match name {
                "scene" | "mass" | "limit" | "engine" | "evidence" => assert_eq!(row[i], value),
                _ => assert_eq!(number(row[i]).to_bits(), number(value).to_bits(), "{name}"),
            }
        }
    }
    for row in &found {
        assert!(number(row[9]) <= number(row[8]) && number(row[8]) <= number(row[10]));
    }
    let provenance = json["provenance"].to_string();
    assert!(provenance.contains("bipenalty") && !provenance.contains('/'), "{provenance}");
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let command = "signorini three.toml --mass averaged,lumped --beta-s log:1e-3:1e12:150 --ratio log:0.1:1e3:40 \
                   --format svg,png,csv,json --out out --quiet --threads";
    let written = ["1", "2"].map(|threads| {
        let scratch = Scratch::new(&format!("threads-{threads}"));
        scratch.three_bars();
        let out = run(&scratch, &format!("{command} {threads}"));
        assert_eq!(out.succeeded(), "");
        let names = scratch.files();
        assert_eq!(names.len(), 2 * 2 * 4, "{names:?}");
        names.into_iter().map(|name| (scratch.read(&name), name)).collect::<Vec<_>>()
    });
    assert!(written[0] == written[1]);
    let starts = |ending: &str, magic: &[u8]| {
        let of_kind = written[0].iter().filter(|(_, name)| name.ends_with(ending));
        of_kind.filter(|(bytes, _)| bytes.starts_with(magic)).count()
    };
    assert_eq!((starts("png", b"\x89PNG"), starts("csv", HEADER.as_bytes())), (4, 4));
    assert_eq!((starts("svg", b"<"), starts("json", b"{")), (4, 4));
}

#[test]
fn only_what_is_asked_for_is_written() {
    let scratch = Scratch::new("formats");
    run(&scratch, "symmetric --mass lumped --beta-s lin:0:10:11 --format pdf,json --out a/b").succeeded();
    assert_eq!(scratch.files(), ["a/b/symmetric-lumped.json", "a/b/symmetric-lumped.pdf"]);
    assert!(scratch.read("a/b/symmetric-lumped.pdf").starts_with(b"%PDF"));
    let json: serde_json::Value = serde_json::from_slice(&scratch.read("a/b/symmetric-lumped.json")).unwrap();
    assert_eq!(json["rows"].as_array().unwrap().len(), 11 * 5);
    // Without --out: figures/<tool>, and another window than the usual one in a folder of its own below it.
    let mut expected = scratch.files();
    let windows = [
        ("", ""),
        ("--beta-s 1 --ratio 1", "beta1-r1/"),
        ("--beta-s 1,2 --ratio 1", "beta1-2-r1/"),
        ("--stiffness log:1e2:1e6:50", "slog-100-1e6-50/"),
        ("--ratio plastic --relative-courant 0.7 --beta-s 10", "beta10-rplastic-courant0.7/"),
    ];
    for (window, folder) in windows {
        run(&scratch, &format!("signorini --mass 0.3 {window} --format csv --quiet")).succeeded();
        expected.push(format!("figures/stability-map/{folder}signorini-0.3.csv"));
    }
    run(&scratch, "signorini --mass 0.3 --time-step 1e-4 --format csv --quiet").succeeded();
    expected.push("figures/stability-map/step1e-4/signorini-0.3-step.csv".to_owned());
    expected.sort();
    assert_eq!(scratch.files(), expected);
}

#[test]
fn the_other_options_do_what_they_say() {
    let scratch = Scratch::new("options");
    let point = "symmetric --mass lumped --beta-s 5 --ratio 0.5 --stdout csv";
    let consistent = run(&scratch, &format!("{point} --penalty-mass consistent")).succeeded();
    let diagonalised = run(&scratch, &format!("{point} --penalty-mass diagonalised")).succeeded();
    assert_ne!(rows(&consistent)[0][8], rows(&diagonalised)[0][8]);
    let other = run(&scratch, &format!("{point} --limit central-difference")).succeeded();
    assert_eq!(rows(&other)[0][4], "central-difference");
    assert_eq!(rows(&other)[0][7], "", "omega_max is the spectrum's alone");
    assert_eq!(rows(&other)[0][8], rows(&consistent)[0][8]);
    let version = run(&scratch, "--version").succeeded();
    assert!(version.contains(env!("CARGO_PKG_VERSION")), "{version}");
    // Elements of the first bar; the second keeps its proportion of two to one.
    let remeshed =
        run(&scratch, "hunek --elements 3 --beta-s 1 --ratio 1 --mass lumped --stdout csv").succeeded();
    assert_eq!(rows(&remeshed)[0][3], "9");
}

/// A text whose lines were broken.
fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn explain_computes_and_writes_nothing() {
    let scratch = Scratch::new("explain");
    // A map that would take days by this engine.
    let days =
        "signorini --elements 10000000 --engine sturm --beta-s lin:0:10:10000 --ratio lin:1:2:1000 --explain";
    let text = unwrapped(&run(&scratch, days).succeeded());
    assert!(text.contains("sturm") && text.contains("10000 x 1000 points"), "{text}");
    let text = run(&scratch, "--explain").succeeded();
    assert!(
        text.contains("fig3-1-lumped") && text.contains("closed-form") && text.contains("left out"),
        "{text}"
    );
    assert_eq!(scratch.files(), Vec::<String>::new());
}

#[test]
fn quiet_is_silent_and_loud_answers_the_question() {
    let scratch = Scratch::new("quiet");
    let point = "hunek --mass lumped --beta-s 10 --ratio 1 --stdout csv";
    for quiet in ["--quiet", "-q"] {
        let out = run(&scratch, &format!("{point} {quiet}"));
        assert_eq!(out.stderr, "");
        out.succeeded();
    }
    let loud = run(&scratch, point);
    // h = 0.2 and c0 = 100, so dt = 2e-3 s, less the margin of the enclosure.
    assert!(loud.stderr.contains("linear limit of closed contact dt = 1.99999999999"), "{}", loud.stderr);
}

#[test]
fn a_reader_that_stops_early_is_no_error() {
    let many = "signorini --beta-s log:1e-3:1e12:20000 --stdout csv --quiet";
    for arguments in [many, "--explain", "signorini --explain"] {
        let mut child = Command::new(TOOL)
            .args(arguments.split(' '))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        if arguments == many {
            let mut first = [0; 5];
            child.stdout.as_mut().unwrap().read_exact(&mut first).unwrap();
            assert_eq!(&first, b"scene");
        }
        drop(child.stdout.take());
        let out = child.wait_with_output().unwrap();
        assert_eq!(String::from_utf8_lossy(&out.stderr), "", "{arguments}");
        assert_eq!(out.status.code(), Some(0), "{arguments}");
    }
    // Nor is one who does not want the summary.
    let scratch = Scratch::new("no reader");
    let (tool, step_speed) = (TOOL, env!("CARGO_BIN_EXE_step-speed"));
    for (tool, arguments) in [(tool, "signorini --ratio 1 --out ."), (step_speed, "--repeats 1")] {
        let mut child = Command::new(tool)
            .args(arguments.split(' '))
            .current_dir(scratch.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().unwrap().code(), Some(0), "{arguments}");
    }
}

/// 300 decades, lists out of order and with repetition, a path with a space, odd names: legal, if unusual.
#[test]
fn odd_but_legal_input_is_computed() {
    let scratch = Scratch::new("odd folder");
    scratch.three_bars();
    let stdout = "--mass lumped --stdout csv --quiet";
    let count = |arguments: &str| rows(&run(&scratch, &format!("{arguments} {stdout}")).succeeded()).len();
    assert_eq!(count("signorini --beta-s log:1e-300:1e290:50 --ratio 1"), 50);
    assert_eq!(count("signorini --beta-s 3,1,1,0 --ratio 2,inf,2,0.5"), 16);
    assert_eq!(count("signorini --elements 1000000 --beta-s 1 --ratio 2"), 1);
    assert_eq!(count("signorini signorini --beta-s 1 --ratio 2"), 2);
    scratch
        .write("two words.toml", tool::scene("A-1", "left = \"fixed\"\nright = \"wall\"", &["elements = 1"]));
    let out = Command::new(TOOL)
        .args(["two words.toml", "--beta-s", "1", "--ratio", "1", "--stdout", "csv", "--mass", "lumped"])
        .current_dir(scratch.path())
        .output()
        .unwrap();
    assert_eq!(out.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&out.stdout).contains("A-1,lumped,1.0,1,"));
    assert_eq!(count("three.toml --beta-s 1 --ratio 1"), 1);
    // A scene without any contact: the penalties act on nothing.
    scratch.write("alone.toml", tool::scene("alone", "", &["elements = 4"]));
    assert_eq!(count("alone.toml --beta-s 0,1e16 --ratio 0.1,inf"), 4);
}

/// What a heavy penalty mass leaves uncertified is an error row and status 1, never a silent number.
#[test]
fn what_cannot_be_certified_is_an_error_row() {
    let scratch = Scratch::new("uncertified");
    scratch
        .write("pinned.toml", tool::scene("pinned", "left = \"fixed\"\nright = \"wall\"", &["elements = 1"]));
    // One node under 1e7 times its own mass, far below what the rounding of its stiffness allows to certify.
    let out = run(&scratch, "pinned.toml --mass lumped --beta-s 1 --ratio 1e-7 --stdout csv");
    let row = out.stdout.lines().nth(1).unwrap();
    if out.status == 1 {
        assert!(row.ends_with(",,,,\"closed-form, not certified\""), "{row}");
        assert!(out.stderr.contains("not certified"), "{}", out.stderr);
    } else {
        assert_eq!(out.status, 0);
        assert!(number(row.split(',').nth(8).unwrap()) > 0.0, "{row}");
    }
}

/// The limits of the schemes: C^2 = 1/(2 beta_s) + 1/(4 r) for the predictor-corrector on a lumped bar, the same rule
/// solved for r by `--ratio plastic`, and the 0.7072 of the Park scheme at theta = 1/2; theta = 0 allows more.
#[test]
fn the_limit_of_a_scheme_is_not_the_limit_of_the_spectrum() {
    let scratch = Scratch::new("schemes");
    let courant = |arguments: &str| {
        let command = format!("signorini --elements 10 --mass lumped --stdout csv -q {arguments}");
        let rows = run(&scratch, &command).succeeded();
        let row = rows.lines().nth(1).unwrap().to_owned();
        assert!(row.split(',').nth(7).unwrap().is_empty(), "omega_max belongs to the spectrum: {row}");
        number(row.split(',').nth(8).unwrap())
    };
    let near = |found: f64, expected: f64, allowed: f64| {
        assert!((found / expected - 1.0).abs() < allowed, "{found}")
    };
    // Ten roundings between the options and the printed value.
    near(courant("--limit predictor-corrector --beta-s 1 --ratio 1"), 0.75f64.sqrt(), 10.0 * f64::EPSILON);
    near(courant("--limit central-difference --beta-s 1 --ratio 1"), 1.0, 10.0 * f64::EPSILON);
    let plastic = "--limit predictor-corrector --beta-s 1e4 --ratio plastic --relative-courant 0.5";
    near(courant(plastic), 0.5, 10.0 * f64::EPSILON);
    // Given to four digits.
    near(courant("--limit park --beta-s 1e4 --ratio 1"), 0.7072, 0.5e-4 / 0.7072);
    assert!(courant("--limit park --theta 0 --beta-s 1e4 --ratio 1") > 0.75);
}

#[test]
fn a_scene_without_a_name_has_that_of_its_file() {
    let scratch = Scratch::new("nameless");
    scratch.three_bars();
    let text = String::from_utf8(scratch.read("three.toml")).unwrap();
    let nameless: String =
        text.lines().filter(|line| !line.starts_with("name")).map(|l| format!("{l}\n")).collect();
    assert_ne!(text, nameless);
    scratch.write("my three_bars.toml", nameless);
    let program = Command::new(TOOL)
        .current_dir(scratch.path())
        .args(["my three_bars.toml", "--mass", "lumped", "--beta-s", "1", "--ratio", "1", "--stdout", "csv"])
        .output()
        .unwrap();
    let records = String::from_utf8(program.stdout).unwrap();
    assert!(records.lines().nth(1).unwrap().starts_with("my-three_bars,lumped,"), "{records}");
}

#[test]
fn another_limit_or_mesh_has_files_of_its_own() {
    let scratch = Scratch::new("stems");
    let point = "signorini --mass lumped --beta-s 1 --ratio 1 --out there --format csv --quiet";
    for more in
        ["", "--limit park", "--limit park --theta 1", "--elements 3", "--limit noh-bathe --parameter 0.6"]
    {
        run(&scratch, &format!("{point} {more}")).succeeded();
    }
    let stems = ["-n3", "-noh-bathe-parameter0.6", "-park-theta1", "-park", ""];
    assert_eq!(scratch.files(), stems.map(|stem| format!("there/signorini-lumped{stem}.csv")));
}

#[cfg(unix)]
#[test]
fn bash_completes_scenes_and_their_files() {
    let scratch = Scratch::new("completions");
    scratch.three_bars();
    scratch.write("notes.txt", "");
    scratch.write("c.bash", run(&scratch, "--completions bash").succeeded());
    let offered = |line: &[&str]| {
        let words = line.join(" ");
        let script = format!(
            "source ./c.bash; COMP_WORDS=({words} ''); COMP_CWORD={}; f=$(complete -p stability-map); f=${{f##*-F }}; \
             ${{f%% *}} stability-map '' {}; echo \"${{COMPREPLY[*]}}\"",
            line.len(),
            line[line.len() - 1]
        );
        let bash = Command::new("bash").current_dir(scratch.path()).args(["-c", &script]).output();
        String::from_utf8(bash.unwrap().stdout).unwrap()
    };
    assert_eq!(offered(&["stability-map"]).trim(), "signorini symmetric hunek bouncing-bar three.toml");
    assert!(offered(&["stability-map", "signorini"]).contains("hunek"));
    let limits = offered(&["stability-map", "--limit"]);
    assert!(limits.contains("park") && !limits.contains("hunek"), "{limits}");
}

#[test]
fn the_plan_groups_mass_matrices_and_tells_time_and_memory() {
    let scratch = Scratch::new("plan");
    let plan = run(&scratch, "--explain").succeeded();
    assert!(plan.lines().all(|line| line.len() <= 100), "{plan}");
    let plan = unwrapped(&plan);
    // What holds for the mass matrices of the family, or of a figure, is said once.
    for of_several in
        ["(1 element, 0.05 mass)", "fig1-lumped, fig1-averaged, fig1-consistent: 401 x 2 points"]
    {
        assert_eq!(plan.matches(of_several).count(), 1, "{plan}");
    }
    assert!(
        plan.contains("MB of memory for the records, about ") && plan.contains(" s of one core"),
        "{plan}"
    );
    // Of a mesh that is factorised, too; patches were not timed.
    let plan = |more: &str| {
        let blocks = "/analyses/scenes/two-blocks.toml";
        run(
            &scratch,
            &format!("{}{blocks} {more} --explain", env!("CARGO_MANIFEST_DIR").trim_end_matches("/analyses")),
        )
        .succeeded()
    };
    assert!(
        unwrapped(&plan("")).contains(" s of one core")
            && !unwrapped(&plan("--patch 2")).contains(" s of one core")
    );
}
