//! Bad input: exit status 2, one message that names the place, the value and what is allowed, and nothing written.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/tool.rs"]
mod tool;

use tool::{Scratch, run_words, scene};

/// Refused, with every one of `words` in the message.
fn refused(scratch: &Scratch, arguments: &[&str], words: &[&str]) {
    let before = scratch.files();
    let out = run_words(scratch, arguments);
    let message = &out.stderr;
    assert_eq!(out.status, 2, "{arguments:?}: {message}");
    assert_eq!(out.stdout, "", "{arguments:?}");
    assert!(
        message.starts_with("error: ") && message.matches("error:").count() == 1,
        "{arguments:?}: {message}"
    );
    for bad in ["panicked", "backtrace", "overflow"] {
        assert!(!message.contains(bad), "{arguments:?}: {message}");
    }
    for word in words {
        assert!(message.contains(word), "{arguments:?}: no {word:?} in {message}");
    }
    assert_eq!(scratch.files(), before, "{arguments:?} wrote something");
}

fn options(place: &str, cases: &[(&str, &str)]) {
    let scratch = Scratch::new(&format!("refused{place}"));
    for (value, allowed) in cases {
        let other = if place == "--ratio" { ["--beta-s", "1"] } else { ["--ratio", "1"] };
        let separate = [&["signorini"], &other[..], &[place, value]].concat();
        refused(&scratch, &separate, &[place, value, allowed]);
        let joined = format!("{place}={value}");
        refused(&scratch, &[&["signorini"], &other[..], &[&joined]].concat(), &[place, value, allowed]);
    }
}

#[test]
fn a_stiffness_penalty_is_refused() {
    let range = "lin:start:stop:count or log:start:stop:count";
    let count = "an integer from 2 to 100000000";
    options(
        "--beta-s",
        &[
            ("-1", "a finite number of at least 0"),
            ("inf", "a finite number of at least 0"),
            ("NaN", "a finite number of at least 0"),
            ("lin:0:10:0", count),
            ("lin:0:10:1", count),
            ("lin:0:10:2.5", count),
            ("lin:0:10:1000000000000", count),
            ("lin:10:0:5", "a start below the stop"),
            ("lin:1:1:5", "a start below the stop"),
            ("lin:0:inf:5", "finite ends"),
            ("log:0:1:5", "a positive start"),
            ("lin:0:1", range),
            ("cube:0:1:5", range),
            ("1,,2", "a number such as 0.5, 1e12 or inf"),
            ("garbage", "a number such as 0.5, 1e12 or inf"),
        ],
    );
}

#[test]
fn a_ratio_is_refused() {
    let positive = "a positive number, or inf";
    let cases = [("0", positive), ("-1", positive), ("NaN", positive), ("log:0:1:5", "a positive start")];
    options("--ratio", &cases);
}

#[test]
fn other_options_are_refused() {
    let elements = "an integer from 1 to 100000000";
    options(
        "--elements",
        &[
            ("0", elements),
            ("2.5", elements),
            ("-3", elements),
            ("100000001", elements),
            ("99999999999999999999", elements),
            ("many", elements),
        ],
    );
    options(
        "--mass",
        &[("1.2", "a number in [0, 1]"), ("-0.1", "a number in [0, 1]"), ("heavy", "lumped, averaged")],
    );
    options(
        "--threads",
        &[("0", "1 to 1024"), ("-1", "1 to 1024"), ("1.5", "1 to 1024"), ("1025", "1 to 1024")],
    );
    options("--engine", &[("steam", "auto, closed-form, secular, sturm, dense")]);
    options("--limit", &[("sky", "spectrum")]);
    options("--format", &[("gif", "svg, png, pdf, csv, json")]);
    options("--stdout", &[("xml", "csv, json")]);
    options("--penalty-mass", &[("none", "consistent, diagonalised")]);
}

#[test]
fn what_does_not_go_together_is_refused() {
    let scratch = Scratch::new("together");
    let million = ["signorini", "--beta-s", "lin:0:1:1000000", "--ratio", "lin:1:2:1000000"];
    refused(
        &scratch,
        &million,
        &["--beta-s", "--ratio", "1000000 x 1000000 points", "from 1 to 100000000 points"],
    );
    let dense = ["signorini", "--elements", "20000", "--engine", "dense"];
    refused(&scratch, &dense, &["--engine", "20001 nodes", "at most 20000 nodes"]);
    refused(&scratch, &["--beta-s", "1"], &["SCENE", "none", "at least one scene"]);
    refused(&scratch, &["--unheard-of"], &["--unheard-of"]);
    let range = ["signorini", "--beta-s", "1e305", "--ratio", "1e-300"];
    refused(&scratch, &range, &["--beta-s", "--ratio", "1e305", "1e-300", "keep it within"]);
    // Two runs that would write the same files; the records of both may well be printed.
    refused(&scratch, &["signorini", "signorini"], &["SCENE", "signorini-lumped", "different names"]);
    refused(&scratch, &["signorini", "--mass", "lumped,1"], &["--mass", "signorini-lumped", "different"]);
}

#[test]
fn a_directory_that_cannot_be_written_is_refused() {
    let scratch = Scratch::new("unwritable");
    scratch.write("file", "");
    for out in ["file", "file/below", "/proc/none/such", "/dev/null"] {
        refused(&scratch, &["signorini", "--out", out], &["--out", out, "a directory that can be written"]);
    }
}

#[test]
fn a_scene_that_is_no_file_is_refused() {
    let scratch = Scratch::new("no-file");
    refused(
        &scratch,
        &["missing.toml"],
        &["SCENE", "missing.toml", "not found", "signorini, symmetric, hunek"],
    );
    refused(&scratch, &[""], &["SCENE", "\"\"", "the path of a scene file"]);
    refused(&scratch, &["."], &[".", "read as UTF-8 text"]);
    scratch.write("latin.toml", b"name = \"caf\xe9\"\n");
    refused(&scratch, &["latin.toml"], &["latin.toml", "UTF-8"]);
    scratch.write("empty.toml", "");
    refused(&scratch, &["empty.toml"], &["empty.toml, line 1", "[[bar]], [matrices] and [[body]]"]);
}

/// `broken` instead of the first scene's line of that key; the message names file, line, value and what is allowed.
fn scene_refused(broken: &str, words: &[&str]) {
    let scratch = Scratch::new("scene");
    let text = scene("bars", "left = \"wall\"", &[broken]);
    let line = text.lines().position(|line| line == broken.lines().last().unwrap()).unwrap() + 1;
    scratch.write("bad.toml", &text);
    let place = format!("bad.toml, line {line}");
    refused(&scratch, &["bad.toml", "--beta-s", "1"], &[&[place.as_str()], words].concat());
}

#[test]
fn a_wrong_value_in_a_scene_is_refused() {
    scene_refused("length = -1.0", &["bar 1, length", "-1", "a positive finite number (m)"]);
    scene_refused("length = 0.0", &["bar 1, length", "0", "a positive finite number (m)"]);
    scene_refused("density = nan", &["bar 1, density", "NaN", "a positive finite number (kg/m^3)"]);
    scene_refused("area = inf", &["bar 1, area", "inf", "a positive finite number (m^2)"]);
    scene_refused("velocity = inf", &["bar 1, velocity", "inf", "a finite number (m/s)"]);
    scene_refused("elements = 0", &["bar 1, elements", "0", "an integer"]);
    scene_refused("elements = -7", &["bar 1, elements", "-7", "an integer"]);
    scene_refused("elements = 2.5", &["elements", "2.5", "an integer"]);
    scene_refused("elements = 1000000000000", &["bar 1, elements", "1000000000000", "from 1 to 100000000"]);
    scene_refused("youngs_modulus = \"stiff\"", &["youngs_modulus", "stiff", "a number"]);
    scene_refused("colour = 3", &["unknown field `colour`", "`length`", "`elements`"]);
    scene_refused("length = 1.0\nlength = 2.0", &["duplicate key", "length = 2.0"]);
    scene_refused("youngs_modulus = 1e300", &["youngs_modulus", "1e300", "<= 1e290"]);
    scene_refused("density = 1e-300", &["density", "1e-300", "1e-290 <="]);
}

#[test]
fn a_wrong_scene_is_refused() {
    let scratch = Scratch::new("wrong-scene");
    let bad = |text: String, words: &[&str]| {
        scratch.write("bad.toml", text);
        refused(&scratch, &["bad.toml", "--beta-s", "1"], &[&["bad.toml, line"], words].concat());
    };
    bad(scene("two words", "", &["area = 1.0"]), &["name", "two words", "letters, digits, '-' and '_'"]);
    bad(scene("../up", "", &["area = 1.0"]), &["name", "../up", "letters, digits, '-' and '_'"]);
    bad(scene("bars", "left = \"glued\"", &["area = 1.0"]), &["glued", "`free`, `fixed`, `wall`"]);
    bad(scene("bars", "", &[]), &["without any of its tables", "[[bar]], [matrices] and [[body]]"]);
    bad("name = \"bars\"\nbar = []\n".to_owned(), &["no bar", "at least one"]);
    let fixed = "left = \"fixed\"\nright = \"fixed\"";
    bad(scene("bars", fixed, &["elements = 1"]), &["bar 1, elements", "two fixed ends", "at least 2"]);
    bad("name = \"bars\n".to_owned(), &["name = \"bars"]);
    let gaps = "[impact]\nduration = 1.0\ngaps = [0.0, 1.0]\n";
    bad(scene("bars", "", &["area = 1.0"]) + gaps, &["impact.gaps", "2 values", "here 0"]);
    // Each bar can be held, the contact between them cannot.
    let apart = [
        "youngs_modulus = 1e150\ndensity = 1e-100",
        "youngs_modulus = 1e-150\ndensity = 1e100\narea = 1e-30",
    ];
    scratch.write("bad.toml", scene("bars", "", &apart));
    refused(
        &scratch,
        &["bad.toml", "--beta-s", "10", "--ratio", "2"],
        &["penalty mass", "beta_s = 1e1", "within"],
    );
}
