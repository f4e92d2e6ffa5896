//! Proofs by factorisation: a sparse Cholesky that runs to its end, and its rounding error.
//!
//! B = D (u M - a K - t P) D with D diagonal, powers of two close to m_ii^(-1/2): scaling by D is exact. Let the
//! factorisation of the stored, shifted matrix fl(B) - c I end with L. Then (Higham, Accuracy and Stability of Numerical
//! Algorithms, 2002, theorem 10.3, for any order of the sums; Rump, BIT 46, 2006, uses it the same way)
//!
//! ```text
//! L L' = fl(B) - c I + F      |F| <= g(q + 2) |L| |L'|      g(k) = k eps/(1 - k eps)
//! ```
//! with q the most entries in a row of L. So B is semidefinite when c >= |F| + |fl(B) - B| in the 2-norm, and both are
//! bounded by the largest row sum of the bounding matrix: that of |L| (|L'| 1) is computed from the factor itself, one
//! pass over its entries, and is far sharper than Rump's bound by the trace, which grows with the number of unknowns.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, simplicial::SimplicialLltRef, supernodal::SupernodalLltRef,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, Par, Side};

use super::pencil::MeshPencil;
use crate::pencil::{Gap, Matrix};

/// Fewer unknowns than this are factorised by one thread: the fork costs more than the work.
const FEW: usize = 20_000;

/// Unit roundoff of f64.
const UNIT: f64 = f64::EPSILON / 2.0;

/// g(k) = k eps/(1 - k eps): the relative error of k roundings.
pub(super) fn rounding(k: usize) -> f64 {
    let error = k as f64 * UNIT;
    error / (1.0 - error)
}

/// Where the factorisation of a pencil has its entries, analysed once for all shifts.
#[derive(Debug)]
pub struct Factorisation {
    /// The pattern of K, M and P together: the upper triangle by columns.
    starts: Vec<usize>,
    rows: Vec<usize>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
    penalty: Vec<f64>,
    /// The sums of the sizes of the terms of P, which its rounding is measured by.
    sizes: Vec<f64>,
    /// The largest row sum of them.
    penalty_size: f64,
    /// How many terms an entry of P sums at most.
    terms: usize,
    symbolic: SymbolicCholesky<usize>,
    scaling: Vec<f64>,
}

/// A gap whose entries z_i are off by no more than a unit roundoff of their sizes: (i, z_i, size).
#[derive(Debug)]
pub(super) struct Weighted {
    pub scale: f64,
    pub entries: Vec<(u32, f64, f64)>,
}

/// What a factorisation said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// u M - a K - t P is positive semidefinite: proven.
    Proven,
    /// A pivot was not positive: it is indefinite, or nearer to singular than rounding can tell.
    Refuted,
    /// The factorisation ended, but u would have to be larger by this relative amount for a proof.
    TooClose(f64),
}

/// The factorisation would need more memory than allowed, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a factorisation needs {needed} bytes; allowed: {allowed}")]
pub struct TooLarge {
    /// Bytes needed.
    pub needed: usize,
    /// Bytes allowed.
    pub allowed: usize,
}

impl Factorisation {
    /// Analyses the pencil; nothing large is allocated before the fill is known.
    ///
    /// # Errors
    /// The factor would need more than `allowed` bytes.
    pub fn new(pencil: &MeshPencil, allowed: usize) -> Result<Self, TooLarge> {
        let weighted = |contact: &Gap| Weighted {
            scale: contact.scale,
            entries: contact.column.0.iter().map(|(i, z)| (*i, *z, z.abs())).collect(),
        };
        let gaps: Vec<_> = pencil.contacts().iter().map(weighted).collect();
        Self::of((pencil.stiffness(), pencil.mass()), &gaps, allowed)
    }

    /// The same of K, M and gaps that may be off.
    pub(super) fn of(
        (stiffness, mass): (&Matrix, &Matrix),
        gaps: &[Weighted],
        allowed: usize,
    ) -> Result<Self, TooLarge> {
        let n = mass.size();
        let scaling: Vec<f64> = (0..n).map(|i| (-0.5 * mass.diagonal(i).log2()).round().exp2()).collect();
        let (columns, terms) = entries((stiffness, mass), gaps, &scaling);
        let mut this = Pattern::default();
        this.starts.push(0);
        for column in columns {
            for (row, [k, m, p, size]) in column {
                this.rows.push(row);
                this.stiffness.push(k);
                this.mass.push(m);
                this.penalty.push(p);
                this.sizes.push(size);
            }
            this.starts.push(this.rows.len());
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &this.starts, None, &this.rows);
        let too_large = |needed| TooLarge { needed, allowed };
        let parameters = CholeskySymbolicParams::default();
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Upper, SymmetricOrdering::Amd, parameters)
            .map_err(|_| too_large(usize::MAX))?;
        let needed = symbolic.len_val() * size_of::<f64>();
        if needed > allowed {
            return Err(too_large(needed));
        }
        let penalty_size = this.penalty_size();
        let Pattern { starts, rows, stiffness, mass, penalty, sizes } = this;
        Ok(Self { starts, rows, stiffness, mass, penalty, sizes, penalty_size, terms, symbolic, scaling })
    }

    /// Bytes of the factor.
    pub fn memory(&self) -> usize {
        self.symbolic.len_val() * size_of::<f64>()
    }

    /// Multiplications of a factorisation: the sum of the squares of the columns' entries.
    pub fn operations(&self) -> f64 {
        let squares = |columns: usize, below: usize| -> f64 {
            (1..=columns).map(|own| ((own + below) as f64).powi(2)).sum()
        };
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(raw) => {
                raw.col_ptr().windows(2).map(|ends| squares(1, ends[1] - ends[0] - 1)).sum()
            }
            SymbolicCholeskyRaw::Supernodal(raw) => {
                let below = raw.col_ptr_for_row_idx().windows(2).map(|ends| ends[1] - ends[0]);
                let own =
                    raw.supernode_begin().iter().zip(raw.supernode_end()).map(|(begin, end)| end - begin);
                own.zip(below).map(|(own, below)| squares(own, below)).sum()
            }
        }
    }

    /// Whether u M - a K - t P is positive semidefinite; `margin` is the part of u that rounding may use.
    pub fn prove(&self, u: f64, a: f64, t: f64, margin: f64) -> Verdict {
        self.prove_beyond(u, (a, t), margin, 0.0)
    }

    /// Whether D (u M - a K - t P) D - beyond I is positive semidefinite.
    pub(super) fn prove_beyond(&self, u: f64, at: (f64, f64), margin: f64, beyond: f64) -> Verdict {
        self.prove_with(u, at, margin, (beyond, |_| 1.0))
    }

    /// The same for t < 0 with D E for D: E takes from the diagonal of D P D what it has more than that of u D M D.
    pub(super) fn prove_scaled(&self, u: f64, (a, t): (f64, f64), margin: f64, beyond: f64) -> Verdict {
        let own = |column: usize| {
            let mut at = self.starts[column]..self.starts[column + 1];
            let share = at
                .find(|at| self.rows[*at] == column)
                .map_or(0.0, |at| -t * self.penalty[at] / (u * self.mass[at]));
            (-0.5 * (1.0 + share.max(0.0)).log2()).round().exp2()
        };
        let extra: Vec<f64> = (0..self.scaling.len()).map(own).collect();
        self.prove_with(u, (a, t), margin, (beyond, |i: usize| extra[i]))
    }

    /// A bound of what entries of t P round by, scaled.
    pub(super) fn penalty_rounding(&self, t: f64) -> f64 {
        rounding(self.terms + 16) * self.penalty_size * t.abs()
    }

    /// D.
    pub(super) fn scaling(&self) -> &[f64] {
        &self.scaling
    }

    fn prove_with(
        &self,
        u: f64,
        (a, t): (f64, f64),
        margin: f64,
        (beyond, extra): (f64, impl Fn(usize) -> f64),
    ) -> Verdict {
        let n = self.scaling.len();
        let shift = margin * u;
        let mut values: Vec<f64> = Vec::with_capacity(self.rows.len());
        let mut sums = vec![0.0; n];
        for column in 0..n {
            for at in self.starts[column]..self.starts[column + 1] {
                let row = self.rows[at];
                let e = extra(row) * extra(column);
                let (m, k, p) = (e * u * self.mass[at], e * a * self.stiffness[at], e * t * self.penalty[at]);
                let own = if row == column { shift } else { 0.0 };
                let size = m.abs() + k.abs() + e * t.abs() * self.sizes[at] + own;
                sums[column] += size;
                if row != column {
                    sums[row] += size;
                }
                values.push(if row == column { m - k - p - shift } else { m - k - p });
            }
        }
        // Each entry: the terms of P with four factors each, of which two may be off, three products, three differences.
        let stored = rounding(self.terms + 16) * largest(&sums);
        let parallel = if n < FEW { Par::Seq } else { Par::rayon(0) };
        let Some(factor) = self.factorise(&values, parallel) else { return Verdict::Refuted };
        let (product, most) = self.absolute_product(&factor);
        // The sums that bound the error are positive: doubling covers their own rounding.
        let needed = beyond + 2.0 * (rounding(most + 2) * product + stored);
        if needed <= shift { Verdict::Proven } else { Verdict::TooClose(coarse(needed / u)) }
    }

    /// The factor of the matrix with these entries, or none if a pivot is not positive.
    fn factorise(&self, values: &[f64], parallel: Par) -> Option<Vec<f64>> {
        let n = self.scaling.len();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.starts, None, &self.rows);
        let matrix = SparseColMatRef::new(pattern, values);
        let mut factor = vec![0.0; self.symbolic.len_val()];
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(parallel, Default::default());
        let mut memory = MemBuffer::try_new(scratch).ok()?;
        let stack = MemStack::new(&mut memory);
        let none = LltRegularization::default();
        self.symbolic
            .factorize_numeric_llt(
                &mut factor,
                matrix,
                Side::Upper,
                none,
                parallel,
                stack,
                Default::default(),
            )
            .ok()?;
        factor.iter().all(|l| l.is_finite()).then_some(factor)
    }

    /// The largest row sum of |L| |L'|, and the most entries in a row of L.
    fn absolute_product(&self, factor: &[f64]) -> (f64, usize) {
        let n = self.scaling.len();
        let mut inner = vec![0.0; n];
        let mut counts = vec![0_usize; n];
        visit(&self.symbolic, factor, |row, column, l| {
            inner[column] += l.abs();
            counts[row] += 1;
        });
        let mut outer = vec![0.0; n];
        visit(&self.symbolic, factor, |row, column, l| outer[row] += l.abs() * inner[column]);
        (largest(&outer), counts.into_iter().max().unwrap_or(0))
    }
}

/// `x`, positive, rounded up to 8 digits of its binary fraction: the last digits of a factor depend on the threads that made
/// it, and a bound would show them.
fn coarse(x: f64) -> f64 {
    const REST: u64 = (1 << 44) - 1;
    f64::from_bits((x.to_bits() + REST) & !REST)
}

/// A factor of M alone, to apply M^-1 to vectors.
#[derive(Debug)]
pub(super) struct MassFactor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl MassFactor {
    /// The factor of M; none if M is not positive definite or the factor needs more than `allowed` bytes.
    pub(super) fn new(pencil: &MeshPencil, allowed: usize) -> Option<Self> {
        let mut all = Factorisation::new(pencil, allowed).ok()?;
        let values: Vec<f64> = (0..pencil.size())
            .flat_map(|column| (all.starts[column]..all.starts[column + 1]).map(move |at| (column, at)))
            .map(|(column, at)| all.mass[at] / (all.scaling[column] * all.scaling[all.rows[at]]))
            .collect();
        all.scaling.iter_mut().for_each(|s| *s = 1.0);
        // On one thread: vectors, and numbers from them, would differ with the threads.
        let factor = all.factorise(&values, Par::Seq)?;
        Some(Self { symbolic: all.symbolic, values: factor })
    }

    /// x = M^-1 x.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let factor = LltRef::<'_, usize, f64>::new(&self.symbolic, &self.values);
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let mut column = Mat::from_fn(x.len(), 1, |i, _| x[i]);
        factor.solve_in_place_with_conj(Conj::No, column.as_mut(), Par::Seq, MemStack::new(&mut memory));
        x.iter_mut().enumerate().for_each(|(i, x)| *x = column[(i, 0)]);
    }
}

#[derive(Default)]
struct Pattern {
    starts: Vec<usize>,
    rows: Vec<usize>,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
    penalty: Vec<f64>,
    sizes: Vec<f64>,
}

impl Pattern {
    /// The largest row sum of the sizes of P.
    fn penalty_size(&self) -> f64 {
        let n = self.starts.len() - 1;
        let mut sums = vec![0.0; n];
        for column in 0..n {
            for at in self.starts[column]..self.starts[column + 1] {
                sums[column] += self.sizes[at];
                if self.rows[at] != column {
                    sums[self.rows[at]] += self.sizes[at];
                }
            }
        }
        largest(&sums)
    }
}

/// The upper triangle by columns, scaled: (row, [k, m, p, size of p]), and the most terms that an entry of P sums.
fn entries<'a>(
    (stiffness, mass): (&'a Matrix, &'a Matrix),
    gaps: &'a [Weighted],
    scaling: &'a [f64],
) -> (impl Iterator<Item = Vec<(usize, [f64; 4])>> + 'a, usize) {
    let n = mass.size();
    let mut touching: Vec<Vec<(u32, f64, f64)>> = vec![Vec::new(); n];
    for (j, gap) in gaps.iter().enumerate() {
        gap.entries.iter().for_each(|(i, z, size)| touching[*i as usize].push((j as u32, *z, *size)));
    }
    let terms = touching.iter().map(Vec::len).max().unwrap_or(0);
    let columns = (0..n).map(move |column| {
        let mut found: Vec<(usize, [f64; 4])> = Vec::new();
        found.extend(stiffness.row(column).map(|(row, k)| (row, [k, 0.0, 0.0, 0.0])));
        found.extend(mass.row(column).map(|(row, m)| (row, [0.0, m, 0.0, 0.0])));
        for (j, z, size) in &touching[column] {
            let gap = &gaps[*j as usize];
            found.extend(gap.entries.iter().map(|(row, y, other)| {
                (*row as usize, [0.0, 0.0, gap.scale * z * y, gap.scale * size * other])
            }));
        }
        found.retain(|(row, _)| *row <= column);
        found.sort_by_key(|(row, _)| *row);
        found.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1.iter_mut().zip(next.1).for_each(|(kept, next)| *kept += next);
            }
            same
        });
        found
            .iter_mut()
            .for_each(|(row, v)| v.iter_mut().for_each(|v| *v *= scaling[column] * scaling[*row]));
        found
    });
    (columns, terms)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// Visits every stored entry of L by columns: (row, column, value).
fn visit(symbolic: &SymbolicCholesky<usize>, values: &[f64], mut entry: impl FnMut(usize, usize, f64)) {
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(raw) => {
            let l = SimplicialLltRef::new(raw, values);
            let (starts, rows) = (raw.col_ptr(), raw.row_idx());
            for column in 0..raw.nrows() {
                (starts[column]..starts[column + 1]).for_each(|at| entry(rows[at], column, l.values()[at]));
            }
        }
        SymbolicCholeskyRaw::Supernodal(raw) => {
            let l = SupernodalLltRef::new(raw, values);
            for s in 0..raw.n_supernodes() {
                let (node, start) = (l.supernode(s), l.supernode(s).start());
                let (block, pattern) = (node.val(), node.pattern());
                for j in 0..block.ncols() {
                    (j..block.ncols()).for_each(|i| entry(start + i, start + j, block[(i, j)]));
                    pattern
                        .iter()
                        .enumerate()
                        .for_each(|(i, row)| entry(*row, start + j, block[(block.ncols() + i, j)]));
                }
            }
        }
    }
}
