//! The contacts of a step: their columns M^-1 z, and the reactions of those that are closed.
//!
//! With g = Z'u + g0 (positive in penetration), mu = Z'M^-1 Z and the closed contacts' s and m (diagonal), the momentum
//! balance M a = f - K u - Z lambda with (M + Z m Z') a = f - K u - Z s g gives
//!
//! ```text
//! (I + m mu) lambda = s g + m p        (I + mu m) Z'a = p - mu s g        p = Z'M^-1 (f - K u)
//! ```
//! The textbook form lambda = s g + m Z'a subtracts numbers of size beta_s, and so does Z'a = p - mu lambda. Contacts couple through the bar between them unless M is diagonal: mu is then tridiagonal.

use super::twisted::Twisted;
use crate::error::Refusal;
use crate::pencil::{Gap, Penalty, Pencil};

/// One contact as a scheme sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The nodes it acts on.
    pub gap: Gap,
    /// +1 or -1: the displacement towards the wall that closes a wall contact; not used for a pair, whose gap is
    /// u_left - u_right + g0.
    pub direction: f64,
    /// s and m. The diagonalised mass penalty is not a rank-one term and is refused.
    pub penalty: Penalty,
    /// g0, m: minus the initial distance.
    pub initial_gap: f64,
}

impl Contact {
    /// The nodes with their entry of z, the second only for a pair.
    pub(super) fn column(&self) -> [Option<(usize, f64)>; 2] {
        match self.gap {
            Gap::Wall { node } => [Some((node, self.direction)), None],
            Gap::Pair { left } => [Some((left, 1.0)), Some((left + 1, -1.0))],
        }
    }

    /// z'x.
    #[inline]
    pub(super) fn across(&self, x: &[f64]) -> f64 {
        match self.gap {
            Gap::Wall { node } => self.direction * x[node],
            Gap::Pair { left } => x[left] - x[left + 1],
        }
    }

    /// Moves x so that z'x = `value`, the mean of a pair unchanged.
    #[inline]
    pub(super) fn set_across(&self, value: f64, x: &mut [f64]) {
        match self.gap {
            Gap::Wall { node } => x[node] = self.direction * value,
            Gap::Pair { left } => {
                let mean = 0.5 * (x[left] + x[left + 1]);
                x[left] = mean + 0.5 * value;
                x[left + 1] = mean - 0.5 * value;
            }
        }
    }
}

/// Entries of a column M^-1 z below this part of its largest are left out: the square of the unit roundoff.
const NEGLIGIBLE: f64 = f64::EPSILON * f64::EPSILON / 4.0;

/// M^-1 z, zeros and negligible entries at its ends left out.
#[derive(Debug, Clone)]
struct Column {
    start: usize,
    entries: Vec<f64>,
}

/// The contacts of a system with what their reactions need; k contacts.
#[derive(Debug, Clone)]
pub(super) struct Contacts {
    pub(super) list: Vec<Contact>,
    columns: Vec<Column>,
    /// mu_jj and mu_{j,j+1}, 1/kg.
    compliance: Vec<f64>,
    coupling: Vec<f64>,
    scratch: Scratch,
}

#[derive(Debug, Clone)]
struct Scratch {
    right_side: Vec<f64>,
    upper: Vec<f64>,
}

impl Contacts {
    pub(super) fn new(pencil: &Pencil, list: Vec<Contact>) -> Result<Self, Refusal> {
        let k = list.len();
        if let Some(contact) = list.iter().find(|contact| contact.penalty.nodal_mass != 0.0) {
            let value = format!("the diagonalised form ({} kg on each node)", contact.penalty.nodal_mass);
            return Err(Refusal::new("mass penalty", value, "the consistent form m z z'"));
        }
        let inertia = Twisted::new(pencil.mass(), 1.0);
        let full = |contact: &Contact| {
            let mut x = vec![0.0; pencil.size()];
            contact.column().into_iter().flatten().for_each(|(node, z)| x[node] = z);
            inertia.solve(&mut x);
            x
        };
        let mut compliance = Vec::with_capacity(k);
        let mut coupling = Vec::with_capacity(k);
        let mut columns = Vec::with_capacity(k);
        for (j, contact) in list.iter().enumerate() {
            let x = full(contact);
            compliance.push(contact.across(&x));
            coupling.push(list.get(j + 1).map_or(0.0, |next| next.across(&x)));
            columns.push(trimmed(&x));
        }
        let scratch = Scratch { right_side: vec![0.0; k], upper: vec![0.0; k] };
        Ok(Self { list, columns, compliance, coupling, scratch })
    }

    /// mu_jj, 1/kg.
    pub(super) fn compliance(&self, j: usize) -> f64 {
        self.compliance[j]
    }

    /// (mu x)_j.
    #[inline]
    pub(super) fn mu_times(&self, j: usize, x: &[f64]) -> f64 {
        let left = if j > 0 { self.coupling[j - 1] * x[j - 1] } else { 0.0 };
        let right = x.get(j + 1).map_or(0.0, |right| self.coupling[j] * right);
        left + self.compliance[j] * x[j] + right
    }

    /// The entry of M^-1 z_j at `node`, which the contact acts on.
    #[inline]
    pub(super) fn entry(&self, j: usize, node: usize) -> f64 {
        self.columns[j].entries[node - self.columns[j].start]
    }

    /// rate += factor M^-1 Z x.
    pub(super) fn add_columns(&self, factor: f64, x: &[f64], rate: &mut [f64]) {
        for (column, x) in self.columns.iter().zip(x).filter(|(_, x)| **x != 0.0) {
            let weight = factor * x;
            let touched = &mut rate[column.start..column.start + column.entries.len()];
            touched.iter_mut().zip(&column.entries).for_each(|(rate, entry)| *rate += weight * entry);
        }
    }

    /// lambda of the closed contacts, 0 for the others: (I + m mu) lambda = s g + m p, N.
    /// `p` is `None` where the scheme applies s g alone.
    pub(super) fn reactions(&mut self, closed: &[bool], gap: &[f64], p: Option<&[f64]>, lambda: &mut [f64]) {
        for (j, contact) in self.list.iter().enumerate() {
            let inertial = p.map_or(0.0, |p| contact.penalty.mass * p[j]);
            let force = contact.penalty.stiffness * gap[j] + inertial;
            self.scratch.right_side[j] = if closed[j] { force } else { 0.0 };
        }
        let row = |this: &Self, j: usize, i: usize| {
            if closed[j] && closed[i] { this.list[j].penalty.mass * this.mu(j, i) } else { 0.0 }
        };
        self.solve(row, lambda);
    }

    /// x <- (I + mu m)^-1 (x + mu y), where m and y belong to the closed contacts; y is 0 for the others.
    pub(super) fn relax(&mut self, closed: &[bool], y: &[f64], x: &mut [f64]) {
        for (j, x) in x.iter().enumerate() {
            self.scratch.right_side[j] = x + self.mu_times(j, y);
        }
        let row = |this: &Self, j: usize, i: usize| {
            if closed[i] { this.mu(j, i) * this.list[i].penalty.mass } else { 0.0 }
        };
        self.solve(row, x);
    }

    fn mu(&self, j: usize, i: usize) -> f64 {
        if i == j { self.compliance[j] } else { self.coupling[i.min(j)] }
    }

    /// (I + C) x = right side for the tridiagonal C = `entry`. C is a product of a positive semidefinite and a
    /// non-negative diagonal matrix, so that elimination needs no exchange of rows.
    fn solve(&mut self, entry: impl Fn(&Self, usize, usize) -> f64, x: &mut [f64]) {
        let k = x.len();
        for j in 0..k {
            let lower = if j > 0 { entry(self, j, j - 1) } else { 0.0 };
            let (carried, above) = if j > 0 { (x[j - 1], self.scratch.upper[j - 1]) } else { (0.0, 0.0) };
            let pivot = 1.0 + entry(self, j, j) - lower * above;
            self.scratch.upper[j] = if j + 1 < k { entry(self, j, j + 1) / pivot } else { 0.0 };
            x[j] = (self.scratch.right_side[j] - lower * carried) / pivot;
        }
        for j in (1..k).rev() {
            x[j - 1] -= self.scratch.upper[j - 1] * x[j];
        }
    }
}

fn trimmed(x: &[f64]) -> Column {
    let largest = x.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let kept = |entry: &f64| entry.abs() > NEGLIGIBLE * largest;
    let start = x.iter().position(kept).unwrap_or(0);
    let end = x.iter().rposition(kept).map_or(0, |last| last + 1);
    Column { start, entries: x[start..end].to_vec() }
}
