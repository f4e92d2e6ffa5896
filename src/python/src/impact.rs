//! Impacts: the histories of a run as arrays.

use std::sync::Arc;

use bipenalty::error::{Refusal, Result};
use bipenalty::impact::{
    Encounter, Ending, Exact, History, Mesh, Observer, Passage, Record, Recording, Run, Summary,
};
use bipenalty::mesh::{Assembled, MeshImpact, Place, SurfaceContact};
use bipenalty::penalty::{Ratio, StiffnessPenalty};
use bipenalty::pencil::{Gap, Matrix};
use bipenalty::schemes::{Energy, Motion, Scheme};
use bipenalty::stability::{AnyModel, Asking, Model};
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArray1, ToPyArray};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::work::{Watch, long};
use crate::{failed, refused};

/// beta_s, r, C = dt/dt_cr, the duration (s) where it is not that of the scene, and steps between rows.
#[derive(FromPyObject)]
pub struct Pace(f64, f64, f64, Option<f64>, u64);

/// Velocities (m/s) and constant forces (N) of the unknowns, and the gaps (m) of the contacts, at the start.
#[derive(FromPyObject)]
pub struct AtStart<'py>(Option<Floats<'py>>, Option<Floats<'py>>, Option<Floats<'py>>);

type Floats<'py> = PyReadonlyArray1<'py, f64>;

impl AtStart<'_> {
    fn vectors(self) -> [Option<Vec<f64>>; 3] {
        [self.0, self.1, self.2].map(|given| given.map(|given| given.as_array().to_vec()))
    }
}

/// Steps through the impact of a model, and hands on its arrays and numbers by name. Of a mesh, `impact` is what its scene says.
///
/// # Errors
/// What the run refuses, and what a signal or `progress` raises.
pub fn run<'py>(
    py: Python<'py>,
    (model, impact): (Arc<AnyModel>, Option<MeshImpact>),
    scheme: Arc<dyn Scheme>,
    (pace, start): (Pace, AtStart<'py>),
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let every = pace.4;
    if let AnyModel::Bars(bars) = &*model {
        let given = ["velocity", "load", "gaps"].into_iter().zip(start.vectors());
        if let Some((place, _)) = given.into_iter().find(|(_, given)| given.is_some()) {
            let value = format!("given with scene {}", model.name());
            return Err(refused(Refusal::new(place, value, "none: a scene of [[bar]] has its own")));
        }
        return thrown(py, of_bars(bars, scheme, &pace).map_err(refused)?, every, progress);
    }
    let start = start.vectors();
    let prepare = move |_: &Watch| passage(&model, impact, scheme, pace, start);
    passed(py, long(py, 1, None, prepare)?.map_err(failed)?, every, progress)
}

fn of_bars(model: &Model, scheme: Arc<dyn Scheme>, pace: &Pace) -> Result<Run, Refusal> {
    let Pace(beta_s, ratio, relative_courant, duration, _) = *pace;
    let run = Run::new(model.clone(), scheme, StiffnessPenalty::new(beta_s)?, Ratio::new(ratio)?)?;
    let run = run.with_relative_courant(relative_courant)?;
    match duration {
        Some(duration) => run.with_duration(duration),
        None => Ok(run),
    }
}

/// The passage of matrices or a mesh; dt_cr is the proven contact-free step.
fn passage(
    model: &AnyModel,
    impact: Option<MeshImpact>,
    scheme: Arc<dyn Scheme>,
    pace: Pace,
    [velocity, load, gaps]: [Option<Vec<f64>>; 3],
) -> Result<Passage> {
    let Pace(beta_s, ratio, relative_courant, duration, _) = pace;
    let penalty = model.penalty(StiffnessPenalty::new(beta_s)?, Ratio::new(ratio)?)?;
    let missing = |place: &str, allowed: &str| {
        let value = format!("none with scene {}", model.name());
        Refusal::new(place, value, format!("{allowed}, or a scene of [[body]] with [impact]"))
    };
    if impact.is_none() && velocity.is_none() && load.is_none() {
        return Err(missing("velocity", "a number for each unknown (m/s), or a load (N)").into());
    }
    let duration = duration.or_else(|| impact.as_ref().map(|impact| impact.duration));
    let duration = duration.ok_or_else(|| missing("duration", "a positive number (s)"))?;
    let free = model.contact_free(&Asking::default())?.step?;
    let critical_step = model.time_step(1.0)? * free.lower;
    let own = encounter(model, impact, critical_step)?;
    let initial: Vec<f64> = own.pencil().gaps().iter().map(|gap| gap.initial).collect();
    let velocity = velocity.unwrap_or_else(|| own.velocity().to_vec());
    let load = load.unwrap_or_else(|| own.load().to_vec());
    let pencil = match model {
        AnyModel::Mesh(model) => model.stepping_pencil()?,
        AnyModel::Bars(model) => model.pencil(),
    };
    let encounter = Encounter::new(pencil, velocity, load, critical_step)?;
    let encounter = encounter.with_gaps(&gaps.unwrap_or(initial))?;
    Ok(Passage::new(encounter, scheme, penalty, relative_courant, duration)?)
}

/// The bodies as their scene has them thrown, or matrices at rest.
fn encounter(model: &AnyModel, impact: Option<MeshImpact>, critical_step: f64) -> Result<Encounter, Refusal> {
    let reference = model.reference()?;
    let model = match model {
        AnyModel::Bars(model) => return Encounter::of_bars(model),
        AnyModel::Mesh(model) => model,
    };
    let (Some(elements), Some(places), Matrix::Sparse(stiffness)) =
        (model.mesh(), model.places(), model.pencil().stiffness())
    else {
        let pencil = model.stepping_pencil()?;
        let rest = vec![0.0; pencil.size()];
        return Encounter::new(pencil, rest, Vec::new(), critical_step);
    };
    let contact = |(gap, place): (&Gap, &Place)| SurfaceContact {
        column: gap.column.clone(),
        scale: gap.scale,
        initial_gap: gap.initial,
        place: place.clone(),
    };
    let assembled = Assembled {
        stiffness: stiffness.clone(),
        mass: model.pencil().mass().clone(),
        contacts: model.pencil().contacts().iter().zip(places).map(contact).collect(),
        elements: elements.clone(),
    };
    let still = MeshImpact { duration: 0.0, gaps: Vec::new(), gravity: [0.0; 3] };
    let l_max = 4.0 / (critical_step * critical_step);
    Encounter::of_mesh(&assembled, &impact.unwrap_or(still), l_max, reference)
}

fn thrown<'py>(
    py: Python<'py>,
    run: Run,
    every: u64,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let recording = Recording { every, energies: true, ..Recording::default() };
    run.check(&recording).map_err(refused)?;
    let stepped = run.clone();
    let history = long(py, run.steps() as usize, progress, move |watch: &Watch| {
        let mut report = |done, _| watch.set(done);
        stepped.execute(&recording, Some(Observer { stop: watch.stop(), report: &mut report }))
    })?
    .map_err(refused)?;
    of_history(py, &run, &history)
}

fn passed<'py>(
    py: Python<'py>,
    passage: Passage,
    every: u64,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (steps, time_step) = (passage.steps() as usize, passage.time_step());
    let record = long(py, steps, progress, move |watch: &Watch| {
        let mut report = |done, _| watch.set(done);
        let told = Observer { stop: watch.stop(), report: &mut report };
        passage.execute(every, Some(told), &mut |_: f64, _: &dyn Motion| ())
    })?
    .map_err(refused)?;
    of_record(py, &record, time_step)
}

/// What histories and records have in common.
fn rows<'py>(
    py: Python<'py>,
    time: &[f64],
    force: &[f64],
    energy: &[Energy],
    ending: Ending,
) -> PyResult<Bound<'py, PyDict>> {
    if matches!(ending, Ending::Stopped { .. }) {
        return Err(PyKeyboardInterrupt::new_err(()));
    }
    let named = PyDict::new(py);
    named.set_item("time", time.to_pyarray(py))?;
    named.set_item("contact_force", of_contacts(py, time.len(), force.to_vec())?)?;
    let energies = |name: &str, of: fn(&Energy) -> f64| {
        let values: Vec<f64> = energy.iter().map(of).collect();
        named.set_item(name, values.into_pyarray(py))
    };
    energies("kinetic_energy", |e| e.kinetic)?;
    energies("strain_energy", |e| e.strain)?;
    energies("penalty_energy", |e| e.penalty)?;
    energies("contact_work", |e| e.contact_work)?;
    energies("body_work", |e| e.body_work)?;
    energies("loss", |e| e.loss)?;
    let blew_up = match ending {
        Ending::BlewUp { time, .. } => Some(time),
        Ending::Finished | Ending::Stopped { .. } => None,
    };
    named.set_item("blew_up_at", blew_up)?;
    Ok(named)
}

fn of_contacts(py: Python<'_>, rows: usize, values: Vec<f64>) -> PyResult<Bound<'_, PyAny>> {
    let contacts = values.len() / rows.max(1);
    Ok(values.into_pyarray(py).reshape([rows, contacts])?.into_any())
}

fn of_history<'py>(py: Python<'py>, run: &Run, history: &History) -> PyResult<Bound<'py, PyDict>> {
    let named = rows(py, &history.time, &history.force, &history.energy, history.ending)?;
    let lengths = Mesh::new(run.model().scene()).contact_lengths(run.model().mass());
    let gaps = history.relative_gap.iter().zip(lengths.iter().cycle()).map(|(gap, h)| gap * h).collect();
    named.set_item("relative_gap", of_contacts(py, history.time.len(), history.relative_gap.clone())?)?;
    named.set_item("gap", of_contacts(py, history.time.len(), gaps)?)?;
    let summary = Summary::of(run, history);
    named.set_item("time_step", run.time_step())?;
    named.set_item("steps", history.steps)?;
    named.set_item("switches", history.switches)?;
    named.set_item("force_error", summary.force_error)?;
    named.set_item("energy_ratio", summary.energy_ratio)?;
    named.set_item("more_energy", summary.more_energy)?;
    let exact = Exact::of(run.model().scene(), run.duration());
    let exact: Option<Vec<f64>> = exact.map(|exact| history.time.iter().map(|t| exact.force(*t)).collect());
    named.set_item("exact_force", exact.map(|force| force.into_pyarray(py)))?;
    Ok(named)
}

fn of_record<'py>(py: Python<'py>, record: &Record, time_step: f64) -> PyResult<Bound<'py, PyDict>> {
    let named = rows(py, &record.time, &record.force, &record.energy, record.ending)?;
    named.set_item("gap", of_contacts(py, record.time.len(), record.gap.clone())?)?;
    named.set_item("time_step", time_step)?;
    named.set_item("steps", record.steps)?;
    named.set_item("switches", record.switches)?;
    let energy = energy_ratio(record).filter(|_| record.ending.is_finished());
    named.set_item("energy_ratio", energy.map(|(ratio, _)| ratio))?;
    named.set_item("more_energy", energy.is_some_and(|(ratio, rounding)| ratio > 1.0 + rounding))?;
    for none in ["relative_gap", "exact_force", "force_error"] {
        named.set_item(none, py.None())?;
    }
    Ok(named)
}

/// Energy at the end, without the work of the loads, over that at the start; and what rounding may make of it, as
/// [`Summary`] has it of bars: 4 epsilon a step of the largest energy. None where there is nothing to divide by.
fn energy_ratio(record: &Record) -> Option<(f64, f64)> {
    let (first, last) = (record.energy.first()?, record.energy.last()?);
    let start = first.stored();
    let end = last.stored() - (last.body_work - first.body_work);
    let rounding = 4.0 * f64::EPSILON * (record.steps + 1) as f64 * record.largest_energy() / start;
    (start >= f64::MIN_POSITIVE).then(|| (end / start, rounding))
}
