//! Where everything goes on the page: margins from the measured text, frames from what is left.

use super::axes::title_rise;
use super::error::PlotError;
use super::font::Fonts;
use super::frame::{Frame, Interval, intervals, settle};
use super::geometry::Rect;
use super::model::{Axis, ColourBar, Figure, Layer, Panel, Scale};
use super::theme::{
    AXIS_SIZE, BAR, GAP, LEAST_SIZE, MAJOR_TICK, MAX_LABEL_SHARE, MIN_FRAME, PADDING, PT, TICK_PITCH_X,
    TICK_PITCH_Y, TICK_SIZE, TITLE_SIZE,
};
use super::ticks::{Ticks, ticks};

/// A panel with its place on the page.
pub(super) struct PlacedPanel<'a> {
    pub(super) panel: &'a Panel,
    pub(super) frame: Frame,
    pub(super) x_ticks: Ticks,
    pub(super) y_ticks: Ticks,
    /// (a), (b), ... where the panels are tagged.
    pub(super) tag: Option<String>,
    /// Size of the title, pt.
    pub(super) title_size: f64,
}

/// The colour bar with its place on the page.
pub(super) struct PlacedBar<'a> {
    pub(super) bar: &'a ColourBar,
    pub(super) rect: Rect,
    pub(super) interval: Interval,
    /// Whether values lie below and above the range.
    pub(super) beyond: [bool; 2],
    pub(super) ticks: Ticks,
}

/// The whole page, all lengths in mm.
pub(super) struct Layout<'a> {
    pub(super) panels: Vec<PlacedPanel<'a>>,
    pub(super) bar: Option<PlacedBar<'a>>,
    /// Height without the legend, which goes below.
    pub(super) height: f64,
}

/// Space around every frame, mm; the same for all panels, so that the frames are equal.
#[derive(Clone, Copy, Default)]
struct Margins {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// Height over width of a frame: what can be drawn.
const ASPECTS: std::ops::RangeInclusive<f64> = 0.05..=20.0;

/// Height of a line of text of this size (pt) with room for scripts, mm.
pub(super) fn text_height(size: f64) -> f64 {
    /// Line height, em.
    const LINE: f64 = 1.15;
    size * PT * LINE
}

/// Lays the figure out, with `side` mm right of each frame for the names of curves.
pub(super) fn layout<'a>(figure: &'a Figure, fonts: &Fonts, side: f64) -> Result<Layout<'a>, PlotError> {
    if figure.panels.is_empty() {
        return Err(PlotError::NoPanels);
    }
    if !ASPECTS.contains(&figure.aspect) {
        let aspect = figure.aspect;
        return Err(PlotError::Aspect { aspect });
    }
    let columns = figure.columns.clamp(1, figure.panels.len());
    let rows = figure.panels.len().div_ceil(columns);
    let shades = bar_interval(figure)?;
    let axes: Vec<(Interval, Interval)> = figure.panels.iter().map(intervals).collect::<Result<_, _>>()?;
    let bar = figure.colour_bar.as_ref().zip(shades.map(|(interval, _)| interval));
    let beyond = shades.map_or([false; 2], |(_, beyond)| beyond);
    let (size, margins) = fit(figure, fonts, &axes, bar, (columns, rows), side)?;
    check_lengths(figure, fonts, size, margins)?;
    let cell = (margins.left + size.0 + margins.right, margins.top + size.1 + margins.bottom);
    let mut panels = Vec::new();
    for (index, (panel, (x, y))) in figure.panels.iter().zip(&axes).enumerate() {
        let (row, column) = (index / columns, index % columns);
        let left = column as f64 * cell.0 + margins.left;
        let top = row as f64 * cell.1 + margins.top;
        let rect = Rect::new(left, top, size.0, size.1);
        panels.push(PlacedPanel {
            panel,
            frame: Frame { rect, x: *x, y: *y },
            x_ticks: horizontal_ticks(&panel.x, *x, size.0, fonts)?,
            y_ticks: vertical_ticks(&panel.y, *y, size.1),
            tag: tag(figure, index),
            title_size: match &panel.title {
                Some(title) => title_size(title, across(size, margins), fonts)?,
                None => TITLE_SIZE,
            },
        });
    }
    let height = rows as f64 * cell.1;
    let bar = bar.map(|(bar, interval)| {
        let long = height - margins.top - margins.bottom;
        PlacedBar {
            bar,
            rect: Rect::new(columns as f64 * cell.0, margins.top, BAR, long),
            interval,
            beyond,
            ticks: vertical_ticks(&bar.axis, interval, long),
        }
    });
    Ok(Layout { panels, bar, height })
}

/// Size of every frame and the margins around it.
///
/// Ticks need the frame's size, margins need the tick labels, the frame needs the margins: twice
/// around settles it.
fn fit(
    figure: &Figure,
    fonts: &Fonts,
    axes: &[(Interval, Interval)],
    bar: Option<(&ColourBar, Interval)>,
    (columns, rows): (usize, usize),
    side: f64,
) -> Result<((f64, f64), Margins), PlotError> {
    let width = figure.width.millimetres();
    let share = width / columns as f64;
    let mut size = (share, share * figure.aspect);
    let mut margins = Margins::default();
    for _ in 0..2 {
        margins = common_margins(figure, axes, fonts, size, side)?;
        let bar_width = match bar {
            Some((bar, interval)) => {
                let ticks = vertical_ticks(&bar.axis, interval, rows as f64 * size.1);
                BAR + side_width(&bar.axis, &ticks, fonts)? + PADDING
            }
            None => 0.0,
        };
        let frame = (width - bar_width) / columns as f64 - margins.left - margins.right;
        if side > MAX_LABEL_SHARE * share || frame < MIN_FRAME {
            return Err(PlotError::TooNarrow { columns, width });
        }
        size = (frame, frame * figure.aspect);
    }
    Ok((size, margins))
}

/// The range of the colours, given or from all cells of the figure, and whether values lie below and above it.
fn bar_interval(figure: &Figure) -> Result<Option<(Interval, [bool; 2])>, PlotError> {
    let layers = figure.panels.iter().flat_map(|panel| &panel.layers);
    let values: Vec<f64> = layers
        .filter_map(|layer| match layer {
            Layer::Cells { values, .. } => Some(values),
            _ => None,
        })
        .flatten()
        .copied()
        .collect();
    let beyond = |interval: Interval| {
        let inside = |value: &f64| interval.scale == Scale::Linear || *value > 0.0;
        let of = |holds: &dyn Fn(f64) -> bool| values.iter().filter(|value| inside(value)).any(|v| holds(*v));
        (interval, [of(&|value| value < interval.low), of(&|value| value > interval.high)])
    };
    match &figure.colour_bar {
        None if values.is_empty() => Ok(None),
        None => Err(PlotError::NoColourBar),
        Some(bar) => {
            // What is not positive has no place on a logarithmic bar, and a colour of its own.
            let shown = |value: &&f64| bar.axis.scale == Scale::Linear || **value > 0.0;
            let shown: Vec<f64> = values.iter().filter(shown).copied().collect();
            settle(&bar.axis, &shown, &[]).map(beyond).map(Some)
        }
    }
}

fn common_margins(
    figure: &Figure,
    axes: &[(Interval, Interval)],
    fonts: &Fonts,
    size: (f64, f64),
    side: f64,
) -> Result<Margins, PlotError> {
    let mut margins = Margins {
        left: 0.0,
        right: side,
        top: PADDING,
        bottom: MAJOR_TICK + GAP + text_height(TICK_SIZE) + GAP + text_height(AXIS_SIZE) + PADDING,
    };
    for (panel, (x, y)) in figure.panels.iter().zip(axes) {
        let y_ticks = vertical_ticks(&panel.y, *y, size.1);
        let x_ticks = horizontal_ticks(&panel.x, *x, size.0, fonts)?;
        let left = PADDING + side_width(&panel.y, &y_ticks, fonts)?;
        margins.left = margins.left.max(left);
        // The last tick label may reach beyond the frame by half its width.
        let reach = widest(&x_ticks, fonts)? / 2.0;
        margins.right = margins.right.max(reach);
        let head = match &panel.title {
            Some(title) => {
                let width = fonts.line(title, TITLE_SIZE)?.width;
                let width = if figure.tags { f64::INFINITY } else { width };
                text_height(TITLE_SIZE) + title_rise(width, size.0) - 2.0 * GAP
            }
            None if figure.tags => text_height(TITLE_SIZE) + title_rise(f64::INFINITY, size.0) - 2.0 * GAP,
            None if y_ticks.power.is_some() => text_height(TICK_SIZE),
            None => 0.0,
        };
        // Half a tick label stands above the frame when a tick ends the axis.
        let head = PADDING + (head + GAP).max(text_height(TICK_SIZE) / 2.0);
        margins.top = margins.top.max(head);
    }
    margins.right += PADDING;
    Ok(margins)
}

/// Axis labels and titles are centred on their frame and may reach as far as the margins beside it.
fn check_lengths(
    figure: &Figure,
    fonts: &Fonts,
    size: (f64, f64),
    margins: Margins,
) -> Result<(), PlotError> {
    let across = across(size, margins);
    let along = size.1 + 2.0 * margins.top.min(margins.bottom);
    let bar = figure.colour_bar.iter().map(|bar| (&bar.axis.label, AXIS_SIZE, along));
    let labels = figure.panels.iter().flat_map(|panel| {
        let title = panel.title.iter().map(|title| (title, LEAST_SIZE, across));
        let axes = [(&panel.x.label, AXIS_SIZE, across), (&panel.y.label, AXIS_SIZE, along)];
        title.chain(axes)
    });
    for (label, points, room) in labels.chain(bar) {
        check_length(fonts.line(label, points)?.width, room, label)?;
    }
    Ok(())
}

/// Room for what is centred on a frame, mm.
fn across(size: (f64, f64), margins: Margins) -> f64 {
    size.0 + 2.0 * margins.left.min(margins.right)
}

/// The size at which a title fits into `room`, not below what can be read, pt.
fn title_size(title: &str, room: f64, fonts: &Fonts) -> Result<f64, PlotError> {
    let width = fonts.line(title, TITLE_SIZE)?.width;
    // Scripts shrink less than letters where they are smallest: a hundredth less leaves room for them.
    Ok(if width <= room { TITLE_SIZE } else { (0.99 * TITLE_SIZE * room / width).max(LEAST_SIZE) })
}

/// The tag of a panel that is one of several.
fn tag(figure: &Figure, index: usize) -> Option<String> {
    let letter = char::from(b'a' + u8::try_from(index).ok().filter(|index| *index < 26)?);
    (figure.tags && figure.panels.len() > 1).then(|| format!("({letter})"))
}

/// Refuses a label that would be cut off.
pub(super) fn check_length(length: f64, room: f64, label: &str) -> Result<(), PlotError> {
    if length <= room {
        return Ok(());
    }
    let label = label.to_owned();
    Err(PlotError::LabelTooLong { label, length, room })
}

/// Space a vertical axis takes beside its frame: ticks, their labels and the axis label.
fn side_width(axis: &Axis, ticks: &Ticks, fonts: &Fonts) -> Result<f64, PlotError> {
    let label = if axis.label.is_empty() { 0.0 } else { GAP + text_height(AXIS_SIZE) };
    Ok(MAJOR_TICK + GAP + widest(ticks, fonts)? + label)
}

fn widest(ticks: &Ticks, fonts: &Fonts) -> Result<f64, PlotError> {
    let mut width = 0.0_f64;
    for (_, label) in &ticks.major {
        width = width.max(fonts.line(label, TICK_SIZE)?.width);
    }
    Ok(width)
}

fn vertical_ticks(axis: &Axis, interval: Interval, height: f64) -> Ticks {
    // The number of ticks is small and positive: the cast drops the fraction.
    let most = (height / TICK_PITCH_Y) as usize;
    named(axis, ticks(interval.scale, interval.low, interval.high, most))
}

/// The ticks with the labels that the axis has for single values.
fn named(axis: &Axis, mut ticks: Ticks) -> Ticks {
    for (value, name) in &axis.names {
        ticks.major.retain(|(known, _)| known != value);
        ticks.major.push((*value, name.clone()));
    }
    ticks
}

/// As many ticks as fit without their labels coming close.
fn horizontal_ticks(axis: &Axis, interval: Interval, width: f64, fonts: &Fonts) -> Result<Ticks, PlotError> {
    /// Least space between two labels, mm.
    const SPACE: f64 = 2.0;
    let mut most = (width / TICK_PITCH_X) as usize;
    loop {
        let result = named(axis, ticks(interval.scale, interval.low, interval.high, most));
        let needed = widest(&result, fonts)? + SPACE;
        let places: Vec<f64> =
            result.major.iter().map(|(value, _)| interval.position(*value) * width).collect();
        if most <= 2 || places.windows(2).all(|pair| pair[1] - pair[0] >= needed) {
            return Ok(result);
        }
        most -= 1;
    }
}
