//! What can stop a tool: a refusal or failure of the library, a file, a record or a figure.

use std::path::PathBuf;

pub use bipenalty::error::Refusal;
use bipenalty::error::reason;

/// What can go wrong in a tool.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The library refused the input, or could not read a scene.
    #[error(transparent)]
    Library(#[from] bipenalty::error::Error),
    /// A file could not be read or written.
    #[error("{path}: {}; allowed: a path that can be {wanted}", reason(source))]
    File {
        /// The path as the user named it.
        path: PathBuf,
        /// What was tried: "read", "written" or "run".
        wanted: &'static str,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Records could not be turned into text.
    #[error("the records could not be written: {0}")]
    Record(String),
    /// A figure could not be drawn.
    #[error("the figure {name} could not be drawn: {source}")]
    Figure {
        /// The file name without its ending.
        name: String,
        /// What the drawing crate said.
        source: figure::PlotError,
    },
}

impl From<Refusal> for Error {
    fn from(refusal: Refusal) -> Self {
        Self::Library(refusal.into())
    }
}

impl From<csv::Error> for Error {
    fn from(error: csv::Error) -> Self {
        Self::Record(error.to_string())
    }
}

/// The result of everything in a tool that can fail.
pub type Result<T, E = Error> = std::result::Result<T, E>;
