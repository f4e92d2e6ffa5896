//! The largest ratio that costs no step, over beta_s.

use super::maps::{STIFFNESS, figure, limit_name, line, number, scene_name};
use crate::record::OptimalRatioRow;
use figure::{Axis, Figure, Layer, Naming, Panel, Source, literal};

/// The optimal ratio over beta_s, one curve a mass matrix, and the width of its enclosure; of a ratio that is the same
/// everywhere, as far as is proven, how far from it r* may lie. Where no ratio costs a step,
/// or every one does, there is no curve; `None` if that is everywhere. The rows of all models stand in `file`.
pub fn optimal_ratio(file: &str, models: &[Vec<OptimalRatioRow>], log: bool) -> Option<Figure> {
    if let Some(ratio) = constant(models) {
        return distances(models, log, ratio);
    }
    let x = || if log { Axis::log(STIFFNESS) } else { Axis::linear(STIFFNESS) };
    let (mut values, mut widths, mut found) = (Vec::new(), Vec::new(), Vec::new());
    let mut before = 0;
    for (style, model) in models.iter().enumerate() {
        // Where every ratio costs a step, the largest that does not is 0.
        let some =
            |(_, row): &(usize, &OptimalRatioRow)| row.optimal_ratio.is_some_and(|ratio| ratio.0 > 0.0);
        let mut rows: Vec<(usize, &OptimalRatioRow)> = (before..).zip(model).filter(some).collect();
        before += model.len();
        rows.sort_by(|(_, a), (_, b)| a.stiffness_penalty.0.total_cmp(&b.stiffness_penalty.0));
        let (indices, rows): (Vec<usize>, Vec<&OptimalRatioRow>) = rows.into_iter().unzip();
        let Some(first) = rows.first() else { continue };
        let source = Source::of(file, ["stiffness_penalty", "optimal_ratio"], &indices);
        let name = literal(&first.mass);
        let curve = |of: fn(&OptimalRatioRow) -> Option<f64>| {
            rows.iter().map(|row| (row.stiffness_penalty.0, of(row).unwrap_or(f64::NAN))).collect::<Vec<_>>()
        };
        let ratios = curve(|row| Some(row.optimal_ratio?.0));
        found.extend(ratios.iter().map(|(_, ratio)| *ratio));
        values.push(Layer::curve(ratios, &name, style).from_records(source));
        // An enclosure of no width has no place on a logarithmic axis.
        let width = curve(|row| Some(row.upper?.0 - row.lower?.0).filter(|width| *width > 0.0));
        if width.iter().any(|(_, width)| width.is_finite()) {
            widths.push(Layer::curve(width, name, style));
        }
    }
    let row = models.iter().flatten().next()?;
    let of_scheme = matches!(row.limit, "predictor-corrector" | "park");
    let (least, most) =
        found.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(*r), high.max(*r)));
    let (y, title) = if of_scheme {
        let title = format!("{}, {}", scene_name(&row.scene), limit_name(row.limit));
        (Axis::linear("largest *r* without cost").over(0.0, 1.5), title)
    } else {
        (Axis::linear("optimal ratio *r*").over(0.9 * least, 1.1 * most), scene_name(&row.scene))
    };
    if values.is_empty() {
        return None;
    }
    let mut panels = vec![Panel::new(x(), y, values).titled(literal(&title))];
    if !widths.is_empty() {
        let y = Axis::log("width of the enclosure of *r*");
        panels.push(Panel::new(x(), y, widths).titled("proven to within"));
    }
    let mut figure = figure(panels);
    figure.naming = Naming::Legend;
    Some(figure)
}

/// The ratio that every enclosure contains, 1 if it can be; `None` if there is none, or a row without enclosure.
fn constant(models: &[Vec<OptimalRatioRow>]) -> Option<f64> {
    let enclosure = |row: &OptimalRatioRow| Some((row.lower?.0, row.upper.filter(|u| u.0.is_finite())?.0));
    let enclosures: Option<Vec<(f64, f64)>> = models.iter().flatten().map(enclosure).collect();
    let (low, high) = enclosures?
        .into_iter()
        .reduce(|(low, high), (lower, upper)| (low.max(lower), high.min(upper)))
        .filter(|(low, high)| low <= high && *low > 0.0)?;
    Some(if low <= 1.0 && 1.0 <= high { 1.0 } else { f64::midpoint(low, high) })
}

/// The largest distance from `ratio` in each enclosure of r*.
fn distances(models: &[Vec<OptimalRatioRow>], log: bool, ratio: f64) -> Option<Figure> {
    let layer = |(style, model): (usize, &Vec<OptimalRatioRow>)| {
        let mut points: Vec<(f64, f64)> = model
            .iter()
            .filter_map(|row| {
                let distance = (row.upper?.0 - ratio).max(ratio - row.lower?.0);
                // No distance has no place on a logarithmic axis.
                Some((row.stiffness_penalty.0, if distance > 0.0 { distance } else { f64::NAN }))
            })
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let label = literal(&model.first()?.mass);
        let some = points.iter().any(|(_, distance)| distance.is_finite());
        some.then(|| line(points, label, style))
    };
    let layers: Vec<Layer> = models.iter().enumerate().filter_map(layer).collect();
    let row = models.iter().flatten().next()?;
    let x = if log { Axis::log(STIFFNESS) } else { Axis::linear(STIFFNESS) };
    let name = number((1e6 * ratio).round() / 1e6);
    let y = Axis::log(format!("|*r*^{{∗}} − {name}|, at most"));
    let title = format!("{}, largest ratio without cost", scene_name(&row.scene));
    let mut figure = figure(vec![Panel::new(x, y, layers).titled(literal(&title))]);
    figure.naming = Naming::Legend;
    (!figure.panels[0].layers.is_empty()).then_some(figure)
}
