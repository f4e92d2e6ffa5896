//! Where everything goes on the page: margins from the measured text, frames from what is left.

use super::axes::{power_note, title_rise};
use super::error::PlotError;
use super::font::Fonts;
use super::frame::{Frame, Interval, equalised, intervals, settle};
use super::geometry::Rect;
use super::labels::{horizontal_ticks, vertical_ticks, widest};
use super::model::{Axis, ColourBar, Figure, Layer, Panel, Scale};
use super::theme::{
    AXIS_SIZE, BAR, GAP, LEAST_SIZE, MAJOR_TICK, MAX_LABEL_SHARE, MIN_FRAME, PADDING, PT, TICK_SIZE,
    TITLE_SIZE,
};
use super::ticks::Ticks;

/// A panel with its place on the page.
pub(super) struct PlacedPanel<'a> {
    pub(super) panel: &'a Panel,
    pub(super) frame: Frame,
    pub(super) x_ticks: Ticks,
    pub(super) y_ticks: Ticks,
    /// (a), (b), ... where the panels are tagged.
    pub(super) tag: Option<String>,
    /// Which axes are labelled here, not at another panel of the column or row.
    pub(super) labelled: Labelled,
    /// Sizes of the title and of the labels of the axes, pt.
    pub(super) sizes: Sizes,
    /// How far the base line of the title lies above the frame, mm.
    pub(super) title_rise: f64,
    /// How far left of the frame the label of the vertical axis reaches, mm; the same for a column.
    pub(super) reach: f64,
}

/// Which axes of a panel carry numbers and labels: those that are not the axis of the panel below, and of the one on the left.
#[derive(Clone, Copy)]
pub(super) struct Labelled {
    pub(super) x: bool,
    pub(super) y: bool,
}

/// Sizes of texts that shrink, not below what can be read, where there is little room, pt.
#[derive(Clone, Copy)]
pub(super) struct Sizes {
    pub(super) title: f64,
    pub(super) x: f64,
    pub(super) y: f64,
}

impl Sizes {
    /// The smaller of each: labels of one kind have one size in a figure.
    fn smaller(self, other: Self) -> Self {
        Self { title: self.title.min(other.title), x: self.x.min(other.x), y: self.y.min(other.y) }
    }
}

/// The colour bar with its place on the page.
pub(super) struct PlacedBar<'a> {
    pub(super) bar: &'a ColourBar,
    pub(super) rect: Rect,
    pub(super) interval: Interval,
    /// Whether values lie below and above the range.
    pub(super) beyond: [bool; 2],
    pub(super) ticks: Ticks,
    /// Size of the label, pt.
    pub(super) label_size: f64,
}

/// The whole page, all lengths in mm.
pub(super) struct Layout<'a> {
    pub(super) panels: Vec<PlacedPanel<'a>>,
    pub(super) bar: Option<PlacedBar<'a>>,
    /// Height without the legend, which goes below.
    pub(super) height: f64,
}

/// Space around the frames, mm; the frames are equal.
#[derive(Clone, Default)]
struct Margins {
    /// Left of each column.
    left: Vec<f64>,
    right: f64,
    top: f64,
    /// Below each row.
    bottom: Vec<f64>,
}

/// Space left of a frame whose axis is labelled elsewhere, and below one, mm.
const BARE_LEFT: f64 = PADDING;
const BARE_BOTTOM: f64 = MAJOR_TICK + GAP;

/// Height of all frames of a column together, mm: with titles, labels and a legend they fit on a page with its caption.
const MOST_HEIGHT: f64 = 140.0;

/// How often the size of a frame is found anew.
const MOST_TURNS: usize = 6;

/// Height over width of a frame: what can be drawn.
const ASPECTS: std::ops::RangeInclusive<f64> = 0.05..=20.0;

/// Height of a line of text of this size (pt) with room for scripts, mm.
pub(super) fn text_height(size: f64) -> f64 {
    /// Line height, em.
    const LINE: f64 = 1.15;
    size * PT * LINE
}

/// What is known of a figure before anything is placed.
struct Plan<'a> {
    figure: &'a Figure,
    fonts: &'a Fonts,
    axes: Vec<(Interval, Interval)>,
    labelled: Vec<Labelled>,
    columns: usize,
    rows: usize,
    /// Room right of each frame for the names of curves, mm.
    side: f64,
}

/// Lays the figure out in so many columns, with `side` mm right of each frame for the names of curves.
pub(super) fn layout<'a>(
    figure: &'a Figure,
    columns: usize,
    fonts: &Fonts,
    side: f64,
) -> Result<Layout<'a>, PlotError> {
    if figure.panels.is_empty() {
        return Err(PlotError::NoPanels);
    }
    if !ASPECTS.contains(&figure.aspect) {
        let aspect = figure.aspect;
        return Err(PlotError::Aspect { aspect });
    }
    let columns = columns.clamp(1, figure.panels.len());
    let rows = figure.panels.len().div_ceil(columns);
    let shades = bar_interval(figure)?;
    let axes: Vec<(Interval, Interval)> = figure.panels.iter().map(intervals).collect::<Result<_, _>>()?;
    let labelled = labelled(figure, &axes, columns);
    let plan = Plan { figure, fonts, axes, labelled, columns, rows, side };
    let bar = figure.colour_bar.as_ref().zip(shades.map(|(interval, _)| interval));
    let (size, margins) = plan.fit(bar)?;
    let panels = (0..figure.panels.len()).map(|index| plan.place(figure, index, size, &margins));
    let mut panels = panels.collect::<Result<Vec<_>, PlotError>>()?;
    let sizes = panels.iter().map(|panel| panel.sizes).reduce(Sizes::smaller);
    panels.iter_mut().zip(sizes.into_iter().cycle()).for_each(|(panel, sizes)| panel.sizes = sizes);
    let height = rows as f64 * (margins.top + size.1) + margins.bottom.iter().sum::<f64>();
    let width = margins.left.iter().sum::<f64>() + columns as f64 * (size.0 + margins.right);
    let bar = bar.map(|(bar, interval)| -> Result<PlacedBar, PlotError> {
        let long = plan.bar_length(size, &margins);
        Ok(PlacedBar {
            bar,
            rect: Rect::new(width, margins.top, BAR, long),
            interval,
            beyond: shades.map_or([false; 2], |(_, beyond)| beyond),
            ticks: vertical_ticks(&bar.axis, interval, long),
            label_size: fitted(&bar.axis.label, AXIS_SIZE, long + 2.0 * (margins.top - GAP), fonts)?,
        })
    });
    Ok(Layout { panels, bar: bar.transpose()?, height })
}

/// Which axes of each panel are labelled; above the gap of an incomplete last row they are.
fn labelled(figure: &Figure, axes: &[(Interval, Interval)], columns: usize) -> Vec<Labelled> {
    let same = |one: &Axis, i: Interval, other: &Axis, j: Interval| {
        (&one.label, &one.names, one.scale) == (&other.label, &other.names, other.scale)
            && (i.low, i.high) == (j.low, j.high)
    };
    let panels = &figure.panels;
    let own = |i: usize| Labelled {
        x: panels
            .get(i + columns)
            .is_none_or(|below| !same(&panels[i].x, axes[i].0, &below.x, axes[i + columns].0)),
        y: i.is_multiple_of(columns) || !same(&panels[i].y, axes[i].1, &panels[i - 1].y, axes[i - 1].1),
    };
    // Where one panel of a row needs room below it, or one of a column on its left, the others have it too.
    let all: Vec<usize> = (0..panels.len()).collect();
    let of = |i: &usize| Labelled {
        x: all.iter().any(|j| j / columns == i / columns && own(*j).x),
        y: all.iter().any(|j| j % columns == i % columns && own(*j).y),
    };
    all.iter().map(of).collect()
}

impl Plan<'_> {
    /// Size of every frame and the margins around them.
    ///
    /// Ticks need the frame's size, margins need the tick labels, the frame needs the margins: twice around settles most
    /// figures, a few times more those whose ranges change with the frame.
    fn fit(&self, bar: Option<(&ColourBar, Interval)>) -> Result<((f64, f64), Margins), PlotError> {
        let (width, columns) = (self.figure.width.millimetres(), self.columns);
        let share = width / columns as f64;
        let mut size = (share, share * self.figure.aspect);
        let mut margins = Margins::default();
        for turn in 0..MOST_TURNS {
            let before = size;
            margins = self.margins(size)?;
            let bar_width = match bar {
                Some((bar, interval)) => {
                    let ticks = vertical_ticks(&bar.axis, interval, self.bar_length(size, &margins));
                    BAR + side_width(&bar.axis, &ticks, self.fonts)? + PADDING
                }
                None => 0.0,
            };
            let left: f64 = margins.left.iter().sum();
            let frame = (width - bar_width - left) / columns as f64 - margins.right;
            if self.side > MAX_LABEL_SHARE * share || frame < MIN_FRAME {
                return Err(PlotError::TooNarrow { columns, width });
            }
            // A frame with room to spare at its own labels is no larger next time, or its size would swing with theirs.
            let frame = if turn > 1 { frame.min(before.0) } else { frame };
            size = (frame, (frame * self.figure.aspect).min(MOST_HEIGHT / self.rows as f64));
            if turn > 0 && (size == before || !self.figure.equal) {
                break;
            }
        }
        Ok((size, margins))
    }

    /// From the top of the first row of frames to the bottom of the last one.
    fn bar_length(&self, size: (f64, f64), margins: &Margins) -> f64 {
        let between =
            (self.rows - 1) as f64 * margins.top + margins.bottom[..self.rows - 1].iter().sum::<f64>();
        self.rows as f64 * size.1 + between
    }

    fn margins(&self, size: (f64, f64)) -> Result<Margins, PlotError> {
        let bottom = MAJOR_TICK + GAP + text_height(TICK_SIZE) + GAP + text_height(AXIS_SIZE) + PADDING;
        let mut margins = Margins {
            left: vec![BARE_LEFT; self.columns],
            right: self.side,
            top: PADDING,
            bottom: vec![BARE_BOTTOM; self.rows],
        };
        for (index, panel) in self.figure.panels.iter().enumerate() {
            let (x_ticks, y_ticks) = self.ticks(index, size)?;
            let (row, column) = (index / self.columns, index % self.columns);
            if self.labelled[index].y {
                let left = PADDING + side_width(&panel.y, &y_ticks, self.fonts)?;
                margins.left[column] = margins.left[column].max(left);
            }
            if self.labelled[index].x {
                margins.bottom[row] = bottom;
            }
            // The last tick label may reach beyond the frame by half its width.
            let reach = if self.labelled[index].x { widest(&x_ticks, self.fonts)? / 2.0 } else { 0.0 };
            margins.right = margins.right.max(reach);
            // So may the first, towards the last one of the panel on the left.
            margins.left[column] = margins.left[column].max(BARE_LEFT + reach);
            let head = match &panel.title {
                Some(_) => text_height(TITLE_SIZE) + self.title_rise(index, TITLE_SIZE, size)? - 2.0 * GAP,
                None if self.figure.tags => {
                    text_height(TITLE_SIZE) + title_rise(f64::INFINITY, size.0, None) - 2.0 * GAP
                }
                None if self.note(index, size)?.is_some() => text_height(TICK_SIZE),
                None => 0.0,
            };
            // Half a tick label stands above the frame when a tick ends the axis.
            let head = PADDING + (head + GAP).max(text_height(TICK_SIZE) / 2.0);
            margins.top = margins.top.max(head);
        }
        margins.right += PADDING;
        Ok(margins)
    }

    /// The axes of a panel with a frame of this size.
    fn axes(&self, index: usize, size: (f64, f64)) -> (Interval, Interval) {
        if self.figure.equal { equalised(self.axes[index], size) } else { self.axes[index] }
    }

    fn ticks(&self, index: usize, size: (f64, f64)) -> Result<(Ticks, Ticks), PlotError> {
        let (panel, (x, y)) = (&self.figure.panels[index], self.axes(index, size));
        Ok((horizontal_ticks(&panel.x, x, size.0, self.fonts)?, vertical_ticks(&panel.y, y, size.1)))
    }

    /// Width of the power of ten above the vertical axis, if there is one.
    fn note(&self, index: usize, size: (f64, f64)) -> Result<Option<f64>, PlotError> {
        let note = power_note(&self.ticks(index, size)?.1).filter(|_| self.labelled[index].y);
        note.map(|note| Ok(self.fonts.line(&note, TICK_SIZE)?.width)).transpose()
    }

    /// How far the title of a panel, at this size, is raised above its frame; beside tags as far as possible.
    fn title_rise(&self, index: usize, title_size: f64, size: (f64, f64)) -> Result<f64, PlotError> {
        let title = self.figure.panels[index].title.as_deref().unwrap_or_default();
        let width = self.fonts.line(title, title_size)?.width;
        let width = if self.figure.tags { f64::INFINITY } else { width };
        Ok(title_rise(width, size.0, self.note(index, size)?))
    }

    fn place<'a>(
        &self,
        figure: &'a Figure,
        index: usize,
        size: (f64, f64),
        margins: &Margins,
    ) -> Result<PlacedPanel<'a>, PlotError> {
        let (panel, (x, y)) = (&figure.panels[index], self.axes(index, size));
        let (row, column) = (index / self.columns, index % self.columns);
        let left = margins.left[..=column].iter().sum::<f64>() + column as f64 * (size.0 + margins.right);
        let top =
            margins.bottom[..row].iter().sum::<f64>() + row as f64 * (margins.top + size.1) + margins.top;
        let (x_ticks, y_ticks) = self.ticks(index, size)?;
        let sizes = self.sizes(index, size, margins)?;
        // Titles stand on one line, for which the place was kept at full size.
        let rises = (0..figure.panels.len()).map(|index| self.title_rise(index, TITLE_SIZE, size));
        let title_rise = rises.collect::<Result<Vec<_>, _>>()?.into_iter().fold(0.0, f64::max);
        Ok(PlacedPanel {
            panel,
            frame: Frame { rect: Rect::new(left, top, size.0, size.1), x, y },
            x_ticks,
            y_ticks,
            tag: tag(figure, index),
            labelled: self.labelled[index],
            sizes,
            title_rise,
            reach: margins.left[column] - PADDING,
        })
    }

    /// Sizes at which the texts of a panel fit; they are centred on their frame and may reach into the margins.
    fn sizes(&self, index: usize, size: (f64, f64), margins: &Margins) -> Result<Sizes, PlotError> {
        let panel = &self.figure.panels[index];
        let (row, column) = (index / self.columns, index % self.columns);
        // The label of the vertical axis may be longer than the frame: nothing reaches above or below it.
        let label = if self.labelled[index].y { PADDING + text_height(AXIS_SIZE) } else { 0.0 };
        let across = size.0 + 2.0 * ((margins.left[column] - label).min(margins.right) - GAP);
        let along = size.1 + 2.0 * (margins.top.min(margins.bottom[row]) - GAP);
        let title = panel.title.as_ref();
        Ok(Sizes {
            title: title.map_or(Ok(TITLE_SIZE), |title| fitted(title, TITLE_SIZE, across, self.fonts))?,
            x: if self.labelled[index].x {
                fitted(&panel.x.label, AXIS_SIZE, across, self.fonts)?
            } else {
                AXIS_SIZE
            },
            y: if self.labelled[index].y {
                fitted(&panel.y.label, AXIS_SIZE, along, self.fonts)?
            } else {
                AXIS_SIZE
            },
        })
    }
}

/// The range of the colours, given or from all cells of the figure, and whether values lie below and above it.
fn bar_interval(figure: &Figure) -> Result<Option<(Interval, [bool; 2])>, PlotError> {
    let layers = figure.panels.iter().flat_map(|panel| &panel.layers);
    let values: Vec<f64> = layers
        .filter_map(|layer| match layer {
            Layer::Cells { values, .. } | Layer::Patches { values, .. } => Some(values),
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

/// The size up to `full` at which a text fits into `room` mm, not below what can be read, pt.
fn fitted(text: &str, full: f64, room: f64, fonts: &Fonts) -> Result<f64, PlotError> {
    let width = fonts.line(text, full)?.width;
    if width <= room {
        return Ok(full);
    }
    // Scripts shrink less than letters where they are smallest: a hundredth less leaves room for them.
    let size = (0.99 * full * room / width).max(LEAST_SIZE);
    check_length(fonts.line(text, size)?.width, room, text)?;
    Ok(size)
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
pub(super) fn side_width(axis: &Axis, ticks: &Ticks, fonts: &Fonts) -> Result<f64, PlotError> {
    let label = if axis.label.is_empty() { 0.0 } else { GAP + text_height(AXIS_SIZE) };
    Ok(MAJOR_TICK + GAP + widest(ticks, fonts)? + label)
}
