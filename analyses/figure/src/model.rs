//! What a figure shows. Nothing here knows how it is drawn.

/// Printed width of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// One column of a journal page, 90 mm.
    Single,
    /// The full width of a journal page, 190 mm.
    Double,
}

impl Width {
    /// Width in millimetres.
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Single => 90.0,
            Self::Double => 190.0,
        }
    }
}

/// Where curves and markers are named.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Naming {
    /// Beside the lines if every name finds a free place, else in a legend.
    #[default]
    Auto,
    /// In a legend below the panels.
    Legend,
}

/// How letters are written into an SVG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lettering {
    /// As outlines, which need no font and look the same everywhere.
    #[default]
    Outlines,
    /// As text, to be searched and edited; a viewer without DejaVu Sans takes another font.
    Text,
}

/// One picture: panels in reading order on a grid, perhaps a colour bar.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Printed width.
    pub width: Width,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels per row, at least 1; fewer are drawn where that leaves too little room for labels.
    pub columns: usize,
    /// Height of a panel's frame over its width.
    pub aspect: f64,
    /// How the colours of [`Layer::Cells`] are read; shared by all panels.
    pub colour_bar: Option<ColourBar>,
    /// Where curves and markers are named.
    pub naming: Naming,
    /// Further entries of the legend, by layers without points: what a marker or a shade stands for.
    pub key: Vec<Layer>,
    /// Whether a unit is as long on the vertical axes as on the horizontal ones: what is too short is made longer.
    pub equal: bool,
    /// Whether several panels are tagged (a), (b), ...
    pub tags: bool,
    /// How letters are written into an SVG.
    pub lettering: Lettering,
}

impl Figure {
    /// A figure with all panels in one row, of golden-section shape.
    pub fn new(width: Width, panels: Vec<Panel>) -> Self {
        /// Height over width, about the golden section.
        const ASPECT: f64 = 0.68;
        Self {
            width,
            columns: panels.len().max(1),
            panels,
            aspect: ASPECT,
            colour_bar: None,
            naming: Naming::Auto,
            key: Vec::new(),
            equal: false,
            tags: false,
            lettering: Lettering::default(),
        }
    }

    /// The same figure at another width. In a column of the page up to three panels stand one above the other, more in twos;
    /// one panel as wide as the page is kept low.
    pub fn at_width(mut self, width: Width) -> Self {
        /// Height over width of a panel that takes the whole page.
        const LOW: f64 = 0.4;
        /// Panels of full width that are not too high for a page.
        const STACK: usize = 3;
        self.width = width;
        match width {
            // High pictures stand side by side.
            Width::Single if self.equal && self.aspect > 1.5 => self.columns = self.columns.min(2),
            Width::Single if self.panels.len() <= STACK => self.columns = 1,
            Width::Single => self.columns = self.columns.min(2),
            Width::Double if self.columns == 1 && self.panels.len() > 1 => self.columns = 2,
            Width::Double if self.columns == 1 => self.aspect = self.aspect.min(LOW),
            Width::Double => (),
        }
        self
    }
}

/// One pair of axes and what is drawn between them.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Title above the frame (markup).
    pub title: Option<String>,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Drawn in this order, the first at the bottom.
    pub layers: Vec<Layer>,
}

impl Panel {
    /// A panel without title.
    pub fn new(x: Axis, y: Axis, layers: Vec<Layer>) -> Self {
        Self { title: None, x, y, layers }
    }

    /// The same panel with a title (markup).
    pub fn titled(mut self, title: impl Into<String>) -> Self {
        self.title = Some(title.into());
        self
    }
}

/// Spacing of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences have equal lengths.
    Linear,
    /// Equal quotients have equal lengths; positive values only.
    Log,
}

/// An axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity and unit (markup).
    pub label: String,
    /// Spacing.
    pub scale: Scale,
    /// Both ends, or `None` to take them from the data.
    pub range: Option<(f64, f64)>,
    /// Labels (markup) for single values in place of the numbers, such as a 0 for what a logarithmic axis cannot show.
    pub names: Vec<(f64, String)>,
}

impl Axis {
    /// A linear axis whose range comes from the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None, names: Vec::new() }
    }

    /// A logarithmic axis whose range comes from the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label) }
    }

    /// The same axis with fixed ends.
    pub fn over(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// The same axis with a label (markup) in place of the number at `value`.
    pub fn named(mut self, value: f64, label: impl Into<String>) -> Self {
        self.names.push((value, label.into()));
        self
    }
}

/// Perceptually uniform colour maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColourMap {
    /// Dark blue over green to yellow.
    #[default]
    Viridis,
    /// Dark blue to yellow; made for colour-blind readers.
    Cividis,
    /// Dark blue over green to pink, of even lightness; after Crameri, doi 10.5281/zenodo.1243862.
    Batlow,
    /// Black to white, for printing without colour.
    Grey,
    /// Blue over white to red, for values of two signs on a bar with 0 in its middle; RdBu of ColorBrewer, colour-blind safe.
    BlueRed,
}

/// The scale by which the colours of a map are read.
#[derive(Clone, Debug)]
pub struct ColourBar {
    /// Label, scale and range of the values; values outside take the end colours.
    pub axis: Axis,
    /// Colours.
    pub map: ColourMap,
}

/// A point in the units of the axes.
pub type DataPoint = (f64, f64);

/// Rows of a CSV file that hold the points of a layer, one a row and in the same order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Name of the file, without folder.
    pub file: String,
    /// Names of the columns of x and y.
    pub columns: [&'static str; 2],
    /// First and last row, counted from 0 below the header.
    pub rows: (usize, usize),
}

impl Source {
    /// The `rows` of `file`; `None` unless there are at least two, each the next of the one before.
    pub fn of(file: &str, columns: [&'static str; 2], rows: &[usize]) -> Option<Self> {
        let (first, last) = (*rows.first()?, *rows.last()?);
        let consecutive = first < last && rows.windows(2).all(|pair| pair[0] + 1 == pair[1]);
        consecutive.then(|| Self { file: file.to_owned(), columns, rows: (first, last) })
    }
}

/// Which side of a line is shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Towards smaller y.
    Below,
    /// Towards larger y.
    Above,
}

/// A reference line across the panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// Vertical line at this x.
    X(f64),
    /// Horizontal line at this y.
    Y(f64),
}

/// Styles of a round: one more has the same colour and shape, filled where it was open.
pub const ROUND: usize = 9;

/// The style of this colour and dash, each the index of a style below [`ROUND`].
pub fn styled(colour: usize, dash: usize) -> usize {
    let (colour, dash) = (colour % ROUND, dash % ROUND);
    colour + ROUND * ((dash + ROUND - colour) % ROUND)
}

/// Something drawn between the axes. Labels are markup, see [`crate`].
/// A `style` picks colour, dash and marker shape together, so that equal styles look equal: 0 blue,
/// solid, disc; 1 vermilion, dashed, square; 2 green, dotted, triangle; 3 purple, dash-dotted,
/// diamond; 4 black; 5 orange; 6 sky blue; 7 grey; 8 light grey, solid and thin, for what swings behind the others; then again from 0, with filled markers for
/// open ones and each colour with the dash of the next: [`styled`] picks both.
#[derive(Clone, Debug)]
pub enum Layer {
    /// Predicted values, joined; a point that is not finite leaves a gap.
    Curve {
        /// Points in drawing order.
        points: Vec<DataPoint>,
        /// Name of the curve.
        label: Option<String>,
        /// Index into the theme.
        style: usize,
        /// The records that hold the points.
        source: Option<Source>,
    },
    /// Measured or computed single values.
    Markers {
        /// Points.
        points: Vec<DataPoint>,
        /// Name of the series.
        label: Option<String>,
        /// Index into the theme.
        style: usize,
        /// Whether a thin line guides the eye from marker to marker.
        joined: bool,
        /// The records that hold the points.
        source: Option<Source>,
    },
    /// The exact solution: a thin black line; jumps are two points with the same x.
    Exact {
        /// Points in drawing order.
        points: Vec<DataPoint>,
        /// Name of the line.
        label: Option<String>,
    },
    /// A straight reference line across the panel, dotted grey.
    Rule {
        /// Where.
        at: At,
        /// Text set beside it.
        label: Option<String>,
    },
    /// One side of a line, lightly shaded, for instance the stable one.
    Shade {
        /// The line that bounds the shade.
        points: Vec<DataPoint>,
        /// The shaded side.
        side: Side,
        /// Text set inside.
        label: Option<String>,
        /// The records that hold the points.
        source: Option<Source>,
    },
    /// A map of coloured cells, each reaching half way to its neighbours on the axes.
    Cells {
        /// Cell centres along x, increasing.
        x: Vec<f64>,
        /// Cell centres along y, increasing.
        y: Vec<f64>,
        /// `values[j * x.len() + i]` at `(x[i], y[j])`; NaN is grey, and on a logarithmic bar what is not positive is shaded
        /// like a [`Layer::Shade`].
        values: Vec<f64>,
    },
    /// Coloured polygons, such as the elements of a mesh, with lines over them.
    Patches {
        /// Corners of each polygon.
        polygons: Vec<Vec<DataPoint>>,
        /// The value of each, coloured as in [`Layer::Cells`].
        values: Vec<f64>,
        /// Thin black lines.
        outlines: Vec<Vec<DataPoint>>,
    },
    /// A line of constant value, perhaps in several pieces, named on the longest.
    Contour {
        /// Pieces, each joined in order.
        lines: Vec<Vec<DataPoint>>,
        /// The value, set in a gap of the line.
        label: Option<String>,
    },
}

impl Layer {
    /// A named curve.
    pub fn curve(points: Vec<DataPoint>, label: impl Into<String>, style: usize) -> Self {
        Self::Curve { points, label: Some(label.into()), style, source: None }
    }

    /// Named markers, not joined.
    pub fn markers(points: Vec<DataPoint>, label: impl Into<String>, style: usize) -> Self {
        Self::Markers { points, label: Some(label.into()), style, joined: false, source: None }
    }

    /// The same layer with the records that hold its points; only curves, markers and shades can have some.
    pub fn from_records(mut self, records: Option<Source>) -> Self {
        if let Self::Curve { source, .. } | Self::Markers { source, .. } | Self::Shade { source, .. } =
            &mut self
        {
            *source = records;
        }
        self
    }

    /// The points of a line, of markers or of a shade; none of anything else.
    pub fn points(&self) -> &[DataPoint] {
        match self {
            Self::Curve { points, .. }
            | Self::Markers { points, .. }
            | Self::Exact { points, .. }
            | Self::Shade { points, .. } => points,
            Self::Rule { .. } | Self::Cells { .. } | Self::Patches { .. } | Self::Contour { .. } => &[],
        }
    }

    /// The records that hold the points; `None` if no file does.
    pub fn source(&self) -> Option<&Source> {
        match self {
            Self::Curve { source, .. } | Self::Markers { source, .. } | Self::Shade { source, .. } => {
                source.as_ref()
            }
            Self::Exact { .. }
            | Self::Rule { .. }
            | Self::Cells { .. }
            | Self::Patches { .. }
            | Self::Contour { .. } => None,
        }
    }
}
