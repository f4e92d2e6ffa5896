//! Error against run time, made of measurements only: one marker a measurement, the Pareto front as a line.

use super::maps::{number, scene_name};
use figure::{Axis, Figure, Layer, Naming, Panel, Width, literal};
use precision::{Family, Measurement, distinct};

/// Errors below are drawn here: no method is right beyond a tenth of a unit in the last place but by chance.
const SMALLEST_ERROR: f64 = 1e-17;

const SECONDS: &str = "time [s]";

/// How the methods that step at half the critical step end.
const HALF: &str = "C=0.5";

/// A method's name in the legend (markup) and its style: its own, since two lines of one kind say nothing.
fn kind(method: &str) -> (String, usize) {
    let known = KINDS.iter().find(|(start, ..)| method.starts_with(start));
    match known {
        Some((_, name, style)) => ((*name).to_owned(), *style),
        None if method.starts_with("numpy") => ("numpy central difference".to_owned(), 16),
        None => ("central difference".to_owned(), 7),
    }
}

/// How the name of a method begins, its name in the legend (markup) and its style.
const KINDS: [(&str, &str, usize); 20] = [
    ("closed-form unproven", "closed form, unproven", 9),
    ("closed-form", "closed form", 0),
    ("secular", "secular", 1),
    ("sturm", "Sturm", 2),
    ("dense", "dense (faer)", 3),
    ("lapack", "LAPACK", 4),
    ("LAPACK", "LAPACK", 4),
    ("scipy eigh", "scipy eigh", 5),
    ("scipy eig_banded", "scipy eig\\_banded", 14),
    ("scipy", "scipy eigsh", 13),
    ("element bound", "element bound (*l*_{max} from above)", 6),
    ("Gershgorin", "Gershgorin (*l*_{max} from above)", 15),
    ("power iteration 300", "power iteration, 300 steps (*l*_{max} from below)", 16),
    ("power", "power iteration, 30 steps (*l*_{max} from below)", 7),
    ("Lanczos 80", "Lanczos, 80 steps (*l*_{max} from below)", 17),
    ("Lanczos", "Lanczos, 20 steps (*l*_{max} from below)", 8),
    ("predictor-corrector", "predictor-corrector", 0),
    ("park", "Park", 1),
    ("numpy predictor-corrector", "numpy predictor-corrector", 9),
    ("numpy park", "numpy Park", 10),
];

/// |error| of the critical step over time at one size, one panel a problem.
pub fn eigenvalue_errors(rows: &[Measurement], size: usize) -> Figure {
    let rows: Vec<&Measurement> =
        measured(rows, Family::Eigenvalue).into_iter().filter(|row| row.size == size).collect();
    let panel = |problem: &String| {
        let of: Vec<&Measurement> = rows.iter().filter(|row| row.problem == *problem).copied().collect();
        let mut layers = vec![front(&of)];
        layers.extend(of.iter().map(|row| markers(&[row], false)));
        panel_of(
            error_axis("error of the critical step", &rows),
            layers,
            format!("{problem}, {size} elements"),
        )
    };
    figure(problems(&rows).iter().map(panel).collect(), 2)
}

/// Time over size, one line a method, one panel a problem.
pub fn eigenvalue_times(rows: &[Measurement]) -> Figure {
    let rows = measured(rows, Family::Eigenvalue);
    let panel = |problem: &String| {
        let of = || rows.iter().filter(|row| row.problem == *problem);
        let methods = methods(of().copied());
        let line = |method: &&str| {
            let (name, style) = kind(method);
            let points = of().filter(|row| row.method == *method);
            let points = points.filter_map(|row| Some((row.size as f64, row.point()?.0))).collect();
            Layer::Markers { points, label: Some(name), style, joined: true, source: None }
        };
        let layers = methods.iter().map(line).collect();
        Panel::new(Axis::log("elements *n*"), Axis::log(SECONDS), layers).titled(literal(problem))
    };
    figure(problems(&rows).iter().map(panel).collect(), 2)
}

/// Errors of the impacts of one scene over time: one panel a mass matrix and quantity, one line a scheme through the meshes
/// at half the critical step. Of other steps only what lies on the front is shown, as markers.
pub fn impact_errors(rows: &[Measurement], scene: &str) -> Figure {
    let prefix = format!("{scene}-");
    let rows: Vec<&Measurement> =
        measured(rows, Family::Stepping).into_iter().filter(|row| row.problem.starts_with(&prefix)).collect();
    let panel = |problem: &String| {
        let of: Vec<&Measurement> = rows.iter().filter(|row| row.problem == *problem).copied().collect();
        let methods = methods(of.iter().copied());
        let line = |method: &&str| {
            let halved = method.ends_with(HALF);
            let shown = |row: &&&Measurement| row.method == *method && (halved || row.on_front);
            markers(&of.iter().filter(shown).copied().collect::<Vec<_>>(), halved)
        };
        let shown = methods.iter().filter(|method| {
            method.ends_with(HALF) || of.iter().any(|row| row.method == **method && row.on_front)
        });
        let layers = std::iter::once(front(&of)).chain(shown.map(line)).collect();
        let what = problem.trim_start_matches(&prefix).replace('-', ", ");
        panel_of(error_axis("rms error", &rows), layers, format!("{}, {what}", scene_name(scene)))
    };
    let mut figure = figure(problems(&rows).iter().map(panel).collect(), 3);
    let single = "not joined: a step other than half the critical one";
    figure.key = vec![Layer::markers(Vec::new(), single, 13)];
    figure
}

/// What can be drawn of a family.
fn measured(rows: &[Measurement], family: Family) -> Vec<&Measurement> {
    rows.iter().filter(|row| row.family == family && row.point().is_some()).collect()
}

/// The problems in their order.
fn problems(rows: &[&Measurement]) -> Vec<String> {
    distinct(rows.iter().map(|row| row.problem.clone()))
}

/// The methods in their order.
fn methods<'a>(rows: impl Iterator<Item = &'a Measurement>) -> Vec<&'a str> {
    distinct(rows.map(|row| row.method.as_str()))
}

fn markers(rows: &[&Measurement], joined: bool) -> Layer {
    let (name, style) = rows.first().map_or((String::new(), 0), |row| kind(&row.method));
    Layer::Markers { points: points(rows), label: Some(name), style, joined, source: None }
}

fn points(rows: &[&Measurement]) -> Vec<(f64, f64)> {
    rows.iter().filter_map(|row| row.point()).map(|(t, error)| (t, error.max(SMALLEST_ERROR))).collect()
}

/// The Pareto front as steps: between two of its points nothing is better than the quicker one.
fn front(rows: &[&Measurement]) -> Layer {
    let on_front: Vec<&Measurement> = rows.iter().filter(|row| row.on_front).copied().collect();
    let mut corners = points(&on_front);
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for (t, error) in corners {
        if let Some((_, above)) = steps.last().copied() {
            steps.push((t, above));
        }
        steps.push((t, error));
    }
    Layer::Exact { points: steps, label: Some("Pareto front".to_owned()) }
}

/// One scale of errors for all panels.
fn error_axis(label: &str, rows: &[&Measurement]) -> Axis {
    let errors = points(rows).into_iter().map(|(_, error)| error);
    let (low, high) = errors.fold((f64::INFINITY, 0.0_f64), |(low, high), e| (low.min(e), high.max(e)));
    let range = (low < high).then_some((low / 2.0, high * 2.0));
    let axis = Axis { range, ..Axis::log(label) };
    // What is smaller is drawn there.
    if low > SMALLEST_ERROR {
        axis
    } else {
        axis.named(SMALLEST_ERROR, format!("≤ {}", number(SMALLEST_ERROR)))
    }
}

fn panel_of(y: Axis, layers: Vec<Layer>, title: String) -> Panel {
    Panel::new(Axis::log(SECONDS), y, layers).titled(literal(&title))
}

fn figure(panels: Vec<Panel>, columns: usize) -> Figure {
    let mut figure = Figure::new(Width::Double, panels);
    figure.columns = columns;
    figure.naming = Naming::Legend;
    figure
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_can_be_printed() {
        for (_, name, _) in KINDS {
            assert!(figure::check_label(name).is_ok(), "{name}");
        }
    }
}
