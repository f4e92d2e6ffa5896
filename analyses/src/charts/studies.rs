//! Errors, oscillations and cost of impacts, made of records only.

use super::maps::number;
use crate::record::{Number, StudyRow};
use bipenalty::schemes::SchemeName;
use figure::{At, Axis, Figure, Layer, Naming, Panel, ROUND, Width, literal};

/// Errors below are drawn here: they are rounding.
const LEAST: f64 = 1e-15;

const FORCE_ERROR: &str = "rms force error";

/// A line of a chart: one scheme at one ratio.
type Line = (&'static str, f64);

/// The lines in the order of the rows.
fn lines(rows: &[StudyRow]) -> Vec<Line> {
    let mut found: Vec<Line> = Vec::new();
    for row in rows {
        let line = (row.scheme, row.ratio.0);
        if !found.contains(&line) {
            found.push(line);
        }
    }
    found
}

/// The colour and shape of a scheme, filled or open at another ratio than 1.
fn style((scheme, ratio): Line) -> usize {
    let place = SchemeName::ALL.iter().position(|known| known.name() == scheme).unwrap_or(0);
    if ratio == 1.0 { place } else { place + ROUND }
}

fn title((scheme, ratio): Line, all: &[Line]) -> String {
    let found = SchemeName::ALL.iter().find(|known| known.name() == scheme);
    let name = literal(found.map_or(scheme, |known| known.facts().title));
    let several = all.iter().filter(|line| line.0 == scheme).count() > 1;
    if several { format!("{name}, *r* = {}", number(ratio)) } else { name }
}

/// One line a scheme and ratio over x.
fn panel(
    rows: &[StudyRow],
    (x, x_of): (Axis, impl Fn(&StudyRow) -> Option<f64>),
    (y, y_of): (Axis, impl Fn(&StudyRow) -> Option<Number>),
) -> Panel {
    let all = lines(rows);
    let layer = |line: &Line| {
        let of = rows.iter().filter(|row| (row.scheme, row.ratio.0) == *line);
        let points: Vec<_> = of.filter_map(|row| Some((x_of(row)?, y_of(row)?.0.abs().max(LEAST)))).collect();
        Layer::Markers {
            points,
            label: Some(title(*line, &all)),
            style: style(*line),
            joined: true,
            source: None,
        }
    };
    let layers: Vec<Layer> = all.iter().map(layer).filter(|layer| !layer.points().is_empty()).collect();
    Panel::new(x, y, layers)
}

fn figure(panels: Vec<Panel>, columns: usize) -> Figure {
    let mut figure = Figure::new(Width::Double, panels);
    figure.columns = columns;
    figure.naming = Naming::Legend;
    figure
}

/// Errors of force and impulse over the number of cells along the block.
pub fn cells(rows: &[StudyRow]) -> Figure {
    let x = || Axis::log("cells along the block");
    let cells = |row: &StudyRow| Some(row.cells as f64);
    figure(
        vec![
            panel(rows, (x(), cells), (Axis::log(FORCE_ERROR), |row: &StudyRow| row.force_error)),
            panel(rows, (x(), cells), (Axis::log("impulse error"), |row: &StudyRow| row.impulse_error)),
        ],
        2,
    )
}

/// Force error, total variation and gap over beta_s.
pub fn penalty(rows: &[StudyRow]) -> Figure {
    let x = || Axis::log("stiffness penalty *β*_{s}");
    let beta_s = |row: &StudyRow| Some(row.stiffness_penalty.0);
    let variation = Axis::log("total variation / exact");
    let gap = Axis::log("steady |*g*| / *h*");
    figure(
        vec![
            panel(rows, (x(), beta_s), (Axis::log(FORCE_ERROR), |row: &StudyRow| row.force_error)),
            panel(rows, (x(), beta_s), (variation, |row: &StudyRow| row.variation)),
            panel(rows, (x(), beta_s), (gap, |row: &StudyRow| row.steady_relative_gap)),
        ],
        3,
    )
}

/// Largest force over total variation, one marker a scheme, a panel a ratio: a force without oscillations stands at (1, 1).
pub fn oscillation(rows: &[StudyRow]) -> Figure {
    let mut ratios: Vec<f64> = rows.iter().map(|row| row.ratio.0).collect();
    ratios.dedup();
    let panel = |ratio: &f64| {
        let of: Vec<&StudyRow> = rows.iter().filter(|row| row.ratio.0 == *ratio).collect();
        let layer = |row: &&StudyRow| {
            let point = (row.variation?.0, 1.0 + row.overshoot?.0);
            let line = (row.scheme, 1.0);
            Some(Layer::markers(vec![point], title(line, &[line]), style(line)))
        };
        let mut layers = vec![Layer::Rule { at: At::Y(1.0), label: None }];
        layers.extend(of.iter().filter_map(layer));
        let x = Axis::log("total variation / exact");
        Panel::new(x, Axis::log("largest force / exact"), layers).titled(format!("*r* = {}", number(*ratio)))
    };
    figure(ratios.iter().map(panel).collect(), 3)
}

/// Errors of force and impulse against run time.
pub fn cost(rows: &[StudyRow]) -> Figure {
    let x = || Axis::log("time of the steps [s]");
    let seconds = |row: &StudyRow| row.seconds.map(|seconds| seconds.0);
    figure(
        vec![
            panel(rows, (x(), seconds), (Axis::log(FORCE_ERROR), |row: &StudyRow| row.force_error)),
            panel(rows, (x(), seconds), (Axis::log("impulse error"), |row: &StudyRow| row.impulse_error)),
        ],
        2,
    )
}
