//! Charts of contact-impact runs, made of records only: one figure a quantity, one panel a stiffness penalty, one
//! curve a scheme, the exact solution in black.

use super::charts::{number, scene_name};
use super::{Axis, Figure, Layer, Panel, Width, literal};
use crate::record::{HistoryRow, Number, StressRow};

/// The records of one run, as the charts need them.
#[derive(Debug, Clone)]
pub struct RunRecord {
    /// beta_s.
    pub stiffness_penalty: f64,
    /// Name of the scheme.
    pub scheme: &'static str,
    /// The history of the first contact.
    pub history: Vec<HistoryRow>,
    /// The stress at the chosen times.
    pub stress: Vec<StressRow>,
}

/// A line of the exact solution; jumps are two points with the same time.
pub type ExactLine = Vec<(f64, f64)>;

/// What is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Contact force over time, N.
    Force,
    /// g/h over time while it is a penetration, logarithmic.
    Gap,
    /// Kinetic and strain energy over time, J.
    Energy,
}

impl Quantity {
    /// Every quantity with the name of its files.
    pub const ALL: [(&'static str, Self); 3] =
        [("force", Self::Force), ("gap", Self::Gap), ("energy", Self::Energy)];

    fn label(self) -> &'static str {
        match self {
            Self::Force => "contact force *λ* [N]",
            Self::Gap => "penetration *g* / *h*",
            Self::Energy => "kinetic + strain energy [J]",
        }
    }

    fn axis(self) -> Axis {
        if self == Self::Gap { Axis::log(self.label()) } else { Axis::linear(self.label()) }
    }

    /// What is drawn of a row; NaN leaves a gap in the line.
    fn value(self, row: &HistoryRow) -> f64 {
        match self {
            Self::Force => row.contact_force.0,
            Self::Gap if row.relative_gap.0 > 0.0 => row.relative_gap.0,
            Self::Gap => f64::NAN,
            Self::Energy => row.kinetic_energy.0 + row.strain_energy.0,
        }
    }
}

/// One quantity over time.
pub fn histories(
    scene: &str,
    mass: &str,
    runs: &[RunRecord],
    quantity: Quantity,
    exact: &ExactLine,
) -> Figure {
    let curve = |run: &RunRecord| run.history.iter().map(|row| (row.time.0, quantity.value(row))).collect();
    panels(scene, mass, runs, "time *t* [s]", &quantity.axis(), curve, &|_| exact.clone())
}

/// The stress along the bars at the time of the rows.
pub fn stresses(scene: &str, mass: &str, runs: &[RunRecord]) -> Figure {
    let curve = |run: &RunRecord| run.stress.iter().map(|row| (row.position.0, row.stress.0)).collect();
    let exact = |run: &RunRecord| {
        let point = |row: &StressRow| Some((row.position.0, row.exact.map(|Number(stress)| stress)?));
        run.stress.iter().filter_map(point).collect()
    };
    panels(scene, mass, runs, "position *x* [m]", &Axis::linear("stress *σ* [Pa]"), curve, &exact)
}

fn panels(
    scene: &str,
    mass: &str,
    runs: &[RunRecord],
    x: &str,
    y: &Axis,
    curve: impl Fn(&RunRecord) -> Vec<(f64, f64)>,
    exact: &dyn Fn(&RunRecord) -> ExactLine,
) -> Figure {
    let mut penalties: Vec<f64> = runs.iter().map(|run| run.stiffness_penalty).collect();
    penalties.dedup();
    let panel = |beta_s: &f64| {
        let of_panel: Vec<&RunRecord> = runs.iter().filter(|run| run.stiffness_penalty == *beta_s).collect();
        let mut layers = Vec::new();
        for run in &of_panel {
            let (points, label) = (curve(run), Some(literal(run.scheme)));
            // A run without contact has no line in a chart of penetrations.
            if points.iter().any(|(_, y)| y.is_finite()) {
                layers.push(Layer::Curve { points, label, style: style(run.scheme) });
            }
        }
        let points = of_panel.first().map_or_else(Vec::new, |run| exact(run));
        if !points.is_empty() {
            layers.push(Layer::Exact { points, label: Some("exact".to_owned()) });
        }
        let title =
            format!("{}, {}, *β*_{{s}} = {}", literal(&scene_name(scene)), literal(mass), number(*beta_s));
        Panel::new(Axis::linear(x), y.clone(), layers).titled(title)
    };
    let panels: Vec<Panel> = penalties.iter().map(panel).filter(|panel| !panel.layers.is_empty()).collect();
    let width = if panels.len() == 1 { Width::Single } else { Width::Double };
    let mut figure = Figure::new(width, panels);
    figure.columns = figure.columns.min(2);
    figure.naming = super::Naming::Legend;
    figure
}

/// Central differences chatter on a stiff contact: they stay grey behind the other schemes.
fn style(scheme: &str) -> usize {
    const LIGHT_GREY: usize = 8;
    match scheme {
        "central difference" => LIGHT_GREY,
        "predictor-corrector" => 0,
        _ => 1,
    }
}
