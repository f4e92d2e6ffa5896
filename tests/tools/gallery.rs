//! The figures: what is committed is what the commands write, and every figure has its record and its sources.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use std::fs;
use std::path::Path;

use serde_json::Value;
use tool::{Scratch, run, run_program};

/// Words of the labels of a drawing.
fn labels(svg: &str) -> Vec<&str> {
    svg.split("aria-label=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

fn text(scratch: &Scratch, name: &str) -> String {
    String::from_utf8(scratch.read(name)).unwrap()
}

#[test]
fn the_committed_figure_is_what_the_command_writes() {
    let scratch = Scratch::new("gallery");
    run(&scratch, "--mass lumped --format svg --out out --quiet").succeeded();
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../figures/stability-map");
    // Coordinates are hundredths of a millimetre: the last bit of a processor does not show.
    for figure in ["fig3-1-lumped.svg", "fig1-lumped.svg", "mass-matrices.svg"] {
        let (old, new) = (fs::read(committed.join(figure)).unwrap(), scratch.read(&format!("out/{figure}")));
        assert!(old == new, "{figure} is not what `stability-map` writes: run it, look, and commit");
    }
    // Every picture of the gallery has the width of a column or a page at 300 dots per inch.
    let mut seen = 0;
    for folder in fs::read_dir(committed.parent().unwrap()).unwrap().map(|entry| entry.unwrap().path()) {
        for file in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if file.extension().is_some_and(|ending| ending == "png") {
                let bytes = fs::read(&file).unwrap();
                let pixels = u32::from_be_bytes(bytes[16..20].try_into().unwrap());
                assert!([1063, 2244].contains(&pixels), "{}: {pixels} pixels", file.display());
                seen += 1;
            }
        }
    }
    assert!(seen >= 10, "{seen} pictures");
}

#[test]
fn every_figure_has_its_data_and_its_record() {
    let scratch = Scratch::new("record");
    run(&scratch, "signorini symmetric --mass lumped --beta-s lin:0:10:11 --out a/secret --quiet")
        .succeeded();
    let stems = ["signorini-lumped", "symmetric-lumped"];
    let endings = ["csv", "png", "record.json", "svg"];
    let expected: Vec<String> =
        stems.iter().flat_map(|stem| endings.map(|ending| format!("a/secret/{stem}.{ending}"))).collect();
    assert_eq!(scratch.files(), expected);
    let text = text(&scratch, "a/secret/signorini-lumped.record.json");
    assert!(!text.contains("secret"), "a path: {text}");
    let record: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        record["command"],
        "stability-map signorini symmetric --mass lumped --beta-s lin:0:10:11 --quiet"
    );
    assert_eq!(record["version"], env!("CARGO_PKG_VERSION"));
    assert!(!record["revision"].as_str().unwrap().is_empty());
    assert_eq!(record["scene"], serde_json::json!(["signorini"]));
    assert_eq!(record["engine"], serde_json::json!(["closed-form"]));
    assert_eq!(record["data"], serde_json::json!([{"file": "signorini-lumped.csv", "rows": 55}]));
    assert!(record["seconds"].as_f64().unwrap() > 0.0);
    assert_eq!(record["width_mm"], 90.0);
    let checks = record["checks"].as_array().unwrap();
    let names: Vec<&str> = checks.iter().map(|check| check["check"].as_str().unwrap()).collect();
    assert_eq!(names, ["certified", "lower <= critical_courant <= upper"]);
    assert!(checks.iter().all(|check| check["rows"] == 55 && check["holds"] == 55), "{checks:?}");
    assert_eq!(record["holds"], true);
}

#[test]
fn a_figure_of_several_runs_names_all_their_data() {
    let scratch = Scratch::new("record-impact");
    let words = "signorini --elements 10 --mass lumped --beta-s 1,1e4 --scheme predictor-corrector,park \
                 --format svg,tex,record --out out --quiet";
    let words: Vec<&str> = words.split_whitespace().collect();
    let out = run_program(env!("CARGO_BIN_EXE_contact-impact"), &scratch, &words);
    assert_eq!(out.status, 0, "{}", out.stderr);
    let record: Value =
        serde_json::from_str(&text(&scratch, "out/signorini-force-lumped.record.json")).unwrap();
    assert_eq!(record["data"].as_array().unwrap().len(), 4);
    assert_eq!(record["scheme"], serde_json::json!(["predictor-corrector", "park"]));
    assert_eq!(record["checks"], serde_json::json!([{"check": "finished", "rows": 4, "holds": 4}]));
    // The source of the figure reads the four histories.
    let tex = text(&scratch, "out/signorini-force-lumped.tex");
    assert_eq!(tex.matches("table[col sep=comma, x=time, y=contact_force]").count(), 4, "{tex}");
    // The exact stress jumps upright: two points of the exact line at one place, 0.1 Pa apart at half the bar.
    let tex = text(&scratch, "out/signorini-stress-lumped.tex");
    let exact = tex.lines().find(|line| line.contains("coordinates")).unwrap();
    assert!(exact.contains("(5e0,0e0) (5e0,-1e-1)") || exact.contains("(5e0,0e0) (5e0,-1.0"), "{exact}");
    assert!(
        labels(&text(&scratch, "out/signorini-stress-lumped.svg")).iter().any(|l| l.contains("t = 0.05 s"))
    );
}

#[test]
fn the_tex_source_reads_the_rows_of_its_curves() {
    let scratch = Scratch::new("tex");
    let command =
        "signorini --mass lumped --beta-s lin:0:10:11 --ratio 1,2,inf --format tex --out out --quiet";
    run(&scratch, command).succeeded();
    assert_eq!(scratch.files(), ["out/signorini-lumped.csv", "out/signorini-lumped.tex"]);
    let (tex, csv) = (text(&scratch, "out/signorini-lumped.tex"), text(&scratch, "out/signorini-lumped.csv"));
    let ratios: Vec<&str> = csv.lines().skip(1).map(|line| line.split(',').nth(6).unwrap()).collect();
    let read = "table[col sep=comma, x=stiffness_penalty, y=critical_courant] {signorini-lumped.csv}";
    let blocks = tex.split("rows=").skip(1).filter(|rest| rest.lines().nth(1).unwrap().contains(read));
    let mut found = Vec::new();
    for block in blocks {
        let (first, rest) = block.split_once(" to ").unwrap();
        let last = rest.split(']').next().unwrap();
        let rows = first.parse::<usize>().unwrap()..=last.parse::<usize>().unwrap();
        assert_eq!(rows.clone().count(), 11);
        assert!(ratios[rows.clone()].iter().all(|ratio| *ratio == ratios[*rows.start()]));
        found.push(ratios[*rows.start()]);
    }
    // The stable side lies below the lowest curve, and is drawn first.
    assert_eq!(found, ["inf", "1.0", "2.0", "inf"]);
    assert!(tex.contains("xlabel={stiffness penalty $\\beta _{\\mathrm{s}}$}"));
    for (open, close) in [("{", "}"), ("\\begin", "\\end{"), ("[", "]")] {
        assert_eq!(tex.matches(open).count(), tex.matches(close).count(), "{open} {close}");
    }
}

#[test]
fn a_map_in_tex_has_its_cells_as_an_image() {
    let scratch = Scratch::new("tex-map");
    let axes = "--beta-s log:1e-3:1e12:31 --ratio log:0.1:1e3:21";
    run(&scratch, &format!("signorini --mass lumped {axes} --format tex --out out --quiet")).succeeded();
    let stem = "out/signorini-lumped";
    assert_eq!(scratch.files(), [format!("{stem}-cells1.png"), format!("{stem}.csv"), format!("{stem}.tex")]);
    assert!(text(&scratch, "out/signorini-lumped.tex").contains("]{signorini-lumped-cells1}};"));
}

#[test]
fn the_width_is_that_of_a_column_or_a_page() {
    let scratch = Scratch::new("width");
    let file = "out/signorini-lumped.svg";
    for (option, width) in [("", "90mm"), (" --width single", "90mm"), (" --width double", "190mm")] {
        let command = format!("signorini --mass lumped --beta-s lin:0:10:11 --format svg --out out{option}");
        run(&scratch, &command).succeeded();
        assert!(text(&scratch, file).contains(&format!("width=\"{width}\"")), "{option}");
    }
    assert_eq!(run(&scratch, "signorini --width 100").status, 2);
}

#[test]
fn an_unordered_list_is_drawn_in_order() {
    let scratch = Scratch::new("unordered");
    for (list, out) in [("0,2,4,10", "a"), ("4,0,10,2", "b")] {
        let command = format!("signorini --mass lumped --beta-s {list} --format svg,csv --out {out} --quiet");
        run(&scratch, &command).succeeded();
    }
    assert!(scratch.read("a/signorini-lumped.svg") == scratch.read("b/signorini-lumped.svg"));
    assert_ne!(scratch.read("a/signorini-lumped.csv"), scratch.read("b/signorini-lumped.csv"));
}
