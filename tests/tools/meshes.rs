//! Scenes of meshes and matrices as users of the tools meet them: confirmed limits, studies, and what is refused.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use tool::{Scratch, run_program};

const STUDIES: &str = env!("CARGO_BIN_EXE_mesh-limits");

#[test]
fn no_proven_step_is_beyond_the_limit_and_rules_of_thumb_are() {
    let scratch = Scratch::new("mesh-studies");
    let words = ["--quick", "--quiet", "--stdout", "csv", "bounds", "rules"];
    let csv = run_program(STUDIES, &scratch, &words).succeeded();
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let (mut proven, mut bold) = (0, 0);
    for row in csv.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>()) {
        let error: f64 = row[at("error")].parse().unwrap();
        match row[at("estimate")] {
            "element" | "patches" => {
                assert!(error <= 0.0, "{row:?}");
                proven += 1;
            }
            "no contact" if error > 0.0 => bold += 1,
            _ => (),
        }
    }
    assert!(proven >= 16 && bold >= 4, "{proven} proven, {bold} too bold");
}
