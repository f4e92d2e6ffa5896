//! From the units of the axes to millimetres on the page.

use super::error::PlotError;
use super::geometry::{Point, Rect};
use super::model::{At, Axis, DataPoint, Layer, Panel, Scale};
use super::theme::RANGE_PAD;

/// Data that differ by less than this share of their size are shown as a constant: rounding errors
/// are not a curve.
const CONSTANT: f64 = 1e-9;
/// Narrower ranges than this share of the values leave no digits for tick labels.
const FINEST: f64 = 1e-12;
/// Points farther out than this many frames are moved in, so that all numbers stay finite.
const FAR: f64 = 1e6;

/// An axis with its ends settled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub(super) scale: Scale,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Interval {
    /// Where `value` lies between the ends: 0 at the lower, 1 at the upper one, beyond them outside.
    pub(super) fn position(&self, value: f64) -> f64 {
        let of = |value| coordinate(self.scale, value);
        let position = (of(value) - of(self.low)) / (of(self.high) - of(self.low));
        position.clamp(-FAR, FAR)
    }
}

/// The axes of a frame of this width and height with one length for a unit of both: one of them reaches farther, as far on
/// both sides.
pub(super) fn equalised((x, y): (Interval, Interval), (width, height): (f64, f64)) -> (Interval, Interval) {
    let extent = |of: Interval| coordinate(of.scale, of.high) - coordinate(of.scale, of.low);
    let unit = (width / extent(x)).min(height / extent(y));
    let widened = |of: Interval, length: f64| {
        let beyond = (0.5 * (length / unit - extent(of))).max(0.0);
        let at = |end: f64, by: f64| value_at(of.scale, coordinate(of.scale, end) + by);
        Interval { low: at(of.low, -beyond), high: at(of.high, beyond), ..of }
    };
    (widened(x, width), widened(y, height))
}

/// The coordinate in which an axis is evenly spaced.
pub(super) fn coordinate(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Log => value.log10(),
    }
}

/// The inverse of [`coordinate`].
fn value_at(scale: Scale, coordinate: f64) -> f64 {
    match scale {
        Scale::Linear => coordinate,
        Scale::Log => 10_f64.powf(coordinate),
    }
}

/// The ends of an axis: the given range, else the extent of the data, with some air around the
/// `airy` values and none around the `tight` ones.
pub(super) fn settle(axis: &Axis, tight: &[f64], airy: &[f64]) -> Result<Interval, PlotError> {
    let (scale, label) = (axis.scale, || axis.label.clone());
    let tight = extent(axis, tight)?;
    let airy = extent(axis, airy)?;
    let (low, high) = match axis.range {
        Some(range) => range,
        None => {
            let all = hull(tight, airy);
            let all = all.ok_or_else(|| PlotError::NoRange { label: label() })?;
            padded(scale, all, tight, airy)
        }
    };
    // Comparisons with NaN are false, so a range that is not a number is refused here too.
    if !(low < high && low.is_finite() && high.is_finite()) {
        let label = label();
        return Err(PlotError::Range { label, low, high });
    }
    check_positive(axis, low)?;
    if !Ends::new(scale, low, high).are_apart(FINEST) {
        let label = label();
        return Err(PlotError::Range { label, low, high });
    }
    Ok(Interval { scale, low, high })
}

/// The extent `all` of the data with air around the `airy` part of it.
fn padded(scale: Scale, all: (f64, f64), tight: Option<(f64, f64)>, airy: Option<(f64, f64)>) -> (f64, f64) {
    let ends = Ends::new(scale, all.0, all.1);
    let width = ends.high - ends.low;
    if width <= CONSTANT * ends.low.abs().max(ends.high.abs()) {
        // A single value is shown in the middle of an axis of about its own size.
        let margin = match scale {
            Scale::Linear if ends.low != 0.0 => RANGE_PAD * ends.low.abs(),
            _ => 1.0,
        };
        return (value_at(scale, ends.low - margin), value_at(scale, ends.high + margin));
    }
    let airy = airy.map(|(low, high)| {
        let shifted = |value, by| value_at(scale, coordinate(scale, value) + by * width);
        // Air does not reach beyond zero: a quantity that has one sign is shown with one sign.
        let end = |value: f64, by| match shifted(value, by) {
            beyond if beyond * value <= 0.0 && scale == Scale::Linear => 0.0,
            inside => inside,
        };
        (end(low, -RANGE_PAD), end(high, RANGE_PAD))
    });
    hull(tight, airy).unwrap_or(all)
}

/// Ends of an axis in the coordinate in which it is evenly spaced.
struct Ends {
    low: f64,
    high: f64,
}

impl Ends {
    fn new(scale: Scale, low: f64, high: f64) -> Self {
        Self { low: coordinate(scale, low), high: coordinate(scale, high) }
    }

    /// Whether the ends differ by more than this share of their size, and by a finite number.
    fn are_apart(&self, share: f64) -> bool {
        let width = self.high - self.low;
        width.is_normal() && width > share * self.low.abs().max(self.high.abs())
    }
}

/// Smallest and largest finite value.
fn extent(axis: &Axis, values: &[f64]) -> Result<Option<(f64, f64)>, PlotError> {
    let mut ends = None;
    for &value in values.iter().filter(|value| value.is_finite()) {
        check_positive(axis, value)?;
        ends = hull(ends, Some((value, value)));
    }
    Ok(ends)
}

fn hull(a: Option<(f64, f64)>, b: Option<(f64, f64)>) -> Option<(f64, f64)> {
    match (a, b) {
        (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
        (one, other) => one.or(other),
    }
}

fn check_positive(axis: &Axis, value: f64) -> Result<(), PlotError> {
    if axis.scale == Scale::Log && value <= 0.0 {
        let label = axis.label.clone();
        return Err(PlotError::NotPositive { label, value });
    }
    Ok(())
}

/// Both axes of a panel with their ends settled.
pub(super) fn intervals(panel: &Panel) -> Result<(Interval, Interval), PlotError> {
    // Lines run from edge to edge in x; markers need air on all sides, maps on none.
    let (mut tight_x, mut tight_y, mut airy_x, mut airy_y) = (vec![], vec![], vec![], vec![]);
    for layer in &panel.layers {
        match layer {
            Layer::Curve { points, .. } | Layer::Exact { points, .. } | Layer::Shade { points, .. } => {
                tight_x.extend(points.iter().map(|point| point.0));
                airy_y.extend(points.iter().map(|point| point.1));
            }
            Layer::Markers { points, .. } => {
                airy_x.extend(points.iter().map(|point| point.0));
                airy_y.extend(points.iter().map(|point| point.1));
            }
            Layer::Rule { at: At::X(x), .. } => airy_x.push(*x),
            Layer::Rule { at: At::Y(y), .. } => airy_y.push(*y),
            Layer::Cells { x, y, .. } => {
                tight_x.extend(x);
                tight_y.extend(y);
            }
            Layer::Patches { polygons, .. } => {
                airy_x.extend(polygons.iter().flatten().map(|point| point.0));
                airy_y.extend(polygons.iter().flatten().map(|point| point.1));
            }
            Layer::Contour { lines, .. } => {
                tight_x.extend(lines.iter().flatten().map(|point| point.0));
                tight_y.extend(lines.iter().flatten().map(|point| point.1));
            }
        }
    }
    Ok((settle(&panel.x, &tight_x, &airy_x)?, settle(&panel.y, &tight_y, &airy_y)?))
}

/// The rectangle between the axes of a panel, and the way into it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) rect: Rect,
    pub(super) x: Interval,
    pub(super) y: Interval,
}

impl Frame {
    pub(super) fn x_at(&self, value: f64) -> f64 {
        self.rect.left + self.x.position(value) * self.rect.width()
    }

    pub(super) fn y_at(&self, value: f64) -> f64 {
        self.rect.bottom - self.y.position(value) * self.rect.height()
    }

    /// Runs of finite points on the page, broken where a point is not finite.
    pub(super) fn lines(&self, points: &[DataPoint]) -> Vec<Vec<Point>> {
        points
            .split(|(x, y)| !(x.is_finite() && y.is_finite()))
            .filter(|run| !run.is_empty())
            .map(|run| run.iter().map(|p| (self.x_at(p.0), self.y_at(p.1))).collect())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_axis_refuses_zero_in_data_and_range() {
        let axis = Axis::log("*β*_{s}");
        let data = settle(&axis, &[0.0, 1.0], &[]);
        assert!(matches!(data, Err(PlotError::NotPositive { value, .. }) if value == 0.0));
        let range = settle(&axis.over(0.0, 1.0), &[], &[]);
        assert!(matches!(range, Err(PlotError::NotPositive { .. })));
    }

    #[test]
    fn empty_and_reversed_ranges_are_refused() {
        let none = settle(&Axis::linear("t"), &[], &[f64::NAN]);
        assert!(matches!(none, Err(PlotError::NoRange { .. })));
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (0.0, f64::INFINITY)] {
            let range = settle(&Axis::linear("t").over(low, high), &[], &[]);
            assert!(matches!(range, Err(PlotError::Range { .. })), "{low} {high}");
        }
    }

    #[test]
    fn a_constant_lies_inside_its_axis() {
        for axis in [Axis::linear("C"), Axis::log("C")] {
            let interval = settle(&axis, &[], &[1.0, 1.0]).expect("finite");
            assert!((interval.position(1.0) - 0.5).abs() < 1e-12);
        }
    }
}
