//! The table that answers the user's question first: how large is the linear limit of closed contact, and does r = 1 keep
//! it? Nothing here is called safe: contact that opens and closes may gain energy below its linear limit.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table, Width};

use super::Solved;
use crate::record::{CostRow, GIVEN, ImpactRow, Number, OptimalRatioRow};
use bipenalty::stability::{AnyModel, CriticalStep, Curve, Model};

/// What the summary says of one scene with one mass matrix, over all its maps.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSummary {
    scene: String,
    elements: Option<usize>,
    mass: String,
    free: String,
    linear_limit: String,
    verdict: String,
    /// C_r, whether it is a lower bound, and where.
    lowest: Option<(f64, bool, String)>,
    points: usize,
    uncertified: usize,
    seconds: f64,
    touches: bool,
    /// Whether every value is certified and r = 1 keeps the element limit.
    pub holds: bool,
}

/// Up to this many points are answered in words.
pub const FEW_POINTS: usize = 8;

/// What stands below every table of limits.
const CAUTION: &str = "The limits are linear, of closed contact. Contact that opens and closes may gain energy below them: central \
                       differences with a mass penalty did at every step measured; the predictor-corrector at r = 1/4 did not \
                       up to C = 0.99 (verify-limits --contact opening).";

const HEADER: [&str; 7] =
    ["limit at r = 1", "kept", "scene", "elements", "mass", "C_r free", "smallest C_r (beta_s, r)"];

/// What the letters of a summary stand for.
pub(super) const WORDS: &str = "Limit: of the linear scheme with closed contact; kept: r = 1 costs none of it; C_r: critical Courant \
                                number c0 dt_cr/h (of meshes omega_ref dt_cr/2), free: without contact; beta_s: contact stiffness over E A/h; r: ratio of stiffness to mass penalty, 1 keeps the contact-free limit.";

impl MapSummary {
    /// The summary of `solved`.
    pub fn of(solved: &Solved) -> Self {
        let model = &*solved.model;
        let free = solved.contact_free;
        let optimal = smallest(&solved.optimal).map(|(step, _)| step);
        let (verdict, keeps) = match (free, optimal) {
            (Ok(free), Some(step)) => verdict(solved, free, step),
            _ => ("not certified".to_owned(), false),
        };
        let lowest = solved.curves.iter().filter_map(|curve| Some((smallest(curve)?, curve.ratio)));
        let lowest = lowest.min_by(|a, b| a.0.0.critical_courant.total_cmp(&b.0.0.critical_courant));
        let points = || solved.curves.iter().flat_map(|curve| &curve.points);
        let uncertified = points().filter(|point| point.step.is_err()).count();
        Self {
            scene: model.name().to_owned(),
            elements: model.elements(),
            mass: model.mass().map_or(GIVEN.to_owned(), |mass| mass.name()),
            free: free.map_or("-".to_owned(), |step| format!("{:.6}", step.critical_courant)),
            linear_limit: optimal.map_or("-".to_owned(), |step| {
                let seconds = format!("{:.5e} s", solved.seconds_of(step.lower));
                if step.is_lower_bound() { format!("at least {seconds} (lower bound)") } else { seconds }
            }),
            verdict,
            lowest: lowest.map(|((step, beta_s), ratio)| {
                let at = format!("({}, {})", short(beta_s), short(ratio.get()));
                (step.critical_courant, step.is_lower_bound(), at)
            }),
            points: points().count(),
            uncertified,
            seconds: solved.seconds,
            touches: model.contacts() > 0,
            holds: uncertified == 0 && keeps,
        }
    }

    /// Adds the summary of another map of the same scene and mass; `false` if it is of another one.
    fn absorb(&mut self, other: &Self) -> bool {
        if (&self.scene, self.elements, &self.mass) != (&other.scene, other.elements, &other.mass) {
            return false;
        }
        let lower = |a: &(f64, bool, String), b: &(f64, bool, String)| a.0 < b.0;
        if self.lowest.as_ref().zip(other.lowest.as_ref()).is_none_or(|(mine, theirs)| lower(theirs, mine)) {
            self.lowest = other.lowest.clone();
        }
        if !other.holds {
            self.verdict.clone_from(&other.verdict);
        }
        self.points += other.points;
        self.uncertified += other.uncertified;
        self.seconds += other.seconds;
        self.holds &= other.holds;
        true
    }

    fn cells(&self) -> Vec<String> {
        let mut verdict = self.verdict.clone();
        if self.uncertified > 0 {
            verdict += &format!(", {} not certified", count(self.uncertified));
        }
        let lowest = self.lowest.as_ref();
        vec![
            self.linear_limit.clone(),
            verdict,
            self.scene.clone(),
            self.elements.map_or("-".to_owned(), |n| n.to_string()),
            self.mass.clone(),
            self.free.clone(),
            lowest.map_or("-".to_owned(), |(courant, bound, at)| {
                format!("{}{courant:.4e} {at}", if *bound { "at least " } else { "" })
            }),
        ]
    }
}

/// The point of least C_r.
fn smallest(curve: &Curve) -> Option<(CriticalStep, f64)> {
    let certified = curve.points.iter().map(|p| Some((p.step.ok()?, p.stiffness_penalty.get())));
    certified.flatten().min_by(|a, b| a.0.critical_courant.total_cmp(&b.0.critical_courant))
}

/// Whether r = 1 kept the contact-free limit, and how far off; false only if it fell below the element limit.
fn verdict(solved: &Solved, free: CriticalStep, optimal: CriticalStep) -> (String, bool) {
    if solved.model.contacts() == 0 {
        return ("no contact".to_owned(), true);
    }
    if !solved.limit.is_spectrum() {
        // A scheme need not keep it; what it keeps is the answer.
        let kept = optimal.critical_courant / free.critical_courant;
        let text = match optimal.is_lower_bound() {
            true if optimal.lower >= free.lower => "yes".to_owned(),
            true => format!("keeps at least {kept:.4} of it"),
            false if optimal.upper >= free.lower => "yes".to_owned(),
            false => format!("keeps {kept:.4} of it"),
        };
        return (text, true);
    }
    // What the mediant inequality promises: no less than the contact-free limit or that of the reference.
    let promised = match &*solved.model {
        AnyModel::Bars(model) => element_limit(model),
        AnyModel::Mesh(_) => 1.0,
    };
    let as_promised = optimal.upper >= promised.min(free.lower) * (1.0 - 4.0 * f64::EPSILON);
    let text = match (optimal.upper >= free.lower, as_promised) {
        (true, _) => kept(free, optimal),
        (false, true) => {
            let cost = 1.0 - optimal.critical_courant / free.critical_courant;
            format!("{} limit yes, costs {cost:.1e}", reference_name(&solved.model))
        }
        (false, false) => "NO".to_owned(),
    };
    (text, as_promised)
}

/// C_r of the element of highest frequency.
fn element_limit(model: &Model) -> f64 {
    let highest =
        model.scene().bars().iter().map(|bar| model.mass().element_eigenvalue(bar)).fold(0.0, f64::max);
    let reference = model.reference_eigenvalue();
    model.critical_courant(reference) * (reference / highest).sqrt()
}

fn reference_name(model: &AnyModel) -> &'static str {
    match model {
        AnyModel::Bars(_) => "element",
        AnyModel::Mesh(_) => "reference",
    }
}

/// How well a limit is known to be kept: in roundings where it is known to that, else by the width of the enclosure.
fn kept(free: CriticalStep, optimal: CriticalStep) -> String {
    let width = optimal.upper / optimal.lower - 1.0;
    if width > 1e-12 {
        return format!("yes (to {width:.0e})");
    }
    let units = (free.critical_courant - optimal.critical_courant) / (free.critical_courant * f64::EPSILON);
    format!("yes ({:.1} eps)", units.max(0.0))
}

/// Prints one line a scene and mass matrix.
pub fn print_summaries(summaries: &[MapSummary]) {
    let mut merged: Vec<MapSummary> = Vec::new();
    for summary in summaries {
        if !merged.iter_mut().any(|known| known.absorb(summary)) {
            merged.push(summary.clone());
        }
    }
    print_table(&HEADER, merged.iter().map(MapSummary::cells));
    let points = merged.iter().map(|summary| summary.points).sum();
    crate::tell!("{} in {}", count(points), duration(merged.iter().map(|summary| summary.seconds).sum()));
    say(WORDS);
    if merged.iter().any(|summary| summary.touches) {
        say(CAUTION);
    }
}

/// Scene, elements, mass, what was found and whether it holds: the middle of a line on optimal ratios.
pub fn tabulate_ratios(rows: &[OptimalRatioRow]) -> Vec<String> {
    let Some(first) = rows.first() else { return Vec::new() };
    let found = rows.iter().filter_map(|row| Some((row.optimal_ratio?.0, row.upper?.0 - row.lower?.0)));
    let narrowest = found.clone().min_by(|a, b| a.1.total_cmp(&b.1));
    let widest = found.max_by(|a, b| a.1.total_cmp(&b.1));
    let text = match (narrowest, widest) {
        (Some((ratio, narrow)), Some((_, wide))) => format!("{ratio:.12}, {narrow:.1e} to {wide:.1e}"),
        _ => match rows.iter().filter_map(|row| row.lower).map(|lower| lower.0).reduce(f64::min) {
            Some(lower) => format!("at least {lower:.12} (lower bound)"),
            None => "no ratio costs a step".to_owned(),
        },
    };
    let failing = rows.iter().find(|row| !row.holds);
    let holds =
        failing.map_or("yes".to_owned(), |row| format!("NO, at beta_s = {}", short(row.stiffness_penalty.0)));
    let elements = first.elements.map_or("-".to_owned(), |n| n.to_string());
    vec![first.scene.clone(), elements, first.mass.clone(), text, holds]
}

/// Prints one line a scheme: the cheapest and the dearest penalty of each ratio.
pub fn print_costs(rows: &[CostRow]) {
    let header = ["scene", "mass", "scheme", "forces a step", "r", "relative cost"];
    let curves = rows.chunk_by(|a, b| {
        (&a.scene, &a.mass, a.limit, a.parameter, a.ratio)
            == (&b.scene, &b.mass, b.limit, b.parameter, b.ratio)
    });
    let cells = |curve: &[CostRow]| {
        let costs = || curve.iter().filter_map(|row| row.cost).map(|cost| cost.0);
        let (low, high) = (costs().fold(f64::INFINITY, f64::min), costs().fold(0.0, f64::max));
        let row = &curve[0];
        let cost = match [low, high].map(|value| format!("{value:.4}")) {
            _ if low > high => "not certified".to_owned(),
            [low, high] if low == high => low,
            [low, high] => format!("{low} to {high}"),
        };
        let named = |p: Number| format!("{} {}", row.limit, (1e4 * p.0).round() / 1e4);
        let scheme = row.parameter.map_or(row.limit.to_owned(), named);
        vec![
            row.scene.clone(),
            row.mass.clone(),
            scheme,
            row.evaluations.to_string(),
            short(row.ratio.0),
            cost,
        ]
    };
    print_table(&header, curves.map(cells));
}

/// Prints one line a run, a table for each scene and mass.
pub fn print_impacts(rows: &[ImpactRow]) {
    let header = ["scheme", "beta_s", "r", "force error", "steady g/h", "energy ratio", "switches", "ending"];
    let optional = |x: Option<Number>| x.map_or("-".to_owned(), |x| format!("{:.4e}", x.0));
    let cells = |row: &ImpactRow| {
        vec![
            row.scheme.to_owned(),
            short(row.stiffness_penalty.0),
            short(row.ratio.0),
            optional(row.force_error),
            optional(row.steady_relative_gap),
            row.energy_ratio.map_or("-".to_owned(), |x| ratio(x.0)),
            row.switches.to_string(),
            row.ending.clone(),
        ]
    };
    for rows in rows.chunk_by(|a, b| (&a.scene, &a.mass) == (&b.scene, &b.mass)) {
        crate::tell!("{}, {} mass", rows[0].scene, rows[0].mass);
        print_table(&header, rows.iter().map(cells));
    }
    let gained = rows.iter().filter(|row| row.gained).count();
    if gained > 0 {
        let all = rows.len();
        crate::tell!(
            "{gained} of {all} runs ended with more energy than they were given, from contact: a step below the linear limit does not \
             prevent it; up to --relative-courant 0.99 buffered central differences (--scheme buffered) cannot, at any ratio, \
             and the predictor-corrector at r = 1/4 (--scheme predictor-corrector --ratio 0.25) did not"
        );
    }
    let blown_up = rows.iter().filter(|row| row.ending.starts_with("blew up")).count();
    if blown_up > 0 {
        let all = rows.len();
        crate::tell!(
            "{blown_up} of {all} runs blew up, so that they have no errors and are in no figure: \
             their step is too large for the scheme; a smaller --relative-courant or --ratio helps"
        );
    }
}

/// A ratio that is near 1 where all is well, and may be any number where it is not.
fn ratio(x: f64) -> String {
    if (1e-3..1e4).contains(&x) { format!("{x:.6}") } else { format!("{x:.4e}") }
}

/// Prints a paragraph on standard error, its lines within the columns of a summary.
pub(super) fn say(text: &str) {
    crate::tell!("{}", wrapped(text, COLUMNS.into()));
}

/// The words of `text` in lines of up to `columns` letters, all but the first indented.
fn wrapped(text: &str, columns: usize) -> String {
    let (mut lines, mut line) = (Vec::new(), String::new());
    for word in text.split(' ') {
        let width = line.chars().count() + 1 + word.chars().count();
        if !line.trim().is_empty() && width > columns {
            lines.push(std::mem::replace(&mut line, "   ".to_owned()));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    lines.push(line);
    lines.join("\n")
}

/// Columns of a summary: what fits on a page and into half a screen.
const COLUMNS: u16 = 100;

/// Prints a plain table on standard error; cells that do not fit go on in a second line, between words.
pub fn print_table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) {
    crate::tell!("{}", arranged(header, rows));
}

fn arranged(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    const APART: u16 = 2;
    let longest = |text: &str| text.split_whitespace().map(|word| word.chars().count()).max().unwrap_or(0);
    let mut words: Vec<usize> = header.iter().map(|cell| longest(cell)).collect();
    let mut table = Table::new();
    table.load_preset(NOTHING).set_content_arrangement(ContentArrangement::Dynamic).set_width(COLUMNS);
    table.set_header(header.iter().map(|cell| cell.to_string()));
    for row in rows {
        words.iter_mut().zip(&row).for_each(|(word, cell)| *word = longest(cell).max(*word));
        table.add_row(row);
    }
    for (column, word) in table.column_iter_mut().zip(words) {
        // A column is counted with its padding.
        let least = u16::try_from(word).unwrap_or(COLUMNS).saturating_add(APART);
        column.set_constraint(ColumnConstraint::LowerBoundary(Width::Fixed(least)));
        column.set_padding((0, APART)).set_cell_alignment(CellAlignment::Left);
    }
    table.trim_fmt()
}

/// A number as short as it can be written.
pub(super) fn short(x: f64) -> String {
    let (plain, power) = (format!("{x}"), format!("{x:e}"));
    if plain.len() <= power.len() { plain } else { power }
}

fn count(points: usize) -> String {
    format!("{points} point{}", if points == 1 { "" } else { "s" })
}

fn duration(seconds: f64) -> String {
    if seconds < 1e-3 { format!("{:.0} us", seconds * 1e6) } else { format!("{:.3} s", seconds) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_fit_and_lose_no_word() {
        let lines = wrapped(CAUTION, 100);
        assert!(
            lines.lines().count() > 1 && lines.lines().all(|line| line.chars().count() <= 100),
            "{lines}"
        );
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(words(&lines), words(CAUTION));
        assert_eq!(wrapped("one", 2), "one");
    }

    #[test]
    fn tables_break_between_words() {
        let words = ["predictor-corrector", "finished with 5.0 times its energy", "1.2345e-6"];
        let row: Vec<String> = words.iter().cycle().take(9).map(|word| (*word).to_owned()).collect();
        let table = arranged(&["a header"; 9], [row]);
        for word in words.iter().flat_map(|text| text.split(' ')) {
            assert_eq!(table.matches(word).count(), 3, "{word}:\n{table}");
        }
        assert!(table.lines().count() > 2);
    }
}
