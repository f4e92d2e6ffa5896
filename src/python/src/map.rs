//! A map as it was found; its arrays are made when they are asked for.

use std::sync::Arc;

use bipenalty::error::Refusal;
use bipenalty::stability::{AnyModel, CriticalStep, Curve, MapPoint};
use numpy::{IntoPyArray as _, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;

use crate::model::{evidence, seconds};
use crate::refused;

/// A map of len(ratio) x len(beta_s) points.
#[pyclass(frozen, module = "bipenalty._bipenalty")]
pub struct Map {
    model: Arc<AnyModel>,
    curves: Vec<Curve>,
    shape: [usize; 2],
    /// That the library took, s.
    #[pyo3(get)]
    seconds: f64,
}

impl Map {
    /// Bytes of a point: as found (88), and the arrays that may be asked for (7 of 8).
    pub const BYTES_PER_POINT: u64 = 88 + 7 * 8;

    pub fn new(model: Arc<AnyModel>, curves: Vec<Curve>, shape: [usize; 2], seconds: f64) -> Self {
        Self { model, curves, shape, seconds }
    }

    fn points(&self) -> impl Iterator<Item = &MapPoint> {
        self.curves.iter().flat_map(|curve| &curve.points)
    }
}

#[pymethods]
impl Map {
    /// The array of one quantity, NaN where nothing could be certified.
    fn array<'py>(&self, py: Python<'py>, quantity: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let count = self.shape[0] * self.shape[1];
        let of_step = |of: fn(&CriticalStep) -> f64| {
            let mut found = Vec::with_capacity(count);
            found.extend(self.points().map(|point| point.step.as_ref().map_or(f64::NAN, of)));
            Ok(found)
        };
        let of_seconds = |at: usize| {
            let mut found = Vec::with_capacity(count);
            for point in self.points() {
                found.push(seconds(&self.model, point)?[at]);
            }
            Ok(found)
        };
        let found: Result<Vec<f64>, Refusal> = py.detach(|| match quantity {
            "critical_step" => of_seconds(0),
            "lower" => of_seconds(1),
            "upper" => of_seconds(2),
            "courant" => of_step(|step| step.critical_courant),
            "courant_lower" => of_step(|step| step.lower),
            "courant_upper" => of_step(|step| step.upper),
            "omega_max" => of_step(|step| step.omega_max),
            other => Err(Refusal::new("quantity", other, "one of a map")),
        });
        found.map_err(refused)?.into_pyarray(py).reshape(self.shape)
    }

    /// The engine of every point, ratio by ratio.
    fn engines(&self) -> Vec<&'static str> {
        self.points().map(|point| point.engine).collect()
    }

    /// What stands behind every point, ratio by ratio; "" where nothing could be certified.
    fn evidence(&self) -> Vec<String> {
        self.points().map(|point| point.step.as_ref().map_or_else(|_| String::new(), evidence)).collect()
    }
}
