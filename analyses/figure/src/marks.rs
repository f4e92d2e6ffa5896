//! What plotters draws, as marks of SVG: the one backend behind every picture.

use std::borrow::Borrow as _;
use std::convert::Infallible;
use std::fmt::Write as _;

use plotters::backend::DrawingBackend;
use plotters::element::{Drawable, PointCollection};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingErrorKind};

/// Marks in drawing order, on a page counted in whole units.
#[derive(Debug)]
pub(super) struct Marks {
    /// SVG, one mark a line.
    pub(super) text: String,
    /// Width and height of the page.
    pub(super) size: (u32, u32),
}

/// Writing to a String cannot fail.
type Written = Result<(), DrawingErrorKind<Infallible>>;

impl Marks {
    /// Draws an element of plotters, whose coordinates are those of the page.
    pub(super) fn draw<E>(&mut self, element: &E)
    where
        E: Drawable<Self>,
        for<'a> &'a E: PointCollection<'a, BackendCoord>,
    {
        let places = element.point_iter().into_iter().map(|place| *place.borrow());
        // Nothing here can fail, and no text is drawn, whose fonts might.
        let _ = element.draw(places, self, self.size);
    }

    fn mark(&mut self, mark: std::fmt::Arguments, colour: BackendColor) -> Written {
        let _ = match colour.alpha {
            // Opaque is the default: leave it out to keep files small.
            1.0.. => writeln!(self.text, "<{mark}/>"),
            alpha => writeln!(self.text, "<{mark} opacity=\"{alpha}\"/>"),
        };
        Ok(())
    }
}

fn hex(colour: BackendColor) -> String {
    let (red, green, blue) = colour.rgb;
    format!("#{red:02X}{green:02X}{blue:02X}")
}

fn points(path: impl IntoIterator<Item = BackendCoord>) -> String {
    path.into_iter().fold(String::new(), |mut points, (x, y)| {
        let _ = write!(points, "{x},{y} ");
        points
    })
}

/// `fill` and `stroke` of a mark that is either filled or outlined.
fn paint(colour: BackendColor, fill: bool) -> (String, String) {
    let (ink, none) = (hex(colour), "none".to_owned());
    if fill { (ink, none) } else { (none, ink) }
}

impl DrawingBackend for Marks {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Written {
        Ok(())
    }

    fn present(&mut self) -> Written {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, colour: BackendColor) -> Written {
        self.draw_rect(at, (at.0 + 1, at.1 + 1), &colour, true)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Written {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Written {
        let (width, height) = (right - left, bottom - top);
        let (inside, line) = paint(style.color(), fill);
        let stroke = if fill { String::new() } else { format!(" stroke=\"{line}\"") };
        let place = format_args!("x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"");
        self.mark(format_args!("rect {place} fill=\"{}\"{stroke}", inside.to_lowercase()), style.color())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Written {
        let (colour, width) = (hex(style.color()), style.stroke_width());
        let points = points(path);
        let mark = format_args!(
            "polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" points=\"{points}\""
        );
        self.mark(mark, style.color())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Written {
        let (colour, points) = (hex(style.color()), points(path));
        self.mark(format_args!("polygon fill=\"{colour}\" points=\"{points}\""), style.color())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Written {
        let ((inside, line), width) = (paint(style.color(), fill), style.stroke_width());
        let ink = format_args!("fill=\"{inside}\" stroke=\"{line}\" stroke-width=\"{width}\"");
        self.mark(format_args!("circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {ink}"), style.color())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::prelude::{BLUE, Circle, Color, PathElement, Pixel, Rectangle};

    #[test]
    fn any_element_of_plotters_is_one_mark() {
        let mut marks = Marks { text: String::new(), size: (100, 50) };
        marks.draw(&PathElement::new([(0, 0), (10, 20)], BLUE));
        marks.draw(&Circle::new((5, 6), 3, BLUE.mix(0.5).filled()));
        marks.draw(&Rectangle::new([(1, 2), (4, 8)], BLUE));
        marks.draw(&Pixel::new((7, 8), BLUE.filled()));
        let expected = [
            r##"<polyline fill="none" stroke="#0000FF" stroke-width="1" points="0,0 10,20 "/>"##,
            r##"<circle cx="5" cy="6" r="3" fill="#0000FF" stroke="none" stroke-width="1" opacity="0.5"/>"##,
            r##"<rect x="1" y="2" width="3" height="6" fill="none" stroke="#0000FF"/>"##,
            r##"<rect x="7" y="8" width="1" height="1" fill="#0000ff"/>"##,
        ];
        assert_eq!(marks.text.lines().collect::<Vec<_>>(), expected);
    }
}
