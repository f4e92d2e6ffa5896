//! A map as it was found; its arrays are made when they are asked for.

use bipenalty::spectrum::Uncertified;
use bipenalty::stability::{CriticalStep, Curve, Model};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::model::{evidence, seconds};

/// A map of len(ratio) x len(beta_s) points.
#[pyclass(frozen, module = "bipenalty._bipenalty")]
pub struct Map {
    model: Model,
    curves: Vec<Curve>,
    shape: (usize, usize),
}

impl Map {
    /// Bytes of a point: as found (88), and the arrays that may be asked for (7 of 8).
    pub const BYTES_PER_POINT: u64 = 88 + 7 * 8;

    pub fn new(model: Model, curves: Vec<Curve>, shape: (usize, usize)) -> Self {
        Self { model, curves, shape }
    }

    fn steps(&self) -> impl Iterator<Item = (&Result<CriticalStep, Uncertified>, &'static str)> {
        self.curves.iter().flat_map(|curve| curve.points.iter().map(|point| (&point.step, point.engine)))
    }
}

#[pymethods]
impl Map {
    /// The array of one quantity, NaN where nothing could be certified.
    fn array<'py>(&self, py: Python<'py>, quantity: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let model = &self.model;
        let of: &(dyn Fn(&CriticalStep) -> f64 + Sync) = match quantity {
            "critical_step" => &|step| seconds(model, step)[0],
            "lower" => &|step| seconds(model, step)[1],
            "upper" => &|step| seconds(model, step)[2],
            "courant" => &|step| step.critical_courant,
            "courant_lower" => &|step| step.lower,
            "courant_upper" => &|step| step.upper,
            "omega_max" => &|step| step.omega_max,
            other => return Err(PyValueError::new_err(format!("no quantity {other:?}"))),
        };
        let values: Vec<f64> = py.detach(|| {
            let points = self.curves.iter().flat_map(|curve| &curve.points);
            points.map(|point| point.step.as_ref().map_or(f64::NAN, of)).collect()
        });
        values.into_pyarray(py).reshape([self.shape.0, self.shape.1])
    }

    /// The engine of every point, ratio by ratio.
    fn engines(&self) -> Vec<&'static str> {
        self.steps().map(|(_, engine)| engine).collect()
    }

    /// What stands behind every point, ratio by ratio; "" where nothing could be certified.
    fn evidence(&self) -> Vec<&'static str> {
        self.steps().map(|(step, _)| step.as_ref().map_or("", evidence)).collect()
    }
}
