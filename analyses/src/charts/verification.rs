//! Predicted limits as curves, the limits that stepping found as markers on them, islands of stability above them.

use super::curve::{Curve, curves_of};
use super::maps::{STYLES, Styles, curves, limit_name};
use crate::record::{StabilityRow, VerifyRow};
use figure::{Figure, Layer, Naming};

/// More ratios would share their styles: they cannot be told apart in one chart.
pub const MOST_RATIOS: usize = STYLES;

/// The style that stands for all markers in the legend: a black disc.
const FOUND: usize = 13;
/// The style of islands.
const ISLAND: usize = 6;

/// C_r over beta_s: `predicted` curves and `measured` points, one panel a model; at most [`MOST_RATIOS`] ratios.
pub fn limits(predicted: &[Vec<StabilityRow>], measured: &[Vec<VerifyRow>], log: bool) -> Figure {
    let styles = Styles::of(predicted);
    let mut figure = curves(None, predicted, log);
    figure.naming = Naming::Legend;
    for ((panel, rows), predicted) in figure.panels.iter_mut().zip(measured).zip(predicted) {
        if let Some(row) = rows.first() {
            panel.y.label = format!("*C*_{{r}}, {}", limit_name(row.scheme));
        }
        let shown = rows.iter().filter(|row| !log || row.stiffness_penalty.0 > 0.0);
        let islands: Vec<Layer> = shown.flat_map(islands).collect();
        let tops = islands.iter().flat_map(Layer::points).map(|point| point.1);
        let top = tops.fold(0.0, f64::max);
        // Islands lie above the curves that the range was made for, and get the same air.
        panel.y.range = panel.y.range.map(|(low, high)| (low, high.max(top + 0.05 * (top - low))));
        panel.layers.extend(islands);
        for Curve { ratio, .. } in curves_of(predicted) {
            let of_ratio = rows.iter().filter(|row| row.ratio.0 == ratio);
            let point =
                |row: &VerifyRow| (row.stiffness_penalty.0, 0.5 * (row.stable_at.0 + row.unstable_at.0));
            let points: Vec<_> = of_ratio.map(point).filter(|(beta_s, _)| !log || *beta_s > 0.0).collect();
            if !points.is_empty() {
                panel.layers.push(Layer::Markers {
                    points,
                    label: None,
                    style: styles.style(ratio),
                    joined: false,
                    source: None,
                });
            }
        }
    }
    let has_islands = measured.iter().flatten().any(|row| !row.islands.is_empty());
    figure.key.push(Layer::markers(Vec::new(), "limit found by stepping", FOUND));
    figure.key.extend(has_islands.then(|| island(Vec::new())));
    figure
}

/// Steps above its limit at which the scheme is stable again.
fn island(points: Vec<(f64, f64)>) -> Layer {
    let label = Some("stable again (island)".to_owned());
    Layer::Markers { points, label, style: ISLAND, joined: true, source: None }
}

/// The islands of a row as upright lines, each between its ends.
fn islands(row: &VerifyRow) -> Vec<Layer> {
    let ends = |part: &str| {
        let (low, high) = part.split_once('-')?;
        Some((low.parse().ok()?, high.parse().ok()?))
    };
    let line = |(low, high)| island(vec![(row.stiffness_penalty.0, low), (row.stiffness_penalty.0, high)]);
    row.islands.split_whitespace().filter_map(ends).map(line).collect()
}
