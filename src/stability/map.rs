//! The map C_r(beta_s, r) of one model, curve by curve.

use rayon::prelude::*;

use super::{CriticalStep, Grid, Model};
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::spectrum::{StepLimit, Uncertified};

/// One point of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
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
    pub points: Vec<Point>,
}

/// Computes the certified map of `model` over `grid` with `limit`, in parallel over pieces of its curves.
///
/// Every point starts afresh or from its left neighbour within the same piece, and the pieces do not depend on the
/// number of threads: so the numbers do not either. `done` is told of every finished piece.
pub fn map(model: &Model, grid: &Grid, limit: &dyn StepLimit, done: &(dyn Fn(usize) + Sync)) -> Vec<Curve> {
    let pieces: Vec<(Ratio, &[StiffnessPenalty])> = grid
        .ratios
        .iter()
        .flat_map(|ratio| grid.stiffness_penalties.chunks(PIECE).map(|piece| (*ratio, piece)))
        .collect();
    let computed: Vec<Vec<Point>> = pieces
        .into_par_iter()
        .map(|(ratio, piece)| {
            let points = curve_piece(model, limit, ratio, piece);
            done(piece.len());
            points
        })
        .collect();
    let per_curve = grid.stiffness_penalties.len().div_ceil(PIECE);
    let curves = grid.ratios.iter().zip(computed.chunks(per_curve));
    curves.map(|(ratio, pieces)| Curve { ratio: *ratio, points: pieces.concat() }).collect()
}

/// Points in a piece: enough to spread the cost of a task, few enough to share a single curve between cores.
const PIECE: usize = 64;

fn curve_piece(model: &Model, limit: &dyn StepLimit, ratio: Ratio, piece: &[StiffnessPenalty]) -> Vec<Point> {
    let mut start = None;
    let solve = |beta_s: &StiffnessPenalty| {
        let (found, engine) = limit.enclose_by(&model.penalty(*beta_s, ratio), start);
        start = found.as_ref().ok().map(|step| step.l.value);
        Point { stiffness_penalty: *beta_s, step: found.map(|step| model.critical_step(step.l)), engine }
    };
    piece.iter().map(solve).collect()
}
