//! What stepping is to confirm: the limit with closed contacts, and how fast a step just above it grows.

use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::schemes::Scheme;
use crate::spectrum::Engine;
use crate::stability::{EngineName, Model, SchemeLimit};

use super::{Limit, Point, Search, Trials, steps_to_show};

/// Slower growth a step than this is not looked for: some 1e7 steps a trial would be needed.
pub const VISIBLE_GROWTH: f64 = 1e-6;

/// A predicted limit and what a run just above it does.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The limit as a Courant number c0 dt/h of the reference element.
    pub courant: f64,
    /// ln of the growth a step at (1 + tolerance) times the limit; `None` where no formula is at hand.
    pub growth: Option<f64>,
    /// Steps of a trial that show this growth.
    pub steps_needed: Option<f64>,
    /// Courant numbers between which the scheme is stable again above the limit.
    pub islands: Vec<(f64, f64)>,
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
    scheme: Scheme,
    theta: f64,
    source: Source<'a>,
}

enum Source<'a> {
    Spectrum(Box<dyn Engine + 'a>),
    Scheme(Box<SchemeLimit<'a>>),
}

impl<'a> Predictor<'a> {
    /// Central differences have the limit of the spectrum, the others their own; `theta` is for [`Scheme::Park`].
    ///
    /// # Errors
    /// What [`SchemeLimit::new`] refuses.
    pub fn new(model: &'a Model, pencil: &'a Pencil, scheme: Scheme, theta: f64) -> Result<Self, Refusal> {
        let source = match scheme {
            Scheme::CentralDifference => Source::Spectrum(model.engine(EngineName::Auto, None)),
            _ => Source::Scheme(Box::new(SchemeLimit::new(model, pencil, scheme, theta)?)),
        };
        Ok(Self { model, scheme, theta, source })
    }

    /// What finds the limit as l = 4/dt^2.
    pub fn engine(&self) -> &dyn Engine {
        match &self.source {
            Source::Spectrum(engine) => engine.as_ref(),
            Source::Scheme(limit) => limit.as_ref(),
        }
    }

    /// The limit at `point` and the growth at (1 + `tolerance`) times it. Above the spectrum's limit central differences
    /// have the multipliers -exp(+-g), cosh g = 2 (1 + tolerance)^2 - 1.
    pub fn at(&self, point: Point, tolerance: f64) -> Prediction {
        let penalties = self.model.penalties(point.stiffness_penalty, point.ratio);
        let l = self.engine().estimate(&penalties, None);
        let (growth, islands) = match &self.source {
            Source::Spectrum(_) => (Some(2.0 * (1.0 + tolerance).acosh()), Vec::new()),
            Source::Scheme(limit) => {
                let relative = (1.0 + tolerance) * (limit.contact_free().value / l).sqrt();
                let free = self.model.critical_courant(limit.contact_free().value);
                let islands = limit.islands(&penalties);
                (
                    limit.growth(&penalties, relative).map(f64::ln_1p),
                    islands.iter().map(|(low, high)| (low * free, high * free)).collect(),
                )
            }
        };
        let steps_needed = growth.map(|growth| steps_to_show(tolerance, growth, self.share(l)));
        Prediction { courant: self.model.critical_courant(l), growth, steps_needed, islands }
    }

    /// The share of a start with velocities alone that grows beyond the limit l. The Park scheme meets a stiff contact with
    /// the displacement that these have made in a step, dt/dt_c of what they make in the modes of the bars.
    fn share(&self, l: f64) -> f64 {
        match &self.source {
            Source::Scheme(limit) if self.scheme == Scheme::Park => {
                (limit.contact_free().value / l).sqrt().min(1.0)
            }
            _ => 1.0,
        }
    }
}

/// A prediction beside what stepping found.
#[derive(Debug, Clone, PartialEq)]
pub struct Confirmation {
    /// What was predicted.
    pub predicted: Prediction,
    /// What was found.
    pub found: Limit,
    /// See [`Limit::judge`]; false too if a trial in the middle of a predicted island grew.
    pub agrees: Option<bool>,
}

/// Steps at the limit that `predictor` has for `point`, and in its islands.
///
/// # Errors
/// As [`largest_stable_courant`](super::largest_stable_courant).
pub fn confirm(predictor: &Predictor, point: Point, tolerance: f64) -> Result<Confirmation, Refusal> {
    let Predictor { model, scheme, theta, .. } = *predictor;
    let predicted = predictor.at(point, tolerance);
    let search = Search::for_prediction(tolerance, scheme, &predicted)?;
    let trials = Trials::new(model, scheme, theta, point, &search)?;
    let found = trials.near(predicted.courant)?;
    let mut agrees = found.judge(&predicted, tolerance);
    for (low, high) in &predicted.islands {
        if trials.run(0.5 * (low + high))?.growth.is_some() {
            agrees = Some(false);
        }
    }
    Ok(Confirmation { predicted, found, agrees })
}
