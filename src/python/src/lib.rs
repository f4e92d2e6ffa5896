//! The library as the Python module `bipenalty._bipenalty`: what is computed stays in Rust, what users see is written in
//! Python beside it (`bipenalty/`), and this crate carries numbers from one to the other.
//!
//! Results are tuples and arrays here; the Python package gives them names, units and a `repr`.
//!
//! # Rooms
//! ```text
//! model          a scene or matrices as `Core`: points, ratios, penalties, contours
//! map, stepped   what a map holds; limits found by stepping        impact   runs of bars
//! distributed    one part of a mesh, and the driver that asks all of them
//! arrays, asked  numpy and scipy to vectors and rows, without a copy where that is possible; what is asked, by name
//! work           long work without the interpreter's lock, with progress and Ctrl-C
//! ```

mod arrays;
mod asked;
mod distributed;
mod impact;
mod map;
mod model;
mod stepped;
mod work;

use bipenalty::error::{Error, Refusal};
use pyo3::exceptions::{PyArithmeticError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    bipenalty,
    Uncertified,
    PyArithmeticError,
    "No enclosure of the limit is as narrow as was asked for; the message says what was reached."
);

/// What the library refuses is a `ValueError` with its text.
fn refused(refusal: Refusal) -> PyErr {
    PyValueError::new_err(refusal.to_string())
}

/// As [`refused`], for a scene that cannot be read and a limit that could not be enclosed too.
fn failed(error: Error) -> PyErr {
    match error {
        Error::Uncertified { message, .. } => Uncertified::new_err(message),
        Error::Refused(_) | Error::SceneFile { .. } | Error::File { .. } | Error::NotFound { .. } => {
            PyValueError::new_err(error.to_string())
        }
    }
}

/// A limit that could not be enclosed closely enough.
fn uncertified(error: impl std::fmt::Display) -> PyErr {
    Uncertified::new_err(error.to_string())
}

#[pymodule(gil_used = false)]
fn _bipenalty(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Uncertified", module.py().get_type::<Uncertified>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<model::Core>()?;
    module.add_class::<map::Map>()?;
    module.add_class::<distributed::Part>()?;
    module.add_class::<distributed::Session>()?;
    module.add_function(wrap_pyfunction!(asked::limit_name, module)?)?;
    module.add_function(wrap_pyfunction!(distributed::split, module)?)?;
    module.add_function(wrap_pyfunction!(distributed::axis, module)?)
}
