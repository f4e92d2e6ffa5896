//! Predicted limits as curves, the limits that stepping found as markers on them.

use super::curve::{Curve, curves_of};
use super::maps::{STYLES, Styles, all_curves, limit_name};
use crate::record::{StabilityRow, VerifyRow};
use figure::{Figure, Layer, Naming};

/// More ratios would share their styles: they cannot be told apart in one chart.
pub const MOST_RATIOS: usize = STYLES;

/// C_r over beta_s: `predicted` curves and `measured` points, one panel a model; at most [`MOST_RATIOS`] ratios.
pub fn limits(predicted: &[Vec<StabilityRow>], measured: &[Vec<VerifyRow>], log: bool) -> Figure {
    let styles = Styles::of(predicted);
    let mut figure = all_curves(predicted, log);
    figure.naming = Naming::Legend;
    for ((panel, rows), predicted) in figure.panels.iter_mut().zip(measured).zip(predicted) {
        if let Some(row) = rows.first() {
            panel.y.label = format!("*C*_{{r}}, {}", limit_name(row.scheme));
        }
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
    figure
}
