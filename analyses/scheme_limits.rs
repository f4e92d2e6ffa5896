//! How large a step does each scheme stand, and which ratio is free of cost to it?
//!
//! The contact is held closed. The limit of central differences is the spectrum's, 2/omega_max; the predictor-corrector
//! stands dt^2 s' mu = 1, the Park scheme the step at which its amplification matrix has the multiplier -1. For every mass
//! matrix: Fig. 3 of the paper with the four limits side by side, maps over (beta_s, r), the largest ratio that costs no
//! step against the contact-free scene, and, since every ratio costs the Park scheme a step, how much each ratio costs.

use std::process::ExitCode;

use bipenalty::cli::{
    Job, Limit, LimitOptions, Output, OutputOptions, Progress, SceneOptions, Solved, Verdict, finish,
};
use bipenalty::error::{Refusal, Result};
use bipenalty::penalty::StiffnessPenalty;
use bipenalty::plot::charts;
use bipenalty::record::{OptimalRatioRow, StabilityRow};
use bipenalty::stability::{Axis, EngineName, Model, SchemeLimit, optimal_scheme_ratio, scheme_contour};
use clap::Parser;
use rayon::prelude::*;

/// The stability limits of the schemes themselves with closed contact, and their optimal ratios.
#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Averaging of the Park scheme, in [0, 1]
    #[arg(long, value_name = "T", default_value_t = 0.5)]
    theta: f64,
    #[command(flatten)]
    output: OutputOptions,
}

const LIMITS: [Limit; 4] =
    [Limit::Spectrum, Limit::CentralDifference, Limit::PredictorCorrector, Limit::Park];

/// beta_s of a contact so stiff that only the ratio limits the step.
const STIFF: f64 = 1e6;

fn main() -> ExitCode {
    finish(run(&Options::parse()))
}

fn run(options: &Options) -> Result<Verdict> {
    let models = plan(options)?;
    let output = Output::prepare(&options.output, "scheme-limits")?;
    if options.output.explain {
        models.iter().for_each(|model| {
            println!(
                "{}, {} mass: four limits as curves and maps",
                model.scene().name(),
                model.mass().name()
            );
        });
        return Ok(Verdict::Holds);
    }
    let progress = Progress::new(0, "points", options.output.quiet);
    let (mut printed, mut certified) = (Vec::new(), true);
    for model in &models {
        for job in jobs(model)? {
            let rows = solve(&job, model, options.theta, &progress)?;
            certified &= rows.iter().flatten().all(|row| row.critical_courant.is_some());
            output.write_rows(&job.stem, &rows.concat())?;
            if output.wants_figures() {
                draw(&job, model, &rows, options.theta, &output)?;
            }
            printed.extend(rows.concat());
        }
    }
    for models in models.chunks(options.scene.mass.0.len()) {
        costs(models, options.theta, &output, &progress)?;
    }
    let holds = optimal_ratios(&models, options.theta, &output)?;
    drop(progress);
    output.print(printed)?;
    Ok(if certified && holds { Verdict::Holds } else { Verdict::Fails })
}

/// The bar of 100 elements on a wall unless told otherwise, with every mass matrix.
fn plan(options: &Options) -> Result<Vec<Model>> {
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = vec!["signorini".to_owned()];
    }
    let models: Vec<Model> = asked.scenes()?.iter().flat_map(|scene| asked.models(scene)).collect();
    for limit in LIMITS {
        models.iter().try_for_each(|model| settings(limit, options.theta).check(model))?;
    }
    Ok(models)
}

fn settings(limit: Limit, theta: f64) -> LimitOptions {
    let theta = (limit == Limit::Park).then_some(theta);
    LimitOptions { limit, theta, engine: EngineName::Auto }
}

/// Fig. 3 and the map of one model.
fn jobs(model: &Model) -> Result<Vec<Job>> {
    let stem = |kind: &str| format!("{kind}-{}-{}", model.scene().name(), model.mass().name());
    let ratios = Axis::list([0.25, 1.0, 2.0, 3.0, f64::INFINITY]);
    let curves = Job::new(stem("fig3"), vec![model.clone()], Axis::linear(0.0, 10.0, 401)?, ratios)?;
    let (beta_s, ratio) = (Axis::log(1e-2, 1e6, 161)?, Axis::log(0.05, 1e2, 97)?);
    Ok(vec![curves, Job::new(stem("map"), vec![model.clone()], beta_s, ratio)?])
}

/// The rows of the four limits, one panel each; a map shows the two that are not the spectrum's.
fn solve(job: &Job, model: &Model, theta: f64, progress: &Progress) -> Result<Vec<Vec<StabilityRow>>> {
    let limits = LIMITS.into_iter().filter(|limit| !is_map(job) || limit.scheme().is_some());
    let panel = |limit: Limit| {
        let solved: Vec<Solved> = job.solve(&settings(limit, theta), progress)?;
        let of = |s: &Solved| StabilityRow::of(model, limit.name(), &s.curves, s.engine);
        Ok(solved.iter().flat_map(of).collect())
    };
    limits.map(panel).collect()
}

fn is_map(job: &Job) -> bool {
    job.chart == bipenalty::cli::Chart::Map
}

fn draw(job: &Job, model: &Model, rows: &[Vec<StabilityRow>], theta: f64, output: &Output) -> Result<()> {
    let figure = if is_map(job) {
        let range = |axis: &Axis| (axis.values[0], axis.values[axis.values.len() - 1]);
        let (beta_s, ratio) = (range(&job.beta_s), range(&job.ratio));
        let pencil = model.pencil();
        let mut lines = Vec::new();
        for (scheme, rows) in LIMITS.into_iter().filter_map(Limit::scheme).zip(rows) {
            let limit = SchemeLimit::new(model, &pencil, scheme, theta)?;
            let line = |level: f64| (level, scheme_contour(model, &limit, level, beta_s, ratio));
            lines.push(charts::levels(rows).into_iter().map(line).collect());
        }
        charts::titled_by_limit(charts::map(rows, &lines), rows)
    } else {
        charts::titled_by_limit(charts::curves(rows, false), rows)
    };
    output.write_figure(&job.stem, &figure)?;
    Ok(())
}

/// The step that each ratio costs under a stiff contact, for the mass matrices of one scene and every limit but the
/// spectrum's.
fn costs(models: &[Model], theta: f64, output: &Output, progress: &Progress) -> Result<()> {
    let mut rows = Vec::new();
    for model in models {
        let stem = format!("cost-{}-{}", model.scene().name(), model.mass().name());
        let (beta_s, ratio) = (Axis::list([0.0, STIFF]), Axis::log(1e-2, 1e2, 121)?);
        let job = Job::new(stem, vec![model.clone()], beta_s, ratio)?;
        rows.push(solve(&job, model, theta, progress)?.split_off(1));
    }
    let Some(first) = models.first() else { return Ok(()) };
    let stem = format!("cost-{}", first.scene().name());
    output.write_rows(&stem, &rows.iter().flatten().flatten().cloned().collect::<Vec<_>>())?;
    if output.wants_figures() {
        output.write_figure(&stem, &charts::costs(&rows, theta))?;
    }
    Ok(())
}

/// The largest ratio without cost to each scheme over beta_s; whether each enclosure holds the expected ratio.
fn optimal_ratios(models: &[Model], theta: f64, output: &Output) -> Result<bool> {
    let mut holds = true;
    for scheme in [Limit::PredictorCorrector, Limit::Park] {
        let mut all = Vec::new();
        for model in models {
            let rows = ratios_of(model, scheme, theta)?;
            holds &= rows.iter().all(|row| row.holds);
            all.push(rows);
        }
        let stem = format!("optimal-ratio-{}", scheme.name());
        output.write_rows(&stem, &all.concat())?;
        // Every ratio costs the Park scheme a step: nothing to draw.
        if output.wants_figures() && scheme == Limit::PredictorCorrector {
            output.write_figure(&stem, &charts::optimal_scheme_ratio(&all, true))?;
        }
    }
    Ok(holds)
}

fn ratios_of(model: &Model, limit: Limit, theta: f64) -> Result<Vec<OptimalRatioRow>> {
    let Some(scheme) = limit.scheme() else { return Ok(Vec::new()) };
    let pencil = model.pencil();
    let found = SchemeLimit::new(model, &pencil, scheme, theta)?;
    let row = |beta_s: &f64| {
        let beta_s = StiffnessPenalty::new(*beta_s)?;
        let refused = |e| Refusal::new(model.scene().name(), e, "scenes whose limit can be certified");
        let ratio = optimal_scheme_ratio(model, &found, beta_s).map_err(refused)?;
        let expected = found.expected_ratio(model, beta_s);
        Ok(OptimalRatioRow::new(model, limit.name(), beta_s.get(), ratio, expected))
    };
    Axis::log(1e-1, 1e6, 141)?.values.par_iter().map(row).collect()
}
