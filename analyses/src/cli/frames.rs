//! What is known of a figure before its rows are: a style that it cannot have is refused before anything is computed.

use super::style::Style;
use figure::{Axis, ColourBar, ColourMap, Figure, Layer, Panel, Scale, Width};

/// A figure without its rows. What only the rows tell is left open, and is then taken as the style would have it.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The name of its files.
    name: String,
    panels: Option<usize>,
    x: Scale,
    y: Scale,
    /// The ends of the data along x.
    along: Option<(f64, f64)>,
    map: bool,
}

impl Frame {
    /// A figure of as many panels as its rows make, on axes of these scales.
    pub fn new(name: impl Into<String>, x: Scale, y: Scale) -> Self {
        Self { name: name.into(), panels: None, x, y, along: None, map: false }
    }

    /// The same with a known number of panels.
    pub fn of_panels(self, panels: usize) -> Self {
        Self { panels: Some(panels), ..self }
    }

    /// The same with data over all of `values`, which may be none.
    pub fn along(self, values: &[f64]) -> Self {
        let shown = values.iter().filter(|x| x.is_finite() && (self.x == Scale::Linear || **x > 0.0));
        let ends =
            shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
        Self { along: (ends.0 <= ends.1).then_some(ends), ..self }
    }

    /// The same with colours over both axes, which are logarithmic.
    pub fn of_colours(self) -> Self {
        Self { map: true, ..self }
    }

    /// The name of its files.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// A figure that can be drawn in `style` if this one can, as far as is known.
    pub(super) fn rehearsed(&self, style: &Style) -> Figure {
        let [across, up] = style.limits();
        let x = match (across, self.along) {
            // Where limits and data meet, else where the data begin, which those limits hide.
            (Some((low, high)), Some((first, last))) if low <= last && first <= high => low.max(first),
            (_, Some((first, _))) => first,
            (limits, None) => within(limits, self.x),
        };
        let y = within(up, self.y);
        let layer = match self.map {
            // Cells have two centres at least along both axes.
            true => Layer::Cells { x: vec![x, 2.0 * x], y: vec![y, 2.0 * y], values: vec![1.0; 4] },
            false => Layer::markers(vec![(x, y)], "rows", 0),
        };
        let axis = |scale, label| Axis { scale, ..Axis::linear(label) };
        let panel = Panel::new(axis(self.x, "horizontal"), axis(self.y, "vertical"), vec![layer]);
        let panels = self.panels.or(style.titles()).unwrap_or(1);
        let width = if panels == 1 { Width::Single } else { Width::Double };
        let mut figure = Figure::new(width, vec![panel; panels]);
        figure.columns = panels.min(3);
        figure.colour_bar =
            self.map.then(|| ColourBar { axis: Axis::log("colours"), map: ColourMap::Viridis });
        figure
    }
}

/// A value that an axis with these limits shows, if there is one.
fn within(limits: Option<(f64, f64)>, scale: Scale) -> f64 {
    match (limits, scale) {
        (Some((low, high)), Scale::Log) if low > 0.0 => (low * high).sqrt(),
        (Some((low, high)), Scale::Linear) => f64::midpoint(low, high),
        _ => 1.0,
    }
}
