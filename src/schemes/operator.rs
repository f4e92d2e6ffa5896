//! u -> scale M^-1 (f - K u): a stencil, and for a banded mass one factorisation made in advance.

use std::ops::Range;

use super::kernels::{self, Instructions};
use super::twisted::Twisted;
use crate::pencil::Pencil;

/// Consecutive nodes with the same row of (f - K u):
/// left (u_{i-1} - u_i) + right (u_{i+1} - u_i) - ground u_i + load.
#[derive(Debug, Clone, PartialEq)]
struct Stretch {
    nodes: Range<usize>,
    left: f64,
    right: f64,
    ground: f64,
    load: f64,
}

impl Stretch {
    /// Whether the row is a plain second difference, as inside a uniform bar.
    fn is_uniform(&self) -> bool {
        self.left == self.right && self.ground == 0.0 && self.left != 0.0
    }

    fn same_row(&self, other: &Self) -> bool {
        let row = |s: &Self| [s.left, s.right, s.ground, s.load];
        row(self) == row(other)
    }

    /// The row at node i.
    #[inline]
    fn rate(&self, u: &[f64], i: usize) -> f64 {
        let towards = |c: f64, j: usize| if c == 0.0 { 0.0 } else { c * (u[j] - u[i]) };
        let left = towards(self.left, i.wrapping_sub(1));
        left + towards(self.right, i + 1) - self.ground * u[i] + self.load
    }
}

/// The map u -> scale M^-1 (f - K u), with n nodes. scale = dt gives the velocity increment of a step, "kick", m/s.
#[derive(Debug, Clone)]
pub(super) struct Operator {
    stretches: Vec<Stretch>,
    inertia: Option<Twisted>,
    instructions: Instructions,
}

impl Operator {
    /// The map of `pencil` under the nodal forces `load` (N, length n, or empty for none).
    pub(super) fn new(pencil: &Pencil, load: &[f64], scale: f64) -> Self {
        let lumped = pencil.mass().off_diagonal.iter().all(|off| *off == 0.0);
        let inertia = (!lumped).then(|| Twisted::new(pencil.mass(), scale));
        let stretches =
            stretches(pencil, load, |i| if lumped { scale / pencil.mass().diagonal[i] } else { 1.0 });
        Self { stretches, inertia, instructions: Instructions::detect() }
    }

    /// Whether M is diagonal.
    pub(super) fn is_lumped(&self) -> bool {
        self.inertia.is_none()
    }

    /// rate = scale M^-1 (f - K u).
    pub(super) fn apply(&self, u: &[f64], rate: &mut [f64]) {
        for stretch in &self.stretches {
            let Range { start, end } = stretch.nodes;
            if stretch.is_uniform() {
                let around = &u[start - 1..end + 1];
                kernels::uniform_rate(
                    self.instructions,
                    stretch.left,
                    stretch.load,
                    around,
                    &mut rate[start..end],
                );
            } else {
                (start..end).for_each(|i| rate[i] = stretch.rate(u, i));
            }
        }
        if let Some(inertia) = &self.inertia {
            inertia.solve(rate);
        }
    }

    /// The rate of node i alone; M diagonal.
    #[inline]
    pub(super) fn rate_at(&self, u: &[f64], i: usize) -> f64 {
        let k = self.stretches.partition_point(|stretch| stretch.nodes.end <= i);
        self.stretches[k].rate(u, i)
    }

    /// v += rate, next = u + dt v in one pass; M diagonal.
    pub(super) fn kick_drift(&self, dt: f64, u: &[f64], velocity: &mut [f64], next: &mut [f64]) {
        for stretch in &self.stretches {
            let Range { start, end } = stretch.nodes;
            if stretch.is_uniform() {
                let (v, next) = (&mut velocity[start..end], &mut next[start..end]);
                let around = &u[start - 1..end + 1];
                kernels::kick_drift(self.instructions, stretch.left, stretch.load, dt, around, v, next);
            } else {
                for i in start..end {
                    velocity[i] += stretch.rate(u, i);
                    next[i] = u[i] + dt * velocity[i];
                }
            }
        }
    }

    /// v += kick, u += dt v.
    pub(super) fn drift(&self, dt: f64, kick: &[f64], velocity: &mut [f64], u: &mut [f64]) {
        kernels::drift(self.instructions, dt, kick, velocity, u);
    }
}

/// The rows of f - K u, times `factor` of their node, equal neighbours joined.
fn stretches(pencil: &Pencil, load: &[f64], factor: impl Fn(usize) -> f64) -> Vec<Stretch> {
    let (diagonal, off) = (&pencil.stiffness().diagonal, &pencil.stiffness().off_diagonal);
    let mut found: Vec<Stretch> = Vec::new();
    for i in 0..pencil.size() {
        let left = if i > 0 { -off[i - 1] } else { 0.0 };
        let right = off.get(i).map_or(0.0, |off| -off);
        let ground = diagonal[i] - left - right;
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
