//! The unilateral contact of what has no mass, or is at rest: of the unknowns of a pencil or of some of them,
//!
//! ```text
//! 0 = r - K_cc x - Z_c lambda      0 <= lambda   perpendicular to   Z_c'x + g <= 0
//! x = K_cc^-1 (r - Z_c lambda)     W lambda - (Z_c'K_cc^-1 r + g) >= 0     W = Z_c'K_cc^-1 Z_c
//! ```
//! K_cc is constant: one sparse Cholesky factorisation and one solve a contact in advance, two solves and the complementarity
//! problem for every r. W is k x k and dense.

use faer::Mat;
use faer::sparse::Triplet;
use rayon::prelude::*;

use super::ContactRule;
use super::complementarity::Complementarity;
use crate::error::Refusal;
use crate::memory;
use crate::pencil::{Matrix, Pencil};
use crate::sparse::SparseVector;
use crate::symmetric::SparseCholesky;

/// K_cc^-1 and the contacts on it.
#[derive(Debug, Clone)]
pub(super) struct Flexible {
    factor: SparseCholesky,
    /// z of each contact on the unknowns c.
    columns: Vec<SparseVector>,
    /// A rigid motion that K does not resist.
    carried: Option<Carried>,
    problem: Complementarity,
    demand: Vec<f64>,
    all: Vec<bool>,
    load: Vec<f64>,
}

/// t with K t = 0, and p with t'p = 1: the load -p(t'r) balances r, and p'x = 0.
#[derive(Debug, Clone)]
pub(super) struct Carried {
    pub motion: Vec<f64>,
    pub balance: Vec<f64>,
}

impl Flexible {
    /// Of the ascending `unknowns`, which are all that the gaps of `pencil` have entries at.
    pub fn new(pencil: &Pencil, unknowns: &[u32], carried: Option<Carried>) -> Result<Self, Refusal> {
        let k = pencil.gaps().len();
        let contacts = ("contacts", &*k.to_string());
        // W, its factor, and that of the proof that it is definite.
        memory::require(contacts, "flexibilities", 24 * (k as u64).pow(2), |available| {
            format!("at most {} contacts", (available / 24).isqrt())
        })?;
        let local = |i: u32| unknowns.binary_search(&i).ok().map(|at| at as u32);
        let place = |(i, z): &(u32, f64)| local(*i).map(|i| (i, *z));
        let columns =
            pencil.gaps().iter().map(|gap| SparseVector(gap.column.0.iter().filter_map(place).collect()));
        let columns: Vec<SparseVector> = columns.collect();
        let factor = factor(pencil.stiffness(), unknowns, carried.as_ref())?;
        let n = unknowns.len();
        let of = |column: &SparseVector| {
            let mut x = vec![0.0; n];
            column.add_to(1.0, &mut x);
            apply(&factor, carried.as_ref(), &mut x);
            columns.iter().map(|column| column.dot(&x)).collect::<Vec<f64>>()
        };
        let w: Vec<Vec<f64>> = columns.par_iter().map(of).collect();
        // The solves round W apart from its transpose.
        let problem = Complementarity::of(Mat::from_fn(k, k, |i, j| 0.5 * (w[i][j] + w[j][i])));
        let problem = problem.ok_or_else(|| {
            let allowed = "contacts whose reactions move their gaps, each in its own way";
            Refusal::new("contacts", format!("{k} that depend on each other"), allowed)
        })?;
        let (demand, all, load) = (vec![0.0; k], vec![true; k], vec![0.0; n]);
        Ok(Self { factor, columns, carried, problem, demand, all, load })
    }

    /// x <- K_cc^-1 x.
    pub fn apply(&self, x: &mut [f64]) {
        apply(&self.factor, self.carried.as_ref(), x);
    }

    /// From x = K_cc^-1 r and the gaps that belong to it, the reactions and what they leave of x.
    pub fn react(&mut self, rule: ContactRule, gap: &[f64], force: &mut [f64], x: &mut [f64]) {
        self.demand.copy_from_slice(gap);
        match rule {
            ContactRule::Unilateral => self.problem.push(&self.demand, &self.all, force),
            ContactRule::HeldClosed => self.problem.hold(&self.demand, &self.all, force),
            ContactRule::HeldOpen => force.fill(0.0),
        }
        if force.iter().all(|force| *force == 0.0) {
            return;
        }
        self.load.fill(0.0);
        self.columns.iter().zip(&*force).for_each(|(column, force)| column.add_to(*force, &mut self.load));
        apply(&self.factor, self.carried.as_ref(), &mut self.load);
        x.iter_mut().zip(&self.load).for_each(|(x, pressed)| *x -= pressed);
    }

    /// z_j'x.
    pub fn across(&self, j: usize, x: &[f64]) -> f64 {
        self.columns[j].dot(x)
    }
}

fn apply(factor: &SparseCholesky, carried: Option<&Carried>, x: &mut [f64]) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let take = |from: &[f64], share: f64, x: &mut [f64]| {
        x.iter_mut().zip(from).for_each(|(x, entry)| *x -= share * entry);
    };
    if let Some(Carried { motion, balance }) = carried {
        take(balance, dot(motion, x), x);
    }
    factor.solve(x);
    if let Some(Carried { motion, balance }) = carried {
        take(motion, dot(balance, x), x);
    }
}

/// The Cholesky factor of K_cc. Where a rigid motion is carried, one of its unknowns is tied to the ground: the tie takes no
/// force, since all others are in balance.
fn factor(k: &Matrix, unknowns: &[u32], carried: Option<&Carried>) -> Result<SparseCholesky, Refusal> {
    let n = unknowns.len();
    let lower = |at: usize| {
        let row = k
            .row(unknowns[at] as usize)
            .filter_map(|(j, k)| Some((unknowns.binary_search(&(j as u32)).ok()?, k)));
        row.filter(move |(j, _)| *j <= at).map(move |(j, k)| Triplet::new(at, j, k))
    };
    let mut triplets: Vec<_> = (0..n).flat_map(lower).collect();
    if let Some(Carried { motion, .. }) = carried {
        let largest = (0..n).max_by(|a, b| motion[*a].abs().total_cmp(&motion[*b].abs())).unwrap_or(0);
        triplets.push(Triplet::new(largest, largest, k.diagonal(unknowns[largest] as usize)));
    }
    let refused = |why: String| {
        Refusal::new(
            "stiffness",
            why,
            "one that resists every motion of the unknowns without mass or at rest",
        )
    };
    let factor = SparseCholesky::new(n, &triplets);
    let factor = factor.map_err(|_| refused("a motion that it does not resist".to_owned()))?;
    let resisted = resistance(&factor, |at| k.diagonal(unknowns[at] as usize), n);
    // Each pivot is a difference of as many products as its row has entries: n of them at most.
    match resisted > 4.0 * f64::EPSILON * n as f64 || n == 0 {
        true => Ok(factor),
        false => Err(refused(format!("a motion that it resists by {resisted:e} of its diagonal alone"))),
    }
}

/// x'K x/x'D x, D the diagonal, for x = K^-1 D^1/2 e of signs e: small if K is nearly singular, as then nearly all of x lies
/// there.
fn resistance(factor: &SparseCholesky, diagonal: impl Fn(usize) -> f64, n: usize) -> f64 {
    let mut seed = 1_u64;
    let mut sign = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if seed >> 63 == 0 { 1.0 } else { -1.0 }
    };
    let load: Vec<f64> = (0..n).map(|i| sign() * diagonal(i).sqrt()).collect();
    let mut x = load.clone();
    factor.solve(&mut x);
    let work: f64 = x.iter().zip(&load).map(|(x, load)| x * load).sum();
    work / x.iter().enumerate().map(|(i, x)| diagonal(i) * x * x).sum::<f64>()
}
