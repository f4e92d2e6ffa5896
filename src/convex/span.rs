//! Lower bounds of f for every t from numbers alone: the forms of sampled vectors, with their rounding.
//!
//! Any vector x gives f(t) >= (x'Kx + t x'Px)/x'Mx. The best x of the span of all sampled vectors V is a Ritz vector x = V y, from a
//! small dense problem; its quotient is then bounded from below, whatever y is:
//!
//! ```text
//! |fl(x'Kx) - x'Kx| <= g |x|'|K||x| <= g rho_K x'Dx      D = diag(M)      rho_K = max_i (|K| 1)_i/d_i
//! x'Dx <= S^2      S = sum_i |y_i| |v_i|_D      |fl(z'x) - z'x| <= g sum_i |y_i| |z|'|v_i|
//! ```
//! with g = g(q + d + 2k + 4) for rows of q entries, sums of depth d and k vectors; the same for M. Where the matrices are sums over
//! parts, K = sum_p K_p, each form is the sum over the parts: the largest rho of a part serves, since sum_p x'D_p x = x'Dx, and
//! the depth grows by the number of parts. So the vectors may lie on as many machines as there are parts.

use faer::Mat;

use super::factor::rounding;
use super::pencil::MeshPencil;
use super::ritz;
use super::vectors::dot_depth;
use crate::pencil::Matrix;

/// What one vector x says about every t: f(t) >= stiffness + t penalty, with penalty the end of its interval that is worse.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// A lower bound of x'Kx/x'Mx.
    pub stiffness: f64,
    /// A lower bound of x'Px/x'Mx.
    pub least_penalty: f64,
    /// An upper bound of x'Px/x'Mx.
    pub most_penalty: f64,
}

impl Line {
    /// A lower bound of f(t).
    pub fn at(&self, t: f64) -> f64 {
        let penalty = if t >= 0.0 { self.least_penalty } else { self.most_penalty };
        let value = self.stiffness + t * penalty;
        value - 4.0 * f64::EPSILON * (self.stiffness.abs() + (t * penalty).abs())
    }

    /// A lower bound of l_max(K + s P, M + m P): the quotient (x'Kx + s x'Px)/(x'Mx + m x'Px).
    pub fn with_mass(&self, s: f64, m: f64) -> f64 {
        let quotient = |p: f64| {
            let value = (self.stiffness + s * p) / (1.0 + m * p);
            value - 8.0 * f64::EPSILON * (self.stiffness.abs() + s * p) / (1.0 + m * p)
        };
        quotient(self.least_penalty).min(quotient(self.most_penalty))
    }
}

/// What bounds the rounding of the forms of a pencil, or of the sum of several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// rho of K and of M: the largest row sums over d_i.
    pub rho: (f64, f64),
    /// The most roundings that an entry of a product goes through: the entries of a row, and what summed them up.
    pub row: usize,
    /// Unknowns of the largest part.
    pub unknowns: usize,
    /// Entries of the longest gap.
    pub gap: usize,
    /// Parts.
    pub parts: usize,
}

/// Largest row sum of |A| over d.
fn relative_rows(matrix: &Matrix, diagonal: &[f64]) -> (f64, usize) {
    let rows = (0..matrix.size()).map(|i| {
        let (sum, length) = matrix.row(i).fold((0.0, 0), |(sum, length), (_, a)| (sum + a.abs(), length + 1));
        (sum / diagonal[i], length)
    });
    rows.fold((0.0, 0), |(sum, length), (next, more)| (f64::max(sum, next), length.max(more)))
}

impl Sizes {
    /// Of one pencil.
    pub fn of(pencil: &MeshPencil) -> Self {
        let diagonal = pencil.mass_diagonal();
        let (rho_k, row_k) = relative_rows(pencil.stiffness(), diagonal);
        let (rho_m, row_m) = relative_rows(pencil.mass(), diagonal);
        Self {
            // The row sums themselves are rounded.
            rho: (rho_k * (1.0 + rounding(row_k + 2)), rho_m * (1.0 + rounding(row_m + 2))),
            row: row_k.max(row_m),
            unknowns: pencil.size(),
            gap: pencil.contacts().iter().map(|c| c.column.0.len()).max().unwrap_or(0),
            parts: 1,
        }
    }

    /// Of the sum of two.
    pub fn and(self, other: Self) -> Self {
        Self {
            rho: (self.rho.0.max(other.rho.0), self.rho.1.max(other.rho.1)),
            row: self.row.max(other.row),
            unknowns: self.unknowns.max(other.unknowns),
            gap: self.gap.max(other.gap),
            parts: self.parts + other.parts,
        }
    }
}

/// The forms of a new vector v with all earlier ones and itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// v_i'K v.
    pub stiffness: Vec<f64>,
    /// v_i'M v.
    pub mass: Vec<f64>,
    /// z_j'v.
    pub gaps: Vec<f64>,
    /// |z_j|'|v|.
    pub gap_sizes: Vec<f64>,
    /// v'Dv.
    pub square: f64,
}

/// The span of all sampled vectors, as far as bounds need it.
#[derive(Debug, Clone)]
pub struct Span {
    rows: Vec<Row>,
    /// v_i'P v_j, without bounds: for the choice of y only.
    penalty: Vec<Vec<f64>>,
    /// |v_i|_D.
    lengths: Vec<f64>,
    scales: Vec<f64>,
    sizes: Sizes,
    rounding: f64,
}

impl Span {
    /// The empty span of a pencil with contacts of these scales.
    pub fn new(sizes: Sizes, scales: Vec<f64>) -> Self {
        Self {
            rows: Vec::new(),
            penalty: Vec::new(),
            lengths: Vec::new(),
            scales,
            sizes,
            rounding: rounding(sizes.row + dot_depth(sizes.unknowns) + sizes.parts + 3),
        }
    }

    /// Number of vectors.
    pub fn dimension(&self) -> usize {
        self.rows.len()
    }

    /// Adds a vector.
    pub fn push(&mut self, row: Row) {
        let terms = self.sizes.unknowns + self.sizes.parts;
        self.lengths.push(row.square.sqrt() * (1.0 + rounding(terms + 1)));
        self.rows.push(row);
        let new = &self.rows[self.rows.len() - 1].gaps;
        let form = |old: &Row| old.gaps.iter().zip(new).zip(&self.scales).map(|((a, b), w)| w * a * b).sum();
        self.penalty.push(self.rows.iter().map(form).collect());
    }

    /// y'A y of a matrix kept by its lower triangle.
    fn form<'a>(matrix: impl Iterator<Item = &'a Vec<f64>>, y: &[f64]) -> f64 {
        let row = |(i, row): (usize, &Vec<f64>)| {
            let off: f64 = row[..i].iter().zip(y).map(|(a, y)| a * y).sum();
            y[i] * (2.0 * off + row[i] * y[i])
        };
        matrix.enumerate().map(row).sum()
    }

    /// The line of x = V y, bounded as the module says.
    pub fn line(&self, y: &[f64]) -> Line {
        let k = y.len();
        let g = self.rounding + rounding(2 * k + 4);
        let size = y.iter().zip(&self.lengths).map(|(y, v)| y.abs() * v).sum::<f64>().powi(2)
            * (1.0 + rounding(2 * k + 4));
        let stiffness = Self::form(self.rows.iter().map(|row| &row.stiffness), y);
        let mass = Self::form(self.rows.iter().map(|row| &row.mass), y);
        let (rho_k, rho_m) = self.sizes.rho;
        let (least_mass, most_mass) = (mass - g * rho_m * size, mass + g * rho_m * size);
        let stiffness = stiffness - g * rho_k * size;
        let (mut least, mut most) = (0.0, 0.0);
        for (j, scale) in self.scales.iter().enumerate() {
            let (mut gap, mut sizes) = (0.0, 0.0);
            for (row, y) in self.rows.iter().zip(y) {
                gap += y * row.gaps[j];
                sizes += y.abs() * row.gap_sizes[j];
            }
            let error = 2.0 * rounding(self.sizes.gap + k + 4) * sizes;
            least += scale * (gap.abs() - error).max(0.0).powi(2);
            most += scale * (gap.abs() + error).powi(2);
        }
        let sums = rounding(self.scales.len() + 6);
        Line {
            stiffness: if stiffness >= 0.0 { stiffness / most_mass } else { stiffness / least_mass },
            least_penalty: least * (1.0 - sums) / most_mass,
            most_penalty: most * (1.0 + sums) / least_mass,
        }
    }

    /// The coefficients y of the Ritz vector of the largest Ritz value at t.
    pub fn ritz(&self, t: f64) -> Vec<f64> {
        let k = self.dimension();
        let whole = |rows: &dyn Fn(usize, usize) -> f64| Mat::from_fn(k, k, |i, j| rows(i.max(j), i.min(j)));
        let stiffness = whole(&|i, j| self.rows[i].stiffness[j]);
        let penalty = whole(&|i, j| self.penalty[i][j]);
        let gaps = || Mat::from_fn(self.scales.len(), k, |j, i| self.scales[j].sqrt() * self.rows[i].gaps[j]);
        ritz::largest(&stiffness, &penalty, t, gaps)
    }
}
