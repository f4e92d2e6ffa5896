//! Charts of limits with axes in seconds and N/m.

use super::levels::ContourLines;
use super::maps::number;
use crate::record::{OptimalRatioRow, StabilityRow};
use figure::{At, Axis, Figure, Layer, Panel};

pub(super) const STIFFNESS: &str = "penalty stiffness *s* (N/m)";
const STEP: &str = "critical time step (s)";

/// What a panel multiplies: s/beta_s, N/m, and dt/C_r, s. `None` where its rows tell neither.
fn factors(rows: &[StabilityRow]) -> Option<(f64, f64)> {
    let stiffness = |row: &StabilityRow| Some(row.penalty_stiffness?.0 / row.stiffness_penalty.0);
    let step = |row: &StabilityRow| match (row.critical_step, row.critical_courant) {
        (Some(step), Some(courant)) => Some(step.0 / courant.0),
        _ => Some(row.step_lower?.0 / row.lower?.0),
    };
    let stiffness = rows.iter().filter(|row| row.stiffness_penalty.0 > 0.0).find_map(stiffness)?;
    Some((stiffness, rows.iter().find_map(step)?))
}

/// A figure of C_r over beta_s in seconds over N/m; of a map the colours and the labels of its contour lines. `models` are the
/// rows of the panels, `contours` the lines of a map. A panel whose rows have neither is left as it is.
pub fn in_si(mut figure: Figure, models: &[Vec<StabilityRow>], contours: &[ContourLines]) -> Figure {
    let is_map = figure.colour_bar.is_some();
    for (i, (panel, rows)) in figure.panels.iter_mut().zip(models).enumerate() {
        let Some((stiffness, step)) = factors(rows) else { continue };
        let y = if is_map { 1.0 } else { step };
        scale(&mut panel.x, STIFFNESS, stiffness);
        if !is_map {
            scale(&mut panel.y, STEP, step);
        }
        let mut levels = contours.get(i).into_iter().flatten().map(|(level, _)| level.value * step);
        panel.layers.iter_mut().for_each(|layer| scale_layer(layer, (stiffness, y), step, &mut levels));
    }
    if let Some(bar) = &mut figure.colour_bar {
        bar.axis = Axis { range: None, ..Axis::log(STEP) };
    }
    shared(&mut figure.panels);
    figure
}

/// A figure of ratios over beta_s with its abscissa in N/m; `models` are the rows of its curves, whose contacts are to agree in
/// scale. Left as it is where they do not.
pub fn stiffness_in_si(mut figure: Figure, models: &[Vec<OptimalRatioRow>]) -> Figure {
    let rows = || models.iter().flatten().filter(|row| row.stiffness_penalty.0 > 0.0);
    let scales: Option<Vec<f64>> =
        rows().map(|row| Some(row.penalty_stiffness?.0 / row.stiffness_penalty.0)).collect();
    let Some(scales) = scales.filter(|scales| !scales.is_empty()) else { return figure };
    let (low, high) =
        scales.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), s| (low.min(*s), high.max(*s)));
    // A product and a quotient are off by a rounding each.
    if high > low * (1.0 + 4.0 * f64::EPSILON) {
        return figure;
    }
    for panel in &mut figure.panels {
        scale(&mut panel.x, STIFFNESS, low);
        for layer in &mut panel.layers {
            scale_layer(layer, (low, 1.0), 1.0, &mut std::iter::empty());
            if let Layer::Curve { source: Some(source), .. } = layer {
                source.columns = ["penalty_stiffness", "optimal_ratio"];
            }
        }
    }
    figure
}

fn scale(axis: &mut Axis, label: &str, by: f64) {
    axis.label = label.to_owned();
    axis.range = axis.range.map(|(low, high)| (low * by, high * by));
}

/// Panels of one range keep one where their units agree, and take their own where they do not.
fn shared(panels: &mut [Panel]) {
    let differ = panels.windows(2).any(|pair| pair[0].y.range != pair[1].y.range);
    if differ {
        panels.iter_mut().for_each(|panel| panel.y.range = None);
    }
}

fn scale_layer(layer: &mut Layer, (x, y): (f64, f64), step: f64, levels: &mut impl Iterator<Item = f64>) {
    let all = |points: &mut Vec<(f64, f64)>| {
        points.iter_mut().for_each(|point| *point = (point.0 * x, point.1 * y));
    };
    match layer {
        Layer::Curve { points, source, .. }
        | Layer::Markers { points, source, .. }
        | Layer::Shade { points, source, .. } => {
            all(points);
            if let Some(source) = source {
                let column = if source.columns[1] == "lower" { "step_lower" } else { "critical_step" };
                source.columns = ["penalty_stiffness", column];
            }
        }
        Layer::Exact { points, .. } => all(points),
        Layer::Rule { at: At::X(value), .. } => *value *= x,
        Layer::Rule { at: At::Y(value), .. } => *value *= y,
        Layer::Cells { x: centres, values, .. } => {
            centres.iter_mut().for_each(|value| *value *= x);
            values.iter_mut().for_each(|value| *value *= step);
        }
        // Lengths and stresses are in SI units.
        Layer::Patches { .. } => (),
        Layer::Contour { lines, label } => {
            lines.iter_mut().for_each(all);
            *label = levels.next().map(three_digits);
        }
    }
}

/// A level as a label; three digits are as many as fit into the gap of a line.
fn three_digits(level: f64) -> String {
    number(format!("{level:.2e}").parse().unwrap_or(level))
}
