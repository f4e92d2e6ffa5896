//! Maps of meshes: every point of a spectrum from the convex curve, and of the predictor-corrector from two numbers of it.

use super::asking::{Asking, LimitOf};
use super::mesh::MeshModel;
use crate::convex::{Asked, Curve, Enclosed, Prover, TooWide};
use crate::damping::{Damping, enclose_damped};
use crate::error::Refusal;
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::spectrum::{Enclosure, Evidence, Step, Uncertified};
use crate::stability::{self, CriticalStep, Grid, MapPoint, model};

/// The engine in records, by what proves its bounds.
pub(super) fn engine(prover: &Prover) -> &'static str {
    match prover {
        Prover::Whole(_) => "convex",
        Prover::Patches(_) => "convex-patches",
        Prover::Chance(_) => "convex-chance",
    }
}

/// Of the lower bound that the predictor-corrector has.
const BOUND: &str = "convex-bound";

impl MeshModel {
    pub(super) fn map(&self, grid: &Grid, asking: &Asking) -> Result<Vec<stability::Curve>, Refusal> {
        let reference = self.reference()?;
        let Found { steps, engine, error } = match (&asking.limit, asking.limit.scheme()) {
            (LimitOf::Damped(damping), _) => self.damped(grid, asking, reference, *damping)?,
            (_, None) => self.spectrum(grid, asking, reference)?,
            (_, Some(scheme)) => match scheme.as_park() {
                Some(park) => self.park(grid, asking, reference, park)?,
                None => self.predictor_corrector(grid, asking, reference)?,
            },
        };
        let mut steps = steps.into_iter();
        let mut curve = |ratio: &Ratio| {
            let steps = steps.by_ref().take(grid.stiffness_penalties.len());
            let point = |(beta_s, step): (&StiffnessPenalty, Result<Step, Uncertified>)| MapPoint {
                stiffness_penalty: *beta_s,
                step: step.map(|step| critical_step(reference, error, step)),
                engine,
            };
            let points = grid.stiffness_penalties.iter().zip(steps).map(point).collect();
            stability::Curve { ratio: *ratio, points }
        };
        Ok(grid.ratios.iter().map(&mut curve).collect())
    }

    fn spectrum(&self, grid: &Grid, asking: &Asking, reference: f64) -> Result<Found, Refusal> {
        let asked: Vec<Asked> = pairs(grid).map(|(r, b)| Asked::of(b.get(), r.get(), reference)).collect();
        self.with_curve(asking, |curve| {
            let width = asking.width(asked.len());
            let error = self.counted_error(curve, 0.5 * width);
            let found = curve.enclose_to(&asked, width - error);
            let prover = curve.prover();
            let point = |(asked, found): (&Asked, Result<Enclosed, TooWide>)| {
                let step = step(found, asking, prover)?;
                // With m/(1 + e) for m the root of f(s - l m) = l moves up, and by no more than e: f(s - l m) = l itself
                // lies at l (1 + e) or above.
                let more = if asked.mass > 0.0 { error } else { 0.0 };
                let l = Enclosure { upper: step.l.upper * (1.0 + more), ..step.l };
                Ok(Step { l, ..step })
            };
            let steps = asked.iter().zip(found).map(point).collect();
            Ok(Found { steps, engine: engine(prover), error })
        })
    }

    /// By undamped problems of the same curve. With m/(1 + e) for m, y N - C - S/y stays semidefinite at (1 + e) y: l moves by no
    /// more than (1 + e)^2.
    fn damped(
        &self,
        grid: &Grid,
        asking: &Asking,
        reference: f64,
        damping: Damping,
    ) -> Result<Found, Refusal> {
        let asked: Vec<Asked> = pairs(grid).map(|(r, b)| Asked::of(b.get(), r.get(), reference)).collect();
        self.with_curve(asking, |curve| {
            let width = asking.width(asked.len());
            let error = self.counted_error(curve, 0.25 * width);
            // The step of a search is up to twice as wide as those of its problems.
            let narrow = 0.5 * width - error;
            let found = enclose_damped((self.pencil(), &mut *curve), damping, &asked, narrow);
            let prover = curve.prover();
            let point = |(asked, found): (&Asked, Result<Step, TooWide>)| {
                let found = match found {
                    Ok(step) => step,
                    Err(wide) => step(Err(wide), asking, prover)?,
                };
                let more = if asked.mass > 0.0 { error } else { 0.0 };
                let l = Enclosure { upper: found.l.upper * (1.0 + more).powi(2), ..found.l };
                Ok(Step { l, ..found })
            };
            let steps = asked.iter().zip(found).map(point).collect();
            Ok(Found { steps, engine: engine(prover), error })
        })
    }

    /// dt^2 = 1/(r omega^2) + 1/(beta_s l_max(P, M)), no more than the contact-free limit.
    fn predictor_corrector(&self, grid: &Grid, asking: &Asking, reference: f64) -> Result<Found, Refusal> {
        let width = asking.width(grid.len());
        self.with_curve(asking, |curve| {
            let error = self.reference_error(curve);
            let found = curve.enclose_to(&[Asked { stiffness: 0.0, mass: 0.0 }], width);
            let free = found.into_iter().map(|found| step(found, asking, curve.prover())).next();
            let at = |(r, b): (Ratio, StiffnessPenalty)| match free {
                Some(Ok(free)) => Ok(bound(curve, free.l, reference * (1.0 + error), r.get(), b.get())),
                Some(Err(wide)) => Err(wide),
                None => Err(Uncertified { value: f64::NAN, width: f64::INFINITY }),
            };
            Ok(Found { steps: pairs(grid).map(at).collect(), engine: BOUND, error })
        })
    }
}

/// The points of a grid, ratio by ratio.
pub(super) fn pairs(grid: &Grid) -> impl Iterator<Item = (Ratio, StiffnessPenalty)> + '_ {
    grid.ratios.iter().flat_map(|r| grid.stiffness_penalties.iter().map(move |b| (*r, *b)))
}

/// The step of the sufficient half, stable for any contacts; sharp where they are alike.
fn bound(curve: &Curve, free: Enclosure, reference: f64, ratio: f64, beta_s: f64) -> Step {
    let own = beta_s * curve.upper().slope();
    if own == 0.0 {
        return Step::proven(free);
    }
    // Six roundings, of positive terms.
    let contact = 4.0 / (1.0 / own + 1.0 / (ratio * reference)) * (1.0 + 4.0 * f64::EPSILON);
    let Enclosure { lower, upper, .. } = free;
    Step::at_least(Enclosure { value: lower.max(contact), lower, upper: upper.max(contact) })
}

/// Limits, ratio by ratio.
pub(super) struct Found {
    pub steps: Vec<Result<Step, Uncertified>>,
    pub engine: &'static str,
    /// How far the reference may lie above its number, relative.
    pub error: f64,
}

/// What was found, if it is as narrow as asked; of patches and chance any bound is good where nothing was asked.
pub(super) fn step(
    found: Result<Enclosed, TooWide>,
    asking: &Asking,
    prover: &Prover,
) -> Result<Step, Uncertified> {
    let enclosed = match (found, prover) {
        (Ok(enclosed), _) => enclosed,
        (Err(TooWide { enclosed, .. }), Prover::Patches(_) | Prover::Chance(_))
            if asking.tolerance.is_none() && enclosed.step_width() <= Asking::BY_PATCHES =>
        {
            enclosed
        }
        (Err(wide), _) => return Err(uncertified(wide.enclosed)),
    };
    let evidence = match prover {
        Prover::Whole(_) | Prover::Patches(_) => Evidence::Proven,
        Prover::Chance(chance) => Evidence::Probability(chance.probability()),
    };
    Ok(Step { l: enclosure(enclosed), evidence })
}

/// The lower bound is the value: a Ritz value, which errs by far less than the proof above it.
fn enclosure(Enclosed { lower, upper }: Enclosed) -> Enclosure {
    Enclosure { value: lower, lower, upper }
}

/// What is known all the same: the value is the proven lower bound, value (1 + width) the upper.
fn uncertified(Enclosed { lower, upper }: Enclosed) -> Uncertified {
    Uncertified { value: lower, width: if lower > 0.0 { upper / lower - 1.0 } else { f64::INFINITY } }
}

/// In units of the reference omega_ref^2, which may be larger by a part e: C = omega_ref dt/2, (1 + e)^1/2 <= 1 + e/2.
fn critical_step(reference: f64, error: f64, step: Step) -> CriticalStep {
    let found = model::critical_step(0.25 * reference, step);
    CriticalStep { upper: found.upper * (1.0 + 0.5 * error), ..found }
}
