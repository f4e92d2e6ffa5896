//! Limits that the spectrum tells after a change of variables: other explicit schemes stand a multiple of its step, and a damped
//! step is stable exactly when an undamped one with another penalty is, see [`damping`](crate::damping).

use crate::damping::{Damping, Equivalent};
use crate::error::{Refusal, Result};
use crate::schemes::explicit::ExplicitScheme;
use crate::stability::{CriticalStep, Curve, MapPoint};

use super::asking::{Asking, LimitOf};
use super::{AnyModel, Largest};

/// Omega has fewer than 6 unit roundoffs, the product one more.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The map of a scheme from that of the spectrum: Omega/2 times each step.
pub(super) fn lengthened(mut curves: Vec<Curve>, scheme: &ExplicitScheme) -> Vec<Curve> {
    let longer = 0.5 * scheme.largest();
    let step = |found: CriticalStep| CriticalStep {
        critical_courant: found.critical_courant * longer,
        lower: found.lower * longer * (1.0 - ROUNDING),
        upper: found.upper * longer * (1.0 + ROUNDING),
        ..found
    };
    let points = curves.iter_mut().flat_map(|curve: &mut Curve| &mut curve.points);
    points.for_each(|point: &mut MapPoint| point.step = point.step.map(step));
    curves
}

/// The step that central differences must stand where `scheme` takes `time_step`, s.
pub(super) fn shortened(time_step: f64, scheme: &ExplicitScheme) -> f64 {
    time_step / (0.5 * scheme.largest())
}

/// What was found of an undamped problem, in the units of the damped one. An entry of the problem has 5 roundings.
fn divided(found: Largest, by: f64) -> Largest {
    let margin = 8.0 * f64::EPSILON;
    let Largest { value, lower, upper } = found;
    Largest { value: value / by, lower: lower / by * (1.0 - margin), upper: upper / by * (1.0 + margin) }
}

impl AnyModel {
    /// [`AnyModel::largest_penalty`] with damping: 2/dt <= A leaves no penalty.
    pub(super) fn largest_damped_penalty(
        &self,
        damping: Damping,
        time_step: f64,
        ratio: f64,
        asking: &Asking,
    ) -> Result<Option<Largest>> {
        let Some(undamped) = damping.equivalent(time_step) else { return Ok(None) };
        let ratio = ratio * (undamped.stiffness / undamped.mass);
        let found = self.largest_penalty(undamped.time_step(), ratio, &asking.of_spectrum())?;
        Ok(found.map(|found| divided(found, undamped.stiffness)))
    }

    /// [`AnyModel::largest_ratio`] with damping.
    pub(super) fn largest_damped_ratio(
        &self,
        damping: Damping,
        time_step: f64,
        beta_s: f64,
        asking: &Asking,
    ) -> Result<Option<Largest>> {
        let Some(undamped) = damping.equivalent(time_step) else { return Ok(None) };
        let beta_s = beta_s * undamped.stiffness;
        let found = self.largest_ratio(undamped.time_step(), beta_s, &asking.of_spectrum())?;
        Ok(found.map(|found| divided(found, undamped.stiffness / undamped.mass)))
    }

    /// [`AnyModel::contour`] of a limit that the spectrum tells.
    pub(super) fn transformed_contour(
        &self,
        critical_courant: f64,
        beta_s: (f64, f64),
        ratio: (f64, f64),
        asking: &Asking,
    ) -> Result<Vec<(f64, f64)>, Refusal> {
        let undamped = asking.of_spectrum();
        match &asking.limit {
            LimitOf::Explicit(scheme) => {
                self.contour(shortened(critical_courant, scheme), beta_s, ratio, &undamped)
            }
            LimitOf::Damped(damping) => {
                let dt = self.time_step(critical_courant)?;
                let Some(Equivalent { l, stiffness, mass }) = damping.equivalent(dt) else {
                    return Ok(Vec::new());
                };
                let courant = critical_courant * (2.0 / l.sqrt()) / dt;
                let (of_ratio, scaled) = (stiffness / mass, |(a, b): (f64, f64), by: f64| (a * by, b * by));
                let line =
                    self.contour(courant, scaled(beta_s, stiffness), scaled(ratio, of_ratio), &undamped)?;
                Ok(line.into_iter().map(|(b, r)| (b / stiffness, r / of_ratio)).collect())
            }
            LimitOf::Spectrum | LimitOf::Scheme(_) => self.contour(critical_courant, beta_s, ratio, asking),
        }
    }
}
