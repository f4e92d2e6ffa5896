//! `verify-limits --contact opening` as its users meet it: limits and recommended steps follow from the runs.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::HashMap;
use std::process::Command;

#[path = "common/tool.rs"]
mod tool;

use tool::Scratch;

/// A row of a CSV file by column.
type Row = HashMap<String, String>;

/// The output folder of a run, which must end with exit status 0.
fn run(name: &str, arguments: &str) -> Scratch {
    let directory = Scratch::new(name);
    let out = Command::new(env!("CARGO_BIN_EXE_verify-limits"))
        .args(["--contact", "opening", "-q", "--out"])
        .arg(directory.path())
        .args(arguments.split_whitespace())
        .output()
        .unwrap();
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    assert!(out.stderr.is_empty() && out.stdout.is_empty());
    directory
}

/// The rows of the only file whose name is `stem` and then the scene and the options.
fn table(directory: &Scratch, stem: &str) -> Vec<Row> {
    let files = std::fs::read_dir(directory.path()).unwrap().map(|file| file.unwrap().path());
    let is = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        name.strip_prefix(stem).is_some_and(|rest| {
            rest.starts_with("-") && !rest.starts_with("-limits-") && rest.ends_with(".csv")
        })
    };
    let [file] = &files.filter(is).collect::<Vec<_>>()[..] else { panic!("no file, or several, of {stem}") };
    let text = std::fs::read_to_string(file).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().unwrap();
    lines.map(|fields| header.iter().cloned().zip(fields).collect()).collect()
}

fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap_or_else(|_| panic!("{name} is {:?}", row[name]))
}

fn same(a: &Row, b: &Row, columns: &[&str]) -> bool {
    columns.iter().all(|column| a[*column] == b[*column])
}

/// The limits and the recommendation, worked out again from the runs.
#[test]
fn limits_and_recommended_steps_follow_from_the_runs() {
    let directory = run(
        "follow",
        "signorini hunek --elements 20 --mass lumped,0.3 --beta-s 1,1e4 --ratio 0.25,1,inf --fraction 0.5,0.2,0.9",
    );
    let runs = table(&directory, "opening");
    // At r = inf and beta_s = 1e4 the two other schemes stay below a million steps; the Park scheme does not.
    let beside = ["scene", "mass", "scheme", "stiffness_penalty", "ratio"];
    let safe = |of: &[&Row]| {
        let gaining =
            of.iter().filter(|row| row["gains"] == "true").map(|row| number(row, "relative_courant"));
        let first = gaining.fold(f64::INFINITY, f64::min);
        let below = of.iter().map(|row| number(row, "relative_courant")).filter(|c| *c < first);
        (below.fold(0.0, f64::max), first)
    };
    for row in &runs {
        assert_eq!(number(row, "energy_gain") > 1.0 / number(row, "elements"), row["gains"] == "true");
        assert!(row["scheme"] != "predictor-corrector" || row["energy_gain"] == "0.0", "{row:?}");
    }
    let limits = table(&directory, "opening-limits");
    for limit in &limits {
        let scan: Vec<&Row> = runs.iter().filter(|row| same(row, limit, &beside)).collect();
        assert_eq!(scan.len(), 6, "two loads and three steps");
        let (last, first) = safe(&scan);
        let courant = number(limit, "predicted") / number(scan[0], "predicted");
        assert!((number(limit, "stable_at") - last * courant).abs() <= 1e-12, "{limit:?} {last}");
        assert!(
            first.is_infinite() || (number(limit, "unstable_at") / (first * courant) - 1.0).abs() <= 1e-12
        );
        assert_eq!(limit["agrees"], first.is_infinite().to_string());
        assert_eq!(limit["contact"], "opening");
    }
    let recommended = table(&directory, "recommendation");
    assert_eq!(recommended.len(), 2 * 3 * 3);
    for row in &recommended {
        let of_row = limits.iter().filter(|limit| same(limit, row, &["mass", "scheme", "ratio"]));
        let steps = of_row
            .map(|limit| safe(&runs.iter().filter(|run| same(run, limit, &beside)).collect::<Vec<_>>()).0);
        assert_eq!(number(row, "relative_courant"), steps.fold(f64::INFINITY, f64::min), "{row:?}");
    }
    let found = |scheme: &str, ratio: &str| {
        let row = recommended.iter().find(|row| row["scheme"] == scheme && row["ratio"] == ratio).unwrap();
        number(row, "relative_courant")
    };
    assert_eq!(found("predictor-corrector", "0.25"), 0.9);
    assert_eq!(found("central-difference", "1.0"), 0.0);
}

/// The table of analyses/README.md, its column of lumped mass, from the run that the page gives.
#[test]
fn the_table_of_the_page_is_what_the_runs_give() {
    let directory = run("page", "--mass lumped --format csv");
    let recommended = table(&directory, "recommendation");
    let page = include_str!("../../analyses/README.md");
    let short = |text: &str| {
        let value: f64 = text.parse().unwrap();
        if value.is_infinite() { "∞".to_owned() } else { value.to_string() }
    };
    let digits = |text: &str| format!("{:.3}", (1e3 * text.parse::<f64>().unwrap()).floor() / 1e3);
    for row in &recommended {
        let scheme =
            row["scheme"].replace("central-difference", "central difference").replace("park", "Park");
        let start = format!("| {scheme} | {} | ", short(&row["ratio"]));
        let line = page.lines().find(|line| line.starts_with(&start));
        let line = line.unwrap_or_else(|| panic!("no line {start}"));
        let cells: Vec<&str> = line[start.len()..].trim_end_matches(" |").split(" | ").collect();
        let none = number(row, "relative_courant") == 0.0;
        let step = if none { "none".to_owned() } else { digits(&row["relative_courant"]) };
        let kept = if none { "–".to_owned() } else { digits(&row["energy_ratio"]) };
        assert_eq!((cells[0], cells[3]), (step.as_str(), kept.as_str()), "{line}");
    }
    assert_eq!(recommended.len(), 21);
}
