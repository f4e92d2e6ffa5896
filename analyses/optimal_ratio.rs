//! Does r = 1 hold? The largest penalty ratio that costs no time step, bracketed on certified eigenvalues.
//!
//! For every scene, mass matrix and stiffness penalty the ratio r is bisected between a bound that is proven to cost
//! nothing (mediant inequality on the Rayleigh quotient) and one that is proven to cost a step (the enclosures of the
//! penalised and the contact-free l_max are apart). The expected ratio is r* = l_max(K, M)/omega_e^2, which is 1 for
//! bars with free ends.

use std::process::ExitCode;

use bipenalty::cli::{
    Output, OutputOptions, Progress, SceneOptions, Verdict, checked_grid, finish, print_table,
    tabulate_ratios,
};
use bipenalty::error::{Refusal, Result};
use bipenalty::plot::charts;
use bipenalty::record::OptimalRatioRow;
use bipenalty::stability::{
    Axis, EngineName, Expectation, Grid, Model, check_has_contact, governing_bar, optimal_ratio,
};
use clap::Parser;
use rayon::prelude::*;

/// The largest penalty ratio r that costs no time step, with its enclosure, over the stiffness penalty.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 1,1e4 or lin:1:10:10 or log:1e-3:1e12:61 (start:stop:count)
    #[arg(long, value_name = "SPEC", default_value = "log:1e-3:1e12:61")]
    beta_s: Axis,
    /// auto, closed-form, secular, sturm, dense, or lapack where it is built in
    #[arg(long, value_name = "NAME", default_value = "auto")]
    engine: EngineName,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  optimal-ratio                                     the built-in scenes, into figures/optimal-ratio/
  optimal-ratio my-bars.toml --beta-s 1e4           which r is free of cost for my bars, and which bar governs
  optimal-ratio signorini --mass lumped --beta-s log:1:1e16:17 --stdout csv";

/// What was found for one model.
struct Found {
    model: Model,
    expectation: Expectation,
    rows: Vec<OptimalRatioRow>,
}

fn main() -> ExitCode {
    finish(run(&Options::parse()))
}

fn run(options: &Options) -> Result<Verdict> {
    let models = plan(options)?;
    let output = Output::prepare(&options.output, "optimal-ratio")?;
    let grid = checked_grid(&options.beta_s, &Axis::list([1.0, 1e12]))?;
    models.iter().flatten().try_for_each(|model| model.check_grid(&grid))?;
    if options.output.explain {
        models.iter().flatten().for_each(|model| print!("{}", explain(model, options, &grid)));
        return Ok(Verdict::Holds);
    }
    let points = models.iter().flatten().count() * grid.stiffness_penalties.len();
    let progress = Progress::new(points, "ratios", options.output.quiet);
    let (mut all, mut holds) = (Vec::new(), true);
    for models in &models {
        let mut found = Vec::new();
        for model in models {
            found.push(search(model, &grid, options.engine, &progress)?);
        }
        let name = models[0].scene().name();
        let rows: Vec<Vec<OptimalRatioRow>> = found.iter().map(|found| found.rows.clone()).collect();
        output.write_rows(name, &rows.concat())?;
        if output.wants_figures() && options.beta_s.values.len() > 1 {
            let expected: Vec<f64> = found.iter().map(|found| found.expectation.ratio()).collect();
            output.write_figure(name, &charts::optimal_ratio(&rows, &expected, options.beta_s.log))?;
        }
        holds &= rows.iter().flatten().all(|row| row.holds);
        all.extend(found);
    }
    drop(progress);
    output.print(all.iter().flat_map(|found| &found.rows))?;
    if !options.output.quiet {
        summarise(&all);
    }
    Ok(if holds { Verdict::Holds } else { Verdict::Fails })
}

/// The models of every scene, one a mass matrix; the built-in scenes if none is named.
fn plan(options: &Options) -> Result<Vec<Vec<Model>>> {
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = ["signorini", "symmetric", "hunek"].map(str::to_owned).to_vec();
    }
    let models: Vec<Vec<Model>> = asked.scenes()?.iter().map(|scene| asked.models(scene)).collect();
    models.iter().flatten().try_for_each(check_has_contact)?;
    models.iter().flatten().try_for_each(|model| model.check_engine(options.engine))?;
    Ok(models)
}

/// Brackets the optimal ratio of one model at every beta_s, in parallel.
fn search(model: &Model, grid: &Grid, engine: EngineName, progress: &Progress) -> Result<Found> {
    progress.doing(model.scene().name());
    let pencil = engine.needs_pencil().then(|| model.pencil());
    let engine = model.engine(engine, pencil.as_ref());
    let uncertified =
        |error| Refusal::new(model.scene().name(), error, "scenes whose limit can be certified");
    let expectation = Expectation::of(model, engine.as_ref()).map_err(uncertified)?;
    let rows: Result<Vec<OptimalRatioRow>, _> = grid
        .stiffness_penalties
        .par_iter()
        .map(|beta_s| {
            let found = optimal_ratio(model, engine.as_ref(), &expectation, *beta_s);
            progress.add(1);
            found.map(|found| OptimalRatioRow::new(model, beta_s.get(), found, expectation.ratio()))
        })
        .collect();
    Ok(Found { model: model.clone(), expectation, rows: rows.map_err(uncertified)? })
}

fn explain(model: &Model, options: &Options, grid: &Grid) -> String {
    format!(
        "{} values of beta_s, about 150 eigenvalues each\n  {}\n",
        grid.stiffness_penalties.len(),
        model.explain(options.engine, grid)
    )
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
        cells.insert(3, format!("{:.12}", found.expectation.ratio()));
        cells.push(governing_bar(&found.model));
        cells
    };
    print_table(&header, found.iter().map(line));
}
