//! u -> scale M^-1 (f - K u): a stencil for bars, rows of a sparse matrix for other meshes; unless M is diagonal, one
//! factorisation made in advance.

use std::ops::Range;

use rayon::prelude::*;

use super::inertia::Inertia;
use super::kernels::{self, Instructions, dispatched};
use super::rows::{ROWS, Rows};
use crate::error::Refusal;
use crate::pencil::{Matrix, Pencil, Tridiagonal};

/// Consecutive nodes with the same row of (f - K u):
/// left (u_{i-1} - u_i) + right (u_{i+1} - u_i) - ground u_i + load.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stretch {
    nodes: Range<usize>,
    left: f64,
    right: f64,
    ground: f64,
    load: f64,
}

impl Stretch {
    /// Whether the row is a plain second difference, as inside a uniform bar.
    #[inline(always)]
    fn is_uniform(&self) -> bool {
        self.left == self.right && self.ground == 0.0 && self.left != 0.0
    }

    fn same_row(&self, other: &Self) -> bool {
        let row = |s: &Self| [s.left, s.right, s.ground, s.load];
        row(self) == row(other)
    }

    /// The row at node i.
    #[inline(always)]
    fn rate(&self, u: &[f64], i: usize) -> f64 {
        let at = |j: usize| u.get(j).copied().unwrap_or(0.0);
        self.rate_between(at(i.wrapping_sub(1)), u[i], at(i + 1))
    }

    /// The same from the displacements of a node and its neighbours; that of a missing one does not matter.
    #[inline(always)]
    fn rate_between(&self, left: f64, here: f64, right: f64) -> f64 {
        let towards = |c: f64, there: f64| if c == 0.0 { 0.0 } else { c * (there - here) };
        towards(self.left, left) + towards(self.right, right) - self.ground * here + self.load
    }
}

/// f - K u, each row times a factor of its own.
#[derive(Debug, Clone)]
enum Forces {
    Stretches(Vec<Stretch>),
    Sparse(Rows),
}

impl Forces {
    /// The row of node i alone.
    #[inline]
    fn at(&self, u: &[f64], i: usize) -> f64 {
        match self {
            Self::Stretches(stretches) => {
                let k = stretches.partition_point(|stretch| stretch.nodes.end <= i);
                stretches[k].rate(u, i)
            }
            Self::Sparse(rows) => rows.at(u, i),
        }
    }
}

/// The map u -> scale M^-1 (f - K u), with n nodes. scale = dt gives the velocity increment of a step, "kick", m/s.
#[derive(Debug, Clone)]
pub struct Operator {
    rows: Forces,
    /// Unless M is diagonal.
    inertia: Option<Inertia>,
    instructions: Instructions,
}

impl Operator {
    /// The map of `pencil` under the nodal forces `load` (N, length n, or empty for none).
    ///
    /// # Errors
    /// A mass that has no Cholesky factor.
    pub fn new(pencil: &Pencil, load: &[f64], scale: f64) -> Result<Self, Refusal> {
        let lumped = pencil.mass().is_diagonal();
        let inertia = if lumped { None } else { Some(Inertia::new(pencil.mass(), scale)?) };
        let factor = |i: usize| if lumped { scale / pencil.mass().diagonal(i) } else { 1.0 };
        let rows = match pencil.stiffness() {
            Matrix::Chain(k) => Forces::Stretches(stretches(k, load, factor)),
            Matrix::Sparse(_) | Matrix::Diagonal(_) => {
                let factor = (0..pencil.size()).map(factor).collect();
                Forces::Sparse(Rows::new(pencil, factor, load.to_vec()))
            }
        };
        Ok(Self { rows, inertia, instructions: Instructions::detect() })
    }

    /// Whether M is diagonal.
    pub fn is_lumped(&self) -> bool {
        self.inertia.is_none()
    }

    /// rate = scale M^-1 (f - K u).
    pub fn apply(&self, u: &[f64], rate: &mut [f64]) {
        match &self.rows {
            Forces::Stretches(stretches) => {
                for stretch in stretches {
                    let Range { start, end } = stretch.nodes;
                    if stretch.is_uniform() {
                        let (around, rate) = (&u[start - 1..end + 1], &mut rate[start..end]);
                        kernels::uniform_rate(self.instructions, stretch.left, stretch.load, around, rate);
                    } else {
                        (start..end).for_each(|i| rate[i] = stretch.rate(u, i));
                    }
                }
            }
            Forces::Sparse(rows) => {
                rate.par_chunks_mut(ROWS).enumerate().for_each(|(task, rate)| {
                    rows.each(u, task, |first, forces| rate[first..][..forces.len()].copy_from_slice(forces));
                });
            }
        }
        if let Some(inertia) = &self.inertia {
            inertia.solve(rate);
        }
    }

    /// The rate of node i alone; M diagonal.
    #[inline]
    pub(super) fn rate_at(&self, u: &[f64], i: usize) -> f64 {
        self.rows.at(u, i)
    }

    /// v += rate, u += dt v in one pass; M diagonal. `next` is for displacements that others still need.
    pub(super) fn kick_drift(&self, dt: f64, u: &mut Vec<f64>, velocity: &mut [f64], next: &mut Vec<f64>) {
        match &self.rows {
            Forces::Stretches(stretches) => kick_drift_row(self.instructions, stretches, dt, u, velocity),
            Forces::Sparse(rows) => {
                let pieces = velocity.par_chunks_mut(ROWS).zip(next.par_chunks_mut(ROWS));
                pieces.enumerate().for_each(|(task, (velocity, next))| {
                    let before = &u[task * ROWS..];
                    rows.each(u, task, |first, forces| {
                        let (before, n) = (&before[first..][..forces.len()], forces.len());
                        let (velocity, next) = (&mut velocity[first..][..n], &mut next[first..][..n]);
                        for i in 0..n {
                            velocity[i] += forces[i];
                            next[i] = before[i] + dt * velocity[i];
                        }
                    });
                });
                std::mem::swap(u, next);
            }
        }
    }

    /// v += kick, u += dt v.
    pub fn drift(&self, dt: f64, kick: &[f64], velocity: &mut [f64], u: &mut [f64]) {
        kernels::drift(self.instructions, dt, kick, velocity, u);
    }
}

#[inline(always)]
fn kick_drift_stretches(stretches: &[Stretch], dt: f64, u: &mut [f64], velocity: &mut [f64]) {
    let mut left = 0.0;
    for stretch in stretches {
        let Range { start, end } = stretch.nodes;
        if stretch.is_uniform() {
            let (u, velocity) = (&mut u[start..=end], &mut velocity[start..end]);
            left = kernels::kick_drift(stretch.left, stretch.load, dt, left, u, velocity);
            continue;
        }
        for i in start..end {
            let (here, right) = (u[i], u.get(i + 1).copied().unwrap_or(0.0));
            velocity[i] += stretch.rate_between(left, here, right);
            u[i] = here + dt * velocity[i];
            left = here;
        }
    }
}

dispatched! {
    /// v += rate, u += dt v over all stretches: a bar of some hundred nodes would feel a choice for each.
    kick_drift_row = kick_drift_stretches(stretches: &[Stretch], dt: f64, u: &mut [f64], velocity: &mut [f64])
}

/// The rows of f - K u, times `factor` of their node, equal neighbours joined.
fn stretches(stiffness: &Tridiagonal, load: &[f64], factor: impl Fn(usize) -> f64) -> Vec<Stretch> {
    let mut found: Vec<Stretch> = Vec::new();
    for (i, own) in stiffness.diagonal.iter().enumerate() {
        let left = if i > 0 { -stiffness.left(i) } else { 0.0 };
        let right = if i + 1 < stiffness.diagonal.len() { -stiffness.right(i) } else { 0.0 };
        let ground = own - left - right;
        let f = factor(i);
        let load = f * load.get(i).copied().unwrap_or(0.0);
        let row = Stretch { nodes: i..i + 1, left: f * left, right: f * right, ground: f * ground, load };
        match found.last_mut() {
            Some(last) if last.same_row(&row) => last.nodes.end = i + 1,
            _ => found.push(row),
        }
    }
    found
}
