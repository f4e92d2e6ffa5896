//! What contact costs a mesh, what proves it, and what rules of thumb make of it: charts made of records only.

use super::maps::{STIFFNESS, number};
use crate::meshes::MANUAL;
use crate::record::MeshRow;
use figure::{At, Axis, Figure, Layer, Naming, Panel, Width, literal};

/// Less than this is lost within the width of the exact step: it is drawn here.
const LEAST: f64 = 1e-8;

const RELATIVE: &str = "step / contact-free step";

/// The step of pure penalty over beta_s, one curve an element, with the contact-free step in its name; a panel for the plane
/// and one for space.
pub fn elements(rows: &[MeshRow]) -> Figure {
    let panel = |(title, kinds, first): (&str, &[&str], usize)| {
        let curve = |(style, kind): (usize, &&str)| {
            let of: Vec<&MeshRow> = rows.iter().filter(|row| row.element == *kind).collect();
            let free = of.first().map_or(f64::NAN, |row| {
                row.courant.map_or(f64::NAN, |courant| courant.0) / row.relative_step.0
            });
            let points = of.iter().map(|row| (row.stiffness_penalty.0, row.relative_step.0)).collect();
            Layer::curve(points, format!("{} ({free:.3})", literal(kind)), first + style)
        };
        let layers = kinds.iter().enumerate().map(curve).collect();
        let y = Axis::log(RELATIVE).over(0.02, 1.2);
        Panel::new(Axis::log(STIFFNESS), y, layers).titled(title)
    };
    let [plane, space] = &crate::meshes::ELEMENTS;
    let panels = [
        ("plane, pure penalty (contact-free *c* d*t*/*h*)", &plane[..], 0),
        // One legend for both: no style stands for two elements.
        ("space, pure penalty (contact-free *c* d*t*/*h*)", &space[..], plane.len()),
    ];
    in_rows(panels.into_iter().map(panel).collect())
}

/// The step over the ratio of the cells of two bodies, a panel a beta_s and a line a ratio.
pub fn sizes(rows: &[MeshRow]) -> Figure {
    let panel = |beta_s: f64| {
        let of = || rows.iter().filter(|row| row.stiffness_penalty.0 == beta_s);
        let line = |(style, ratio): (usize, f64)| {
            let of = of().filter(|row| row.ratio.0 == ratio);
            let points = of.filter_map(|row| Some((row.parameter?.0, row.relative_step.0))).collect();
            markers(points, format!("*r* = {}", number(ratio)), style)
        };
        let ratios = distinct(of().map(|row| row.ratio.0));
        let layers = ratios.into_iter().enumerate().map(line).collect();
        let x = Axis::log("size of a cell, upper / lower body");
        // A weak contact takes a few per cent.
        let y = if beta_s <= 1.0 { Axis::linear(RELATIVE) } else { Axis::log(RELATIVE) };
        Panel::new(x, y, layers).titled(format!("*β*_{{s}} = {}", number(beta_s)))
    };
    let panels = distinct(rows.iter().map(|row| row.stiffness_penalty.0)).into_iter().map(panel);
    in_rows(panels.collect())
}

/// How much too small the steps are that elements and patches of them prove, at least `LEAST`; a panel an element, a line a penalty.
pub fn bounds(rows: &[MeshRow]) -> Figure {
    let mut kinds: Vec<&str> = rows.iter().map(|row| row.element).collect();
    kinds.dedup();
    let panel = |kind: &&str| {
        let of = |beta_s: f64, ratio: f64| {
            let of = rows.iter().filter(move |row| {
                row.element == *kind && row.stiffness_penalty.0 == beta_s && row.ratio.0 == ratio
            });
            of.filter_map(|row| Some((row.parameter?.0, (-row.error.0).max(LEAST)))).collect()
        };
        let lines = [
            (1e3, 1.0, "no contact, and *r* = 1".to_owned()),
            (1.0, f64::INFINITY, "*β*_{s} = 1".to_owned()),
            (10.0, f64::INFINITY, "*β*_{s} = 10".to_owned()),
            (1e3, f64::INFINITY, "*β*_{s} = 1000".to_owned()),
        ];
        let line = |(style, (beta_s, ratio, name)): (usize, (f64, f64, String))| {
            markers(of(beta_s, ratio), name, style)
        };
        let layers = lines.into_iter().enumerate().map(line).collect();
        let y = Axis::log("1 − proven step / exact step").named(LEAST, format!("≤ {}", number(LEAST)));
        Panel::new(Axis::log("elements along an edge of a patch"), y, layers).titled(literal(kind))
    };
    in_rows(kinds.iter().map(panel).collect())
}

/// Estimated over exact step: above the line a rule is too bold. A panel a mesh and ratio.
pub fn rules(rows: &[MeshRow]) -> Figure {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let ratios = distinct(rows.iter().map(|row| row.ratio.0));
    let panel = |scene: &str, ratio: f64| {
        let of = |name: &str| {
            let of =
                rows.iter().filter(|row| row.scene == scene && row.ratio.0 == ratio && row.estimate == name);
            of.map(|row| (row.stiffness_penalty.0, 1.0 + row.error.0)).collect()
        };
        let rules = [
            ("no contact", "elements, no contact"),
            ("nodal", "nodal, contact summed in"),
            ("oscillators", "min(element, 2(*μ*/*k*)^{1/2})"),
        ];
        let mut layers = vec![Layer::Rule { at: At::Y(1.0), label: None }];
        let curve = |(style, (name, label)): (usize, &(&str, &str))| Layer::curve(of(name), *label, style);
        layers.extend(rules.iter().enumerate().map(curve));
        let y = Axis::log("estimated / exact step").over(0.5, 20.0);
        Panel::new(Axis::log(STIFFNESS), y, layers).titled(format!(
            "{}, *r* = {}",
            literal(scene),
            number(ratio)
        ))
    };
    // A column a mesh and a row a ratio, at every width.
    let all = ratios.iter().flat_map(|ratio| scenes.iter().map(move |scene| (*scene, *ratio)));
    let mut figure = in_rows(all.map(|(scene, ratio)| panel(scene, ratio)).collect());
    figure.columns = scenes.len().max(1);
    figure
}

/// The five scales of a manual on curves whose first point they share.
pub fn scales(rows: &[MeshRow]) -> Figure {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let curve = |(style, scene): (usize, &&str)| {
        let of = rows.iter().filter(|row| row.scene == *scene && row.ratio.0.is_infinite());
        let points = of.filter_map(|row| Some((row.parameter?.0, row.relative_step.0))).collect();
        Layer::curve(points, format!("{}, pure penalty", literal(scene)), style)
    };
    let mut layers: Vec<Layer> = scenes.iter().enumerate().map(curve).collect();
    let neutral = rows
        .iter()
        .filter(|row| row.ratio.0 == 1.0 && Some(&row.scene.as_str()) == scenes.first().as_ref().copied());
    let points = neutral.filter_map(|row| Some((row.parameter?.0, row.relative_step.0))).collect();
    layers.push(Layer::curve(points, "the same with *r* = 1", 4));
    layers.push(Layer::markers(MANUAL.to_vec(), "Abaqus 6.6 manual, its scene unknown", 5));
    let y = Axis::log(RELATIVE).over(0.005, 1.5);
    let mut figure = Figure::new(Width::Single, vec![Panel::new(Axis::log("penalty scale"), y, layers)]);
    figure.naming = Naming::Legend;
    figure
}

fn markers(points: Vec<(f64, f64)>, label: String, style: usize) -> Layer {
    Layer::Markers { points, label: Some(label), style, joined: true, source: None }
}

fn in_rows(panels: Vec<Panel>) -> Figure {
    let mut figure = Figure::new(Width::Double, panels);
    figure.columns = 2;
    figure.naming = Naming::Legend;
    figure
}

/// The values in increasing order, each once.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
