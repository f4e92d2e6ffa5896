use thiserror::Error;

/// What can be wrong with a figure, with the offending value.
#[derive(Debug, Error)]
pub enum PlotError {
    /// The figure has no panel, so there is nothing to draw.
    #[error("the figure has no panels")]
    NoPanels,
    /// A layer has no point with two finite coordinates.
    #[error("the {layer} `{label}` has no finite point")]
    EmptyLayer {
        /// Kind of layer.
        layer: &'static str,
        /// Its label, empty if it has none.
        label: String,
    },
    /// No range is given for an axis and no layer has a finite value to take it from.
    #[error("the axis `{label}` has no range and no finite data to take one from")]
    NoRange {
        /// Label of the axis.
        label: String,
    },
    /// The range of an axis or of the colour bar is not finite, empty or reversed.
    #[error("the range {low} .. {high} of the axis `{label}` must be finite, with the lower end first")]
    Range {
        /// Label of the axis.
        label: String,
        /// Lower end as given.
        low: f64,
        /// Upper end as given.
        high: f64,
    },
    /// A logarithmic axis was asked to show zero or a negative number.
    #[error("the logarithmic axis `{label}` cannot show {value}: only positive values")]
    NotPositive {
        /// Label of the axis.
        label: String,
        /// The value.
        value: f64,
    },
    /// The number of cell values is not the product of the numbers of cell centres.
    #[error("a map of {columns} x {rows} cells needs {} values, but has {values}", columns * rows)]
    CellCount {
        /// Number of cell centres along x.
        columns: usize,
        /// Number of cell centres along y.
        rows: usize,
        /// Number of values given.
        values: usize,
    },
    /// The number of values is not that of the polygons.
    #[error("{polygons} polygons need as many values, not {values}")]
    PatchCount {
        /// Number of polygons.
        polygons: usize,
        /// Number of values given.
        values: usize,
    },
    /// The cell centres of a map are too few or do not increase.
    #[error("the cell centres along `{label}` must be at least two, finite and increasing")]
    CellCentres {
        /// Label of the axis.
        label: String,
    },
    /// A map is drawn but the figure has no colour bar to read it by.
    #[error("a figure with a map needs a colour bar")]
    NoColourBar,
    /// The shape of the panels is not a positive number.
    #[error("the aspect of the panels must be between 0.05 and 20, not {aspect}")]
    Aspect {
        /// Height over width as given.
        aspect: f64,
    },
    /// The margins leave no room for the panels.
    #[error("{columns} columns of panels do not fit in a width of {width} mm")]
    TooNarrow {
        /// Columns of panels.
        columns: usize,
        /// Width of the figure, mm.
        width: f64,
    },
    /// A label would be cut off at the edge of the page.
    #[error("label `{label}` is {length:.0} mm long, but only {room:.0} mm fit: shorten it")]
    LabelTooLong {
        /// The label.
        label: String,
        /// Its printed length, mm.
        length: f64,
        /// Room for it, mm.
        room: f64,
    },
    /// A label is not well-formed markup.
    #[error("label `{label}`: {problem}")]
    Markup {
        /// The label.
        label: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The built-in font lacks a character.
    #[error("label `{label}`: the built-in font has no {character:?}")]
    Character {
        /// The label.
        label: String,
        /// The character.
        character: char,
    },
    /// The axes have ranges outside of which all of the figure lies.
    #[error("nothing lies within the ranges of the axes")]
    NothingVisible,
    /// A built-in font could not be read.
    #[error("the built-in font cannot be read")]
    Font,
    /// The SVG could not be read back for conversion.
    #[error("the SVG cannot be converted: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// The PNG could not be written.
    #[error("the PNG cannot be encoded: {0}")]
    Png(#[from] png::EncodingError),
    /// A picture would have no pixels, or more than memory holds.
    #[error("the picture has no pixels, or too many")]
    Pixels,
    /// The PDF could not be written.
    #[error("the PDF cannot be written: {0}")]
    Pdf(String),
}
