//! How large is the linear limit of closed contact, and what does the contact penalty do to it?
//!
//! For every scene and mass matrix the largest eigenvalue of the bi-penalised pencil is found on a grid of the
//! stiffness penalty beta_s and the ratio r, with an enclosure, and 2/omega_max is drawn as the critical Courant
//! number. Without a scene: the charts of the paper, the same for long bars, and maps over 15 decades of beta_s.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use analyses::charts;
use analyses::cli::{
    Chart, Job, LimitOptions, MapSummary, Output, OutputOptions, Progress, RatioSpec, SceneOptions, Solved,
    Verdict, arguments, check_stems, finish, paper, point_answers, print_summaries, redraw_stability,
    scheme_lines,
};
use analyses::error::{Refusal, Result};
use analyses::record::StabilityRow;
use bipenalty::scene::built_in;
use bipenalty::stability::{Axis, contour};
use clap::{Parser, ValueHint};

/// Critical time steps of bars in contact: C_r over the stiffness penalty and the ratio, certified.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 0,0.5,10 or lin:0:10:401 or log:1e-3:1e12:301 (start:stop:count)
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true)]
    beta_s: Option<Axis>,
    /// Penalty ratios r, in the same forms; inf is the pure penalty method, plastic the ratio of zero penetration
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true)]
    ratio: Option<RatioSpec>,
    /// dt over the contact-free critical step, for --ratio plastic [default: 0.5]
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    relative_courant: Option<f64>,
    #[command(flatten)]
    limit: LimitOptions,
    /// Draw the records of a CSV file, written by an earlier run, again without computing
    #[arg(long, value_name = "FILE.csv", value_hint = ValueHint::FilePath, conflicts_with_all = ["scenes",
        "elements", "mass", "penalty_mass", "beta_s", "ratio", "relative_courant", "limit", "theta", "engine"])]
    from: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

/// Up to this many points are answered in words.
const FEW_POINTS: usize = 8;

const EXAMPLES: &str = "Examples:
  stability-map                                     the charts of the paper and maps beyond it
  stability-map my-bars.toml --beta-s 10 --ratio 1  the linear limit of closed contact of my bars
  stability-map signorini --beta-s log:1e-3:1e12:301 --ratio log:0.1:1e3:201 --format pdf
  stability-map signorini --limit park --theta 1    how far the Park scheme itself is stable
  stability-map hunek --limit predictor-corrector --beta-s 1e6 --ratio plastic
  stability-map signorini --elements 200 --mass lumped --beta-s 10 --ratio 2 --stdout csv
  stability-map --from figures/stability-map/fig3-1-lumped.csv --width single --format pdf,tex";

fn main() -> ExitCode {
    finish(run(&arguments::<Options>()))
}

fn run(options: &Options) -> Result<Verdict> {
    if let Some(file) = &options.from {
        return redraw(file, options);
    }
    let jobs = plan(options)?;
    let output = Output::prepare(&options.output, "stability-map")?;
    if options.output.explain {
        let plan: String = jobs.iter().map(|job| job.explain(&options.limit)).collect();
        Output::print_text(&plan)?;
        return Ok(Verdict::Holds);
    }
    jobs.iter().try_for_each(Job::require_memory)?;
    let (mut summaries, mut answers, mut printed, mut files) = (Vec::new(), Vec::new(), Vec::new(), 0);
    let progress = Progress::new(jobs.iter().map(Job::points).sum(), "points", options.output.quiet);
    for job in &jobs {
        let solved = job.solve(&options.limit, &progress)?;
        let rows = |s: &Solved| StabilityRow::of(&s.model, options.limit.limit.name(), &s.curves);
        let rows: Vec<Vec<StabilityRow>> = solved.iter().map(rows).collect();
        files += output.write_rows(&job.stem, &rows.concat())?.len();
        if output.wants_figures() {
            files += draw(job, &rows, &options.limit, &output)?;
        }
        if job.chart != Chart::MassFamily {
            summaries.extend(solved.iter().map(MapSummary::of));
        }
        if job.points() <= FEW_POINTS && job.chart != Chart::MassFamily {
            answers.extend(solved.iter().zip(&rows).flat_map(|(solved, rows)| point_answers(solved, rows)));
        }
        if output.to_stdout() {
            printed.extend(rows.concat());
        }
    }
    drop(progress);
    output.print(printed)?;
    if !options.output.quiet {
        answers.iter().for_each(|answer| eprintln!("{answer}"));
        print_summaries(&summaries);
        output.report(files);
    }
    let holds = summaries.iter().all(|summary| summary.holds);
    Ok(if holds { Verdict::Holds } else { Verdict::Fails })
}

/// The figure of records that an earlier run has left.
fn redraw(file: &Path, options: &Options) -> Result<Verdict> {
    let output = Output::prepare(&options.output, "stability-map")?;
    if options.output.explain {
        Output::print_text(&format!("{}: drawn again; left out: every computation\n", file.display()))?;
        return Ok(Verdict::Holds);
    }
    let (rows, files) = redraw_stability(file, &output)?;
    output.print(rows)?;
    if !options.output.quiet {
        output.report(files);
    }
    Ok(Verdict::Holds)
}

/// The figures of the paper, or one figure for each scene and mass matrix that was asked for.
fn plan(options: &Options) -> Result<Vec<Job>> {
    if let Some(c) = options.relative_courant.filter(|_| options.ratio != Some(RatioSpec::Plastic)) {
        return Err(Refusal::new("--relative-courant", c, "--ratio plastic beside it").into());
    }
    let scenes = options.scene.scenes()?;
    let own_axes = options.beta_s.is_some() || options.ratio.is_some() || options.scene.elements.is_some();
    let jobs = if scenes.is_empty() && own_axes {
        return Err(
            Refusal::new("SCENE", "none", "at least one scene with --beta-s, --ratio or --elements").into()
        );
    } else if scenes.is_empty() {
        let remeshed = |name: &str, elements: usize| match built_in(name) {
            Some(scene) => Ok(scene?.with_elements(elements)?),
            None => Err(Refusal::new("SCENE", name, "a built-in scene").into()),
        };
        paper(&remeshed, &options.scene.mass.0, options.scene.penalty_mass.into())?
    } else {
        let asked = options.beta_s.clone();
        let linear = Axis::linear(0.0, 10.0, 401)?;
        let spec = options.ratio.clone();
        let mut jobs = Vec::new();
        for model in scenes.iter().flat_map(|scene| options.scene.models(scene)) {
            let stem = format!("{}-{}", model.scene().name(), model.mass().name());
            // Without a contact there is one limit, whatever the penalties.
            let touches = !model.scales().is_empty();
            let usual = if touches { linear.clone() } else { Axis::list([0.0]) };
            let beta_s = asked.clone().unwrap_or(usual);
            jobs.push(match &spec {
                Some(RatioSpec::Plastic) => {
                    Job::plastic(stem, model, beta_s, options.relative_courant.unwrap_or(0.5))?
                }
                Some(RatioSpec::Axis(ratio)) => Job::new(stem, vec![model], beta_s, ratio.clone())?,
                None => {
                    let ratios = [0.5, 1.0, 2.0, 3.0, f64::INFINITY];
                    let ratio = if touches { Axis::list(ratios) } else { Axis::list([1.0]) };
                    Job::new(stem, vec![model], beta_s, ratio)?
                }
            });
        }
        jobs
    };
    jobs.iter().flat_map(|job| &job.models).try_for_each(|model| options.limit.check(model))?;
    check_stems(&options.output, jobs.iter().map(|job| job.stem.clone()))?;
    Ok(jobs)
}

/// Draws the chart of a job from its rows; contour lines come from the secular equation, not from the grid.
fn draw(job: &Job, rows: &[Vec<StabilityRow>], limit: &LimitOptions, output: &Output) -> Result<usize> {
    let file = format!("{}.csv", job.stem);
    let figure = match job.chart {
        Chart::None => return Ok(0),
        Chart::Curves => charts::curves(&file, rows, charts::is_logarithmic(&job.beta_s.values)),
        Chart::MassFamily => charts::mass_family(&file, rows),
        Chart::Map => {
            let range = |axis: &Axis| (axis.values[0], axis.values[axis.values.len() - 1]);
            let (beta_s, ratio) = (range(&job.beta_s), range(&job.ratio));
            let mut lines = Vec::new();
            for (model, rows) in job.models.iter().zip(rows) {
                lines.push(match limit.limit.scheme() {
                    None => {
                        let line = |level: f64| Ok((level, contour(model, level, beta_s, ratio)?));
                        charts::levels(rows).into_iter().map(line).collect::<Result<Vec<_>>>()?
                    }
                    Some(scheme) => {
                        let pencil = model.pencil();
                        let limit = model.limit(&*scheme.with_theta(limit.theta())?, &pencil)?;
                        scheme_lines(model, &*limit, rows, beta_s, ratio)
                    }
                });
            }
            charts::map(rows, &lines)
        }
    };
    Ok(output.write_figure(&job.stem, &figure)?.len())
}
