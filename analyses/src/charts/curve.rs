//! The rows of one model as curves over beta_s that know their rows.

use crate::record::StabilityRow;
use figure::Source;

/// The points of one ratio by increasing beta_s.
pub(super) struct Curve {
    pub(super) ratio: f64,
    /// Whether its points are lower bounds of limits.
    bounds: bool,
    pub(super) points: Vec<CurvePoint>,
}

/// A row as a point of a curve.
#[derive(Clone, Copy)]
pub(super) struct CurvePoint {
    pub(super) beta_s: f64,
    /// What is known to be stable: C_r, or its lower bound; NaN where nothing could be certified.
    pub(super) courant: f64,
    /// Index of the row among those of the model.
    row: usize,
}

impl Curve {
    pub(super) fn line(&self) -> Vec<(f64, f64)> {
        self.points.iter().map(|point| (point.beta_s, point.courant)).collect()
    }

    /// The rows of `file` where the points stand, those of the model from `first` on.
    pub(super) fn source(&self, file: &str, first: usize) -> Option<Source> {
        let rows: Vec<usize> = self.points.iter().map(|point| first + point.row).collect();
        let column = if self.bounds { "lower" } else { "critical_courant" };
        Source::of(file, ["stiffness_penalty", column], &rows)
    }
}

/// The rows of one model as curves, in their order.
pub(super) fn curves_of(rows: &[StabilityRow]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let courant = row.stable_courant().unwrap_or(f64::NAN);
        let point = CurvePoint { beta_s: row.stiffness_penalty.0, courant, row: index };
        match curves.last_mut() {
            Some(curve) if curve.ratio == row.ratio.0 => curve.points.push(point),
            _ => curves.push(Curve { ratio: row.ratio.0, bounds: row.is_lower_bound(), points: vec![point] }),
        }
    }
    curves.iter_mut().for_each(|curve| curve.points.sort_by(|a, b| a.beta_s.total_cmp(&b.beta_s)));
    curves
}
