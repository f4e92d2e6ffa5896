//! What stepping is to confirm: the limit with closed contacts, and how fast a step just above it grows.

use crate::error::Refusal;
use crate::pencil::Pencil;
use crate::schemes::Scheme;
use crate::spectrum::Engine;
use crate::stability::{EngineName, Model, SchemeLimit};

use super::lattice::Lattice;
use super::trial::Trials;
use super::{Limit, Point, Search, steps_to_show};

/// What a prediction claims.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Evidence {
    /// The scheme is unstable just above it.
    Limit,
    /// The limit is not below it.
    LowerBound,
}

/// A predicted limit and what a run just above it does.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The limit as a Courant number c0 dt/h of the reference element.
    pub courant: f64,
    /// Whether it is the limit or a bound of it.
    pub evidence: Evidence,
    /// ln of the growth a step at (1 + tolerance) times the limit; `None` where no formula is at hand.
    pub growth: Option<f64>,
    /// Steps of a trial that show this growth.
    pub steps_needed: Option<f64>,
    /// Courant numbers between which the scheme is stable again above the limit.
    pub islands: Vec<(f64, f64)>,
}

impl Prediction {
    /// Whether trials of `steps` steps show the growth; one that is not known should show.
    pub fn is_visible(&self, steps: u64) -> bool {
        self.steps_needed.is_none_or(|needed| needed <= steps as f64)
    }
}

/// Predicts the limits of one scheme for one model.
pub struct Predictor<'a> {
    model: &'a Model,
    scheme: Scheme,
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
        Ok(Self { model, scheme, source })
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
        Prediction {
            courant: self.model.critical_courant(l),
            evidence: Evidence::Limit,
            growth,
            steps_needed,
            islands,
        }
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
    /// What was predicted, where there is a prediction.
    pub predicted: Option<Prediction>,
    /// What was found.
    pub found: Limit,
    /// See [`Limit::judge`]; false too if a trial in the middle of a predicted island grew.
    pub agrees: Option<bool>,
}

/// The limit that stepping finds at `point`, beside what `predicted` says; it is where the search begins. The trials in
/// predicted islands serve the judgement alone.
///
/// # Errors
/// As [`largest_stable_courant`](super::largest_stable_courant).
pub fn confirm(
    model: &Model,
    scheme: Scheme,
    theta: f64,
    point: Point,
    tolerance: f64,
    predicted: Option<Prediction>,
) -> Result<Confirmation, Refusal> {
    model.check(point.stiffness_penalty, point.ratio)?;
    let search = Search::to(tolerance, scheme)?;
    let penalties = model.penalties(point.stiffness_penalty, point.ratio);
    let trials = Trials::new(model, scheme, theta, penalties, &search)?;
    let found = Lattice::new(&trials).limit(predicted.as_ref().map_or(1.0, |p| p.courant))?;
    let mut agrees = predicted.as_ref().and_then(|predicted| found.judge(predicted, tolerance));
    for (low, high) in predicted.iter().flat_map(|predicted| &predicted.islands) {
        if trials.run(0.5 * (low + high), search.steps)?.grows {
            agrees = Some(false);
        }
    }
    Ok(Confirmation { predicted, found, agrees })
}
