//! The contacts of a step: their columns M^-1 z, and the reactions of those that are closed.
//!
//! With g = Z'u + g0 (positive in penetration), mu = Z'M^-1 Z and the closed contacts' s and m (diagonal), the momentum
//! balance M a = f - K u - Z lambda with (M + Z m Z') a = f - K u - Z s g gives
//!
//! ```text
//! (I + m mu) lambda = s g + m p        (I + mu m) Z'a = p - mu s g        p = Z'M^-1 (f - K u)
//! ```
//! The textbook form lambda = s g + m Z'a subtracts numbers of size beta_s, and so does Z'a = p - mu lambda. Contacts couple
//! through the bar between them unless M is diagonal: mu is then tridiagonal. Contacts of other meshes that share nodes, or
//! an inverse of M, are coupled at will: with m = a s, a = 1/rate, the closed ones obey the symmetric
//! (1/s + a mu) lambda = g + a p.

use faer::Mat;

use super::inertia::Inertia;
use crate::error::Refusal;
use crate::pencil::{Gap, Matrix, Penalty, PenaltyMass, Pencil};
use crate::sparse::SparseVector;
use crate::symmetric::Cholesky;

/// Entries of a column M^-1 z below this part of its largest are left out: the square of the unit roundoff.
const NEGLIGIBLE: f64 = f64::EPSILON * f64::EPSILON / 4.0;

/// M^-1 z without negligible entries.
#[derive(Debug, Clone)]
enum Column {
    /// Consecutive nodes, as in a bar.
    Run {
        start: usize,
        entries: Vec<f64>,
    },
    Scattered(SparseVector),
}

impl Column {
    fn new(x: &[f64], consecutive: bool) -> Self {
        let largest = x.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let kept = |entry: &f64| entry.abs() > NEGLIGIBLE * largest;
        if consecutive {
            let start = x.iter().position(kept).unwrap_or(0);
            let end = x.iter().rposition(kept).map_or(0, |last| last + 1);
            return Self::Run { start, entries: x[start..end].to_vec() };
        }
        let entries = x.iter().enumerate().filter(|(_, x)| kept(x)).map(|(i, x)| (i as u32, *x));
        Self::Scattered(SparseVector(entries.collect()))
    }

    /// The entries of x at the nodes of z, which are taken out of x.
    fn of_nodes(z: &SparseVector, x: &mut [f64]) -> Self {
        let entry = |(i, _): &(u32, f64)| (*i, std::mem::take(&mut x[*i as usize]));
        Self::Scattered(SparseVector(z.0.iter().map(entry).collect()))
    }

    fn entry(&self, node: usize) -> f64 {
        match self {
            Self::Run { start, entries } => {
                node.checked_sub(*start).and_then(|at| entries.get(at)).copied().unwrap_or(0.0)
            }
            Self::Scattered(SparseVector(entries)) => {
                entries.binary_search_by_key(&(node as u32), |(i, _)| *i).map_or(0.0, |at| entries[at].1)
            }
        }
    }

    fn add_to(&self, weight: f64, rate: &mut [f64]) {
        match self {
            Self::Run { start, entries } => {
                let touched = &mut rate[*start..start + entries.len()];
                touched.iter_mut().zip(entries).for_each(|(rate, entry)| *rate += weight * entry);
            }
            Self::Scattered(column) => column.add_to(weight, rate),
        }
    }
}

/// mu = Z'M^-1 Z, 1/kg.
#[derive(Debug, Clone)]
enum Coupling {
    /// mu_{j,j+1}: only neighbours in a row meet, and not even they where M is diagonal.
    Neighbours { beside: Vec<f64>, upper: Vec<f64> },
    /// All of it, and the factor of (1/s + a mu) for the contacts that were closed last.
    Full { mu: Mat<f64>, closed: Vec<usize>, factor: Option<Cholesky> },
}

/// The contacts of a system with what their reactions need; k contacts.
#[derive(Debug, Clone)]
pub struct Contacts {
    gaps: Vec<Gap>,
    /// s_j, N/m, and m_j, kg.
    pub(super) terms: Vec<(f64, f64)>,
    /// a = m_j/s_j, s^2.
    inverse_rate: f64,
    columns: Vec<Column>,
    /// mu_jj, 1/kg.
    compliance: Vec<f64>,
    coupling: Coupling,
    right_side: Vec<f64>,
    disjoint: bool,
}

impl Contacts {
    /// The contacts of `pencil` with their penalty.
    ///
    /// # Errors
    /// The diagonalised mass penalty of a gap of several nodes, which is no rank-one term; a mass that has no factor.
    pub fn new(pencil: &Pencil, penalty: &Penalty) -> Result<Self, Refusal> {
        let gaps = pencil.gaps().to_vec();
        let spread = |gap: &&Gap| penalty.form == PenaltyMass::Diagonalised && gap.column.0.len() > 1;
        if let Some(gap) = gaps.iter().find(spread) {
            let value = format!("the diagonalised form ({} kg on each node)", 2.0 * penalty.of(gap.scale).1);
            return Err(Refusal::new("mass penalty", value, "the consistent form m z z'"));
        }
        let inertia = Inertia::new(pencil.mass(), 1.0)?;
        let chain = matches!(pencil.mass(), Matrix::Chain(_)) && pencil.chain().is_some();
        let k = gaps.len();
        let (mut compliance, mut beside) = (Vec::with_capacity(k), Vec::with_capacity(k));
        let mut columns = Vec::with_capacity(k);
        let disjoint = are_disjoint(pencil);
        let neighbours = chain || (disjoint && pencil.mass().is_diagonal());
        let mut mu = if neighbours { Mat::zeros(0, 0) } else { Mat::zeros(k, k) };
        let mut x = vec![0.0; pencil.size()];
        for (j, gap) in gaps.iter().enumerate() {
            gap.column.0.iter().for_each(|(node, z)| x[*node as usize] = *z);
            inertia.solve_column(&gap.column, &mut x);
            compliance.push(gap.column.dot(&x));
            beside.push(gaps.get(j + 1).filter(|_| chain).map_or(0.0, |next| next.column.dot(&x)));
            if !neighbours {
                (0..k).for_each(|i| mu[(i, j)] = gaps[i].column.dot(&x));
            }
            match inertia.is_lumped() && !chain {
                true => columns.push(Column::of_nodes(&gap.column, &mut x)),
                false => {
                    columns.push(Column::new(&x, chain));
                    x.fill(0.0);
                }
            }
        }
        let coupling = match neighbours {
            true => Coupling::Neighbours { beside, upper: vec![0.0; k] },
            false => Coupling::Full { mu, closed: Vec::new(), factor: None },
        };
        Ok(Self {
            terms: gaps.iter().map(|gap| penalty.of(gap.scale)).collect(),
            inverse_rate: 1.0 / penalty.rate,
            columns,
            compliance,
            coupling,
            right_side: vec![0.0; k],
            disjoint,
            gaps,
        })
    }

    /// Number of contacts k.
    pub fn len(&self) -> usize {
        self.gaps.len()
    }

    /// Whether there is no contact.
    pub fn is_empty(&self) -> bool {
        self.gaps.is_empty()
    }

    /// The nodes of contact j with their entry of z.
    pub(super) fn column(&self, j: usize) -> &[(u32, f64)] {
        &self.gaps[j].column.0
    }

    /// Whether no two contacts act on the same node.
    pub(super) fn are_disjoint(&self) -> bool {
        self.disjoint
    }

    /// z_j'x.
    #[inline]
    pub fn across(&self, j: usize, x: &[f64]) -> f64 {
        self.gaps[j].column.dot(x)
    }

    /// g0 of contact j, m.
    pub(super) fn initial(&self, j: usize) -> f64 {
        self.gaps[j].initial
    }

    /// Moves x so that z_j'x = `value`, along z: the mean of a pair is unchanged.
    #[inline]
    pub(super) fn set_across(&self, j: usize, value: f64, x: &mut [f64]) {
        let column = &self.gaps[j].column;
        match column.0[..] {
            [(node, z)] => x[node as usize] = value / z,
            [(left, a), (right, b)] if a == -b && a.abs() == 1.0 => {
                let (left, right) = (left as usize, right as usize);
                let mean = 0.5 * (x[left] + x[right]);
                x[left] = mean + 0.5 * (a * value);
                x[right] = mean + 0.5 * (b * value);
            }
            _ => {
                let square: f64 = column.0.iter().map(|(_, z)| z * z).sum();
                let missing = (value - column.dot(x)) / square;
                column.add_to(missing, x);
            }
        }
    }

    /// mu_jj, 1/kg.
    pub fn compliance(&self, j: usize) -> f64 {
        self.compliance[j]
    }

    /// mu_ij = z_i' M^-1 z_j, 1/kg.
    pub fn compliance_between(&self, i: usize, j: usize) -> f64 {
        match &self.coupling {
            Coupling::Neighbours { .. } if i.abs_diff(j) > 1 => 0.0,
            Coupling::Neighbours { .. } | Coupling::Full { .. } => self.mu(i, j),
        }
    }

    /// sum_i |mu_ji|, 1/kg.
    pub(super) fn compliance_sum(&self, j: usize) -> f64 {
        let near = match &self.coupling {
            Coupling::Neighbours { .. } => j.saturating_sub(1)..self.len().min(j + 2),
            Coupling::Full { .. } => 0..self.len(),
        };
        near.map(|i| self.mu(j, i).abs()).sum()
    }

    /// Whether no contact moves the gap of another one: mu is diagonal.
    pub(super) fn act_apart(&self) -> bool {
        match &self.coupling {
            Coupling::Neighbours { beside, .. } => beside.iter().all(|mu| *mu == 0.0),
            Coupling::Full { mu, .. } => (0..mu.nrows()).all(|i| (0..i).all(|j| mu[(i, j)] == 0.0)),
        }
    }

    /// a = m_j/s_j of all contacts, s^2.
    pub(super) fn inverse_rate(&self) -> f64 {
        self.inverse_rate
    }

    /// (mu x)_j.
    #[inline]
    pub(super) fn mu_times(&self, j: usize, x: &[f64]) -> f64 {
        match &self.coupling {
            Coupling::Neighbours { beside, .. } => {
                let left = if j > 0 { beside[j - 1] * x[j - 1] } else { 0.0 };
                let right = x.get(j + 1).map_or(0.0, |right| beside[j] * right);
                left + self.compliance[j] * x[j] + right
            }
            Coupling::Full { mu, .. } => x.iter().enumerate().map(|(i, x)| mu[(j, i)] * x).sum(),
        }
    }

    /// The entry of M^-1 z_j at `node`.
    #[inline]
    pub(super) fn entry(&self, j: usize, node: usize) -> f64 {
        self.columns[j].entry(node)
    }

    /// rate += factor M^-1 Z x.
    pub fn add_columns(&self, factor: f64, x: &[f64], rate: &mut [f64]) {
        for (column, x) in self.columns.iter().zip(x).filter(|(_, x)| **x != 0.0) {
            column.add_to(factor * x, rate);
        }
    }

    /// lambda of the closed contacts, 0 for the others: (I + m mu) lambda = s g + m p, N.
    /// `p` is `None` where the scheme applies s g alone.
    pub fn reactions(&mut self, closed: &[bool], gap: &[f64], p: Option<&[f64]>, lambda: &mut [f64]) {
        if let Coupling::Full { .. } = self.coupling {
            let a = self.inverse_rate;
            let force = |j: usize| gap[j] + p.map_or(0.0, |p| a * p[j]);
            lambda.fill(0.0);
            self.solve_closed(closed, force, lambda);
            return;
        }
        for (j, (s, m)) in self.terms.iter().enumerate() {
            let inertial = p.map_or(0.0, |p| m * p[j]);
            let force = s * gap[j] + inertial;
            self.right_side[j] = if closed[j] { force } else { 0.0 };
        }
        let row = |this: &Self, j: usize, i: usize| {
            if closed[j] && closed[i] { this.terms[j].1 * this.mu(j, i) } else { 0.0 }
        };
        self.solve_row(row, lambda);
    }

    /// x <- (I + mu m)^-1 (x + mu y), where m and y belong to the closed contacts; y is 0 for the others.
    pub(super) fn relax(&mut self, closed: &[bool], y: &[f64], x: &mut [f64]) {
        for (j, x) in x.iter().enumerate() {
            self.right_side[j] = x + self.mu_times(j, y);
        }
        if let Coupling::Full { .. } = self.coupling {
            // w = s x of the closed contacts obeys (1/s + a mu) w = x + mu y.
            let (right_side, mut w) = (std::mem::take(&mut self.right_side), vec![0.0; x.len()]);
            self.solve_closed(closed, |j| right_side[j], &mut w);
            for j in 0..x.len() {
                x[j] = match closed[j] && self.terms[j].0 > 0.0 {
                    true => w[j] / self.terms[j].0,
                    false => right_side[j] - self.inverse_rate * self.mu_times(j, &w),
                };
            }
            self.right_side = right_side;
            return;
        }
        let row = |this: &Self, j: usize, i: usize| {
            if closed[i] { this.mu(j, i) * this.terms[i].1 } else { 0.0 }
        };
        self.solve_row(row, x);
    }

    fn mu(&self, j: usize, i: usize) -> f64 {
        match &self.coupling {
            _ if i == j => self.compliance[j],
            Coupling::Neighbours { beside, .. } => beside[i.min(j)],
            Coupling::Full { mu, .. } => mu[(j, i)],
        }
    }

    /// (I + C) x = right side for the tridiagonal C = `entry`. C is a product of a positive semidefinite and a
    /// non-negative diagonal matrix, so that elimination needs no exchange of rows.
    fn solve_row(&mut self, entry: impl Fn(&Self, usize, usize) -> f64, x: &mut [f64]) {
        let k = x.len();
        let mut upper = match &mut self.coupling {
            Coupling::Neighbours { upper, .. } => std::mem::take(upper),
            Coupling::Full { .. } => return,
        };
        for j in 0..k {
            let lower = if j > 0 { entry(self, j, j - 1) } else { 0.0 };
            let (carried, above) = if j > 0 { (x[j - 1], upper[j - 1]) } else { (0.0, 0.0) };
            let pivot = 1.0 + entry(self, j, j) - lower * above;
            upper[j] = if j + 1 < k { entry(self, j, j + 1) / pivot } else { 0.0 };
            x[j] = (self.right_side[j] - lower * carried) / pivot;
        }
        for j in (1..k).rev() {
            x[j - 1] -= upper[j - 1] * x[j];
        }
        if let Coupling::Neighbours { upper: kept, .. } = &mut self.coupling {
            *kept = upper;
        }
    }

    /// (1/s + a mu) x = right side for the closed contacts of coupled ones; x of the others is left alone. The factor is
    /// kept until a contact opens or closes.
    fn solve_closed(&mut self, closed: &[bool], right_side: impl Fn(usize) -> f64, x: &mut [f64]) {
        let (terms, a) = (&self.terms, self.inverse_rate);
        let Coupling::Full { mu, closed: last, factor } = &mut self.coupling else { return };
        let now = || (0..closed.len()).filter(|j| closed[*j] && terms[*j].0 > 0.0);
        if factor.is_none() || !now().eq(last.iter().copied()) {
            *last = now().collect();
            let entry = |i: usize, j: usize| {
                let own = if i == j { 1.0 / terms[last[i]].0 } else { 0.0 };
                own + a * mu[(last[i], last[j])]
            };
            // Positive definite: mu is, and 1/s > 0.
            *factor = Cholesky::new(Mat::from_fn(last.len(), last.len(), entry));
        }
        let mut y: Vec<f64> = last.iter().map(|j| right_side(*j)).collect();
        match factor {
            Some(factor) => factor.solve(&mut y),
            None => y.fill(f64::NAN),
        }
        last.iter().zip(y).for_each(|(j, y)| x[*j] = y);
    }
}

fn are_disjoint(pencil: &Pencil) -> bool {
    let mut touched = vec![false; pencil.size()];
    pencil
        .gaps()
        .iter()
        .flat_map(|gap| &gap.column.0)
        .all(|(i, _)| !std::mem::replace(&mut touched[*i as usize], true))
}
