//! What stepping is to confirm: the limit with closed contacts, and how fast a step just above it grows.

use crate::error::Refusal;
use crate::pencil::{Penalty, Pencil};
use crate::schemes::Scheme;
use crate::spectrum::{Engine as _, Evidence, Step, StepLimit};
use crate::stability::Model;

use super::lattice::Lattice;
use super::slowest::slowest_period;
use super::trial::{Stepped, Trials};
use super::{Bracket, PenaltyPoint, Search, steps_to_show};

/// A predicted limit and what a run just above it does.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The limit as a Courant number c0 dt/h of the reference element.
    pub courant: f64,
    /// Whether it is the limit or a lower bound of it.
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
    limit: Box<dyn StepLimit + 'a>,
    /// The contact-free l_max, rad^2/s^2.
    contact_free: f64,
}

impl<'a> Predictor<'a> {
    /// For `model`, whose pencil is `pencil`.
    ///
    /// # Errors
    /// What [`Model::limit`] refuses, and a contact-free limit that is not certified.
    pub fn new(model: &'a Model, pencil: &'a Pencil, scheme: &dyn Scheme) -> Result<Self, Refusal> {
        let limit = model.limit(scheme, pencil)?;
        let contact_free = model.auto().enclose(&Penalty::NONE, None);
        let uncertified =
            |e| Refusal::new(model.scene().name(), e, "scenes whose contact-free limit is certified");
        Ok(Self { model, limit, contact_free: contact_free.map_err(uncertified)?.value })
    }

    /// What finds the limit.
    pub fn limit(&self) -> &dyn StepLimit {
        &*self.limit
    }

    /// The contact-free l_max, rad^2/s^2.
    pub fn contact_free(&self) -> f64 {
        self.contact_free
    }

    /// l = 4/dt^2 of the limit at `point`.
    ///
    /// # Errors
    /// A limit that could not be certified.
    pub fn step(&self, point: PenaltyPoint) -> Result<Step, Refusal> {
        let penalty = self.model.penalty(point.stiffness_penalty, point.ratio);
        let uncertified = |e| Refusal::new(self.model.scene().name(), e, "points whose limit is certified");
        self.limit.enclose(&penalty, None).map_err(uncertified)
    }

    /// The limit at `point` and the growth at (1 + `tolerance`) times it.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn at(&self, point: PenaltyPoint, tolerance: f64) -> Result<Prediction, Refusal> {
        let step = self.step(point)?;
        let penalty = self.model.penalty(point.stiffness_penalty, point.ratio);
        let growth = self.limit.growth(&penalty, &step, 1.0 + tolerance);
        let free = self.model.critical_courant(self.contact_free);
        let courant = |l: f64| (self.contact_free / l).sqrt() * free;
        let islands = self.limit.islands(&penalty);
        let share = self.limit.share(&step);
        let courant_of_limit = self.model.critical_courant(step.l.value);
        let swing = slowest_period(self.model, &penalty) / self.model.time_step(courant_of_limit);
        Ok(Prediction {
            courant: courant_of_limit,
            evidence: step.evidence,
            growth,
            steps_needed: growth.map(|growth| steps_to_show(tolerance, growth, share, swing)),
            islands: islands.iter().map(|(high, low)| (courant(*high), courant(*low))).collect(),
        })
    }
}

/// A prediction beside what stepping found.
#[derive(Debug, Clone, PartialEq)]
pub struct Confirmation {
    /// What was predicted, where there is a prediction.
    pub predicted: Option<Prediction>,
    /// What was found.
    pub found: Bracket,
    /// See [`Bracket::judge`]; false too if a trial in the middle of a predicted island grew.
    pub agrees: Option<bool>,
}

/// The limit that stepping finds at `point`, beside what `predicted` says; it is where the search begins. The trials in
/// predicted islands serve the judgement alone.
///
/// # Errors
/// As [`largest_stable_courant`](super::largest_stable_courant).
pub fn confirm(
    model: &Model,
    scheme: &dyn Scheme,
    point: PenaltyPoint,
    tolerance: f64,
    predicted: Option<Prediction>,
) -> Result<Confirmation, Refusal> {
    model.check(point.stiffness_penalty, point.ratio)?;
    let search = Search::to(tolerance, scheme)?;
    let penalty = model.penalty(point.stiffness_penalty, point.ratio);
    let trials = Trials::new(Stepped::bars(model, &penalty)?, scheme, penalty, &search)?;
    judged(&trials, predicted, 1.0, tolerance)
}

/// The limit that trials find, looked for from the prediction or from `first`, and what it says of the prediction.
pub(super) fn judged(
    trials: &Trials<'_>,
    predicted: Option<Prediction>,
    first: f64,
    tolerance: f64,
) -> Result<Confirmation, Refusal> {
    let found = Lattice::new(trials).limit(predicted.as_ref().map_or(first, |p| p.courant))?;
    let mut agrees = predicted.as_ref().and_then(|predicted| found.judge(predicted, tolerance));
    for (low, high) in predicted.iter().flat_map(|predicted| &predicted.islands) {
        if trials.run(0.5 * (low + high), trials.search.steps)?.grows {
            agrees = Some(false);
        }
    }
    Ok(Confirmation { predicted, found, agrees })
}
