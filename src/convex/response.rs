//! What contacts answer to unit forces on them: Z'A^-1 Z of A = u M + c K, and how far it may be off.
//!
//! Column by column, by conjugate gradients and residuals in double-double arithmetic: each round solves for what the last
//! one left, so that the digits of X are those of double-double, not those of the iteration. With r = z - A x
//!
//! ```text
//! |y'A^-1 z - y'x| = |y'A^-1 r| <= (y'A^-1 y)^(1/2) (r'A^-1 r)^(1/2)      r'A^-1 r <= q r'D^-1 r/g
//! ```
//! as A >= g M, which the caller knows, and M >= D/q with D = diag(M). So if (r_j'A^-1 r_j)^(1/2) <= e F_jj^(1/2) for each column of
//! F = Z'A^-1 Z, every form y'Fy is off by no more than e (sum |y_i| F_ii^(1/2))^2 <= e k sum F_ii y_i^2. Neither matrix is factorised;
//! a column takes some vectors of n.

use rayon::prelude::*;

use super::factor::rounding;
use super::pencil::MeshPencil;
use super::span::Sizes;
use super::vectors::{dot, dot_depth};
use crate::double_double::{Dd, Real};
use crate::pencil::{Gap, Matrix};

/// A = mass M + stiffness K, at least `least` M.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shifted {
    /// u, rad^2/s^2 where K has a part.
    pub mass: Dd,
    /// c, -1, 0 or 1.
    pub stiffness: f64,
    /// g > 0.
    pub least: f64,
}

/// F = Z'A^-1 Z of k contacts, row by row, and e: each form y'Fy is off by no more than e k sum F_ii y_i^2.
#[derive(Debug, Clone)]
pub(super) struct Response {
    pub entries: Vec<Dd>,
    pub error: f64,
}

/// How much a round may reduce a residual: conjugate gradients in f64 reach little beyond.
const ROUND: f64 = 1e-9;
/// An e from which on residuals in f64 do: they are off by some tens of roundings.
const FEW_DIGITS: f64 = 1e-10;
/// Rounds; double-double arithmetic holds no more digits than four rounds make.
const MOST_ROUNDS: usize = 5;
/// Iterations of a round; where u is that near to the spectrum, the step of a contact-free mesh is as near to the limit.
const MOST_ITERATIONS: usize = 20_000;

/// What answers forces on the contacts of a pencil.
#[derive(Debug, Clone)]
pub(super) struct Responder {
    pencil: MeshPencil,
    sizes: Sizes,
    /// q with M >= diag(M)/q.
    condition: f64,
}

impl Responder {
    pub fn new(pencil: &MeshPencil, condition: f64) -> Self {
        Self { pencil: pencil.clone(), sizes: Sizes::of(pencil), condition }
    }

    /// F, with e down to `goal` if rounding lets it.
    pub fn respond(&self, shifted: Shifted, goal: f64) -> Response {
        let contacts = self.pencil.contacts();
        let k = contacts.len();
        let columns: Vec<(Vec<Dd>, f64)> =
            contacts.par_iter().map(|contact| self.column(contact, shifted, goal)).collect();
        let error = columns.iter().map(|(_, error)| *error).fold(0.0, f64::max);
        let half = Dd::from(0.5);
        let entry = |i: usize, j: usize| half * (columns[j].0[i] + columns[i].0[j]);
        Response { entries: (0..k * k).map(|at| entry(at / k, at % k)).collect(), error }
    }

    /// z_i'A^-1 z of all contacts i, and e of this column. Residuals in f64 do where few digits are asked for.
    fn column(&self, contact: &Gap, shifted: Shifted, goal: f64) -> (Vec<Dd>, f64) {
        if goal >= FEW_DIGITS {
            let found = self.column_by(contact, shifted, goal, &row_in_f64, f64::EPSILON);
            if found.1 <= goal {
                return found;
            }
        }
        self.column_by(contact, shifted, goal, &row_in_dd, Dd::ROUNDOFF)
    }

    /// With residuals row by row, of that roundoff.
    fn column_by(
        &self,
        contact: &Gap,
        shifted: Shifted,
        goal: f64,
        row: &dyn Fn(&Matrix, usize, &[Dd]) -> Dd,
        roundoff: f64,
    ) -> (Vec<Dd>, f64) {
        let n = self.pencil.size();
        let solver = Solver::new(&self.pencil, shifted);
        let mut x = vec![Dd::from(0.0); n];
        let mut residual = vec![0.0; n];
        contact.column.add_to(1.0, &mut residual);
        let mut error = f64::INFINITY;
        let mut best = x.clone();
        for _ in 0..MOST_ROUNDS {
            // Near the spectrum the first round may end short of a positive F_jj.
            let reduce = if error.is_finite() { (0.1 * goal / error).clamp(ROUND, 0.1) } else { ROUND };
            let correction = solver.solve(&residual, reduce);
            x.iter_mut().zip(&correction).for_each(|(x, d)| *x = *x + Dd::from(*d));
            self.residual(contact, shifted, &x, row, &mut residual);
            let left = self.left(contact, shifted, &x, &residual, roundoff);
            let better = left < 0.5 * error;
            if better {
                error = left;
                best.copy_from_slice(&x);
            }
            // Rounding has the last word: another round would change nothing.
            if error <= goal || (error.is_finite() && !better) {
                break;
            }
        }
        // F_jj, which the error is measured by, is known to it: 1e-3 of it is allowed for.
        let error = if error <= 1e-4 { error } else { f64::INFINITY };
        (self.pencil.contacts().iter().map(|other| along(other, &best)).collect(), error)
    }

    /// (r'A^-1 r)^(1/2) over F_jj^(1/2), from above.
    fn left(&self, contact: &Gap, shifted: Shifted, x: &[Dd], r: &[f64], roundoff: f64) -> f64 {
        let diagonal = self.pencil.mass_diagonal();
        let inverse: Vec<f64> = r.iter().zip(diagonal).map(|(r, d)| r / d).collect();
        let scaled: Vec<f64> = x.iter().zip(diagonal).map(|(x, d)| x.hi * d).collect();
        let plain: Vec<f64> = x.iter().map(|x| x.hi).collect();
        let sums = 1.0 + rounding(dot_depth(r.len()) + 8);
        let length = |square: f64| (square * sums).sqrt() * (1.0 + 4.0 * f64::EPSILON);
        // |K||x| in the norm of D^-1 is no longer than the largest row sum of D^-1 |K| times x in that of D.
        let Sizes { rho: (k, m), row, .. } = self.sizes;
        let unit = (row + 8) as f64 * roundoff;
        let sizes = shifted.mass.hi.abs() * m + shifted.stiffness.abs() * k;
        let lost = unit * (sizes * length(dot(&scaled, &plain)) + contact_length(contact, diagonal));
        let rest = length(dot(&inverse, r)) + 2.0 * lost;
        let own = along(contact, x).hi;
        let error = (self.condition / (shifted.least * own)).sqrt() * rest * (1.0 + 1e-3);
        if own > 0.0 { error } else { f64::INFINITY }
    }

    /// r = z - A x.
    fn residual(
        &self,
        contact: &Gap,
        shifted: Shifted,
        x: &[Dd],
        row: &dyn Fn(&Matrix, usize, &[Dd]) -> Dd,
        r: &mut [f64],
    ) {
        let (stiffness, mass) = (self.pencil.stiffness(), self.pencil.mass());
        let mut entries = contact.column.0.iter().peekable();
        let c = Dd::from(shifted.stiffness);
        for (i, r) in r.iter_mut().enumerate() {
            let z = entries.next_if(|(at, _)| *at as usize == i).map_or(0.0, |(_, z)| *z);
            let mut image = shifted.mass * row(mass, i, x);
            if shifted.stiffness != 0.0 {
                image = image + c * row(stiffness, i, x);
            }
            *r = (Dd::from(z) - image).hi;
        }
    }
}

/// z'x.
fn along(contact: &Gap, x: &[Dd]) -> Dd {
    contact.column.0.iter().fold(Dd::from(0.0), |sum, (i, z)| sum + Dd::from(*z) * x[*i as usize])
}

/// z in the norm of D^-1.
fn contact_length(contact: &Gap, diagonal: &[f64]) -> f64 {
    contact.column.0.iter().map(|(i, z)| z * z / diagonal[*i as usize]).sum::<f64>().sqrt()
}

/// Row i of A x in double-double arithmetic.
fn row_in_dd(matrix: &Matrix, i: usize, x: &[Dd]) -> Dd {
    let add = |sum: Dd, (j, a): (usize, f64)| sum + Dd::from(a) * x[j];
    match matrix {
        Matrix::Sparse(sparse) => {
            let (columns, values) = sparse.row(i);
            columns.iter().zip(values).map(|(j, a)| (*j as usize, *a)).fold(Dd::from(0.0), add)
        }
        Matrix::Chain(_) | Matrix::Diagonal(_) => matrix.row(i).fold(Dd::from(0.0), add),
    }
}

/// Row i of A x in f64; what x has beyond f64 is one roundoff of it.
fn row_in_f64(matrix: &Matrix, i: usize, x: &[Dd]) -> Dd {
    Dd::from(match matrix {
        Matrix::Sparse(sparse) => {
            let (columns, values) = sparse.row(i);
            columns.iter().zip(values).map(|(j, a)| a * x[*j as usize].hi).sum()
        }
        Matrix::Chain(_) | Matrix::Diagonal(_) => matrix.row(i).map(|(j, a)| a * x[j].hi).sum::<f64>(),
    })
}

/// Conjugate gradients with the diagonal of A.
struct Solver<'a> {
    pencil: &'a MeshPencil,
    shift: f64,
    stiffness: f64,
    inverse: Vec<f64>,
}

impl<'a> Solver<'a> {
    fn new(pencil: &'a MeshPencil, shifted: Shifted) -> Self {
        let (shift, stiffness) = (shifted.mass.hi, shifted.stiffness);
        let own = |i: usize| shift * pencil.mass().diagonal(i) + stiffness * pencil.stiffness().diagonal(i);
        let inverse = (0..pencil.size()).map(|i| 1.0 / own(i)).collect();
        Self { pencil, shift, stiffness, inverse }
    }

    fn multiply(&self, x: &[f64], y: &mut [f64], part: &mut [f64]) {
        self.pencil.multiply_mass(x, y);
        y.iter_mut().for_each(|y| *y *= self.shift);
        if self.stiffness != 0.0 {
            self.pencil.multiply(self.stiffness, 0.0, x, part);
            y.iter_mut().zip(part).for_each(|(y, part)| *y += *part);
        }
    }

    /// About A^-1 b, the residual reduced to the part `reduce`.
    fn solve(&self, b: &[f64], reduce: f64) -> Vec<f64> {
        let n = b.len();
        let (mut x, mut r) = (vec![0.0; n], b.to_vec());
        let mut direction: Vec<f64> = r.iter().zip(&self.inverse).map(|(r, d)| r * d).collect();
        let mut steep = direction.clone();
        let (mut image, mut part) = (vec![0.0; n], vec![0.0; n]);
        let mut square = dot(&r, &steep);
        let goal = square * reduce * reduce;
        for _ in 0..MOST_ITERATIONS {
            if square.is_nan() || square <= goal {
                break;
            }
            self.multiply(&direction, &mut image, &mut part);
            let length = square / dot(&direction, &image);
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            x.iter_mut().zip(&direction).for_each(|(x, d)| *x += length * d);
            r.iter_mut().zip(&image).for_each(|(r, y)| *r -= length * y);
            steep.iter_mut().zip(&r).zip(&self.inverse).for_each(|((s, r), d)| *s = r * d);
            let next = dot(&r, &steep);
            let turn = next / square;
            direction.iter_mut().zip(&steep).for_each(|(d, s)| *d = s + turn * *d);
            square = next;
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::{Csr, SparseVector};

    /// A chain of springs with a full mass and three gaps.
    fn chain(n: u32) -> MeshPencil {
        let (mut k, mut m) = (Vec::new(), Vec::new());
        for i in 0..n {
            m.push((i, i, 4.0 + f64::from(i % 3)));
            if i > 0 {
                let stiff = 1.0 + f64::from(i % 5);
                k.extend([(i, i, stiff), (i - 1, i - 1, stiff), (i, i - 1, -stiff), (i - 1, i, -stiff)]);
                m.extend([(i, i - 1, 1.0), (i - 1, i, 1.0)]);
            }
        }
        let matrix = |entries: &[_]| Matrix::Sparse(Csr::from_triplets(n as usize, n as usize, entries));
        let gap = |entries: Vec<(u32, f64)>| Gap { column: SparseVector(entries), scale: 1.0, initial: 0.0 };
        let gaps = vec![gap(vec![(0, 1.0)]), gap(vec![(3, 1.0), (7, -0.5)]), gap(vec![(n - 1, -1.0)])];
        MeshPencil::new(matrix(&k), matrix(&m), gaps).unwrap()
    }

    /// The bound of a coarse answer holds against an answer to many more digits, and is no more than asked for.
    #[test]
    fn answers_are_off_by_no_more_than_they_say() {
        // diag(M) <= 6 and row sums beside it 2: M >= diag(M)/2. l_max(K, M) <= 2 max(k)/(min(m) - 2)/.. < 10.
        let responder = Responder::new(&chain(60), 2.0);
        let mut worst: f64 = 0.0;
        for (mass, stiffness) in [(10.5, -1.0), (1e6, -1.0), (0.6, 1.0), (1.0, 0.0)] {
            let least = if stiffness < 0.0 { mass - 10.0 } else { mass };
            let shifted = Shifted { mass: Dd::from(mass), stiffness, least };
            let exact = responder.respond(shifted, 1e-24);
            assert!(exact.error <= 1e-24, "{mass} {stiffness}: {:e}", exact.error);
            for goal in [1e-4, 1e-8, 1e-13] {
                let found = responder.respond(shifted, goal);
                assert!(found.error <= goal, "{mass} {stiffness} {goal}: {:e}", found.error);
                for (at, (f, e)) in found.entries.iter().zip(&exact.entries).enumerate() {
                    let own = |i: usize| exact.entries[i * 3 + i].hi;
                    let off = (*f - *e).hi.abs() / (own(at / 3) * own(at % 3)).sqrt();
                    assert!(off <= found.error, "{mass} {stiffness} {goal}: {off:e} > {:e}", found.error);
                    worst = worst.max(off / found.error);
                }
            }
        }
        // Not idle either.
        assert!(worst > 1e-6, "{worst:e}");
    }
}
