//! Sparse matrices from text: Matrix Market, and Abaqus' matrix input and coordinate format.

use std::path::{Path, PathBuf};

use crate::error::{Error, Refusal, Result};

/// What a file was written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Matrix Market, with its sizes.
    MatrixMarket,
    /// Abaqus: `node, dof, node, dof, value`, or `row column value`; no sizes.
    Abaqus,
}

/// The stored entries of a matrix, with the lines that they came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Entries {
    /// The file.
    pub path: PathBuf,
    /// What it was written as.
    pub form: Form,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// (row, column, value) from 0; for a symmetric file as it is stored, one triangle.
    pub entries: Vec<(u32, u32, f64)>,
    /// The line of each entry, from 1.
    pub lines: Vec<u32>,
    /// Whether the entry (i, j) stands for (j, i) as well.
    pub symmetric: bool,
    /// For `node, dof` files: the unknowns in their order.
    pub labels: Option<Vec<(i64, i64)>>,
}

impl Entries {
    /// A place in the file, for messages.
    pub fn place(&self, line: impl std::fmt::Display) -> String {
        format!("{}, line {line}", self.path.display())
    }

    /// The line of the entry (row, column) or, in a symmetric file, of its mirror.
    pub fn line_of(&self, row: u32, column: u32) -> u32 {
        let same = |&(i, j, _): &(u32, u32, f64)| {
            (i, j) == (row, column) || (self.symmetric && (j, i) == (row, column))
        };
        self.entries.iter().position(same).map_or(1, |at| self.lines[at])
    }

    /// Every entry of the whole matrix: of a symmetric file both triangles.
    pub fn whole(&self) -> Vec<(u32, u32, f64)> {
        let mut whole = self.entries.clone();
        if self.symmetric {
            let mirrored =
                self.entries.iter().filter(|(i, j, _)| i != j).map(|(i, j, value)| (*j, *i, *value));
            whole.extend(mirrored);
        }
        whole
    }
}

/// Reads a matrix.
///
/// # Errors
/// A file that cannot be read, is cut off, or has an index or value that means nothing: with the line.
pub fn read(path: &Path) -> Result<Entries> {
    let text = std::fs::read_to_string(path).map_err(|source| Error::File {
        path: path.to_owned(),
        wanted: "read as UTF-8 text",
        source,
    })?;
    Ok(parse(&text, path)?)
}

/// Reads a matrix from text; `path` is what messages call it.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Entries, Refusal> {
    let banner = "%%matrixmarket";
    let market = text.get(..banner.len()).is_some_and(|start| start.eq_ignore_ascii_case(banner));
    let lines = Lines { path, text };
    if market { lines.matrix_market() } else { lines.abaqus() }
}

/// (node, dof) of a row and of a column.
type Labels = [(i64, i64); 2];

struct Lines<'a> {
    path: &'a Path,
    text: &'a str,
}

impl<'a> Lines<'a> {
    fn refuse(&self, line: usize, value: impl ToString, allowed: impl Into<String>) -> Refusal {
        Refusal::new(format!("{}, line {line}", self.path.display()), value, allowed)
    }

    /// Lines that hold something, with their number.
    fn data(&self, comment: &'static str) -> impl Iterator<Item = (usize, &'a str)> {
        let lines = self.text.lines().enumerate().map(|(at, line)| (at + 1, line.trim()));
        lines.filter(move |(_, line)| !line.is_empty() && !line.starts_with(comment))
    }

    fn count(&self, line: usize, word: Option<&str>, what: &str) -> Result<usize, Refusal> {
        let word = word.unwrap_or("nothing");
        // Indices are 32 bits wide.
        let count = word.parse::<usize>().ok().filter(|count| *count < u32::MAX as usize);
        count.ok_or_else(|| {
            self.refuse(line, format!("{word:?}"), format!("{what}, an integer below {}", u32::MAX))
        })
    }

    fn index(&self, line: usize, word: Option<&str>, what: &str, size: usize) -> Result<u32, Refusal> {
        let index = self.count(line, word, what)?;
        if (1..=size).contains(&index) {
            Ok(index as u32 - 1)
        } else {
            Err(self.refuse(line, format!("{what} {index}"), format!("1 to {size}")))
        }
    }

    fn value(&self, line: usize, word: Option<&str>) -> Result<f64, Refusal> {
        let word = word.unwrap_or("nothing");
        let value = word.parse::<f64>().or_else(|_| word.replace(['d', 'D'], "e").parse());
        match value {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.refuse(line, format!("{word:?}"), "a finite number")),
        }
    }

    fn none_left(&self, line: usize, word: Option<&str>) -> Result<(), Refusal> {
        word.map_or(Ok(()), |word| Err(self.refuse(line, format!("{word:?}"), "the end of the line")))
    }

    fn matrix_market(&self) -> Result<Entries, Refusal> {
        let banner = self.text.lines().next().unwrap_or_default().to_ascii_lowercase();
        let words: Vec<&str> = banner.split_whitespace().skip(1).collect();
        let (coordinate, symmetric) = match words[..] {
            [
                "matrix",
                form @ ("coordinate" | "array"),
                "real" | "integer" | "double",
                shape @ ("general" | "symmetric"),
            ] => (form == "coordinate", shape == "symmetric"),
            _ => {
                let allowed = "%%MatrixMarket matrix coordinate|array real|integer general|symmetric";
                return Err(self.refuse(1, format!("{banner:?}"), allowed));
            }
        };
        let mut data = self.data("%");
        let (line, sizes) =
            data.next().ok_or_else(|| self.refuse(1, "no line of sizes", "rows, columns and entries"))?;
        let mut words = sizes.split_whitespace();
        let (rows, columns) =
            (self.count(line, words.next(), "rows")?, self.count(line, words.next(), "columns")?);
        let count = match (coordinate, symmetric) {
            (true, _) => self.count(line, words.next(), "the number of entries")?,
            (false, true) => rows * (rows + 1) / 2,
            (false, false) => rows * columns,
        };
        self.none_left(line, words.next())?;
        if symmetric && rows != columns {
            return Err(self.refuse(
                line,
                format!("{rows} x {columns}"),
                "a square matrix where it is symmetric",
            ));
        }
        // A false count must not reserve more than the file could hold.
        let room = count.min(self.text.len());
        let (mut entries, mut lines) = (Vec::with_capacity(room), Vec::with_capacity(room));
        let mut last = line;
        let mut place = (0, 0);
        for (line, text) in data {
            if entries.len() == count {
                return Err(self.refuse(
                    line,
                    "one entry more",
                    format!("{count} entries, as the sizes say"),
                ));
            }
            let mut words = text.split_whitespace();
            if coordinate {
                place = (
                    self.index(line, words.next(), "row", rows)?,
                    self.index(line, words.next(), "column", columns)?,
                );
                if symmetric && place.0 < place.1 {
                    let value = format!("entry ({}, {})", place.0 + 1, place.1 + 1);
                    return Err(self.refuse(
                        line,
                        value,
                        "the lower triangle, row >= column, of a symmetric matrix",
                    ));
                }
            }
            entries.push((place.0, place.1, self.value(line, words.next())?));
            lines.push(line as u32);
            self.none_left(line, words.next())?;
            if !coordinate {
                place = if place.0 + 1 < rows as u32 {
                    (place.0 + 1, place.1)
                } else {
                    (if symmetric { place.1 + 1 } else { 0 }, place.1 + 1)
                };
            }
            last = line;
        }
        if entries.len() < count {
            let value = format!("the end of the file after {} entries", entries.len());
            return Err(self.refuse(last, value, format!("{count} entries, as the sizes say")));
        }
        let path = self.path.to_owned();
        Ok(Entries { path, form: Form::MatrixMarket, rows, columns, entries, lines, symmetric, labels: None })
    }

    /// Abaqus writes no sizes: the matrix is square and the largest index, or the number of (node, dof), its size.
    fn abaqus(&self) -> Result<Entries, Refusal> {
        let mut read: Vec<(Labels, f64, u32)> = Vec::new();
        let mut fields = 0;
        for (line, text) in self.data("**") {
            let words: Vec<&str> = text.split([',', ' ', '\t']).filter(|word| !word.is_empty()).collect();
            if fields == 0 {
                fields = words.len();
            }
            if words.len() != fields || !(fields == 3 || fields == 5) {
                let allowed = "node, dof, node, dof, value or row, column, value, the same in every line; or a Matrix Market file, which starts with %%MatrixMarket";
                return Err(self.refuse(line, format!("{text:?}"), allowed));
            }
            let label = |at: usize| {
                let allowed = if fields == 3 { "an integer of at least 1" } else { "an integer" };
                let label = words[at].parse::<i64>().ok().filter(|label| fields == 5 || *label >= 1);
                label.ok_or_else(|| self.refuse(line, format!("{:?}", words[at]), allowed))
            };
            let place = if fields == 3 {
                [(label(0)?, 0), (label(1)?, 0)]
            } else {
                [(label(0)?, label(1)?), (label(2)?, label(3)?)]
            };
            let value = self.value(line, words.last().copied())?;
            // Abaqus' mark of a prescribed degree of freedom: it would be the largest eigenvalue.
            if value.abs() >= 1e36 {
                let allowed =
                    "entries below 1e36, Abaqus' mark of a held degree of freedom: leave such rows out";
                return Err(self.refuse(line, value, allowed));
            }
            read.push((place, value, line as u32));
        }
        if read.is_empty() {
            return Err(self.refuse(1, "no entry", "a matrix with at least one entry"));
        }
        let mut labels: Vec<(i64, i64)> = read.iter().flat_map(|(place, ..)| *place).collect();
        labels.sort_unstable();
        labels.dedup();
        // Rows without entry still count where they have a number.
        let size = if fields == 3 { labels[labels.len() - 1].0 as usize } else { labels.len() };
        if size >= u32::MAX as usize {
            return Err(self.refuse(1, format!("{size} unknowns"), format!("fewer than {}", u32::MAX)));
        }
        let number = |label: &(i64, i64)| {
            if fields == 3 {
                label.0 as u32 - 1
            } else {
                labels.partition_point(|known| known < label) as u32
            }
        };
        let entries: Vec<(u32, u32, f64)> =
            read.iter().map(|([i, j], value, _)| (number(i), number(j), *value)).collect();
        let lines = read.iter().map(|(.., line)| *line).collect();
        let symmetric = !has_mirror(&entries);
        let path = self.path.to_owned();
        let labels = (fields == 5).then_some(labels);
        Ok(Entries { path, form: Form::Abaqus, rows: size, columns: size, entries, lines, symmetric, labels })
    }
}

/// Whether both (i, j) and (j, i) are stored for some i != j; where never, one of each pair stands for both.
fn has_mirror(entries: &[(u32, u32, f64)]) -> bool {
    let mut places: Vec<(u32, u32)> =
        entries.iter().map(|(i, j, _)| (*i, *j)).filter(|(i, j)| i != j).collect();
    places.sort_unstable();
    places.iter().any(|(i, j)| i < j && places.binary_search(&(*j, *i)).is_ok())
}
