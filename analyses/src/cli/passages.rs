//! The impacts of matrices and meshes in `contact-impact`: rows go to files while the runs go on.

use std::sync::Arc;

use clap::Args;
use rayon::prelude::*;

use super::impacts::{BYTES_PER_WRITTEN_ROW, STOP};
use super::output::RowFile;
use super::summary::short;
use super::{Intent, Output, Progress};
use crate::charts::impacts::RunRecord;
use crate::error::{Error, Refusal, Result};
use crate::record::{ContactRow, GIVEN, ImpactRow, PassageRow, PlaceRow};
use bipenalty::impact::{self, Comparison, Encounter, Ending, Mesh, Outcome, Passage, exact, least_every};
use bipenalty::memory;
use bipenalty::mesh::{Elements, Field, Place, von_mises};
use bipenalty::schemes::{Motion, Scheme};
use bipenalty::stability::{AnyModel, AnyScene};
use bipenalty::verify::{PenaltyPoint, linear_step};

/// dt/dt_cr of the contact-free scene unless told otherwise.
const USUAL_COURANT: f64 = 0.5;

/// How long a step is.
#[derive(Debug, Clone, Args)]
pub struct StepOptions {
    /// dt/dt_cr of the contact-free scene
    #[arg(long, value_name = "C", allow_negative_numbers = true, default_value_t = USUAL_COURANT)]
    pub relative_courant: f64,
    /// dt in s
    #[arg(long, value_name = "DT", allow_negative_numbers = true, conflicts_with = "relative_courant")]
    pub time_step: Option<f64>,
    /// dt over the linear limit of each scheme at each penalty, the smaller one of closed and of open contact
    #[arg(
        long,
        value_name = "F",
        allow_negative_numbers = true,
        conflicts_with_all = ["relative_courant", "time_step"]
    )]
    pub fraction: Option<f64>,
}

impl StepOptions {
    /// What a folder's name says of the step, if it is not the usual one.
    pub fn words(&self) -> [Option<String>; 3] {
        let word = |name: &str, value: Option<f64>| value.map(|value| format!("{name}{value}"));
        let courant = Some(self.relative_courant).filter(|courant| *courant != USUAL_COURANT);
        [word("c", courant), word("dt", self.time_step), word("fraction", self.fraction)]
    }

    /// dt over `critical_step` (s), the contact-free one of `model`.
    ///
    /// # Errors
    /// A number that is not positive and finite, and what the limit refuses.
    pub fn relative(
        &self,
        model: &AnyModel,
        critical_step: f64,
        scheme: &Arc<dyn Scheme>,
        point: PenaltyPoint,
    ) -> Result<f64> {
        let positive = |option: &str, value: f64, allowed: &str| {
            let held = value > 0.0 && value.is_finite();
            held.then_some(value).ok_or_else(|| Refusal::new(option, value, allowed))
        };
        match (self.time_step, self.fraction) {
            (Some(dt), _) => Ok(positive("--time-step", dt, "a positive finite number (s)")? / critical_step),
            (None, Some(fraction)) => {
                let fraction = positive("--fraction", fraction, "a positive finite number")?;
                Ok(fraction * linear_step(model, scheme, point)?.relative)
            }
            (None, None) => {
                Ok(positive("--relative-courant", self.relative_courant, "a positive finite number")?)
            }
        }
    }
}

/// One run of a scene of matrices or of a mesh.
#[derive(Debug, Clone)]
pub struct PlannedPassage {
    /// Its model.
    pub model: Arc<AnyModel>,
    /// The run.
    pub passage: Passage,
    /// beta_s and r.
    pub point: PenaltyPoint,
    /// What the resultant is compared with, where the scene has an exact solution.
    pub comparison: Option<Comparison>,
    /// The exact force as a line, with its jumps.
    pub exact: Vec<(f64, f64)>,
}

/// What a run has left, beside its files.
#[derive(Debug, Clone)]
pub struct FinishedPassage {
    /// The run as planned.
    pub planned: PlannedPassage,
    /// Its rows.
    pub rows: Vec<PassageRow>,
    /// Its line of the summary.
    pub row: ImpactRow,
    /// How it ended.
    pub ending: Ending,
    /// Files written while it went on.
    pub files: usize,
}

/// Which states are kept.
#[derive(Debug, Clone, Copy)]
pub struct Kept {
    /// A row every so many steps.
    pub every: u64,
    /// A frame every so many rows.
    pub frame_every: u64,
}

impl PlannedPassage {
    /// The run of `scene` and its model by `scheme` at a point; `duration` in s is that of the scene where it is `None`.
    ///
    /// # Errors
    /// As [`Encounter::of_scene`], [`StepOptions::relative`] and [`Passage::new`].
    pub fn new(
        (scene, model): (&AnyScene, &Arc<AnyModel>),
        encounter: &Encounter,
        scheme: &Arc<dyn Scheme>,
        point: PenaltyPoint,
        (steps, duration): (&StepOptions, Option<f64>),
    ) -> Result<Self> {
        let duration = duration.map_or_else(|| impact::duration(scene), Ok)?;
        let courant = steps.relative(model, encounter.critical_step(), scheme, point)?;
        let penalty = encounter.penalty(point.stiffness_penalty.get(), point.ratio.get());
        let passage = Passage::new(encounter.clone(), scheme.clone(), penalty, courant, duration)?;
        // What a scheme refuses to start is refused before anything is written.
        passage.prepare(false)?;
        let mut planned = Self { model: model.clone(), passage, point, comparison: None, exact: Vec::new() };
        if let Some(exact) = exact(scene, duration) {
            let facts = scheme.facts();
            planned.exact = [vec![(0.0, 0.0)], exact.force_line()].concat();
            let length = planned.length(scene);
            planned.comparison =
                Some(Comparison::new(exact, facts.search, planned.passage.time_step(), length));
        }
        Ok(planned)
    }

    /// h of the bars in which the bodies move, m, in which penetrations are given; 1 without them.
    fn length(&self, scene: &AnyScene) -> f64 {
        let (AnyScene::Mesh(scene), Some(mass)) = (scene, self.model.mass()) else { return 1.0 };
        let lengths = scene.as_bars().map(|bars| Mesh::new(&bars).contact_lengths(mass));
        lengths.and_then(|lengths| lengths.first().copied()).unwrap_or(1.0)
    }

    /// The name of the mass matrix.
    pub fn mass(&self) -> String {
        self.model.mass().map_or(GIVEN.to_owned(), |mass| mass.name())
    }

    /// The name of its files.
    pub fn stem(&self) -> String {
        format!(
            "{}-{}-{}-beta{}-r{}",
            self.model.name(),
            self.mass(),
            self.passage.scheme().facts().name,
            short(self.point.stiffness_penalty.get()),
            short(self.point.ratio.get()),
        )
    }

    /// What will be done, in words.
    pub fn explain(&self, kept: Kept) -> Intent {
        let Self { passage, .. } = self;
        let pencil = passage.encounter().pencil();
        let exact =
            if self.exact.is_empty() { "no exact solution" } else { "beside the exact force of bars" };
        // A step and the energies of its row read the matrices once; 7e9 bytes/s were measured of a sphere of 4,271 unknowns.
        let seconds = 0.5 * passage.working_bytes() as f64 / 7e9 * passage.steps() as f64;
        let method = format!(
            "{} steps of {:.6e} s ({:.4} of the contact-free step), about {seconds:.1e} s; {} unknowns, {} contacts, about {} bytes for \
             matrices and states and {} for rows; {exact}",
            passage.steps(),
            passage.time_step(),
            passage.time_step() / passage.encounter().critical_step(),
            pencil.size(),
            pencil.gaps().len(),
            passage.working_bytes(),
            passage.rows(kept.every) * BYTES_PER_WRITTEN_ROW,
        );
        Intent::of(self.stem(), method)
    }
}

/// Refuses runs whose matrices, states and rows the memory does not hold together, before any of them starts.
///
/// # Errors
/// Names the bytes needed, and the steps between records that fit.
pub fn check_passages(planned: &[&PlannedPassage], every: u64) -> Result<(), Refusal> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(planned.len());
    let working = planned.iter().map(|run| run.passage.working_bytes()).max().unwrap_or(0) * cores as u64;
    let rows: u64 = planned.iter().map(|run| run.passage.rows(every)).sum();
    let steps = planned.iter().map(|run| run.passage.steps()).sum();
    let bytes = working + rows * BYTES_PER_WRITTEN_ROW;
    let what = format!("{rows} rows and {cores} runs at once");
    memory::require(("--every", &every.to_string()), &what, bytes, |available| {
        least_every(steps, planned.len() as u64, BYTES_PER_WRITTEN_ROW, available.saturating_sub(working))
    })
}

/// Executes the runs in parallel. Ctrl-C ends them early; what is finished is returned.
///
/// # Errors
/// What a run refuses before it starts, and what the system says of its files.
pub fn execute_passages(
    planned: &[PlannedPassage],
    kept: Kept,
    output: &Output,
    progress: &Progress,
) -> Result<Vec<FinishedPassage>> {
    super::impacts::watch_for_interrupts();
    planned.par_iter().map(|run| pass(run, kept, output, progress)).collect()
}

fn pass(
    planned: &PlannedPassage,
    kept: Kept,
    output: &Output,
    progress: &Progress,
) -> Result<FinishedPassage> {
    let mut seen = 0;
    let mut report = |done: u64, _: u64| {
        progress.add((done - seen) as usize);
        seen = done;
    };
    let watched = impact::Observer { stop: &STOP, report: &mut report };
    let stem = planned.stem();
    let mut contacts = output.stream(&format!("{stem}-contacts"))?;
    let (mut rows, mut comparison) = (Vec::new(), planned.comparison.clone());
    let mut frames = Frames::new(planned, &stem, output);
    let mut count = 0;
    let every = if output.to_stdout() && planned.comparison.is_none() { u64::MAX } else { kept.every };
    let outcome = planned.passage.stream(every, Some(watched), |time, motion| {
        let row = PassageRow::of(time, motion, comparison.as_ref());
        if let Some(comparison) = &mut comparison {
            comparison.note(time, row.contact_force.0, row.largest_gap.0);
        }
        rows.push(row);
        if let Some(file) = &mut contacts {
            ContactRow::of(time, motion).for_each(|row| file.push(row));
        }
        if count % kept.frame_every == 0 {
            frames.add(time, motion);
        }
        count += 1;
    })?;
    let mut files = usize::from(contacts.is_some());
    contacts.map_or(Ok(()), RowFile::finish)?;
    files += frames.finish()?;
    files += output.write_rows(&stem, &rows)?.len();
    progress.add(planned.passage.steps().saturating_sub(seen) as usize);
    let row = summarised(planned, &outcome, comparison);
    Ok(FinishedPassage { planned: planned.clone(), rows, row, ending: outcome.ending, files })
}

fn summarised(planned: &PlannedPassage, outcome: &Outcome, comparison: Option<Comparison>) -> ImpactRow {
    let names = (planned.model.name(), &*planned.mass());
    let at = (planned.point.stiffness_penalty.get(), planned.point.ratio.get());
    ImpactRow::of_passage(names, &planned.passage, at, outcome, comparison)
}

/// The states of a run as files for ParaView.
struct Frames<'a> {
    mesh: Option<(&'a Elements, &'a [Place])>,
    stem: &'a str,
    output: &'a Output,
    written: Vec<(f64, String)>,
    failure: Option<Error>,
}

impl<'a> Frames<'a> {
    fn new(planned: &'a PlannedPassage, stem: &'a str, output: &'a Output) -> Self {
        let mesh = match &*planned.model {
            AnyModel::Mesh(mesh) if output.wants_frames() => mesh.mesh().zip(mesh.places()),
            _ => None,
        };
        Self { mesh, stem, output, written: Vec::new(), failure: None }
    }

    fn add(&mut self, time: f64, motion: &mut dyn Motion) {
        let Some((elements, places)) = self.mesh.filter(|_| self.failure.is_none()) else { return };
        let stem = format!("{}-{:05}", self.stem, self.written.len());
        let frame = |out: &mut Vec<u8>| write_frame(elements, places, motion, out);
        match self.output.write_vtu(&stem, frame) {
            Ok(_) => self.written.push((time, format!("{stem}.vtu"))),
            Err(error) => self.failure = Some(error),
        }
    }

    /// The number of files.
    fn finish(self) -> Result<usize> {
        match self.failure {
            Some(error) => Err(error),
            None if self.written.is_empty() => Ok(0),
            None => Ok(self.written.len() + self.output.write_collection(self.stem, &self.written)?),
        }
    }
}

/// Displacement, velocity, stress, and at the nodes of contacts gap and force: 0 elsewhere, where `contact` is 0.
fn write_frame(
    elements: &Elements,
    places: &[Place],
    motion: &dyn Motion,
    out: &mut Vec<u8>,
) -> Result<(), Refusal> {
    let state = motion.state();
    let mut velocity = vec![0.0; state.velocity.len()];
    motion.velocity(&mut velocity);
    let stress = elements.stresses(&state.displacement)?;
    let equivalent: Vec<f64> = stress.iter().map(von_mises).collect();
    let nodes = elements.first[elements.bodies.len()].0;
    let [mut contact, mut gap, mut force] = [(); 3].map(|()| vec![0.0; nodes]);
    for (j, place) in places.iter().enumerate() {
        let node = place.node;
        // Of a node with several contacts the most closed one is shown.
        gap[node] = if contact[node] == 0.0 { state.gap[j] } else { state.gap[j].max(gap[node]) };
        contact[node] = 1.0;
        force[node] += state.force[j];
    }
    let fields = [
        ("displacement", Field::Displacement(&state.displacement)),
        ("velocity", Field::Displacement(&velocity)),
        ("contact", Field::Nodes(&contact)),
        ("gap", Field::Nodes(&gap)),
        ("contact_force", Field::Nodes(&force)),
        ("stress", Field::Tensors(&stress)),
        ("von_mises", Field::Cells(&equivalent)),
    ];
    elements.write_vtu(out, &fields).map_err(|error| Refusal::new("vtu", error, "a mesh that can be written"))
}

impl FinishedPassage {
    /// What the charts need.
    pub fn record(&self) -> RunRecord {
        RunRecord {
            stiffness_penalty: self.planned.point.stiffness_penalty.get(),
            scheme: self.planned.passage.scheme().facts(),
            history: self.rows.iter().map(PassageRow::drawn).collect(),
            history_stem: self.planned.stem(),
            stress: Vec::new(),
            stress_stem: String::new(),
        }
    }

    /// Where its contacts are.
    pub fn places(&self) -> Vec<PlaceRow> {
        let places = match &*self.planned.model {
            AnyModel::Mesh(mesh) => mesh.places(),
            AnyModel::Bars(_) => None,
        };
        PlaceRow::of(self.planned.passage.encounter().pencil().gaps(), places)
    }
}
