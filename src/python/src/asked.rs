//! What is asked of a model, in the words of Python.

use bipenalty::error::Refusal;
use bipenalty::schemes::SchemeName;
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
    if let Some(theta) = theta.filter(|_| limit != SchemeName::Park.name()) {
        let allowed = format!("none with the limit {limit}, or the limit park");
        return Err(Refusal::new("theta", theta, allowed));
    }
    if limit == LimitOf::Spectrum.name() {
        return Ok(LimitOf::Spectrum);
    }
    let names =
        || format!("{}, {}", LimitOf::Spectrum.name(), SchemeName::ALL.map(SchemeName::name).join(", "));
    let refusal = |_| Refusal::new("limit", format!("{limit:?}"), names());
    let scheme: SchemeName = limit.parse().map_err(refusal)?;
    Ok(LimitOf::Scheme(match theta {
        Some(theta) => scheme.with_theta(theta)?,
        None => scheme.into(),
    }))
}
