//! The map C_r(beta_s, r) of one model, curve by curve.

use rayon::prelude::*;

use super::{CriticalStep, Grid, Model};
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::spectrum::{StepLimit, Uncertified};

/// One point of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPoint {
    /// beta_s.
    pub stiffness_penalty: StiffnessPenalty,
    /// The critical step, or why it could not be certified.
    pub step: Result<CriticalStep, Uncertified>,
    /// The engine that found it.
    pub engine: &'static str,
}

/// The points of one ratio, in the order of the stiffness penalties.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// r.
    pub ratio: Ratio,
    /// One point a stiffness penalty.
    pub points: Vec<MapPoint>,
}

/// Computes the certified map of `model` over `grid` with `limit`, in parallel over pieces of its curves.
///
/// Every point starts afresh or from its left neighbour within the same piece, and the pieces do not depend on the
/// number of threads: so the numbers do not either. `done` is told of every finished
/// piece, and of 0 points before each; it may unwind, which ends the map.
pub fn map(model: &Model, grid: &Grid, limit: &dyn StepLimit, done: &(dyn Fn(usize) + Sync)) -> Vec<Curve> {
    // In place, since a map of millions of points is bound by the memory it touches.
    let unknown = Err(Uncertified { value: f64::NAN, width: f64::INFINITY });
    let blank =
        |beta_s: &StiffnessPenalty| MapPoint { stiffness_penalty: *beta_s, step: unknown, engine: "" };
    let curve = |ratio: &Ratio| {
        let mut points: Vec<MapPoint> = grid.stiffness_penalties.iter().map(blank).collect();
        points.par_chunks_mut(PIECE).for_each(|piece| {
            // Whoever unwinds here ends the map: rayon begins every piece all the same.
            done(0);
            fill(model, limit, *ratio, piece);
            done(piece.len());
        });
        Curve { ratio: *ratio, points }
    };
    grid.ratios.par_iter().map(curve).collect()
}

/// Points in a piece: enough to spread the cost of a task, few enough to share a single curve between cores.
const PIECE: usize = 64;

fn fill(model: &Model, limit: &dyn StepLimit, ratio: Ratio, piece: &mut [MapPoint]) {
    let mut start = None;
    for point in piece {
        let (found, engine) = limit.enclose_by(&model.penalty(point.stiffness_penalty, ratio), start);
        start = found.as_ref().ok().map(|step| step.l.value);
        point.step = found.map(|step| model.critical_step_of(step));
        point.engine = engine;
    }
}
