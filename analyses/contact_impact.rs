//! What the schemes make of an impact: contact force, penetration, stress and energy beside the exact solution.
//!
//! Every scene is stepped by the central difference, the stabilised predictor-corrector and the stabilised Park scheme
//! with the bi-penalty contact (paper, Sec. 4.3 to 5.2), for every mass matrix and stiffness penalty, at a step of C times
//! the contact-free critical one. The exact solutions are d'Alembert's.

use std::process::ExitCode;

use analyses::charts::impacts::{self, Quantity};
use analyses::cli::{
    Analysis, FinishedRun, Output, OutputOptions, PlannedRun, Progress, SceneOptions, Verdict, check_memory,
    check_stems, checked_grid, exact_energy, exact_force, exact_stress, execute, narrate, print_impacts,
    require_memory, suffix,
};
use analyses::error::{Refusal, Result};
use analyses::record::{HistoryRow, ImpactRow};
use bipenalty::impact::{Ending, Exact, Recording, Run};
use bipenalty::penalty::{Ratio, StiffnessPenalty};
use bipenalty::schemes::SchemeName;
use bipenalty::stability::{Grid, Model, Sweep, check_has_contact};
use clap::Parser;

/// Contact-impact of bars in time: three schemes, exact solutions, errors.
// The schemes know no diagonalised mass penalty of a pair; on a wall both forms are one.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES, mut_arg("penalty_mass", |form| form.hide(true)))]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 1,1e4 or lin:1:10:10 or log:1:1e12:4 (start:stop:count)
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = "1,1e4,1e8,1e12")]
    beta_s: Sweep,
    /// Penalty ratios r, in the same forms; inf is the pure penalty method
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = "1")]
    ratio: Sweep,
    /// Schemes: central-difference, predictor-corrector, park
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "central-difference,predictor-corrector,park"
    )]
    scheme: Vec<SchemeName>,
    /// dt/dt_cr of the contact-free scene
    #[arg(long, value_name = "C", allow_negative_numbers = true, default_value_t = 0.5)]
    relative_courant: f64,
    /// Averaging of the Park scheme, in [0, 1]
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 0.5)]
    theta: f64,
    /// Simulated time in s [default: the scene's]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Time in s at which the stress along the bars is taken [default: a quarter into the first contact of the exact
    /// solution; without one, a sixth of the simulated time]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    stress_at: Option<f64>,
    /// Keep every N-th step only, for long runs; the errors are those of every step
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1)]
    every: u64,
    #[command(flatten)]
    output: OutputOptions,
}

/// Bytes of a run that is planned (500 for three bars, twice), and of its line.
const BYTES_PER_RUN: u64 = 2000;

const EXAMPLES: &str = "Examples:
  contact-impact                                  the impacts of the paper
  contact-impact hunek --mass lumped --scheme park --beta-s 1e8
  contact-impact my-bars.toml --mass lumped --scheme predictor-corrector --ratio 1,2 --stdout csv
  contact-impact bouncing-bar --mass lumped --duration 16 --every 10 --format svg,csv";

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "contact-impact";
    type Plan = Vec<Vec<PlannedRun>>;
    type Found = Found;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Self::Plan> {
        plan(self)
    }

    fn explain(&self, figures: &Self::Plan) -> Result<String> {
        let steps = |planned: &PlannedRun| format!("{}: {} steps\n", planned.stem(), planned.run.steps());
        let left_out =
            "left out: eigenvectors; mass solves where the mass is lumped; exact solutions a scene has not\n";
        Ok(figures.iter().flatten().map(steps).collect::<String>() + left_out)
    }

    fn compute(&self, figures: Self::Plan, output: &Output) -> Result<(Found, usize)> {
        let steps = figures.iter().flatten().map(|planned| planned.run.steps() as usize).sum();
        let progress = Progress::new(steps, "steps", self.output.quiet);
        let mut found = Found { rows: Vec::new(), complete: true };
        let mut files = 0;
        for runs in &figures {
            progress.doing(runs[0].run.model().scene().name());
            let finished = execute(runs, &recording(self, &runs[0].run), &progress)?;
            found.rows.extend(finished.iter().map(FinishedRun::row));
            files += write(&finished, output)? + draw_all(&finished, output)?;
            found.complete &= finished.len() == runs.len()
                && finished.iter().all(|run| run.history.ending == Ending::Finished);
            if finished.iter().any(|run| matches!(run.history.ending, Ending::Stopped { .. })) {
                break;
            }
        }
        files += output.write_rows("summary", &found.rows)?.len();
        Ok((found, files))
    }

    fn print(&self, found: &Found, output: &Output) -> Result<()> {
        output.print(&found.rows)
    }

    fn summarise(&self, found: &Found) {
        print_impacts(&found.rows);
    }

    fn verdict(&self, found: &Found) -> Verdict {
        if found.complete { Verdict::Holds } else { Verdict::Fails }
    }
}

/// What the runs have left.
struct Found {
    rows: Vec<ImpactRow>,
    /// Whether every run came to its end.
    complete: bool,
}

/// The runs of every figure: one scene, one mass matrix, one ratio, all penalties and schemes.
fn plan(options: &Options) -> Result<Vec<Vec<PlannedRun>>> {
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = ["signorini", "hunek", "bouncing-bar"].map(str::to_owned).to_vec();
    }
    let grid = checked_grid(&options.beta_s, &options.ratio)?;
    require_memory(&grid, BYTES_PER_RUN * options.scheme.len() as u64)?;
    let mut figures = Vec::new();
    for model in asked.bars()?.iter().flat_map(|scene| asked.bar_models(scene)) {
        check_has_contact(&model)?;
        model.check_grid(&grid)?;
        check_form(&model, &grid)?;
        for ratio in &grid.ratios {
            let mut runs = Vec::new();
            for beta_s in &grid.stiffness_penalties {
                for scheme in &options.scheme {
                    let scheme =
                        scheme.with_theta(options.theta).map_err(|refusal| by_option(refusal, options))?;
                    let run = Run::new(model.clone(), scheme, *beta_s, *ratio)?;
                    let run = configure(run, options).map_err(|refusal| by_option(refusal, options))?;
                    runs.push(PlannedRun { run, beta_s: *beta_s, ratio: *ratio });
                }
            }
            figures.push(runs);
        }
    }
    let all: Vec<&PlannedRun> = figures.iter().flatten().collect();
    check_memory(&all, |run| recording(options, run), options.output.stdout.is_none())?;
    check_stems(&options.output, figures.iter().flatten().map(PlannedRun::stem))?;
    Ok(figures)
}

/// The run with the steps, the time and the recording that were asked for.
fn configure(run: Run, options: &Options) -> Result<Run, Refusal> {
    let run = run.with_relative_courant(options.relative_courant)?;
    let run = match options.duration {
        Some(duration) => run.with_duration(duration)?,
        None => run,
    };
    run.check(&recording(options, &run)).map(|()| run)
}

/// A refusal by the option that the user typed.
fn by_option(refusal: Refusal, options: &Options) -> Refusal {
    let place = match refusal.place.as_str() {
        "theta" => "--theta",
        "relative Courant number" => "--relative-courant",
        "duration" if options.duration.is_some() => "--duration",
        "stress time" => "--stress-at",
        "steps between records" => "--every",
        other => other,
    };
    Refusal { place: place.to_owned(), ..refusal }
}

/// Refuses the diagonalised mass penalty of a pair: the schemes know rank-one contact terms.
fn check_form(model: &Model, grid: &Grid) -> Result<(), Refusal> {
    let mass = |beta_s: &StiffnessPenalty, ratio: &Ratio| beta_s.get() / ratio.get() > 0.0;
    let some =
        grid.ratios.iter().any(|ratio| grid.stiffness_penalties.iter().any(|beta_s| mass(beta_s, ratio)));
    if some && model.spreads_mass() {
        return Err(Refusal::new("--penalty-mass", "diagonalised between two bars", "consistent"));
    }
    Ok(())
}

/// The steps with their energies, and the stress at one time.
fn recording(options: &Options, run: &Run) -> Recording {
    let stress_time = options.stress_at.unwrap_or_else(|| stress_time(run));
    // Standard output prints one line a run: no row is needed for it.
    let every = if options.output.stdout.is_some() { u64::MAX } else { options.every };
    let every = if options.every == 0 { 0 } else { every };
    Recording { every, energies: true, compare: true, stress_times: vec![stress_time] }
}

/// A quarter into the first exact contact, where the wave is halfway through a bar.
fn stress_time(run: &Run) -> f64 {
    let exact = Exact::of(run.model().scene(), run.duration());
    let first = exact.and_then(|exact| exact.contact_intervals().first().copied());
    first.map_or(run.duration() / 6.0, |(start, end)| start + 0.25 * (end - start))
}

/// Writes the records of the runs of one figure; the number of files.
fn write(finished: &[FinishedRun], output: &Output) -> Result<usize> {
    let mut files = 0;
    for run in finished {
        for contact in 0..run.history.contacts {
            files +=
                output.write_rows(&run.history_stem(contact), &HistoryRow::of(&run.history, contact))?.len();
        }
        files += output.write_rows(&run.stress_stem(), &run.stress())?.len();
    }
    Ok(files)
}

/// Draws the runs of one figure, contact by contact. What has blown up would hide everything else; its row says when.
fn draw_all(finished: &[FinishedRun], output: &Output) -> Result<usize> {
    let drawable = |run: &&FinishedRun| !matches!(run.history.ending, Ending::BlewUp { .. });
    let drawable: Vec<&FinishedRun> = finished.iter().filter(drawable).collect();
    let Some(first) = drawable.first().filter(|_| output.wants_figures()) else { return Ok(0) };
    (0..first.history.contacts).map(|contact| draw(&first.planned, &drawable, contact, output)).sum()
}

/// Force and gap of one contact; with the first also what belongs to the bars.
fn draw(planned: &PlannedRun, runs: &[&FinishedRun], contact: usize, output: &Output) -> Result<usize> {
    let (run, ratio) = (&planned.run, planned.ratio.get());
    let (scene, mass) = (run.model().scene().name(), run.model().mass().name());
    let ratio = if ratio == 1.0 { String::new() } else { format!("-r{ratio}") };
    let records: Vec<_> = runs.iter().map(|run| run.record(contact)).collect();
    let summary: Vec<ImpactRow> = runs.iter().map(|run| run.row()).collect();
    let number = (run.model().scales().len() > 1).then_some(contact + 1);
    let histories: Vec<String> = runs.iter().map(|run| run.history_stem(contact)).collect();
    let mut files = 0;
    for (name, quantity) in Quantity::ALL.into_iter().filter(|(_, q)| contact == 0 || q.is_of_contact()) {
        let exact = match quantity {
            Quantity::Force => exact_force(run),
            Quantity::Energy => exact_energy(run),
            Quantity::Gap => Vec::new(),
        };
        let figure = impacts::histories(scene, &mass, &records, (quantity, number), &exact);
        let stem = format!("{scene}-{name}-{mass}{ratio}{}", suffix(contact));
        files += output.write_figure_of(&stem, &figure, &histories, Some(&summary))?.len();
    }
    if contact == 0 {
        let time = records.iter().flat_map(|record| &record.stress).map(|row| row.time.0).next();
        let exact = time.map_or_else(Vec::new, |time| exact_stress(run, time));
        let figure = impacts::stresses(scene, &mass, &records, &exact);
        let stem = format!("{scene}-stress-{mass}{ratio}");
        let stresses: Vec<String> = runs.iter().map(|run| run.stress_stem()).collect();
        files += output.write_figure_of(&stem, &figure, &stresses, Some(&summary))?.len();
    }
    Ok(files)
}
