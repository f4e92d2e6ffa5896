//! The page as SVG: shapes are elements of plotters, drawn on [`Marks`], text is glyphs of the built-in font.
//!
//! plotters counts in whole numbers only, so the page is counted in hundredths of a millimetre, well
//! below what a printer resolves; `width`, `height` and `viewBox` give it its size.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use base64::Engine as _;
use plotters::element::{Circle, PathElement, Polygon, Rectangle};
use plotters::style::{RGBColor, ShapeStyle};

use super::font::{Fonts, Line, Piece};
use super::geometry::{Point, Rect};
use super::marks::Marks;
use super::theme::{BLACK, Colour, HALO, PT, Shape, WHITE};

/// Canvas units in a millimetre.
const UNITS: f64 = 100.0;
/// Width of the line that closes the seam between two polygons, mm.
const SEAM: f64 = 0.06;
/// Family name of the built-in font; the PDF finds it by this.
const FAMILY: &str = "DejaVu Sans";
/// What a viewer without it may take instead.
const FALLBACK: &str = ", Verdana, sans-serif";

/// What the page is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// A picture that looks the same everywhere: text as glyph outlines, which need no font, cells as an image.
    Svg,
    /// The same with text as text.
    Letters,
    /// A drawing for the converter to PDF: text in the built-in font, which it embeds, cells as rectangles.
    Pdf,
}

/// A pen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    pub(super) colour: Colour,
    /// Width, pt.
    pub(super) width: f64,
    /// Lengths drawn and left out in turn, mm; empty for a solid line.
    pub(super) dash: &'static [f64],
}

impl Pen {
    pub(super) fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: &[] }
    }
}

/// Where a line of text stands relative to its anchor: shares of its width and height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchor {
    /// 0: anchor at the left end, 1: at the right end.
    pub(super) x: f64,
    /// 0: anchor at the top of capitals, 1: on the baseline.
    pub(super) y: f64,
}

impl Anchor {
    pub(super) const CENTRE: Self = Self { x: 0.5, y: 0.5 };
    pub(super) const LEFT: Self = Self { x: 0.0, y: 0.5 };
    pub(super) const RIGHT: Self = Self { x: 1.0, y: 0.5 };
    pub(super) const BOTTOM: Self = Self { x: 0.5, y: 1.0 };
}

/// A line of text to be drawn.
pub(super) struct Text<'a> {
    pub(super) line: &'a Line,
    pub(super) at: Point,
    pub(super) anchor: Anchor,
    /// Clockwise, degrees.
    pub(super) turn: f64,
    pub(super) colour: Colour,
    /// Whether white around the letters keeps them apart from what is below.
    pub(super) halo: bool,
}

/// A page being drawn.
pub(super) struct Canvas<'f> {
    fonts: &'f Fonts,
    form: Form,
    marks: Marks,
    /// Glyphs used, to be defined once.
    glyphs: BTreeSet<char>,
}

/// A length on the canvas; pages are far smaller than the range of i32.
fn units(millimetres: f64) -> i32 {
    (millimetres * UNITS).round() as i32
}

fn spot(point: Point) -> (i32, i32) {
    (units(point.0), units(point.1))
}

fn hex(colour: Colour) -> String {
    format!("#{:02x}{:02x}{:02x}", colour.0, colour.1, colour.2)
}

impl<'f> Canvas<'f> {
    /// An empty page of this width and height, mm.
    pub(super) fn new(fonts: &'f Fonts, form: Form, (width, height): (f64, f64)) -> Self {
        let size = (units(width).unsigned_abs(), units(height).unsigned_abs());
        Self { fonts, form, marks: Marks { text: String::new(), size }, glyphs: BTreeSet::new() }
    }

    pub(super) fn fonts(&self) -> &'f Fonts {
        self.fonts
    }

    pub(super) fn form(&self) -> Form {
        self.form
    }

    /// Draws a polyline.
    pub(super) fn stroke(&mut self, line: &[Point], pen: Pen) {
        let dashed = !pen.dash.is_empty();
        if dashed {
            let lengths: Vec<String> = pen.dash.iter().map(|d| units(*d).to_string()).collect();
            let _ = writeln!(self.marks.text, "<g stroke-dasharray=\"{}\">", lengths.join(","));
        }
        let style = style(pen.colour, pen.width);
        self.marks.draw(&PathElement::new(line.iter().copied().map(spot).collect::<Vec<_>>(), style));
        if dashed {
            self.marks.text.push_str("</g>\n");
        }
    }

    /// Fills a polygon.
    pub(super) fn fill(&mut self, corners: &[Point], colour: Colour) {
        let style = style(colour, 0.0).filled();
        self.marks.draw(&Polygon::new(corners.iter().copied().map(spot).collect::<Vec<_>>(), style));
    }

    /// Fills a polygon up to its neighbours: with a thin line of its own colour, without which a viewer that smooths edges lets
    /// the paper through between them.
    pub(super) fn patch(&mut self, corners: &[Point], colour: Colour) {
        let (colour, width) = (hex(colour), units(SEAM));
        let points: Vec<String> = corners.iter().map(|p| format!("{},{}", units(p.0), units(p.1))).collect();
        let _ = writeln!(
            self.marks.text,
            "<polygon fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"{width}\" points=\"{}\"/>",
            points.join(" ")
        );
    }

    /// Draws a marker of radius `radius` mm.
    pub(super) fn marker(&mut self, centre: Point, radius: f64, (shape, filled): (Shape, bool), pen: Pen) {
        let (line, inside) =
            (style(pen.colour, pen.width), style(if filled { pen.colour } else { WHITE }, 0.0));
        match shape {
            Shape::Circle => {
                let radius = units(radius).unsigned_abs();
                self.marks.draw(&Circle::new(spot(centre), radius, inside.filled()));
                self.marks.draw(&Circle::new(spot(centre), radius, line));
            }
            Shape::Polygon { corners, turn } => {
                // A polygon looks as large as the circle of the same area, a little inside its own.
                let reach = radius * if corners == 3 { 1.35 } else { 1.2 };
                let mut ring: Vec<Point> = (0..corners)
                    .map(|i| {
                        let turns = turn / 360.0 + f64::from(i) / f64::from(corners);
                        let (sin, cos) = (std::f64::consts::TAU * turns).sin_cos();
                        (centre.0 + reach * cos, centre.1 - reach * sin)
                    })
                    .collect();
                self.fill(&ring, if filled { pen.colour } else { WHITE });
                ring.extend_from_within(..2);
                self.stroke(&ring, pen);
            }
        }
    }

    /// Fills an upright rectangle.
    pub(super) fn rect(&mut self, place: Rect, colour: Colour) {
        let corners = [spot((place.left, place.top)), spot((place.right, place.bottom))];
        self.marks.draw(&Rectangle::new(corners, style(colour, 0.0).filled()));
    }

    /// Places a PNG image.
    pub(super) fn image(&mut self, png: &[u8], place: Rect) {
        let data = base64::engine::general_purpose::STANDARD.encode(png);
        let (x, y) = spot((place.left, place.top));
        let (width, height) = (units(place.width()), units(place.height()));
        let _ = writeln!(
            self.marks.text,
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             preserveAspectRatio=\"none\" image-rendering=\"optimizeSpeed\" \
             xlink:href=\"data:image/png;base64,{data}\"/>"
        );
    }

    /// Writes a line of text.
    pub(super) fn text(&mut self, text: &Text) {
        let line = text.line;
        let (x, y) = spot(text.at);
        let _ = write!(self.marks.text, "<g transform=\"translate({x} {y})");
        if text.turn != 0.0 {
            let _ = write!(self.marks.text, " rotate({:.2})", text.turn);
        }
        let words: String = line.pieces.iter().map(|piece| piece.text.as_str()).collect();
        let _ = writeln!(self.marks.text, "\" aria-label=\"{}\">", escape(&words));
        let start = (-text.anchor.x * line.width, (1.0 - text.anchor.y) * line.ascent);
        if text.halo {
            for piece in &line.pieces {
                self.outlines(piece, start, WHITE, true);
            }
        }
        for piece in &line.pieces {
            match self.form {
                Form::Svg => self.outlines(piece, start, text.colour, false),
                Form::Letters | Form::Pdf => self.live(piece, start, text.colour),
            }
        }
        self.marks.text.push_str("</g>\n");
    }

    fn outlines(&mut self, piece: &Piece, start: Point, colour: Colour, halo: bool) {
        let scale = piece.size * UNITS / self.fonts.units_per_em();
        let (x, y) = spot((start.0 + piece.x, start.1 + piece.y));
        let _ = write!(
            self.marks.text,
            "<g transform=\"matrix({scale:.5} 0 {:.5} {scale:.5} {x} {y})\" fill=\"{}\"",
            -piece.slant * scale,
            hex(colour)
        );
        if halo {
            let width = 2.0 * HALO * UNITS / scale;
            let _ = write!(self.marks.text, " stroke=\"#ffffff\" stroke-width=\"{width:.0}\"");
        }
        self.marks.text.push('>');
        let mut pen = 0.0;
        for character in piece.text.chars() {
            if !character.is_whitespace() {
                self.glyphs.insert(character);
                let id = glyph_id(character);
                let _ = write!(self.marks.text, "<use x=\"{pen}\" xlink:href=\"#{id}\"/>");
            }
            pen += self.fonts.advance(character);
        }
        self.marks.text.push_str("</g>\n");
    }

    fn live(&mut self, piece: &Piece, start: Point, colour: Colour) {
        let (x, y) = spot((start.0 + piece.x, start.1 + piece.y));
        let others = if self.form == Form::Letters { FALLBACK } else { "" };
        let _ = writeln!(
            self.marks.text,
            "<text transform=\"matrix(1 0 {:.4} 1 {x} {y})\" font-family=\"{FAMILY}{others}\" \
             font-size=\"{:.2}\" font-kerning=\"none\" fill=\"{}\" xml:space=\"preserve\">{}</text>",
            -piece.slant,
            piece.size * UNITS,
            hex(colour),
            escape(&piece.text)
        );
    }

    /// The finished SVG.
    pub(super) fn finish(self) -> String {
        let (w, h) = self.marks.size;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {w} {h}\">\n<defs>\n",
            f64::from(w) / UNITS,
            f64::from(h) / UNITS,
        );
        for &character in &self.glyphs {
            if let Some(path) = self.fonts.outline(character) {
                let id = glyph_id(character);
                let _ = writeln!(svg, "<path id=\"{id}\" d=\"{path}\"/>");
            }
        }
        let _ = write!(
            svg,
            "</defs>\n<rect width=\"{w}\" height=\"{h}\" fill=\"{}\"/>\n\
             <g fill=\"{}\" stroke-linejoin=\"round\">\n{}</g>\n</svg>\n",
            hex(WHITE),
            hex(BLACK),
            self.marks.text
        );
        svg
    }
}

fn style(colour: Colour, width: f64) -> ShapeStyle {
    ShapeStyle {
        color: RGBColor(colour.0, colour.1, colour.2).into(),
        filled: false,
        stroke_width: units(width * PT).unsigned_abs(),
    }
}

fn glyph_id(character: char) -> String {
    format!("u{:x}", u32::from(character))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
