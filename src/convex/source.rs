//! Where sampled vectors and proofs come from: this machine, or any other that answers.

use super::curve::Prover;
use super::factor::Verdict;
use super::lanczos::{Search, largest};
use super::operator::Operator;
use super::span::Span;
use super::start::Start;
use super::subspace::Subspace;
use super::vectors::dot;

/// What a search for the largest eigenvalue found; its vector is in the span from then on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Its Ritz value.
    pub value: f64,
    /// |A x - value M x| in the norm of M^-1.
    pub residual: f64,
}

/// What the curve asks of a pencil (K, M, P). It decides by the answers which t to ask for next, and nothing that it
/// proves depends on how well a search went: every vector is judged by its own forms, every upper bound by its proof.
pub trait Source {
    /// Unknowns.
    fn unknowns(&self) -> usize;

    /// Whether there is any contact.
    fn has_contacts(&self) -> bool;

    /// The forms of the vectors found so far.
    fn span(&self) -> &Span;

    /// Looks for the top vector of (a K + t P, M), from V y or from noise, and adds it to the span.
    fn seek(&mut self, combination: (f64, f64), start: Option<&[f64]>, search: &Search) -> Found;

    /// |A x - theta M x| in the norm of M^-1 over theta, for x = V y with x'Mx = 1 and A = K + t P.
    fn residual(&mut self, t: f64, y: &[f64]) -> f64;

    /// Whether u M - a K - t P is positive semidefinite; `margin` is the part of u that rounding may use.
    fn prove(&mut self, u: f64, combination: (f64, f64), margin: f64) -> Verdict;

    /// Whether every u above the largest eigenvalue can be proven, up to rounding.
    fn is_sharp(&self) -> bool;

    /// Whether proofs are by patches.
    fn is_patched(&self) -> bool;

    /// Products with K so far.
    fn products(&self) -> usize;
}

/// A pencil on this machine.
#[derive(Debug)]
pub struct Local {
    pub(super) operator: Operator,
    pub(super) prover: Prover,
    pub(super) subspace: Subspace,
}

impl Local {
    /// A pencil with its top vector, which is the first of the span.
    pub(super) fn new(start: Start, prover: Prover) -> Self {
        let mut subspace = Subspace::new(start.operator.pencil());
        subspace.add(&start.operator, &start.vector);
        Self { operator: start.operator, prover, subspace }
    }
}

impl Source for Local {
    fn unknowns(&self) -> usize {
        self.operator.pencil().size()
    }

    fn has_contacts(&self) -> bool {
        !self.operator.pencil().contacts().is_empty()
    }

    fn span(&self) -> &Span {
        self.subspace.span()
    }

    fn seek(&mut self, combination: (f64, f64), start: Option<&[f64]>, search: &Search) -> Found {
        let start = start.map(|y| self.subspace.vector(y));
        let found = largest(&self.operator, combination, start.as_deref(), search);
        self.subspace.add(&self.operator, &found.vector);
        Found { value: found.value, residual: found.residual }
    }

    fn residual(&mut self, t: f64, y: &[f64]) -> f64 {
        let x = self.subspace.vector(y);
        let (mut image, mut mass) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        self.operator.multiply((1.0, t), &x, &mut image);
        self.operator.pencil().multiply_mass(&x, &mut mass);
        let theta = dot(&x, &image);
        image.iter_mut().zip(&mass).for_each(|(a, m)| *a -= theta * m);
        let residual = image.clone();
        self.operator.solve_mass(&mut image);
        dot(&residual, &image).max(0.0).sqrt() / theta.abs()
    }

    fn prove(&mut self, u: f64, combination: (f64, f64), margin: f64) -> Verdict {
        self.prover.prove(u, combination, margin)
    }

    fn is_sharp(&self) -> bool {
        matches!(self.prover, Prover::Whole(_))
    }

    fn is_patched(&self) -> bool {
        matches!(self.prover, Prover::Patches(_))
    }

    fn products(&self) -> usize {
        self.operator.products()
    }
}
