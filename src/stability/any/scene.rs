//! A scene of any kind: bars, matrices or meshes, told apart by the tables of its file.

use toml::de::DeTable;

use crate::error::{Refusal, Result};
use crate::matrices::MatrixScene;
use crate::mesh::MeshScene;
use crate::scene::{self, Scene, in_file, line_of};

/// A scene of bars, of matrices, or of meshes.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyScene {
    /// `[[bar]]`.
    Bars(Scene),
    /// `[matrices]`.
    Matrices(MatrixScene),
    /// `[[body]]`.
    Mesh(MeshScene),
}

/// The tables of which a scene holds one.
const TABLES: [(&str, &str); 3] = [("bar", "[[bar]]"), ("matrices", "[matrices]"), ("body", "[[body]]")];

impl AnyScene {
    /// The scene called `argument`: a built-in name or the path of a TOML file.
    ///
    /// # Errors
    /// A name that is neither, a file that cannot be read, and what [`AnyScene::parse`] refuses.
    pub fn load(argument: &str) -> Result<Self> {
        match scene::built_in(argument) {
            Some(scene) => Ok(Self::Bars(scene?)),
            None => Self::parse(&scene::read(argument)?, argument),
        }
    }

    /// The scene in TOML `text`; `path` is what messages call it, and its folder is where files are looked for.
    ///
    /// # Errors
    /// None or several of `[[bar]]`, `[matrices]` and `[[body]]`, with their lines, and what the scene of each kind
    /// refuses.
    pub fn parse(text: &str, path: &str) -> Result<Self> {
        let tables = DeTable::parse(text).map_err(|error| in_file(&error, text, path))?;
        let line = |key: &str| {
            let key = tables.get_ref().keys().find(|known| known.get_ref() == key)?;
            Some(line_of(text, key.span().start))
        };
        let found: Vec<_> =
            TABLES.iter().filter_map(|(key, table)| Some((*key, *table, line(key)?))).collect();
        match found[..] {
            [("bar", ..)] => scene::parse(text, path).map(Self::Bars),
            [("matrices", ..)] => MatrixScene::parse(text, path).map(Self::Matrices),
            [("body", ..)] => MeshScene::parse(text, path).map(Self::Mesh),
            [] => {
                let allowed = "one of [[bar]], [matrices] and [[body]]";
                Err(Refusal::new(format!("{path}, line 1"), "a scene without any of its tables", allowed)
                    .into())
            }
            _ => {
                let several: Vec<String> =
                    found.iter().map(|(_, table, line)| format!("{table} (line {line})")).collect();
                let place =
                    format!("{path}, line {}", found.iter().map(|(.., line)| *line).max().unwrap_or(1));
                Err(Refusal::new(place, several.join(" beside "), "one of them in a scene").into())
            }
        }
    }

    /// The name, used in records and file names.
    pub fn name(&self) -> &str {
        match self {
            Self::Bars(scene) => scene.name(),
            Self::Matrices(scene) => &scene.name,
            Self::Mesh(scene) => &scene.name,
        }
    }

    /// The same scene with `elements` in the first bar.
    ///
    /// # Errors
    /// As [`Scene::with_elements`]; scenes of matrices and of meshes, which say themselves how finely they are meshed.
    pub fn with_elements(&self, elements: usize) -> Result<Self, Refusal> {
        match self {
            Self::Bars(scene) => scene.with_elements(elements).map(Self::Bars),
            Self::Matrices(_) | Self::Mesh(_) => {
                let value = format!("{elements} with scene {}", self.name());
                Err(Refusal::new(
                    "elements",
                    value,
                    "a scene of [[bar]]; `cells` of a [[body]] are in its file",
                ))
            }
        }
    }
}
