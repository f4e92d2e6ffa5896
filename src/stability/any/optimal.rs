//! The largest ratio that costs no step against the contact-free model, and lines of one step in the plane (beta_s, r).

use rayon::prelude::*;

use super::asking::{Asking, LimitOf};
use super::curve::step;
use super::mesh::MeshModel;
use super::{AnyModel, with_limit};
use crate::convex::Asked;
use crate::error::{Error, Refusal, Result};
use crate::penalty::StiffnessPenalty;
use crate::spectrum::{Enclosure, StepLimit, Uncertified};
use crate::stability::contour::{explicit, on_line};
use crate::stability::{
    Expectation, Model, OptimalRatio, contour, optimal_ratio, optimal_scheme_ratio, scheme_contour,
};

/// The ratio that was found, and the one that the theory expects.
type FoundAndExpected = (Option<OptimalRatio>, Option<f64>);

impl AnyModel {
    /// Encloses the largest ratio that costs no step at `beta_s`; `None` if none costs any. For the spectrum it is
    /// r* = l_max(K, M)/omega_ref^2 where the top mode moves a gap, and larger where it does not; for the
    /// predictor-corrector the ratio up to which the proven step is the contact-free one.
    ///
    /// # Errors
    /// As [`AnyModel::map`]; a limit that could not be enclosed.
    pub fn optimal_ratio(&self, beta_s: f64, asking: &Asking) -> Result<Option<OptimalRatio>> {
        let found = self.optimal_ratios(&[beta_s], asking, &|_| ())?;
        Ok(found.first().and_then(|(found, _)| *found))
    }

    /// [`AnyModel::optimal_ratio`] at each beta_s, with what the theory expects of it; expected is `None` where no ratio
    /// costs any, or none is known. `done` is told of ratios as they are found.
    ///
    /// # Errors
    /// As [`AnyModel::optimal_ratio`].
    pub fn optimal_ratios(
        &self,
        beta_s: &[f64],
        asking: &Asking,
        done: &(dyn Fn(usize) + Sync),
    ) -> Result<Vec<FoundAndExpected>> {
        self.check(asking)?;
        // A multiple of every step is one of both that are compared.
        let spectrum;
        let asking = match asking.limit {
            LimitOf::Explicit(_) => {
                spectrum = asking.of_spectrum();
                &spectrum
            }
            LimitOf::Spectrum | LimitOf::Scheme(_) | LimitOf::Damped(_) => asking,
        };
        // A closed contact changes what damping takes: the mediant inequality proves nothing there.
        if matches!(asking.limit, LimitOf::Damped(_)) {
            let value = format!("{}, whose optimal ratio is not derived", asking.limit.name());
            return Err(Refusal::new("limit", value, "no damping").into());
        }
        let beta_s = beta_s.iter().map(|b| StiffnessPenalty::new(*b)).collect::<Result<Vec<_>, _>>()?;
        match self {
            Self::Bars(model) => with_limit(model, asking, |limit| {
                Ok(ratios_of_bars(model, limit, asking.limit.scheme().is_some(), &beta_s, done))
            })?
            .map_err(Error::from),
            Self::Mesh(model) => {
                let one = |b: &StiffnessPenalty| {
                    let found = model.optimal_ratio(*b, asking)?;
                    done(1);
                    Ok((found, model.expected_ratio(b.get(), asking)?))
                };
                beta_s.iter().map(one).collect()
            }
        }
    }

    /// The points (beta_s, r) of a rectangle whose limit is `critical_courant`, ordered by beta_s; empty where there is none.
    ///
    /// # Errors
    /// As [`AnyModel::map`].
    pub fn contour(
        &self,
        critical_courant: f64,
        beta_s: (f64, f64),
        ratio: (f64, f64),
        asking: &Asking,
    ) -> Result<Vec<(f64, f64)>, Refusal> {
        self.check(asking)?;
        if matches!(asking.limit, LimitOf::Damped(_) | LimitOf::Explicit(_)) {
            return self.transformed_contour(critical_courant, beta_s, ratio, asking);
        }
        match self {
            Self::Mesh(model) => model.contour(critical_courant, beta_s, ratio, asking),
            Self::Bars(model) if asking.limit.scheme().is_none() => {
                contour(model, critical_courant, beta_s, ratio)
            }
            Self::Bars(model) => with_limit(model, asking, |limit| {
                Ok(scheme_contour(model, limit, critical_courant, beta_s, ratio))
            }),
        }
    }
}

/// Of bars, in parallel over beta_s.
fn ratios_of_bars(
    model: &Model,
    limit: &dyn StepLimit,
    of_scheme: bool,
    beta_s: &[StiffnessPenalty],
    done: &(dyn Fn(usize) + Sync),
) -> Result<Vec<FoundAndExpected>, Uncertified> {
    let expectation = if of_scheme { None } else { Some(Expectation::of(model, limit)?) };
    let one = |b: &StiffnessPenalty| {
        let found = match &expectation {
            Some(expectation) => (optimal_ratio(model, limit, expectation, *b)?, Some(expectation.ratio())),
            None => (optimal_scheme_ratio(model, limit, *b)?, limit.expected_ratio(b.get())),
        };
        done(1);
        Ok(found)
    };
    beta_s.par_iter().map(one).collect()
}

impl MeshModel {
    /// The contact-free l_max, as closely as asked for one point.
    fn free(&self, asking: &Asking) -> Result<Enclosure> {
        let found = self.with_curve(asking, |curve| {
            let found = curve.enclose_to(&[Asked { stiffness: 0.0, mass: 0.0 }], asking.width(1));
            Ok(found.into_iter().map(|found| step(found, asking, curve.prover())).next())
        })?;
        let none = Uncertified { value: f64::NAN, width: f64::INFINITY };
        Ok(found.unwrap_or(Err(none)).map(|step| step.l)?)
    }

    fn optimal_ratio(&self, beta_s: StiffnessPenalty, asking: &Asking) -> Result<Option<OptimalRatio>> {
        let (free, reference, b) = (self.free(asking)?, self.reference()?, beta_s.get());
        let ratio = |value: f64, lower: f64, upper: f64| {
            Some(OptimalRatio { stiffness_penalty: beta_s, value, lower, upper })
        };
        if b == 0.0 || self.pencil().contacts().is_empty() {
            return Ok(None);
        }
        if let Some(park) = asking.limit.scheme().and_then(|scheme| scheme.as_park()) {
            let upper = self.costly_ratio_of_park(asking, park, b)?;
            return Ok(upper.and_then(|upper| ratio(0.0, 0.0, upper)));
        }
        let error = self.with_curve(asking, |curve| Ok(self.reference_error(curve)))?;
        let down = 1.0 - 8.0 * f64::EPSILON - error;
        if asking.limit.scheme().is_some() {
            let mu = self.with_curve(asking, |curve| Ok(curve.upper().slope()))?;
            let left = 4.0 / free.lower - 1.0 / (b * mu);
            let lower = 1.0 / (reference * left) * down;
            return Ok(if left > 0.0 { ratio(lower, lower, f64::INFINITY) } else { None });
        }
        // Up to here the mediant inequality proves that nothing is lost.
        let lower = free.lower / reference * down;
        // f > u beyond t: with l = u the step is lost as soon as beta_s (1 - u/(r omega^2)) > t.
        let u = free.upper;
        let t = self.with_curve(asking, |curve| Ok(curve.passed(u, asking.width(1))))?;
        if t >= b {
            return Ok(None);
        }
        let upper = u / reference / (1.0 - t.max(0.0) / b) / down;
        Ok(ratio(upper, lower, upper))
    }

    fn expected_ratio(&self, beta_s: f64, asking: &Asking) -> Result<Option<f64>> {
        let (free, reference) = (self.free(asking)?, self.reference()?);
        if asking.limit.scheme().is_none() {
            return Ok(Some(free.lower / reference));
        }
        // The flexibility grows without bound at dt_c: each ratio costs.
        if asking.limit.scheme().is_some_and(|scheme| scheme.as_park().is_some()) {
            return Ok((beta_s > 0.0).then_some(0.0));
        }
        let mu = self.with_curve(asking, |curve| Ok(curve.upper().slope()))?;
        let left = 4.0 / free.lower - 1.0 / (beta_s * mu);
        Ok((left > 0.0).then(|| 1.0 / (reference * left)))
    }

    /// beta_s (1 - l/(r omega^2)) = f^-1(l); of the predictor-corrector 1/(beta_s mu) + 1/(r omega^2) = dt^2.
    fn contour(
        &self,
        critical_courant: f64,
        beta_s: (f64, f64),
        ratio: (f64, f64),
        asking: &Asking,
    ) -> Result<Vec<(f64, f64)>, Refusal> {
        if asking.limit.scheme().is_some_and(|scheme| scheme.as_park().is_some()) {
            let value = format!("park with scene {}, whose lines are not explicit", self.name());
            return Err(Refusal::new(
                "contour",
                value,
                "another limit, or lines between the points of a map",
            ));
        }
        let reference = self.reference()?;
        let x = 1.0 / (critical_courant * critical_courant);
        let l = reference * x;
        self.with_curve(asking, |curve| {
            if asking.limit.scheme().is_some() {
                let (mu, free) = (curve.upper().slope(), curve.mesh());
                let line = (l / (4.0 * mu), 0.25 * x);
                return Ok(if l >= free { on_line(line, beta_s, ratio) } else { Vec::new() });
            }
            let t = curve.passed(l, asking.width(1));
            Ok(if t.is_finite() { explicit(t, x, beta_s, ratio) } else { Vec::new() })
        })
    }
}
