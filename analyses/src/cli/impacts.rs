//! The runs of `contact-impact`: every scene, mass matrix, penalty and scheme, in parallel.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::summary::short;
use super::{Intent, Progress};
use crate::charts::impacts::{ExactLine, RunRecord};
use crate::error::{Refusal, Result};
use crate::record::{HistoryRow, ImpactRow, StressRow};
use bipenalty::impact::{self, Exact, History, Mesh, Recording, Run, least_every};
use bipenalty::memory;
use bipenalty::penalty::{Ratio, StiffnessPenalty};
use bipenalty::schemes::SchemeName;

/// One run and its penalties.
#[derive(Debug, Clone)]
pub struct PlannedRun {
    /// The run.
    pub run: Run,
    /// beta_s.
    pub beta_s: StiffnessPenalty,
    /// r.
    pub ratio: Ratio,
}

/// What a run has left.
#[derive(Debug, Clone)]
pub struct FinishedRun {
    /// The run as planned.
    pub planned: PlannedRun,
    /// Its history, with energies.
    pub history: History,
}

impl PlannedRun {
    /// The name of its files: scene, mass, scheme and penalties.
    pub fn stem(&self) -> String {
        let model = self.run.model();
        format!(
            "{}-{}-{}-beta{}-r{}",
            model.scene().name(),
            model.mass().name(),
            self.run.scheme().facts().name,
            short(self.beta_s.get()),
            short(self.ratio.get()),
        )
    }

    /// What `--explain` says of the run: its steps, and what they take on a machine of 2025.
    pub fn explain(&self, recording: &Recording) -> Intent {
        let Self { run, .. } = self;
        let scene = run.model().scene();
        let nodes = (scene.elements() + scene.bars().len()) as f64;
        let node_step =
            match (run.scheme().facts().name == SchemeName::Park.name(), run.model().mass().is_lumped()) {
                (false, true) => 0.6e-9,
                (false, false) => 2.2e-9,
                (true, true) => 6.5e-9,
                (true, false) => 12.5e-9,
            };
        let bytes = run.working_bytes() + run.history_bytes(recording);
        let method = format!(
            "{} steps, about {:.1e} s of one core without files; at most {} MB of memory",
            run.steps(),
            node_step * nodes * run.steps() as f64,
            bytes.div_ceil(1_000_000)
        );
        Intent::of(self.stem(), method)
    }
}

impl FinishedRun {
    /// The line of the summary.
    pub fn row(&self) -> ImpactRow {
        ImpactRow::new(&self.planned.run, self.planned.beta_s.get(), self.planned.ratio.get(), &self.history)
    }

    /// What the file of the history of `contact` (from 0 at the left) is called.
    pub fn history_stem(&self, contact: usize) -> String {
        self.planned.stem() + &suffix(contact)
    }

    /// What the file of the stress is called.
    pub fn stress_stem(&self) -> String {
        self.planned.stem() + "-stress"
    }

    /// The stress rows of every recorded time.
    pub fn stress(&self) -> Vec<StressRow> {
        let run = &self.planned.run;
        let exact = Exact::of(run.model().scene(), run.duration());
        self.history.stress.iter().flat_map(|field| StressRow::of(run, exact.as_ref(), field)).collect()
    }

    /// What the charts need of `contact` (from 0).
    pub fn record(&self, contact: usize) -> RunRecord {
        RunRecord {
            stiffness_penalty: self.planned.beta_s.get(),
            scheme: self.planned.run.scheme().facts(),
            history: HistoryRow::of(&self.history, contact),
            history_stem: self.history_stem(contact),
            stress: self.stress(),
            stress_stem: self.stress_stem(),
        }
    }
}

/// What the name of a file says of a contact, counted from 0 at the left.
pub fn suffix(contact: usize) -> String {
    if contact == 0 { String::new() } else { format!("-contact{}", contact + 1) }
}

/// Bytes of a row of the files of one contact: the record (72), its line of text (up to 260, in a vector that doubles), and
/// for the record of a figure its cells (9 of 24 and up to 32), of which all figures together keep a copy.
pub(super) const BYTES_PER_WRITTEN_ROW: u64 = 1700;

/// Refuses runs whose histories and records the memory does not hold together, before any of them starts; `written`: rows
/// go to files.
///
/// # Errors
/// Names the bytes needed, and the steps between records that fit.
pub fn check_memory(
    planned: &[&PlannedRun],
    recording: impl Fn(&Run) -> Recording,
    written: bool,
) -> Result<(), Refusal> {
    let (mut working, mut fixed, mut rows, mut row_bytes, mut steps) = (0, 0, 0, 0, 0);
    for PlannedRun { run, .. } in planned {
        let recording = recording(run);
        let files = if written { BYTES_PER_WRITTEN_ROW * run.model().scales().len() as u64 } else { 0 };
        let stress = 8 + if written { BYTES_PER_WRITTEN_ROW } else { 0 };
        working = run.working_bytes().max(working);
        fixed += stress * (recording.stress_times.len() * run.model().scene().elements()) as u64;
        rows += run.rows(&recording);
        row_bytes = (run.row_bytes(&recording) + files).max(row_bytes);
        steps += run.steps();
    }
    // Not asked of rayon, whose threads are counted later.
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let together = cores.min(planned.len()) as u64;
    fixed += working * together;
    let all = fixed + rows * row_bytes;
    let every = planned.first().map_or(1, |planned| recording(&planned.run).every);
    let what = format!("{rows} rows and {together} runs at once");
    memory::require(("--every", &every.to_string()), &what, all, |available| {
        least_every(steps, planned.len() as u64, row_bytes, available.saturating_sub(fixed))
    })
}

/// Raised by Ctrl-C.
pub(super) static STOP: AtomicBool = AtomicBool::new(false);

/// Lets Ctrl-C end the runs.
pub(super) fn watch_for_interrupts() {
    // Set once; a later call finds the handler in place, and all share the flag.
    let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
}

/// Executes the runs in parallel. Ctrl-C ends them early; what is finished is returned.
///
/// # Errors
/// What a run refuses before it starts.
pub fn execute(
    planned: &[PlannedRun],
    recording: &Recording,
    progress: &Progress,
) -> Result<Vec<FinishedRun>> {
    watch_for_interrupts();
    let failure: Mutex<Option<Refusal>> = Mutex::new(None);
    let finished: Vec<Option<FinishedRun>> = planned
        .par_iter()
        .map(|planned| {
            let mut seen = 0;
            let mut report = |done: u64, _: u64| {
                progress.add((done - seen) as usize);
                seen = done;
            };
            let watched = impact::Observer { stop: &STOP, report: &mut report };
            let history = planned.run.execute(recording, Some(watched));
            progress.add(planned.run.steps().saturating_sub(seen) as usize);
            match history {
                Ok(history) => Some(FinishedRun { planned: planned.clone(), history }),
                Err(refusal) => {
                    if let Ok(mut failure) = failure.lock() {
                        failure.get_or_insert(refusal);
                    }
                    None
                }
            }
        })
        .collect();
    match failure.into_inner() {
        Ok(Some(refusal)) => Err(refusal.into()),
        // A run that was stopped before its first row has nothing to say.
        _ => Ok(finished.into_iter().flatten().filter(|run| !run.history.time.is_empty()).collect()),
    }
}

/// The exact contact force of a run's scene, with its jumps.
pub fn exact_force(run: &Run) -> ExactLine {
    // From the free bars before the start.
    let line = |exact: Exact| [vec![(0.0, 0.0)], exact.force_line()].concat();
    Exact::of(run.model().scene(), run.duration()).map_or_else(Vec::new, line)
}

/// The exact stress at time t with the bars laid end to end, with its jumps.
pub fn exact_stress(run: &Run, t: f64) -> ExactLine {
    let scene = run.model().scene();
    let Some(exact) = Exact::of(scene, run.duration()) else { return Vec::new() };
    let mesh = Mesh::new(scene);
    let line = |bar: usize| {
        let start = mesh.start(bar);
        exact.stress_line(bar, t).into_iter().map(move |(x, stress)| (start + x, stress))
    };
    (0..scene.bars().len()).flat_map(line).collect()
}

/// The exact kinetic and strain energy, J.
pub fn exact_energy(run: &Run) -> ExactLine {
    let Some(exact) = Exact::of(run.model().scene(), run.duration()) else { return Vec::new() };
    let samples = 300;
    let energy = |i: i32| {
        let t = run.duration() * f64::from(i) / f64::from(samples);
        let (kinetic, strain) = exact.energies(t);
        (t, kinetic + strain)
    };
    (0..=samples).map(energy).collect()
}
