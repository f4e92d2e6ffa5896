//! Scenes from TOML. Every refusal names the file, the line and the key.

use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use super::{Bar, End, Impact, Scene, built_in};
use crate::error::{Error, Refusal, Result};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneText {
    name: Spanned<String>,
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
        let names: Vec<_> = super::BUILT_IN.iter().map(|(name, _)| *name).collect();
        return Err(Refusal::new(
            "SCENE",
            format!("{argument:?}, not found,"),
            format!("the path of a scene file, or one of {}", names.join(", ")),
        )
        .into());
    }
    std::fs::read_to_string(path).map_err(|source| Error::File {
        path: path.to_owned(),
        wanted: "read as UTF-8 text",
        source,
    })
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
            let key = format!("bar[{i}].elements");
            return Err(Refusal::new(place(&key), elements, "an integer of at least 1").into());
        }
    }
    let scene = build(raw);
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
    let message = quoted.map_or_else(|| words.clone(), |quoted| format!("`{quoted}`: {words}"));
    Error::SceneFile { path: path.to_owned(), line, message }
}

fn build(raw: SceneText) -> Scene {
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
    Scene {
        name: raw.name.into_inner(),
        left: raw.ends.left,
        right: raw.ends.right,
        bars: bars.collect(),
        impact,
    }
}

/// The line of every key, for messages.
struct Lines(Vec<(String, usize)>);

impl Lines {
    fn of(raw: &SceneText, text: &str) -> Self {
        let mut found = vec![("name".to_owned(), raw.name.span().start)];
        for (i, bar) in raw.bar.iter().enumerate() {
            let values = bar.get_ref();
            let mut add = |key: &str, at: usize| found.push((format!("bar[{i}].{key}"), at));
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
