//! `--from FILE.csv`: the figure of earlier records, drawn again.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use tool::{Outcome, Scratch, run, run_program};

/// What a run drew, and the same drawn from its CSV.
fn both(
    scratch: &Scratch,
    stem: &str,
    first: Outcome,
    again: impl Fn(&Scratch, &str) -> Outcome,
) -> [String; 2] {
    assert_eq!(first.status, 0, "{}", first.stderr);
    let out = again(scratch, &format!("--from one/{stem}.csv --format svg,csv --out two --quiet"));
    assert_eq!((out.status, out.stdout.as_str()), (0, ""), "{}", out.stderr);
    assert!(scratch.read(&format!("one/{stem}.csv")) == scratch.read(&format!("two/{stem}.csv")), "{stem}");
    ["one", "two"].map(|folder| String::from_utf8(scratch.read(&format!("{folder}/{stem}.svg"))).unwrap())
}

#[test]
fn curves_are_the_same_bytes() {
    let grids = [
        "hunek --mass averaged,0.3",
        "symmetric --mass averaged,0.3 --beta-s log:1e-2:1e4:40 --ratio 3,1,inf",
        "signorini --mass averaged,0.3 --limit park --beta-s 10,0,1 --ratio 1,2",
    ];
    for (i, grid) in grids.into_iter().enumerate() {
        let scratch = Scratch::new(&format!("curves-{i}"));
        let scene = grid.split(' ').next().unwrap();
        for mass in ["averaged", "0.3"] {
            let first = run(&scratch, &format!("{grid} --format svg,csv --out one --quiet"));
            let [one, two] = both(&scratch, &format!("{scene}-{mass}"), first, run);
            assert!(one == two, "{grid}");
        }
    }
}

#[test]
fn the_figures_of_the_paper_are_the_same_bytes() {
    let scratch = Scratch::new("paper");
    run(&scratch, "--mass consistent --format svg,csv --out one --quiet").succeeded();
    for stem in ["mass-matrices", "fig1-consistent", "fig3-1-consistent", "fig3-100-consistent"] {
        let first = run(&scratch, "--version");
        let [one, two] = both(&scratch, stem, first, run);
        assert!(one == two, "{stem}");
    }
}

#[test]
fn a_map_differs_by_nothing_but_its_contour_lines() {
    let scratch = Scratch::new("map");
    let axes = "--beta-s log:1e-3:1e6:91 --ratio log:0.1:1e3:65";
    let first = run(&scratch, &format!("symmetric --mass lumped {axes} --format svg,csv --out one --quiet"));
    let [one, two] = both(&scratch, "symmetric-lumped", first, run);
    // Contour lines are drawn as casing and line, in white and black; the words in their gaps move with them.
    let image = |svg: &str| svg.lines().find(|line| line.starts_with("<image")).unwrap().to_owned();
    assert!(image(&one) == image(&two));
    let labels = |svg: &str| -> Vec<String> {
        svg.split("aria-label=\"").skip(1).map(|rest| rest.split('"').next().unwrap().to_owned()).collect()
    };
    assert_eq!(labels(&one), labels(&two));
}

#[test]
fn optimal_ratios_are_the_same_bytes() {
    let tool = |scratch: &Scratch, arguments: &str| {
        let words: Vec<&str> = arguments.split_whitespace().collect();
        run_program(env!("CARGO_BIN_EXE_optimal-ratio"), scratch, &words)
    };
    for limit in ["spectrum", "predictor-corrector"] {
        let scratch = Scratch::new(&format!("ratios-{limit}"));
        let command =
            format!("signorini --limit {limit} --beta-s log:1:1e6:7 --format svg,csv --out one --quiet");
        let first = tool(&scratch, &command);
        let stem = if limit == "spectrum" { "signorini".to_owned() } else { format!("signorini-{limit}") };
        let [one, two] = both(&scratch, &stem, first, tool);
        assert!(one == two, "{limit}");
    }
}

const THREE: &str = "name = \"three\"\n[ends]\nleft = \"free\"\nright = \"wall\"\n";

/// Three unlike bars on a wall: C_r of the predictor-corrector is known from below, and drawn as such.
#[test]
fn lower_bounds_are_recorded_drawn_and_read_back() {
    let scratch = Scratch::new("bounds");
    let bar = |length: u32, density: u32| {
        format!(
            "[[bar]]\nlength = {length}.0\nelements = {length}\nyoungs_modulus = 1.0\ndensity = {density}.0\narea = 1.0\n"
        )
    };
    scratch.write("three.toml", [THREE.to_owned(), bar(3, 1), bar(1, 4), bar(2, 2)].concat());
    let limit = "three.toml --mass lumped --limit predictor-corrector --quiet";
    for points in ["--beta-s 1,2,3,10 --ratio 1", "--beta-s log:1:1e3:9 --ratio log:0.1:10:13"] {
        run(&scratch, &format!("{limit} {points} --format svg,csv --out one")).succeeded();
        let csv = String::from_utf8(scratch.read("one/three-lumped.csv")).unwrap();
        for row in csv.lines().skip(1) {
            let cells: Vec<&str> = row.split(',').collect();
            assert_eq!([cells[8], cells[12], cells[15]], ["", "", "lower bound"]);
            let number = |column: usize| cells[column].parse::<f64>().unwrap();
            // Unstable where each contact alone would be, at 2^(1/2) of the step at least.
            assert!(number(9) < number(10) && number(10) < 4.0 * number(9), "{row}");
            assert!(number(14) >= number(10) && number(14) < number(10) * (1.0 + 1e-14), "{row}");
            // c0 = h = 1 in the reference bar, so that C_r is the step in seconds.
            let [lower, seconds] = [number(9), number(13)];
            assert!(seconds <= lower && seconds > lower * (1.0 - 1e-14), "{row}");
        }
        run(&scratch, "--from one/three-lumped.csv --format svg,csv --out two --quiet").succeeded();
        assert!(scratch.read("one/three-lumped.csv") == scratch.read("two/three-lumped.csv"));
        let drawn = String::from_utf8(scratch.read("two/three-lumped.svg")).unwrap();
        assert!(drawn.contains("lower bound"), "{points}");
    }
    let answer =
        run(&scratch, "three.toml --mass lumped --limit predictor-corrector --beta-s 10 --ratio 1").stderr;
    assert!(
        answer.contains("stable up to at least dt = ") && !answer.contains("limit of closed contact dt"),
        "{answer}"
    );
    let program = env!("CARGO_BIN_EXE_optimal-ratio");
    let words = "three.toml --mass lumped --limit predictor-corrector --beta-s 1e6 --stdout csv --quiet";
    let found = run_program(program, &scratch, &words.split(' ').collect::<Vec<_>>()).succeeded();
    let cells: Vec<&str> = found.lines().nth(1).unwrap().split(',').collect();
    assert_eq!([cells[6], cells[8], cells[9]], ["", "inf", "true"]);
    let lower: f64 = cells[7].parse().unwrap();
    // Lumped: r = 1/4 costs nothing for every beta_s where the reference element has the highest frequency.
    assert!((0.25..0.2501).contains(&lower), "{lower}");
}

/// Records from before there were steps in seconds, and with a column of their own, make the same figure.
#[test]
fn older_records_and_further_columns_are_read() {
    let scratch = Scratch::new("older");
    run(&scratch, "signorini --mass lumped --beta-s 0,1,2 --format svg,csv --out one --quiet").succeeded();
    let text = String::from_utf8(scratch.read("one/signorini-lumped.csv")).unwrap();
    let older = |line: &str| line.split(',').take(12).collect::<Vec<_>>().join(",") + "\n";
    let wider = |line: &str| format!("note,{line}\n");
    for altered in [text.lines().map(older).collect::<String>(), text.lines().map(wider).collect()] {
        scratch.write("signorini-lumped.csv", altered);
        run(&scratch, "--from signorini-lumped.csv --format svg --out two --quiet").succeeded();
        assert!(scratch.read("one/signorini-lumped.svg") == scratch.read("two/signorini-lumped.svg"));
    }
}

#[test]
fn the_source_is_not_touched() {
    let scratch = Scratch::new("source");
    run(&scratch, "signorini --mass lumped --beta-s 0,1,2 --format csv --out out --quiet").succeeded();
    // The same numbers with other line ends: written again they would change.
    let csv = String::from_utf8(scratch.read("out/signorini-lumped.csv")).unwrap().replace('\n', "\r\n");
    scratch.write("out/signorini-lumped.csv", &csv);
    run(&scratch, "--from out/signorini-lumped.csv --out out --format svg,csv --quiet").succeeded();
    assert!(scratch.read("out/signorini-lumped.csv") == csv.as_bytes());
    assert!(scratch.files().contains(&"out/signorini-lumped.svg".to_owned()));
}

#[test]
fn wrong_records_are_refused_by_line_and_column() {
    let scratch = Scratch::new("wrong");
    run(&scratch, "signorini --mass lumped --beta-s 0,1,2 --ratio 1,2 --format csv --out . --quiet")
        .succeeded();
    let good = String::from_utf8(scratch.read("signorini-lumped.csv")).unwrap();
    let files = scratch.files();
    let cells: Vec<Vec<&str>> = good.lines().map(|line| line.split(',').collect()).collect();
    // Line (counted from 1), column, what is put there, what the message must say.
    let wrong = [
        (1, 5, "beta_s", "the columns scene,mass"),
        (3, 2, "1.5", "a number in [0, 1]"),
        (3, 3, "0", "an integer of at least 1"),
        (4, 4, "euler", "spectrum"),
        (4, 5, "-1", "at least 0"),
        (5, 6, "0", "above 0, or inf"),
        (5, 7, "fast", "positive number"),
        (6, 8, "2", "lower to upper"),
        (6, 9, "", "none of the three"),
        (6, 13, "9", "lower to upper"),
        (6, 15, "lower bound", "proven"),
        (7, 10, "nan", "positive number"),
        (7, 0, "", "a word"),
        (2, 11, "", "a word"),
        (2, 0, "a,b", "12 columns or more"),
    ];
    for (line, column, value, message) in wrong {
        let mut cells = cells.clone();
        cells[line - 1][column] = value;
        let text: String = cells.iter().map(|row| row.join(",") + "\n").collect();
        scratch.write("wrong.csv", text);
        let out = run(&scratch, "--from wrong.csv --out out");
        assert_eq!((out.status, out.stdout.as_str()), (2, ""), "{value}");
        let place = format!("wrong.csv, line {line}");
        assert!(out.stderr.contains(&place) && out.stderr.contains(message), "{}", out.stderr);
    }
    let too_few =
        [("", "line 1"), ("header", "at least one row"), ("row", "at least two stiffness penalties")];
    for (kind, message) in too_few {
        let lines = match kind {
            "" => 0,
            "header" => 1,
            _ => 2,
        };
        let text: String = good.lines().take(lines).map(|line| format!("{line}\n")).collect();
        scratch.write("wrong.csv", text);
        let out = run(&scratch, "--from wrong.csv --out out");
        assert!(out.status == 2 && out.stderr.contains(message), "{kind}: {}", out.stderr);
    }
    assert_eq!(run(&scratch, "--from missing.csv --out out").status, 2);
    assert_eq!(run(&scratch, "hunek --from signorini-lumped.csv --out out").status, 2);
    assert_eq!(run(&scratch, "--from signorini-lumped.csv --ratio 2 --out out").status, 2);
    let left: Vec<String> = scratch.files().into_iter().filter(|name| name != "wrong.csv").collect();
    assert_eq!(left, files, "nothing is written");
}

/// The record of a figure that is drawn again names the run that computed, also the second time, and certifies nothing.
#[test]
fn a_redraw_keeps_the_run_that_computed_and_certifies_nothing() {
    let scratch = Scratch::new("origin");
    run(&scratch, "signorini --mass lumped --beta-s 0,1,2 --format svg,csv,record --out a --quiet")
        .succeeded();
    let record = |name: &str| -> serde_json::Value { serde_json::from_slice(&scratch.read(name)).unwrap() };
    let first = record("a/signorini-lumped.record.json");
    for (from, to) in [("a", "b"), ("b", "c")] {
        let command =
            format!("--from {from}/signorini-lumped.csv --format svg,csv,record --out {to} --quiet");
        run(&scratch, &command).succeeded();
        let again = record(&format!("{to}/signorini-lumped.record.json"));
        assert_eq!(again["computed"][0]["command"], first["command"], "{to}");
        assert!(!again["checks"].to_string().contains("certified"), "{}", again["checks"]);
    }
    // One row less than the record speaks of: the run is not known.
    let csv = String::from_utf8(scratch.read("a/signorini-lumped.csv")).unwrap();
    let (shorter, _) = csv.trim_end().rsplit_once('\n').unwrap();
    scratch.write("a/signorini-lumped.csv", shorter);
    run(&scratch, "--from a/signorini-lumped.csv --format svg,record --out d --quiet");
    let altered = record("d/signorini-lumped.record.json");
    assert!(altered["computed"][0]["command"].is_null() && altered["computed"][0]["unknown"].is_string());
}

#[test]
fn a_style_is_refused_by_line() {
    let scratch = Scratch::new("style");
    for wrong in ["titel = \"x\"", "x_limits = [2, 1]", "levels = [-1.0]", "colour_map = \"jet\""] {
        scratch.write("style.toml", format!("tags = true\n{wrong}\n"));
        let out = run(&scratch, "signorini --style style.toml --out out");
        assert!(out.status == 2 && out.stderr.contains("style.toml, line 2"), "{wrong}: {}", out.stderr);
    }
    assert_eq!(scratch.files(), Vec::<String>::new());
}

fn tool(name: &str) -> &'static str {
    match name {
        "stability-map" => env!("CARGO_BIN_EXE_stability-map"),
        "optimal-ratio" => env!("CARGO_BIN_EXE_optimal-ratio"),
        _ => env!("CARGO_BIN_EXE_scheme-limits"),
    }
}

fn run_tool(scratch: &Scratch, name: &str, arguments: &str) -> Outcome {
    run_program(tool(name), scratch, &arguments.split_whitespace().collect::<Vec<_>>())
}

/// The text of a record with each cell of `columns` in data row `row` multiplied by `factor`.
fn scaled(text: &str, row: usize, columns: &[&str], factor: f64) -> String {
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let lines = text.lines().enumerate().map(|(i, line)| {
        let cells = line.split(',').zip(&header).map(|(cell, column)| match cell.parse::<f64>() {
            Ok(value) if i == row + 1 && columns.contains(column) => format!("{:?}", factor * value),
            _ => cell.to_owned(),
        });
        cells.collect::<Vec<_>>().join(",") + "\n"
    });
    lines.collect()
}

/// What the record of a redraw says of samples: rows computed again, rows that agree, why not.
fn samples(scratch: &Scratch, name: &str) -> (u64, u64, String) {
    let record: serde_json::Value = serde_json::from_slice(&scratch.read(name)).unwrap();
    let checks = record["checks"].as_array().unwrap();
    let found = checks.iter().find(|check| check["check"] == "agrees with samples computed again").unwrap();
    (found["rows"].as_u64().unwrap(), found["holds"].as_u64().unwrap(), record["unchecked"].to_string())
}

const LIMITS: [&str; 6] = ["critical_courant", "lower", "upper", "critical_step", "step_lower", "step_upper"];

/// Runs whose rows can be computed again, with the file, the columns of an enclosure and the samples of a redraw.
const REPEATED: [(&str, &str, &str, u64); 7] = [
    (
        "stability-map",
        "signorini --mass lumped,consistent --beta-s 0,1,2 --ratio 1,inf",
        "signorini-lumped",
        5,
    ),
    (
        "stability-map",
        "symmetric --mass averaged --penalty-mass diagonalised --beta-s 1,2,5",
        "symmetric-averaged",
        5,
    ),
    (
        "stability-map",
        "signorini --mass lumped --limit park --theta=1 --beta-s 1,2,5 --ratio 1,2",
        "signorini-lumped",
        5,
    ),
    (
        "stability-map",
        "hunek --elements 4 --mass 0.3 --limit noh-bathe --parameter 0.6 --beta-s 1,2,5",
        "hunek-0.3",
        5,
    ),
    (
        "optimal-ratio",
        "signorini --mass lumped --limit predictor-corrector --beta-s 1e2,1e3,1e4",
        "signorini-predictor-corrector",
        3,
    ),
    (
        "scheme-limits",
        "signorini --mass lumped --per-force --limit chung-lee:1.02,park --beta-s 1,2,5 --ratio 1",
        "forces-signorini-lumped",
        6,
    ),
    (
        "stability-map",
        "symmetric --mass lumped --limit predictor-corrector --beta-s 1,2,5",
        "symmetric-lumped",
        5,
    ),
];

/// One row moved, enclosure and all, so that the file alone shows nothing: the samples do.
#[test]
fn rows_that_were_moved_are_told() {
    for (name, command, stem, rows) in REPEATED {
        let scratch = Scratch::new(&format!("moved-{name}-{rows}-{}", command.len()));
        run_tool(&scratch, name, &format!("{command} --format csv,record,svg --out one --quiet")).succeeded();
        let redraw = format!("--from one/{stem}.csv --format record,svg --out two --quiet");
        run_tool(&scratch, name, &redraw).succeeded();
        let record = format!("two/{stem}.record.json");
        assert_eq!(samples(&scratch, &record), (rows, rows, "null".to_owned()), "{command}");
        let text = String::from_utf8(scratch.read(&format!("one/{stem}.csv"))).unwrap();
        let columns: &[&str] =
            if name == "optimal-ratio" { &["optimal_ratio", "lower", "upper"] } else { &LIMITS };
        scratch.write(&format!("one/{stem}.csv"), scaled(&text, 0, columns, 1.0 + 1e-6));
        let out = run_tool(&scratch, name, &redraw);
        assert!(out.status == 1 && out.stderr.contains("does not hold"), "{command}: {}", out.stderr);
        assert_eq!(samples(&scratch, &record).1, rows - 1, "{command}");
    }
}

/// What cannot be computed again is drawn, and said not to be checked.
#[test]
fn rows_of_unknown_scenes_are_said_not_to_be_checked() {
    let scratch = Scratch::new("unchecked");
    scratch.three_bars();
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    std::fs::copy(format!("{scenes}/two-blocks.toml"), scratch.path().join("blocks.toml")).unwrap();
    scratch.write(
        "k.mtx",
        "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 1.0\n2 2 1.0\n2 1 -1.0\n",
    );
    scratch.write("m.mtx", "%%MatrixMarket matrix array real general\n2 1\n1.0\n1.0\n");
    scratch.write("z.mtx", "%%MatrixMarket matrix array real general\n2 1\n0.0\n1.0\n");
    let matrices =
        "name = \"given\"\n[matrices]\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ngaps = \"z.mtx\"\n";
    scratch.write("given.toml", matrices);
    let points = "--beta-s 1,2,5 --ratio 1,2 --format csv,record,svg --out one --quiet";
    for (scene, stem, why) in [
        ("three.toml --mass lumped", "three-lumped", "not built in"),
        ("blocks.toml --mass lumped", "two-blocks-lumped", "not built in"),
        ("given.toml", "given", "not built in"),
        ("signorini --mass lumped --damping-stiffness 1e-4", "signorini-lumped", "damping"),
    ] {
        run(&scratch, &format!("{scene} {points}")).succeeded();
        run(&scratch, &format!("--from one/{stem}.csv --format record,svg --out two --quiet")).succeeded();
        let (rows, _, unchecked) = samples(&scratch, &format!("two/{stem}.record.json"));
        assert!(rows == 0 && unchecked.contains(why), "{scene}: {unchecked}");
    }
    // Without the record beside them rows of an unusual theta are not called wrong.
    run(&scratch, &format!("signorini --mass lumped --limit park --theta 1 {points}")).succeeded();
    std::fs::remove_file(scratch.path().join("one/signorini-lumped.record.json")).unwrap();
    run(&scratch, "--from one/signorini-lumped.csv --format record,svg --out two --quiet").succeeded();
    let (rows, _, unchecked) = samples(&scratch, "two/signorini-lumped.record.json");
    assert!(rows == 0 && unchecked.contains("is not known"), "{unchecked}");
}

#[test]
fn rows_in_another_order_and_of_other_units_are_refused() {
    let scratch = Scratch::new("order");
    run(&scratch, "signorini hunek --mass lumped --beta-s 0,1,2 --ratio 1 --format csv --out . --quiet")
        .succeeded();
    let read = |name: &str| String::from_utf8(scratch.read(name)).unwrap();
    let (one, other) = (read("signorini-lumped.csv"), read("hunek-lumped.csv"));
    let rows = |text: &str, rows: std::ops::Range<usize>| -> String {
        text.lines().skip(1 + rows.start).take(rows.len()).map(|line| format!("{line}\n")).collect()
    };
    let header = one.lines().next().unwrap().to_owned() + "\n";
    let mixed = [header.as_str(), &rows(&one, 0..2), &rows(&other, 0..3), &rows(&one, 2..3)].concat();
    let seconds = scaled(&one, 1, &["critical_step", "step_lower", "step_upper"], 1.0 + 1e-9);
    let newtons = scaled(&one, 2, &["penalty_stiffness"], 2.0);
    for (text, message) in [
        (mixed, "wrong.csv, line 7"),
        (seconds, "critical_step at beta_s = 1"),
        (newtons, "penalty_stiffness at beta_s = 2"),
    ] {
        scratch.write("wrong.csv", text);
        let out = run(&scratch, "--from wrong.csv --out out --format svg");
        assert!(out.status == 2 && out.stderr.contains(message), "{message}: {}", out.stderr);
    }
}

#[test]
fn costs_are_the_same_bytes() {
    let scratch = Scratch::new("costs");
    let name = "scheme-limits";
    let first = "signorini --mass lumped --per-force --beta-s log:0.01:100:41 --format svg,csv,record --out one --quiet";
    run_tool(&scratch, name, first).succeeded();
    let stem = "forces-signorini-lumped";
    let again = format!("--from one/{stem}.csv --format svg,record --out two --quiet");
    run_tool(&scratch, name, &again).succeeded();
    assert!(scratch.read(&format!("one/{stem}.svg")) == scratch.read(&format!("two/{stem}.svg")));
    let text = String::from_utf8(scratch.read(&format!("one/{stem}.csv"))).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let mut seen = std::collections::BTreeMap::new();
    for row in text.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |column: &str| cells[place(column)].parse::<f64>().unwrap();
        let forces = number("evaluations");
        assert_eq!(number("step_per_force"), number("step_lower") / forces);
        // A lumped bar on a wall: C_0 = 1.
        assert!((number("cost") * number("critical_courant") / forces - 1.0).abs() < 1e-14, "{row}");
        if number("ratio") == 1.0 && number("stiffness_penalty") == 100.0 {
            seen.insert(cells[place("limit")].to_owned(), (forces, number("cost")));
        }
    }
    assert_eq!(seen.len(), 7);
    // dt^2 = m/s + 1/(s mu): C^2 = 1/4 + 1/200. Noh and Bathe: 2 forces for 2/sqrt((3p - 1)(1 - p)) with p = 0.54.
    for (limit, forces, cost) in [
        ("central-difference", 1.0, 1.0),
        ("predictor-corrector", 1.0, (0.255_f64).sqrt().recip()),
        ("noh-bathe", 2.0, 2.0 * (0.62_f64 * 0.46).sqrt()),
        ("tchamwa-wielgosz", 1.0, (2.0_f64 * 1.033 - 1.0).sqrt()),
    ] {
        let found = seen[limit];
        assert!(found.0 == forces && (found.1 / cost - 1.0).abs() < 1e-12, "{limit}: {found:?}, not {cost}");
    }
    assert!(seen["park"].0 == 2.0 && seen["park"].1 > 2.0);
    for wrong in
        ["--limit spectrum", "--limit noh-bathe:0.9", "--limit park:x", "--ratio lin:1:9:9", "--limit park"]
    {
        let scene = if wrong == "--limit park" {
            concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/two-blocks.toml")
        } else {
            "signorini"
        };
        let out = run_tool(&scratch, name, &format!("{scene} --per-force {wrong} --out three"));
        assert_eq!((out.status, out.stdout.as_str()), (2, ""), "{wrong}");
    }
}
