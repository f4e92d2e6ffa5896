//! Files and standard output. Nothing is created before the run has something to write.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{Format, OutputOptions, StandardOutput};
use crate::error::{Error, Refusal, Result};
use crate::plot::Figure;
use crate::record::{self, Provenance};

/// Where a run writes, checked before it computes.
#[derive(Debug, Clone)]
pub struct Output {
    directory: PathBuf,
    formats: Vec<Format>,
    stdout: Option<StandardOutput>,
    provenance: Provenance,
}

impl Output {
    /// Prepares the output of `tool`, sets the number of threads, and checks that the directory can be written.
    ///
    /// # Errors
    /// Refuses a directory that is a file or cannot be written to.
    pub fn prepare(options: &OutputOptions, tool: &str) -> Result<Self> {
        let directory = options.out.clone().unwrap_or_else(|| Path::new("figures").join(tool));
        if options.stdout.is_none() && !options.explain {
            check_writable(&directory)?;
        }
        if let Some(threads) = options.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
            pool.map_err(|e| Refusal::new("--threads", threads, format!("what the system grants ({e})")))?;
        }
        Ok(Self {
            directory,
            formats: options.format.clone(),
            stdout: options.stdout,
            provenance: Provenance::new(tool, std::env::args().skip(1)),
        })
    }

    /// Tells on standard error how many files a run has written, if any.
    pub fn report(&self, files: usize) {
        match files {
            0 => (),
            1 => eprintln!("1 file in {}", self.directory.display()),
            _ => eprintln!("{files} files in {}", self.directory.display()),
        }
    }

    /// Whether figures are wanted at all.
    pub fn wants_figures(&self) -> bool {
        self.stdout.is_none() && self.formats.iter().any(|format| format.is_figure())
    }

    /// Whether records go to standard output instead of files.
    pub fn to_stdout(&self) -> bool {
        self.stdout.is_some()
    }

    /// Prints `text` on standard output.
    ///
    /// # Errors
    /// A closed pipe.
    pub fn print_text(text: &str) -> Result<()> {
        print_bytes(text.as_bytes())
    }

    /// Prints the rows of the whole run, if standard output was asked for.
    ///
    /// # Errors
    /// A closed pipe.
    pub fn print<R: Serialize>(&self, rows: impl IntoIterator<Item = R>) -> Result<()> {
        let bytes = match self.stdout {
            None => return Ok(()),
            Some(StandardOutput::Csv) => record::csv(rows)?,
            Some(StandardOutput::Json) => record::json(&self.provenance, rows)?,
        };
        print_bytes(&bytes)
    }

    /// Writes the rows as `stem.csv` and `stem.json`, as asked for.
    ///
    /// # Errors
    /// What the system says of the file.
    pub fn write_rows<R: Serialize + Clone>(&self, stem: &str, rows: &[R]) -> Result<Vec<PathBuf>> {
        let mut written = Vec::new();
        for format in self.file_formats() {
            let bytes = match format {
                Format::Csv => record::csv(rows.iter())?,
                Format::Json => record::json(&self.provenance, rows.iter())?,
                _ => continue,
            };
            written.push(self.write(stem, format, &bytes)?);
        }
        Ok(written)
    }

    /// Draws `figure` as `stem.svg`, `stem.png` and `stem.pdf`, as asked for.
    ///
    /// # Errors
    /// What the drawing layer refuses and what the system says of the file.
    pub fn write_figure(&self, stem: &str, figure: &Figure) -> Result<Vec<PathBuf>> {
        let mut written = Vec::new();
        for format in self.file_formats() {
            let drawn = match format {
                Format::Svg => figure.svg().map(String::into_bytes),
                Format::Png => figure.png(),
                Format::Pdf => figure.pdf(),
                _ => continue,
            };
            let bytes = drawn.map_err(|source| Error::Figure { name: stem.to_owned(), source })?;
            written.push(self.write(stem, format, &bytes)?);
        }
        Ok(written)
    }

    fn file_formats(&self) -> impl Iterator<Item = Format> {
        self.formats.iter().copied().filter(|_| self.stdout.is_none())
    }

    /// Writes a file whole or not at all: to a neighbour first, then renamed.
    fn write(&self, stem: &str, format: Format, bytes: &[u8]) -> Result<PathBuf> {
        let path = self.directory.join(format!("{stem}.{}", format.ending()));
        let draft = self.directory.join(format!(".{stem}.{}.part", format.ending()));
        let written = std::fs::create_dir_all(&self.directory)
            .and_then(|()| std::fs::write(&draft, bytes))
            .and_then(|()| std::fs::rename(&draft, &path));
        match written {
            Ok(()) => Ok(path),
            Err(source) => Err(Error::File { path, wanted: "written", source }),
        }
    }
}

fn print_bytes(bytes: &[u8]) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    let written = stdout.write_all(bytes).and_then(|()| stdout.flush());
    written.map_err(|source| Error::File { path: "standard output".into(), wanted: "written", source })
}

/// Asks the nearest existing directory above `directory` whether files can be made there.
fn check_writable(directory: &Path) -> Result<(), Refusal> {
    let refuse = |why: String| {
        Err(Refusal::new("--out", directory.display(), format!("a directory that can be written ({why})")))
    };
    let existing = directory.ancestors().find(|path| path.exists() || path.as_os_str().is_empty());
    let existing = match existing {
        Some(path) if !path.as_os_str().is_empty() => path,
        _ => Path::new("."),
    };
    if !existing.is_dir() {
        return refuse(format!("{} is not a directory", existing.display()));
    }
    let probe = existing.join(format!(".bipenalty-{}", std::process::id()));
    match std::fs::File::create_new(&probe).and_then(|_| std::fs::remove_file(&probe)) {
        Ok(()) => Ok(()),
        Err(error) => refuse(error.to_string()),
    }
}

/// Refuses two runs that would write the same files.
///
/// # Errors
/// Two equal stems, by the options that lead to them.
pub fn refuse_repeated(stems: impl IntoIterator<Item = impl AsRef<str>>) -> Result<(), Refusal> {
    let mut known = std::collections::HashSet::new();
    match stems.into_iter().map(|stem| stem.as_ref().to_owned()).find(|stem| !known.insert(stem.clone())) {
        None => Ok(()),
        Some(stem) => Err(Refusal::new(
            "SCENE, --mass",
            format!("a second run that writes {stem}"),
            "scenes of different names and different mass matrices, or --stdout",
        )),
    }
}
