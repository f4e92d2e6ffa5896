//! The legend below the panels: samples of lines and markers with their names, in columns.

use super::canvas::{Anchor, Canvas, Text};
use super::draw::sample;
use super::error::PlotError;
use super::font::{Fonts, Line};
use super::geometry::Rect;
use super::layout::{check_length, text_height};
use super::model::Layer;
use super::names::label_of;
use super::theme::{BLACK, GAP, LABEL_SIZE, PADDING, SAMPLE, SAMPLE_GAP};

/// One entry of a legend.
struct Entry<'a> {
    layer: &'a Layer,
    line: Line,
}

/// A legend, measured.
pub(super) struct Legend<'a> {
    entries: Vec<Entry<'a>>,
    /// Widths of the columns, mm.
    columns: Vec<f64>,
}

impl<'a> Legend<'a> {
    /// A legend of these layers for a page `width` mm wide. Layers that look and are called alike
    /// get one entry.
    pub(super) fn new(
        layers: impl IntoIterator<Item = &'a Layer>,
        fonts: &Fonts,
        width: f64,
    ) -> Result<Self, PlotError> {
        let mut entries: Vec<Entry> = Vec::new();
        for layer in layers {
            let known = entries.iter().any(|entry| alike(entry.layer, layer));
            if let (Some(label), false) = (label_of(layer), known) {
                let line = fonts.line(label, LABEL_SIZE)?;
                let room = width - SAMPLE - SAMPLE_GAP - 2.0 * PADDING;
                check_length(line.width, room, label)?;
                entries.push(Entry { layer, line });
            }
        }
        let columns = columns(&entries, width - 2.0 * PADDING);
        Ok(Self { entries, columns })
    }

    /// The layers listed.
    pub(super) fn layers(&self) -> impl Iterator<Item = &'a Layer> {
        self.entries.iter().map(|entry| entry.layer)
    }

    /// Height, mm.
    pub(super) fn height(&self) -> f64 {
        if self.entries.is_empty() {
            return 0.0;
        }
        let rows = self.entries.len().div_ceil(self.columns.len());
        rows as f64 * row_height() + PADDING
    }

    /// Draws the legend centred in `place`, row by row.
    pub(super) fn draw(&self, canvas: &mut Canvas, place: Rect) {
        let all: f64 = self.columns.iter().sum();
        let left = place.centre().0 - (all - 2.0 * PADDING) / 2.0;
        for (index, entry) in self.entries.iter().enumerate() {
            let (row, column) = (index / self.columns.len(), index % self.columns.len());
            let x = left + self.columns[..column].iter().sum::<f64>();
            let y = place.top + (row as f64 + 0.5) * row_height();
            sample(canvas, entry.layer, [(x, y), (x + SAMPLE, y)]);
            canvas.text(&Text {
                line: &entry.line,
                at: (x + SAMPLE + SAMPLE_GAP, y),
                anchor: Anchor::LEFT,
                turn: 0.0,
                colour: BLACK,
                halo: false,
            });
        }
    }
}

/// The widths of as many columns as fit, each as wide as its widest entry, and no more than fill the rows evenly; at least
/// one.
fn columns(entries: &[Entry], width: f64) -> Vec<f64> {
    let widths = |columns: usize| -> Vec<f64> {
        let widest = |column: usize| {
            let of = entries.iter().skip(column).step_by(columns);
            SAMPLE + SAMPLE_GAP + of.map(|entry| entry.line.width).fold(0.0, f64::max) + 2.0 * PADDING
        };
        (0..columns).map(widest).collect()
    };
    let fits = |columns: &usize| widths(*columns).iter().sum::<f64>() <= width + 2.0 * PADDING;
    let most = (1..=entries.len()).rev().find(fits).unwrap_or(1);
    let rows = entries.len().div_ceil(most).max(1);
    // Fewer columns of as many rows are emptier, but those that are even may be too wide.
    let even = Some(entries.len().div_ceil(rows)).filter(fits);
    widths(even.unwrap_or(most).max(1))
}

fn row_height() -> f64 {
    text_height(LABEL_SIZE) + GAP
}

/// Whether two layers have the same name and the same look.
fn alike(a: &Layer, b: &Layer) -> bool {
    let look = |layer: &Layer| match layer {
        Layer::Curve { style, .. } | Layer::Markers { style, .. } => *style,
        _ => 0,
    };
    std::mem::discriminant(a) == std::mem::discriminant(b) && look(a) == look(b) && label_of(a) == label_of(b)
}
