//! Are the predicted limits the limits? Stepping at them, from a state that excites every mode, says so.
//!
//! For each point of a grid the contacts are held closed, and the largest stable Courant number is bisected from the
//! growth of the motion alone: no eigenvalue enters. It is then compared with the prediction.

use std::process::ExitCode;

use bipenalty::cli::{
    Contact, OpeningOptions, OpeningPlan, Output, OutputOptions, Progress, SceneOptions, Verdict,
    checked_grid, finish, print_table,
};
use bipenalty::error::{Refusal, Result};
use bipenalty::plot::verify_charts;
use bipenalty::record::{StabilityRow, VerifyRow};
use bipenalty::scene::{Scene, load};
use bipenalty::schemes::Scheme;
use bipenalty::stability::{Axis, EngineName, Grid, Model, map};
use bipenalty::verify::{Point, Search, largest_stable_courant};
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
    /// Schemes: central-difference
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "central-difference")]
    scheme: Vec<Scheme>,
    /// Relative width to which stepping brackets a limit
    #[arg(long, value_name = "EPS", allow_negative_numbers = true, default_value_t = 1e-6)]
    tolerance: f64,
    /// Contact: closed (held closed), opening (opens and closes)
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "closed,opening")]
    contact: Vec<Contact>,
    #[command(flatten)]
    opening: OpeningOptions,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  verify-limits                                   the points of Fig. 3, into figures/verify-limits/
  verify-limits signorini --mass lumped --beta-s log:1e-3:1e12:20 --ratio log:0.1:1e3:20 --tolerance 1e-4
  verify-limits my-bars.toml --beta-s 10 --stdout csv";

/// One figure: models side by side, with one scheme.
struct Job {
    stem: String,
    models: Vec<Model>,
    scheme: Scheme,
    search: Search,
}

fn main() -> ExitCode {
    finish(run(&Options::parse()))
}

fn run(options: &Options) -> Result<Verdict> {
    if !options.contact.contains(&Contact::Closed) {
        let models: Vec<Model> =
            options.scene.scenes()?.iter().flat_map(|s| options.scene.models(s)).collect();
        let grid = checked_grid(&options.beta_s, &options.ratio)?;
        let plan = OpeningPlan::new(&models, &options.scheme, 0.5, &grid, &options.opening)?;
        let output = Output::prepare(&options.output, "verify-limits")?;
        if options.output.explain {
            Output::print_text(&plan.explain())?;
            return Ok(Verdict::Holds);
        }
        let progress = Progress::new(plan.len(), "runs", options.output.quiet);
        let result = plan.measure(&progress)?;
        drop(progress);
        let files = result.write(&output)?;
        output.print(&result.limits)?;
        if !options.output.quiet {
            result.summarise(&plan);
            output.report(files);
        }
        return Ok(if result.holds { Verdict::Holds } else { Verdict::Fails });
    }
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
            rows.push(measure(model, job, &grid, options.tolerance, &progress)?);
        }
        files += output.write_rows(&job.stem, &rows.concat())?.len();
        if output.wants_figures() && grid.stiffness_penalties.len() > 1 {
            let predicted: Result<Vec<_>> =
                job.models.iter().map(|model| prediction(model, options)).collect();
            let figure = verify_charts::limits(&predicted?, &rows, options.beta_s.log);
            files += output.write_figure(&job.stem, &figure)?.len();
        }
        all.extend(rows);
    }
    drop(progress);
    output.print(all.iter().flatten())?;
    if !options.output.quiet {
        summarise(&all);
        output.report(files);
    }
    let agree = all.iter().flatten().all(|row| row.agrees);
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
    let mut jobs = Vec::new();
    for scheme in &options.scheme {
        if *scheme != Scheme::CentralDifference {
            return Err(Refusal::new("--scheme", scheme.name(), Scheme::CentralDifference.name()).into());
        }
        let search = Search::to(options.tolerance, *scheme)?;
        for (i, mass) in options.scene.mass.0.iter().enumerate() {
            let models: Vec<Model> =
                scenes.iter().map(|scene| options.scene.models(scene).swap_remove(i)).collect();
            models.iter().try_for_each(|model| model.check_grid(grid))?;
            let names: Vec<&str> = scenes.iter().map(Scene::name).collect();
            let stem = format!("{}-{}-{}", names.join("-"), mass.name(), scheme.name());
            jobs.push(Job { stem, models, scheme: *scheme, search });
        }
    }
    Ok(jobs)
}

/// Steps at every point of the grid, in parallel, and compares with 2/omega_max.
fn measure(
    model: &Model,
    job: &Job,
    grid: &Grid,
    tolerance: f64,
    progress: &Progress,
) -> Result<Vec<VerifyRow>> {
    let engine = model.engine(EngineName::Auto, None);
    let ratios =
        grid.ratios.iter().flat_map(|ratio| grid.stiffness_penalties.iter().map(move |b| (*ratio, *b)));
    let points: Vec<Point> =
        ratios.map(|(ratio, stiffness_penalty)| Point { stiffness_penalty, ratio }).collect();
    let row = |point: &Point| -> Result<VerifyRow> {
        let penalties = model.penalties(point.stiffness_penalty, point.ratio);
        let predicted = model.critical_courant(engine.estimate(&penalties, None));
        // theta is for the Park scheme alone.
        let found = largest_stable_courant(model, job.scheme, 0.5, *point, &job.search)?;
        progress.add(1);
        Ok(VerifyRow::new(model, job.scheme, *point, predicted, &found, tolerance))
    };
    points.par_iter().map(row).collect()
}

/// The predicted curves, finer than the measured points.
fn prediction(model: &Model, options: &Options) -> Result<Vec<StabilityRow>> {
    let ends = || options.beta_s.values.iter().copied();
    let (low, high) = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
    let fine = if options.beta_s.log { Axis::log(low, high, 201)? } else { Axis::linear(low, high, 201)? };
    let grid = Grid::new(&fine, &options.ratio)?;
    let engine = model.engine(EngineName::Auto, None);
    let curves = map(model, &grid, engine.as_ref(), &|_| ());
    Ok(StabilityRow::of(model, "spectrum", &curves, engine.name()))
}

fn explain(job: &Job, grid: &Grid) -> String {
    format!(
        "{}: {} points, about 25 trials of up to {} steps each; predicted in closed form; left out: eigenvectors\n",
        job.stem,
        grid.len() * job.models.len(),
        job.search.steps
    )
}

fn summarise(all: &[Vec<VerifyRow>]) {
    let header =
        ["scene", "elements", "mass", "scheme", "points", "agree", "largest distance from the prediction"];
    let line = |rows: &Vec<VerifyRow>| {
        let first = &rows[0];
        let distance =
            |row: &VerifyRow| (0.5 * (row.stable_at.0 + row.unstable_at.0) / row.predicted.0 - 1.0).abs();
        let agree = rows.iter().filter(|row| row.agrees).count();
        vec![
            first.scene.clone(),
            first.elements.to_string(),
            first.mass.clone(),
            first.scheme.to_owned(),
            rows.len().to_string(),
            if agree == rows.len() { "all".to_owned() } else { format!("{agree}, NOT ALL") },
            format!("{:.1e}", rows.iter().map(distance).fold(0.0, f64::max)),
        ]
    };
    print_table(&header, all.iter().map(line));
}
