//! `--from` of records that were altered, of scenes that cannot be computed again, and of what schemes cost.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use tool::{Outcome, Scratch, run, run_program};

fn binary(name: &str) -> &'static str {
    match name {
        "stability-map" => env!("CARGO_BIN_EXE_stability-map"),
        "optimal-ratio" => env!("CARGO_BIN_EXE_optimal-ratio"),
        _ => env!("CARGO_BIN_EXE_scheme-limits"),
    }
}

fn run_tool(scratch: &Scratch, name: &str, arguments: &str) -> Outcome {
    run_program(binary(name), scratch, &arguments.split_whitespace().collect::<Vec<_>>())
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
        "signorini-lumped",
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

/// The stem of the only rows in `folder` whose name has this beginning.
fn stem_in(scratch: &Scratch, folder: &str, begin: &str) -> String {
    let files = std::fs::read_dir(scratch.path().join(folder)).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let stems = names.filter_map(|name| name.strip_suffix(".csv").map(str::to_owned));
    let stems: Vec<String> = stems.filter(|stem| stem.starts_with(begin)).collect();
    assert_eq!(stems.len(), 1, "{stems:?}");
    stems[0].clone()
}

/// One row moved, enclosure and all, so that the file alone shows nothing: the samples do.
#[test]
fn rows_that_were_moved_are_told() {
    for (name, command, begin, rows) in REPEATED {
        let scratch = Scratch::new(&format!("moved-{name}-{rows}-{}", command.len()));
        run_tool(&scratch, name, &format!("{command} --format csv,record,svg --out one --quiet")).succeeded();
        let stem = stem_in(&scratch, "one", begin);
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
    let points = "--beta-s 1,2,5 --ratio 1,2 --format csv,record,svg --quiet --out one";
    for (number, (scene, begin, why)) in [
        ("three.toml --mass lumped", "three-lumped", "not built in"),
        ("blocks.toml --mass lumped", "two-blocks-lumped", "not built in"),
        ("given.toml", "given", "not built in"),
        ("signorini --mass lumped --damping-stiffness 1e-4", "signorini-lumped", "damping"),
    ]
    .into_iter()
    .enumerate()
    {
        let one = format!("one-{number}");
        run(&scratch, &format!("{scene} {points}-{number}")).succeeded();
        let stem = stem_in(&scratch, &one, begin);
        run(&scratch, &format!("--from {one}/{stem}.csv --format record,svg --out two --quiet")).succeeded();
        let (rows, _, unchecked) = samples(&scratch, &format!("two/{stem}.record.json"));
        assert!(rows == 0 && unchecked.contains(why), "{scene}: {unchecked}");
    }
    // Without the record beside them rows of an unusual theta are not called wrong.
    run(&scratch, &format!("signorini --mass lumped --limit park --theta 1 {points}")).succeeded();
    let stem = stem_in(&scratch, "one", "signorini-lumped");
    std::fs::remove_file(scratch.path().join(format!("one/{stem}.record.json"))).unwrap();
    run(&scratch, &format!("--from one/{stem}.csv --format record,svg --out two --quiet")).succeeded();
    let (rows, _, unchecked) = samples(&scratch, &format!("two/{stem}.record.json"));
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
    for wrong in ["--limit spectrum", "--limit noh-bathe:0.9", "--limit park:x", "--ratio lin:1:9:9"] {
        let out = run_tool(&scratch, name, &format!("signorini --per-force {wrong} --out three"));
        assert_eq!((out.status, out.stdout.as_str()), (2, ""), "{wrong}");
    }
}
