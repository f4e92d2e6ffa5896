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
fn without_onsets(lines: &[Vec<(f64, f64)>]) -> Option<(f64, f64)> {
    /// A hundredth of the values of a line.
    const FEW: usize = 100;
    let ends = lines.iter().filter_map(|line| {
        let mut values: Vec<f64> = line.iter().map(|point| point.1).filter(|y| *y > 0.0).collect();
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
                    Some(lines) => layers.extend(lines.map(|line| Layer::curve(line, &*name, style))),
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
        let lines: Vec<Vec<(f64, f64)>> = of_panel.iter().map(|run| curve(run).0).collect();
        let y = match y.scale {
            Scale::Log => Axis { range: without_onsets(&lines), ..y.clone() },
            Scale::Linear => y.clone(),
        };
        Panel::new(Axis::linear(x), y, layers).titled(title)
    };
    let panels: Vec<Panel> = groups.iter().map(panel).filter(|panel| !panel.layers.is_empty()).collect();
    let width = if panels.len() == 1 { Width::Single } else { Width::Double };
    let mut figure = Figure::new(width, panels);
    figure.columns = figure.columns.min(2);
    figure.naming = figure::Naming::Legend;
    if runs.iter().any(|run| envelope(&curve(run).0, y.scale).is_some()) {
        let pairs = "pairs: range of swings";
        figure.key = vec![Layer::curve(Vec::new(), pairs, LIGHT_GREY)];
    }
    figure
}

/// The style of what swings behind the others.
const LIGHT_GREY: usize = 8;

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

/// A line twice, apart where it swings more often than print can tell: there by its least and its largest values, since a
/// block of ink would hide what lies behind it and say no more. `None` where all its swings can be seen.
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
    let turns = turns(points, scale, |x| part(x, PARTS), PARTS);
    // Two turns a swing.
    let is_dense = |x: f64| turns[part(x, PARTS)] * PARTS > 2 * MOST;
    if !points.iter().any(|point| is_dense(point.0)) {
        return None;
    }
    Some([f64::min, f64::max].map(|of: fn(f64, f64) -> f64| {
        let mut line: Vec<(f64, f64)> = Vec::new();
        let mut window = None;
        for (x, y) in points {
            let here = is_dense(*x).then(|| part(*x, MOST));
            match line.last_mut() {
                // The smaller, and the larger, of a number and NaN is the number.
                Some(end) if here.is_some() && here == window => end.1 = of(end.1, *y),
                _ => line.push((*x, *y)),
            }
            window = here;
        }
        line
    }))
}

/// How often a line turns in each of the parts; turns by less than the width of a line are none.
fn turns(points: &[(f64, f64)], scale: Scale, part: impl Fn(f64) -> usize, parts: usize) -> Vec<usize> {
    let height = |y: f64| if scale == Scale::Log { y.ln() } else { y };
    let finite = || points.iter().filter(|point| point.1.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
        (low.min(height(point.1)), high.max(height(point.1)))
    });
    let mut turns = vec![0_usize; parts];
    // The last turning point, and whether the line rises from the one before.
    let (mut turn, mut rises) = (f64::NAN, None);
    for point in finite() {
        let y = height(point.1);
        match rises {
            Some(up) if (y >= turn) == up => turn = y,
            _ if (y - turn).abs() > LINE * (high - low) => {
                turns[part(point.0)] += usize::from(rises.is_some());
                (turn, rises) = (y, Some(y > turn));
            }
            _ if turn.is_nan() => turn = y,
            _ => (),
        }
    }
    turns
}

/// Central differences chatter on a stiff contact: they stay grey and thin behind the others. The schemes of the paper lead; each of
/// the others has a style of its own.
fn style(scheme: Facts) -> usize {
    let place = SchemeName::ALL.iter().position(|known| known.name() == scheme.name);
    match place {
        Some(0) => LIGHT_GREY,
        // Predictor-corrector and Park are the second and the third.
        Some(place) => place - 1,
        None if scheme.gains_nothing => 0,
        None => LIGHT_GREY + 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Smooth at first, then with so many swings from 0 to 2.
    fn swinging(swings: f64) -> Vec<(f64, f64)> {
        let wave = |x: f64| 1.0 - (std::f64::consts::TAU * 2.0 * swings * (x - 0.5)).cos();
        (0..=20_000)
            .map(|i| f64::from(i) / 20_000.0)
            .map(|x| (x, if x < 0.5 { 0.0 } else { wave(x) }))
            .collect()
    }

    #[test]
    fn dense_swings_become_their_envelope_and_the_rest_stays() {
        // Half the panel with 50 swings has them 0.7 mm apart, with 500 too dense.
        assert!(envelope(&swinging(50.0), Scale::Linear).is_none());
        let points = swinging(500.0);
        let [low, high] = envelope(&points, Scale::Linear).expect("dense");
        for (i, line) in [&low, &high].into_iter().enumerate() {
            assert!(line[..10_000] == points[..10_000], "the smooth half");
            let rest: Vec<f64> = line.iter().filter(|p| p.0 > 0.51).map(|p| p.1).collect();
            assert!(rest.len() < 80 && rest.iter().all(|y| (y - 2.0 * i as f64).abs() < 1e-2), "{rest:?}");
        }
        // Rounding is no swing.
        let noise: Vec<(f64, f64)> =
            (0..2000_i32).map(|i| (f64::from(i), f64::from(i) + 1e-9 * f64::from(i % 2))).collect();
        assert!(envelope(&noise, Scale::Linear).is_none());
    }

    #[test]
    fn the_onset_of_contact_makes_no_axis() {
        let points =
            (0..1000).map(|i| (f64::from(i), if i < 3 { 1e-13 } else { 1e-3 + 1e-6 * f64::from(i) }));
        let (low, high) = without_onsets(&[points.collect()]).expect("two values");
        assert!(low > 0.9e-3 && high < 2.2e-3, "{low} {high}");
    }
}
