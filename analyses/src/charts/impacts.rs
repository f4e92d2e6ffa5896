//! Charts of contact-impact runs, made of records only: one figure a quantity, one panel a stiffness penalty, one
//! curve a scheme, the exact solution in black.

use super::maps::{number, scene_name};
use crate::record::{HistoryRow, Number, StressRow};
use bipenalty::schemes::{ContactSearch, Facts};
use figure::{Axis, Figure, Layer, Panel, Source, Width, literal};

/// The records of one run, as the charts need them.
#[derive(Debug, Clone)]
pub struct RunRecord {
    /// beta_s.
    pub stiffness_penalty: f64,
    /// The scheme.
    pub scheme: Facts,
    /// The history of one contact.
    pub history: Vec<HistoryRow>,
    /// What the file of the history is called, without ending.
    pub history_stem: String,
    /// The stress at the chosen times.
    pub stress: Vec<StressRow>,
    /// What the file of the stress is called, without ending.
    pub stress_stem: String,
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

    /// Whether it belongs to a contact, not to the bars.
    pub fn is_of_contact(self) -> bool {
        self != Self::Energy
    }

    /// The axis; a contact that is one of several is named by its number.
    fn axis(self, contact: Option<usize>) -> Axis {
        let index = contact.map_or_else(String::new, |number| format!("_{{{number}}}"));
        match self {
            Self::Force => Axis::linear(format!("contact force *λ*{index} [N]")),
            Self::Gap => Axis::log(format!("penetration *g*{index} / *h*")),
            Self::Energy => Axis::linear("kinetic + strain energy [J]"),
        }
    }

    /// The column that holds it; the energy is a sum of two.
    fn column(self) -> Option<&'static str> {
        match self {
            Self::Force => Some("contact_force"),
            Self::Gap => Some("relative_gap"),
            Self::Energy => None,
        }
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

/// One quantity over time; `contact` is the number, from 1 at the left, of a contact that is one of several.
pub fn histories(
    scene: &str,
    mass: &str,
    runs: &[RunRecord],
    (quantity, contact): (Quantity, Option<usize>),
    exact: &ExactLine,
) -> Figure {
    let curve = |run: &RunRecord| {
        let points: Vec<_> = run.history.iter().map(|row| (row.time.0, quantity.value(row))).collect();
        // A gap in the line is none in the column.
        let whole = points.iter().all(|(_, value)| value.is_finite());
        let column = quantity.column().filter(|_| whole);
        let source = column.and_then(|column| source(&run.history_stem, ["time", column], points.len()));
        (points, source)
    };
    panels(scene, mass, runs, "time *t* [s]", &quantity.axis(contact), curve, exact)
}

/// The stress along the bars at the time of the rows, beside the `exact` one at that time.
pub fn stresses(scene: &str, mass: &str, runs: &[RunRecord], exact: &ExactLine) -> Figure {
    let curve = |run: &RunRecord| {
        let points: Vec<_> = run.stress.iter().map(|row| (row.position.0, row.stress.0)).collect();
        let source = source(&run.stress_stem, ["position", "stress"], points.len());
        (points, source)
    };
    let time = runs.iter().find_map(|run| run.stress.first()).map_or_else(String::new, |row| {
        // The time of a step carries the rounding of its size.
        let Number(time) = row.time;
        format!(", *t* = {} s", number(format!("{time:.3e}").parse().unwrap_or(time)))
    });
    let position = format!("position *x* [m]{time}");
    panels(scene, mass, runs, &position, &Axis::linear("stress *σ* [Pa]"), curve, exact)
}

/// All rows of the file `stem`.
fn source(stem: &str, columns: [&'static str; 2], rows: usize) -> Option<Source> {
    Source::of(&format!("{stem}.csv"), columns, &(0..rows).collect::<Vec<_>>())
}

fn panels(
    scene: &str,
    mass: &str,
    runs: &[RunRecord],
    x: &str,
    y: &Axis,
    curve: impl Fn(&RunRecord) -> (Vec<(f64, f64)>, Option<Source>),
    exact: &ExactLine,
) -> Figure {
    let mut penalties: Vec<f64> = runs.iter().map(|run| run.stiffness_penalty).collect();
    penalties.dedup();
    let panel = |beta_s: &f64| {
        let of_panel: Vec<&RunRecord> = runs.iter().filter(|run| run.stiffness_penalty == *beta_s).collect();
        let mut layers = Vec::new();
        for run in &of_panel {
            let (points, source) = curve(run);
            // A run without contact has no line in a chart of penetrations.
            if points.iter().any(|(_, y)| y.is_finite()) {
                let layer = Layer::curve(points, literal(run.scheme.title), style(run.scheme));
                layers.push(layer.from_records(source));
            }
        }
        if !exact.is_empty() {
            layers.push(Layer::Exact { points: exact.clone(), label: Some("exact".to_owned()) });
        }
        let title =
            format!("{}, {}, *β*_{{s}} = {}", literal(&scene_name(scene)), literal(mass), number(*beta_s));
        Panel::new(Axis::linear(x), y.clone(), layers).titled(title)
    };
    let panels: Vec<Panel> = penalties.iter().map(panel).filter(|panel| !panel.layers.is_empty()).collect();
    let width = if panels.len() == 1 { Width::Single } else { Width::Double };
    let mut figure = Figure::new(width, panels);
    figure.columns = figure.columns.min(2);
    figure.naming = figure::Naming::Legend;
    figure
}

/// A scheme that looks for contact only at the start of a step chatters on a stiff one: it stays grey behind the others, and
/// the one that is proven to gain nothing leads.
fn style(scheme: Facts) -> usize {
    const LIGHT_GREY: usize = 8;
    match (scheme.search, scheme.gains_nothing) {
        (ContactSearch::StartOfStep, _) => LIGHT_GREY,
        (ContactSearch::Predictor, true) => 0,
        (ContactSearch::Predictor, false) => 1,
    }
}
