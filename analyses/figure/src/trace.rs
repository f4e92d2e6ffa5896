//! What of a layer is visible: its lines, dots and areas on the page, clipped to the frame.

use super::error::PlotError;
use super::frame::Frame;
use super::geometry::{Point, Rect, simplify};
use super::model::{At, DataPoint, Layer, Side};
use super::theme::{CURVE_TOLERANCE, MARKER};

/// The visible part of a layer, in mm.
#[derive(Default)]
pub(super) struct Trace {
    /// Lines, cut at the frame.
    pub(super) lines: Vec<Vec<Point>>,
    /// Centres of markers inside the frame.
    pub(super) dots: Vec<Point>,
    /// Shaded polygons.
    pub(super) areas: Vec<Vec<Point>>,
}

impl Trace {
    /// Whether nothing of the layer is visible.
    pub(super) fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.dots.is_empty() && self.areas.is_empty()
    }

    /// Whether a line or marker reaches into a rectangle.
    pub(super) fn touches(&self, rect: &Rect) -> bool {
        let around_dots = rect.grown(MARKER);
        self.lines
            .iter()
            .flat_map(|line| line.windows(2))
            .any(|pair| rect.clip_segment(pair[0], pair[1]).is_some())
            || self.dots.iter().any(|dot| around_dots.contains(&Rect::around(*dot, 0.0, 0.0)))
    }
}

/// The visible part of a layer.
pub(super) fn trace(layer: &Layer, frame: &Frame) -> Result<Trace, PlotError> {
    let rect = frame.rect;
    match layer {
        Layer::Curve { points, label, .. } => {
            check(points, "curve", label)?;
            Ok(curve(points, frame))
        }
        Layer::Exact { points, label } => {
            check(points, "exact solution", label)?;
            Ok(curve(points, frame))
        }
        Layer::Markers { points, label, joined, .. } => {
            check(points, "series", label)?;
            let dots = inside(frame.lines(points).concat(), rect);
            let lines = if *joined { visible(points, frame) } else { Vec::new() };
            Ok(Trace { lines, dots, ..Trace::default() })
        }
        Layer::Rule { at, label } => {
            let (At::X(place) | At::Y(place)) = *at;
            check(&[(place, 0.0)], "rule", label)?;
            Ok(rule(*at, frame))
        }
        Layer::Shade { points, side, label, .. } => {
            check(points, "shade", label)?;
            let lines = frame.lines(points);
            let areas = lines.iter().map(|line| area(line, *side, rect));
            Ok(Trace { areas: areas.filter(|area| has_height(area)).collect(), ..Trace::default() })
        }
        Layer::Contour { lines, label } => {
            check(&lines.concat(), "contour", label)?;
            Ok(Trace {
                lines: lines.iter().flat_map(|line| visible(line, frame)).collect(),
                ..Trace::default()
            })
        }
        Layer::Cells { .. } | Layer::Patches { .. } => Ok(Trace::default()),
    }
}

/// A layer without a single point to show is a mistake of the caller.
fn check(points: &[DataPoint], layer: &'static str, label: &Option<String>) -> Result<(), PlotError> {
    if points.iter().any(|(x, y)| x.is_finite() && y.is_finite()) {
        return Ok(());
    }
    let label = label.clone().unwrap_or_default();
    Err(PlotError::EmptyLayer { layer, label })
}

/// A line across the frame, if it lies inside.
fn rule(at: At, frame: &Frame) -> Trace {
    let rect = frame.rect;
    let line = match at {
        At::X(x) => [(frame.x_at(x), rect.top), (frame.x_at(x), rect.bottom)],
        At::Y(y) => [(rect.left, frame.y_at(y)), (rect.right, frame.y_at(y))],
    };
    Trace { lines: rect.clip(&line), ..Trace::default() }
}

/// Lines, and a dot for every point that stands alone between gaps.
fn curve(points: &[DataPoint], frame: &Frame) -> Trace {
    let alone = frame.lines(points).into_iter().filter(|run| run.len() == 1);
    Trace {
        dots: inside(alone.flatten().collect(), frame.rect),
        lines: visible(points, frame),
        ..Trace::default()
    }
}

fn inside(points: Vec<Point>, rect: Rect) -> Vec<Point> {
    // A point on the edge may lie outside by rounding.
    let rect = rect.grown(CURVE_TOLERANCE);
    let seen = |point: &Point| rect.contains(&Rect::around(*point, 0.0, 0.0));
    points.into_iter().filter(seen).collect()
}

fn visible(points: &[DataPoint], frame: &Frame) -> Vec<Vec<Point>> {
    let rect = frame.rect.grown(CURVE_TOLERANCE);
    let lines = frame.lines(points);
    let parts = lines.iter().flat_map(|line| rect.clip(line));
    parts.map(|part| simplify(&part, CURVE_TOLERANCE)).collect()
}

/// The polygon between a line and the lower or upper edge of a rectangle, inside of it.
fn area(line: &[Point], side: Side, rect: Rect) -> Vec<Point> {
    let (Some(first), Some(last)) = (line.first(), line.last()) else {
        return Vec::new();
    };
    let edge = match side {
        Side::Below => rect.bottom,
        Side::Above => rect.top,
    };
    let mut ring = line.to_vec();
    ring.extend([(last.0, edge), (first.0, edge)]);
    // Cut at the four edges in turn (Sutherland and Hodgman).
    let ring = cut_at(&ring, |p| p.0 - rect.left);
    let ring = cut_at(&ring, |p| rect.right - p.0);
    let ring = cut_at(&ring, |p| p.1 - rect.top);
    cut_at(&ring, |p| rect.bottom - p.1)
}

/// Whether an area is more than a line along the edge at which it was cut.
fn has_height(area: &[Point]) -> bool {
    let (low, high) = area
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| (low.min(point.1), high.max(point.1)));
    high - low > CURVE_TOLERANCE
}

/// The part of a polygon where `depth`, a linear function, is not negative.
fn cut_at(ring: &[Point], depth: impl Fn(Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::new();
    for (index, &to) in ring.iter().enumerate() {
        let from = ring[(index + ring.len() - 1) % ring.len()];
        let (a, b) = (depth(from), depth(to));
        if (a < 0.0) != (b < 0.0) {
            let t = a / (a - b);
            kept.push((from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1)));
        }
        if b >= 0.0 {
            kept.push(to);
        }
    }
    kept
}
