//! Maps of coloured cells, without seams between them: as one image or, in a PDF, as rectangles that reach below the
//! ones drawn after them, because two edges that only meet let the paper through where a viewer smooths them.

use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};

use super::canvas::{Canvas, Form};
use super::error::PlotError;
use super::export::encode;
use super::frame::{Frame, Interval};
use super::geometry::Rect;
use super::model::{Axis, ColourMap, Panel, Scale};
use super::theme::{Colour, MISSING, PNG_DPI, SHADE};

/// Batlow at equal distances: between them straight lines are off by less than two in 255.
const BATLOW: [Colour; 17] = [
    (1, 25, 89),
    (13, 49, 93),
    (17, 67, 96),
    (22, 82, 98),
    (34, 96, 97),
    (53, 106, 89),
    (77, 115, 77),
    (102, 122, 63),
    (129, 130, 50),
    (160, 138, 43),
    (191, 144, 53),
    (219, 149, 76),
    (242, 157, 108),
    (252, 168, 145),
    (253, 180, 180),
    (252, 192, 214),
    (250, 204, 250),
];

/// Colour of a share of the range; values outside take the end colours.
pub(super) fn colour(map: ColourMap, share: f64) -> Colour {
    if share.is_nan() {
        return MISSING;
    }
    let share = share.clamp(0.0, 1.0);
    match map {
        ColourMap::Viridis => colorous::VIRIDIS.eval_continuous(share).as_tuple(),
        ColourMap::Cividis => colorous::CIVIDIS.eval_continuous(share).as_tuple(),
        ColourMap::Batlow => between(&BATLOW, share),
        ColourMap::Grey => between(&[(0, 0, 0), (255, 255, 255)], share),
        ColourMap::BlueRed => colorous::RED_BLUE.eval_continuous(1.0 - share).as_tuple(),
    }
}

/// The colour at a share in [0, 1] of the way through at least two colours.
fn between(colours: &[Colour], share: f64) -> Colour {
    let place = share * (colours.len() - 1) as f64;
    // In range: the share is, and the cast drops the fraction.
    let first = (place as usize).min(colours.len() - 2);
    let (from, to, rest) = (colours[first], colours[first + 1], place - first as f64);
    let mix = |a: u8, b: u8| (f64::from(a) + rest * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}

/// Cells with centres `x`, `y` on a panel, coloured by where their values lie in `range`.
pub(super) struct Cells<'a> {
    frame: Rect,
    /// Edges between the cells, mm, as the axes run: across to the right, up from the bottom.
    across: Vec<f64>,
    up: Vec<f64>,
    values: &'a [f64],
    map: ColourMap,
    range: Interval,
}

impl<'a> Cells<'a> {
    pub(super) fn new(
        (panel, frame): (&Panel, &Frame),
        (x, y, values): (&[f64], &[f64], &'a [f64]),
        (map, range): (ColourMap, Interval),
    ) -> Result<Self, PlotError> {
        check(&panel.x, x)?;
        check(&panel.y, y)?;
        if values.len() != x.len() * y.len() {
            return Err(PlotError::CellCount { columns: x.len(), rows: y.len(), values: values.len() });
        }
        let across = edges(x.iter().map(|value| frame.x_at(*value)));
        // Images run downwards, axes upwards: count from the bottom.
        let up = edges(y.iter().map(|value| -frame.y_at(*value)));
        Ok(Self { frame: frame.rect, across, up, values, map, range })
    }

    pub(super) fn draw(&self, canvas: &mut Canvas) -> Result<(), PlotError> {
        match canvas.form() {
            Form::Svg | Form::Letters => {
                if let Some((png, place)) = self.image()? {
                    canvas.image(&png, place);
                }
            }
            Form::Pdf => self.rectangles().into_iter().for_each(|(place, colour)| canvas.rect(place, colour)),
        }
        Ok(())
    }

    /// The cells as PNG with their place on the page; `None` if the frame shows none of them.
    pub(super) fn image(&self) -> Result<Option<(Vec<u8>, Rect)>, PlotError> {
        let columns = Samples::new(&self.across, self.frame.left, self.frame.right);
        let rows = Samples::new(&self.up, -self.frame.bottom, -self.frame.top);
        if columns.cells.is_empty() || rows.cells.is_empty() {
            return Ok(None);
        }
        let height = rows.cells.len();
        let png = picture(columns.cells.len() as u32, height as u32, |column, row| {
            self.colour(columns.cells[column as usize], rows.cells[height - 1 - row as usize])
        })?;
        let place = Rect { left: columns.from, top: -rows.to, right: columns.to, bottom: -rows.from };
        Ok(Some((png, place)))
    }

    /// What the frame shows of the cells, to be drawn in this order: runs of one colour, row by row from the bottom,
    /// each also below the next cell of its row and below the row that follows.
    fn rectangles(&self) -> Vec<(Rect, Colour)> {
        let mut rectangles = Vec::new();
        let last = (self.across.len() - 2, self.up.len() - 2);
        for j in 0..=last.1 {
            let colours: Vec<Colour> = (0..=last.0).map(|i| self.colour(i, j)).collect();
            let mut first = 0;
            for run in colours.chunk_by(|one, next| one == next) {
                let end = first + run.len();
                let place = Rect {
                    left: self.across[first].max(self.frame.left),
                    right: self.across[(end + 1).min(last.0 + 1)].min(self.frame.right),
                    top: (-self.up[(j + 2).min(last.1 + 1)]).max(self.frame.top),
                    bottom: (-self.up[j]).min(self.frame.bottom),
                };
                if place.left < place.right && place.top < place.bottom {
                    rectangles.push((place, run[0]));
                }
                first = end;
            }
        }
        rectangles
    }

    fn colour(&self, i: usize, j: usize) -> Colour {
        colour_of(self.values[j * (self.across.len() - 1) + i], self.map, self.range)
    }
}

/// The colour of a value on a bar over `range`.
pub(super) fn colour_of(value: f64, map: ColourMap, range: Interval) -> Colour {
    if range.scale == Scale::Log && value <= 0.0 {
        return SHADE;
    }
    colour(map, range.position(value))
}

fn check(axis: &Axis, centres: &[f64]) -> Result<(), PlotError> {
    let increasing = centres.windows(2).all(|pair| pair[0] < pair[1]);
    if centres.len() < 2 || !increasing || !centres.iter().all(|value| value.is_finite()) {
        let label = axis.label.clone();
        return Err(PlotError::CellCentres { label });
    }
    Ok(())
}

/// Edges of at least two cells: half way between their centres, as far beyond the first and last.
fn edges(centres: impl Iterator<Item = f64>) -> Vec<f64> {
    let centres: Vec<f64> = centres.collect();
    let last = centres.len() - 1;
    let mut edges = vec![1.5 * centres[0] - 0.5 * centres[1]];
    edges.extend(centres.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])));
    edges.push(1.5 * centres[last] - 0.5 * centres[last - 1]);
    edges
}

/// The visible part of a row of cells, sampled at the resolution of the PNG.
struct Samples {
    from: f64,
    to: f64,
    /// For every pixel the cell its centre lies in.
    cells: Vec<usize>,
}

impl Samples {
    fn new(edges: &[f64], low: f64, high: f64) -> Self {
        let last = edges.len() - 1;
        let (from, to) = (edges[0].max(low), edges[last].min(high));
        // Pages are small and a negative width gives no pixel: the cast drops the fraction.
        let pixels = ((to - from) / 25.4 * PNG_DPI).ceil() as usize;
        let step = (to - from) / pixels as f64;
        let cell = |pixel| {
            let place = from + (pixel as f64 + 0.5) * step;
            edges[1..last].partition_point(|edge| *edge <= place)
        };
        Self { from, to, cells: (0..pixels).map(cell).collect() }
    }
}

/// A PNG with the colour of each pixel (column, row).
fn picture(width: u32, height: u32, colour_of: impl Fn(u32, u32) -> Colour) -> Result<Vec<u8>, PlotError> {
    let mut image = Pixmap::new(width, height).ok_or(PlotError::Pixels)?;
    for (index, pixel) in (0_u32..).zip(image.pixels_mut()) {
        let (r, g, b) = colour_of(index % width, index / width);
        // Opaque, so premultiplied already: the constructor cannot refuse.
        if let Some(opaque) = PremultipliedColorU8::from_rgba(r, g, b, u8::MAX) {
            *pixel = opaque;
        }
    }
    encode(&image, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scale;

    #[test]
    fn unequal_cells_reach_half_way_to_their_neighbours() {
        let edges = edges([0.0, 1.0, 4.0].into_iter());
        assert_eq!(edges, [-0.5, 0.5, 2.5, 5.5]);
        // What is visible lies in the first two cells, half and half.
        let samples = Samples::new(&edges, 0.0, 1.0);
        let half = samples.cells.len() / 2;
        assert_eq!((samples.from, samples.to), (0.0, 1.0));
        assert_eq!((samples.cells[0], samples.cells[half + 1]), (0, 1));
        assert!(Samples::new(&edges, 6.0, 7.0).cells.is_empty());
    }

    #[test]
    fn rectangles_show_their_cells_and_reach_below_their_neighbours() {
        let values = [0.0, 0.0, 1.0, 0.5, f64::NAN, 0.25];
        let cells = Cells {
            frame: Rect { left: 0.5, top: -2.0, right: 9.0, bottom: 0.0 },
            across: vec![0.0, 1.0, 2.0, 3.0],
            up: vec![0.0, 1.0, 1.5],
            values: &values,
            map: ColourMap::Viridis,
            range: Interval { low: 0.0, high: 1.0, scale: Scale::Linear },
        };
        let rectangles = cells.rectangles();
        // Two cells of one colour are one run; the frame cuts the first column.
        assert_eq!(rectangles.len(), 5);
        assert_eq!(rectangles[0].0, Rect { left: 0.5, top: -1.5, right: 3.0, bottom: 0.0 });
        let around = |x: f64, y: f64| Rect::around((x, -y), 0.02, 0.02);
        for (j, y) in [0.5, 1.25].into_iter().enumerate() {
            for (i, x) in [0.75, 1.5, 2.5].into_iter().enumerate() {
                let top = rectangles.iter().rfind(|(place, _)| place.contains(&around(x, y)));
                assert_eq!(top.map(|(_, colour)| *colour), Some(cells.colour(i, j)), "cell {i}, {j}");
            }
        }
        // On every edge between cells one rectangle lies whole below the smoothed edge of the other.
        for (x, y) in [(2.0, 0.5), (1.0, 1.25), (2.0, 1.25), (0.75, 1.0), (1.5, 1.0), (2.5, 1.0)] {
            assert!(rectangles.iter().any(|(place, _)| place.contains(&around(x, y))), "a seam at {x}, {y}");
        }
    }

    #[test]
    fn batlow_runs_from_its_first_to_its_last_colour() {
        for (share, expected) in [(0.0, BATLOW[0]), (0.5, BATLOW[8]), (1.0, BATLOW[16])] {
            assert_eq!(colour(ColourMap::Batlow, share), expected);
        }
        assert_eq!(colour(ColourMap::Grey, 0.5), (128, 128, 128));
    }

    #[test]
    fn a_missing_value_is_grey_and_the_ends_hold_beyond() {
        assert_eq!(colour(ColourMap::Viridis, f64::NAN), MISSING);
        let map = ColourMap::Cividis;
        assert_eq!(colour(map, 7.0), colour(map, 1.0));
        assert_ne!(colour(map, 0.0), colour(map, 1.0));
    }
}
