//! What is asked of a model, in the words of Python.

use std::sync::Arc;

use bipenalty::error::Refusal;
use bipenalty::schemes::{Scheme, SchemeName};
use bipenalty::stability::{Asking, LimitOf};
use pyo3::prelude::*;

use crate::refused;

/// Whose limit, what finds it, how closely: the keywords that all methods share.
#[derive(FromPyObject)]
pub struct Asked(String, Option<f64>, String, Option<f64>);

impl Asked {
    /// The same as the library knows it.
    ///
    /// # Errors
    /// Names that are not known; a theta that the limit does not use.
    pub fn asking(self) -> PyResult<Asking> {
        let Self(limit, theta, engine, tolerance) = self;
        let limit = limit_of(&limit, theta).map_err(refused)?;
        let engine = engine.parse().map_err(refused)?;
        Ok(Asking { limit, engine, tolerance, ..Asking::default() })
    }
}

fn limit_of(limit: &str, theta: Option<f64>) -> Result<LimitOf, Refusal> {
    if limit == LimitOf::Spectrum.name() && theta.is_none() {
        return Ok(LimitOf::Spectrum);
    }
    let names =
        || format!("{}, {}", LimitOf::Spectrum.name(), SchemeName::ALL.map(SchemeName::name).join(", "));
    let refusal = |_| Refusal::new("limit", format!("{limit:?}"), names());
    if let (true, Some(theta)) = (limit == LimitOf::Spectrum.name(), theta) {
        return Err(Refusal::new("theta", theta, "none with the limit spectrum, or park"));
    }
    let scheme: SchemeName = limit.parse().map_err(refusal)?;
    scheme_of(scheme.name(), theta).map(LimitOf::Scheme)
}

/// The scheme called `name`, with the theta of the Park scheme.
///
/// # Errors
/// A name that is not known; a theta outside [0, 1].
pub fn scheme_of(name: &str, theta: Option<f64>) -> Result<Arc<dyn Scheme>, Refusal> {
    let name: SchemeName = name.parse()?;
    if let Some(theta) = theta.filter(|_| name != SchemeName::Park) {
        return Err(Refusal::new("theta", theta, format!("none with {}, or park", name.name())));
    }
    match theta {
        Some(theta) => name.with_theta(theta),
        None => Ok(name.into()),
    }
}
