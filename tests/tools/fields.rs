//! The pictures of meshes that `contact-impact --fields` draws, as a user meets them.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use tool::{Scratch, run_program};

/// A block of four by four cells, held at its sides, that hits a wall at 1 m/s with its whole foot.
fn block(element: &str) -> String {
    format!(
        "name = \"block\"\ndimension = 2\nplane = \"strain\"\n[[body]]\nname = \"block\"\nbox = [0.02, 0.02]\n\
         cells = [4, 4]\nelement = \"{element}\"\nyoungs_modulus = 210e9\npoissons_ratio = 0.3\ndensity = 7850.0\n\
         thickness = 0.5\nvelocity = [0.0, -1.0]\n[[contact]]\nsurfaces = [\"block.bottom\", \"wall\"]\n\
         [[hold]]\nsurface = \"block.left\"\ndirections = [\"x\"]\n[[hold]]\nsurface = \"block.right\"\n\
         directions = [\"x\"]\n[impact]\nduration = 1e-5\n"
    )
}

const HOW: &str = "--scheme predictor-corrector --beta-s 1e3 --ratio 0.25 --out there -q --fields";
const STEM: &str = "there/block-lumped-predictor-corrector-beta1e3-r0.25";

fn impact(scratch: &Scratch, arguments: &str) -> tool::Outcome {
    run_program(env!("CARGO_BIN_EXE_contact-impact"), scratch, &arguments.split(' ').collect::<Vec<_>>())
}

/// A column of numbers.
fn column(scratch: &Scratch, file: &str, name: &str) -> Vec<f64> {
    let text = String::from_utf8(scratch.read(file)).unwrap();
    let at = text.lines().next().unwrap().split(',').position(|known| known == name).unwrap();
    text.lines().skip(1).map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

#[test]
fn pictures_show_every_element_and_rows_that_add_up() {
    for (element, elements) in [("tri3", 32), ("tri6", 32), ("quad4", 16), ("quad8", 16)] {
        let scratch = Scratch::new("fields");
        scratch.write("block.toml", block(element));
        impact(&scratch, &format!("block.toml {HOW} --format svg,csv,record")).succeeded();
        let svg = String::from_utf8(scratch.read(&format!("{STEM}-stress.svg"))).unwrap();
        // A polygon of the mesh has a line of 0.06 mm in its own colour; the times of the panels are in their order.
        assert_eq!(svg.matches("<polygon fill=\"#").count() - svg.matches("stroke-width=\"6\"").count(), 160);
        assert_eq!(svg.matches("stroke-width=\"6\"").count(), 3 * elements, "{element}");
        assert!(svg.contains("aria-label=\"normal stress σyy [Pa]\""), "{element}");
        let time = column(&scratch, &format!("{STEM}-stress.csv"), "time");
        assert_eq!(time.len(), 3 * elements, "{element}");
        // What the picture shows is the stress across the wall.
        let shown = column(&scratch, &format!("{STEM}-stress.csv"), "shown");
        assert_eq!(shown, column(&scratch, &format!("{STEM}-stress.csv"), "stress_yy"), "{element}");
        let (times, forces) = ("time", "contact_force");
        let [all, of] = [times, forces].map(|name| column(&scratch, &format!("{STEM}.csv"), name));
        let file = format!("{STEM}-pressure.csv");
        let [at, force, pressure, area] =
            ["time", "contact_force", "pressure", "area"].map(|name| column(&scratch, &file, name));
        let mut instants = at.clone();
        instants.dedup();
        assert_eq!(instants.len(), 3, "{element}");
        for instant in &instants {
            let rows: Vec<usize> = (0..at.len()).filter(|i| at[*i] == *instant).collect();
            // The history adds the same numbers in another order; 0.02 m by 0.5 m.
            let known = of[all.iter().position(|time| time == instant).unwrap()];
            let sum: f64 = rows.iter().map(|i| force[*i]).sum();
            let by_pressure: f64 = rows.iter().map(|i| pressure[*i] * area[*i]).sum();
            let whole: f64 = rows.iter().map(|i| area[*i]).sum();
            let rounding = 16.0 * f64::EPSILON;
            assert!((sum - known).abs() <= rounding * known, "{element}: {sum} {known}");
            assert!((by_pressure - known).abs() <= rounding * known, "{element}: {by_pressure} {known}");
            assert!((whole - 0.01).abs() <= rounding, "{element}: {whole}");
        }
        // The second of the three is the instant of the largest force.
        let largest = (0..of.len()).fold(0, |best, i| if of[i] > of[best] { i } else { best });
        assert_eq!(instants[1], all[largest], "{element}");
        // A plane wave has one pressure: at the ends of the foot, whose share is half, too.
        if element == "quad4" {
            let peak: Vec<f64> =
                (0..at.len()).filter(|i| at[*i] == instants[1]).map(|i| pressure[i]).collect();
            let spread = peak.iter().fold(0.0_f64, |spread, p| spread.max((p / peak[0] - 1.0).abs()));
            assert!(peak[0] > 0.0 && spread < 1e-9, "{peak:?}");
        }
    }
}

#[test]
fn instants_are_those_asked_for() {
    let scratch = Scratch::new("fields-at");
    scratch.write("block.toml", block("quad4"));
    impact(&scratch, &format!("block.toml {HOW} --format csv --stress-at 2e-6,8e-6")).succeeded();
    let mut time = column(&scratch, &format!("{STEM}-pressure.csv"), "time");
    time.dedup();
    let step = column(&scratch, &format!("{STEM}.csv"), "time")[1];
    assert_eq!(time.len(), 2);
    for (found, asked) in time.iter().zip([2e-6, 8e-6]) {
        assert!((found - asked).abs() <= 0.5 * step * (1.0 + f64::EPSILON), "{found} {asked}");
    }
}

#[test]
fn what_has_no_picture_is_refused_and_nothing_is_written() {
    for (arguments, word) in [
        ("signorini --mass lumped --fields --out there", "a scene of [[body]], which has a mesh"),
        ("signorini --mass lumped --stress-at 0.1,0.2 --out there", "at most 1"),
        ("block.toml --fields --stress-at 1,2,3,4,5,6,7 --out there", "at most 6"),
        ("block.toml --fields --stress-at 1 --out there", "a time (s) from 0 to"),
        ("block.toml --fields --stress-at nan --out there", "a time (s) from 0 to"),
    ] {
        let scratch = Scratch::new("fields-refused");
        scratch.write("block.toml", block("quad4"));
        let out = impact(&scratch, arguments);
        assert_eq!(out.status, 2, "{arguments}: {}", out.stderr);
        assert!(out.stderr.contains(word), "{arguments}: {}", out.stderr);
        assert!(scratch.files().is_empty(), "{arguments}");
    }
}
