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
            let limit = if grid.contains("park") { "-park" } else { "" };
            let [one, two] = both(&scratch, &format!("{scene}-{mass}{limit}"), first, run);
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
        let limit = if limit == "spectrum" { String::new() } else { format!("-{limit}") };
        let stem = format!("signorini-beta1-10-100-1e3-1e4-1e5-1e6{limit}");
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
        let csv = String::from_utf8(scratch.read("one/three-lumped-predictor-corrector.csv")).unwrap();
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
        run(&scratch, "--from one/three-lumped-predictor-corrector.csv --format svg,csv --out two --quiet")
            .succeeded();
        assert!(
            scratch.read("one/three-lumped-predictor-corrector.csv")
                == scratch.read("two/three-lumped-predictor-corrector.csv")
        );
        let drawn = String::from_utf8(scratch.read("two/three-lumped-predictor-corrector.svg")).unwrap();
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
