//! The scenes of the paper, compiled in from the files under `built_in/`.

use super::{Scene, file};
use crate::error::Result;

/// Name and TOML text of every built-in scene.
pub const BUILT_IN: [(&str, &str); 4] = [
    ("signorini", include_str!("built_in/signorini.toml")),
    ("symmetric", include_str!("built_in/symmetric.toml")),
    ("hunek", include_str!("built_in/hunek.toml")),
    ("bouncing-bar", include_str!("built_in/bouncing-bar.toml")),
];

/// The built-in scene of this name, or `None`.
///
/// # Errors
/// None in practice: the compiled-in texts are read by a test.
pub fn built_in(name: &str) -> Option<Result<Scene>> {
    let (name, text) = BUILT_IN.iter().find(|(known, _)| *known == name)?;
    Some(file::parse(text, &format!("built-in scene {name}")))
}
