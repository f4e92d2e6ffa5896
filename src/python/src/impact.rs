//! Impacts of bars: the histories of a run as arrays.

use bipenalty::impact::{Ending, Exact, History, Mesh, Observer, Recording, Run, Summary};
use bipenalty::schemes::Energy;
use numpy::{IntoPyArray, PyArrayMethods, ToPyArray};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::refused;
use crate::work::{Watch, long};

/// Executes `run` with a row every so many steps, and hands on its arrays and numbers by name.
///
/// # Errors
/// What the run refuses, and what a signal or `progress` raises.
pub fn run<'py>(
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
    if matches!(history.ending, Ending::Stopped { .. }) {
        return Err(PyKeyboardInterrupt::new_err(()));
    }
    arrays(py, &run, &history)
}

fn arrays<'py>(py: Python<'py>, run: &Run, history: &History) -> PyResult<Bound<'py, PyDict>> {
    let named = PyDict::new(py);
    let (rows, contacts) = (history.time.len(), history.contacts);
    let lengths = Mesh::new(run.model().scene()).contact_lengths(run.model().mass());
    let of_contacts = |values: Vec<f64>| values.into_pyarray(py).reshape([rows, contacts]);
    let gaps = history.relative_gap.iter().zip(lengths.iter().cycle()).map(|(gap, h)| gap * h).collect();
    named.set_item("time", history.time.to_pyarray(py))?;
    named.set_item("contact_force", of_contacts(history.force.clone())?)?;
    named.set_item("relative_gap", of_contacts(history.relative_gap.clone())?)?;
    named.set_item("gap", of_contacts(gaps)?)?;
    let energy = |name: &str, of: fn(&Energy) -> f64| {
        let values: Vec<f64> = history.energy.iter().map(of).collect();
        named.set_item(name, values.into_pyarray(py))
    };
    energy("kinetic_energy", |e| e.kinetic)?;
    energy("strain_energy", |e| e.strain)?;
    energy("penalty_energy", |e| e.penalty)?;
    energy("contact_work", |e| e.contact_work)?;
    energy("body_work", |e| e.body_work)?;
    energy("loss", |e| e.loss)?;
    let summary = Summary::of(run, history);
    named.set_item("time_step", run.time_step())?;
    named.set_item("steps", history.steps)?;
    named.set_item("switches", history.switches)?;
    named.set_item("force_error", summary.force_error)?;
    named.set_item("energy_ratio", summary.energy_ratio)?;
    named.set_item("more_energy", summary.more_energy)?;
    let blew_up = match history.ending {
        Ending::BlewUp { time, .. } => Some(time),
        Ending::Finished | Ending::Stopped { .. } => None,
    };
    named.set_item("blew_up_at", blew_up)?;
    let exact = Exact::of(run.model().scene(), run.duration());
    let exact: Option<Vec<f64>> = exact.map(|exact| history.time.iter().map(|t| exact.force(*t)).collect());
    named.set_item("exact_force", exact.map(|force| force.into_pyarray(py)))?;
    Ok(named)
}
