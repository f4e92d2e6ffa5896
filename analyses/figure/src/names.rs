//! Naming lines where they are: beside their ends, beside them, or in a gap of them.

use super::error::PlotError;
use super::font::{Fonts, Line};
use super::frame::Frame;
use super::geometry::{Point, Rect};
use super::layout::text_height;
use super::model::Layer;
use super::search::Obstacles;
use super::theme::{BLACK, Colour, GAP, GREY, LABEL_SIZE, LEADER, series_ink};
use super::trace::Trace;

/// A name with its place.
pub(super) struct Name {
    pub(super) layer: usize,
    pub(super) line: Line,
    /// Middle of the text at half the height of its capitals.
    pub(super) centre: Point,
    /// Clockwise, degrees.
    pub(super) turn: f64,
    pub(super) colour: Colour,
    /// From the end of the curve to the name.
    pub(super) leader: Option<[Point; 2]>,
    /// Index of the line of the layer that is interrupted, and the arc lengths where.
    pub(super) gap: Option<(usize, f64, f64)>,
}

/// Names of one panel.
#[derive(Default)]
pub(super) struct Names {
    pub(super) placed: Vec<Name>,
    /// Layers for whose names there is no free place.
    pub(super) homeless: Vec<usize>,
}

/// The label of a layer, if it has one.
pub(super) fn label_of(layer: &Layer) -> Option<&str> {
    match layer {
        Layer::Curve { label, .. }
        | Layer::Markers { label, .. }
        | Layer::Exact { label, .. }
        | Layer::Rule { label, .. }
        | Layer::Shade { label, .. }
        | Layer::Contour { label, .. } => label.as_deref(),
        Layer::Cells { .. } | Layer::Patches { .. } => None,
    }
}

/// Whether a layer is one of the series that a legend can list.
pub(super) fn is_series(layer: &Layer) -> bool {
    matches!(layer, Layer::Curve { .. } | Layer::Markers { .. } | Layer::Exact { .. })
}

/// Colour of a layer's name.
pub(super) fn ink(layer: &Layer) -> Colour {
    match layer {
        Layer::Curve { style, .. } | Layer::Markers { style, .. } => series_ink(*style),
        Layer::Rule { .. } | Layer::Shade { .. } => GREY,
        _ => BLACK,
    }
}

/// Where a curve leaves through the right edge of the frame.
pub(super) fn right_end(layer: &Layer, trace: &Trace, frame: &Frame) -> Option<Point> {
    /// Nearer to the edge than this is at the edge, mm.
    const NEAR: f64 = 0.2;
    if !matches!(layer, Layer::Curve { .. } | Layer::Exact { .. }) {
        return None;
    }
    let end = *trace.lines.last()?.last()?;
    (frame.rect.right - end.0 < NEAR).then_some(end)
}

/// Which names of series are placed where.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Series {
    /// At the right ends of the curves, else beside them.
    Ends,
    /// Beside the curves only.
    Beside,
    /// Not at all: a legend lists them.
    Listed,
}

/// Places the names of a panel's layers.
pub(super) fn place(
    layers: &[Layer],
    traces: &[Trace],
    frame: &Frame,
    fonts: &Fonts,
    series: Series,
) -> Result<Names, PlotError> {
    let mut names = Names::default();
    let mut ends = Vec::new();
    let mut others = Vec::new();
    for (index, layer) in layers.iter().enumerate() {
        let Some(label) = label_of(layer) else {
            continue;
        };
        // What is not visible is not named, and what the legend lists is not named twice.
        if traces[index].is_empty() || (is_series(layer) && series == Series::Listed) {
            continue;
        }
        let line = fonts.line(label, LABEL_SIZE)?;
        match right_end(layer, &traces[index], frame) {
            Some(end) if series == Series::Ends => ends.push((index, line, end)),
            _ => others.push((index, line)),
        }
    }
    place_ends(ends, layers, frame, &mut names);
    let mut obstacles = Obstacles { frame: frame.rect, traces, taken: Vec::new() };
    // The shade has most freedom: its name comes last.
    others.sort_by_key(|(index, _)| matches!(layers[*index], Layer::Shade { .. }));
    for (index, line) in others {
        match place_one(index, line, &layers[index], &mut obstacles) {
            Some(name) => names.placed.push(name),
            None => names.homeless.push(index),
        }
    }
    Ok(names)
}

fn place_one(layer: usize, line: Line, what: &Layer, obstacles: &mut Obstacles) -> Option<Name> {
    let size = (line.width, line.height());
    let colour = ink(what);
    if matches!(what, Layer::Contour { .. })
        && let Some(inset) = obstacles.inset(layer, size)
    {
        obstacles.taken.extend(inset.boxes);
        return Some(Name {
            layer,
            line,
            centre: inset.centre,
            turn: inset.turn,
            colour,
            leader: None,
            gap: Some(inset.gap),
        });
    }
    let rect = match what {
        Layer::Shade { .. } => obstacles.inside(layer, size),
        _ => obstacles.beside(layer, size),
    }?;
    obstacles.taken.push(rect);
    Some(Name {
        layer,
        centre: (rect.centre().0, rect.top + line.ascent / 2.0),
        line,
        turn: 0.0,
        colour,
        leader: None,
        gap: None,
    })
}

/// Stacks the names of curves that end at the right edge beside the frame, each as near to the end
/// of its curve as the others allow.
fn place_ends(mut ends: Vec<(usize, Line, Point)>, layers: &[Layer], frame: &Frame, names: &mut Names) {
    ends.sort_by(|a, b| a.2.1.total_cmp(&b.2.1));
    let pitch = text_height(LABEL_SIZE);
    let wanted: Vec<f64> = ends.iter().map(|(_, _, end)| end.1).collect();
    let Some(heights) = spread(&wanted, pitch, frame.rect) else {
        names.homeless.extend(ends.iter().map(|(index, ..)| *index));
        return;
    };
    for ((layer, line, end), height) in ends.into_iter().zip(heights) {
        let foot = (frame.rect.right + LEADER, height);
        names.placed.push(Name {
            layer,
            centre: (foot.0 + GAP + line.width / 2.0, height),
            line,
            turn: 0.0,
            colour: ink(&layers[layer]),
            leader: Some([end, foot]),
            gap: None,
        });
    }
}

/// Heights as near as possible to the wanted ones (ascending), `pitch` apart and within the frame;
/// `None` if there are too many.
fn spread(wanted: &[f64], pitch: f64, frame: Rect) -> Option<Vec<f64>> {
    let needed = pitch * wanted.len() as f64;
    if needed > frame.height() {
        return None;
    }
    // With the pitch taken out, heights need only be ascending: pool neighbours that are not, and
    // give each pool the mean of what its members wanted (least squares).
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (index, height) in wanted.iter().enumerate() {
        let mut pool = (height - index as f64 * pitch, 1);
        while let Some(&(mean, count)) = pools.last() {
            if mean <= pool.0 {
                break;
            }
            let members = count + pool.1;
            pool.0 = (mean * count as f64 + pool.0 * pool.1 as f64) / members as f64;
            pool.1 = members;
            pools.pop();
        }
        pools.push(pool);
    }
    let lowest = frame.top + pitch / 2.0;
    let highest = frame.bottom - needed + pitch / 2.0;
    let flat = pools.iter().flat_map(|(mean, count)| std::iter::repeat_n(*mean, *count));
    let placed = flat.enumerate();
    Some(placed.map(|(i, mean)| mean.clamp(lowest, highest.max(lowest)) + i as f64 * pitch).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_spread_apart_and_stay_inside() {
        let frame = Rect::new(0.0, 0.0, 10.0, 20.0);
        let heights = spread(&[0.5, 0.6, 0.7, 12.0, 19.9], 3.0, frame).expect("room for five");
        for pair in heights.windows(2) {
            assert!(pair[1] - pair[0] >= 3.0 - 1e-12, "{heights:?}");
        }
        assert!(heights[0] >= 1.5 && heights[4] <= 18.5, "{heights:?}");
        assert_eq!(heights[3], 12.0);
        assert!(spread(&[1.0; 7], 3.0, frame).is_none());
    }
}
