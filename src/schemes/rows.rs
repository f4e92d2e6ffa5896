//! The forces of a sparse stiffness, the matrix once through memory.
//!
//! The unknowns of a node have the same columns, and these come node by node: blocks of d x d entries, of which one index,
//! kept here, and d displacements are read. That is 9 instead of 12 bytes an entry in the plane and 8.4 in space, for 1 and
//! 0.4 bytes of memory more. Sums run over each direction by itself, in the same order wherever a row is asked for.

use std::ops::Range;

use crate::pencil::{Matrix, Pencil};
use crate::sparse::Csr;

/// Rows that one task takes; fixed, so that no result depends on the number of threads.
pub(super) const ROWS: usize = 4096;

/// Rows whose forces are held at once, in whole blocks of two and of three.
const BATCH: usize = 252;

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

    /// The blocks of the node of D directions whose first row is i.
    #[inline]
    fn of_node<const D: usize>(&self, starts: &[usize], i: usize) -> &[u32] {
        let first = (starts[i] - starts[self.rows.start]) / (D * D);
        &self.blocks[first..first + (starts[i + 1] - starts[i]) / D]
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
        Self { pencil: pencil.clone(), factor, load, runs }
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
        let (columns, values) = k.row(i);
        let pull = match run.directions {
            2 => pair(run.of_node::<2>(k.parts().0, node), [values; 2], u)[0],
            3 => triple(run.of_node::<3>(k.parts().0, node), [values; 3], u)[0],
            _ => single(columns, values, u),
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
        let (starts, columns, values) = k.parts();
        let values = |i: usize| &values[starts[i]..starts[i + 1]];
        match run.directions {
            2 => pulls.as_chunks_mut::<2>().0.iter_mut().zip(rows.step_by(2)).for_each(|(to, i)| {
                *to = pair(run.of_node::<2>(starts, i), [values(i), values(i + 1)], u);
            }),
            3 => pulls.as_chunks_mut::<3>().0.iter_mut().zip(rows.step_by(3)).for_each(|(to, i)| {
                *to = triple(run.of_node::<3>(starts, i), [values(i), values(i + 1), values(i + 2)], u);
            }),
            _ => pulls.iter_mut().zip(rows).for_each(|(to, i)| {
                *to = single(&columns[starts[i]..starts[i + 1]], values(i), u);
            }),
        }
    }
}

#[inline]
fn single(columns: &[u32], values: &[f64], u: &[f64]) -> f64 {
    columns.iter().zip(values).map(|(j, k)| k * u[*j as usize]).sum()
}

/// Two rows of a node times u; the columns come in pairs.
#[inline]
fn pair(blocks: &[u32], rows: [&[f64]; 2], u: &[f64]) -> [f64; 2] {
    let [a, b] = rows.map(|row| row.as_chunks::<2>().0);
    let (mut x, mut y) = ([0.0; 2], [0.0; 2]);
    for ((block, a), b) in blocks.iter().zip(a).zip(b) {
        let u = &u[*block as usize..][..2];
        x = [x[0] + a[0] * u[0], x[1] + a[1] * u[1]];
        y = [y[0] + b[0] * u[0], y[1] + b[1] * u[1]];
    }
    [x[0] + x[1], y[0] + y[1]]
}

/// Three rows of a node times u; the columns come in threes.
#[inline]
fn triple(blocks: &[u32], rows: [&[f64]; 3], u: &[f64]) -> [f64; 3] {
    let [a, b, c] = rows.map(|row| row.as_chunks::<3>().0);
    let mut sums = [[0.0; 3]; 3];
    for (((block, a), b), c) in blocks.iter().zip(a).zip(b).zip(c) {
        let u = &u[*block as usize..][..3];
        for (sum, row) in sums.iter_mut().zip([a, b, c]) {
            *sum = [sum[0] + row[0] * u[0], sum[1] + row[1] * u[1], sum[2] + row[2] * u[2]];
        }
    }
    sums.map(|sum| sum[0] + sum[1] + sum[2])
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
