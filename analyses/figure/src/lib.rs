//! Charts for papers: a figure is described as data and rendered as SVG, PNG or PDF.
//!
//! A [`Figure`] has the width of a journal column or page and one or more [`Panel`]s; a panel has two
//! [`Axis`] and [`Layer`]s drawn one over the other. Nothing is read or written here: the results
//! are strings and bytes, and equal figures give equal bytes.
//!
//! ```
//! use figure::{Axis, Figure, Layer, Panel, Width};
//! let curve = (0..=100).map(|i| f64::from(i) / 10.0).map(|b| (b, 1.0 / (1.0 + b).sqrt())).collect();
//! let panel = Panel::new(
//!     Axis::linear("penalty *β*_{s}"),
//!     Axis::linear("critical Courant number *C*_{r}"),
//!     vec![Layer::curve(curve, "*r* = ∞", 0)],
//! );
//! let svg = Figure::new(Width::Single, vec![panel]).svg()?;
//! assert!(svg.contains("width=\"90mm\""));
//! # Ok::<(), figure::PlotError>(())
//! ```
//!
//! # Rooms
//! ```text
//! model       what a figure shows: panels, axes, layers with their source and name; knows no drawing
//! labels      which ticks of an axis are labelled
//! layout      places on the page: frame, ticks, axes' labels, legend, colour bar
//! names       beside which line a name stands (search, geometry)
//! draw        layers, axes and names as elements, from the bottom up (trace, cells, patches, isolines)
//! marks       the page as a backend of plotters: elements become marks of SVG; canvas adds glyphs and images
//! export      the SVG as it is, as PNG and as PDF;  tex  the same figure for pgfplots
//! theme, font, markup   colours, sizes, letters
//! ```
//!
//! # Why plotters, and for what
//! plotters separates what is drawn (elements: path, polygon, circle, rectangle) from the page it is drawn on (a backend),
//! and that seam is used here, through one backend of our own, `marks`: it writes what a printer needs and nothing
//! else, one mark a line, and from its SVG come the PNG and the PDF, so that the three cannot differ; any element of
//! plotters can be put on the same page. Its charts are not used: they place axes and labels by whole pixels of a screen,
//! know no names beside curves, no printed width and no records behind a curve, which is what a figure for a paper needs.
//! TeX draws by itself from the records, so `tex` hands it the model, not the marks.
//!
//! # Labels
//! Labels are a small markup: `_{..}` sets a subscript, `^{..}` a superscript, `*..*` italics, a
//! backslash takes the next character as it is; [`literal`] escapes text from outside. Curves are
//! named at their right end or beside them; where that is impossible, a legend below takes over.

mod axes;
mod canvas;
mod cells;
mod draw;
mod error;
mod export;
mod font;
mod frame;
mod geometry;
mod isolines;
mod labels;
mod layout;
mod legend;
mod marks;
mod markup;
mod model;
mod names;
mod patches;
mod search;
mod tex;
mod tex_label;
mod theme;
mod ticks;
mod trace;

#[cfg(test)]
mod tests;

/// Refuses a label (markup) that no figure can print: markup that is not closed, a character that the font lacks.
///
/// # Errors
/// [`PlotError::Markup`], [`PlotError::Character`].
pub fn check_label(label: &str) -> Result<(), PlotError> {
    font::Fonts::new()?.check(label)
}

pub use error::PlotError;
pub use isolines::isolines;
pub use markup::literal;
pub use model::{
    At, Axis, ColourBar, ColourMap, DataPoint, Figure, Layer, Lettering, Naming, Panel, ROUND, Scale, Side,
    Source, Width, styled,
};
pub use tex::TexSource;
