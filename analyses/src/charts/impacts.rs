//! Charts of contact-impact runs, made of records only: one figure a quantity, one panel a stiffness penalty, one
//! curve a scheme, the exact solution in black.

use super::maps::{number, scene_name};
use crate::record::{HistoryRow, Number, StressRow};
use bipenalty::schemes::{Facts, SchemeName};
use figure::{Axis, Figure, Layer, Panel, Scale, Source, Width, literal};

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
    /// The largest g of all contacts over time while it is a penetration, m, logarithmic.
    LargestGap,
    /// Kinetic and strain energy over time, J.
    Energy,
}

impl Quantity {
    /// Those of impacts of matrices and meshes.
    pub const OF_MANY: [(&'static str, Self); 3] =
        [("force", Self::Force), ("gap", Self::LargestGap), ("energy", Self::Energy)];

    /// Those of bars, with the names of their files.
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
            Self::LargestGap => Axis::log("largest penetration *g* [m]"),
            Self::Energy => Axis::linear("kinetic + strain energy [J]"),
        }
    }

    /// The column that holds it; the energy is a sum of two.
    fn column(self) -> Option<&'static str> {
        match self {
            Self::Force => Some("contact_force"),
            Self::Gap => Some("relative_gap"),
            Self::LargestGap => Some("largest_gap"),
            Self::Energy => None,
        }
    }

    /// What is drawn of a row; NaN leaves a gap in the line.
    fn value(self, row: &HistoryRow) -> f64 {
        match self {
            Self::Force => row.contact_force.0,
            Self::Gap | Self::LargestGap if row.relative_gap.0 > 0.0 => row.relative_gap.0,
            Self::Gap | Self::LargestGap => f64::NAN,
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

/// The ends of a logarithmic axis of these lines, without the few values of each, a step or two, at which contact only begins
/// or ends: they may be as small as rounding, and would leave no room for the others.
fn without_onsets(layers: &[Layer]) -> Option<(f64, f64)> {
    /// A hundredth of the values of a line.
    const FEW: usize = 100;
    let ends = layers.iter().filter_map(|layer| {
        let mut values: Vec<f64> = layer.points().iter().map(|point| point.1).filter(|y| *y > 0.0).collect();
        values.sort_by(f64::total_cmp);
        Some((*values.get(values.len() / FEW)?, *values.last()?))
    });
    let (low, high) = ends.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))?;
    // As much air as an axis has whose ends come from all values.
    let air = (high / low).powf(0.05);
    (low < high).then_some((low / air, high * air))
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
    let of = |beta_s: f64| runs.iter().filter(move |run| run.stiffness_penalty == beta_s);
    let same = |one: f64, other: f64| {
        of(one).count() == of(other).count()
            && of(one).zip(of(other)).all(|(a, b)| look_alike(&curve(a).0, &curve(b).0, y.scale))
    };
    // One panel for all penalties that look alike, such as the stiff ones.
    let mut groups: Vec<Vec<f64>> = Vec::new();
    for beta_s in penalties {
        match groups.iter_mut().find(|group| same(group[0], beta_s)) {
            Some(group) => group.push(beta_s),
            None => groups.push(vec![beta_s]),
        }
    }
    let panel = |group: &Vec<f64>| {
        let of_panel: Vec<&RunRecord> = of(group[0]).collect();
        let mut layers = Vec::new();
        for run in &of_panel {
            let (points, source) = curve(run);
            // A run without contact has no line in a chart of penetrations.
            if points.iter().any(|(_, y)| y.is_finite()) {
                let (name, style) = (literal(run.scheme.title), style(run.scheme));
                match envelope(&points, y.scale) {
                    // Equal names and styles: one entry of the legend for both.
                    Some(lines) => layers
                        .extend(lines.map(|line| Layer::curve(line, format!("{name} (envelope)"), style))),
                    None => layers.push(Layer::curve(points, name, style).from_records(source)),
                }
            }
        }
        if !exact.is_empty() {
            layers.push(Layer::Exact { points: exact.clone(), label: Some("exact".to_owned()) });
        }
        let numbers: Vec<String> = group.iter().map(|beta_s| number(*beta_s)).collect();
        let title =
            format!("{}, {}, *β*_{{s}} = {}", literal(&scene_name(scene)), literal(mass), numbers.join(", "));
        let y = if y.scale == Scale::Log {
            Axis { range: without_onsets(&layers), ..y.clone() }
        } else {
            y.clone()
        };
        Panel::new(Axis::linear(x), y, layers).titled(title)
    };
    let panels: Vec<Panel> = groups.iter().map(panel).filter(|panel| !panel.layers.is_empty()).collect();
    let width = if panels.len() == 1 { Width::Single } else { Width::Double };
    let mut figure = Figure::new(width, panels);
    figure.columns = figure.columns.min(2);
    figure.naming = figure::Naming::Legend;
    figure
}

/// The width of a line as a share of the height of a chart.
const LINE: f64 = 0.005;

/// Whether two lines differ by less than the width of a line anywhere: half a hundredth of the height of a chart, over
/// whose decades `scale` may spread it.
fn look_alike(one: &[(f64, f64)], other: &[(f64, f64)], scale: Scale) -> bool {
    let finite = || one.iter().map(|point| point.1).filter(|y| y.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let close = |a: f64, b: f64| match scale {
        Scale::Linear => (a - b).abs() <= LINE * (high - low),
        Scale::Log => (a / b).ln().abs() <= LINE * (high / low).ln(),
    };
    one.len() == other.len()
        && one
            .iter()
            .zip(other)
            .all(|(a, b)| a.0 == b.0 && (close(a.1, b.1) || (a.1.is_nan() && b.1.is_nan())))
}

/// The least and the largest values of a line that swings more often than print can tell apart: a block of ink would hide
/// what lies behind it and say no more. `None` where its swings can be seen.
fn envelope(points: &[(f64, f64)], scale: Scale) -> Option<[Vec<(f64, f64)>; 2]> {
    /// Swings that a panel of half a page, 70 mm, shows half a millimetre apart: three thin lines and their gaps.
    const MOST: usize = 140;
    /// Parts of the panel in each of which they are counted.
    const PARTS: usize = 20;
    let (first, last) = (points.first()?.0, points.last()?.0);
    let part = |x: f64, parts: usize| {
        // Between 0 and `parts`, so that the cast drops the fraction.
        (((x - first) / (last - first) * parts as f64) as usize).min(parts - 1)
    };
    let height = |y: f64| if scale == Scale::Log { y.ln() } else { y };
    let finite = || points.iter().filter(|point| point.1.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
        (low.min(height(point.1)), high.max(height(point.1)))
    });
    let mut turns = [0_usize; PARTS];
    // The last turning point and whether the line rises from there: turns by less than a line's width are none.
    let (mut turn, mut rises) = (f64::NAN, None);
    for point in finite() {
        let y = height(point.1);
        match rises {
            Some(up) if (y >= turn) == up => turn = y,
            _ if (y - turn).abs() > LINE * (high - low) => {
                turns[part(point.0, PARTS)] += usize::from(rises.is_some());
                (turn, rises) = (y, Some(y > turn));
            }
            _ if turn.is_nan() => turn = y,
            _ => (),
        }
    }
    // Two turns a swing.
    if turns.iter().max()? * PARTS <= 2 * MOST {
        return None;
    }
    let mut lines = [f64::min, f64::max].map(|of: fn(f64, f64) -> f64| {
        let mut line: Vec<(f64, f64)> =
            (0..MOST).map(|i| (first + (i as f64 + 0.5) / MOST as f64 * (last - first), f64::NAN)).collect();
        for (x, y) in finite() {
            // The smaller, and the larger, of a number and NaN is the number.
            let end = &mut line[part(*x, MOST)].1;
            *end = of(*end, *y);
        }
        line
    });
    lines.iter_mut().for_each(|line| line[MOST - 1].0 = last);
    Some(lines)
}

/// Central differences chatter on a stiff contact: they stay grey and thin behind the others. The schemes of the paper lead; each of
/// the others has a style of its own.
fn style(scheme: Facts) -> usize {
    const LIGHT_GREY: usize = 8;
    let place = SchemeName::ALL.iter().position(|known| known.name() == scheme.name);
    match place {
        Some(0) => LIGHT_GREY,
        // Predictor-corrector and Park are the second and the third.
        Some(place) => place - 1,
        None if scheme.gains_nothing => 0,
        None => LIGHT_GREY + 1,
    }
}
