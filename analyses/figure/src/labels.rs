//! Which ticks of an axis are labelled: as many as fit.

use super::error::PlotError;
use super::font::Fonts;
use super::frame::Interval;
use super::layout::text_height;
use super::model::{Axis, Scale};
use super::theme::{TICK_PITCH_X, TICK_PITCH_Y, TICK_SIZE};
use super::ticks::{Ticks, ticks};

pub(super) fn vertical_ticks(axis: &Axis, interval: Interval, height: f64) -> Ticks {
    // The number of ticks is small and positive: the cast drops the fraction.
    let most = (height / TICK_PITCH_Y) as usize;
    let ticks = named(axis, ticks(interval.scale, interval.low, interval.high, most));
    uncrowded(axis, ticks, interval, height / text_height(TICK_SIZE))
}

/// The ticks with the labels that the axis has for single values.
fn named(axis: &Axis, mut ticks: Ticks) -> Ticks {
    for (value, name) in &axis.names {
        ticks.major.retain(|(known, _)| known != value);
        ticks.major.push((*value, name.clone()));
    }
    ticks
}

/// The ticks without labels that would lie on others, on an axis as long as `rooms` labels: names stay, then powers of ten.
fn uncrowded(axis: &Axis, mut ticks: Ticks, interval: Interval, rooms: f64) -> Ticks {
    let rank = |value: f64| {
        let is_power = interval.scale == Scale::Log && (value.log10() - value.log10().round()).abs() < 1e-9;
        (axis.names.iter().all(|(named, _)| *named != value), !is_power)
    };
    let mut labels = std::mem::take(&mut ticks.major);
    labels.sort_by_key(|(value, _)| rank(*value));
    let place = |value: f64| interval.position(value) * rooms;
    for (value, label) in labels {
        if ticks.major.iter().all(|(kept, _)| (place(*kept) - place(value)).abs() >= 1.0) {
            ticks.major.push((value, label));
        }
    }
    ticks.major.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    ticks
}

/// As many ticks as fit without their labels coming close.
pub(super) fn horizontal_ticks(
    axis: &Axis,
    interval: Interval,
    width: f64,
    fonts: &Fonts,
) -> Result<Ticks, PlotError> {
    /// Least space between two labels, mm.
    const SPACE: f64 = 2.0;
    let mut most = (width / TICK_PITCH_X) as usize;
    loop {
        let result = named(axis, ticks(interval.scale, interval.low, interval.high, most));
        let needed = widest(&result, fonts)? + SPACE;
        let places: Vec<f64> =
            result.major.iter().map(|(value, _)| interval.position(*value) * width).collect();
        if places.windows(2).all(|pair| pair[1] - pair[0] >= needed) {
            return Ok(result);
        }
        if most <= 2 {
            return Ok(uncrowded(axis, result, interval, width / needed));
        }
        most -= 1;
    }
}

/// The width of the widest label, mm.
pub(super) fn widest(ticks: &Ticks, fonts: &Fonts) -> Result<f64, PlotError> {
    let mut width = 0.0_f64;
    for (_, label) in &ticks.major {
        width = width.max(fonts.line(label, TICK_SIZE)?.width);
    }
    Ok(width)
}
