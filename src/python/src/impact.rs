//! Impacts: the histories of a run as arrays.

use std::sync::Arc;

use bipenalty::error::{Refusal, Result};
use bipenalty::impact::{
    self, Comparison, Encounter, Ending, Exact, History, Mesh, Observer, Passage, Record, Recording, Run,
    Summary,
};
use bipenalty::penalty::{Ratio, StiffnessPenalty};
use bipenalty::schemes::{Energy, Scheme};
use bipenalty::stability::{AnyModel, AnyScene, Model};
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArray1, ToPyArray};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::model::InUse;
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

/// Steps through the impact of a model, and hands on its arrays and numbers by name. `scene` is that of the model, if it has one.
///
/// # Errors
/// What the run refuses, and what a signal or `progress` raises.
pub fn run<'py>(
    py: Python<'py>,
    (model, scene): (InUse, Option<AnyScene>),
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
    let prepare = move |_: &Watch| passage(&model, scene.as_ref(), scheme, pace, start);
    let (passage, exact) = long(py, 1, None, prepare)?.map_err(failed)?;
    passed(py, passage, exact, every, progress)
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

/// The passage of matrices or a mesh, and its exact force where the scene has one and nothing else was given.
fn passage(
    model: &AnyModel,
    scene: Option<&AnyScene>,
    scheme: Arc<dyn Scheme>,
    pace: Pace,
    start: [Option<Vec<f64>>; 3],
) -> Result<(Passage, Option<Exact>)> {
    let Pace(beta_s, ratio, relative_courant, duration, _) = pace;
    let (beta_s, ratio) = (StiffnessPenalty::new(beta_s)?, Ratio::new(ratio)?);
    let missing = |place: &str, allowed: &str| {
        let value = format!("none with scene {}", model.name());
        Refusal::new(place, value, format!("{allowed}, or a scene with [impact]"))
    };
    let mut throw = match scene {
        Some(scene) => Encounter::of_scene(scene, model)?,
        None => Encounter::of_model(model)?,
    };
    let of_scene = scene.and_then(|scene| impact::duration(scene).ok());
    let still = throw.load().is_empty() && throw.velocity().iter().all(|v| *v == 0.0);
    if still && of_scene.is_none() && start[0].is_none() && start[1].is_none() {
        return Err(missing("velocity", "a number for each unknown (m/s), or a load (N)").into());
    }
    let duration = duration.or(of_scene).ok_or_else(|| missing("duration", "a positive number (s)"))?;
    let exact = scene.filter(|_| start.iter().all(Option::is_none));
    let exact = exact.and_then(|scene| impact::exact(scene, duration));
    let [velocity, load, gaps] = start;
    if let Some(velocity) = velocity {
        throw = throw.with_velocity(velocity)?;
    }
    if let Some(load) = load {
        throw = throw.with_load(load)?;
    }
    if let Some(gaps) = gaps {
        throw = throw.with_gaps(&gaps)?;
    }
    let penalty = throw.penalty(beta_s.get(), ratio.get());
    Ok((Passage::new(throw, scheme, penalty, relative_courant, duration)?, exact))
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
    exact: Option<Exact>,
    every: u64,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (steps, time_step) = (passage.steps() as usize, passage.time_step());
    // Gaps are compared with nothing: of any length.
    let search = passage.scheme().facts().search;
    let mut compared = exact.map(|exact| Comparison::new(exact, search, time_step, 1.0));
    let (record, compared) = long(py, steps, progress, move |watch: &Watch| {
        let mut report = |done, _| watch.set(done);
        let told = Observer { stop: watch.stop(), report: &mut report };
        let record = passage.execute(every, Some(told), |time, motion| {
            if let Some(compared) = &mut compared {
                compared.note(time, motion.state().force.iter().sum(), 0.0);
            }
        })?;
        Ok((record, compared))
    })?
    .map_err(refused)?;
    of_record(py, &record, compared, time_step)
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
    named.set_item("time_step", run.time_step())?;
    named.set_item("steps", history.steps)?;
    summarised(&named, &Summary::of(run, history))?;
    let exact = Exact::of(run.model().scene(), run.duration());
    let exact: Option<Vec<f64>> = exact.map(|exact| history.time.iter().map(|t| exact.force(*t)).collect());
    named.set_item("exact_force", exact.map(|force| force.into_pyarray(py)))?;
    Ok(named)
}

fn of_record<'py>(
    py: Python<'py>,
    record: &Record,
    compared: Option<Comparison>,
    time_step: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let named = rows(py, &record.time, &record.force, &record.energy, record.ending)?;
    named.set_item("gap", of_contacts(py, record.time.len(), record.gap.clone())?)?;
    named.set_item("relative_gap", py.None())?;
    named.set_item("time_step", time_step)?;
    named.set_item("steps", record.steps)?;
    let exact: Option<Vec<f64>> =
        compared.as_ref().map(|compared| record.time.iter().map(|t| compared.expected(*t)).collect());
    named.set_item("exact_force", exact.map(|force| force.into_pyarray(py)))?;
    let accuracy = compared.map(Comparison::finish).unwrap_or_default();
    let energy = record.outcome().and_then(|outcome| outcome.kept());
    summarised(&named, &Summary::new(accuracy, energy, record.switches))?;
    Ok(named)
}

fn summarised(named: &Bound<'_, PyDict>, summary: &Summary) -> PyResult<()> {
    named.set_item("switches", summary.switches)?;
    named.set_item("force_error", summary.force_error)?;
    named.set_item("energy_ratio", summary.energy_ratio)?;
    named.set_item("more_energy", summary.more_energy)
}
