//! Are the predicted limits the limits? Stepping at them, from a state that excites every mode, says so.
//!
//! For each point of a grid the contacts are held closed, and the largest stable Courant number is searched by the growth
//! of the motion alone, beginning a little below and above the prediction: 2/omega_max for central differences, the limit
//! of the scheme itself for the others. Where growth above the limit is too slow for any run, the row says so.

use std::process::ExitCode;

use bipenalty::cli::{
    Output, OutputOptions, Progress, SceneOptions, Verdict, checked_grid, finish, print_verification,
    refuse_repeated,
};
use bipenalty::error::{Refusal, Result};
use bipenalty::plot::verify_charts;
use bipenalty::record::{StabilityRow, VerifyRow};
use bipenalty::scene::{Scene, load};
use bipenalty::schemes::Scheme;
use bipenalty::stability::{Axis, Grid, Model, map};
use bipenalty::verify::{Point, Predictor, Search, confirm};
use clap::Parser;
use rayon::prelude::*;

/// Limits confirmed by time stepping with closed contact; exit status 1 on any disagreement.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 0,0.5,10 or lin:0:10:11 or log:1e-3:1e12:20 (start:stop:count)
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = "lin:0:10:11")]
    beta_s: Axis,
    /// Penalty ratios r, in the same forms; inf is the pure penalty method
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = "0.5,1,2,3,inf")]
    ratio: Axis,
    /// Schemes: central-difference, predictor-corrector, park
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "central-difference,predictor-corrector,park"
    )]
    scheme: Vec<Scheme>,
    /// Averaging of the Park scheme, in [0, 1] [default: 0.5]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    theta: Option<f64>,
    /// Relative width to which stepping brackets a limit [default: 1e-6 for central differences, 1e-4 for the others]
    #[arg(long, value_name = "EPS", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  verify-limits                                   the points of Fig. 3, into figures/verify-limits/
  verify-limits signorini --mass lumped --beta-s log:1e-3:1e12:20 --ratio log:0.1:1e3:20 --tolerance 1e-4
  verify-limits signorini --elements 10 --scheme park --theta 1 --beta-s log:1e-2:1e6:9 --ratio 0.25,1,4
  verify-limits my-bars.toml --beta-s 10 --stdout csv";

/// One figure: models side by side, with one scheme.
struct Job {
    stem: String,
    models: Vec<Model>,
    scheme: Scheme,
    theta: f64,
    tolerance: f64,
}

fn main() -> ExitCode {
    finish(run(&Options::parse()))
}

fn run(options: &Options) -> Result<Verdict> {
    let grid = checked_grid(&options.beta_s, &options.ratio)?;
    let jobs = plan(options, &grid)?;
    let output = Output::prepare(&options.output, "verify-limits")?;
    if options.output.explain {
        Output::print_text(&jobs.iter().map(|job| explain(job, &grid)).collect::<String>())?;
        return Ok(Verdict::Holds);
    }
    let points = jobs.iter().map(|job| job.models.len() * grid.len()).sum();
    let progress = Progress::new(points, "limits", options.output.quiet);
    let (mut all, mut files) = (Vec::new(), 0);
    for job in &jobs {
        progress.doing(&job.stem);
        let mut rows = Vec::new();
        for model in &job.models {
            rows.push(measure(model, job, &grid, &progress)?);
        }
        files += output.write_rows(&job.stem, &rows.concat())?.len();
        if output.wants_figures() && is_drawn(&grid) {
            let predicted: Result<Vec<_>> =
                job.models.iter().map(|model| prediction(model, job, options)).collect();
            let figure = verify_charts::limits(&predicted?, &rows, options.beta_s.log);
            files += output.write_figure(&job.stem, &figure)?.len();
        }
        all.extend(rows);
    }
    drop(progress);
    output.print(all.iter().flatten())?;
    if !options.output.quiet {
        print_verification(&all);
        output.report(files);
    }
    let agree = all.iter().flatten().all(|row| row.agrees != Some(false));
    Ok(if agree { Verdict::Holds } else { Verdict::Fails })
}

/// Fig. 3 of the paper for every mass matrix, or the scenes that were asked for.
fn plan(options: &Options, grid: &Grid) -> Result<Vec<Job>> {
    let scenes: Vec<Scene> = if options.scene.scenes.is_empty() {
        let elements = options.scene.elements.unwrap_or(1);
        let fig3 = ["signorini", "symmetric"].map(|name| Ok(load(name)?.with_elements(elements)?));
        fig3.into_iter().collect::<Result<_>>()?
    } else {
        options.scene.scenes()?
    };
    if let Some(theta) = options.theta.filter(|_| !options.scheme.contains(&Scheme::Park)) {
        return Err(Refusal::new("--theta", theta, "no theta without --scheme park").into());
    }
    let mut jobs = Vec::new();
    for scheme in &options.scheme {
        let usual = if *scheme == Scheme::CentralDifference { 1e-6 } else { 1e-4 };
        let (theta, tolerance) = (options.theta.unwrap_or(0.5), options.tolerance.unwrap_or(usual));
        Search::to(tolerance, *scheme)?;
        for (i, mass) in options.scene.mass.0.iter().enumerate() {
            let models: Vec<Model> =
                scenes.iter().map(|scene| options.scene.models(scene).swap_remove(i)).collect();
            for model in &models {
                model.check_grid(grid)?;
                Predictor::new(model, &model.pencil(), *scheme, theta)?;
            }
            let names: Vec<&str> = scenes.iter().map(Scene::name).collect();
            let stem = format!("{}-{}-{}", names.join("-"), mass.name(), scheme.name());
            jobs.push(Job { stem, models, scheme: *scheme, theta, tolerance });
        }
    }
    if options.output.stdout.is_none() {
        refuse_repeated(scenes.iter().map(Scene::name))?;
        refuse_repeated(jobs.iter().map(|job| job.stem.as_str()))?;
    }
    Ok(jobs)
}

/// Steps at every point of the grid, in parallel, and compares with the prediction.
fn measure(model: &Model, job: &Job, grid: &Grid, progress: &Progress) -> Result<Vec<VerifyRow>> {
    let pencil = model.pencil();
    let predictor = Predictor::new(model, &pencil, job.scheme, job.theta)?;
    let ratios =
        grid.ratios.iter().flat_map(|ratio| grid.stiffness_penalties.iter().map(move |b| (*ratio, *b)));
    let points: Vec<Point> =
        ratios.map(|(ratio, stiffness_penalty)| Point { stiffness_penalty, ratio }).collect();
    let row = |point: &Point| -> Result<VerifyRow> {
        let confirmation = confirm(&predictor, *point, job.tolerance)?;
        progress.add(1);
        Ok(VerifyRow::new(model, job.scheme, *point, &confirmation))
    };
    points.par_iter().map(row).collect()
}

/// Whether the curves of a grid can be told apart.
fn is_drawn(grid: &Grid) -> bool {
    grid.stiffness_penalties.len() > 1 && grid.ratios.len() <= verify_charts::MOST_RATIOS
}

/// The predicted curves, finer than the measured points.
fn prediction(model: &Model, job: &Job, options: &Options) -> Result<Vec<StabilityRow>> {
    let ends = || options.beta_s.values.iter().copied();
    let (low, high) = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
    let fine = if options.beta_s.log { Axis::log(low, high, 201)? } else { Axis::linear(low, high, 201)? };
    let grid = Grid::new(&fine, &options.ratio)?;
    let pencil = model.pencil();
    let predictor = Predictor::new(model, &pencil, job.scheme, job.theta)?;
    let curves = map(model, &grid, predictor.engine(), &|_| ());
    Ok(StabilityRow::of(model, job.scheme.name(), &curves, predictor.engine().name()))
}

fn explain(job: &Job, grid: &Grid) -> String {
    format!(
        "{}: {} points to {:e}, from 2 trials each, begun at the prediction{}; left out: eigenvectors\n",
        job.stem,
        grid.len() * job.models.len(),
        job.tolerance,
        if is_drawn(grid) { "" } else { ", not drawn" }
    )
}
