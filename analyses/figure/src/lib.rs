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
mod layout;
mod legend;
mod markup;
mod model;
mod names;
mod search;
mod tex;
mod tex_label;
mod theme;
mod ticks;
mod trace;

#[cfg(test)]
mod tests;

pub use error::PlotError;
pub use isolines::isolines;
pub use markup::literal;
pub use model::{
    At, Axis, ColourBar, ColourMap, DataPoint, Figure, Layer, Naming, Panel, Scale, Side, Source, Width,
};
pub use tex::TexSource;
