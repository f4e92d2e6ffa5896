//! How large the entries of K and M are relative to M: what every backward error is multiplied by.

use faer::Mat;
use faer::sparse::Triplet;

use super::Matrix;
use crate::error::Refusal;
use crate::symmetric::{self, SparseCholesky};

/// Numbers B and c with |x|'|K||x| <= B x'Mx and |x|'|M||x| <= c x'Mx for every x, entries in absolute value.
///
/// A change of every entry of K and M by the relative e then moves no eigenvalue l by more than e (B + c l). Elements
/// give them: what each element obeys, their sum does. For two-node bars B is the largest element eigenvalue and
/// c = 3/(1+2g).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// B, rad^2/s^2.
    pub stiffness: f64,
    /// c, dimensionless, at least 1.
    pub mass: f64,
}

/// Rows of the mass beyond its diagonal are tried to be dominated after so many improvements of the weights.
const IMPROVEMENTS: usize = 60;

impl Bounds {
    /// The bounds of a pencil with a diagonal mass that its rows prove: B = max_i (|K| d)_i/(M d)_i for positive weights d,
    /// of which some steps of the power method bring the largest eigenvalue near (Collatz and Wielandt).
    pub fn of_lumped(stiffness: &Matrix, mass: &[f64]) -> Self {
        let own = |i: usize| mass[i];
        Self { stiffness: least_quotient(stiffness, &own, 0.0) * (1.0 + margin(stiffness)), mass: 1.0 }
    }

    /// The bounds of one element of p unknowns, matrices row by row, by D = diag(M): l_max(|K|, D) and l_max(|M|, D) over
    /// l_min(M, D). `None` for matrices of another size, not symmetric or finite, and a mass that is not positive definite.
    pub fn of_element(k: &[f64], m: &[f64], size: usize) -> Option<Self> {
        let symmetric = |a: &[f64]| (0..size).all(|i| (0..i).all(|j| a[i * size + j] == a[j * size + i]));
        let finite = k.iter().chain(m).all(|a| a.is_finite());
        if size == 0
            || k.len() != size * size
            || m.len() != size * size
            || !finite
            || !symmetric(k)
            || !symmetric(m)
        {
            return None;
        }
        let own = |i: usize| m[i * size + i];
        if (0..size).any(|i| own(i) <= 0.0) {
            return None;
        }
        let eigenvalues = |entry: &dyn Fn(usize) -> f64| {
            let scaled = |i: usize, j: usize| entry(i * size + j) / (own(i).sqrt() * own(j).sqrt());
            symmetric::eigenvalues(&Mat::from_fn(size, size, scaled))
        };
        let largest = |values: Vec<f64>| values.last().copied();
        let stiffness = largest(eigenvalues(&|i| k[i].abs())?)?;
        let mass = largest(eigenvalues(&|i| m[i].abs())?)?;
        let least = *eigenvalues(&|i| m[i])?.first()?;
        // A dense eigenvalue of p rows errs by some p^2 roundings of the largest.
        let rounding = (4 * size * size + 16) as f64 * f64::EPSILON;
        let least = least - rounding * mass;
        (least > 0.0).then(|| Self {
            stiffness: stiffness * (1.0 + rounding) / least,
            mass: (mass * (1.0 + rounding) / least).max(1.0),
        })
    }

    /// What obeys either obeys this.
    pub fn or(self, other: Self) -> Self {
        Self { stiffness: self.stiffness.max(other.stiffness), mass: self.mass.max(other.mass) }
    }

    /// Checks the bounds with D = diag(M). BarRows prove |K| <= b D and |M| <= a D by positive weights; x'Dx <= q x'Mx holds
    /// with q = min(B/b, c/a) if M - D/q is positive definite, which is shown by the rows of its comparison matrix or by a
    /// Cholesky factor. A chain is checked sharply: B M - |K| with the off-diagonal entries of M taken as negative, the
    /// worst signs of x, must have positive pivots.
    ///
    /// # Errors
    /// Names the bound that could not be shown to hold; a mass that is not positive definite among them.
    pub(super) fn check(self, stiffness: &Matrix, mass: &Matrix) -> Result<(), Refusal> {
        super::check::positive("bounds, stiffness", self.stiffness, "rad^2/s^2")?;
        if !(self.mass >= 1.0 && self.mass.is_finite()) {
            return Err(Refusal::new("bounds, mass", self.mass, "a finite number of at least 1"));
        }
        if self.holds_by_pivots(stiffness, mass) {
            return Ok(());
        }
        let own = |i: usize| mass.diagonal(i);
        let slack = 1.0 + margin(stiffness).max(margin(mass));
        let b = least_quotient(stiffness, &own, self.stiffness);
        if b > self.stiffness * slack {
            let allowed = format!("at least {b:e} rad^2/s^2, or a bound that the rows of |K| prove");
            return Err(Refusal::new("bounds, stiffness", format!("{:e}", self.stiffness), allowed));
        }
        let a = least_quotient(mass, &own, 1.0);
        let q = (self.stiffness / b).min(self.mass / a) * slack;
        if exceeds_its_diagonal(mass, 1.0 / q) {
            return Ok(());
        }
        let value = format!("B = {:e} rad^2/s^2 and c = {:e}", self.stiffness, self.mass);
        let allowed = format!(
            "a positive definite mass, of which B/{b:e} and c/{a:e} are at least the condition in its diagonal"
        );
        Err(Refusal::new("mass, bounds", value, allowed))
    }

    /// The sharp check of a tridiagonal pencil, a positive definite mass included.
    fn holds_by_pivots(self, stiffness: &Matrix, mass: &Matrix) -> bool {
        let (Matrix::Chain(k), Matrix::Chain(_) | Matrix::Diagonal(_)) = (stiffness, mass) else {
            return false;
        };
        let zeros = vec![0.0; k.off_diagonal.len()];
        let (m, m_off) = match mass {
            Matrix::Chain(m) => (&m.diagonal, &m.off_diagonal),
            Matrix::Diagonal(m) => (m, &zeros),
            Matrix::Sparse(_) => return false,
        };
        // Elimination errs by 8 unit roundoffs of each entry, and |K|/B and |M| are at most c M together: where the
        // bounds hold, 64 of them leave positive pivots.
        let more = 1.0 + 64.0 * f64::EPSILON * self.mass;
        let row = |a: &[f64], off: &[f64], bound: f64, i: usize| {
            let beside = |j: usize| -(more * m_off[j].abs() + off[j].abs() / bound);
            (more * m[i] - a[i].abs() / bound, if i > 0 { beside(i - 1) } else { 0.0 })
        };
        let positive = |a: &[f64], off: &[f64], bound: f64| {
            let rows = (1..a.len()).map(|i| row(a, off, bound, i));
            super::last_pivot(row(a, off, bound, 0).0, rows, |pivot, _| pivot > 0.0).is_some_and(|d| d > 0.0)
        };
        positive(&k.diagonal, &k.off_diagonal, self.stiffness) && positive(m, m_off, self.mass)
    }
}

/// The relative rounding of a row sum.
fn margin(matrix: &Matrix) -> f64 {
    let longest = match matrix {
        Matrix::Chain(_) => 3,
        Matrix::Diagonal(_) => 1,
        Matrix::Sparse(a) => (0..a.rows()).map(|i| a.row(i).0.len()).max().unwrap_or(0),
    };
    (longest + 16) as f64 * f64::EPSILON
}

/// max_i (|A| d)_i/(D d)_i for the best positive weights d that are found, until it is no more than `enough`: at least
/// the largest eigenvalue of (|A|, D).
fn least_quotient(matrix: &Matrix, own: &impl Fn(usize) -> f64, enough: f64) -> f64 {
    let n = matrix.size();
    let mut weights = vec![1.0; n];
    let mut least = f64::INFINITY;
    for _ in 0..IMPROVEMENTS {
        let quotient =
            |i: usize| matrix.row(i).map(|(j, a)| a.abs() * weights[j]).sum::<f64>() / (own(i) * weights[i]);
        let quotients: Vec<f64> = (0..n).map(quotient).collect();
        let largest = quotients.iter().fold(0.0, |a: f64, b| a.max(*b));
        least = least.min(largest);
        if least <= enough || largest == 0.0 {
            break;
        }
        // Half a step: rows that see each other alone would only take turns.
        weights.iter_mut().zip(&quotients).for_each(|(w, q)| *w *= 0.5 + 0.5 * q / largest);
    }
    least
}

/// Whether M >= `share` diag(M): by the comparison matrix of M, or by a Cholesky factor of the difference. A factor in
/// floating point changes A by no more than n (n + 1) u diag(A) (Demmel 1989; Rump, BIT 46, 2006), so that the share is
/// shown to twice that only: enough for a bound of rounding errors.
fn exceeds_its_diagonal(mass: &Matrix, share: f64) -> bool {
    let dominated = |i: usize| {
        let beside: f64 = mass.row(i).filter(|(j, _)| *j != i).map(|(_, a)| a.abs()).sum();
        (1.0 - share) * mass.diagonal(i) >= beside
    };
    let n = mass.size();
    if (0..n).all(dominated) {
        return true;
    }
    let rounding = 0.5 * f64::EPSILON * n as f64 * (n + 1) as f64;
    let kept = 1.0 - share + 2.0 * rounding;
    let entry = |i: usize, j: usize, a: f64| if i == j { a * kept } else { a };
    let lower = |i: usize| {
        mass.row(i).filter(move |(j, _)| *j <= i).map(move |(j, a)| Triplet::new(i, j, entry(i, j, a)))
    };
    let triplets: Vec<_> = (0..n).flat_map(lower).collect();
    SparseCholesky::new(n, &triplets).is_ok()
}
