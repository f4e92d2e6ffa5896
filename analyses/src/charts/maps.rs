//! The charts of the tools, made of records only.

use super::curve::{Curve, CurvePoint, curves_of};
use super::levels::{ContourLines, Level};
use crate::record::{GIVEN, StabilityRow};
use bipenalty::schemes::explicit::ExplicitName;
use figure::{At, Axis, ColourBar, ColourMap, Figure, Layer, Panel, Side, Source, Width, literal};

/// Label of the critical Courant number.
const COURANT: &str = "critical Courant number *C*_{r}";
pub(super) const STIFFNESS: &str = "stiffness penalty *β*_{s}";
const RATIO: &str = "penalty ratio *r*";

/// C_r over beta_s, one panel a model and one curve a ratio, all on one scale of C_r; r = 1 below the others, which may lie
/// on it. Points that could not be certified leave a gap. The rows of all models stand in `file`; `None`: in none, since
/// the points were computed for the chart.
pub fn curves<'a>(file: impl Into<Option<&'a str>>, models: &[Vec<StabilityRow>], log: bool) -> Figure {
    let (file, styles) = (file.into(), Styles::of(models));
    let mut drawn: Vec<Vec<Curve>> = models.iter().map(|rows| curves_of(rows)).collect();
    drawn.iter_mut().for_each(|curves| curves.sort_by_key(|curve| curve.ratio != 1.0));
    if log {
        drawn.iter_mut().flatten().for_each(|curve| curve.points.retain(|point| point.beta_s > 0.0));
    }
    let values = drawn.iter().flatten().flat_map(|curve| curve.points.iter().map(|point| point.courant));
    let range = shared_range(values.filter(|c| c.is_finite()));
    let mut first = 0;
    let panels = models.iter().zip(drawn).map(|(rows, curves)| {
        let x = if log { Axis::log(STIFFNESS) } else { Axis::linear(STIFFNESS) };
        let source = |curve: &Curve| curve.source(file?, first);
        let layer = |curve: &Curve| {
            let (label, style) = (format!("*r* = {}", number(curve.ratio)), styles.style(curve.ratio));
            line(curve.line(), label, style).from_records(source(curve))
        };
        let y = Axis { range, ..Axis::linear(COURANT) };
        let stable = stable_side(&curves, source);
        let layers = stable.into_iter().chain(curves.iter().map(layer));
        let panel = Panel::new(x, y, layers.collect()).titled(title(rows));
        first += rows.len();
        panel
    });
    figure(panels.collect())
}

/// Computed points as a curve, or as markers on a thin line where they are so few that the eye would take the straight
/// pieces between them for computed.
pub(super) fn line(points: Vec<(f64, f64)>, label: String, style: usize) -> Layer {
    /// Closer points than these on a column of a page, some 2 mm apart, cannot be told from a curve.
    const FEW: usize = 31;
    if points.len() > FEW {
        return Layer::curve(points, label, style);
    }
    Layer::Markers { points, label: Some(label), style, joined: true, source: None }
}

/// The side below all curves, where every step is stable; its source is that of a curve that is nowhere above another.
fn stable_side(curves: &[Curve], source: impl Fn(&Curve) -> Option<Source>) -> Option<Layer> {
    let mut points = curves.first()?.line();
    let mut lowest_of_all = vec![true; curves.len()];
    for (i, (beta_s, lowest)) in points.iter_mut().enumerate() {
        for curve in curves {
            // Curves of other abscissae have no common envelope; a gap in one is a gap of the shade.
            let CurvePoint { beta_s: other, courant, .. } = *curve.points.get(i)?;
            if other != *beta_s {
                return None;
            }
            *lowest = if courant < *lowest || courant.is_nan() { courant } else { *lowest };
        }
        for (is_lowest, curve) in lowest_of_all.iter_mut().zip(curves) {
            *is_lowest &= curve.points[i].courant.total_cmp(lowest).is_eq();
        }
    }
    let drawable = points.iter().filter(|point| point.1.is_finite()).count() > 1;
    let label = if curves.len() == 1 { "stable" } else { "stable for all *r* shown" };
    let source =
        curves.iter().zip(lowest_of_all).find(|(_, lowest)| *lowest).and_then(|(curve, _)| source(curve));
    drawable.then(|| Layer::Shade { points, side: Side::Below, label: Some(label.to_owned()), source })
}

/// Styles that can be told apart.
pub(super) const STYLES: usize = 8;

/// The style of every ratio of a figure: the ratios of the paper keep theirs in every chart, the others take what is
/// left in turn.
pub(super) struct Styles(Vec<(f64, usize)>);

impl Styles {
    /// The styles for all ratios of `models`.
    pub(super) fn of(models: &[Vec<StabilityRow>]) -> Self {
        const PAPER: [(f64, usize); 6] =
            [(1.0, 0), (2.0, 1), (3.0, 2), (0.5, 3), (f64::INFINITY, 4), (0.25, 5)];
        let mut styles: Vec<(f64, usize)> = Vec::new();
        let mut others = Vec::new();
        for Curve { ratio, .. } in models.iter().flat_map(|rows| curves_of(rows)) {
            match PAPER.iter().find(|(known, _)| *known == ratio) {
                Some(known) => styles.push(*known),
                None if !others.contains(&ratio) => others.push(ratio),
                None => (),
            }
        }
        let taken: Vec<usize> = styles.iter().map(|(_, style)| *style).collect();
        let free: Vec<usize> = (0..STYLES).filter(|style| !taken.contains(style)).collect();
        let cycle = free.iter().chain(&taken).copied().cycle();
        styles.extend(others.into_iter().zip(cycle));
        Self(styles)
    }

    /// The style of a ratio.
    pub(super) fn style(&self, ratio: f64) -> usize {
        self.0.iter().find(|(known, _)| *known == ratio).map_or(0, |(_, style)| *style)
    }
}

/// The range of all values with some air, so that panels can be compared, from 0 on where they come near it; `None` if there
/// is none.
fn shared_range(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let (low, high) = (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max));
    let air = 0.05 * (high - low);
    let from = if low < 0.5 * high { 0.0 } else { low - air };
    (air > 0.0).then_some((from, high + air))
}

/// Whether values are spread more evenly over a logarithmic axis than over a linear one.
pub fn is_logarithmic(values: &[f64]) -> bool {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    // The largest gap as a share of the whole range.
    let unevenness = |of: fn(f64) -> f64| {
        let gaps = values.windows(2).map(|pair| of(pair[1]) - of(pair[0]));
        gaps.fold(0.0, f64::max) / (of(values[values.len() - 1]) - of(values[0]))
    };
    let positive = values.first().is_some_and(|least| *least > 0.0);
    positive
        && values.iter().all(|value| value.is_finite())
        && unevenness(f64::ln) < unevenness(|value| value)
}

/// The contact-free limit over gamma: computed points on the closed form sqrt((1+2g)/3) of (26). The rows of all models
/// stand in `file`.
pub fn mass_family(file: &str, models: &[Vec<StabilityRow>]) -> Figure {
    let computed = models.iter().flatten().enumerate();
    let computed = computed.filter_map(|(i, row)| Some((i, (row.gamma?.0, row.critical_courant?.0))));
    let (rows, computed): (Vec<usize>, Vec<(f64, f64)>) = computed.unzip();
    let source = Source::of(file, ["gamma", "critical_courant"], &rows);
    let exact = |i: usize| {
        let gamma = i as f64 / 100.0;
        (gamma, ((1.0 + 2.0 * gamma) / 3.0).sqrt())
    };
    let layers = vec![
        Layer::Exact { points: (0..=100).map(exact).collect(), label: Some("√((1 + 2γ)/3)".to_owned()) },
        Layer::markers(computed, "computed", 0).from_records(source),
    ];
    let x = Axis::linear("mass matrix γ (0 consistent, 1 lumped)").over(0.0, 1.0);
    figure(vec![Panel::new(x, Axis::linear(COURANT), layers).titled("contact-free limit")])
}

/// The rows of one model as a grid with increasing axes.
pub(super) struct MapGrid {
    /// beta_s.
    pub(super) x: Vec<f64>,
    /// r.
    pub(super) y: Vec<f64>,
    /// C_r, row by row of constant r.
    pub(super) values: Vec<f64>,
}

impl MapGrid {
    pub(super) fn of(rows: &[StabilityRow]) -> Self {
        let mut curves = curves_of(rows);
        curves.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
        let points = |curve: &Curve| curve.points.clone();
        Self {
            x: curves.first().into_iter().flat_map(points).map(|point| point.beta_s).collect(),
            y: curves.iter().map(|curve| curve.ratio).collect(),
            values: curves.iter().flat_map(points).map(|point| point.courant).collect(),
        }
    }
}

/// C_r as colours over (beta_s, r), both logarithmic, with contour lines; one panel a model.
pub fn map(models: &[Vec<StabilityRow>], contours: &[ContourLines]) -> Figure {
    let panels = models.iter().zip(contours).map(|(rows, lines)| {
        let MapGrid { x, y, values } = MapGrid::of(rows);
        let cells = Layer::Cells { x, y, values };
        let contour = |(level, points): &(Level, Vec<(f64, f64)>)| Layer::Contour {
            lines: vec![points.clone()],
            label: Some(level.label.clone()),
        };
        let rule = Layer::Rule { at: At::Y(1.0), label: Some("*r* = 1".to_owned()) };
        // A level that the user asks for may lie outside of this map.
        let lines =
            lines.iter().filter(|(_, points)| points.iter().any(|(x, y)| x.is_finite() && y.is_finite()));
        let layers = std::iter::once(cells).chain(lines.map(contour)).chain([rule]);
        Panel::new(Axis::log(STIFFNESS), Axis::log(RATIO), layers.collect()).titled(title(rows))
    });
    let mut figure = figure(panels.collect());
    figure.colour_bar = Some(ColourBar { axis: Axis::log("*C*_{r}"), map: ColourMap::Viridis });
    figure
}

/// The same figure with whose limit each panel shows in its title; the same limits of two names are one panel.
pub fn titled_by_limit(mut figure: Figure, panels: &[Vec<StabilityRow>]) -> Figure {
    let point = |row: &StabilityRow| (row.stiffness_penalty, row.ratio, row.critical_courant);
    let alike = |one: &[StabilityRow], other: &[StabilityRow]| {
        let key = |rows: &[StabilityRow]| rows.first().map(|row| (row.scene.clone(), row.mass.clone()));
        key(one) == key(other) && one.iter().map(point).eq(other.iter().map(point))
    };
    let mut kept: Vec<(Panel, Vec<String>, &[StabilityRow])> = Vec::new();
    for (panel, rows) in std::mem::take(&mut figure.panels).into_iter().zip(panels) {
        let name = rows.first().map_or(String::new(), |row| limit_name(row.limit));
        match kept.last_mut() {
            Some((_, names, before)) if alike(before, rows) => names.push(name),
            _ => kept.push((panel, vec![name], rows)),
        }
    }
    let titled = |(panel, mut names, rows): (Panel, Vec<String>, &[StabilityRow])| {
        // Central differences have the spectrum's limit: the name of the scheme says more.
        if names.len() > 1 {
            names.retain(|name| name != "spectrum");
        }
        let mass = rows.first().map_or(String::new(), |row| mass_name(&row.mass));
        panel.titled(literal(&format!("{}{mass}{}", names.join(" / "), bound_name(rows))))
    };
    figure.panels = kept.into_iter().map(titled).collect();
    figure.columns = columns(figure.panels.len());
    figure
}

/// What a title adds where some of the limits are known from below only.
fn bound_name(rows: &[StabilityRow]) -> &'static str {
    if rows.iter().any(StabilityRow::is_lower_bound) { ", lower bound" } else { "" }
}

/// Whose limit, as a title names it.
pub(super) fn limit_name(limit: &str) -> String {
    match limit {
        "central-difference" => "central difference".to_owned(),
        "park" => "Park".to_owned(),
        other => other.parse::<ExplicitName>().map_or(other, |scheme| scheme.facts().title).to_owned(),
    }
}

/// What a ratio costs with a stiff contact: the step kept by every scheme with the first mass matrix, and the loss of the last
/// scheme, Park's with `theta`, with every mass matrix. `models`: mass by mass, scheme by scheme, curves over a contact-free and a stiff beta_s.
pub fn costs(models: &[Vec<Vec<StabilityRow>>], theta: f64) -> Figure {
    let kept = |rows: &[StabilityRow]| -> Vec<(f64, f64)> {
        let quotient = |curve: &Curve| match curve.points[..] {
            [free, stiff] => Some((curve.ratio, stiff.courant / free.courant)),
            _ => None,
        };
        curves_of(rows).iter().filter_map(quotient).collect()
    };
    let schemes = models.first().into_iter().flatten().enumerate().map(|(style, rows)| {
        let name = rows.first().map_or(String::new(), |row| limit_name(row.limit)) + bound_name(rows);
        Layer::curve(kept(rows), literal(&name), style)
    });
    let masses = models.iter().enumerate().filter_map(|(style, schemes)| {
        let rows = schemes.last()?;
        let loss: Vec<_> = kept(rows).into_iter().map(|(r, kept)| (r, 1.0 - kept)).collect();
        Some(Layer::curve(loss, literal(&rows.first()?.mass), style))
    });
    let titles = models.first().and_then(|schemes| schemes.last()?.last()).map(|row| {
        let at = format!("*β*_{{s}} = {}", number(row.stiffness_penalty.0));
        (
            format!("{}, {} mass, {at}", scene_name(&row.scene), row.mass),
            format!("{}, *θ* = {theta}, {at}", limit_name(row.limit)),
        )
    });
    let (mass, scheme) = titles.unwrap_or_default();
    let kept = Axis::linear("share of the step kept").over(0.0, 1.05);
    let left = Panel::new(Axis::log(RATIO), kept, schemes.collect()).titled(mass);
    let right =
        Panel::new(Axis::log(RATIO), Axis::log("share of the step lost"), masses.collect()).titled(scheme);
    figure(vec![left, right])
}

/// One panel fits a column, more take the width of the page.
pub(super) fn figure(panels: Vec<Panel>) -> Figure {
    let width = if panels.len() == 1 { Width::Single } else { Width::Double };
    let mut figure = Figure::new(width, panels);
    figure.columns = columns(figure.panels.len());
    figure
}

/// Three panels stand in a row, others in twos.
fn columns(panels: usize) -> usize {
    if panels == 3 { 3 } else { panels.clamp(1, 2) }
}

/// Scene, size and mass of the rows.
fn title(rows: &[StabilityRow]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    let elements = match row.elements {
        Some(1) => ", 1 element".to_owned(),
        Some(n) => format!(", {n} elements"),
        None => String::new(),
    };
    let (name, mass) = (scene_name(&row.scene), mass_name(&row.mass));
    literal(&format!("{name}{elements}{mass}{}", bound_name(rows)))
}

/// The mass matrix as a title goes on with it.
pub(super) fn mass_name(mass: &str) -> String {
    match mass {
        GIVEN => String::new(),
        name @ ("lumped" | "averaged" | "consistent") => format!(", {name}"),
        gamma => format!(", γ = {gamma}"),
    }
}

/// The built-in scenes by the names of the paper. A long name is cut: the title must fit above half a page.
pub(super) fn scene_name(scene: &str) -> String {
    const LONGEST_NAME: usize = 16;
    match (scene, scene.char_indices().nth(LONGEST_NAME)) {
        ("signorini", _) => "Signorini".to_owned(),
        ("symmetric", _) => "symmetric contact".to_owned(),
        ("hunek", _) => "Hunek".to_owned(),
        ("bouncing-bar", _) => "bouncing bar".to_owned(),
        (_, Some((cut, _))) => format!("{}…", &scene[..cut]),
        _ => scene.to_owned(),
    }
}

/// A number as a label: ∞, plain, or with a power of ten where that is shorter to read.
pub(super) fn number(x: f64) -> String {
    let plain = format!("{x}").replace('-', "−");
    if x.is_infinite() {
        return "∞".to_owned();
    }
    if x == 0.0 || (1e-3..1e4).contains(&x.abs()) {
        return plain;
    }
    let power = format!("{x:e}").replace('-', "−");
    match power.split_once('e') {
        Some(("1", exponent)) => format!("10^{{{exponent}}}"),
        Some((mantissa, exponent)) => format!("{mantissa}·10^{{{exponent}}}"),
        None => plain,
    }
}
