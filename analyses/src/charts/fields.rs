//! Pictures of a mesh at a few instants: the stress in the deformed bodies, pressure and gap along the contact surfaces.

use super::maps::number;
use crate::meshes::Direction;
use crate::record::SurfaceRow;
use figure::{Axis, ColourBar, ColourMap, Figure, Layer, Naming, Panel, Source, Width, literal};

/// The bodies at one instant.
#[derive(Debug, Clone)]
pub struct Instant {
    /// s.
    pub time: f64,
    /// The deformed elements, m.
    pub elements: Vec<Vec<(f64, f64)>>,
    /// What is shown of each, Pa.
    pub stress: Vec<f64>,
    /// The deformed edges of the bodies, m.
    pub outlines: Vec<Vec<(f64, f64)>>,
}

/// The stress on the deformed mesh, an instant a panel, all in the same place and with the same colours. Of a stress with a sign
/// they reach as far on both sides of 0. `factor` is what displacements are multiplied by.
pub fn stresses(instants: &[Instant], direction: Direction, factor: f64) -> Figure {
    let (mut x, mut y, mut most) = (EMPTY, EMPTY, 0.0_f64);
    for instant in instants {
        instant.elements.iter().flatten().for_each(|point| {
            x = (x.0.min(point.0), x.1.max(point.0));
            y = (y.0.min(point.1), y.1.max(point.1));
        });
        most = instant.stress.iter().fold(most, |most, stress| most.max(stress.abs()));
    }
    let air = 0.04 * (x.1 - x.0).max(y.1 - y.0);
    let times = if factor == 1.0 { String::new() } else { format!("{} ", number(factor)) };
    let axis = |name: &str, (low, high): (f64, f64)| {
        Axis::linear(format!("*{name}* + {times}*u*_{{{name}}} [m]")).over(low - air, high + air)
    };
    let panel = |instant: &Instant| {
        let Instant { time, elements, stress, outlines } = instant.clone();
        let layer = Layer::Patches { polygons: elements, values: stress, outlines };
        Panel::new(axis("x", x), axis("y", y), vec![layer]).titled(at(time))
    };
    let mut figure = Figure::new(Width::Double, instants.iter().map(panel).collect());
    // Higher or lower ones leave no room beside them, or for the numbers of their axes: the rest stays empty.
    figure.aspect = ((y.1 - y.0) / (x.1 - x.0)).clamp(0.25, 2.0);
    figure.columns = if figure.aspect < 0.4 { 1 } else { 3 };
    figure.equal = true;
    figure.tags = true;
    let signed = direction != Direction::None;
    // What has no stress at all has one colour.
    let most = if most > 0.0 { most } else { 1.0 };
    let axis = Axis::linear(label(direction)).over(if signed { -most } else { 0.0 }, most);
    let map = if signed { ColourMap::BlueRed } else { ColourMap::Viridis };
    figure.colour_bar = Some(ColourBar { axis, map });
    figure
}

const EMPTY: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

fn label(direction: Direction) -> String {
    match direction {
        Direction::None => "von Mises stress [Pa]".to_owned(),
        Direction::Normal([0.0, _]) => "normal stress *σ*_{yy} [Pa]".to_owned(),
        Direction::Normal([_, 0.0]) => "normal stress *σ*_{xx} [Pa]".to_owned(),
        Direction::Normal([x, y]) => format!("normal stress along ({x:.2}, {y:.2}) [Pa]").replace('-', "−"),
    }
}

/// Three digits, as short as it can be said above a narrow panel.
fn at(time: f64) -> String {
    let units = [("ns", 1e-9), ("µs", 1e-6), ("ms", 1e-3), ("s", 1.0)];
    let unit = units.into_iter().rev().find(|(_, unit)| time >= *unit);
    let (name, unit) = unit.unwrap_or(if time == 0.0 { ("s", 1.0) } else { ("ns", 1e-9) });
    // The time of a step carries the rounding of its size.
    format!("*t* = {} {name}", number(format!("{:.2e}", time / unit).parse().unwrap_or(time / unit)))
}

/// The exact pressure at one of the instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// (position, pressure), m and Pa.
    pub points: Vec<(f64, f64)>,
    /// s.
    pub time: f64,
}

/// Pressure and gap of each contact surface over the place on it, an instant a curve; `rows` lie in the file `stem`.
pub fn surfaces(rows: &[SurfaceRow], dimension: usize, stem: &str, reference: Option<&Reference>) -> Figure {
    let mut names: Vec<&str> = rows.iter().map(|row| &*row.surface).collect();
    names.dedup();
    let mut seen = std::collections::HashSet::new();
    names.retain(|name| seen.insert(*name));
    let mut times: Vec<f64> = rows.iter().map(|row| row.time.0).collect();
    times.dedup();
    let file = format!("{stem}.csv");
    let place = if dimension == 2 { "arc length *s* [m]" } else { "distance from the first touch *r* [m]" };
    let panel = |name: &str, pressure: bool| {
        let layer = |(style, time): (usize, &f64)| {
            let of = |row: &SurfaceRow| row.surface == name && row.time.0 == *time;
            let own: Vec<usize> = (0..rows.len()).filter(|i| of(&rows[*i])).collect();
            let value =
                |row: &SurfaceRow| if pressure { row.pressure.map_or(f64::NAN, |p| p.0) } else { row.gap.0 };
            let points: Vec<_> = own.iter().map(|i| (rows[*i].position.0, value(&rows[*i]))).collect();
            let whole = points.iter().all(|point| point.1.is_finite());
            let columns = ["position", if pressure { "pressure" } else { "gap" }];
            let source = Source::of(&file, columns, &own).filter(|_| whole);
            // Nodes of a surface in space have no order along r.
            let joined = dimension == 2;
            Layer::Markers { points, label: Some(at(*time)), style, joined, source: None }
                .from_records(source)
        };
        let mut layers: Vec<Layer> = times.iter().enumerate().map(layer).collect();
        layers.retain(|layer| layer.points().iter().any(|point| point.1.is_finite()));
        if let Some(Reference { points, time }) = reference.filter(|_| pressure) {
            let label = format!("Hertz, same force, {}", at(*time));
            layers.push(Layer::Exact { points: points.clone(), label: Some(label) });
        }
        let y = if pressure { "contact pressure *p* [Pa]" } else { "penetration *g* [m]" };
        Panel::new(Axis::linear(place), Axis::linear(y), layers).titled(literal(name))
    };
    let panels = names.iter().flat_map(|name| [panel(name, true), panel(name, false)]);
    let panels: Vec<Panel> = panels.filter(|panel| !panel.layers.is_empty()).collect();
    let mut figure = Figure::new(Width::Double, panels);
    figure.columns = 2;
    figure.naming = Naming::Legend;
    figure
}

#[cfg(test)]
mod tests {
    use super::*;

    fn instant(stress: [f64; 2]) -> Instant {
        let square = |x: f64| vec![(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)];
        Instant {
            time: 3.576e-5,
            elements: vec![square(0.0), square(1.0)],
            stress: stress.into(),
            outlines: vec![],
        }
    }

    #[test]
    fn colours_reach_to_the_extreme_stress_of_all_instants() {
        let instants = [instant([1.0, -3.0]), instant([2.0, -1.0])];
        let figure = stresses(&instants, Direction::Normal([0.0, 1.0]), 1.0);
        let bar = figure.colour_bar.as_ref().expect("a bar");
        assert_eq!((bar.axis.range, bar.map), (Some((-3.0, 3.0)), ColourMap::BlueRed));
        let polygons = |panel: &Panel| match &panel.layers[0] {
            Layer::Patches { polygons, .. } => polygons.len(),
            other => panic!("{other:?}"),
        };
        assert_eq!(figure.panels.iter().map(polygons).collect::<Vec<_>>(), [2, 2]);
        assert_eq!(figure.panels[0].title.as_deref(), Some("*t* = 35.8 µs"));
        assert_eq!(figure.panels[0].x.label, "*x* + *u*_{x} [m]");
        assert_eq!(figure.panels[0].x.range, figure.panels[1].x.range);
        let figure = stresses(&[instant([1.0, 3.0])], Direction::None, 200.0);
        let bar = figure.colour_bar.as_ref().expect("a bar");
        assert_eq!((bar.axis.range, bar.map), (Some((0.0, 3.0)), ColourMap::Viridis));
        assert_eq!(figure.panels[0].y.label, "*y* + 200 *u*_{y} [m]");
    }
}
