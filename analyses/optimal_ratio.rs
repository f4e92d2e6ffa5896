//! Does r = 1 hold? The largest penalty ratio that costs no time step, bracketed on certified eigenvalues.
//!
//! For every scene, mass matrix and stiffness penalty the ratio r is bisected between a bound that is proven to cost
//! nothing (mediant inequality on the Rayleigh quotient) and one that is proven to cost a step (the enclosures of the
//! penalised and the contact-free l_max are apart). The expected ratio is r* = l_max(K, M)/omega_e^2, which is 1 for
//! bars with free ends.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use analyses::charts;
use analyses::cli::{
    self, Analysis, Frame, Intent, LimitOptions, Output, OutputOptions, Progress, SceneOptions, Units,
    Verdict, check_stems, checked_grid, narrate, print_table, redraw_optimal_ratio, redrawn, require_memory,
    tabulate_ratios,
};
use analyses::error::{Refusal, Result};
use analyses::record::{OptimalRatioRow, Subject};
use bipenalty::stability::{AnyModel, Grid, LimitOf, Sweep, governing_bar};
use clap::{Parser, ValueHint};
use figure::{Figure, Scale};

/// The largest penalty ratio r that costs no time step, with its enclosure, over the stiffness penalty.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 1,1e4 or lin:1:10:10 or log:1e-3:1e12:61 (start:stop:count)
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = USUAL)]
    beta_s: Sweep,
    /// Stiffness penalties s in N/m, in the same forms, instead of beta_s: s of the contact of smallest scale, no other is softer
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, conflicts_with = "beta_s")]
    stiffness: Option<Sweep>,
    #[command(flatten)]
    limit: LimitOptions,
    /// Units of the axes of the charts; the records hold both
    #[arg(long, value_name = "UNITS", default_value = "dimensionless")]
    units: Units,
    /// Draw the records of a CSV file, written by an earlier run, again without computing
    #[arg(long, value_name = "FILE.csv", value_hint = ValueHint::FilePath, conflicts_with_all = ["scenes",
        "elements", "mass", "penalty_mass", "beta_s", "stiffness", "limit", "theta", "parameter", "damping_mass", "damping_stiffness",
        "damping_contact", "engine", "tolerance", "patch"])]
    from: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  optimal-ratio                                     the built-in scenes, into figures/optimal-ratio/
  optimal-ratio my-bars.toml --beta-s 1e4           which r costs nothing, and which bar governs
  optimal-ratio hunek --limit predictor-corrector   which r is free of cost for that scheme
  optimal-ratio signorini --mass lumped --beta-s log:1:1e16:17 --stdout csv
  optimal-ratio my-bars.toml --mass lumped --stiffness log:1e6:1e12:13 --units si   over N/m
  optimal-ratio --from figures/optimal-ratio/signorini.csv --width single --format pdf";

/// The stiffness penalties unless others are asked for.
const USUAL: &str = "log:1e-3:1e12:61";

/// Records to draw again, or the models of each scene and the stiffness penalties.
enum Plan {
    Redraw(PathBuf),
    Models(Vec<Vec<Arc<AnyModel>>>, Grid),
}

/// What was found for one model.
struct Found {
    model: Arc<AnyModel>,
    /// The expected ratio where it is one for every beta_s.
    expected: Option<f64>,
    rows: Vec<OptimalRatioRow>,
}

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "optimal-ratio";
    type Plan = Plan;
    /// What was computed, and the rows of a file drawn again.
    type Found = (Vec<Found>, Vec<OptimalRatioRow>);

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Plan> {
        if let Some(file) = &self.from {
            return Ok(Plan::Redraw(file.clone()));
        }
        let models = plan(self)?;
        let grid = checked_grid(self.stiffness.as_ref().unwrap_or(&self.beta_s), &ratios())?;
        // A row with its text and its cells.
        require_memory(&grid, 2000)?;
        let bars = models.iter().flatten().filter(|model| matches!(***model, AnyModel::Bars(_)));
        bars.into_iter().try_for_each(|model| model.check_grid(&grid_of(self, model)?))?;
        Ok(Plan::Models(models, grid))
    }

    fn explain(&self, plan: &Plan) -> Result<Vec<Intent>> {
        match plan {
            Plan::Redraw(file) => Ok(vec![redrawn(file)]),
            Plan::Models(models, grid) => {
                let models = models.iter().flatten();
                Ok(models.map(|model| explain(model, self, grid)).collect::<Result<_, Refusal>>()?)
            }
        }
    }

    fn frames(&self, plan: &Plan) -> Vec<Frame> {
        let Plan::Models(..) = plan else { return Vec::new() };
        let values = &self.stiffness.as_ref().unwrap_or(&self.beta_s).values;
        let x = if charts::is_logarithmic(values) { Scale::Log } else { Scale::Linear };
        // Whether there are widths or distances to draw over a logarithmic axis is for the rows to say.
        let frame = Frame::new(Self::NAME, x, Scale::Linear);
        if values.len() > 1 { vec![frame] } else { Vec::new() }
    }

    fn compute(&self, plan: Plan, output: &Output) -> Result<(Self::Found, usize)> {
        match plan {
            Plan::Redraw(file) => {
                let (rows, files) = redraw_optimal_ratio(&file, output)?;
                Ok(((Vec::new(), rows), files))
            }
            Plan::Models(models, grid) => {
                let (found, files) = compute(self, &models, &grid, output)?;
                Ok(((found, Vec::new()), files))
            }
        }
    }

    fn print(&self, (found, redrawn): &Self::Found, output: &Output) -> Result<()> {
        output.print(found.iter().flat_map(|found| &found.rows).chain(redrawn))
    }

    fn summarise(&self, (found, _): &Self::Found) {
        if !found.is_empty() {
            summarise(found);
        }
    }

    fn verdict(&self, (found, redrawn): &Self::Found) -> Verdict {
        let mut rows = found.iter().flat_map(|found| &found.rows).chain(redrawn);
        if rows.all(|row| row.holds) { Verdict::Holds } else { Verdict::Fails }
    }
}

/// Searches the models scene by scene, writes and draws what was found.
fn compute(
    options: &Options,
    models: &[Vec<Arc<AnyModel>>],
    grid: &Grid,
    output: &Output,
) -> Result<(Vec<Found>, usize)> {
    let points = models.iter().flatten().count() * grid.stiffness_penalties.len();
    let progress = Progress::new(points, "ratios", options.output.quiet);
    let (mut all, mut files) = (Vec::new(), 0);
    for models in models {
        let mut found = Vec::new();
        for model in models {
            found.push(search(model, options, &progress)?);
        }
        let name = &stem(models, options)?;
        let rows: Vec<Vec<OptimalRatioRow>> = found.iter().map(|found| found.rows.clone()).collect();
        let figure = figure(options, name, &rows).filter(|_| output.wants_figures());
        figure.iter().try_for_each(|figure| output.check_figure(name, figure.clone()))?;
        files += output.write_rows(name, &rows.concat())?.len();
        if let Some(figure) = figure {
            files += output.write_figure(name, &figure)?.len();
        }
        all.extend(found);
    }
    Ok((all, files))
}

/// The figure of one scene, if there is something to draw.
fn figure(options: &Options, name: &str, rows: &[Vec<OptimalRatioRow>]) -> Option<Figure> {
    let values = &options.stiffness.as_ref().unwrap_or(&options.beta_s).values;
    if values.len() < 2 {
        return None;
    }
    let figure = charts::optimal_ratio(&format!("{name}.csv"), rows, charts::is_logarithmic(values))?;
    Some(if options.units == Units::Si { charts::stiffness_in_si(figure, rows) } else { figure })
}

/// The models of every scene, one a mass matrix; the built-in scenes if none is named.
fn plan(options: &Options) -> Result<Vec<Vec<Arc<AnyModel>>>> {
    if let LimitOf::Damped(_) = options.limit.asking()?.limit {
        let value = "central differences with damping, whose optimal ratio is not derived";
        return Err(Refusal::new("--damping-...", value, "no damping").into());
    }
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = ["signorini", "symmetric", "hunek"].map(str::to_owned).to_vec();
    }
    let models = asked.scenes()?.iter().map(|scene| asked.models(scene)).collect::<Result<Vec<_>>>()?;
    models.iter().flatten().try_for_each(|model| cli::check_touches(model))?;
    models.iter().flatten().try_for_each(|model| options.limit.check(model))?;
    let stems = models.iter().map(|models| stem(models, options)).collect::<Result<Vec<_>, _>>()?;
    check_stems(&options.output, stems.into_iter())?;
    Ok(models)
}

/// The grid of one model.
fn grid_of(options: &Options, model: &AnyModel) -> Result<Grid, Refusal> {
    let beta_s = match &options.stiffness {
        Some(stiffness) => cli::penalties_of(stiffness, model)?,
        None => options.beta_s.clone(),
    };
    checked_grid(&beta_s, &ratios())
}

/// The ratios between which every penalty is to be a number.
fn ratios() -> Sweep {
    Sweep::list([1.0, 1e12])
}

/// The name of the files of one scene, with all that makes another question of it.
fn stem(models: &[Arc<AnyModel>], options: &Options) -> Result<String, Refusal> {
    let usual = USUAL.parse::<Sweep>()?;
    let axis = (options.beta_s != usual).then(|| cli::axis_word("beta", &options.beta_s));
    let stiffness = options.stiffness.as_ref().map(|stiffness| cli::axis_word("s", stiffness));
    let words = [options.scene.mass_word(), axis, stiffness].into_iter().chain(options.scene.words());
    Ok(models[0].name().to_owned() + &cli::question(words.chain(options.limit.words()?)))
}

/// Brackets the optimal ratio of one model at every beta_s.
fn search(model: &Arc<AnyModel>, options: &Options, progress: &Progress) -> Result<Found> {
    progress.doing(model.name());
    let grid = grid_of(options, model)?;
    model.check_grid(&grid)?;
    let (options, subject) = (&options.limit, Subject::of(model)?);
    let asking = options.asking()?;
    let beta_s: Vec<f64> = grid.stiffness_penalties.iter().map(|b| b.get()).collect();
    let found = model.optimal_ratios(&beta_s, &asking, &|n| progress.add(n))?;
    let one_for_all = matches!(asking.limit, LimitOf::Spectrum | LimitOf::Explicit(_));
    let expected = found.first().and_then(|(_, expected)| *expected).filter(|_| one_for_all);
    let name = options.name()?;
    let free = model.contact_free(&asking)?.step.ok().map(|step| subject.seconds(step.lower));
    let row = |(beta_s, (found, expected)): (&f64, _)| {
        OptimalRatioRow::new(&subject, name, *beta_s, found, expected, free)
    };
    let rows = beta_s.iter().zip(found).map(row).collect();
    Ok(Found { model: model.clone(), expected, rows })
}

fn explain(model: &AnyModel, options: &Options, grid: &Grid) -> Result<Intent, Refusal> {
    let (values, limit) = (grid.stiffness_penalties.len(), options.limit.asking()?.limit);
    let each = if matches!(model, AnyModel::Bars(_)) { ", about 150 limits each" } else { "" };
    let values = format!("{values} values of beta_s{each}");
    Ok(match (model, limit) {
        (AnyModel::Bars(_), LimitOf::Scheme(_)) => {
            let bisection =
                format!("bisection on the limit of {}; left out: eigenvectors", options.limit.name()?);
            Intent::of(model.name(), format!("{values}: {bisection}"))
        }
        _ => cli::explain(model, &options.limit, grid)?.preceded(&values),
    })
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
        cells.push(match &*found.model {
            AnyModel::Bars(model) => governing_bar(model),
            AnyModel::Mesh(_) => "the mesh".to_owned(),
        });
        cells
    };
    print_table(&header, found.iter().map(line));
}
