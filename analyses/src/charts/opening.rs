//! Where linear stability is not enough: the energy gained from contact that opens and closes, made of records only.

use super::maps::{limit_name, scene_name};
use crate::record::OpeningRow;
use figure::{At, Axis, ColourBar, ColourMap, Figure, Layer, Naming, Panel, Side, Width, literal};

/// Gains below the first have the darkest colour, those above the second the lightest; the colour bar has points there.
const SHOWN: (f64, f64) = (1e-4, 1e2);

/// Where a chart of gains shows that there is none: below all that it shows otherwise.
const NONE: f64 = 0.1 * SHOWN.0;

const GAIN: &str = "energy gained / put in";
const STEP: &str = "step / linear limit";

/// Whether there are enough ratios and steps for a map.
pub fn is_map(rows: &[OpeningRow]) -> bool {
    let finite = rows.iter().map(|row| row.ratio.0).filter(|ratio| ratio.is_finite());
    distinct(finite).len() > 1 && distinct(rows.iter().map(fraction)).len() > 1
}

/// The largest gain over all loads and beta_s for the rows of one scene and mass, which must make a map: as colour over step and r, one panel
/// a scheme, and for the pure penalty method, which has no place on the axis of r, as curves over the step. What is out of
/// the range shown is drawn at its end, and what gains nothing is shaded, or drawn at 0.
pub fn gain_maps(rows: &[OpeningRow]) -> Figure {
    let schemes = distinct_schemes(rows);
    let mut panels: Vec<Panel> = schemes.iter().map(|scheme| map_of(rows, scheme)).collect();
    let pure: Vec<&OpeningRow> = rows.iter().filter(|row| row.ratio.0.is_infinite()).collect();
    if let Some(first) = pure.first() {
        let layer = |(style, scheme): (usize, &&str)| {
            let of_scheme: Vec<&OpeningRow> =
                pure.iter().filter(|row| row.scheme == *scheme).copied().collect();
            let steps = distinct(of_scheme.iter().map(|row| fraction(row)));
            let points =
                steps.into_iter().map(|at| (at, largest_gain(&of_scheme, |row| fraction(row) == at)));
            let points =
                points.map(|(at, gain)| (at, if gain <= 0.0 { NONE } else { gain.clamp(SHOWN.0, SHOWN.1) }));
            let label = Some(literal(&limit_name(scheme)));
            Layer::Markers { points: points.collect(), label, style, joined: true, source: None }
        };
        let mut layers: Vec<Layer> = schemes.iter().enumerate().map(layer).collect();
        if let Some(elements) = first.elements {
            let counts = At::Y(1.0 / elements as f64);
            layers.push(Layer::Rule { at: counts, label: Some("one element".to_owned()) });
        }
        let y = Axis::log(GAIN).over(NONE / 2.0, 2.0 * SHOWN.1).named(NONE, "0");
        let y = y.named(SHOWN.0, "≤ 10^{−4}").named(SHOWN.1, "≥ 10^{2}");
        panels.push(
            Panel::new(Axis::linear(STEP).over(0.0, 1.0), y, layers).titled(title(rows, "pure penalty")),
        );
    }
    let mut figure = Figure::new(Width::Double, panels);
    figure.columns = 2;
    figure.naming = Naming::Legend;
    let none = Some("no gain".to_owned());
    figure.key = vec![Layer::Shade { points: Vec::new(), side: Side::Below, label: none, source: None }];
    let axis = Axis::log(GAIN).over(SHOWN.0, SHOWN.1);
    figure.colour_bar = Some(ColourBar { axis, map: ColourMap::Viridis });
    figure
}

/// The map of one scheme over the finite ratios.
fn map_of(rows: &[OpeningRow], scheme: &str) -> Panel {
    let of_scheme: Vec<&OpeningRow> =
        rows.iter().filter(|row| row.scheme == scheme && row.ratio.0.is_finite()).collect();
    let x = distinct(of_scheme.iter().map(|row| fraction(row)));
    let y = distinct(of_scheme.iter().map(|row| row.ratio.0));
    let at =
        |ratio: f64, step: f64| largest_gain(&of_scheme, |row| row.ratio.0 == ratio && fraction(row) == step);
    let values = y.iter().flat_map(|ratio| x.iter().map(|step| at(*ratio, *step))).collect();
    let (low, high) = edges(&x);
    let (least, most) = edges(&y.iter().map(|ratio| ratio.ln()).collect::<Vec<_>>());
    let across = Axis::linear(STEP).over(low.max(0.0), high.min(1.0));
    let up = Axis::log("penalty ratio *r*").over(least.exp(), most.exp());
    let title = title(rows, &limit_name(scheme));
    Panel::new(across, up, vec![Layer::Cells { x, y, values }]).titled(title)
}

/// Half a cell beyond the first and the last of at least two centres.
fn edges(centres: &[f64]) -> (f64, f64) {
    let last = centres.len() - 1;
    (1.5 * centres[0] - 0.5 * centres[1], 1.5 * centres[last] - 0.5 * centres[last - 1])
}

/// The largest gain of the rows that are `wanted`, 0 where nothing is gained; NaN if there is none.
fn largest_gain(rows: &[&OpeningRow], wanted: impl Fn(&OpeningRow) -> bool) -> f64 {
    let gains = rows.iter().filter(|row| wanted(row)).map(|row| row.energy_gain.0);
    gains.filter(|gain| !gain.is_nan()).map(|gain| gain.max(0.0)).fold(f64::NAN, f64::max)
}

/// C/C_limit to nine digits, so that the same fraction of different limits is one column.
fn fraction(row: &OpeningRow) -> f64 {
    (1e9 * row.relative_courant.0 / row.predicted.0).round() / 1e9
}

/// The values in increasing order, each once.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The schemes in the order of the rows.
fn distinct_schemes(rows: &[OpeningRow]) -> Vec<&'static str> {
    let mut schemes: Vec<&str> = rows.iter().map(|row| row.scheme).collect();
    schemes.dedup();
    schemes
}

fn title(rows: &[OpeningRow], what: &str) -> String {
    let row = &rows[0];
    literal(&format!("{}, {}, {what}", scene_name(&row.scene), row.mass))
}
