//! What is asked of a model, in the words of Python.

use std::sync::Arc;

use bipenalty::damping::Damping;
use bipenalty::error::Refusal;
use bipenalty::schemes::explicit::ExplicitName;
use bipenalty::schemes::{Scheme, SchemeName, damped};
use bipenalty::stability::{Asking, LimitOf};
use pyo3::prelude::*;

use crate::refused;

/// Whose limit, with its theta, parameter and damping (A, B, c); what finds it; how closely; elements along a patch: the
/// keywords that all methods share.
#[derive(FromPyObject)]
pub struct Asked(String, Option<f64>, Option<f64>, [f64; 3], String, Option<f64>, Option<usize>);

impl Asked {
    /// The same as the library knows it.
    ///
    /// # Errors
    /// Names that are not known; a theta, a parameter or damping that the limit does not have.
    pub fn asking(self) -> PyResult<Asking> {
        let Self(limit, theta, parameter, damping, engine, tolerance, patch) = self;
        let limit = limit_of(&limit, theta, parameter, damping).map_err(refused)?;
        let engine = engine.parse().map_err(refused)?;
        Ok(Asking { limit, engine, tolerance, patch, ..Asking::default() })
    }
}

/// The name in records of what is asked.
///
/// # Errors
/// As [`Asked::asking`].
#[pyfunction]
pub fn limit_name(asked: Asked) -> PyResult<&'static str> {
    Ok(asked.asking()?.limit.name())
}

fn limit_of(
    limit: &str,
    theta: Option<f64>,
    parameter: Option<f64>,
    damping: [f64; 3],
) -> Result<LimitOf, Refusal> {
    let (damping, spectrum) = (damping_of(damping)?, LimitOf::Spectrum.name());
    let explicit = limit.parse::<ExplicitName>().ok();
    let scheme = limit.parse::<SchemeName>().ok();
    if limit != spectrum && explicit.is_none() && scheme.is_none() {
        let names = SchemeName::ALL.map(SchemeName::name).into_iter();
        let names: Vec<&str> = names.chain(ExplicitName::ALL.map(ExplicitName::name)).collect();
        let allowed = format!("{spectrum}, {}", names.join(", "));
        return Err(Refusal::new("limit", format!("{limit:?}"), allowed).suggesting(limit, names));
    }
    if let Some(theta) = theta.filter(|_| scheme != Some(SchemeName::Park)) {
        return Err(Refusal::new("theta", theta, format!("none with the limit {limit}, or park")));
    }
    if let Some(parameter) = parameter.filter(|_| explicit.is_none()) {
        let names = ExplicitName::ALL.map(ExplicitName::name).join(", ");
        let allowed = format!("none with the limit {limit}, or {names}");
        return Err(Refusal::new("parameter", parameter, allowed));
    }
    if let Some(explicit) = explicit {
        if damping.is_none() {
            return Ok(LimitOf::Explicit(explicit.with(parameter)?));
        }
        let value = format!("{limit} with damping, whose limit is not derived");
        let allowed =
            "none with this scheme, or spectrum, central-difference and predictor-corrector with it";
        return Err(Refusal::new("damping", value, allowed));
    }
    Ok(match scheme {
        None if damping.is_none() => LimitOf::Spectrum,
        Some(scheme) if damping.is_none() || scheme != SchemeName::CentralDifference => {
            LimitOf::Scheme(scheme_with(scheme, theta, damping)?)
        }
        _ => LimitOf::Damped(damping),
    })
}

/// C = A M + B K + c K_p, from A (1/s), B (s) and c (s).
fn damping_of([mass, stiffness, contact]: [f64; 3]) -> Result<Damping, Refusal> {
    Damping::new(mass, stiffness, contact)
}

/// A scheme that steps, with the theta of the Park scheme, and damping (A, B, c).
#[derive(FromPyObject)]
pub struct SchemeAsked(String, Option<f64>, [f64; 3]);

impl SchemeAsked {
    /// The same as the library knows it.
    ///
    /// # Errors
    /// A name that is not known; a theta outside [0, 1]; damping that is none, or that the scheme does not have.
    pub fn scheme(self) -> PyResult<Arc<dyn Scheme>> {
        let Self(name, theta, damping) = self;
        scheme_of(&name, theta, damping).map_err(refused)
    }
}

fn scheme_of(name: &str, theta: Option<f64>, damping: [f64; 3]) -> Result<Arc<dyn Scheme>, Refusal> {
    let name: SchemeName = name.parse()?;
    if let Some(theta) = theta.filter(|_| name != SchemeName::Park) {
        return Err(Refusal::new("theta", theta, format!("none with {}, or park", name.name())));
    }
    scheme_with(name, theta, damping_of(damping)?)
}

fn scheme_with(name: SchemeName, theta: Option<f64>, damping: Damping) -> Result<Arc<dyn Scheme>, Refusal> {
    match theta {
        Some(theta) if damping.is_none() => name.with_theta(theta),
        _ => damped(name, damping),
    }
}
