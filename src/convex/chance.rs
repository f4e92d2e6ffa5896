//! Bounds that hold except with a small probability: Lanczos from a random start, where there are neither elements nor the
//! memory for a factor.
//!
//! For a semidefinite matrix of n rows and a start that is uniform on the sphere, k steps leave the largest Ritz value theta
//! with (Kuczynski, Wozniakowski, SIAM J. Matrix Anal. Appl. 13, 1992)
//!
//! ```text
//! l_max <= theta/(1 - e)   except with the probability   1.648 sqrt(n) exp(-sqrt(e) (2k - 1))
//! ```
//! M^-1/2 (K + t P) M^-1/2 is that matrix; for t < 0 it is shifted by |t| mu, mu = l_max(P, M). That K is semidefinite is taken on
//! trust, as far as no Ritz value is negative. The theorem is one of exact arithmetic; in f64 the recurrence of three
//! vectors finds copies of what has converged, and the rest later (Paige, Linear Algebra Appl. 34, 1980). The generator is
//! not random but the same in every run: the probability is over matrices that know nothing of it.

use std::cell::{Cell, RefCell};

use super::factor::Verdict;
use super::lanczos::tridiagonal_ends;
use super::operator::Operator;
use super::pencil::MeshPencil;
use super::vectors::{dot, pseudo_normal, scale};
use crate::error::Refusal;

/// The probability of one search. It enters by its logarithm: k = 670 for a million unknowns and e = 1e-3.
const PROBABILITY: f64 = 1e-15;

/// More steps are refused: a search would take longer than the factorisation for which there is no memory.
const MOST_STEPS: usize = 20_000;

/// Of the largest Ritz value: each step leaves some roundings.
const ROUNDING: f64 = MOST_STEPS as f64 * 16.0 * f64::EPSILON;

/// Searches from random starts.
#[derive(Debug)]
pub struct Chance {
    operator: Operator,
    /// e.
    share: f64,
    steps: usize,
    /// mu, once it is known.
    slope: Cell<f64>,
    found: RefCell<Vec<((f64, f64), f64)>>,
}

impl Chance {
    /// Searches for steps to the relative width `tolerance`.
    ///
    /// # Errors
    /// A mass that is not diagonal, whose root a uniform start needs; a tolerance that takes too many steps.
    pub fn new(pencil: &MeshPencil, tolerance: f64) -> Result<Self, Refusal> {
        if !pencil.mass().is_diagonal() {
            let allowed = "a diagonal mass, or memory for a factor";
            return Err(Refusal::new("evidence by chance", "a mass that is not diagonal", allowed));
        }
        // A step errs by half of what its eigenvalue does; a fifth is left to the search for the bound.
        let share = 1.6 * tolerance;
        let steps = steps(pencil.size(), share);
        if steps > MOST_STEPS {
            // The steps go with 1/sqrt(tolerance).
            let least = tolerance * (steps as f64 / MOST_STEPS as f64).powi(2);
            let value = format!("{tolerance:e}, by chance in {steps} steps");
            return Err(Refusal::new(
                "tolerance",
                value,
                format!("at least {least:e}, or memory for a factor"),
            ));
        }
        let operator = Operator::new(pencil, 0)?;
        Ok(Self { operator, share, steps, slope: Cell::new(f64::INFINITY), found: RefCell::default() })
    }

    /// Steps of each search.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// The probability that any bound so far is wrong.
    pub fn probability(&self) -> f64 {
        PROBABILITY * self.found.borrow().len().max(1) as f64
    }

    /// Whether l_max(a K + t P, M) <= u, by chance.
    pub(super) fn prove(&self, u: f64, combination: (f64, f64)) -> Verdict {
        let known = self.found.borrow().iter().find(|(at, _)| *at == combination).map(|(_, bound)| *bound);
        let bound = known.unwrap_or_else(|| {
            let bound = self.bound(combination);
            self.found.borrow_mut().push((combination, bound));
            if combination == (0.0, 1.0) {
                self.slope.set(bound);
            }
            bound
        });
        if bound <= u { Verdict::Proven } else { Verdict::Refuted }
    }

    fn bound(&self, (a, t): (f64, f64)) -> f64 {
        let shift = if t < 0.0 { -t * self.slope.get() } else { 0.0 };
        if !shift.is_finite() {
            return f64::INFINITY;
        }
        let (least, most) = self.ends((a, t), shift);
        // A Ritz value below zero by more than rounding says that the matrix is not semidefinite.
        if least < -ROUNDING * most || !most.is_finite() {
            return f64::INFINITY;
        }
        most * (1.0 + ROUNDING) / (1.0 - self.share) - shift
    }

    /// The smallest and the largest Ritz value of a K + t P + shift M after all steps.
    fn ends(&self, combination: (f64, f64), shift: f64) -> (f64, f64) {
        let root: Vec<f64> = self.operator.pencil().mass_diagonal().iter().map(|m| m.sqrt()).collect();
        let n = root.len();
        let most = self.steps.min(n);
        let (mut v, mut before) = (pseudo_normal(n, self.found.borrow().len() as u64 + 1), vec![0.0; n]);
        let length = dot(&v, &v).sqrt();
        scale(1.0 / length, &mut v);
        let (mut own, mut beside): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let (mut x, mut image) = (vec![0.0; n], vec![0.0; n]);
        loop {
            x.iter_mut().zip(&v).zip(&root).for_each(|((x, v), m)| *x = v / m);
            self.operator.multiply(combination, &x, &mut image);
            let last = beside.last().copied().unwrap_or(0.0);
            for (((y, m), v), before) in image.iter_mut().zip(&root).zip(&v).zip(&before) {
                *y = *y / m + shift * v - last * before;
            }
            let alpha = dot(&v, &image);
            image.iter_mut().zip(&v).for_each(|(y, v)| *y -= alpha * v);
            own.push(alpha);
            let beta = dot(&image, &image).sqrt();
            let size = own.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
            // Nothing is left: the start sees no more of the spectrum than this.
            if own.len() == most || beta <= f64::EPSILON * size {
                return tridiagonal_ends(&own, &beside);
            }
            beside.push(beta);
            std::mem::swap(&mut before, &mut v);
            std::mem::swap(&mut v, &mut image);
            scale(1.0 / beta, &mut v);
        }
    }
}

/// k with 1.648 sqrt(n) exp(-sqrt(e) (2k - 1)) <= p.
fn steps(n: usize, share: f64) -> usize {
    let needed = (1.648 * (n as f64).sqrt() / PROBABILITY).ln() / share.sqrt();
    (0.5 * (needed + 1.0)).ceil() as usize
}

#[cfg(test)]
mod tests {
    /// n = 1e6, e = 1e-3 and the probability 1e-12 take 560 steps; 1e-15 takes ln(1000)/(2 sqrt(e)) more.
    #[test]
    fn a_million_unknowns_take_some_hundred_steps() {
        let k = super::steps(1_000_000, 1e-3) as f64;
        assert!((k - 560.0 - 1000.0_f64.ln() / (2.0 * 1e-3_f64.sqrt())).abs() < 6.0, "{k}");
    }
}
