//! What a scheme costs over the penalty: how far one evaluation of the internal force gets.

use super::maps::{STIFFNESS, limit_name, line, mass_name, number, scene_name};
use super::units::STIFFNESS as SI_STIFFNESS;
use crate::record::{CostRow, Number};
use bipenalty::schemes::explicit::ExplicitName;
use figure::{Axis, Figure, Layer, Naming, Panel, Width, literal};

const PER_FORCE: &str = "relative step per force";
const STEP_PER_FORCE: &str = "step per force (s)";
/// Costs that stay below this are compared on a linear axis from 0, larger ones on a logarithmic one.
const CHEAP: f64 = 5.0;

/// The step at the limit over the forces it takes, relative to central differences without contact, over beta_s: one panel a
/// ratio and one curve a scheme; in SI units in s over N/m. All `rows` are of one model; ratio by ratio within a scheme.
pub fn per_force(rows: &[CostRow], log: bool, si: bool) -> Figure {
    let mut schemes: Vec<&CostRow> = Vec::new();
    let mut ratios: Vec<f64> = Vec::new();
    for row in rows {
        if !schemes.iter().any(|known| same_scheme(known, row)) {
            schemes.push(row);
        }
        if !ratios.contains(&row.ratio.0) {
            ratios.push(row.ratio.0);
        }
    }
    let panel = |ratio: &f64| {
        let of_ratio = || rows.iter().filter(|row| row.ratio.0 == *ratio);
        let curve = |(style, scheme): (usize, &&CostRow)| {
            let of = of_ratio().filter(|row| same_scheme(row, scheme));
            let shown = of.filter(|row| !log || row.stiffness_penalty.0 > 0.0);
            let point = |row: &CostRow| {
                let of = |value: Option<Number>| value.map_or(f64::NAN, |value| value.0);
                match si {
                    true => (of(row.penalty_stiffness), of(row.step_per_force)),
                    false => (row.stiffness_penalty.0, of(row.cost).recip()),
                }
            };
            let mut points: Vec<(f64, f64)> = shown.map(point).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            line(points, name(scheme), style)
        };
        let layers: Vec<Layer> = schemes.iter().enumerate().map(curve).collect();
        let costs = of_ratio().filter_map(|row| row.cost).map(|cost| cost.0);
        let (stiffness, step) = if si { (SI_STIFFNESS, STEP_PER_FORCE) } else { (STIFFNESS, PER_FORCE) };
        let y = match costs.fold(0.0, f64::max) {
            most if most > CHEAP => Axis::log(step),
            _ if si => Axis::linear(step).over(0.0, 1.05 * longest(rows)),
            _ => Axis::linear(step).over(0.0, 1.05),
        };
        let x = if log { Axis::log(stiffness) } else { Axis::linear(stiffness) };
        Panel::new(x, y, layers).titled(format!("{}*r* = {}", subject(rows), number(*ratio)))
    };
    let panels: Vec<Panel> = ratios.iter().map(panel).collect();
    let width = if panels.len() == 1 { Width::Single } else { Width::Double };
    let mut figure = Figure::new(width, panels);
    figure.columns = figure.columns.min(3);
    figure.naming = Naming::Legend;
    figure
}

/// The largest step per force, s.
fn longest(rows: &[CostRow]) -> f64 {
    rows.iter().filter_map(|row| row.step_per_force).map(|step| step.0).fold(0.0, f64::max)
}

/// Whether two rows are of one curve, at whatever penalties.
fn same_scheme(one: &CostRow, other: &CostRow) -> bool {
    (one.limit, one.parameter) == (other.limit, other.parameter)
}

/// A scheme with its parameter and the forces of a step.
fn name(row: &CostRow) -> String {
    let symbol = row.limit.parse::<ExplicitName>().map_or("*θ*", |scheme| match scheme.facts().parameter {
        "beta" => "*β*",
        "phi" => "*φ*",
        "rho_b" => "*ρ*_{b}",
        _ => "*p*",
    });
    let four_digits = |value: f64| number((1e4 * value).round() / 1e4);
    let parameter = row.parameter.map(|value| format!(" ({symbol} = {})", four_digits(value.0)));
    let forces =
        if row.evaluations == 1 { "1 force".to_owned() } else { format!("{} forces", row.evaluations) };
    let bound = if row.critical_courant.is_none() && row.lower.is_some() { ", lower bound" } else { "" };
    format!("{}{}, {forces}{bound}", literal(&limit_name(row.limit)), parameter.unwrap_or_default())
}

/// Scene and mass, to stand before the ratio.
fn subject(rows: &[CostRow]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    literal(&format!("{}{}, ", scene_name(&row.scene), mass_name(&row.mass)))
}
