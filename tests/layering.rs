//! The architecture within the library, read from the sources: imports point one way, files stay short. Between the
//! library, the bench, the drawing and the tools Cargo keeps the order.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

/// Every module with the modules it may name. What is not listed here may not exist.
const MAY_NAME: [(&str, &[&str]); 20] = [
    ("error", &[]),
    ("memory", &["error"]),
    ("interrupt", &[]),
    ("scene", &["error"]),
    ("fem", &["error", "scene", "sparse", "pencil"]),
    ("pencil", &["error", "sparse", "symmetric"]),
    ("sparse", &["double_double"]),
    ("double_double", &[]),
    ("symmetric", &[]),
    ("mesh", &["error", "memory", "interrupt", "scene", "fem", "sparse", "pencil"]),
    ("matrices", &["error", "scene", "sparse", "pencil"]),
    ("convex", &["error", "interrupt", "double_double", "sparse", "symmetric", "pencil"]),
    ("damping", &["error", "pencil", "spectrum", "convex"]),
    ("parts", &["error", "memory", "fem", "sparse", "pencil", "mesh", "convex"]),
    ("penalty", &["error", "pencil"]),
    ("spectrum", &["error", "double_double", "sparse", "symmetric", "pencil"]),
    (
        "stability", // of any scene, and the limits of schemes
        &[
            "error", "memory", "scene", "fem", "pencil", "penalty", "spectrum", "schemes", "sparse", "mesh",
            "matrices", "convex", "damping", "parts",
        ],
    ),
    (
        "schemes",
        &["error", "memory", "double_double", "sparse", "symmetric", "pencil", "spectrum", "damping"],
    ),
    (
        "impact",
        &[
            "error",
            "memory",
            "interrupt",
            "scene",
            "fem",
            "mesh",
            "pencil",
            "penalty",
            "spectrum",
            "schemes",
            "stability",
        ],
    ),
    (
        "verify",
        &[
            "error",
            "interrupt",
            "scene",
            "fem",
            "pencil",
            "penalty",
            "spectrum",
            "stability",
            "schemes",
            "impact",
        ],
    ),
];

/// Files may not be longer.
const MOST_LINES: usize = 450;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn rust_files(directory: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        match path.extension() {
            // A crate of its own: Cargo keeps its order.
            _ if path.join("Cargo.toml").exists() => (),
            _ if path.is_dir() => found.extend(rust_files(&path)),
            Some(ending) if ending == "rs" => found.push(path),
            _ => (),
        }
    }
    found.sort();
    found
}

/// The top-level module that a file under src belongs to; "lib" for the crate's root.
fn module_of(path: &Path) -> String {
    let relative = path.strip_prefix(root().join("src")).unwrap();
    relative.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs").to_owned()
}

/// The code of a line: without comment, and nothing of a doc comment.
fn code(line: &str) -> &str {
    line.split("//").next().unwrap_or("")
}

/// The top-level modules that a source names, with the line: every `crate::name`, also inside `crate::{a::B, c}`.
fn named(source: &str) -> Vec<(String, usize)> {
    let text: String = source.lines().map(|line| format!("{}\n", code(line))).collect();
    let mut found = Vec::new();
    for (at, _) in text.match_indices("crate::") {
        // `$crate::` and `my_crate::` are other words.
        if text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let line = text[..at].matches('\n').count() + 1;
        let after = &text[at + "crate::".len()..];
        let names = match after.strip_prefix('{') {
            Some(group) => first_words(group),
            None => vec![word(after)],
        };
        found.extend(names.into_iter().map(|name| (name, line)));
    }
    found
}

fn word(text: &str) -> String {
    text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The first word of each item of a `{ }` group, up to its closing brace.
fn first_words(group: &str) -> Vec<String> {
    let (mut depth, mut starts) = (0, vec![0]);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => starts.push(at + 1),
            _ => (),
        }
    }
    starts.into_iter().map(|at| word(&group[at..])).filter(|name| !name.is_empty()).collect()
}

/// What a module names beyond what it may, one complaint each.
fn complaints(module: &str, source: &str, modules: &[String]) -> Vec<String> {
    let Some((_, allowed)) = MAY_NAME.iter().find(|(name, _)| *name == module) else {
        return vec![format!("module {module} has no place in the architecture")];
    };
    let foreign =
        |name: &String| modules.contains(name) && name != module && !allowed.contains(&name.as_str());
    let bad = named(source).into_iter().filter(|(name, _)| foreign(name));
    bad.map(|(name, line)| format!("line {line}: {module} names {name}")).collect()
}

#[test]
fn imports_point_one_way() {
    let files = rust_files(&root().join("src"));
    let modules: Vec<String> = files.iter().map(|path| module_of(path)).collect();
    assert!(
        modules.len() > 20 && modules.contains(&"spectrum".to_owned()),
        "read the wrong folder: {modules:?}"
    );
    let mut bad = Vec::new();
    for (path, module) in
        files.iter().zip(&modules).filter(|(_, module)| !["lib", "build"].contains(&module.as_str()))
    {
        let source = fs::read_to_string(path).unwrap();
        bad.extend(complaints(module, &source, &modules).iter().map(|c| format!("{}, {c}", path.display())));
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

/// The table itself has no circle.
#[test]
fn the_table_has_no_circle() {
    let allowed = |module: &str| MAY_NAME.iter().find(|(name, _)| *name == module).unwrap().1;
    for (module, names) in MAY_NAME {
        let mut reached: Vec<&str> = names.to_vec();
        let mut next = 0;
        while next < reached.len() {
            let further = allowed(reached[next]).iter().filter(|name| !reached.contains(name));
            reached.extend(further.copied().collect::<Vec<_>>());
            next += 1;
        }
        assert!(!reached.contains(&module), "{module} reaches itself through {reached:?}");
    }
}

/// The reader of imports is no better than its blind spots: it must see each of these.
#[test]
fn the_reader_sees_every_form_of_import() {
    let modules = ["scene", "spectrum", "stability", "pencil"].map(str::to_owned);
    let seen = |source: &str| complaints("spectrum", source, &modules).len();
    assert_eq!(seen("use crate::scene::Bar;\n"), 1);
    assert_eq!(seen("fn f(bar: &crate::scene::Bar) {}\n"), 1);
    assert_eq!(seen("use crate::{pencil::{Gap, Pencil}, stability::Model,\n    scene};\n"), 2);
    assert_eq!(seen("pub(crate) use super::super::x; // crate::scene\n//! crate::scene\n"), 0);
    assert_eq!(seen("use crate::pencil::Pencil;\nuse crate::spectrum::Dense;\n"), 0);
    assert_eq!(complaints("elsewhere", "", &modules).len(), 1);
}

#[test]
fn files_are_short() {
    let folders = ["src", "src/python/src", "analyses", "tests"].map(|folder| root().join(folder));
    let files: Vec<PathBuf> = folders.iter().flat_map(|folder| rust_files(folder)).collect();
    assert!(files.len() > 30);
    let lines = |path: &Path| fs::read_to_string(path).unwrap().lines().count();
    let long: Vec<_> = files.iter().filter(|path| lines(path) > MOST_LINES).collect();
    assert!(long.is_empty(), "more than {MOST_LINES} lines: {long:?}");
}

/// `println!` and its kin panic where the reader of a pipe has gone; the tools have lines of their own that do not.
#[test]
fn nothing_is_printed_that_panics() {
    for path in ["src", "analyses"].iter().flat_map(|folder| rust_files(&root().join(folder))) {
        let source = fs::read_to_string(&path).unwrap();
        let printed =
            source.lines().map(code).find(|line| line.contains("println!") || line.contains("print!("));
        assert!(printed.is_none() || path.ends_with("build.rs"), "{}: {printed:?}", path.display());
    }
}
