//! Where linear stability is not enough: the energy gained from contact that opens and closes, made of records only.

use super::charts::{limit_name, scene_name};
use super::{Axis, ColourBar, ColourMap, Figure, Layer, Panel, Width, literal};
use crate::record::OpeningRow;

/// Gains below this have the darkest colour, above the second the lightest.
const COLOURS: (f64, f64) = (1e-4, 1e2);

/// The largest gain over all loads and beta_s as colour over C/C_limit and r: the rows of one scene and mass, one panel a
/// scheme. The pure penalty method, r = inf, has no place on the axis.
pub fn gain_maps(rows: &[OpeningRow]) -> Figure {
    let mut schemes: Vec<&str> = rows.iter().map(|row| row.scheme).collect();
    schemes.dedup();
    let panels = schemes.iter().map(|scheme| {
        let of_scheme: Vec<&OpeningRow> =
            rows.iter().filter(|row| row.scheme == *scheme && row.ratio.0.is_finite()).collect();
        let x = distinct(of_scheme.iter().map(|row| fraction(row)));
        let y = distinct(of_scheme.iter().map(|row| row.ratio.0));
        let value = |ratio: f64, at: f64| {
            let here = of_scheme.iter().filter(|row| row.ratio.0 == ratio && fraction(row) == at);
            here.map(|row| row.energy_gain.0.clamp(COLOURS.0, COLOURS.1)).fold(f64::NAN, f64::max)
        };
        let values = y.iter().flat_map(|r| x.iter().map(|f| value(*r, *f))).collect();
        Panel::new(
            Axis::linear("step / linear limit"),
            Axis::log("penalty ratio *r*"),
            vec![Layer::Cells { x, y, values }],
        )
        .titled(title(rows, scheme))
    });
    let mut figure = Figure::new(Width::Double, panels.collect());
    // Scene, mass and scheme together do not fit above a third of the page.
    let scene = rows.first().map_or(String::new(), |row| scene_name(&row.scene));
    let label = format!("{}: energy gained / put in", literal(&scene));
    let axis = Axis::log(label).over(COLOURS.0, COLOURS.1);
    figure.colour_bar = Some(ColourBar { axis, map: ColourMap::Viridis });
    figure
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

fn title(rows: &[OpeningRow], scheme: &str) -> String {
    literal(&format!("{}, {}", rows[0].mass, limit_name(scheme)))
}
