//! Lower bounds of f for every t: Rayleigh quotients of vectors, with their rounding.
//!
//! Any vector x gives f(t) >= (x'Kx + t x'Px)/x'Mx. The best x of the span of all sampled vectors V is a Ritz vector x = V y, from a
//! small dense problem; its quotient is then bounded from below, whatever y is:
//!
//! ```text
//! |fl(x'Kx) - x'Kx| <= g |x|'|K||x| <= g rho_K x'Dx      D = diag(M)      rho_K = max_i (|K| 1)_i/d_i
//! x'Dx <= S^2      S = sum_i |y_i| |v_i|_D      |fl(z'x) - z'x| <= g sum_i |y_i| |z|'|v_i|
//! ```
//! with g = g(q + d + 2k + 4) for rows of q entries, sums of depth d and k vectors; the same for M.

use faer::Mat;

use super::factor::rounding;
use super::lanczos::eigen;
use super::operator::Operator;
use super::pencil::MeshPencil;
use super::vectors::{combine, dot, dot_depth, project, subtract};
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

/// The span of all sampled vectors, M-orthonormal.
#[derive(Debug)]
pub struct Subspace {
    vectors: Vec<Vec<f64>>,
    stiffness: Vec<Vec<f64>>,
    mass: Vec<Vec<f64>>,
    /// z_j'v_i, and |z_j|'|v_i|, by vectors.
    gaps: Vec<Vec<f64>>,
    gap_sizes: Vec<Vec<f64>>,
    /// |v_i|_D.
    lengths: Vec<f64>,
    scales: Vec<f64>,
    rho: (f64, f64),
    rounding: f64,
    gap_entries: usize,
}

/// Largest row sum of |A| over d.
fn relative_rows(matrix: &Matrix, diagonal: &[f64]) -> (f64, usize) {
    let rows = (0..matrix.size()).map(|i| {
        let (sum, length) = matrix.row(i).fold((0.0, 0), |(sum, length), (_, a)| (sum + a.abs(), length + 1));
        (sum / diagonal[i], length)
    });
    rows.fold((0.0, 0), |(sum, length), (next, more)| (f64::max(sum, next), length.max(more)))
}

impl Subspace {
    /// The empty span of a pencil.
    pub fn new(pencil: &MeshPencil) -> Self {
        let diagonal = pencil.mass_diagonal();
        let (rho_k, row_k) = relative_rows(pencil.stiffness(), diagonal);
        let (rho_m, row_m) = relative_rows(pencil.mass(), diagonal);
        let gap_entries = pencil.contacts().iter().map(|c| c.column.0.len()).max().unwrap_or(0);
        Self {
            vectors: Vec::new(),
            stiffness: Vec::new(),
            mass: Vec::new(),
            gaps: Vec::new(),
            gap_sizes: Vec::new(),
            lengths: Vec::new(),
            scales: pencil.contacts().iter().map(|c| c.scale).collect(),
            // The row sums themselves are rounded.
            rho: (rho_k * (1.0 + rounding(row_k + 2)), rho_m * (1.0 + rounding(row_m + 2))),
            rounding: rounding(row_k.max(row_m) + dot_depth(pencil.size()) + 4),
            gap_entries,
        }
    }

    /// Number of vectors.
    pub fn dimension(&self) -> usize {
        self.vectors.len()
    }

    /// Adds a vector to the span, unless it lies in it already.
    pub fn add(&mut self, operator: &Operator, x: &[f64]) {
        let (mut x, mut image) = (x.to_vec(), vec![0.0; x.len()]);
        operator.normalise(&mut x);
        for _ in 0..2 {
            operator.pencil().multiply_mass(&x, &mut image);
            subtract(&self.vectors, &project(&self.vectors, &image), &mut x);
            operator.pencil().multiply_mass(&x, &mut image);
            // What is left of a vector of the span is rounding alone, or nothing.
            let left = dot(&x, &image).sqrt();
            if left.is_nan()
                || left <= 1e2 * f64::EPSILON * self.dimension() as f64
                || self.dimension() == x.len()
            {
                return;
            }
            operator.normalise(&mut x);
        }
        self.vectors.push(x);
        let x = &self.vectors[self.vectors.len() - 1];
        operator.pencil().multiply_mass(x, &mut image);
        self.mass.push(project(&self.vectors, &image));
        operator.multiply((1.0, 0.0), x, &mut image);
        self.stiffness.push(project(&self.vectors, &image));
        let contacts = operator.pencil().contacts();
        self.gaps.push(contacts.iter().map(|c| c.column.dot(x)).collect());
        let size = |z: &[(u32, f64)]| z.iter().map(|(i, z)| (z * x[*i as usize]).abs()).sum();
        self.gap_sizes.push(contacts.iter().map(|c| size(&c.column.0)).collect());
        let square: f64 = x.iter().zip(operator.pencil().mass_diagonal()).map(|(x, m)| m * x * x).sum();
        self.lengths.push(square.sqrt() * (1.0 + rounding(x.len() + 2)));
    }

    /// y'A y of a matrix kept by its lower triangle.
    fn form(matrix: &[Vec<f64>], y: &[f64]) -> f64 {
        let row = |(i, row): (usize, &Vec<f64>)| {
            let off: f64 = row[..i].iter().zip(y).map(|(a, y)| a * y).sum();
            y[i] * (2.0 * off + row[i] * y[i])
        };
        matrix.iter().enumerate().map(row).sum()
    }

    /// The line of x = V y, bounded as the module says.
    pub fn line(&self, y: &[f64]) -> Line {
        let k = y.len();
        let g = self.rounding + rounding(2 * k + 4);
        let size = y.iter().zip(&self.lengths).map(|(y, v)| y.abs() * v).sum::<f64>().powi(2)
            * (1.0 + rounding(2 * k + 4));
        let (stiffness, mass) = (Self::form(&self.stiffness, y), Self::form(&self.mass, y));
        let (least_mass, most_mass) = (mass - g * self.rho.1 * size, mass + g * self.rho.1 * size);
        let stiffness = stiffness - g * self.rho.0 * size;
        let (mut least, mut most) = (0.0, 0.0);
        for (j, scale) in self.scales.iter().enumerate() {
            let (mut gap, mut sizes) = (0.0, 0.0);
            for (i, y) in y.iter().enumerate() {
                gap += y * self.gaps[i][j];
                sizes += y.abs() * self.gap_sizes[i][j];
            }
            let error = 2.0 * rounding(self.gap_entries + k + 4) * sizes;
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
        let penalty = |i: usize, j: usize| -> f64 {
            self.gaps[i].iter().zip(&self.gaps[j]).zip(&self.scales).map(|((a, b), w)| w * a * b).sum()
        };
        let mut h = Mat::<f64>::zeros(k, k);
        for i in 0..k {
            for j in 0..=i {
                let value = self.stiffness[i][j] + t * penalty(i, j);
                (h[(i, j)], h[(j, i)]) = (value, value);
            }
        }
        let (_, vectors) = eigen(h);
        (0..k).map(|i| vectors[(i, k - 1)]).collect()
    }

    /// V y.
    pub fn vector(&self, y: &[f64]) -> Vec<f64> {
        combine(&self.vectors, y)
    }
}
