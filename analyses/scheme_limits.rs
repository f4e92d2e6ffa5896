//! How large a step does each scheme stand, and which ratio is free of cost to it?
//!
//! The contact is held closed. The limit of central differences is the spectrum's, 2/omega_max; the predictor-corrector
//! stands dt^2 s' mu = 1, the Park scheme the step at which its amplification matrix has the multiplier -1. For every mass
//! matrix: Fig. 3 of the paper with the four limits side by side, maps over (beta_s, r), the largest ratio that costs no
//! step against the contact-free scene, and, since every ratio costs the Park scheme a step, how much each ratio costs.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use analyses::charts;
use analyses::cli::{
    Analysis, Chart, ForceOptions, ForcePlan, Frame, Intent, Job, Limit, LimitOptions, Output, OutputOptions,
    Progress, SceneOptions, Units, Verdict, check_stems, check_touches, narrate, print_costs, print_table,
    question, redraw_costs, redrawn,
};
use analyses::error::{Refusal, Result};
use analyses::record::{CostRow, OptimalRatioRow, StabilityRow, Subject};
use bipenalty::stability::{AnyModel, Sweep};
use clap::Parser;
use figure::Scale;

/// The stability limits of the schemes themselves with closed contact, and their optimal ratios.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Averaging of the Park scheme, in [0, 1]
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = USUAL_THETA)]
    theta: f64,
    /// Units of the axes of the charts; the records hold both
    #[arg(long, value_name = "UNITS", default_value = "dimensionless")]
    units: Units,
    #[command(flatten)]
    forces: ForceOptions,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  scheme-limits                              a bar of 100 elements on a wall
  scheme-limits hunek --mass lumped --theta 1
  scheme-limits my-bars.toml --mass lumped --stdout csv
  scheme-limits --per-force --mass lumped    what each scheme costs, over beta_s
  scheme-limits --per-force --limit central-difference,noh-bathe:0.6 --beta-s 10 --ratio 1";

const LIMITS: [Limit; 4] =
    [Limit::Spectrum, Limit::CentralDifference, Limit::PredictorCorrector, Limit::Park];

/// Records to draw again, limits of the models of each scene, one a mass matrix, or costs to compare.
enum Plan {
    Redraw(PathBuf),
    Limits(Vec<Vec<Arc<AnyModel>>>),
    Costs(ForcePlan),
}

/// What was found: the rows of the figures, the largest ratios without cost, and what schemes cost.
#[derive(Default)]
struct Found {
    rows: Vec<StabilityRow>,
    ratios: Vec<OptimalRatioRow>,
    costs: Vec<CostRow>,
}

/// theta unless another is asked for.
const USUAL_THETA: f64 = 0.5;

/// beta_s of a contact so stiff that only the ratio limits the step.
const STIFF: f64 = 1e6;

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "scheme-limits";
    type Plan = Plan;
    type Found = Found;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Self::Plan> {
        plan(self)
    }

    fn explain(&self, plan: &Self::Plan) -> Result<Vec<Intent>> {
        Ok(match plan {
            Plan::Redraw(file) => vec![redrawn(file)],
            Plan::Limits(models) => models.iter().flatten().map(|model| explain(model)).collect(),
            Plan::Costs(plan) => plan.explain(),
        })
    }

    fn folder(&self) -> String {
        // Only costs: limits say theta in the names of their files.
        self.forces.words(Some(self.theta).filter(|theta| self.forces.per_force && *theta != USUAL_THETA))
    }

    fn frames(&self, plan: &Self::Plan) -> Vec<Frame> {
        let curves =
            |kind: &str, model: &Arc<AnyModel>| Frame::new(stem(kind, model), Scale::Linear, Scale::Linear);
        let map = |model: &Arc<AnyModel>| Frame::new(stem("map", model), Scale::Log, Scale::Log).of_colours();
        match plan {
            Plan::Redraw(_) => Vec::new(),
            Plan::Limits(models) => {
                models.iter().flatten().flat_map(|model| [curves("fig3", model), map(model)]).collect()
            }
            Plan::Costs(plan) => plan.frames(),
        }
    }

    fn compute(&self, plan: Self::Plan, output: &Output) -> Result<(Found, usize)> {
        let costs = |(costs, files)| (Found { costs, ..Found::default() }, files);
        match plan {
            Plan::Redraw(file) => redraw_costs(&file, self.units, output).map(costs),
            Plan::Limits(models) => compute(self, &models, output),
            Plan::Costs(plan) => plan.compute(self.units, output, self.output.quiet).map(costs),
        }
    }

    fn print(&self, found: &Found, output: &Output) -> Result<()> {
        if found.costs.is_empty() { output.print(&found.rows) } else { output.print(&found.costs) }
    }

    fn summarise(&self, found: &Found) {
        if found.costs.is_empty() {
            summarise(&found.rows, &found.ratios);
        } else {
            print_costs(&found.costs);
        }
    }

    fn verdict(&self, found: &Found) -> Verdict {
        let certified = found.rows.iter().all(|row| row.stable_courant().is_some());
        let priced = found.costs.iter().all(|row| row.cost.is_some());
        if certified && priced && found.ratios.iter().all(|row| row.holds) {
            Verdict::Holds
        } else {
            Verdict::Fails
        }
    }
}

/// The figures of every model, then what each ratio costs scene by scene, then the ratios that cost nothing.
fn compute(options: &Options, models: &[Vec<Arc<AnyModel>>], output: &Output) -> Result<(Found, usize)> {
    let theta = options.theta;
    let mut jobs = Vec::new();
    for model in models.iter().flatten() {
        jobs.extend(figures(model, &words(options))?.into_iter().map(|job| (model, job)));
    }
    jobs.iter().try_for_each(|(_, job)| job.check())?;
    let points = jobs.iter().map(|(model, job)| job.points() * limits(job, model).count()).sum();
    let progress = Progress::new(points, "points", options.output.quiet);
    let (mut printed, mut files) = (Vec::new(), 0);
    for (model, job) in &jobs {
        let rows = solve(job, model, theta, &progress)?;
        files += output.write_rows(&job.stem, &rows.concat())?.len();
        if output.wants_figures() {
            files += draw(job, model, &rows, options, output)?;
        }
        printed.extend(rows.concat());
    }
    for models in models {
        files += costs(models, options, output, &progress)?;
    }
    drop(progress);
    let mut ratios = Vec::new();
    for models in models {
        ratios.extend(optimal_ratios(models, options, output, &mut files)?);
    }
    Ok((Found { rows: printed, ratios, ..Found::default() }, files))
}

/// The bar of 100 elements on a wall unless told otherwise, with every mass matrix.
fn plan(options: &Options) -> Result<Plan> {
    if let Some(file) = &options.forces.from {
        return Ok(Plan::Redraw(file.clone()));
    }
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = vec!["signorini".to_owned()];
    }
    let models = asked.scenes()?.iter().map(|scene| asked.models(scene)).collect::<Result<Vec<_>>>()?;
    models.iter().flatten().try_for_each(|model| check_touches(model))?;
    if options.forces.per_force {
        let plan = options.forces.plan(&models.concat(), options.theta)?;
        check_stems(&options.output, plan.stems())?;
        return Ok(Plan::Costs(plan));
    }
    for model in models.iter().flatten() {
        LIMITS
            .iter()
            .filter(|limit| serves(model, **limit))
            .try_for_each(|limit| settings(*limit, options.theta).check(model))?;
    }
    check_stems(&options.output, models.iter().flatten().map(|model| stem("fig3", model)))?;
    Ok(Plan::Limits(models))
}

fn explain(model: &AnyModel) -> Intent {
    let mass = model.mass().map_or(String::new(), |mass| format!(" ({} mass)", mass.name()));
    let limits = LIMITS.iter().filter(|limit| serves(model, **limit)).count();
    let method =
        format!("{limits} limits as curves and maps, largest ratio without cost; left out: eigenvectors");
    Intent::of(format!("{}{mass}", model.name()), method)
}

/// Whether the limit is found for the model: Park's of a mesh with many contacts is not. Bars say themselves what they refuse.
fn serves(model: &AnyModel, limit: Limit) -> bool {
    matches!(model, AnyModel::Bars(_)) || LimitOptions::of(limit).check(model).is_ok()
}

fn stem(kind: &str, model: &AnyModel) -> String {
    let mass = model.mass().map_or(String::new(), |mass| format!("-{}", mass.name()));
    format!("{kind}-{}{mass}", model.name())
}

fn settings(limit: Limit, theta: f64) -> LimitOptions {
    let theta = (limit == Limit::Park).then_some(theta);
    LimitOptions { theta, ..LimitOptions::of(limit) }
}

/// What file names say of options that are not the usual ones.
fn words(options: &Options) -> String {
    let theta = (options.theta != USUAL_THETA).then(|| format!("theta{}", options.theta));
    question(options.scene.words().into_iter().chain([theta]))
}

/// Fig. 3 and the map of one model.
fn figures(model: &Arc<AnyModel>, words: &str) -> Result<Vec<Job>> {
    let ratios = Sweep::list([0.25, 1.0, 2.0, 3.0, f64::INFINITY]);
    let curves =
        Job::new(stem("fig3", model) + words, vec![model.clone()], Sweep::linear(0.0, 10.0, 401)?, ratios)?;
    let (beta_s, ratio) = (Sweep::log(1e-2, 1e6, 161)?, Sweep::log(0.05, 1e2, 97)?);
    Ok(vec![curves, Job::new(stem("map", model) + words, vec![model.clone()], beta_s, ratio)?])
}

/// The rows of the limits, one panel each.
fn solve(job: &Job, model: &AnyModel, theta: f64, progress: &Progress) -> Result<Vec<Vec<StabilityRow>>> {
    let panel = |limit: Limit| {
        let (solved, subject) = (job.solve(&settings(limit, theta), progress)?, Subject::of(model)?);
        Ok(solved.iter().flat_map(|s| StabilityRow::of(&subject, limit.name(), &s.curves)).collect())
    };
    limits(job, model).map(panel).collect()
}

/// The limits of a figure: a map shows those that are not the spectrum's.
fn limits<'a>(job: &Job, model: &'a AnyModel) -> impl Iterator<Item = Limit> + use<'a> {
    let map = job.chart == Chart::Map;
    LIMITS.into_iter().filter(move |limit| serves(model, *limit) && (!map || limit.scheme().is_some()))
}

fn draw(
    job: &Job,
    model: &AnyModel,
    rows: &[Vec<StabilityRow>],
    options: &Options,
    output: &Output,
) -> Result<usize> {
    let mut lines = Vec::new();
    let figure = if job.chart == Chart::Map {
        let panels = limits(job, model).zip(rows);
        let line = |(limit, rows): (Limit, &Vec<StabilityRow>)| {
            job.lines_of(model, rows, &settings(limit, options.theta), output.levels())
        };
        lines = panels.map(line).collect::<Result<Vec<_>, Refusal>>()?;
        charts::map(rows, &lines)
    } else {
        charts::curves(format!("{}.csv", job.stem).as_str(), rows, false)
    };
    let mut figure = charts::titled_by_limit(figure, rows);
    if options.units == Units::Si {
        figure = charts::in_si(figure, rows, &lines);
    }
    Ok(output.write_figure(&job.stem, &figure)?.len())
}

/// The step that each ratio costs under a stiff contact, for the mass matrices of one scene and every limit but the
/// spectrum's.
fn costs(models: &[Arc<AnyModel>], options: &Options, output: &Output, progress: &Progress) -> Result<usize> {
    let theta = options.theta;
    let mut rows = Vec::new();
    for model in models {
        let (beta_s, ratio) = (Sweep::list([0.0, STIFF]), Sweep::log(1e-2, 1e2, 121)?);
        let job = Job::new(stem("cost", model), vec![model.clone()], beta_s, ratio)?;
        rows.push(solve(&job, model, theta, progress)?.split_off(1));
    }
    let Some(first) = models.first() else { return Ok(0) };
    let stem = format!("cost-{}{}", first.name(), words_of_all(options));
    let mut files =
        output.write_rows(&stem, &rows.iter().flatten().flatten().cloned().collect::<Vec<_>>())?.len();
    if output.wants_figures() {
        files += output.write_figure(&stem, &charts::costs(&rows, theta))?.len();
    }
    Ok(files)
}

/// The same for files that hold every mass matrix.
fn words_of_all(options: &Options) -> String {
    question([options.scene.mass_word()]) + &words(options)
}

/// The largest ratio without cost to each scheme over beta_s, for the mass matrices of one scene.
fn optimal_ratios(
    models: &[Arc<AnyModel>],
    options: &Options,
    output: &Output,
    files: &mut usize,
) -> Result<Vec<OptimalRatioRow>> {
    let mut found = Vec::new();
    for scheme in [Limit::PredictorCorrector, Limit::Park] {
        let served = models.iter().filter(|model| serves(model, scheme));
        let rows = served.map(|model| ratios_of(model, scheme, options.theta)).collect::<Result<Vec<_>>>()?;
        if rows.is_empty() {
            continue;
        }
        let stem = format!("optimal-ratio-{}-{}{}", models[0].name(), scheme.name(), words_of_all(options));
        *files += output.write_rows(&stem, &rows.concat())?.len();
        // Where every ratio costs a step, as with the Park scheme, there is nothing to draw.
        if let Some(mut figure) =
            charts::optimal_ratio(&format!("{stem}.csv"), &rows, true).filter(|_| output.wants_figures())
        {
            if options.units == Units::Si {
                figure = charts::stiffness_in_si(figure, &rows);
            }
            *files += output.write_figure(&stem, &figure)?.len();
        }
        found.extend(rows.concat());
    }
    Ok(found)
}

fn ratios_of(model: &AnyModel, limit: Limit, theta: f64) -> Result<Vec<OptimalRatioRow>> {
    let (asking, subject) = (settings(limit, theta).asking()?, Subject::of(model)?);
    let beta_s = Sweep::log(1e-1, 1e6, 141)?.values;
    let free = model.contact_free(&asking)?.step.ok().map(|step| subject.seconds(step.lower));
    let found = model.optimal_ratios(&beta_s, &asking, &|_| ())?;
    let row = |(beta_s, (found, expected)): (&f64, _)| {
        OptimalRatioRow::new(&subject, limit.name(), *beta_s, found, expected, free)
    };
    Ok(beta_s.iter().zip(found).map(row).collect())
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
