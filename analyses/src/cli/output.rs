//! Files and standard output. Nothing is created before the run has something to write.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use serde::Serialize;

use super::frames::Frame;
use super::style::Style;
use super::{Format, OutputOptions, Redrawn, Samples, StandardOutput};
use crate::error::{Error, Refusal, Result};
use crate::record::{self, FigureRecord, Origin, Provenance, Table};
use figure::{Figure, Width};

/// Where a run writes, checked before it computes.
#[derive(Debug, Clone)]
pub struct Output {
    directory: PathBuf,
    formats: Vec<Format>,
    stdout: Option<StandardOutput>,
    provenance: Provenance,
    width: Option<Width>,
    style: Style,
    begun: Instant,
    /// The records of the run by their stem: its figures speak of them.
    tables: Arc<Mutex<BTreeMap<String, Table>>>,
    /// The first figure that could not be drawn.
    undrawn: Arc<Mutex<Option<Error>>>,
    /// The files that are drawn again, never to be overwritten.
    sources: Vec<PathBuf>,
    /// Where the rows that are drawn again come from, and what was found of them; `None` where they are computed.
    computed: Option<(Vec<Origin>, Samples)>,
    /// What of the rows that are drawn again does not hold.
    doubt: Arc<Mutex<Option<String>>>,
}

/// Starts as many threads as were asked for. First of all: whatever computes in parallel, reading a mesh too, starts its own.
///
/// # Errors
/// Refuses what the system does not grant.
pub fn start_threads(options: &OutputOptions) -> Result<()> {
    let Some(threads) = options.threads else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
    Ok(pool.map_err(|e| Refusal::new("--threads", threads, format!("what the system grants ({e})")))?)
}

impl Output {
    /// Prepares the output of `tool`, in `folder` below its own unless told where, and checks that the directory can be written.
    ///
    /// # Errors
    /// Refuses a directory that is a file or cannot be written to.
    pub fn prepare(options: &OutputOptions, tool: &str, folder: &str) -> Result<Self> {
        let style = Style::new(&options.style)?;
        let directory = options.out.clone().unwrap_or_else(|| Path::new("figures").join(tool).join(folder));
        if options.stdout.is_none() && !options.explain {
            check_writable(&directory)?;
        }
        Ok(Self {
            directory,
            formats: options.format.clone(),
            stdout: options.stdout,
            provenance: Provenance::new(tool, std::env::args().skip(1)),
            width: options.width.map(Width::from),
            style,
            begun: Instant::now(),
            tables: Arc::default(),
            undrawn: Arc::default(),
            sources: Vec::new(),
            computed: None,
            doubt: Arc::default(),
        })
    }

    /// The same output for the figures of the records in these files, which are left as they are.
    pub fn redrawing(self, files: Vec<Redrawn>) -> Self {
        let sources = files.iter().filter_map(|redrawn| redrawn.file.canonicalize().ok()).collect();
        let (origins, samples): (Vec<Origin>, Vec<Samples>) =
            files.into_iter().map(|redrawn| (redrawn.origin, redrawn.samples)).unzip();
        let samples = samples.into_iter().fold(Samples::default(), Samples::joined);
        self.doubt.lock().unwrap_or_else(PoisonError::into_inner).clone_from(&samples.differs);
        Self { sources, computed: Some((origins, samples)), ..self }
    }

    /// Tells on standard error of rows that were drawn again and are not what they say; whether there are none.
    pub fn check_redrawn(&self) -> bool {
        let doubt = self.doubt.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(differs) = &doubt {
            crate::tell!("does not hold: {differs}");
        }
        doubt.is_none()
    }

    /// The contour lines that the user asked for.
    pub fn levels(&self) -> Option<&[f64]> {
        self.style.levels()
    }

    /// Tells on standard error how many files a run has written, if any.
    pub fn report(&self, files: usize) {
        match files {
            0 => (),
            1 => crate::tell!("1 file in {}", self.directory.display()),
            _ => crate::tell!("{files} files in {}", self.directory.display()),
        }
    }

    /// Whether figures are wanted at all.
    pub fn wants_figures(&self) -> bool {
        self.file_formats().any(|format| format.is_figure() || format == Format::Record)
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
        // The TeX source of a figure reads the records.
        if self.writes(Format::Csv) || self.writes(Format::Tex) {
            written.extend(self.write(stem, Format::Csv.ending(), &record::csv(rows)?)?);
        }
        if self.writes(Format::Json) {
            written.extend(self.write(
                stem,
                Format::Json.ending(),
                &record::json(&self.provenance, rows)?,
            )?);
        }
        if self.wants_figures() && self.writes(Format::Record) {
            let table = Table::of(format!("{stem}.csv"), &record::csv(rows)?)?;
            self.tables.lock().unwrap_or_else(PoisonError::into_inner).insert(stem.to_owned(), table);
        }
        Ok(written)
    }

    /// Writes `text`, a table of the records, as `stem.md` beside their CSV.
    ///
    /// # Errors
    /// What the system says of the file.
    pub fn write_markdown(&self, stem: &str, text: &str) -> Result<Vec<PathBuf>> {
        if !self.writes(Format::Csv) {
            return Ok(Vec::new());
        }
        Ok(self.write(stem, "md", text.as_bytes())?.into_iter().collect())
    }

    /// Writes what `content` writes as `stem.vtu`, as asked for.
    ///
    /// # Errors
    /// What `content` refuses, and what the system says of the file.
    pub fn write_vtu(
        &self,
        stem: &str,
        content: impl FnOnce(&mut Vec<u8>) -> Result<(), Refusal>,
    ) -> Result<Vec<PathBuf>> {
        if !self.writes(Format::Vtu) {
            return Ok(Vec::new());
        }
        let mut bytes = Vec::new();
        content(&mut bytes)?;
        Ok(self.write(stem, Format::Vtu.ending(), &bytes)?.into_iter().collect())
    }

    /// The figure in the style and the width asked for.
    fn styled(&self, figure: Figure) -> Result<Figure, Refusal> {
        let figure = self.style.apply(figure)?;
        Ok(match self.width {
            Some(width) => figure.at_width(width),
            None => figure,
        })
    }

    /// Refuses a style in which one of the figures to come could not be drawn, before anything is computed.
    ///
    /// # Errors
    /// The first of them, and why.
    pub fn check_style(&self, frames: &[Frame]) -> Result<()> {
        frames.iter().try_for_each(|frame| self.check_figure(frame.name(), frame.rehearsed(&self.style)))
    }

    /// Refuses a figure that cannot be drawn in the style asked for, for instance before the rows that it shows are written.
    ///
    /// # Errors
    /// What the style and the drawing layer refuse.
    pub fn check_figure(&self, name: &str, figure: Figure) -> Result<()> {
        if !self.file_formats().any(Format::is_figure) {
            return Ok(());
        }
        let drawn = self.styled(figure)?.svg();
        drawn.map(|_| ()).map_err(|source| Error::Figure { name: name.to_owned(), source })
    }

    /// Draws `figure`, which shows the rows of the same stem, in the formats asked for, with its record.
    ///
    /// # Errors
    /// What the system says of the file.
    pub fn write_figure(&self, stem: &str, figure: &Figure) -> Result<Vec<PathBuf>> {
        self.write_figure_from(stem, stem, figure)
    }

    /// Draws `figure`, which shows rows written as `source`.
    ///
    /// # Errors
    /// As [`Self::write_figure`].
    pub fn write_figure_from(&self, source: &str, stem: &str, figure: &Figure) -> Result<Vec<PathBuf>> {
        self.write_figure_of(stem, figure, &[source.to_owned()], None::<[(); 0]>)
    }

    /// Draws `figure`, which shows the rows written as `sources`; `about` are rows that say more of the same runs. A figure
    /// that cannot be drawn ends no run, whose other rows would be lost: [`Self::check_drawn`] tells of it.
    ///
    /// # Errors
    /// As [`Self::write_figure`].
    pub fn write_figure_of<R: Serialize>(
        &self,
        stem: &str,
        figure: &Figure,
        sources: &[String],
        about: Option<impl IntoIterator<Item = R>>,
    ) -> Result<Vec<PathBuf>> {
        // Nothing to show, such as the penetrations of bars that never touch.
        if figure.panels.is_empty() {
            return Ok(Vec::new());
        }
        let figure = self.styled(figure.clone())?;
        let data: Vec<Table> = {
            let tables = self.tables.lock().unwrap_or_else(PoisonError::into_inner);
            sources.iter().filter_map(|stem| tables.get(stem)).cloned().collect()
        };
        let (mut written, mut images) = (Vec::new(), Vec::new());
        for format in self.file_formats().filter(|format| format.is_figure()) {
            let drawn = match format {
                Format::Svg => figure.svg().map(String::into_bytes),
                Format::Png => figure.png(),
                Format::Pdf => figure.pdf(),
                Format::Tex => figure.tex(stem).map(|tex| {
                    images = tex.images;
                    tex.text.into_bytes()
                }),
                Format::Csv | Format::Json | Format::Record | Format::Vtu => continue,
            };
            match drawn {
                Ok(bytes) => written.extend(self.write(stem, format.ending(), &bytes)?),
                Err(source) => {
                    let mut undrawn = self.undrawn.lock().unwrap_or_else(PoisonError::into_inner);
                    undrawn.get_or_insert(Error::Figure { name: stem.to_owned(), source });
                }
            }
        }
        for (name, png) in &images {
            written.extend(self.write(name, Format::Png.ending(), png)?);
        }
        if self.wants_figures() && self.writes(Format::Record) {
            let about =
                about.map(|rows| -> Result<_> { Ok(Table::of("", &record::csv(rows)?)?) }).transpose()?;
            let width = figure.width.millimetres();
            let mut record = FigureRecord::new(stem, width, self.provenance.clone(), &data, about.as_ref());
            if let Some((origins, samples)) = &self.computed {
                record = record.redrawn(origins.clone(), &data, samples.check());
                record.unchecked = samples.unknown.iter().cloned().collect();
            }
            record.files =
                written.iter().filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect();
            record.seconds = self.begun.elapsed().as_secs_f64();
            written.extend(self.write(stem, Format::Record.ending(), &record::figure_json(&record)?)?);
        }
        Ok(written)
    }

    /// Whether every figure was drawn, asked when all rows are written.
    ///
    /// # Errors
    /// The first that the drawing layer has refused.
    pub fn check_drawn(&self) -> Result<()> {
        self.undrawn.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
    }

    /// A file `stem.csv` that is written row by row while a run goes on; `None` where no CSV is asked for.
    ///
    /// # Errors
    /// What the system says of the file.
    pub fn stream(&self, stem: &str) -> Result<Option<RowFile>> {
        if !self.writes(Format::Csv) && !self.writes(Format::Tex) {
            return Ok(None);
        }
        let path = self.directory.join(format!("{stem}.csv"));
        let draft = self.directory.join(format!(".{stem}.csv.part"));
        let opened = std::fs::create_dir_all(&self.directory).and_then(|()| std::fs::File::create(&draft));
        match opened {
            Ok(file) => {
                Ok(Some(RowFile { writer: csv::Writer::from_writer(file), path, draft, failure: None }))
            }
            Err(source) => Err(Error::File { path, wanted: "written", source }),
        }
    }

    /// Writes the frames of a run and the collection `stem.pvd` that plays them; the number of files.
    ///
    /// # Errors
    /// What the system says of the file.
    pub fn write_collection(&self, stem: &str, frames: &[(f64, String)]) -> Result<usize> {
        let mut bytes = Vec::new();
        let path = || self.directory.join(format!("{stem}.pvd"));
        bipenalty::mesh::write_pvd(&mut bytes, frames).map_err(|source| Error::File {
            path: path(),
            wanted: "written",
            source,
        })?;
        Ok(self.write(stem, "pvd", &bytes)?.into_iter().count())
    }

    /// Whether meshes with their fields are to be written.
    pub fn wants_frames(&self) -> bool {
        self.writes(Format::Vtu)
    }

    fn writes(&self, format: Format) -> bool {
        self.file_formats().any(|wanted| wanted == format)
    }

    fn file_formats(&self) -> impl Iterator<Item = Format> {
        self.formats.iter().copied().filter(|_| self.stdout.is_none())
    }

    /// Writes a file whole or not at all: to a neighbour first, then renamed.
    fn write(&self, stem: &str, ending: &str, bytes: &[u8]) -> Result<Option<PathBuf>> {
        let path = self.directory.join(format!("{stem}.{ending}"));
        if path.canonicalize().is_ok_and(|path| self.sources.contains(&path)) {
            return Ok(None);
        }
        let draft = self.directory.join(format!(".{stem}.{ending}.part"));
        let written = std::fs::create_dir_all(&self.directory)
            .and_then(|()| std::fs::write(&draft, bytes))
            .and_then(|()| std::fs::rename(&draft, &path));
        match written {
            Ok(()) => Ok(Some(path)),
            Err(source) => Err(Error::File { path, wanted: "written", source }),
        }
    }
}

/// Rows that go to a file as they come: whole or not at all, as every other file.
#[derive(Debug)]
pub struct RowFile {
    writer: csv::Writer<std::fs::File>,
    path: PathBuf,
    draft: PathBuf,
    failure: Option<String>,
}

impl RowFile {
    /// Writes a row; a failure is told by [`RowFile::finish`].
    pub fn push<R: Serialize>(&mut self, row: R) {
        if self.failure.is_none() {
            self.failure = self.writer.serialize(row).err().map(|error| error.to_string());
        }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// What the system has said of it.
    pub fn finish(mut self) -> Result<()> {
        let failed = |source| Error::File { path: self.path.clone(), wanted: "written", source };
        if let Some(why) = self.failure.take() {
            return Err(failed(std::io::Error::other(why)));
        }
        self.writer.flush().and_then(|()| std::fs::rename(&self.draft, &self.path)).map_err(failed)
    }
}

/// A line on standard output.
///
/// # Errors
/// What the system says; that the reader has gone ends a tool without complaint ([`super::finish`]).
pub fn print_line(line: &str) -> Result<()> {
    print_bytes(format!("{line}\n").as_bytes())
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
