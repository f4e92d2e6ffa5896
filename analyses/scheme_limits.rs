//! How large a step does each scheme stand, and which ratio is free of cost to it?
//!
//! The contact is held closed. The limit of central differences is the spectrum's, 2/omega_max; the predictor-corrector
//! stands dt^2 s' mu = 1, the Park scheme the step at which its amplification matrix has the multiplier -1. For every mass
//! matrix: Fig. 3 of the paper with the four limits side by side, maps over (beta_s, r), the largest ratio that costs no
//! step against the contact-free scene, and, since every ratio costs the Park scheme a step, how much each ratio costs.

use std::process::ExitCode;

use analyses::charts;
use analyses::cli::{
    Job, Limit, LimitOptions, Output, OutputOptions, Progress, SceneOptions, Solved, Verdict, arguments,
    check_stems, finish, print_table, scheme_lines,
};
use analyses::error::{Refusal, Result};
use analyses::record::{OptimalRatioRow, StabilityRow};
use bipenalty::penalty::StiffnessPenalty;
use bipenalty::stability::{Axis, EngineName, Model, check_has_contact, optimal_scheme_ratio};
use clap::Parser;
use rayon::prelude::*;

/// The stability limits of the schemes themselves with closed contact, and their optimal ratios.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Averaging of the Park scheme, in [0, 1]
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 0.5)]
    theta: f64,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  scheme-limits                              a bar of 100 elements on a wall
  scheme-limits hunek --mass lumped --theta 1
  scheme-limits my-bars.toml --mass lumped --stdout csv";

const LIMITS: [Limit; 4] =
    [Limit::Spectrum, Limit::CentralDifference, Limit::PredictorCorrector, Limit::Park];

/// beta_s of a contact so stiff that only the ratio limits the step.
const STIFF: f64 = 1e6;

fn main() -> ExitCode {
    finish(run(&arguments::<Options>()))
}

fn run(options: &Options) -> Result<Verdict> {
    let models = plan(options)?;
    let output = Output::prepare(&options.output, "scheme-limits")?;
    if options.output.explain {
        Output::print_text(&models.iter().map(explain).collect::<String>())?;
        return Ok(Verdict::Holds);
    }
    let mut jobs = Vec::new();
    for model in &models {
        jobs.extend(figures(model)?.into_iter().map(|job| (model, job)));
    }
    let points = jobs.iter().map(|(_, job)| job.points() * limits(job).count()).sum();
    let progress = Progress::new(points, "points", options.output.quiet);
    let (mut printed, mut files) = (Vec::new(), 0);
    for (model, job) in &jobs {
        let rows = solve(job, model, options.theta, &progress)?;
        files += output.write_rows(&job.stem, &rows.concat())?.len();
        if output.wants_figures() {
            files += draw(job, model, &rows, options.theta, &output)?;
        }
        printed.extend(rows.concat());
    }
    for models in models.chunks(options.scene.mass.0.len()) {
        files += costs(models, options.theta, &output, &progress)?;
    }
    drop(progress);
    let ratios = optimal_ratios(&models, options.theta, &output, &mut files)?;
    output.print(&printed)?;
    if !options.output.quiet {
        summarise(&printed, &ratios);
        output.report(files);
    }
    let certified = printed.iter().all(|row| row.stable_courant().is_some());
    let holds = certified && ratios.iter().all(|row| row.holds);
    Ok(if holds { Verdict::Holds } else { Verdict::Fails })
}

/// The bar of 100 elements on a wall unless told otherwise, with every mass matrix.
fn plan(options: &Options) -> Result<Vec<Model>> {
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = vec!["signorini".to_owned()];
    }
    let models: Vec<Model> = asked.scenes()?.iter().flat_map(|scene| asked.models(scene)).collect();
    models.iter().try_for_each(check_has_contact)?;
    for limit in LIMITS {
        models.iter().try_for_each(|model| settings(limit, options.theta).check(model))?;
    }
    check_stems(&options.output, models.iter().map(|model| stem("fig3", model)))?;
    Ok(models)
}

fn explain(model: &Model) -> String {
    let (scene, mass) = (model.scene().name(), model.mass().name());
    format!(
        "{scene}, {mass} mass: four limits as curves and maps, largest ratio without cost; left out: eigenvectors\n"
    )
}

fn stem(kind: &str, model: &Model) -> String {
    format!("{kind}-{}-{}", model.scene().name(), model.mass().name())
}

fn settings(limit: Limit, theta: f64) -> LimitOptions {
    let theta = (limit == Limit::Park).then_some(theta);
    LimitOptions { limit, theta, engine: EngineName::Auto }
}

/// Fig. 3 and the map of one model.
fn figures(model: &Model) -> Result<Vec<Job>> {
    let ratios = Axis::list([0.25, 1.0, 2.0, 3.0, f64::INFINITY]);
    let curves = Job::new(stem("fig3", model), vec![model.clone()], Axis::linear(0.0, 10.0, 401)?, ratios)?;
    let (beta_s, ratio) = (Axis::log(1e-2, 1e6, 161)?, Axis::log(0.05, 1e2, 97)?);
    Ok(vec![curves, Job::new(stem("map", model), vec![model.clone()], beta_s, ratio)?])
}

/// The rows of the limits, one panel each.
fn solve(job: &Job, model: &Model, theta: f64, progress: &Progress) -> Result<Vec<Vec<StabilityRow>>> {
    let panel = |limit: Limit| {
        let solved: Vec<Solved> = job.solve(&settings(limit, theta), progress)?;
        let of = |s: &Solved| StabilityRow::of(model, limit.name(), &s.curves);
        Ok(solved.iter().flat_map(of).collect())
    };
    limits(job).map(panel).collect()
}

/// The limits of a figure: a map shows the two that are not the spectrum's.
fn limits(job: &Job) -> impl Iterator<Item = Limit> {
    let map = is_map(job);
    LIMITS.into_iter().filter(move |limit| !map || limit.scheme().is_some())
}

fn is_map(job: &Job) -> bool {
    job.chart == analyses::cli::Chart::Map
}

fn draw(job: &Job, model: &Model, rows: &[Vec<StabilityRow>], theta: f64, output: &Output) -> Result<usize> {
    let figure = if is_map(job) {
        let range = |axis: &Axis| (axis.values[0], axis.values[axis.values.len() - 1]);
        let (beta_s, ratio) = (range(&job.beta_s), range(&job.ratio));
        let pencil = model.pencil();
        let mut lines = Vec::new();
        for (scheme, rows) in LIMITS.into_iter().filter_map(Limit::scheme).zip(rows) {
            let limit = model.limit(&*scheme.with_theta(theta)?, &pencil)?;
            lines.push(scheme_lines(model, &*limit, rows, beta_s, ratio));
        }
        charts::titled_by_limit(charts::map(rows, &lines), rows)
    } else {
        charts::titled_by_limit(charts::curves(&format!("{}.csv", job.stem), rows, false), rows)
    };
    Ok(output.write_figure(&job.stem, &figure)?.len())
}

/// The step that each ratio costs under a stiff contact, for the mass matrices of one scene and every limit but the
/// spectrum's.
fn costs(models: &[Model], theta: f64, output: &Output, progress: &Progress) -> Result<usize> {
    let mut rows = Vec::new();
    for model in models {
        let stem = format!("cost-{}-{}", model.scene().name(), model.mass().name());
        let (beta_s, ratio) = (Axis::list([0.0, STIFF]), Axis::log(1e-2, 1e2, 121)?);
        let job = Job::new(stem, vec![model.clone()], beta_s, ratio)?;
        rows.push(solve(&job, model, theta, progress)?.split_off(1));
    }
    let Some(first) = models.first() else { return Ok(0) };
    let stem = format!("cost-{}", first.scene().name());
    let mut files =
        output.write_rows(&stem, &rows.iter().flatten().flatten().cloned().collect::<Vec<_>>())?.len();
    if output.wants_figures() {
        files += output.write_figure(&stem, &charts::costs(&rows, theta))?.len();
    }
    Ok(files)
}

/// The largest ratio without cost to each scheme over beta_s.
fn optimal_ratios(
    models: &[Model],
    theta: f64,
    output: &Output,
    files: &mut usize,
) -> Result<Vec<OptimalRatioRow>> {
    let mut found = Vec::new();
    for scheme in [Limit::PredictorCorrector, Limit::Park] {
        let rows = models.iter().map(|model| ratios_of(model, scheme, theta)).collect::<Result<Vec<_>>>()?;
        let stem = format!("optimal-ratio-{}", scheme.name());
        *files += output.write_rows(&stem, &rows.concat())?.len();
        // Where every ratio costs a step, as with the Park scheme, there is nothing to draw.
        if let Some(figure) =
            charts::optimal_ratio(&format!("{stem}.csv"), &rows, true).filter(|_| output.wants_figures())
        {
            *files += output.write_figure(&stem, &figure)?.len();
        }
        found.extend(rows.concat());
    }
    Ok(found)
}

fn ratios_of(model: &Model, limit: Limit, theta: f64) -> Result<Vec<OptimalRatioRow>> {
    let Some(scheme) = limit.scheme() else { return Ok(Vec::new()) };
    let pencil = model.pencil();
    let found = model.limit(&*scheme.with_theta(theta)?, &pencil)?;
    let row = |beta_s: &f64| {
        let beta_s = StiffnessPenalty::new(*beta_s)?;
        let refused = |e| Refusal::new(model.scene().name(), e, "scenes whose limit can be certified");
        let ratio = optimal_scheme_ratio(model, &*found, beta_s).map_err(refused)?;
        let expected = found.expected_ratio(beta_s.get());
        Ok(OptimalRatioRow::new(model, limit.name(), beta_s.get(), ratio, expected))
    };
    Axis::log(1e-1, 1e6, 141)?.values.par_iter().map(row).collect()
}

/// One line a model and limit: what r = 1 costs at its worst, and the ratio that costs nothing.
fn summarise(rows: &[StabilityRow], ratios: &[OptimalRatioRow]) {
    let of = |row: &StabilityRow| (row.scene.clone(), row.mass.clone(), row.limit);
    let mut kinds: Vec<_> = rows.iter().map(of).collect();
    let mut known = std::collections::HashSet::new();
    kinds.retain(|kind| known.insert(kind.clone()));
    let smallest = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::min);
    let line = |kind: &(String, String, &'static str)| {
        let of_kind = || rows.iter().filter(|row| of(row) == *kind);
        let courant = StabilityRow::stable_courant;
        let bound = if of_kind().any(StabilityRow::is_lower_bound) { "at least " } else { "" };
        let free = of_kind().find(|row| row.stiffness_penalty.0 == 0.0).and_then(courant);
        let optimal = smallest(
            &mut of_kind()
                .filter(|row| row.ratio.0 == 1.0 && row.stiffness_penalty.0 <= 10.0)
                .filter_map(courant),
        );
        let kept = free.zip(optimal).map(|(free, optimal)| format!("{bound}{:.4}", optimal / free));
        let (scene, mass, limit) = kind.clone();
        let mine = |row: &&OptimalRatioRow| (&row.scene, &row.mass, row.limit) == (&scene, &mass, limit);
        let ratio = smallest(
            &mut ratios.iter().filter(mine).filter_map(|row| Some(row.optimal_ratio.or(row.lower)?.0)),
        );
        let ratio = match ratio {
            None => "-".to_owned(),
            Some(0.0) => "none".to_owned(),
            Some(ratio) => format!("{bound}{ratio:.6}"),
        };
        vec![scene, mass, limit.to_owned(), kept.unwrap_or("-".to_owned()), ratio]
    };
    let header = ["scene", "mass", "limit", "step kept at r = 1, beta_s up to 10", "largest r without cost"];
    print_table(&header, kinds.iter().map(line));
}
