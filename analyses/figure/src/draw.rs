//! Drawing a figure: lay out, find places for the names, then draw from the bottom up.

use super::axes::{draw_axes, draw_bar};
use super::canvas::{Anchor, Canvas, Form, Pen, Text};
use super::cells::Cells;
use super::error::PlotError;
use super::font::Fonts;
use super::geometry::{Point, Rect, cut};
use super::layout::{PlacedBar, PlacedPanel, layout};
use super::legend::Legend;
use super::model::{Figure, Layer, Naming};
use super::names::{Name, Names, Series, is_series, label_of, place, right_end};
use super::patches::Patches;
use super::theme::{
    BLACK, CASING_STROKE, CURVE_STROKE, GAP, GREY, LABEL_SIZE, LEADER, MARKER, PT, SHADE, THIN_STROKE, WHITE,
    series_colour, series_dash, series_shape, series_stroke,
};
use super::trace::{Trace, trace};

/// Dots of reference lines, mm drawn and left out.
const RULE_DASH: &[f64] = &[0.3, 0.8];

/// A panel ready to be drawn.
pub(super) struct ArrangedPanel<'a> {
    pub(super) placed: PlacedPanel<'a>,
    traces: Vec<Trace>,
    pub(super) names: Names,
}

impl ArrangedPanel<'_> {
    fn shows_anything(&self) -> bool {
        let mut layers = self.placed.panel.layers.iter().zip(&self.traces);
        layers.any(|(layer, trace)| {
            matches!(layer, Layer::Cells { .. } | Layer::Patches { .. }) || !trace.is_empty()
        })
    }

    fn has_homeless_series(&self) -> bool {
        let layers = &self.placed.panel.layers;
        self.names.homeless.iter().any(|index| is_series(&layers[*index]))
    }
}

/// A figure ready to be drawn.
pub(super) struct Page<'a> {
    pub(super) panels: Vec<ArrangedPanel<'a>>,
    pub(super) bar: Option<PlacedBar<'a>>,
    pub(super) legend: Legend<'a>,
    pub(super) width: f64,
    /// Without the legend, mm.
    pub(super) height: f64,
}

impl Figure {
    /// The figure as SVG in the given form.
    pub(super) fn draw(&self, form: Form) -> Result<String, PlotError> {
        let fonts = Fonts::new()?;
        let page = self.arrange(&fonts)?;
        if !page.panels.iter().any(ArrangedPanel::shows_anything) {
            return Err(PlotError::NothingVisible);
        }
        let height = page.height + page.legend.height();
        let mut canvas = Canvas::new(&fonts, form, (page.width, height));
        for arranged in &page.panels {
            for (index, layer) in arranged.placed.panel.layers.iter().enumerate() {
                draw_layer(&mut canvas, arranged, index, layer, page.bar.as_ref())?;
            }
            draw_axes(&mut canvas, &arranged.placed)?;
            for name in &arranged.names.placed {
                draw_name(&mut canvas, name, &arranged.placed.panel.layers);
            }
        }
        if let Some(bar) = &page.bar {
            draw_bar(&mut canvas, bar)?;
        }
        let below = Rect::new(0.0, page.height, page.width, page.legend.height());
        page.legend.draw(&mut canvas, below);
        Ok(canvas.finish())
    }

    /// Finds a place for everything, in as many columns as leave room for the labels.
    pub(super) fn arrange<'a>(&'a self, fonts: &Fonts) -> Result<Page<'a>, PlotError> {
        let mut columns = self.columns.clamp(1, self.panels.len().max(1));
        loop {
            match self.arrange_in(columns, fonts) {
                Err(PlotError::LabelTooLong { .. } | PlotError::TooNarrow { .. }) if columns > 1 => {
                    columns -= 1
                }
                arranged => return arranged,
            }
        }
    }

    /// The figure in so many columns: names beside the lines if all fit, else a legend.
    fn arrange_in<'a>(&'a self, columns: usize, fonts: &Fonts) -> Result<Page<'a>, PlotError> {
        let auto = self.naming == Naming::Auto;
        for series in [Series::Ends, Series::Beside].into_iter().filter(|_| auto) {
            let side = match series {
                Series::Ends => self.side_width(columns, fonts)?,
                _ => 0.0,
            };
            let layout = match layout(self, columns, fonts, side) {
                Err(PlotError::TooNarrow { .. }) if side > 0.0 => continue,
                other => other?,
            };
            let panels = arrange_panels(layout.panels, fonts, series)?;
            if !panels.iter().any(ArrangedPanel::has_homeless_series) {
                return page(self, panels, layout.bar, layout.height, fonts);
            }
        }
        let layout = layout(self, columns, fonts, 0.0)?;
        let mut panels = arrange_panels(layout.panels, fonts, Series::Listed)?;
        for arranged in &mut panels {
            let layers = arranged.placed.panel.layers.iter().zip(&arranged.traces).enumerate();
            let series = layers.filter(|(_, (layer, trace))| is_series(layer) && !trace.is_empty());
            let mut listed: Vec<usize> = series.map(|(index, _)| index).collect();
            listed.append(&mut arranged.names.homeless);
            arranged.names.homeless = listed;
        }
        page(self, panels, layout.bar, layout.height, fonts)
    }

    /// Space right of the frames for the names of the curves that end there.
    fn side_width(&self, columns: usize, fonts: &Fonts) -> Result<f64, PlotError> {
        let bare = layout(self, columns, fonts, 0.0)?;
        let mut width = 0.0_f64;
        for placed in &bare.panels {
            for layer in &placed.panel.layers {
                let trace = trace(layer, &placed.frame)?;
                if let (Some(label), Some(_)) = (label_of(layer), right_end(layer, &trace, &placed.frame)) {
                    let name = fonts.line(label, LABEL_SIZE)?.width;
                    width = width.max(LEADER + GAP + name);
                }
            }
        }
        Ok(width)
    }
}

fn arrange_panels<'a>(
    panels: Vec<PlacedPanel<'a>>,
    fonts: &Fonts,
    series: Series,
) -> Result<Vec<ArrangedPanel<'a>>, PlotError> {
    let arranged = |placed: PlacedPanel<'a>| {
        let layers = &placed.panel.layers;
        let traces = layers.iter().map(|layer| trace(layer, &placed.frame)).collect::<Result<Vec<_>, _>>()?;
        let names = place(layers, &traces, &placed.frame, fonts, series)?;
        Ok(ArrangedPanel { placed, traces, names })
    };
    panels.into_iter().map(arranged).collect()
}

/// Puts the names without a place into the legend.
fn page<'a>(
    figure: &'a Figure,
    panels: Vec<ArrangedPanel<'a>>,
    bar: Option<PlacedBar<'a>>,
    height: f64,
    fonts: &Fonts,
) -> Result<Page<'a>, PlotError> {
    let listed = panels.iter().flat_map(|arranged| {
        let layers: &'a [Layer] = &arranged.placed.panel.layers;
        arranged.names.homeless.iter().map(move |index| &layers[*index])
    });
    // A contour in a legend would look like any other one: its colour tells its value.
    let listed = listed.filter(|layer| !matches!(layer, Layer::Contour { .. }));
    let width = figure.width.millimetres();
    let legend = Legend::new(listed.chain(&figure.key), fonts, width)?;
    Ok(Page { panels, bar, legend, width, height })
}

fn draw_layer(
    canvas: &mut Canvas,
    arranged: &ArrangedPanel,
    index: usize,
    layer: &Layer,
    bar: Option<&PlacedBar>,
) -> Result<(), PlotError> {
    let trace = &arranged.traces[index];
    match layer {
        Layer::Cells { x, y, values } => {
            let bar = bar.ok_or(PlotError::NoColourBar)?;
            let place = (arranged.placed.panel, &arranged.placed.frame);
            return Cells::new(place, (x, y, values), (bar.bar.map, bar.interval))?.draw(canvas);
        }
        Layer::Patches { polygons, values, outlines } => {
            let bar = bar.ok_or(PlotError::NoColourBar)?;
            let colours = (bar.bar.map, bar.interval);
            return Patches::new(&arranged.placed.frame, (polygons, values, outlines), colours)?.draw(canvas);
        }
        Layer::Contour { .. } => {
            let gap = arranged.names.placed.iter().find(|name| name.layer == index);
            draw_contour(canvas, trace, gap.and_then(|name| name.gap));
            return Ok(());
        }
        _ => (),
    }
    for area in &trace.areas {
        canvas.fill(area, SHADE);
    }
    if let Some(pen) = pen_of(layer) {
        for line in &trace.lines {
            canvas.stroke(line, pen);
        }
    }
    // A value alone between gaps of a curve is a dot of the line, not a marker; a curve of one value has only that.
    let of_line = matches!(layer, Layer::Curve { .. } | Layer::Exact { .. })
        && (trace.dots.len() > 1 || !trace.lines.is_empty());
    for dot in &trace.dots {
        if of_line {
            let pen = Pen::solid(pen_of(layer).map_or(BLACK, |pen| pen.colour), 0.0);
            canvas.marker(*dot, CURVE_STROKE * PT / 2.0, series_shape(0), pen);
        } else {
            draw_dot(canvas, layer, *dot);
        }
    }
    Ok(())
}

/// The pen of a layer's lines.
pub(super) fn pen_of(layer: &Layer) -> Option<Pen> {
    match layer {
        Layer::Curve { style, .. } => Some(Pen {
            colour: series_colour(*style),
            width: series_stroke(*style),
            dash: series_dash(*style),
        }),
        Layer::Markers { style, joined, .. } => {
            joined.then(|| Pen::solid(series_colour(*style), THIN_STROKE))
        }
        Layer::Exact { .. } | Layer::Contour { .. } => Some(Pen::solid(BLACK, THIN_STROKE)),
        Layer::Rule { .. } => Some(Pen { colour: GREY, width: THIN_STROKE, dash: RULE_DASH }),
        Layer::Shade { .. } | Layer::Cells { .. } | Layer::Patches { .. } => None,
    }
}

fn draw_dot(canvas: &mut Canvas, layer: &Layer, at: Point) {
    let style = match layer {
        Layer::Curve { style, .. } | Layer::Markers { style, .. } => *style,
        _ => return canvas.marker(at, MARKER, series_shape(0), Pen::solid(BLACK, THIN_STROKE)),
    };
    let pen = Pen::solid(series_colour(style), THIN_STROKE);
    canvas.marker(at, MARKER, series_shape(style), pen);
}

/// A white casing first, then the line, both with the gap for the name.
fn draw_contour(canvas: &mut Canvas, trace: &Trace, gap: Option<(usize, f64, f64)>) {
    let mut parts = Vec::new();
    for (index, line) in trace.lines.iter().enumerate() {
        match gap {
            Some((at, from, to)) if at == index => parts.extend(cut(line, from, to)),
            _ => parts.push(line.clone()),
        }
    }
    for pen in [Pen::solid(WHITE, CASING_STROKE), Pen::solid(BLACK, THIN_STROKE)] {
        for part in &parts {
            canvas.stroke(part, pen);
        }
    }
}

fn draw_name(canvas: &mut Canvas, name: &Name, layers: &[Layer]) {
    if let (Some(leader), Some(pen)) = (&name.leader, pen_of(&layers[name.layer])) {
        let width = THIN_STROKE.min(pen.width);
        canvas.stroke(leader, Pen::solid(pen.colour, width));
    }
    canvas.text(&Text {
        line: &name.line,
        at: name.centre,
        anchor: Anchor::CENTRE,
        turn: name.turn,
        colour: name.colour,
        // Names keep clear of lines; only a map lies below them.
        halo: layers.iter().any(|layer| matches!(layer, Layer::Cells { .. })),
    });
}

/// Draws a short piece of a layer for the legend.
pub(super) fn sample(canvas: &mut Canvas, layer: &Layer, [from, to]: [Point; 2]) {
    if let Some(pen) = pen_of(layer) {
        canvas.stroke(&[from, to], pen);
    }
    let middle = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
    match layer {
        Layer::Markers { .. } => draw_dot(canvas, layer, middle),
        Layer::Shade { .. } => {
            let Rect { left, top, right, bottom } = Rect::around(middle, to.0 - from.0, 2.0 * MARKER);
            let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
            canvas.fill(&corners, SHADE);
        }
        _ => (),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Panel, Width};

    /// Six curves that start in one point, and names of growing length.
    fn bunch() -> Figure {
        let curve = |k: u32| {
            let x = (0..=50).map(|i| f64::from(i) / 10.0);
            let points = x.map(|x| (x, 1.0 / (1.0 + x / f64::from(5 + k)).sqrt())).collect();
            Layer::curve(points, "*n* = 1".repeat(k as usize / 2), k as usize)
        };
        let layers = (0..6).map(curve).collect();
        let (x, y) = (Axis::linear("*β*_{s}"), Axis::linear("*C*_{r}"));
        Figure::new(Width::Single, vec![Panel::new(x, y, layers)])
    }

    #[test]
    fn names_stay_on_the_page_and_apart() {
        let (figure, fonts) = (bunch(), Fonts::new().expect("built in"));
        let page = figure.arrange(&fonts).expect("valid figure");
        let names = &page.panels[0].names;
        assert_eq!((names.placed.len(), names.homeless.len()), (6, 0));
        let boxes: Vec<Rect> = names
            .placed
            .iter()
            .map(|name| Rect::around(name.centre, name.line.width, name.line.ascent))
            .collect();
        let paper = Rect::new(0.0, 0.0, page.width, page.height);
        for (index, one) in boxes.iter().enumerate() {
            assert!(paper.contains(one), "{one:?}");
            assert!(boxes[..index].iter().all(|other| !other.meets(one)), "{one:?}");
        }
    }

    #[test]
    fn a_legend_takes_over_when_names_do_not_fit() {
        let mut figure = bunch();
        let crowd = figure.panels[0].layers[5].clone();
        figure.panels[0].layers.resize(40, crowd);
        let fonts = Fonts::new().expect("built in");
        let page = figure.arrange(&fonts).expect("valid figure");
        assert!(page.panels[0].names.placed.is_empty());
        assert!(page.legend.height() > 0.0);
    }
}
