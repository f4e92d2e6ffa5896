//! Widths and outlines of the built-in font, DejaVu Sans. Italics are the same letters slanted, as
//! in its oblique cut; a second font would be in every PDF, and in no fixed order.

use ab_glyph::{Font, FontRef, OutlineCurve, Point};
use std::fmt::Write as _;

use super::error::PlotError;
use super::markup::{Level, Run, parse};
use super::theme::{LEAST_SIZE, PT};

/// Height of a capital letter, em.
const CAP_HEIGHT: f64 = 0.729;
/// Size of sub- and superscripts relative to the text, where that is not too small to print.
const SCRIPT_SIZE: f64 = 0.72;
/// How far a subscript is lowered, em of the text.
const SUB_DROP: f64 = 0.17;
/// How far a superscript is raised, em of the text.
const SUPER_RISE: f64 = 0.36;
/// Slant of italics: the tangent of 11 degrees, as in DejaVu Sans Oblique.
const SLANT: f64 = 0.1944;
/// Air before a script, em of the text.
const SCRIPT_GAP: f64 = 0.03;

/// The font, read once per drawing.
pub(super) struct Fonts(FontRef<'static>);

/// A run of text with its place relative to the start of the line, all in mm (y down).
pub(super) struct Piece {
    pub(super) text: String,
    /// Sideways shift per unit of height.
    pub(super) slant: f64,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) size: f64,
}

/// A label measured at a size: pieces from left to right.
pub(super) struct Line {
    pub(super) pieces: Vec<Piece>,
    /// Advance width, mm.
    pub(super) width: f64,
    /// Above the baseline, mm.
    pub(super) ascent: f64,
    /// Below the baseline, mm.
    pub(super) descent: f64,
}

impl Line {
    /// Height of the box, mm.
    pub(super) fn height(&self) -> f64 {
        self.ascent + self.descent
    }
}

impl Fonts {
    pub(super) fn new() -> Result<Self, PlotError> {
        let font = FontRef::try_from_slice(dejavu::sans::regular());
        font.map(Self).map_err(|_| PlotError::Font)
    }

    /// Font units per em.
    pub(super) fn units_per_em(&self) -> f64 {
        // The font has the entry (2048); the fallback only spares an error path.
        f64::from(self.0.units_per_em().unwrap_or(2048.0))
    }

    /// Advance of a character, font units. Kerning is left out here and switched off in the PDF.
    pub(super) fn advance(&self, character: char) -> f64 {
        f64::from(self.0.h_advance_unscaled(self.0.glyph_id(character)))
    }

    /// Breaks a label into placed pieces at `size` pt.
    pub(super) fn line(&self, label: &str, size: f64) -> Result<Line, PlotError> {
        let em = size * PT;
        let script = SCRIPT_SIZE.max(LEAST_SIZE / size).min(1.0);
        let (mut x, mut pieces) = (0.0, Vec::new());
        let (mut ascent, mut descent) = (CAP_HEIGHT * em, 0.0_f64);
        for run in parse(label)? {
            let (scale, y) = match run.level {
                Level::Base => (1.0, 0.0),
                Level::Sub => (script, SUB_DROP),
                Level::Super => (script, -SUPER_RISE),
            };
            if run.level != Level::Base {
                x += SCRIPT_GAP * em;
            }
            let (y, size) = (y * em, scale * em);
            if let Some(character) = run.text.chars().find(|character| self.0.glyph_id(*character).0 == 0) {
                let label = label.to_owned();
                return Err(PlotError::Character { label, character });
            }
            let units: f64 = run.text.chars().map(|character| self.advance(character)).sum();
            let width = units / self.units_per_em() * size;
            descent = descent.max(self.depth(&run) * size + y);
            ascent = ascent.max(CAP_HEIGHT * size - y);
            pieces.push(Piece { text: run.text, slant: if run.italic { SLANT } else { 0.0 }, x, y, size });
            x += width;
        }
        Ok(Line { pieces, width: x, ascent, descent })
    }

    /// Refuses a label that cannot be printed, whatever its length.
    pub(super) fn check(&self, label: &str) -> Result<(), PlotError> {
        self.line(label, LEAST_SIZE).map(drop)
    }

    /// How far a run reaches below its baseline, em; negative if it stays above.
    fn depth(&self, run: &Run) -> f64 {
        let outlines = run.text.chars().filter_map(|c| self.0.outline(self.0.glyph_id(c)));
        let lowest =
            outlines.map(|outline| f64::from(outline.bounds.min.y).min(f64::from(outline.bounds.max.y)));
        -lowest.fold(0.0, f64::min) / self.units_per_em()
    }

    /// Outline of a character as SVG path data in font units (y down); `None` for blanks.
    pub(super) fn outline(&self, character: char) -> Option<String> {
        let outline = self.0.outline(self.0.glyph_id(character))?;
        let mut path = String::new();
        let mut pen: Option<Point> = None;
        for curve in &outline.curves {
            let (start, rest) = match curve {
                OutlineCurve::Line(a, b) => (a, ("L", vec![b])),
                OutlineCurve::Quad(a, b, c) => (a, ("Q", vec![b, c])),
                OutlineCurve::Cubic(a, b, c, d) => (a, ("C", vec![b, c, d])),
            };
            if pen != Some(*start) {
                write_points(&mut path, "M", &[start]);
            }
            write_points(&mut path, rest.0, &rest.1);
            pen = rest.1.last().map(|point| **point);
        }
        Some(path)
    }
}

/// Appends one path command; font units are whole numbers or halves of them.
fn write_points(path: &mut String, command: &str, points: &[&Point]) {
    path.push_str(command);
    for (index, point) in points.iter().enumerate() {
        let separator = if index == 0 { "" } else { " " };
        // Writing to a String cannot fail.
        let _ = write!(path, "{separator}{} {}", point.x, 0.0 - point.y);
    }
}
