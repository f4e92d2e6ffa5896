//! Frames, ticks, axis labels, titles and the colour bar.

use super::canvas::{Anchor, Canvas, Pen, Text};
use super::cells::colour;
use super::error::PlotError;
use super::font::Line;
use super::geometry::{Point, Rect};
use super::layout::{PlacedBar, PlacedPanel, text_height};
use super::theme::{
    AXIS_SIZE, BLACK, FRAME_STROKE, GAP, MAJOR_TICK, MINOR_TICK, PADDING, TICK_SIZE, TITLE_SIZE,
};
use super::ticks::{Ticks, power_of_ten};

/// Colours in the colour bar, more than the eye tells apart.
const BAR_COLOURS: u32 = 160;
/// How far the point of a bar beyond whose range there are values reaches, mm.
const END: f64 = 2.2;
/// A quarter turn to the left, as vertical axis labels are read, degrees.
const UPWARDS: f64 = -90.0;

/// Draws the frame of a panel with ticks, labels and title.
pub(super) fn draw_axes(canvas: &mut Canvas, placed: &PlacedPanel) -> Result<(), PlotError> {
    let (panel, frame) = (placed.panel, &placed.frame);
    let rect = frame.rect;
    outline(canvas, rect);
    bottom_axis(canvas, placed)?;
    let label = placed.labelled.y.then_some((&*panel.y.label, placed.sizes.y, Some(placed.reach)));
    vertical_axis(canvas, label, &placed.y_ticks, rect, Edge::Left, |value| frame.y_at(value))?;
    if let Some(title) = &panel.title {
        let line = canvas.fonts().line(title, placed.sizes.title)?;
        canvas.text(&plain(&line, (rect.centre().0, rect.top - placed.title_rise), Anchor::BOTTOM));
    }
    if let Some(tag) = &placed.tag {
        // Beside the frame, where no title stands.
        let line = canvas.fonts().line(tag, TITLE_SIZE)?;
        // Above the label of a tick at the end of the axis; right of the edge of the page.
        let rise = title_rise(f64::INFINITY, rect.width(), None).max(placed.title_rise);
        let left = rect.left - placed.reach - PADDING;
        let right = (rect.left - 2.0 * GAP).max(left + line.width);
        canvas.text(&plain(&line, (right, rect.top - rise), Anchor { x: 1.0, y: 1.0 }));
    }
    Ok(())
}

/// How far above the frame the base line of a title lies; one that is wider than its frame clears the tick labels, one that
/// would stand in the power of ten of the axis, whose width is `note`, lies above it.
pub(super) fn title_rise(title: f64, frame: f64, note: Option<f64>) -> f64 {
    let clearance = match note {
        Some(note) if title > frame - 2.0 * (note + 2.0 * GAP) => text_height(TICK_SIZE),
        _ if title > frame => text_height(TICK_SIZE) / 2.0,
        _ => 0.0,
    };
    2.0 * GAP + clearance
}

/// Draws the colour bar with its ticks and label.
pub(super) fn draw_bar(canvas: &mut Canvas, placed: &PlacedBar) -> Result<(), PlotError> {
    let rect = placed.rect;
    // Each colour reaches to the top and is covered by the next: no seams.
    for step in 0..BAR_COLOURS {
        let share = f64::from(step) / f64::from(BAR_COLOURS);
        let Rect { left, top, right, .. } = rect;
        let bottom = rect.bottom - share * rect.height();
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        let middle = share + 0.5 / f64::from(BAR_COLOURS);
        canvas.fill(&corners, colour(placed.bar.map, middle));
    }
    ends(canvas, placed);
    outline(canvas, rect);
    let at = |value| rect.bottom - placed.interval.position(value) * rect.height();
    let label = Some((&*placed.bar.axis.label, placed.label_size, None));
    vertical_axis(canvas, label, &placed.ticks, rect, Edge::Right, at)
}

/// Points beyond the ends of the bar, in the colours that values beyond its range take.
fn ends(canvas: &mut Canvas, placed: &PlacedBar) {
    let (rect, map) = (placed.rect, placed.bar.map);
    let middle = rect.centre().0;
    let tips = [(rect.bottom, rect.bottom + END, 0.0), (rect.top, rect.top - END, 1.0)];
    for ((base, tip, share), _) in tips.into_iter().zip(placed.beyond).filter(|(_, beyond)| *beyond) {
        let corners = [(rect.left, base), (middle, tip), (rect.right, base)];
        canvas.fill(&corners, colour(map, share));
        canvas.stroke(&corners, frame_pen());
    }
}

fn frame_pen() -> Pen {
    Pen::solid(BLACK, FRAME_STROKE)
}

fn outline(canvas: &mut Canvas, rect: Rect) {
    let Rect { left, top, right, bottom } = rect;
    // One corner more than the rectangle has, so that the first one is mitred too.
    let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top), (right, top)];
    canvas.stroke(&corners, frame_pen());
}

fn bottom_axis(canvas: &mut Canvas, placed: &PlacedPanel) -> Result<(), PlotError> {
    let (axis, frame, ticks) = (&placed.panel.x, &placed.frame, &placed.x_ticks);
    let rect = frame.rect;
    for value in &ticks.minor {
        let x = frame.x_at(*value);
        let tick = [(x, rect.bottom), (x, rect.bottom + MINOR_TICK)];
        canvas.stroke(&tick, frame_pen());
    }
    let below = rect.bottom + MAJOR_TICK + GAP;
    // Superscripts rise above capitals: one common baseline for all labels of the axis.
    let baseline = below + text_height(TICK_SIZE) * SCRIPT_ROOM;
    for (value, label) in &ticks.major {
        let x = frame.x_at(*value);
        canvas.stroke(&[(x, rect.bottom), (x, rect.bottom + MAJOR_TICK)], frame_pen());
        if !placed.labelled.x {
            continue;
        }
        let line = canvas.fonts().line(label, TICK_SIZE)?;
        canvas.text(&plain(&line, (x, baseline), Anchor::BOTTOM));
    }
    if !placed.labelled.x {
        return Ok(());
    }
    let line = canvas.fonts().line(&axis.label, placed.sizes.x)?;
    let below = below + text_height(TICK_SIZE) + GAP;
    let baseline = below + text_height(AXIS_SIZE) * SCRIPT_ROOM;
    canvas.text(&plain(&line, (rect.centre().0, baseline), Anchor::BOTTOM));
    if let Some(note) = power_note(ticks) {
        let line = canvas.fonts().line(&note, TICK_SIZE)?;
        let anchor = Anchor { x: 1.0, y: 1.0 };
        canvas.text(&plain(&line, (rect.right, baseline), anchor));
    }
    Ok(())
}

/// Share of a line's height that lies above its baseline.
const SCRIPT_ROOM: f64 = 0.78;

/// The side of the rectangle that carries a vertical axis.
#[derive(Clone, Copy, PartialEq)]
enum Edge {
    Left,
    Right,
}

/// A vertical axis; its label with its size, pt, and how far from the rectangle it reaches, mm, if that is given. Without a
/// label there are no numbers either.
fn vertical_axis(
    canvas: &mut Canvas,
    label_of_axis: Option<(&str, f64, Option<f64>)>,
    ticks: &Ticks,
    rect: Rect,
    edge: Edge,
    at: impl Fn(f64) -> f64,
) -> Result<(), PlotError> {
    let (x, outwards, anchor) = match edge {
        Edge::Left => (rect.left, -1.0, Anchor::RIGHT),
        Edge::Right => (rect.right, 1.0, Anchor::LEFT),
    };
    for value in &ticks.minor {
        let y = at(*value);
        canvas.stroke(&[(x, y), (x + outwards * MINOR_TICK, y)], frame_pen());
    }
    let beside = MAJOR_TICK + GAP;
    let mut widest = 0.0_f64;
    for (value, label) in &ticks.major {
        let y = at(*value);
        canvas.stroke(&[(x, y), (x + outwards * MAJOR_TICK, y)], frame_pen());
        if label_of_axis.is_none() {
            continue;
        }
        // Digits, not their superscripts, are centred on the tick.
        let line = canvas.fonts().line(label, TICK_SIZE)?;
        let digits = canvas.fonts().line("0", TICK_SIZE)?.ascent;
        let anchor = Anchor { y: 1.0 - digits / 2.0 / line.ascent, ..anchor };
        canvas.text(&plain(&line, (x + outwards * beside, y), anchor));
        widest = widest.max(line.width);
    }
    let Some((label, size, reach)) = label_of_axis else { return Ok(()) };
    if let Some(note) = power_note(ticks) {
        let line = canvas.fonts().line(&note, TICK_SIZE)?;
        let anchor = Anchor { x: 0.0, y: 1.0 };
        // On the right the number of a tick that ends the axis stands in its way.
        let ends = edge == Edge::Right
            && ticks.major.iter().any(|(value, _)| at(*value) - rect.top < text_height(TICK_SIZE) / 2.0);
        let rise = if ends { text_height(TICK_SIZE) / 2.0 } else { GAP };
        canvas.text(&plain(&line, (rect.left, rect.top - rise), anchor));
    }
    let line = canvas.fonts().line(label, size)?;
    // Reading upwards, the baseline is on the right of the text.
    let depth = text_height(AXIS_SIZE);
    let baseline = match edge {
        Edge::Left => match reach {
            Some(reach) => x - reach + depth * SCRIPT_ROOM,
            None => x - beside - widest - GAP - depth * (1.0 - SCRIPT_ROOM),
        },
        Edge::Right => x + beside + widest + GAP + depth * SCRIPT_ROOM,
    };
    canvas.text(&Text { turn: UPWARDS, ..plain(&line, (baseline, rect.centre().1), Anchor::BOTTOM) });
    Ok(())
}

/// Black text without halo.
pub(super) fn plain(line: &Line, at: Point, anchor: Anchor) -> Text<'_> {
    Text { line, at, anchor, turn: 0.0, colour: BLACK, halo: false }
}

/// The power of ten taken out of tick labels, as it is written at the end of an axis.
pub(super) fn power_note(ticks: &Ticks) -> Option<String> {
    ticks.power.map(|power| format!("×{}", power_of_ten(power)))
}
