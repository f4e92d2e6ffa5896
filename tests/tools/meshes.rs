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

const K: &str = "%%MatrixMarket matrix coordinate real general\n3 3 7\n1 1 2.0\n1 2 -1.0\n2 1 -1.0\n2 2 2.0\n2 3 -1.0\n\
                 3 2 -1.0\n3 3 1.0\n";
const M: &str = "%%MatrixMarket matrix array real general\n3 1\n1.0\n1.0\n0.5\n";
const Z: &str = "%%MatrixMarket matrix coordinate real general\n3 1 1\n3 1 1.0\n";
const MATRICES: &str =
    "name = \"own\"\n[matrices]\nstiffness = \"K.mtx\"\nmass = \"M.mtx\"\ngaps = \"Z.mtx\"\n";
const BODIES: &str = r#"name = "two"
dimension = 2
plane = "strain"
[[body]]
name = "lower"
box = [2.0, 1.0]
cells = [2, 1]
element = "quad4"
youngs_modulus = 1.0
poissons_ratio = 0.3
density = 1.0
[[body]]
name = "upper"
box = [1.0, 1.0]
cells = [1, 1]
origin = [0.5, 1.0]
element = "quad4"
youngs_modulus = 1.0
poissons_ratio = 0.3
density = 1.0
[[contact]]
surfaces = ["upper.bottom", "lower.top"]
"#;
const PART: &str = r#"name = "part"
dimension = 2
plane = "strain"
[[body]]
name = "part"
mesh = "part.msh"
youngs_modulus = 1.0
poissons_ratio = 0.3
density = 1.0
[[contact]]
surfaces = ["part.foot", "wall"]
"#;
/// The unit square as one quadrilateral with its lower edge `foot`.
const SQUARE: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 \"foot\"\n2 2 \"solid\"\n\
    $EndPhysicalNames\n$Entities\n0 1 1 0\n1 0 0 0 1 0 0 1 1 0\n1 0 0 0 1 1 0 1 2 0\n$EndEntities\n\
    $Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n\
    $Elements\n2 2 1 2\n1 1 1 1\n1 1 2\n2 1 3 1\n2 1 2 3 4\n$EndElements\n";

/// Runs a scene with some of the files above changed: the exit status, the message, and the files that were added.
fn outcome(name: &str, changed: &[(&str, String)]) -> (i32, String, bool) {
    let scratch = Scratch::new(&format!("bad-{name}"));
    let usual = [("K.mtx", K), ("M.mtx", M), ("Z.mtx", Z), ("s.toml", MATRICES), ("part.msh", SQUARE)];
    usual.iter().for_each(|(file, text)| scratch.write(file, text));
    changed.iter().for_each(|(file, text)| scratch.write(file, text));
    let words = ["s.toml", "--beta-s", "1", "--ratio", "1", "--format", "csv", "--out", "out", "--quiet"];
    let out = run_program(tool::TOOL, &scratch, &words);
    (out.status, out.stderr, scratch.path().join("out").exists())
}

#[test]
fn good_matrices_and_meshes_are_taken() {
    for (name, text) in [("matrices", MATRICES), ("bodies", BODIES), ("part", PART)] {
        assert_eq!(outcome(name, &[("s.toml", text.to_owned())]), (0, String::new(), true), "{name}");
    }
}

/// A mesh is read in parallel, before anything is computed: the threads that were asked for are there by then.
#[test]
fn the_number_of_threads_changes_no_byte() {
    let scratch = Scratch::new("mesh-threads");
    let tools = [
        (env!("CARGO_BIN_EXE_stability-map"), "two-blocks.toml --beta-s 1,100 --ratio 1,inf"),
        (env!("CARGO_BIN_EXE_optimal-ratio"), "two-blocks.toml --beta-s 10"),
        (env!("CARGO_BIN_EXE_contact-impact"), "plane-impact.toml --beta-s 100 --scheme predictor-corrector"),
    ];
    for (tool, arguments) in tools {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/");
        let [one, two] = [1, 2].map(|threads| {
            let arguments = format!("{scene}{arguments} --mass lumped --stdout csv -q --threads {threads}");
            run_program(tool, &scratch, &arguments.split(" ").collect::<Vec<_>>()).succeeded()
        });
        assert_eq!(one, two, "{arguments}");
        assert!(one.lines().count() > 1, "{arguments}: {one}");
    }
}

#[test]
fn bad_matrices_are_refused_by_file_and_line_and_nothing_is_written() {
    let full = "%%MatrixMarket matrix coordinate real symmetric\n3 3 4\n1 1 1.0\n2 1 2.0\n2 2 1.0\n3 3 1.0\n";
    let two = "%%MatrixMarket matrix array real general\n2 1\n1.0\n1.0\n";
    let scales = format!("{MATRICES}scales = \"w.mtx\"\n");
    let cases = [
        ("unsymmetric", "K.mtx", K.replace("2 1 -1.0", "2 1 -1.5"), "K.mtx, line 4", "a symmetric matrix"),
        ("negative-mass", "M.mtx", M.replace("0.5", "-0.5"), "M.mtx, line 5", "a mass above 0"),
        ("indefinite-mass", "M.mtx", full.to_owned(), "M.mtx, line 4", "a positive definite mass"),
        ("sizes", "M.mtx", two.to_owned(), "M.mtx, line 2", "3 x 3"),
        ("rows-of-gaps", "Z.mtx", Z.replace("3 1 1\n", "4 1 1\n"), "Z.mtx, line 2", "3 x k"),
        ("number-of-scales", "w.mtx", two.to_owned(), "w.mtx, line 2", "1 x 1"),
        ("index", "K.mtx", K.replace("3 3 1.0", "4 3 1.0"), "K.mtx, line 9", "1 to 3"),
        ("index-0", "K.mtx", K.replace("1 1 2.0", "0 1 2.0"), "K.mtx, line 3", "1 to 3"),
        ("truncated", "K.mtx", K.replace("3 3 1.0\n", ""), "K.mtx, line 8", "7 entries"),
        ("nan", "K.mtx", K.replace("2 2 2.0", "2 2 nan"), "K.mtx, line 6", "a finite number"),
        ("zero-column", "Z.mtx", Z.replace("3 1 1\n", "3 2 1\n"), "Z.mtx, line 2", "a gap that moves"),
    ];
    for (name, file, text, place, allowed) in cases {
        let mut changed = vec![(file, text)];
        if file == "w.mtx" {
            changed.push(("s.toml", scales.clone()));
        }
        let (status, message, written) = outcome(name, &changed);
        assert_eq!((status, written), (2, false), "{name}: {message}");
        assert!(message.contains(place) && message.contains(allowed), "{name}: {message}");
    }
}

#[test]
fn bad_meshes_are_refused_by_file_and_line_and_nothing_is_written() {
    let apart = BODIES.replace("[0.5, 1.0]", "[5.0, 1.0]");
    let large = BODIES.replace("cells = [2, 1]", "cells = [300000, 200000]");
    let folded = SQUARE.replace("1 1 0\n0 1 0\n", "0.1 0.1 0\n0 1 0\n");
    // Its last line before the end of the nodes.
    let cut = SQUARE.split("0 1 0\n$EndNodes").next().unwrap().to_owned();
    let bodies = |from: &str, to: &str| vec![("s.toml", BODIES.replace(from, to))];
    let part = |mesh: String| vec![("s.toml", PART.to_owned()), ("part.msh", mesh)];
    let cases = [
        ("no-surface", bodies("upper.bottom", "upper.under"), "s.toml, line 22", "a side of a box"),
        ("not-facing", bodies("upper.bottom", "upper.left"), "s.toml, line 22", "surfaces that meet"),
        ("apart", vec![("s.toml", apart)], "s.toml, line 22", "surfaces that meet"),
        ("too-large", vec![("s.toml", large)], "s.toml, line 7, body 1, cells", "MB of memory"),
        ("folded", part(folded), "s.toml, line 6, body 1, mesh", "a positive one"),
        ("cut", part(cut), "part.msh, line", "cut off"),
        ("nan", part(SQUARE.replace("1 1 0\n0 1 0\n", "nan 1 0\n0 1 0\n")), "part.msh, line 23", "number"),
        ("node", part(SQUARE.replace("2 1 2 3 4", "2 1 2 3 9")), "part.msh, line 31", "$Nodes"),
        ("group", vec![("s.toml", PART.replace("foot", "head"))], "s.toml, line 11", "foot"),
    ];
    for (name, changed, place, allowed) in cases {
        let (status, message, written) = outcome(name, &changed);
        assert_eq!((status, written), (2, false), "{name}: {message}");
        assert!(message.contains(place) && message.contains(allowed), "{name}: {message}");
    }
}
