//! Sizes, colours and dashes: every number of the house style, with its unit.

/// Millimetres in a typographic point.
pub(super) const PT: f64 = 25.4 / 72.0;
/// Resolution of the PNG, dots per inch.
pub(super) const PNG_DPI: f64 = 300.0;

/// Least size of any letter or digit, sub- and superscripts too, pt: what journals ask for.
pub(super) const LEAST_SIZE: f64 = 6.0;
/// Tick labels, pt.
pub(super) const TICK_SIZE: f64 = 7.0;
/// Labels of curves, contours and legends, pt.
pub(super) const LABEL_SIZE: f64 = 7.5;
/// Axis labels, pt.
pub(super) const AXIS_SIZE: f64 = 8.0;
/// Panel titles, pt.
pub(super) const TITLE_SIZE: f64 = 8.5;

/// Frame and ticks, pt.
pub(super) const FRAME_STROKE: f64 = 0.5;
/// Curves, pt.
pub(super) const CURVE_STROKE: f64 = 1.0;
/// A curve that swings from step to step, pt: its swings stay apart, where wider ones make a block.
pub(super) const SWINGING_STROKE: f64 = 0.3;
/// Exact solutions, rules, contours and leaders, pt.
pub(super) const THIN_STROKE: f64 = 0.6;
/// White casing below contour lines, which keeps them visible on dark colours, pt.
pub(super) const CASING_STROKE: f64 = 1.5;
/// Half width of the white halo around text, mm.
pub(super) const HALO: f64 = 0.35;

/// Major ticks, mm.
pub(super) const MAJOR_TICK: f64 = 1.0;
/// Minor ticks, mm.
pub(super) const MINOR_TICK: f64 = 0.6;
/// Between a tick and its label, and between a curve and its label, mm.
pub(super) const GAP: f64 = 0.7;
/// White space around the whole figure and between its parts, mm.
pub(super) const PADDING: f64 = 1.5;
/// Length of the leader from a curve's end to its label beside the frame, mm.
pub(super) const LEADER: f64 = 2.5;
/// Between a sample and its name in a legend, mm.
pub(super) const SAMPLE_GAP: f64 = 1.5;
/// Length of a line sample in a legend, mm.
pub(super) const SAMPLE: f64 = 9.0;
/// Radius of a marker, mm.
pub(super) const MARKER: f64 = 0.75;
/// Width of the colour bar, mm.
pub(super) const BAR: f64 = 3.0;
/// Smallest frame worth drawing, mm.
pub(super) const MIN_FRAME: f64 = 15.0;
/// Largest share of the width given to labels beside the frames.
pub(super) const MAX_LABEL_SHARE: f64 = 0.3;
/// Room for one tick label along a vertical axis, mm.
pub(super) const TICK_PITCH_Y: f64 = 6.0;
/// Room for one tick label along a horizontal axis, mm.
pub(super) const TICK_PITCH_X: f64 = 9.0;

/// Share of the data's extent added on each side of an axis without a given range.
pub(super) const RANGE_PAD: f64 = 0.05;
/// A step in pixels of the PNG is the finest detail kept of a curve, mm.
pub(super) const CURVE_TOLERANCE: f64 = 0.01;

/// An RGB colour.
pub(super) type Colour = (u8, u8, u8);

pub(super) const BLACK: Colour = (0, 0, 0);
pub(super) const WHITE: Colour = (255, 255, 255);
/// Rules and their text.
pub(super) const GREY: Colour = (90, 90, 90);
/// Shaded (stable) side.
pub(super) const SHADE: Colour = (223, 234, 242);
/// Cells without a value.
pub(super) const MISSING: Colour = (190, 190, 190);

/// Qualitative colours of Okabe and Ito, the dark ones first; the yellow is left out. The last is for noisy curves
/// behind the others.
const SERIES: [Colour; 9] = [
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (0, 0, 0),
    (230, 159, 0),
    (86, 180, 233),
    (120, 120, 120),
    (140, 140, 140),
];

/// Dashes, mm drawn and mm left out in turn; all different, so that grey print keeps the curves apart.
const DASHES: [&[f64]; 9] = [
    &[],
    &[2.2, 0.9],
    &[0.5, 0.7],
    &[2.4, 0.7, 0.5, 0.7],
    &[1.1, 0.6],
    &[2.4, 0.6, 0.5, 0.6, 0.5, 0.6],
    &[4.0, 0.7, 1.3, 0.7],
    &[0.4, 1.3],
    &[],
];

/// Shape of a marker.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Shape {
    /// Circle.
    Circle,
    /// Regular polygon with its first corner `turn` degrees from the right.
    Polygon { corners: u32, turn: f64 },
}

/// Shapes and whether they are filled.
const SHAPES: [(Shape, bool); 9] = [
    (Shape::Circle, true),
    (SQUARE, true),
    (TRIANGLE, true),
    (DIAMOND, true),
    (Shape::Circle, false),
    (SQUARE, false),
    (TRIANGLE, false),
    (DIAMOND, false),
    (Shape::Circle, true),
];
const SQUARE: Shape = Shape::Polygon { corners: 4, turn: 45.0 };
const DIAMOND: Shape = Shape::Polygon { corners: 4, turn: 0.0 };
const TRIANGLE: Shape = Shape::Polygon { corners: 3, turn: 90.0 };

/// Colour of the curve or marker with this style index.
pub(super) fn series_colour(style: usize) -> Colour {
    SERIES[style % SERIES.len()]
}

/// Colour for the text that names this series: its own, darkened where it is too light to read.
pub(super) fn series_ink(style: usize) -> Colour {
    let colour = series_colour(style);
    /// Rec. 709 luma (0 to 255) above which text on white is too pale.
    const PALE: f64 = 105.0;
    let (r, g, b) = (f64::from(colour.0), f64::from(colour.1), f64::from(colour.2));
    let luma = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let factor = (PALE / luma.max(1.0)).min(1.0);
    // Factors are at most 1, so the products stay within 0..=255.
    ((r * factor) as u8, (g * factor) as u8, (b * factor) as u8)
}

/// Width of a curve of this style, pt.
pub(super) fn series_stroke(style: usize) -> f64 {
    if style % SERIES.len() == SERIES.len() - 1 { SWINGING_STROKE } else { CURVE_STROKE }
}

/// Dash pattern of this style, mm; every round through the colours each has the next one.
pub(super) fn series_dash(style: usize) -> &'static [f64] {
    DASHES[(style + style / DASHES.len()) % DASHES.len()]
}

/// Marker of this style and whether it is filled; every second round through the styles turns that about.
pub(super) fn series_shape(style: usize) -> (Shape, bool) {
    let (shape, filled) = SHAPES[style % SHAPES.len()];
    (shape, filled == (style / SHAPES.len()).is_multiple_of(2))
}
