//! Does r = 1 hold? The largest penalty ratio that costs no time step, bracketed on certified eigenvalues.
//!
//! For every scene, mass matrix and stiffness penalty the ratio r is bisected between a bound that is proven to cost
//! nothing (mediant inequality on the Rayleigh quotient) and one that is proven to cost a step (the enclosures of the
//! penalised and the contact-free l_max are apart). The expected ratio is r* = l_max(K, M)/omega_e^2, which is 1 for
//! bars with free ends.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use analyses::charts;
use analyses::cli::{
    self, LimitOptions, Output, OutputOptions, Progress, SceneOptions, Verdict, arguments, check_stems,
    checked_grid, finish, print_table, redraw_optimal_ratio, require_memory, tabulate_ratios,
};
use analyses::error::{Refusal, Result};
use analyses::record::OptimalRatioRow;
use bipenalty::penalty::StiffnessPenalty;
use bipenalty::stability::{
    Axis, Expectation, Grid, Model, check_has_contact, governing_bar, optimal_ratio, optimal_scheme_ratio,
};
use clap::{Parser, ValueHint};
use rayon::prelude::*;

/// The largest penalty ratio r that costs no time step, with its enclosure, over the stiffness penalty.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 1,1e4 or lin:1:10:10 or log:1e-3:1e12:61 (start:stop:count)
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = "log:1e-3:1e12:61")]
    beta_s: Axis,
    #[command(flatten)]
    limit: LimitOptions,
    /// Draw the records of a CSV file, written by an earlier run, again without computing
    #[arg(long, value_name = "FILE.csv", value_hint = ValueHint::FilePath, conflicts_with_all = ["scenes",
        "elements", "mass", "penalty_mass", "beta_s", "limit", "theta", "engine"])]
    from: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  optimal-ratio                                     the built-in scenes, into figures/optimal-ratio/
  optimal-ratio my-bars.toml --beta-s 1e4           which r costs nothing, and which bar governs
  optimal-ratio hunek --limit predictor-corrector   which r is free of cost for that scheme
  optimal-ratio signorini --mass lumped --beta-s log:1:1e16:17 --stdout csv
  optimal-ratio --from figures/optimal-ratio/signorini.csv --width single --format pdf";

/// What was found for one model.
struct Found {
    model: Model,
    /// The expected ratio where it is one for every beta_s.
    expected: Option<f64>,
    rows: Vec<OptimalRatioRow>,
}

fn main() -> ExitCode {
    finish(run(&arguments::<Options>()))
}

fn run(options: &Options) -> Result<Verdict> {
    if let Some(file) = &options.from {
        return redraw(file, options);
    }
    let models = plan(options)?;
    let output = Output::prepare(&options.output, "optimal-ratio")?;
    let grid = checked_grid(&options.beta_s, &Axis::list([1.0, 1e12]))?;
    // A row with its text and its cells.
    require_memory(&grid, 2000)?;
    models.iter().flatten().try_for_each(|model| model.check_grid(&grid))?;
    if options.output.explain {
        let plan: String = models.iter().flatten().map(|model| explain(model, options, &grid)).collect();
        Output::print_text(&plan)?;
        return Ok(Verdict::Holds);
    }
    let points = models.iter().flatten().count() * grid.stiffness_penalties.len();
    let progress = Progress::new(points, "ratios", options.output.quiet);
    let (mut all, mut holds, mut files) = (Vec::new(), true, 0);
    for models in &models {
        let mut found = Vec::new();
        for model in models {
            found.push(search(model, &grid, &options.limit, &progress)?);
        }
        let name = models[0].scene().name();
        let rows: Vec<Vec<OptimalRatioRow>> = found.iter().map(|found| found.rows.clone()).collect();
        files += output.write_rows(name, &rows.concat())?.len();
        if output.wants_figures() && options.beta_s.values.len() > 1 {
            let log = charts::is_logarithmic(&options.beta_s.values);
            if let Some(figure) = charts::optimal_ratio(&format!("{name}.csv"), &rows, log) {
                files += output.write_figure(name, &figure)?.len();
            }
        }
        holds &= rows.iter().flatten().all(|row| row.holds);
        all.extend(found);
    }
    drop(progress);
    output.print(all.iter().flat_map(|found| &found.rows))?;
    if !options.output.quiet {
        summarise(&all);
        output.report(files);
    }
    Ok(if holds { Verdict::Holds } else { Verdict::Fails })
}

/// The figure of records that an earlier run has left; whether every row of them holds.
fn redraw(file: &Path, options: &Options) -> Result<Verdict> {
    let output = Output::prepare(&options.output, "optimal-ratio")?;
    if options.output.explain {
        Output::print_text(&format!("{}: drawn again; left out: every computation\n", file.display()))?;
        return Ok(Verdict::Holds);
    }
    let (rows, files) = redraw_optimal_ratio(file, &output)?;
    output.print(&rows)?;
    if !options.output.quiet {
        output.report(files);
    }
    Ok(if rows.iter().all(|row| row.holds) { Verdict::Holds } else { Verdict::Fails })
}

/// The models of every scene, one a mass matrix; the built-in scenes if none is named.
fn plan(options: &Options) -> Result<Vec<Vec<Model>>> {
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = ["signorini", "symmetric", "hunek"].map(str::to_owned).to_vec();
    }
    let models: Vec<Vec<Model>> = asked.scenes()?.iter().map(|scene| asked.models(scene)).collect();
    models.iter().flatten().try_for_each(check_has_contact)?;
    models.iter().flatten().try_for_each(|model| options.limit.check(model))?;
    check_stems(&options.output, models.iter().map(|models| models[0].scene().name().to_owned()))?;
    Ok(models)
}

/// Brackets the optimal ratio of one model at every beta_s, in parallel.
fn search(model: &Model, grid: &Grid, options: &LimitOptions, progress: &Progress) -> Result<Found> {
    progress.doing(model.scene().name());
    let uncertified =
        |error| Refusal::new(model.scene().name(), error, "scenes whose limit can be certified");
    let pencil = options.needs_pencil().then(|| model.pencil());
    let name = options.limit.name();
    let betas = grid.stiffness_penalties.par_iter();
    if let (Some(scheme), Some(pencil)) = (options.limit.scheme(), &pencil) {
        let limit = model.limit(&*scheme.with_theta(options.theta())?, pencil)?;
        let row = |beta_s: &StiffnessPenalty| {
            let found = optimal_scheme_ratio(model, &*limit, *beta_s)?;
            progress.add(1);
            let expected = limit.expected_ratio(beta_s.get());
            Ok(OptimalRatioRow::new(model, name, beta_s.get(), found, expected))
        };
        let rows = betas.map(row).collect::<Result<_, _>>().map_err(uncertified)?;
        return Ok(Found { model: model.clone(), expected: None, rows });
    }
    let engine = options.find(model, pencil.as_ref())?;
    let expectation = Expectation::of(model, &*engine).map_err(uncertified)?;
    let expected = Some(expectation.ratio());
    let row = |beta_s: &StiffnessPenalty| {
        let found = optimal_ratio(model, &*engine, &expectation, *beta_s)?;
        progress.add(1);
        Ok(OptimalRatioRow::new(model, name, beta_s.get(), found, expected))
    };
    let rows = betas.map(row).collect::<Result<_, _>>().map_err(uncertified)?;
    Ok(Found { model: model.clone(), expected, rows })
}

fn explain(model: &Model, options: &Options, grid: &Grid) -> String {
    let (values, limit) = (grid.stiffness_penalties.len(), options.limit.limit);
    let method = match limit.scheme() {
        None => cli::explain(model, options.limit.engine, grid),
        Some(_) => format!("{}: bisection on the limit of {}", model.scene().name(), limit.name()),
    };
    format!("{values} values of beta_s, about 150 limits each\n  {method}\n")
}

fn summarise(found: &[Found]) {
    let header = [
        "scene",
        "elements",
        "mass",
        "expected r*",
        "found, narrowest and widest enclosure",
        "holds",
        "governed by",
    ];
    let line = |found: &Found| {
        let mut cells = tabulate_ratios(&found.rows);
        cells.insert(3, found.expected.map_or("by beta_s".to_owned(), |r| format!("{r:.12}")));
        cells.push(governing_bar(&found.model));
        cells
    };
    print_table(&header, found.iter().map(line));
}
