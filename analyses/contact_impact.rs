//! What the schemes make of an impact: contact force, penetration, stress and energy beside the exact solution.
//!
//! Every scene is stepped by the central difference, the stabilised predictor-corrector and the stabilised Park scheme
//! with the bi-penalty contact (paper, Sec. 4.3 to 5.2), for every mass matrix and stiffness penalty, at a step of C times
//! the contact-free critical one. The exact solutions are d'Alembert's.

use std::process::ExitCode;

use bipenalty::cli::{
    FinishedRun, Output, OutputOptions, PlannedRun, Progress, SceneOptions, Verdict, checked_grid,
    exact_energy, exact_force, execute, finish, print_impacts,
};
use bipenalty::error::{Refusal, Result};
use bipenalty::impact::{Ending, Recording, Run};
use bipenalty::penalty::Ratio;
use bipenalty::plot::impact_charts::{self, Quantity};
use bipenalty::record::{HistoryRow, ImpactRow};
use bipenalty::schemes::Scheme;
use bipenalty::stability::{Axis, Grid, Model};
use clap::Parser;

/// Contact-impact of bars in time: three schemes, exact solutions, errors.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 1,1e4 or lin:1:10:10 or log:1:1e12:4 (start:stop:count)
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = "1,1e4,1e8,1e12")]
    beta_s: Axis,
    /// Penalty ratios r, in the same forms; inf is the pure penalty method
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = "1")]
    ratio: Axis,
    /// Schemes: central-difference, predictor-corrector, park
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "central-difference,predictor-corrector,park"
    )]
    scheme: Vec<Scheme>,
    /// dt/dt_cr of the contact-free scene
    #[arg(long, value_name = "C", allow_negative_numbers = true, default_value_t = 0.5)]
    relative_courant: f64,
    /// Averaging of the Park scheme, in [0, 1]
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 0.5)]
    theta: f64,
    /// Simulated time in s [default: the scene's]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Time in s at which the stress along the bars is taken [default: a sixth of the simulated time]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    stress_at: Option<f64>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  contact-impact                                  the impacts of the paper, into figures/contact-impact/
  contact-impact hunek --mass lumped --scheme park --beta-s 1e8
  contact-impact my-bars.toml --relative-courant 0.9 --ratio 1,inf --stdout csv";

fn main() -> ExitCode {
    finish(run(&Options::parse()))
}

fn run(options: &Options) -> Result<Verdict> {
    let figures = plan(options)?;
    let planned: Vec<PlannedRun> = figures.concat();
    let output = Output::prepare(&options.output, "contact-impact")?;
    if options.output.explain {
        let steps = |planned: &PlannedRun| format!("{}: {} steps\n", planned.stem(), planned.run.steps());
        let left_out =
            "left out: eigenvectors; mass solves where the mass is lumped; exact solutions a scene has not\n";
        Output::print_text(&(planned.iter().map(steps).collect::<String>() + left_out))?;
        return Ok(Verdict::Holds);
    }
    let (mut rows, mut files, mut complete) = (Vec::new(), 0, true);
    let steps = planned.iter().map(|planned| planned.run.steps() as usize).sum();
    let progress = Progress::new(steps, "steps", options.output.quiet);
    for runs in &figures {
        progress.doing(runs[0].run.model().scene().name());
        let finished = execute(runs, &recording(options, &runs[0].run), &progress)?;
        rows.extend(finished.iter().map(FinishedRun::row));
        files += write(&finished, &output)?;
        complete &= rows.iter().all(|row: &ImpactRow| row.ending == "finished");
        if rows.iter().any(|row| row.ending.starts_with("stopped")) {
            break;
        }
    }
    drop(progress);
    output.print(&rows)?;
    files += output.write_rows("summary", &rows)?.len();
    if !options.output.quiet {
        print_impacts(&rows);
        output.report(files);
    }
    Ok(if complete { Verdict::Holds } else { Verdict::Fails })
}

/// The runs of every figure: one scene, one mass matrix, one ratio, all penalties and schemes.
fn plan(options: &Options) -> Result<Vec<Vec<PlannedRun>>> {
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = ["signorini", "hunek", "bouncing-bar"].map(str::to_owned).to_vec();
    }
    let grid = checked_grid(&options.beta_s, &options.ratio)?;
    let mut figures = Vec::new();
    for model in asked.scenes()?.iter().flat_map(|scene| asked.models(scene)) {
        model.check_grid(&grid)?;
        check_form(&model, &grid)?;
        for ratio in &grid.ratios {
            let mut runs = Vec::new();
            for beta_s in &grid.stiffness_penalties {
                for scheme in &options.scheme {
                    let run = Run::new(model.clone(), *scheme, *beta_s, *ratio)?;
                    let run = run.with_theta(options.theta)?;
                    let run = match options.duration {
                        Some(duration) => run.with_duration(duration)?,
                        None => run,
                    };
                    let run = run.with_relative_courant(options.relative_courant)?;
                    runs.push(PlannedRun { run, beta_s: *beta_s, ratio: *ratio });
                }
            }
            figures.push(runs);
        }
    }
    if let Some(time) = options.stress_at.filter(|time| !(time.is_finite() && *time >= 0.0)) {
        return Err(Refusal::new("--stress-at", time, "a time of at least 0 (s)").into());
    }
    Ok(figures)
}

/// Refuses the diagonalised mass penalty of a pair: the schemes know rank-one contact terms.
fn check_form(model: &Model, grid: &Grid) -> Result<(), Refusal> {
    let largest = grid.stiffness_penalties.iter().copied().reduce(|a, b| if b > a { b } else { a });
    let nodal = |ratio: &Ratio| {
        largest.is_some_and(|beta_s| model.penalties(beta_s, *ratio).iter().any(|p| p.nodal_mass > 0.0))
    };
    if grid.ratios.iter().any(nodal) {
        return Err(Refusal::new("--penalty-mass", "diagonalised between two bars", "consistent"));
    }
    Ok(())
}

/// Every step with its energies, and the stress at one time.
fn recording(options: &Options, run: &Run) -> Recording {
    let stress_time = options.stress_at.unwrap_or(run.duration() / 6.0);
    Recording { every: 1, energies: true, stress_times: vec![stress_time] }
}

/// Writes the records of the runs of one figure, and the figures.
fn write(finished: &[FinishedRun], output: &Output) -> Result<usize> {
    let Some(first) = finished.first() else { return Ok(0) };
    let mut files = 0;
    for run in finished {
        for contact in 0..run.history.contacts {
            let suffix = if contact == 0 { String::new() } else { format!("-contact{}", contact + 1) };
            let stem = run.planned.stem() + &suffix;
            files += output.write_rows(&stem, &HistoryRow::of(&run.history, contact))?.len();
        }
        files += output.write_rows(&(run.planned.stem() + "-stress"), &run.stress())?.len();
    }
    if !output.wants_figures() {
        return Ok(files);
    }
    let run = &first.planned.run;
    let (scene, mass) = (run.model().scene().name(), run.model().mass().name());
    let ratio = if first.planned.ratio.get() == 1.0 {
        String::new()
    } else {
        format!("-r{}", first.planned.ratio.get())
    };
    // What has blown up would hide everything else; its row says when.
    let drawable = |run: &&FinishedRun| !matches!(run.history.ending, Ending::BlewUp { .. });
    let records: Vec<_> = finished.iter().filter(drawable).map(FinishedRun::record).collect();
    if records.is_empty() {
        return Ok(files);
    }
    for (name, quantity) in Quantity::ALL {
        let exact = match quantity {
            Quantity::Force => exact_force(run),
            Quantity::Energy => exact_energy(run),
            Quantity::Gap => Vec::new(),
        };
        let figure = impact_charts::histories(scene, &mass, &records, quantity, &exact);
        files += output.write_figure(&format!("{scene}-{name}-{mass}{ratio}"), &figure)?.len();
    }
    let figure = impact_charts::stresses(scene, &mass, &records);
    Ok(files + output.write_figure(&format!("{scene}-stress-{mass}{ratio}"), &figure)?.len())
}
