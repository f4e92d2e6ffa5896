//! Scenes from TOML. Every refusal names the file, the line and the key.

use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use super::{Bar, End, Impact, Scene, built_in};
use crate::error::{Error, Refusal, Result, nearest};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneText {
    name: Option<Spanned<String>>,
    #[serde(default)]
    ends: EndsText,
    bar: Vec<Spanned<BarText>>,
    impact: Option<Spanned<ImpactText>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct EndsText {
    left: End,
    right: End,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BarText {
    length: Spanned<f64>,
    elements: Spanned<i64>,
    youngs_modulus: Spanned<f64>,
    density: Spanned<f64>,
    area: Spanned<f64>,
    velocity: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImpactText {
    duration: Spanned<f64>,
    gaps: Option<Spanned<Vec<f64>>>,
    gravity: Option<Spanned<f64>>,
}

/// The scene called `argument`: a built-in name or the path of a TOML file.
///
/// # Errors
/// A name that is neither, a file that cannot be read, and everything [`Scene::new`] refuses.
pub fn load(argument: &str) -> Result<Scene> {
    match built_in(argument) {
        Some(scene) => scene,
        None => parse(&read(argument)?, argument),
    }
}

/// The text of the scene file at `argument`.
pub(crate) fn read(argument: &str) -> Result<String> {
    let path = Path::new(argument);
    if !path.exists() {
        return Err(not_found(argument));
    }
    std::fs::read_to_string(path).map_err(|source| Error::File {
        path: path.to_owned(),
        wanted: "read as UTF-8 text",
        source,
    })
}

/// What may have been meant by a scene that is not there: one that is built in, or a scene file of the same folder.
fn not_found(argument: &str) -> Error {
    let names = super::BUILT_IN.map(|(name, _)| name);
    let folder = Path::new(argument).parent().unwrap_or(Path::new(""));
    let read = std::fs::read_dir(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    let files = read.into_iter().flatten().flatten().map(|entry| folder.join(entry.file_name()));
    let files: Vec<String> = files
        .filter(|file| file.extension().is_some_and(|ending| ending == "toml"))
        .map(|file| file.to_string_lossy().into_owned())
        .collect();
    let mut allowed = format!("the path of a scene file, or one of {}", names.join(", "));
    if let Some(meant) = nearest(argument, names.into_iter().chain(files.iter().map(String::as_str))) {
        allowed += &format!("; did you mean {meant}?");
    }
    Error::NotFound { argument: argument.to_owned(), allowed }
}

/// The name of a scene: as its file has it, else the file's own without its ending, blanks and the like as '-'.
///
/// # Errors
/// A name that no file could have.
pub(crate) fn name_of(raw: Option<&Spanned<String>>, text: &str, path: &str) -> Result<String, Refusal> {
    let legal = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    let Some(raw) = raw else {
        let stem =
            Path::new(path).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let name: String = stem.chars().map(|c| if legal(c) { c } else { '-' }).collect();
        return Ok(if name.is_empty() { "scene".to_owned() } else { name });
    };
    let name = raw.get_ref();
    if name.is_empty() || !name.chars().all(legal) {
        let place = format!("{path}, line {}, name", line_of(text, raw.span().start));
        return Err(Refusal::new(place, format!("{name:?}"), "letters, digits, '-' and '_', at least one"));
    }
    Ok(name.clone())
}

/// Reads a scene from TOML `text`; `path` is what messages call it.
///
/// # Errors
/// TOML that cannot be read, keys that are not known, and everything [`Scene::new`] refuses, with its line.
pub fn parse(text: &str, path: &str) -> Result<Scene> {
    let raw: SceneText = toml::from_str(text).map_err(|error| in_file(&error, text, path))?;
    let lines = Lines::of(&raw, text);
    let place = |key: &str| format!("{path}, line {}, {key}", lines.line(key));
    for (i, bar) in raw.bar.iter().enumerate() {
        let elements = *bar.get_ref().elements.get_ref();
        if elements < 1 {
            let key = format!("bar {}, elements", i + 1);
            return Err(Refusal::new(place(&key), elements, "an integer of at least 1").into());
        }
    }
    let name = name_of(raw.name.as_ref(), text, path)?;
    let scene = build(name, raw);
    scene.check(&place)?;
    Ok(scene)
}

/// The parser's words with the line they are about; a missing key has none.
pub(crate) fn in_file(error: &toml::de::Error, text: &str, path: &str) -> Error {
    let line = line_of(text, error.span().map_or(0, |span| span.start));
    // The parser speaks of its types; the user knows numbers.
    let words = error
        .message()
        .replace("f64", "a number")
        .replace("i64", "an integer")
        .replace("floating point", "number");
    let quoted = text.lines().nth(line - 1).map(str::trim).filter(|_| !words.starts_with("missing"));
    let mut message = quoted.map_or_else(|| words.clone(), |quoted| format!("`{quoted}`: {words}"));
    if let Some(meant) = meant_key(&words) {
        message += &format!("; did you mean `{meant}`?");
    }
    Error::SceneFile { path: path.to_owned(), line, message }
}

/// The key that may have been meant by an unknown one: the parser quotes it, and then those it knows.
fn meant_key(words: &str) -> Option<&str> {
    let mut quoted = words.strip_prefix("unknown ")?.split('`').skip(1).step_by(2);
    nearest(quoted.next()?, quoted)
}

fn build(name: String, raw: SceneText) -> Scene {
    let bars = raw.bar.into_iter().map(Spanned::into_inner).map(|bar| Bar {
        length: bar.length.into_inner(),
        elements: bar.elements.into_inner() as usize,
        youngs_modulus: bar.youngs_modulus.into_inner(),
        density: bar.density.into_inner(),
        area: bar.area.into_inner(),
        velocity: bar.velocity.map_or(0.0, Spanned::into_inner),
    });
    let impact = raw.impact.map(Spanned::into_inner).map(|impact| Impact {
        duration: impact.duration.into_inner(),
        gaps: impact.gaps.map_or_else(Vec::new, Spanned::into_inner),
        gravity: impact.gravity.map_or(0.0, Spanned::into_inner),
    });
    Scene { name, left: raw.ends.left, right: raw.ends.right, bars: bars.collect(), impact }
}

/// The line of every key, for messages.
struct Lines(Vec<(String, usize)>);

impl Lines {
    fn of(raw: &SceneText, text: &str) -> Self {
        let mut found = Vec::new();
        for (i, bar) in raw.bar.iter().enumerate() {
            let values = bar.get_ref();
            let mut add = |key: &str, at: usize| found.push((format!("bar {}, {key}", i + 1), at));
            add("length", values.length.span().start);
            add("elements", values.elements.span().start);
            add("youngs_modulus", values.youngs_modulus.span().start);
            add("density", values.density.span().start);
            add("area", values.area.span().start);
            add("velocity", values.velocity.as_ref().map_or(bar.span().start, |v| v.span().start));
        }
        if let Some(impact) = &raw.impact {
            let values = impact.get_ref();
            let start = impact.span().start;
            found.push(("impact.duration".to_owned(), values.duration.span().start));
            found.push(("impact.gaps".to_owned(), values.gaps.as_ref().map_or(start, |g| g.span().start)));
            found.push((
                "impact.gravity".to_owned(),
                values.gravity.as_ref().map_or(start, |g| g.span().start),
            ));
        }
        Self(found.into_iter().map(|(key, at)| (key, line_of(text, at))).collect())
    }

    fn line(&self, key: &str) -> usize {
        self.0.iter().find(|(known, _)| known == key).map_or(1, |(_, line)| *line)
    }
}

/// The line, counted from 1, of byte `at`.
pub(crate) fn line_of(text: &str, at: usize) -> usize {
    text.bytes().take(at).filter(|byte| *byte == b'\n').count() + 1
}
