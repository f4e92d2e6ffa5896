//! Maps of coloured cells, as one image: no seams between cells, small files.

use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};

use super::canvas::Canvas;
use super::error::PlotError;
use super::export::encode;
use super::frame::{Frame, Interval};
use super::geometry::Rect;
use super::model::{Axis, ColourMap, Panel};
use super::theme::{Colour, MISSING, PNG_DPI};

/// Colour of a share of the range; values outside take the end colours.
pub(super) fn colour(map: ColourMap, share: f64) -> Colour {
    if share.is_nan() {
        return MISSING;
    }
    let gradient = match map {
        ColourMap::Viridis => colorous::VIRIDIS,
        ColourMap::Cividis => colorous::CIVIDIS,
    };
    gradient.eval_continuous(share.clamp(0.0, 1.0)).as_tuple()
}

/// Draws cells with centres `x`, `y`, coloured by where their values lie in `range`.
pub(super) fn draw_cells(
    canvas: &mut Canvas,
    place: (&Panel, &Frame),
    cells: (&[f64], &[f64], &[f64]),
    colours: (ColourMap, Interval),
) -> Result<(), PlotError> {
    if let Some((png, place)) = cells_image(place, cells, colours)? {
        canvas.image(&png, place);
    }
    Ok(())
}

/// The cells as PNG with their place on the page; `None` if the frame shows none of them.
pub(super) fn cells_image(
    (panel, frame): (&Panel, &Frame),
    (x, y, values): (&[f64], &[f64], &[f64]),
    (map, range): (ColourMap, Interval),
) -> Result<Option<(Vec<u8>, Rect)>, PlotError> {
    check(&panel.x, x)?;
    check(&panel.y, y)?;
    if values.len() != x.len() * y.len() {
        return Err(PlotError::CellCount { columns: x.len(), rows: y.len(), values: values.len() });
    }
    let rect = frame.rect;
    let across = edges(x.iter().map(|value| frame.x_at(*value)));
    // Images run downwards, axes upwards: count from the bottom.
    let up = edges(y.iter().map(|value| -frame.y_at(*value)));
    let columns = Samples::new(&across, rect.left, rect.right);
    let rows = Samples::new(&up, -rect.bottom, -rect.top);
    if columns.cells.is_empty() || rows.cells.is_empty() {
        return Ok(None);
    }
    let height = rows.cells.len();
    let png = picture(columns.cells.len() as u32, height as u32, |column, row| {
        let (i, j) = (columns.cells[column as usize], rows.cells[height - 1 - row as usize]);
        colour(map, range.position(values[j * x.len() + i]))
    })?;
    let place = Rect { left: columns.from, top: -rows.to, right: columns.to, bottom: -rows.from };
    Ok(Some((png, place)))
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
    fn a_missing_value_is_grey_and_the_ends_hold_beyond() {
        assert_eq!(colour(ColourMap::Viridis, f64::NAN), MISSING);
        let map = ColourMap::Cividis;
        assert_eq!(colour(map, 7.0), colour(map, 1.0));
        assert_ne!(colour(map, 0.0), colour(map, 1.0));
    }
}
