//! Reactions that push and never pull: the linear complementarity problem of a step.
//!
//! ```text
//! 0 <= lambda   perpendicular to   (a G + E) lambda - b >= 0      G = Z'M^-1 Z      E diagonal, not negative
//! ```
//! G is positive semidefinite. Where no two contacts act on each other the solution is max(0, b/(a g + e)), contact by contact.
//! Else the active set of the last step is tried first and then changed by block principal pivoting, with Murty's rule of
//! the last index where blocks do not converge (Judice, Pires, Comput. Oper. Res. 21, 1994): finite for a positive
//! definite matrix, one Cholesky factorisation for each change.

use faer::Mat;

use crate::symmetric::Cholesky;

use super::Contacts;

/// Blocks are changed as long as one of so many tries leaves fewer contacts that are wrong.
const PATIENCE: u32 = 4;

/// Solves the problem for one right side after another.
#[derive(Debug, Clone)]
pub(super) struct Complementarity {
    /// a G_jj + E_jj.
    diagonal: Vec<f64>,
    /// a G + E unless it is diagonal.
    coupled: Option<Coupled>,
}

#[derive(Debug, Clone)]
struct Coupled {
    matrix: Mat<f64>,
    active: Vec<bool>,
    /// The contacts of the factor.
    factored: Vec<usize>,
    factor: Option<Cholesky>,
}

impl Complementarity {
    /// For `contacts` with a = `share` and E = `own`.
    pub fn new(contacts: &Contacts, share: f64, own: &[f64]) -> Self {
        let k = contacts.len();
        let diagonal: Vec<f64> = (0..k).map(|j| share * contacts.compliance(j) + own[j]).collect();
        let apart = share == 0.0 || contacts.act_apart();
        let entry =
            |i: usize, j: usize| if i == j { diagonal[i] } else { share * contacts.compliance_between(i, j) };
        let coupled = (!apart).then(|| Coupled::new(Mat::from_fn(k, k, entry)));
        Self { diagonal, coupled }
    }

    /// For a symmetric positive definite matrix in place of a G + E; `None` if it is not definite.
    pub fn of(matrix: Mat<f64>) -> Option<Self> {
        let k = matrix.nrows();
        let diagonal: Vec<f64> = (0..k).map(|j| matrix[(j, j)]).collect();
        if (0..k).all(|i| (0..i).all(|j| matrix[(i, j)] == 0.0)) {
            return diagonal.iter().all(|entry| *entry > 0.0).then_some(Self { diagonal, coupled: None });
        }
        let scale: Vec<f64> = diagonal.iter().map(|entry| entry.sqrt()).collect();
        let rounding = 4.0 * f64::EPSILON * k as f64;
        let entry = |i: usize, j: usize| match i == j {
            true => 1.0 - rounding,
            false => matrix[(i, j)] / (scale[i] * scale[j]),
        };
        Cholesky::new(Mat::from_fn(k, k, entry))?;
        Some(Self { diagonal, coupled: Some(Coupled::new(matrix)) })
    }

    /// lambda, N, for b = `demand`; 0 for contacts that do not `count`.
    pub fn push(&mut self, demand: &[f64], count: &[bool], lambda: &mut [f64]) {
        match &mut self.coupled {
            Some(coupled) => coupled.push(demand, count, lambda),
            None => self.each(demand, |j| count[j] && demand[j] > 0.0, lambda),
        }
    }

    /// (a G + E) lambda = b for the contacts that `count`, in tension too.
    pub fn hold(&mut self, demand: &[f64], count: &[bool], lambda: &mut [f64]) {
        match &mut self.coupled {
            Some(coupled) => {
                coupled.active.copy_from_slice(count);
                coupled.solve(demand, lambda);
            }
            None => self.each(demand, |j| count[j], lambda),
        }
    }

    fn each(&self, demand: &[f64], acts: impl Fn(usize) -> bool, lambda: &mut [f64]) {
        for (j, lambda) in lambda.iter_mut().enumerate() {
            *lambda = if acts(j) { demand[j] / self.diagonal[j] } else { 0.0 };
        }
    }
}

impl Coupled {
    fn new(matrix: Mat<f64>) -> Self {
        let active = vec![false; matrix.nrows()];
        Self { matrix, active, factored: Vec::new(), factor: None }
    }

    fn push(&mut self, demand: &[f64], count: &[bool], lambda: &mut [f64]) {
        self.active.iter_mut().zip(count).for_each(|(active, count)| *active &= count);
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        // Murty's rule alone ends within 2^k changes, in practice a few k; a motion that is no number any more never
        // does.
        for _ in 0..100 + 10 * demand.len() {
            self.solve(demand, lambda);
            let wrong: Vec<usize> =
                (0..demand.len()).filter(|j| count[*j] && self.is_wrong(*j, demand, lambda)).collect();
            let Some(last) = wrong.last() else { return };
            if wrong.len() < fewest {
                (fewest, patience) = (wrong.len(), PATIENCE);
            } else {
                patience = patience.saturating_sub(1);
            }
            let changed = if patience > 0 { &wrong[..] } else { std::slice::from_ref(last) };
            changed.iter().for_each(|j| self.active[*j] = !self.active[*j]);
        }
        lambda.iter_mut().for_each(|lambda| *lambda = lambda.max(0.0));
    }

    /// Whether an active contact pulls, or another one moves into the other side by more than rounding: each of the k
    /// products of a sum and each of the k eliminations of a row round once.
    fn is_wrong(&self, j: usize, demand: &[f64], lambda: &[f64]) -> bool {
        if self.active[j] {
            return lambda[j] < 0.0;
        }
        let (mut relief, mut size) = (0.0, demand[j].abs());
        for (i, lambda) in lambda.iter().enumerate() {
            let part = self.matrix[(j, i)] * lambda;
            relief += part;
            size += part.abs();
        }
        demand[j] - relief > 2.0 * f64::EPSILON * lambda.len() as f64 * size
    }

    /// lambda of the active contacts from their rows alone, 0 for the others.
    fn solve(&mut self, demand: &[f64], lambda: &mut [f64]) {
        let Self { matrix, active, factored, factor } = self;
        let now = || (0..active.len()).filter(|j| active[*j]);
        if factor.is_none() || !now().eq(factored.iter().copied()) {
            *factored = now().collect();
            let of = Mat::from_fn(factored.len(), factored.len(), |i, j| matrix[(factored[i], factored[j])]);
            *factor = Cholesky::new(of);
        }
        let mut x: Vec<f64> = factored.iter().map(|j| demand[*j]).collect();
        match factor {
            Some(factor) => factor.solve(&mut x),
            None => x.fill(f64::NAN),
        }
        lambda.fill(0.0);
        factored.iter().zip(x).for_each(|(j, x)| lambda[*j] = x);
    }
}
