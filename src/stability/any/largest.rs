//! The questions the other way round: the largest penalty, or ratio, that a given step stands.
//!
//! With l = 4/dt^2 and x = l/omega_ref^2 closed contact stands the step as long as
//!
//! ```text
//! f(beta_s (1 - x/r)) <= l      that is      beta_s (1 - x/r) <= f^-1(l)
//! ```
//! which is explicit in either; r <= x lets any penalty do. Bars ask their own engines, which know f^-1 point by point.

use super::asking::{Asking, LimitOf};
use super::mesh::MeshModel;
use super::park::Fixed;
use super::transformed::shortened;
use super::{AnyModel, with_limit};
use crate::convex::{Asked, Enclosed, Passing};
use crate::error::{Error, Refusal, Result};
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::pencil::Penalty;
use crate::schemes::SchemeName;
use crate::spectrum::{Evidence, Step, StepLimit, Uncertified, bisect};
use crate::stability::Model;

/// The largest of what was asked for, and its enclosure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Largest {
    /// As found; infinite where any will do.
    pub value: f64,
    /// The step is proven to be within the limit up to here.
    pub lower: f64,
    /// The step is proven to be beyond the limit from here on; infinite where that is not known.
    pub upper: f64,
}

impl Largest {
    /// Any will do.
    pub(super) const ANY: Self = Self { value: f64::INFINITY, lower: f64::INFINITY, upper: f64::INFINITY };
}

/// l = 4/dt^2 rounds twice, the step of another explicit scheme or a damped one up to 12 times (relative to l), and what is
/// compared with it a few times more.
pub(super) const MARGIN: f64 = 12.0 * f64::EPSILON;

/// l = 4/dt^2, rad^2/s^2, of a step dt, s: central differences stand the step as long as l_max <= l.
///
/// # Errors
/// A step that is not positive, or whose square f64 does not hold.
pub fn eigenvalue(time_step: f64) -> Result<f64, Refusal> {
    let l = 4.0 / (time_step * time_step);
    if time_step > 0.0 && l.is_normal() {
        return Ok(l);
    }
    Err(Refusal::new("time step", time_step, "a positive number (s) whose square is one in f64"))
}

impl AnyModel {
    /// The largest beta_s whose limit is not below `time_step`, s, with this ratio; `None` where the step is beyond the
    /// contact-free limit already.
    ///
    /// # Errors
    /// As [`AnyModel::map`]; a step or a ratio that is none; a contact-free limit that could not be enclosed.
    pub fn largest_penalty(&self, time_step: f64, ratio: f64, asking: &Asking) -> Result<Option<Largest>> {
        self.check(asking)?;
        match &asking.limit {
            LimitOf::Damped(damping) => {
                return self.largest_damped_penalty(*damping, time_step, ratio, asking);
            }
            LimitOf::Explicit(scheme) => {
                return self.largest_penalty(shortened(time_step, scheme), ratio, &asking.of_spectrum());
            }
            LimitOf::Spectrum | LimitOf::Scheme(_) => (),
        }
        let (l, ratio) = (eigenvalue(time_step)?, Ratio::new(ratio)?);
        match self {
            Self::Mesh(model) => match asking.limit.scheme().and_then(|scheme| scheme.as_park()) {
                Some(park) => model.largest_of_park(l, asking, park, Fixed::Ratio(ratio.get())),
                None => model.largest(l, asking, |given| given.penalty(ratio.get())),
            },
            Self::Bars(model) => {
                let penalty = |b: f64| Some((StiffnessPenalty::new(b).ok()?, ratio));
                // Of the spectrum r <= x: no penalty raises l_max above l (mediant inequality). Of the predictor-corrector
                // 1/(r omega^2) >= dt^2 = 4/l, which alone is a step that it stands.
                let share = match asking.limit.scheme().map(|scheme| scheme.facts().name) {
                    None => 1.0,
                    Some(name) if name == SchemeName::PredictorCorrector.name() => 0.25,
                    Some(_) => 0.0,
                };
                let any = ratio.get() * model.reference_eigenvalue() <= share * l * (1.0 - MARGIN);
                largest_of_bars(model, l, asking, any, penalty)
            }
        }
    }

    /// The largest ratio whose limit is not below `time_step`, s, with this beta_s; `None` where the step is beyond the
    /// contact-free limit already.
    ///
    /// # Errors
    /// As [`AnyModel::largest_penalty`].
    pub fn largest_ratio(&self, time_step: f64, beta_s: f64, asking: &Asking) -> Result<Option<Largest>> {
        self.check(asking)?;
        match &asking.limit {
            LimitOf::Damped(damping) => {
                return self.largest_damped_ratio(*damping, time_step, beta_s, asking);
            }
            LimitOf::Explicit(scheme) => {
                return self.largest_ratio(shortened(time_step, scheme), beta_s, &asking.of_spectrum());
            }
            LimitOf::Spectrum | LimitOf::Scheme(_) => (),
        }
        let (l, beta_s) = (eigenvalue(time_step)?, StiffnessPenalty::new(beta_s)?);
        match self {
            Self::Mesh(model) => match asking.limit.scheme().and_then(|scheme| scheme.as_park()) {
                Some(park) => model.largest_of_park(l, asking, park, Fixed::Penalty(beta_s.get())),
                None => model.largest(l, asking, |given| given.ratio(beta_s.get())),
            },
            Self::Bars(model) => {
                let penalty = |r: f64| Some((beta_s, Ratio::new(r).ok()?));
                largest_of_bars(model, l, asking, false, penalty)
            }
        }
    }
}

/// Where the largest of bars is looked for; an end that stands the step is said to, and nothing beyond it.
const RANGE: (f64, f64) = (1e-30, 1e30);

/// By bisection on the limit, which falls with either parameter, and two proofs beside the result.
fn largest_of_bars(
    model: &Model,
    l: f64,
    asking: &Asking,
    any: bool,
    penalty: impl Fn(f64) -> Option<(StiffnessPenalty, Ratio)>,
) -> Result<Option<Largest>> {
    let find = |limit: &dyn StepLimit| {
        let step = |x: f64| {
            let (beta_s, ratio) = penalty(x).filter(|(b, r)| model.check(*b, *r).is_ok())?;
            limit.enclose(&model.penalty(beta_s, ratio), None).ok()
        };
        Ok(limit.enclose(&Penalty::NONE, None).map(|free| of_limit(&free, l, any, step)))
    };
    with_limit(model, asking, find)?.map_err(Error::from)
}

fn of_limit(free: &Step, l: f64, any: bool, step: impl Fn(f64) -> Option<Step>) -> Option<Largest> {
    if l < free.l.lower * (1.0 - MARGIN) {
        return None;
    }
    let within = |x: f64| step(x).is_some_and(|step| step.l.upper <= l * (1.0 - MARGIN));
    let beyond = |x: f64| {
        step(x).is_some_and(|s| s.evidence != Evidence::LowerBound && s.l.lower > l * (1.0 + MARGIN))
    };
    // What cannot be computed counts as too much.
    let exceeds = |x: f64| step(x).is_none_or(|step| step.l.value > l);
    let known = |x: f64| step(x).is_some();
    let mut high = RANGE.1;
    while high > RANGE.0 && !known(high) {
        high *= 0.1;
    }
    // An infinite ratio can be asked for itself, an infinite penalty cannot.
    if any && l >= free.l.upper * (1.0 + MARGIN) || within(f64::INFINITY) {
        return Some(Largest::ANY);
    }
    // Where the limit tends to the step, rounding decides long before it is reached: the proof ends far below the value.
    let proven = |value: f64| match within(RANGE.0) {
        true => bisect(RANGE.0.ln(), value.ln(), |x| !within(x.exp())).0.exp(),
        false => 0.0,
    };
    if within(high) || !exceeds(high) {
        return Some(Largest { lower: if within(high) { high } else { proven(high) }, ..Largest::ANY });
    }
    let (low, _) = bisect(RANGE.0.ln(), high.ln(), |x| exceeds(x.exp()));
    let value = low.exp();
    let (mut lower, mut upper) = (0.0, f64::INFINITY);
    let mut apart = 16.0 * f64::EPSILON;
    while apart < 0.5 {
        if lower == 0.0 && within(value * (1.0 - apart)) {
            lower = value * (1.0 - apart);
        }
        if upper.is_infinite() && beyond(value * (1.0 + apart)) {
            upper = value * (1.0 + apart);
        }
        if lower > 0.0 && upper.is_finite() {
            break;
        }
        apart *= 2.0;
    }
    Some(Largest { value, lower: if lower > 0.0 { lower } else { proven(value) }, upper })
}

/// What a mesh says about a step.
pub(super) struct Given {
    /// 4/dt^2 and omega_ref^2, rad^2/s^2.
    l: f64,
    reference: f64,
    /// What rounding, and what is left of the reference, may take, relative.
    margin: f64,
    kind: Kind,
}

enum Kind {
    /// f passes l.
    Spectrum(Passing),
    /// l_max(P, M), proven from above.
    PredictorCorrector(f64),
}

impl MeshModel {
    fn largest(
        &self,
        l: f64,
        asking: &Asking,
        of: impl FnOnce(&Given) -> Largest,
    ) -> Result<Option<Largest>> {
        let reference = self.reference()?;
        let found = self.with_curve(asking, |curve| {
            let free = curve.enclose_to(&[Asked { stiffness: 0.0, mass: 0.0 }], asking.width(1));
            let free = free.into_iter().map(|free| free.unwrap_or_else(|wide| wide.enclosed)).next();
            let Enclosed { lower, upper } = free.unwrap_or(Enclosed { lower: 0.0, upper: f64::INFINITY });
            if !(lower > 0.0 && upper.is_finite()) {
                return Ok(Err(Uncertified { value: lower, width: f64::INFINITY }));
            }
            if l < lower * (1.0 - MARGIN) {
                return Ok(Ok(None));
            }
            let margin = MARGIN + self.reference_error(curve);
            let kind = match asking.limit.scheme() {
                None => Kind::Spectrum(curve.passing(l, asking.width(1))),
                Some(_) if l >= upper => Kind::PredictorCorrector(curve.upper().slope()),
                // Between the bounds of the contact-free limit nothing is known.
                Some(_) => Kind::PredictorCorrector(f64::INFINITY),
            };
            Ok(Ok(Some(Given { l, reference, margin, kind })))
        })?;
        Ok(found.map_err(Error::from)?.map(|given| of(&given)))
    }
}

impl Given {
    /// The largest beta_s with a ratio.
    fn penalty(&self, ratio: f64) -> Largest {
        match &self.kind {
            Kind::Spectrum(passing) => {
                let share = 1.0 - self.l / (ratio * self.reference);
                let lost = self.margin * (1.0 + self.l / (ratio * self.reference));
                // Below the contact-free limit by less than its own width nothing is proven.
                let within = passing.lower >= 0.0;
                if share + lost <= 0.0 && within {
                    return Largest::ANY;
                }
                let over =
                    |t: f64, share: f64| if share > 0.0 { (t / share).max(0.0) } else { f64::INFINITY };
                let lower = if within { over(passing.lower, share + lost) } else { 0.0 };
                let upper = over(passing.upper, share - lost);
                // The upper end is where the best vector passes l; the proof stops short of it.
                Largest { value: upper, lower, upper }
            }
            Kind::PredictorCorrector(mu) => {
                let left = (4.0 / self.l) * (1.0 + self.margin)
                    - 1.0 / (ratio * self.reference) * (1.0 - self.margin);
                at_most(if left > 0.0 { 1.0 / (mu * left) * (1.0 - self.margin) } else { f64::INFINITY })
            }
        }
    }

    /// The largest ratio with a beta_s.
    fn ratio(&self, beta_s: f64) -> Largest {
        let x = self.l / self.reference;
        match &self.kind {
            Kind::Spectrum(passing) => {
                // r <= x beta_s/(beta_s - t), with t = f^-1(l).
                let of = |t: f64| if t >= beta_s { f64::INFINITY } else { x * beta_s / (beta_s - t) };
                let ends = |t: f64, margin: f64| of(t + margin * (t.abs() + beta_s)) * (1.0 + margin);
                let lower = if passing.lower >= 0.0 { ends(passing.lower, -self.margin) } else { 0.0 };
                let upper = ends(passing.upper, self.margin);
                Largest { value: upper, lower, upper }
            }
            Kind::PredictorCorrector(mu) if mu.is_infinite() => at_most(0.0),
            Kind::PredictorCorrector(mu) => {
                let own = if beta_s == 0.0 { f64::INFINITY } else { 1.0 / (beta_s * mu) };
                let left = (4.0 / self.l) * (1.0 + self.margin) - own * (1.0 - self.margin);
                at_most(if left > 0.0 {
                    1.0 / (self.reference * left) * (1.0 - self.margin)
                } else {
                    f64::INFINITY
                })
            }
        }
    }
}

/// Of a limit that is known from below only.
pub(super) fn at_most(lower: f64) -> Largest {
    Largest { value: lower, lower, upper: f64::INFINITY }
}
