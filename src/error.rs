//! Every way a computation can be refused or can fail, with the place, the value and what is allowed.

use std::path::PathBuf;

/// An input that was refused before anything was computed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {value} is not allowed; allowed: {allowed}")]
pub struct Refusal {
    /// Where the input came from: an option, or a file with its line and key.
    pub place: String,
    /// The value as it was given.
    pub value: String,
    /// What would have been accepted.
    pub allowed: String,
}

impl Refusal {
    /// Refuses `value`, found at `place`, where only `allowed` is accepted.
    pub fn new(place: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self { place: place.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// The same refusal with the one of `known` that `word` may have been meant for, if there is any.
    pub fn suggesting<'a>(mut self, word: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        if let Some(meant) = nearest(word, known) {
            self.allowed += &format!("; did you mean {meant}?");
        }
        self
    }
}

/// The one of `known` nearest to `word` if they differ by slips of the hand: at most one for each three letters typed.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let slips = |name: &&str| strsim::damerau_levenshtein(word, name);
    let nearest = known.into_iter().min_by_key(slips)?;
    (slips(&nearest) <= word.chars().count().div_ceil(3)).then_some(nearest)
}

/// What the operating system said of a file, as a user would.
pub fn reason(source: &std::io::Error) -> String {
    match source.kind() {
        std::io::ErrorKind::NotFound => "not found".to_owned(),
        _ => source.to_string(),
    }
}

/// What can go wrong in this crate.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input was refused; nothing was computed or written.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// A scene file could not be read as TOML or has a key that is not known.
    #[error("{path}, line {line}: {message}")]
    SceneFile {
        /// The file as the user named it.
        path: String,
        /// The line, counted from 1.
        line: usize,
        /// The parser's own words.
        message: String,
    },
    /// A file could not be read or written.
    #[error("{path}: {}; allowed: a path that can be {wanted}", reason(source))]
    File {
        /// The path as the user named it.
        path: PathBuf,
        /// What was tried: "read" or "written".
        wanted: &'static str,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A scene that is neither built in nor a file.
    #[error("{argument}: not found; allowed: {allowed}")]
    NotFound {
        /// What the user named.
        argument: String,
        /// The names that are built in, and what may have been meant.
        allowed: String,
    },
    /// A limit that could not be enclosed closely enough.
    #[error("{message}")]
    Uncertified {
        /// Proven lower bound of l_max, rad^2/s^2; 0 where there is none.
        lower: f64,
        /// Proven upper bound of l_max, rad^2/s^2; infinite where there is none.
        upper: f64,
        /// What was reached and what was asked.
        message: String,
    },
}

/// The result of everything here that can fail.
pub type Result<T, E = Error> = std::result::Result<T, E>;
