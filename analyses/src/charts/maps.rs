//! The charts of the tools, made of records only.

use super::curve::{Curve, Point, curves_of};
use crate::record::{GIVEN, OptimalRatioRow, StabilityRow};
use figure::isolines;
use figure::{At, Axis, ColourBar, ColourMap, Figure, Layer, Naming, Panel, Side, Source, Width, literal};

/// Label of the critical Courant number.
const COURANT: &str = "critical Courant number *C*_{r}";
const STIFFNESS: &str = "stiffness penalty *β*_{s}";
const RATIO: &str = "penalty ratio *r*";

/// C_r over beta_s, one panel a model and one curve a ratio, all on one scale of C_r. Points that could not be
/// certified leave a gap. A curve r < 1 that cannot be told from r = 1 is not drawn, but named with it. The rows of all
/// models stand in `file`.
pub fn curves(file: &str, models: &[Vec<StabilityRow>], log: bool) -> Figure {
    panels_of(Some(file), models, log, models.iter().map(|rows| distinct(rows)).collect())
}

/// As [`curves`], with every ratio drawn and named for itself; r = 1 below the others.
pub(super) fn all_curves(models: &[Vec<StabilityRow>], log: bool) -> Figure {
    let named = |rows: &Vec<StabilityRow>| {
        let mut curves = curves_of(rows);
        curves.sort_by_key(|curve| curve.ratio != 1.0);
        let drawn = |curve: Curve| Drawn { label: format!("*r* = {}", number(curve.ratio)), curve };
        curves.into_iter().map(drawn).collect()
    };
    // The points were computed for the chart: no file holds them.
    panels_of(None, models, log, models.iter().map(named).collect())
}

fn panels_of(
    file: Option<&str>,
    models: &[Vec<StabilityRow>],
    log: bool,
    mut drawn: Vec<Vec<Drawn>>,
) -> Figure {
    let styles = Styles::of(models);
    if log {
        drawn.iter_mut().flatten().for_each(|drawn| drawn.curve.points.retain(|point| point.beta_s > 0.0));
    }
    let values =
        drawn.iter().flatten().flat_map(|drawn| drawn.curve.points.iter().map(|point| point.courant));
    let range = shared_range(values.filter(|c| c.is_finite()));
    let mut first = 0;
    let panels = models.iter().zip(drawn).map(|(rows, curves)| {
        let x = if log { Axis::log(STIFFNESS) } else { Axis::linear(STIFFNESS) };
        let source = |curve: &Curve| curve.source(file?, first);
        let layer = |Drawn { label, curve }: Drawn| {
            Layer::curve(curve.line(), label, styles.style(curve.ratio)).from_records(source(&curve))
        };
        let y = Axis { range, ..Axis::linear(COURANT) };
        let stable = stable_side(&curves, source);
        let layers = stable.into_iter().chain(curves.into_iter().map(layer));
        let panel = Panel::new(x, y, layers.collect()).titled(title(rows));
        first += rows.len();
        panel
    });
    figure(panels.collect())
}

/// The side below all curves, where every step is stable; its source is that of a curve that is nowhere above another.
fn stable_side(curves: &[Drawn], source: impl Fn(&Curve) -> Option<Source>) -> Option<Layer> {
    let mut points = curves.first()?.curve.line();
    let mut lowest_of_all = vec![true; curves.len()];
    for (i, (beta_s, lowest)) in points.iter_mut().enumerate() {
        for Drawn { curve, .. } in curves {
            // Curves of other abscissae have no common envelope; a gap in one is a gap of the shade.
            let Point { beta_s: other, courant, .. } = *curve.points.get(i)?;
            if other != *beta_s {
                return None;
            }
            *lowest = if courant < *lowest || courant.is_nan() { courant } else { *lowest };
        }
        for (is_lowest, Drawn { curve, .. }) in lowest_of_all.iter_mut().zip(curves) {
            *is_lowest &= curve.points[i].courant.total_cmp(lowest).is_eq();
        }
    }
    let drawable = points.iter().filter(|point| point.1.is_finite()).count() > 1;
    let label = if curves.len() == 1 { "stable" } else { "stable for all *r* shown" };
    let source =
        curves.iter().zip(lowest_of_all).find(|(_, lowest)| *lowest).and_then(|(d, _)| source(&d.curve));
    drawable.then(|| Layer::Shade { points, side: Side::Below, label: Some(label.to_owned()), source })
}

/// A curve as it is drawn.
struct Drawn {
    label: String,
    curve: Curve,
}

/// The curves of one model that can be told apart, named.
fn distinct(rows: &[StabilityRow]) -> Vec<Drawn> {
    let curves = curves_of(rows);
    let optimal = curves.iter().find(|curve| curve.ratio == 1.0).map(|curve| curve.points.clone());
    let hidden = |curve: &Curve| curve.ratio < 1.0 && !differs(&curve.points, optimal.as_deref());
    let some_hidden = curves.iter().any(hidden);
    let shown = curves.into_iter().filter(|curve| !hidden(curve));
    shown
        .map(|curve| {
            let relation = if some_hidden && curve.ratio == 1.0 { "≤" } else { "=" };
            Drawn { label: format!("*r* {relation} {}", number(curve.ratio)), curve }
        })
        .collect()
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

/// Whether two curves are more than the width of a line apart somewhere.
fn differs(points: &[Point], reference: Option<&[Point]>) -> bool {
    const LINE_WIDTH: f64 = 0.005;
    let Some(reference) = reference else { return true };
    points.iter().zip(reference).any(|(a, b)| (a.courant - b.courant).abs() > LINE_WIDTH * b.courant)
}

/// The range of all values with some air, so that panels can be compared; `None` if there is none.
fn shared_range(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let (low, high) = (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max));
    let air = 0.05 * (high - low);
    (air > 0.0).then_some((low - air, high + air))
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

/// Levels worth a contour line: round values between the smallest C_r of the rows and just below the largest.
pub fn levels(rows: &[StabilityRow]) -> Vec<f64> {
    const ROUND: [f64; 10] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.2, 0.4, 0.8, 1.2];
    let values = || rows.iter().filter_map(StabilityRow::stable_courant);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    ROUND.into_iter().filter(|level| *level > 1.1 * low && *level < 0.97 * high).collect()
}

/// Contour lines of one model: the level and the points (beta_s, r) of its line.
pub type ContourLines = Vec<(f64, Vec<(f64, f64)>)>;

/// The contour lines of the rows of one model, interpolated on their grid; what [`map`] draws where the exact lines
/// are not known.
pub fn interpolated_contours(rows: &[StabilityRow]) -> ContourLines {
    let grid = MapGrid::of(rows);
    let lines = |level: f64| {
        let lines = isolines(&grid.x, &grid.y, &grid.values, level);
        lines.into_iter().map(move |line| (level, line))
    };
    levels(rows).into_iter().flat_map(lines).collect()
}

/// The rows of one model as a grid with increasing axes.
struct MapGrid {
    /// beta_s.
    x: Vec<f64>,
    /// r.
    y: Vec<f64>,
    /// C_r, row by row of constant r.
    values: Vec<f64>,
}

impl MapGrid {
    fn of(rows: &[StabilityRow]) -> Self {
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
        let contour = |(level, points): &(f64, Vec<(f64, f64)>)| Layer::Contour {
            lines: vec![points.clone()],
            label: Some(number(*level)),
        };
        let rule = Layer::Rule { at: At::Y(1.0), label: Some("*r* = 1".to_owned()) };
        let layers = std::iter::once(cells).chain(lines.iter().map(contour)).chain([rule]);
        Panel::new(Axis::log(STIFFNESS), Axis::log(RATIO), layers.collect()).titled(title(rows))
    });
    let mut figure = figure(panels.collect());
    figure.colour_bar = Some(ColourBar { axis: Axis::log("*C*_{r}"), map: ColourMap::Viridis });
    figure
}

/// The optimal ratio over beta_s, one curve a mass matrix, and the width of its enclosure. Where no ratio costs a step,
/// or every one does, there is no curve; `None` if that is everywhere. The rows of all models stand in `file`.
pub fn optimal_ratio(file: &str, models: &[Vec<OptimalRatioRow>], log: bool) -> Option<Figure> {
    let x = || if log { Axis::log(STIFFNESS) } else { Axis::linear(STIFFNESS) };
    let (mut values, mut widths, mut found) = (Vec::new(), Vec::new(), Vec::new());
    let mut before = 0;
    for (style, model) in models.iter().enumerate() {
        // Where every ratio costs a step, the largest that does not is 0.
        let some =
            |(_, row): &(usize, &OptimalRatioRow)| row.optimal_ratio.is_some_and(|ratio| ratio.0 > 0.0);
        let mut rows: Vec<(usize, &OptimalRatioRow)> = (before..).zip(model).filter(some).collect();
        before += model.len();
        rows.sort_by(|(_, a), (_, b)| a.stiffness_penalty.0.total_cmp(&b.stiffness_penalty.0));
        let (indices, rows): (Vec<usize>, Vec<&OptimalRatioRow>) = rows.into_iter().unzip();
        let Some(first) = rows.first() else { continue };
        let source = Source::of(file, ["stiffness_penalty", "optimal_ratio"], &indices);
        let name = literal(&first.mass);
        let curve = |of: fn(&OptimalRatioRow) -> Option<f64>| {
            rows.iter().map(|row| (row.stiffness_penalty.0, of(row).unwrap_or(f64::NAN))).collect::<Vec<_>>()
        };
        let ratios = curve(|row| Some(row.optimal_ratio?.0));
        found.extend(ratios.iter().map(|(_, ratio)| *ratio));
        values.push(Layer::curve(ratios, &name, style).from_records(source));
        // An enclosure of no width has no place on a logarithmic axis.
        let width = curve(|row| Some(row.upper?.0 - row.lower?.0).filter(|width| *width > 0.0));
        if width.iter().any(|(_, width)| width.is_finite()) {
            widths.push(Layer::curve(width, name, style));
        }
    }
    let row = models.iter().flatten().next()?;
    let of_scheme = matches!(row.limit, "predictor-corrector" | "park");
    let (least, most) =
        found.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(*r), high.max(*r)));
    let (y, title) = if of_scheme {
        let title = format!("{}, {}", scene_name(&row.scene), limit_name(row.limit));
        (Axis::linear("largest *r* without cost").over(0.0, 1.5), title)
    } else {
        (Axis::linear("optimal ratio *r*").over(0.9 * least, 1.1 * most), scene_name(&row.scene))
    };
    if values.is_empty() {
        return None;
    }
    let mut panels = vec![Panel::new(x(), y, values).titled(literal(&title))];
    if !widths.is_empty() {
        let y = Axis::log("width of the enclosure of *r*");
        panels.push(Panel::new(x(), y, widths).titled("proven to within"));
    }
    let mut figure = figure(panels);
    figure.naming = Naming::Legend;
    Some(figure)
}

/// The same figure with whose limit each panel shows in its title.
pub fn titled_by_limit(mut figure: Figure, panels: &[Vec<StabilityRow>]) -> Figure {
    for (panel, rows) in figure.panels.iter_mut().zip(panels) {
        let Some(row) = rows.first() else { continue };
        let bound = bound_name(rows);
        panel.title = Some(literal(&format!("{}, {} mass{bound}", limit_name(row.limit), row.mass)));
    }
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
        other => other.to_owned(),
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
fn figure(panels: Vec<Panel>) -> Figure {
    let width = if panels.len() == 1 { Width::Single } else { Width::Double };
    let mut figure = Figure::new(width, panels);
    figure.columns = figure.columns.min(2);
    figure
}

/// Scene, size and mass of the rows.
fn title(rows: &[StabilityRow]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    let elements = match row.elements {
        Some(1) => ", 1 element".to_owned(),
        Some(n) => format!(", {n} elements"),
        None => String::new(),
    };
    let mass = match row.mass.as_str() {
        GIVEN => String::new(),
        name @ ("lumped" | "averaged" | "consistent") => format!(", {name}"),
        gamma => format!(", γ = {gamma}"),
    };
    let name = scene_name(&row.scene);
    literal(&format!("{name}{elements}{mass}{}", bound_name(rows)))
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
