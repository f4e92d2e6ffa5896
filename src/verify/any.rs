//! Limits found by stepping for models of any kind, beside what is predicted for them.

use std::sync::Arc;

use rayon::prelude::*;

use super::lattice::Lattice;
use super::prediction::judged;
use super::trial::{Stepped, Trials};
use super::{Bracket, Confirmation, PenaltyPoint, Prediction, Predictor, Search, steps_to_show};
use crate::error::{Refusal, Result};
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::schemes::Scheme;
use crate::spectrum::Uncertified;
use crate::stability::{AnyModel, Asking, CriticalStep, Grid, LimitOf, MapPoint};

/// A limit between two steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seconds {
    /// The step below the limit, whose trial did not grow, s; 0 if no step was found that is stable.
    pub stable_at: f64,
    /// Its neighbour, whose trial did, s.
    pub unstable_at: f64,
    /// The same in Courant numbers: c0 dt/h of bars, omega_ref dt/2 of matrices and meshes.
    pub courant: Bracket,
}

/// A prediction is enclosed more closely than stepping brackets by this factor, so that its width decides nothing.
const CLOSER: f64 = 1.0 / 64.0;

/// The largest stable step of `scheme` with the contacts of `model` held closed, by stepping alone; the search begins at
/// the contact-free step, which the Park scheme has as a parameter. The time goes with n times the steps of a trial.
///
/// # Errors
/// A step that is not positive, what [`Scheme::start`] and [`Search::to`] refuse, penalties that f64 cannot hold, a
/// contact-free limit that is not enclosed, and a model that no step makes unstable.
pub fn limit_of_any(
    model: &AnyModel,
    scheme: &dyn Scheme,
    point: PenaltyPoint,
    search: &Search,
) -> Result<Seconds> {
    let (trials, first) = trials(model, scheme, point, search)?;
    let unit = model.time_step(1.0)?;
    let courant = Lattice::new(&trials).limit(first)?;
    Ok(Seconds { stable_at: courant.stable_at * unit, unstable_at: courant.unstable_at * unit, courant })
}

/// Refuses what cannot be stepped at all.
///
/// # Errors
/// As [`limit_of_any`].
pub fn check_any(model: &AnyModel, scheme: &dyn Scheme, search: &Search) -> Result<()> {
    let point = PenaltyPoint { stiffness_penalty: StiffnessPenalty::new(1.0)?, ratio: Ratio::OPTIMAL };
    Ok(trials(model, scheme, point, search)?.0.start(1.0).map(|_| ())?)
}

/// What is predicted at the points of a grid, ratio by ratio, with the growth at (1 + `tolerance`) times each limit; a
/// point without a prediction has the reason.
pub fn predict_any(
    model: &AnyModel,
    scheme: &Arc<dyn Scheme>,
    grid: &Grid,
    tolerance: f64,
) -> Vec<Result<Prediction, Refusal>> {
    let found = match model {
        AnyModel::Bars(bars) => {
            let pencil = bars.pencil();
            Predictor::new(bars, &pencil, &**scheme).map(|predictor| {
                let points: Vec<PenaltyPoint> = points_of(grid).collect();
                points.par_iter().map(|point| predictor.at(*point, tolerance)).collect()
            })
        }
        AnyModel::Mesh(_) => {
            let limit = LimitOf::Scheme(scheme.clone());
            let asking = Asking { limit, tolerance: Some(CLOSER * tolerance), ..Asking::default() };
            model.map(grid, &asking, &|_| ()).map(|curves| {
                let points = curves.into_iter().flat_map(|curve| curve.points);
                points.map(|found| of_mesh(model, &asking.limit, &found, tolerance)).collect()
            })
        }
    };
    found.unwrap_or_else(|refusal| vec![Err(refusal); grid.len()])
}

/// The points of a grid, ratio by ratio, as maps have them.
pub fn points_of(grid: &Grid) -> impl Iterator<Item = PenaltyPoint> + '_ {
    let of_ratio = |ratio: &Ratio| {
        let ratio = *ratio;
        grid.stiffness_penalties.iter().map(move |b| PenaltyPoint { stiffness_penalty: *b, ratio })
    };
    grid.ratios.iter().flat_map(of_ratio)
}

/// As [`confirm`](super::confirm), of a model of any kind.
///
/// # Errors
/// As [`limit_of_any`].
pub fn confirm_any(
    model: &AnyModel,
    scheme: &dyn Scheme,
    point: PenaltyPoint,
    tolerance: f64,
    predicted: Option<Prediction>,
) -> Result<Confirmation> {
    let (trials, first) = trials(model, scheme, point, &Search::to(tolerance, scheme)?)?;
    Ok(judged(&trials, predicted, first, tolerance)?)
}

/// Trials at a point, and the contact-free Courant number.
fn trials<'a>(
    model: &AnyModel,
    scheme: &'a dyn Scheme,
    point: PenaltyPoint,
    search: &Search,
) -> Result<(Trials<'a>, f64)> {
    let penalty = model.penalty(point.stiffness_penalty, point.ratio)?;
    let (stepped, first) = match model {
        AnyModel::Bars(bars) => {
            bars.check(point.stiffness_penalty, point.ratio)?;
            (Stepped::bars(bars, &penalty)?, 1.0)
        }
        AnyModel::Mesh(mesh) => {
            let free = model.contact_free(&Asking::default())?.step?;
            let unit = model.time_step(1.0)?;
            let critical_step = unit * free.lower;
            let slowest = f64::INFINITY;
            (Stepped { pencil: mesh.stepping_pencil()?, critical_step, unit, slowest }, free.lower)
        }
    };
    Ok((Trials::new(stepped, scheme, penalty, search)?, first))
}

/// What the map of a mesh predicts. Above the limit of a spectrum central differences grow by 2 acosh(excess) a step, as
/// on bars; of the other schemes no growth is known, and trials have to show it.
fn of_mesh(
    model: &AnyModel,
    limit: &LimitOf,
    found: &MapPoint,
    tolerance: f64,
) -> Result<Prediction, Refusal> {
    let uncertified =
        |error: Uncertified| Refusal::new(model.name(), error, "points whose limit is enclosed that closely");
    let CriticalStep { critical_courant: courant, evidence, .. } = found.step.map_err(uncertified)?;
    let growth = limit.scheme().is_none().then(|| 2.0 * (1.0 + tolerance).acosh());
    let steps_needed = growth.map(|growth| steps_to_show(tolerance, growth, 1.0, f64::INFINITY));
    Ok(Prediction { courant, evidence, growth, steps_needed, islands: Vec::new() })
}
