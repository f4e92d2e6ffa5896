//! What the schemes make of an impact: contact force, penetration, stress and energy beside the exact solution.
//!
//! Every scene is stepped by the central difference, the stabilised predictor-corrector and the stabilised Park scheme
//! with the bi-penalty contact (paper, Sec. 4.3 to 5.2), or by others that are asked for, for every mass matrix and stiffness
//! penalty, at a step of C times the contact-free critical one, of a share of the limit of the scheme, or in seconds. The
//! exact solutions are d'Alembert's: of bars, and of boxes that cannot move sideways.

use std::process::ExitCode;
use std::sync::Arc;

use analyses::cli::{
    Analysis, FinishedRun, Format, Frame, Intent, Kept, Output, OutputOptions, PlannedPassage, PlannedRun,
    Progress, SceneOptions, StepOptions, Verdict, axis_word, check_fields, check_instants, check_memory,
    check_passages, check_stems, checked_grid, draw_fields, draw_impacts, draw_passages, execute,
    execute_passages, narrate, penalties_of, print_impacts, question, require_memory, write_impacts,
};
use analyses::error::{Refusal, Result};
use analyses::record::ImpactRow;
use bipenalty::impact::{Encounter, Ending, Exact, Recording, Run};
use bipenalty::penalty::{Ratio, StiffnessPenalty};
use bipenalty::schemes::{Scheme, SchemeName};
use bipenalty::stability::{AnyModel, AnyScene, Grid, Model, Sweep, check_has_contact};
use bipenalty::verify::PenaltyPoint;
use clap::Parser;
use figure::Scale;

/// Contact-impact in time, of bars, meshes and matrices: schemes, exact solutions, errors.
// The schemes know no diagonalised mass penalty of a pair; on a wall both forms are one.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES, mut_arg("penalty_mass", |form| form.hide(true)))]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Stiffness penalties: a list 1,1e4 or lin:1:10:10 or log:1:1e12:4 (start:stop:count)
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = USUAL)]
    beta_s: Sweep,
    /// Stiffness penalties s in N/m, in the same forms, instead of beta_s: s of the contact of smallest scale, no other is softer
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, conflicts_with = "beta_s")]
    stiffness: Option<Sweep>,
    /// Penalty ratios r, in the same forms; inf is the pure penalty method
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, default_value = "1")]
    ratio: Sweep,
    /// Schemes: central-difference, predictor-corrector, park, buffered, lagrange, moreau-jean, paoli-schatzman,
    /// mass-redistribution
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = USUAL_SCHEMES
    )]
    scheme: Vec<SchemeName>,
    #[command(flatten)]
    step: StepOptions,
    /// Averaging of the Park scheme, in [0, 1]
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = USUAL_THETA)]
    theta: f64,
    /// Simulated time in s [default: the scene's]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Time in s at which the stress along the bars is taken [default: a quarter into the first contact of the exact
    /// solution; without one, a sixth of the simulated time]; up to 6 for --fields
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true)]
    stress_at: Vec<f64>,
    /// Of meshes also draw, run by run, stress in the deformed bodies (in the plane) and pressure and gap along the contact
    /// surfaces [default: at the largest contact force, and halfway to it and from it; else --stress-at]
    #[arg(long)]
    fields: bool,
    /// Keep every N-th step only, for long runs; the errors are those of every step
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1)]
    every: u64,
    /// With --format vtu: a frame of a mesh every N-th kept step [default: some 50 frames]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    frame_every: Option<u64>,
    #[command(flatten)]
    output: OutputOptions,
}

/// What is stepped unless told otherwise.
const USUAL: &str = "1,1e4,1e8,1e12";
const USUAL_SCHEMES: &str = "central-difference,predictor-corrector,park";
const USUAL_THETA: f64 = 0.5;

/// Bytes of a run that is planned (500 for three bars, twice), and of its line.
const BYTES_PER_RUN: u64 = 2000;

const EXAMPLES: &str = "Examples:
  contact-impact                                  the impacts of the paper
  contact-impact hunek --mass lumped --scheme park --beta-s 1e8
  contact-impact my-bars.toml --mass lumped --scheme predictor-corrector --ratio 0.25 --stdout csv
  contact-impact bouncing-bar --mass lumped --duration 16 --every 10 --format svg,csv
  contact-impact plane-impact.toml --scheme predictor-corrector,lagrange --ratio 0.25 --fraction 0.9
  contact-impact unlike-blocks.toml --beta-s 1e3 --duration 1e-4 --every 10 --format csv,vtu
  contact-impact sphere-on-plane.toml --beta-s 10 --scheme park --every 10 --fields";

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "contact-impact";
    type Plan = Vec<Group>;
    type Found = Found;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn folder(&self) -> String {
        let others = |name: &str, axis: &Sweep, usual: &str| {
            (usual.parse() != Ok(axis.clone())).then(|| axis_word(name, axis))
        };
        let schemes = self.scheme.iter().map(|scheme| scheme.name()).collect::<Vec<_>>();
        let schemes = (schemes.join(",") != USUAL_SCHEMES).then(|| schemes.join("-"));
        let number = |name: &str, value: Option<f64>| value.map(|value| format!("{name}{value}"));
        let words = [
            others("beta", &self.beta_s, USUAL),
            self.stiffness.as_ref().map(|stiffness| axis_word("s", stiffness)),
            others("r", &self.ratio, "1"),
            schemes,
            number("theta", Some(self.theta).filter(|theta| *theta != USUAL_THETA)),
            number("t", self.duration),
            (!self.stress_at.is_empty()).then(|| {
                let times: Vec<String> = self.stress_at.iter().map(f64::to_string).collect();
                format!("stress{}", times.join("-"))
            }),
            Some(self.every).filter(|every| *every != 1).map(|every| format!("every{every}")),
        ];
        let words = self.scene.words().into_iter().chain(words).chain(self.step.words());
        question(words).trim_start_matches('-').to_owned()
    }

    fn plan(&self) -> Result<Self::Plan> {
        plan(self)
    }

    fn explain(&self, groups: &Self::Plan) -> Result<Vec<Intent>> {
        let intents = |group: &Group| -> Vec<Intent> {
            match group {
                Group::Bars(runs) => runs.iter().map(|run| run.explain(&recording(self, &run.run))).collect(),
                Group::Mesh(runs) => runs.iter().map(|run| run.explain(kept(self, run))).collect(),
            }
        };
        let left_out =
            "left out: eigenvectors; mass solves where the mass is lumped; exact solutions a scene has not";
        let again = "fields: each mesh is stepped a second time, to the instants that its rows tell";
        let fields = self.fields.then(|| Intent::of_all(again));
        Ok(groups.iter().flat_map(intents).chain([Intent::of_all(left_out)]).chain(fields).collect())
    }

    fn frames(&self, groups: &Self::Plan) -> Vec<Frame> {
        let named = |group: &Group, quantity: &str| format!("{}-{quantity}", group.scene());
        let force = |group: &Group| Frame::new(named(group, "force"), Scale::Linear, Scale::Linear);
        let gap = |group: &Group| Frame::new(named(group, "gap"), Scale::Linear, Scale::Log);
        let histories = groups.iter().flat_map(|group| [force(group), gap(group)]);
        let meshes = groups.iter().filter(|group| self.fields && matches!(group, Group::Mesh(_)));
        let field = |stem: String| Frame::new(stem + "-stress", Scale::Linear, Scale::Linear);
        histories.chain(meshes.flat_map(Group::stems).map(field)).collect()
    }

    fn compute(&self, groups: Self::Plan, output: &Output) -> Result<(Found, usize)> {
        let steps = groups.iter().map(Group::steps).sum::<u64>() as usize;
        let progress = Progress::new(steps, "steps", self.output.quiet);
        let mut found = Found { rows: Vec::new(), complete: true };
        let mut files = 0;
        for group in &groups {
            progress.doing(group.scene());
            let (written, endings) = match group {
                Group::Bars(runs) => bars(self, runs, output, &progress, &mut found.rows)?,
                Group::Mesh(runs) => meshes(self, runs, output, &progress, &mut found.rows)?,
            };
            files += written;
            found.complete &= endings.len() == group.len() && endings.iter().all(|e| e.is_finished());
            if endings.iter().any(|ending| matches!(ending, Ending::Stopped { .. })) {
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

/// The runs of every figure: one scene, one mass matrix, one ratio, all penalties and schemes.
enum Group {
    Bars(Vec<PlannedRun>),
    Mesh(Vec<PlannedPassage>),
}

impl Group {
    fn len(&self) -> usize {
        match self {
            Self::Bars(runs) => runs.len(),
            Self::Mesh(runs) => runs.len(),
        }
    }

    fn steps(&self) -> u64 {
        match self {
            Self::Bars(runs) => runs.iter().map(|run| run.run.steps()).sum(),
            Self::Mesh(runs) => runs.iter().map(|run| run.passage.steps()).sum(),
        }
    }

    fn scene(&self) -> &str {
        match self {
            Self::Bars(runs) => runs.first().map_or("", |run| run.run.model().scene().name()),
            Self::Mesh(runs) => runs.first().map_or("", |run| run.model.name()),
        }
    }

    fn stems(&self) -> Vec<String> {
        match self {
            Self::Bars(runs) => runs.iter().map(PlannedRun::stem).collect(),
            Self::Mesh(runs) => runs.iter().map(PlannedPassage::stem).collect(),
        }
    }
}

/// Steps the bars of a group, writes and draws them; the number of files, and how each run ended.
fn bars(
    options: &Options,
    runs: &[PlannedRun],
    output: &Output,
    progress: &Progress,
    rows: &mut Vec<ImpactRow>,
) -> Result<(usize, Vec<Ending>)> {
    let finished = execute(runs, &recording(options, &runs[0].run), progress)?;
    rows.extend(finished.iter().map(FinishedRun::row));
    let files = write_impacts(&finished, output)? + draw_impacts(&finished, output)?;
    Ok((files, finished.iter().map(|run| run.history.ending).collect()))
}

/// The same of matrices or meshes.
fn meshes(
    options: &Options,
    runs: &[PlannedPassage],
    output: &Output,
    progress: &Progress,
    rows: &mut Vec<ImpactRow>,
) -> Result<(usize, Vec<Ending>)> {
    let finished = execute_passages(runs, kept(options, &runs[0]), output, progress)?;
    rows.extend(finished.iter().map(|run| run.row.clone()));
    let mut files = finished.iter().map(|run| run.files).sum();
    if let Some(first) = finished.first() {
        let stem = format!("{}-{}-places", first.planned.model.name(), first.planned.mass());
        files += output.write_rows(&stem, &first.places())?.len();
    }
    files += draw_passages(&finished, output)?;
    if options.fields {
        files += draw_fields(&finished, options.every, &options.stress_at, output)?;
    }
    Ok((files, finished.iter().map(|run| run.ending).collect()))
}

/// Which states of a run are kept.
fn kept(options: &Options, run: &PlannedPassage) -> Kept {
    const FRAMES: u64 = 50;
    let frame_every = options.frame_every.unwrap_or(run.passage.rows(options.every).div_ceil(FRAMES));
    Kept { every: options.every, frame_every }
}

/// What the runs have left.
struct Found {
    rows: Vec<ImpactRow>,
    /// Whether every run came to its end.
    complete: bool,
}

fn plan(options: &Options) -> Result<Vec<Group>> {
    let mut asked = options.scene.clone();
    if asked.scenes.is_empty() {
        asked.scenes = ["signorini", "hunek", "bouncing-bar"].map(str::to_owned).to_vec();
    }
    if options.frame_every == Some(0) {
        return Err(Refusal::new("--frame-every", 0, "at least 1").into());
    }
    let grid = checked_grid(options.stiffness.as_ref().unwrap_or(&options.beta_s), &options.ratio)?;
    require_memory(&grid, BYTES_PER_RUN * options.scheme.len() as u64)?;
    let schemes: Vec<Arc<dyn Scheme>> = options
        .scheme
        .iter()
        .map(|scheme| scheme.with_theta(options.theta).map_err(|refusal| by_option(refusal, options)))
        .collect::<Result<_, _>>()?;
    let mut groups = Vec::new();
    for scene in asked.scenes()? {
        for model in asked.models(&scene)? {
            let grid = match &options.stiffness {
                Some(stiffness) => checked_grid(&penalties_of(stiffness, &model)?, &options.ratio)?,
                None => grid.clone(),
            };
            groups.extend(groups_of(options, &scene, &model, &schemes, &grid)?);
        }
    }
    check_all(options, &groups)?;
    Ok(groups)
}

/// The runs of one model, a group for each ratio.
fn groups_of(
    options: &Options,
    scene: &AnyScene,
    model: &Arc<AnyModel>,
    schemes: &[Arc<dyn Scheme>],
    grid: &Grid,
) -> Result<Vec<Group>> {
    model.check_grid(grid)?;
    check_fields(model, &options.stress_at, options.fields)?;
    match &**model {
        AnyModel::Bars(bars) => {
            check_has_contact(bars)?;
            check_form(bars, grid)?;
            if options.output.format.contains(&Format::Vtu) {
                let value = format!("vtu with scene {}", model.name());
                return Err(Refusal::new("--format", value, "a scene of [[body]], which has a mesh").into());
            }
        }
        AnyModel::Mesh(mesh) => {
            if mesh.pencil().contacts().is_empty() {
                let place = format!("scene {}", model.name());
                return Err(Refusal::new(place, "no contact", "at least one").into());
            }
        }
    }
    let encounter = match &**model {
        AnyModel::Bars(_) => None,
        AnyModel::Mesh(_) => Some(Encounter::of_scene(scene, model)?),
    };
    let mut groups = Vec::new();
    for ratio in &grid.ratios {
        let (mut runs, mut passages) = (Vec::new(), Vec::new());
        for beta_s in &grid.stiffness_penalties {
            let point = PenaltyPoint { stiffness_penalty: *beta_s, ratio: *ratio };
            for scheme in schemes {
                match (&**model, &encounter) {
                    (AnyModel::Bars(bars), _) => {
                        let run = Run::new(bars.clone(), scheme.clone(), *beta_s, *ratio)?;
                        let courant = options.step.relative(model, run.critical_step(), scheme, point)?;
                        let run = configure(run, courant, options).map_err(|r| by_option(r, options))?;
                        runs.push(PlannedRun { run, beta_s: *beta_s, ratio: *ratio });
                    }
                    (AnyModel::Mesh(_), Some(encounter)) => {
                        let paced = (&options.step, options.duration);
                        let run = PlannedPassage::new((scene, model), encounter, scheme, point, paced);
                        let run = run?;
                        check_instants(&run, &options.stress_at)?;
                        passages.push(run);
                    }
                    (AnyModel::Mesh(_), None) => (),
                }
            }
        }
        groups.push(if passages.is_empty() { Group::Bars(runs) } else { Group::Mesh(passages) });
    }
    Ok(groups)
}

/// Refuses what the memory does not hold, and files of one name.
fn check_all(options: &Options, groups: &[Group]) -> Result<()> {
    let (mut bars, mut meshes) = (Vec::new(), Vec::new());
    for group in groups {
        match group {
            Group::Bars(runs) => bars.extend(runs),
            Group::Mesh(runs) => meshes.extend(runs),
        }
    }
    if options.every == 0 {
        return Err(Refusal::new("--every", 0, "at least 1").into());
    }
    if !bars.is_empty() {
        check_memory(&bars, |run| recording(options, run), options.output.stdout.is_none())?;
    }
    check_passages(&meshes, options.every)?;
    check_stems(&options.output, groups.iter().flat_map(Group::stems))?;
    Ok(())
}

/// The run with the step, the time and the recording that were asked for.
fn configure(run: Run, relative_courant: f64, options: &Options) -> Result<Run, Refusal> {
    let run = run.with_relative_courant(relative_courant)?;
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
    let stress_time = options.stress_at.first().copied().unwrap_or_else(|| stress_time(run));
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
