//! What stepping is to confirm: the limit with closed contacts, and how fast a step just above it grows.

use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::schemes::Scheme;
use crate::spectrum::Engine;
use crate::stability::{EngineName, Model, SchemeLimit};

use super::{Point, steps_to_show};

/// Slower growth a step than this is not looked for: some 1e7 steps a trial would be needed.
pub const VISIBLE_GROWTH: f64 = 1e-6;

/// A predicted limit and what a run just above it does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The limit as a Courant number c0 dt/h of the reference element.
    pub courant: f64,
    /// ln of the growth a step at (1 + tolerance) times the limit; `None` where no formula is at hand.
    pub growth: Option<f64>,
    /// Steps of a trial that show this growth.
    pub steps_needed: Option<f64>,
}

impl Prediction {
    /// Whether the growth is fast enough to be looked for; one that is not known is.
    pub fn is_visible(&self) -> bool {
        self.growth.is_none_or(|growth| growth >= VISIBLE_GROWTH)
    }
}

/// Predicts the limits of one scheme for one model.
pub struct Predictor<'a> {
    model: &'a Model,
    limit: Limit<'a>,
}

enum Limit<'a> {
    Spectrum(Box<dyn Engine + 'a>),
    Scheme(Box<SchemeLimit<'a>>),
}

impl<'a> Predictor<'a> {
    /// Central differences have the limit of the spectrum, the others their own; `theta` is for [`Scheme::Park`].
    ///
    /// # Errors
    /// What [`SchemeLimit::new`] refuses.
    pub fn new(model: &'a Model, pencil: &'a Pencil, scheme: Scheme, theta: f64) -> Result<Self, Refusal> {
        let limit = match scheme {
            Scheme::CentralDifference => Limit::Spectrum(model.engine(EngineName::Auto, None)),
            _ => Limit::Scheme(Box::new(SchemeLimit::new(model, pencil, scheme, theta)?)),
        };
        Ok(Self { model, limit })
    }

    /// What finds the limit as l = 4/dt^2.
    pub fn engine(&self) -> &dyn Engine {
        match &self.limit {
            Limit::Spectrum(engine) => engine.as_ref(),
            Limit::Scheme(limit) => limit.as_ref(),
        }
    }

    /// The limit at `point` and the growth at (1 + `tolerance`) times it. Above the spectrum's limit central differences
    /// have the multipliers -exp(+-g), cosh g = 2 (1 + tolerance)^2 - 1.
    pub fn at(&self, point: Point, tolerance: f64) -> Prediction {
        let penalties = self.model.penalties(point.stiffness_penalty, point.ratio);
        let l = self.engine().estimate(&penalties, None);
        let growth = match &self.limit {
            Limit::Spectrum(_) => Some(2.0 * (1.0 + tolerance).acosh()),
            Limit::Scheme(limit) => {
                let relative = (1.0 + tolerance) * (limit.contact_free().value / l).sqrt();
                limit.growth(&penalties, relative).map(f64::ln_1p)
            }
        };
        let steps_needed = growth.map(|growth| steps_to_show(tolerance, growth));
        Prediction { courant: self.model.critical_courant(l), growth, steps_needed }
    }
}
