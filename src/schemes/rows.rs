//! The forces of a sparse stiffness, the matrix once through memory.
//!
//! The unknowns of a node have the same columns, and these come node by node: blocks of d x d entries, of which one index,
//! kept here, and d displacements are read. That is 9 instead of 12 bytes an entry in the plane and 8.4 in space, for 1 and
//! 0.4 bytes of memory more. Sums run over each direction by itself, in the same order wherever a row is asked for.

use std::ops::Range;

use super::kernels::Instructions;
use super::nodes::{self, Nodes};
use crate::pencil::{Matrix, Pencil};
use crate::sparse::Csr;

/// Rows that one task takes; fixed, so that no result depends on the number of threads.
pub(super) const ROWS: usize = 4096;

/// Rows whose forces are held at once, in whole blocks of two and of three: few, so that the vectors are read in between.
const BATCH: usize = 30;

/// Consecutive rows of nodes with so many directions, or of one where no blocks are.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Run {
    rows: Range<usize>,
    directions: usize,
    /// The first column of each block of these nodes, one after the other; empty without blocks.
    blocks: Vec<u32>,
}

impl Run {
    fn new(k: &Csr, rows: Range<usize>, directions: usize) -> Self {
        let nodes = if directions > 1 { rows.clone() } else { 0..0 };
        let firsts = |i: usize| k.row(i).0.iter().copied().step_by(directions);
        let blocks = nodes.step_by(directions).flat_map(firsts).collect();
        Self { rows, directions, blocks }
    }

    /// Some of these rows, those of whole nodes of D directions.
    #[inline]
    fn nodes<'a, const D: usize>(&'a self, k: &'a Csr, rows: Range<usize>) -> Nodes<'a> {
        let (starts, _, values) = k.parts();
        let (first, here) = (starts[self.rows.start], starts[rows.start]..starts[rows.end]);
        let blocks = (here.start - first) / (D * D)..(here.end - first) / (D * D);
        Nodes { blocks: &self.blocks[blocks], starts: &starts[rows.start..=rows.end], values: &values[here] }
    }
}

/// Rows of a stiffness with a factor each; the load is empty for none.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    pencil: Pencil,
    factor: Vec<f64>,
    load: Vec<f64>,
    /// The runs of every task.
    runs: Vec<Vec<Run>>,
    instructions: Instructions,
}

impl Rows {
    pub fn new(pencil: &Pencil, factor: Vec<f64>, load: Vec<f64>) -> Self {
        let n = pencil.size();
        let runs = |first: usize| {
            let rows = first..(first + ROWS).min(n);
            match pencil.stiffness() {
                Matrix::Sparse(k) => runs(k, rows),
                Matrix::Chain(_) | Matrix::Diagonal(_) => {
                    vec![Run { rows, directions: 1, blocks: Vec::new() }]
                }
            }
        };
        let runs = (0..n).step_by(ROWS).map(runs).collect();
        Self { pencil: pencil.clone(), factor, load, runs, instructions: Instructions::detect() }
    }

    /// The row of unknown i, as [`Self::each`] has it.
    pub fn at(&self, u: &[f64], i: usize) -> f64 {
        let k = match self.pencil.stiffness() {
            Matrix::Sparse(k) => k,
            other => return self.scaled(i, other.row(i).map(|(j, k)| k * u[j]).sum()),
        };
        let runs = &self.runs[i / ROWS];
        let run = &runs[runs.partition_point(|run| run.rows.end <= i)];
        let node = i - (i - run.rows.start) % run.directions;
        let values = k.row(i).1;
        let pull = match run.directions {
            2 => nodes::pair(run.nodes::<2>(k, node..node + 2).blocks, [values; 2], u)[0],
            3 => nodes::triple(run.nodes::<3>(k, node..node + 3).blocks, [values; 3], u)[0],
            _ => single(k.row(i), u),
        };
        self.scaled(i, pull)
    }

    /// The factor times load minus pull.
    fn scaled(&self, i: usize, pull: f64) -> f64 {
        self.factor[i] * (self.load.get(i).copied().unwrap_or(0.0) - pull)
    }

    /// Hands the rows of one task to `take`, some at a time, with the number of the first of them in the task.
    #[inline]
    pub fn each(&self, u: &[f64], task: usize, mut take: impl FnMut(usize, &[f64])) {
        let mut forces = [0.0; BATCH];
        for run in &self.runs[task] {
            for first in run.rows.clone().step_by(BATCH) {
                let rows = first..(first + BATCH).min(run.rows.end);
                let forces = &mut forces[..rows.len()];
                self.pulls(u, run, rows.clone(), forces);
                let factor = &self.factor[rows.clone()];
                if self.load.is_empty() {
                    forces
                        .iter_mut()
                        .zip(factor)
                        .for_each(|(force, factor)| *force = factor * (0.0 - *force));
                } else {
                    let load = &self.load[rows];
                    let loaded = forces.iter_mut().zip(factor).zip(load);
                    loaded.for_each(|((force, factor), load)| *force = factor * (load - *force));
                }
                take(first - task * ROWS, forces);
            }
        }
    }

    /// K u of some rows of a run.
    fn pulls(&self, u: &[f64], run: &Run, rows: Range<usize>, pulls: &mut [f64]) {
        let k = match self.pencil.stiffness() {
            Matrix::Sparse(k) => k,
            other => {
                let pull = |i: usize| other.row(i).map(|(j, k)| k * u[j]).sum();
                pulls.iter_mut().zip(rows).for_each(|(to, i)| *to = pull(i));
                return;
            }
        };
        match run.directions {
            2 => nodes::pairs(self.instructions, run.nodes::<2>(k, rows), u, pulls),
            3 => nodes::triples(run.nodes::<3>(k, rows), u, pulls),
            _ => pulls.iter_mut().zip(rows).for_each(|(to, i)| *to = single(k.row(i), u)),
        }
    }
}

#[inline]
fn single((columns, values): (&[u32], &[f64]), u: &[f64]) -> f64 {
    columns.iter().zip(values).map(|(j, k)| k * u[*j as usize]).sum()
}

/// The runs of some rows: blocks of three rows if there are such, else of two.
fn runs(k: &Csr, rows: Range<usize>) -> Vec<Run> {
    let (mut runs, mut i) = (Vec::<(Range<usize>, usize)>::new(), rows.start);
    while i < rows.end {
        let fits = |directions: &usize| i + directions <= rows.end && is_block(k, i, *directions);
        let directions = [3, 2].into_iter().find(fits).unwrap_or(1);
        match runs.last_mut() {
            Some((last, of)) if *of == directions => last.end += directions,
            _ => runs.push((i..i + directions, directions)),
        }
        i += directions;
    }
    runs.into_iter().map(|(rows, directions)| Run::new(k, rows, directions)).collect()
}

/// Whether rows i, i + 1, ... of d directions have the same columns, which come as d consecutive numbers each.
fn is_block(k: &Csr, i: usize, directions: usize) -> bool {
    let columns = k.row(i).0;
    let consecutive = |block: &[u32]| (1..directions).all(|at| block[at] == block[0] + at as u32);
    columns.len().is_multiple_of(directions)
        && (1..directions).all(|at| k.row(i + at).0 == columns)
        && columns.chunks_exact(directions).all(consecutive)
}
