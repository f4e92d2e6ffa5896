//! Coloured polygons, such as the elements of a mesh, cut at the frame.

use super::canvas::{Canvas, Form, Pen};
use super::cells::colour_of;
use super::error::PlotError;
use super::export::raster;
use super::font::Fonts;
use super::frame::{Frame, Interval};
use super::geometry::{Point, Rect};
use super::model::{ColourMap, DataPoint};
use super::theme::{BLACK, Colour, FRAME_STROKE};

/// More polygons than this go into an SVG as an image at the resolution of the PNG: they would be smaller than what print
/// shows, and take megabytes.
const MOST: usize = 20_000;

/// Polygons of a panel with their colours and the lines over them, mm.
pub(super) struct Patches {
    frame: Rect,
    polygons: Vec<(Vec<Point>, Colour)>,
    outlines: Vec<Vec<Point>>,
}

impl Patches {
    pub(super) fn new(
        frame: &Frame,
        (polygons, values, outlines): (&[Vec<DataPoint>], &[f64], &[Vec<DataPoint>]),
        (map, range): (ColourMap, Interval),
    ) -> Result<Self, PlotError> {
        if polygons.len() != values.len() {
            return Err(PlotError::PatchCount { polygons: polygons.len(), values: values.len() });
        }
        let placed = |points: &Vec<DataPoint>| -> Vec<Point> {
            points.iter().map(|point| (frame.x_at(point.0), frame.y_at(point.1))).collect()
        };
        let shown = polygons.iter().zip(values).filter_map(|(polygon, value)| {
            let inside = cut(placed(polygon), frame.rect);
            (inside.len() > 2).then(|| (inside, colour_of(*value, map, range)))
        });
        let lines = outlines.iter().flat_map(|line| frame.rect.clip(&placed(line)));
        Ok(Self { frame: frame.rect, polygons: shown.collect(), outlines: lines.collect() })
    }

    pub(super) fn draw(&self, canvas: &mut Canvas) -> Result<(), PlotError> {
        if self.polygons.len() > MOST && canvas.form() != Form::Pdf {
            canvas.image(&self.image(canvas.fonts())?, self.frame);
        } else {
            self.draw_at(canvas, (0.0, 0.0));
        }
        Ok(())
    }

    /// What the frame shows as PNG.
    pub(super) fn image(&self, fonts: &Fonts) -> Result<Vec<u8>, PlotError> {
        let mut canvas = Canvas::new(fonts, Form::Pdf, (self.frame.width(), self.frame.height()));
        self.draw_at(&mut canvas, (self.frame.left, self.frame.top));
        raster(&canvas.finish())
    }

    /// Draws with this point of the page at the corner of the canvas.
    fn draw_at(&self, canvas: &mut Canvas, origin: Point) {
        let moved = |points: &[Point]| -> Vec<Point> {
            points.iter().map(|point| (point.0 - origin.0, point.1 - origin.1)).collect()
        };
        self.polygons.iter().for_each(|(corners, colour)| canvas.patch(&moved(corners), *colour));
        self.outlines.iter().for_each(|line| canvas.stroke(&moved(line), Pen::solid(BLACK, FRAME_STROKE)));
    }
}

/// The part of a polygon inside a rectangle (Sutherland and Hodgman).
fn cut(mut polygon: Vec<Point>, rect: Rect) -> Vec<Point> {
    // Distance inwards from each side.
    let sides: [fn(&Rect, Point) -> f64; 4] =
        [|r, p| p.0 - r.left, |r, p| r.right - p.0, |r, p| p.1 - r.top, |r, p| r.bottom - p.1];
    for side in sides {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, &to) in polygon.iter().enumerate() {
            let from = polygon[(i + polygon.len() - 1) % polygon.len()];
            let (a, b) = (side(&rect, from), side(&rect, to));
            if (a < 0.0) != (b < 0.0) {
                let t = a / (a - b);
                kept.push((from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1)));
            }
            if b >= 0.0 {
                kept.push(to);
            }
        }
        polygon = kept;
    }
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rect = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };

    fn area(polygon: &[Point]) -> f64 {
        let next = polygon.iter().cycle().skip(1);
        0.5 * polygon.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>()
    }

    #[test]
    fn a_polygon_is_cut_at_the_frame() {
        let inside = vec![(1.0, 1.0), (4.0, 1.0), (4.0, 3.0)];
        assert_eq!(cut(inside.clone(), FRAME), inside);
        // A triangle over the whole frame, and one that loses a corner of a quarter of its area.
        assert_eq!(area(&cut(vec![(-50.0, -5.0), (60.0, -5.0), (5.0, 90.0)], FRAME)), 100.0);
        assert_eq!(area(&cut(vec![(8.0, 2.0), (12.0, 4.0), (8.0, 6.0)], FRAME)), 6.0);
        assert!(cut(vec![(11.0, 1.0), (12.0, 1.0), (12.0, 2.0)], FRAME).is_empty());
    }
}
