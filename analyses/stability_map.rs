//! How large is the linear limit of closed contact, and what does the contact penalty do to it?
//!
//! For every scene and mass matrix the largest eigenvalue of the bi-penalised pencil is found on a grid of the
//! stiffness penalty beta_s and the ratio r, with an enclosure, and 2/omega_max is drawn as the critical Courant
//! number. Without a scene: the charts of the paper, the same for long bars, and maps over 15 decades of beta_s.

use std::path::PathBuf;
use std::process::ExitCode;

use analyses::charts;
use analyses::cli::{
    Analysis, Chart, FEW_POINTS, Format, Frame, Intent, Job, LimitOptions, MapSummary, Output, OutputOptions,
    Progress, RatioSpec, SceneOptions, Solved, Units, Verdict, axis_word, check_stems, governing_answer,
    hold_step, narrate, paper, penalties_of, point_answers, print_summaries, question, redraw_stability,
    redrawn, step_and_cost,
};
use analyses::error::{Refusal, Result};
use analyses::record::{StabilityRow, StepRow, Subject};
use bipenalty::scene::built_in;
use bipenalty::stability::{AnyModel, LimitOf, Sweep, eigenvalue};
use clap::{Parser, ValueHint};
use figure::Scale;

/// Critical time steps of bodies in contact: C_r over the stiffness penalty and the ratio, certified.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 0,0.5,10 or lin:0:10:401 or log:1e-3:1e12:301 (start:stop:count)
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true)]
    beta_s: Option<Sweep>,
    /// Stiffness penalties s in N/m, in the same forms, instead of beta_s: s of the contact of smallest scale, no other is softer
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, conflicts_with = "beta_s")]
    stiffness: Option<Sweep>,
    /// Penalty ratios r, in the same forms; inf is the pure penalty method, plastic the ratio of zero penetration
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true)]
    ratio: Option<RatioSpec>,
    /// dt over the contact-free critical step, for --ratio plastic [default: 0.5]
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    relative_courant: Option<f64>,
    /// Hold the time step DT, s, against the limit: the margin at each beta_s and r, and the largest penalties it stands
    #[arg(long, value_name = "DT", allow_negative_numbers = true)]
    time_step: Option<f64>,
    #[command(flatten)]
    limit: LimitOptions,
    /// Units of the axes of the charts; the records hold both
    #[arg(long, value_name = "UNITS", default_value = "dimensionless")]
    units: Units,
    /// Draw the records of CSV files, written by earlier runs, again without computing, all in one figure
    #[arg(long, value_name = "FILE.csv", value_hint = ValueHint::FilePath, conflicts_with_all = ["scenes",
        "elements", "mass", "penalty_mass", "beta_s", "stiffness", "ratio", "relative_courant", "time_step", "limit", "theta", "parameter", "damping_mass",
        "damping_stiffness", "damping_contact", "engine", "tolerance", "patch"])]
    from: Vec<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  stability-map                                     the charts of the paper and maps beyond it
  stability-map my-bars.toml --beta-s 10 --ratio 1  the linear limit of closed contact of my bars
  stability-map my-bars.toml --stiffness log:1e6:1e12:61 --units si   in s over N/m
  stability-map my-bars.toml --time-step 1e-7 --beta-s 1e4 --ratio 1   is my step within the limit?
  stability-map signorini --beta-s log:1e-3:1e12:301 --ratio log:0.1:1e3:201 --format pdf
  stability-map signorini --limit park --theta 1    how far the Park scheme itself is stable
  stability-map signorini --limit noh-bathe --beta-s 10 --ratio 1   another scheme, its cost
  stability-map signorini --damping-stiffness 1e-4 --beta-s 10 --ratio 1   with damping
  stability-map two-blocks.toml --beta-s log:1e-3:1e9:100 --ratio log:0.1:1e3:100   a mesh
  stability-map hunek --limit predictor-corrector --beta-s 1e6 --ratio plastic
  stability-map signorini --elements 200 --mass lumped --beta-s 10 --ratio 2 --stdout csv
  stability-map two-blocks.toml --beta-s 10 --ratio inf --format vtu   who governs the step
  stability-map --from figures/stability-map/fig3-1-lumped.csv --width single --format pdf,tex";

/// Records to draw again, maps to compute, or a step (s) to hold against their limits.
enum Plan {
    Redraw(Vec<PathBuf>),
    Jobs(Vec<Job>),
    Step(Vec<Job>, f64),
}

/// What was found: rows for standard output, and what is said of them.
#[derive(Default)]
struct Found {
    rows: Vec<StabilityRow>,
    summaries: Vec<MapSummary>,
    steps: Vec<StepRow>,
    answers: Vec<String>,
}

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "stability-map";
    type Plan = Plan;
    type Found = Found;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Plan> {
        if !self.from.is_empty() {
            return Ok(Plan::Redraw(self.from.clone()));
        }
        let jobs = plan(self)?;
        Ok(match self.time_step {
            Some(time_step) => Plan::Step(jobs, time_step),
            None => Plan::Jobs(jobs),
        })
    }

    fn explain(&self, plan: &Plan) -> Result<Vec<Intent>> {
        match plan {
            Plan::Redraw(files) => Ok(files.iter().map(|file| redrawn(file)).collect()),
            Plan::Jobs(jobs) | Plan::Step(jobs, _) => {
                let jobs: Vec<_> =
                    jobs.iter().map(|job| job.explain(&self.limit)).collect::<Result<_, _>>()?;
                Ok(jobs.concat())
            }
        }
    }

    fn folder(&self) -> String {
        folder(self)
    }

    fn frames(&self, plan: &Plan) -> Vec<Frame> {
        match plan {
            Plan::Jobs(jobs) => jobs.iter().filter_map(|job| frame(job, self.units)).collect(),
            // Rows that are drawn again tell all, and steps are not drawn.
            Plan::Redraw(_) | Plan::Step(..) => Vec::new(),
        }
    }

    fn compute(&self, plan: Plan, output: &Output) -> Result<(Found, usize)> {
        match plan {
            Plan::Redraw(files) => {
                let (rows, files) = redraw_stability(&files, self.units, output)?;
                Ok((Found { rows, ..Found::default() }, files))
            }
            Plan::Jobs(jobs) => compute(self, &jobs, output),
            Plan::Step(jobs, time_step) => {
                let held = hold_step(&jobs, &self.limit, time_step, output, self.output.quiet)?;
                Ok((Found { steps: held.rows, answers: held.answers, ..Found::default() }, held.files))
            }
        }
    }

    fn print(&self, found: &Found, output: &Output) -> Result<()> {
        if self.time_step.is_some() { output.print(&found.steps) } else { output.print(&found.rows) }
    }

    fn summarise(&self, found: &Found) {
        found.answers.iter().for_each(|answer| analyses::tell!("{answer}"));
        if !found.summaries.is_empty() {
            print_summaries(&found.summaries);
        }
    }

    fn verdict(&self, found: &Found) -> Verdict {
        let within = found.steps.iter().all(|row| row.within == Some(true));
        if within && found.summaries.iter().all(|summary| summary.holds) {
            Verdict::Holds
        } else {
            Verdict::Fails
        }
    }
}

fn compute(options: &Options, jobs: &[Job], output: &Output) -> Result<(Found, usize)> {
    jobs.iter().try_for_each(Job::check)?;
    let (mut found, mut files) = (Found::default(), 0);
    if let LimitOf::Explicit(scheme) = options.limit.asking()?.limit {
        found.answers.push(step_and_cost(&scheme));
    }
    let progress = Progress::new(jobs.iter().map(Job::points).sum(), "points", options.output.quiet);
    for job in jobs {
        let solved = job.solve(&options.limit, &progress)?;
        let name = options.limit.name()?;
        let rows = |s: &Solved| Ok(StabilityRow::of(&Subject::of(&s.model)?, name, &s.curves));
        let rows: Vec<Vec<StabilityRow>> = solved.iter().map(rows).collect::<Result<_, Refusal>>()?;
        files += output.write_rows(&job.stem, &rows.concat())?.len();
        if output.wants_figures() {
            files += draw(job, &rows, options, output)?;
        }
        if job.chart != Chart::MassFamily {
            found.summaries.extend(solved.iter().map(MapSummary::of));
        }
        if job.points() <= FEW_POINTS && job.chart != Chart::MassFamily {
            for (solved, rows) in solved.iter().zip(&rows) {
                found.answers.extend(point_answers(solved, rows));
                files += modes(job, solved, &options.limit, output, &mut found.answers)?;
            }
        }
        if output.to_stdout() {
            found.rows.extend(rows.concat());
        }
    }
    Ok((found, files))
}

/// Which contacts, bodies and elements of a mesh govern its few points; their modes as files where asked for.
fn modes(
    job: &Job,
    solved: &Solved,
    limit: &LimitOptions,
    output: &Output,
    answers: &mut Vec<String>,
) -> Result<usize> {
    if matches!(&*solved.model, AnyModel::Bars(_)) || !solved.limit.is_spectrum() {
        return Ok(0);
    }
    let (asking, mut files) = (limit.asking()?, 0);
    for (ratio, point) in solved.curves.iter().flat_map(|c| c.points.iter().map(move |p| (c.ratio.get(), p)))
    {
        let beta_s = point.stiffness_penalty.get();
        if point.step.is_err() {
            continue;
        }
        let governing = solved.model.governs(beta_s, ratio, &asking)?;
        answers.push(governing_answer(&solved.model, beta_s, ratio, &governing));
        let stem = format!("{}-{beta_s}-{ratio}", job.stem);
        let mode = |out: &mut Vec<u8>| solved.model.write_mode(&governing, out, &stem);
        files += output.write_vtu(&stem, mode)?.len();
    }
    Ok(files)
}

/// The figures of the paper, or one figure for each scene and mass matrix that was asked for.
fn plan(options: &Options) -> Result<Vec<Job>> {
    if let Some(c) = options.relative_courant.filter(|_| options.ratio != Some(RatioSpec::Plastic)) {
        return Err(Refusal::new("--relative-courant", c, "--ratio plastic beside it").into());
    }
    if let Some(time_step) = options.time_step {
        check_step(options, time_step)?;
    }
    let scenes = options.scene.scenes()?;
    let own_axes = options.beta_s.is_some()
        || options.stiffness.is_some()
        || options.ratio.is_some()
        || options.scene.elements.is_some();
    let jobs = if scenes.is_empty() && own_axes {
        return Err(Refusal::new(
            "SCENE",
            "none",
            "at least one scene with --beta-s, --stiffness, --ratio or --elements",
        )
        .into());
    } else if scenes.is_empty() {
        let remeshed = |name: &str, elements: usize| match built_in(name) {
            Some(scene) => Ok(scene?.with_elements(elements)?),
            None => Err(Refusal::new("SCENE", name, "a built-in scene").into()),
        };
        paper(&remeshed, &options.scene.masses(), options.scene.penalty_mass.into())?
    } else {
        let linear = Sweep::linear(0.0, 10.0, 401)?;
        let spec = options.ratio.clone();
        let mut jobs = Vec::new();
        let mut models = Vec::new();
        for scene in &scenes {
            models.extend(options.scene.models(scene)?);
        }
        for model in models {
            let mut stem = match model.mass() {
                Some(mass) => format!("{}-{}", model.name(), mass.name()),
                None => model.name().to_owned(),
            };
            if options.time_step.is_some() {
                stem += "-step";
            }
            // Without a contact there is one limit, whatever the penalties.
            let touches = model.contacts() > 0;
            let asks_map = touches && options.time_step.is_none();
            let usual = if asks_map { linear.clone() } else { Sweep::list([0.0]) };
            let beta_s = penalties(options, &model)?.unwrap_or(usual);
            jobs.push(match &spec {
                Some(RatioSpec::Plastic) => {
                    Job::plastic(stem, model, beta_s, options.relative_courant.unwrap_or(0.5))?
                }
                Some(RatioSpec::Sweep(ratio)) => Job::new(stem, vec![model], beta_s, ratio.clone())?,
                None => {
                    let ratios = [0.5, 1.0, 2.0, 3.0, f64::INFINITY];
                    let ratio = if touches { Sweep::list(ratios) } else { Sweep::list([1.0]) };
                    Job::new(stem, vec![model], beta_s, ratio)?
                }
            });
        }
        if options.output.style.overlay { overlaid(jobs)? } else { jobs }
    };
    jobs.iter().flat_map(|job| &job.models).try_for_each(|model| options.limit.check(model))?;
    let jobs = named_by_question(jobs, options)?;
    if options.output.format.contains(&Format::Vtu) {
        jobs.iter().try_for_each(|job| check_modes(job, &options.limit))?;
    }
    check_stems(&options.output, jobs.iter().map(|job| job.stem.clone()))?;
    Ok(jobs)
}

/// The charts of the paper keep their files: those of another limit, mesh or penalty have it in their names.
fn named_by_question(mut jobs: Vec<Job>, options: &Options) -> Result<Vec<Job>, Refusal> {
    let words = question(options.scene.words().into_iter().chain(options.limit.words()?));
    jobs.iter_mut().for_each(|job| job.stem += &words);
    Ok(jobs)
}

/// Another window than the usual one has a folder of its own.
fn folder(options: &Options) -> String {
    let number = |name: &str, value: Option<f64>| value.map(|value| axis_word(name, &Sweep::list([value])));
    let axis = |name: &str, axis: &Option<Sweep>| axis.as_ref().map(|axis| axis_word(name, axis));
    let ratio = match &options.ratio {
        Some(RatioSpec::Plastic) => Some("rplastic".to_owned()),
        Some(RatioSpec::Sweep(ratio)) => Some(axis_word("r", ratio)),
        None => None,
    };
    let words = [
        axis("beta", &options.beta_s),
        axis("s", &options.stiffness),
        ratio,
        number("courant", options.relative_courant),
        number("step", options.time_step),
    ];
    question(words).trim_start_matches('-').to_owned()
}

/// What of the figure of a job is known before its rows are.
fn frame(job: &Job, units: Units) -> Option<Frame> {
    let of = |log: bool| if log { Scale::Log } else { Scale::Linear };
    let x = of(charts::is_logarithmic(&job.beta_s.values));
    let panels = job.models.len();
    Some(match job.chart {
        Chart::None => return None,
        Chart::MassFamily => {
            Frame::new(&job.stem, Scale::Linear, Scale::Linear).of_panels(1).along(&[0.0, 1.0])
        }
        Chart::Map => Frame::new(&job.stem, Scale::Log, Scale::Log).of_panels(panels).of_colours(),
        Chart::Curves if units == Units::Si => Frame::new(&job.stem, x, Scale::Linear).of_panels(panels),
        Chart::Curves => Frame::new(&job.stem, x, Scale::Linear).of_panels(panels).along(&job.beta_s.values),
    })
}

/// beta_s as asked for: of a stiffness in N/m, divided by the smallest scale of the contacts.
fn penalties(options: &Options, model: &AnyModel) -> Result<Option<Sweep>, Refusal> {
    match &options.stiffness {
        None => Ok(options.beta_s.clone()),
        Some(stiffness) => penalties_of(stiffness, model).map(Some),
    }
}

/// Refuses a step that is none, and what does not go with one.
fn check_step(options: &Options, time_step: f64) -> Result<(), Refusal> {
    eigenvalue(time_step)?;
    let beside = "--time-step, which";
    if options.scene.scenes.is_empty() {
        return Err(Refusal::new("SCENE", "none", "at least one scene with --time-step"));
    }
    if options.ratio == Some(RatioSpec::Plastic) {
        return Err(Refusal::new("--ratio", format!("plastic with {beside} has its own"), "numbers, or inf"));
    }
    if options.output.format.contains(&Format::Vtu) {
        return Err(Refusal::new("--format", format!("vtu with {beside} has no mode"), "csv, json"));
    }
    Ok(())
}

/// Jobs over the same axes as one, to be drawn in one chart; others as they are.
fn overlaid(jobs: Vec<Job>) -> Result<Vec<Job>> {
    let axes = |job: &Job| (job.beta_s.values.clone(), job.ratio.values.clone());
    let alike = jobs.windows(2).all(|pair| axes(&pair[0]) == axes(&pair[1]));
    match jobs.as_slice() {
        [first, _, ..] if alike && !first.paired => {
            let stem = jobs.iter().map(|job| job.stem.as_str()).collect::<Vec<_>>().join("-");
            let models = jobs.iter().flat_map(|job| job.models.clone()).collect();
            Ok(vec![Job::new(stem, models, first.beta_s.clone(), first.ratio.clone())?])
        }
        _ => Ok(jobs),
    }
}

/// Refuses modes of what has none that a file could hold.
fn check_modes(job: &Job, limit: &LimitOptions) -> Result<()> {
    let refuse = |value: String, allowed: &str| Err(Refusal::new("--format", value, allowed).into());
    if let Some(model) =
        job.models.iter().find(|model| model.mass().is_none() || matches!(***model, AnyModel::Bars(_)))
    {
        return refuse(format!("vtu with scene {}", model.name()), "a scene of [[body]], which has a mesh");
    }
    if !limit.asking()?.limit.is_spectrum() {
        return refuse(format!("vtu with --limit {}", limit.name()?), "--limit spectrum, which has a mode");
    }
    match job.points() {
        n if n > FEW_POINTS => refuse(format!("vtu of {n} points"), "at most 8 points"),
        _ => Ok(()),
    }
}

/// Draws the chart of a job from its rows; contour lines come from the equation of a level, not from the grid.
fn draw(job: &Job, rows: &[Vec<StabilityRow>], options: &Options, output: &Output) -> Result<usize> {
    let file = format!("{}.csv", job.stem);
    let mut lines = Vec::new();
    let mut figure = match job.chart {
        Chart::None => return Ok(0),
        Chart::Curves => charts::curves(file.as_str(), rows, charts::is_logarithmic(&job.beta_s.values)),
        Chart::MassFamily => charts::mass_family(&file, rows),
        Chart::Map => {
            lines = job.contour_lines(rows, &options.limit, output.levels())?;
            charts::map(rows, &lines)
        }
    };
    if options.units == Units::Si && job.chart != Chart::MassFamily {
        figure = charts::in_si(figure, rows, &lines);
    }
    Ok(output.write_figure(&job.stem, &figure)?.len())
}
