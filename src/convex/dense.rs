//! Small symmetric matrices, of the size of the contacts, whose signs are proven.

use faer::Mat;

use super::factor::rounding;
use crate::symmetric::Cholesky;

/// A symmetric matrix A of k rows, and e with |y'(A - exact) y| <= sum e_i y_i^2 for every y.
#[derive(Debug, Clone)]
pub(super) struct Form {
    pub entries: Vec<f64>,
    pub error: Vec<f64>,
}

impl Form {
    pub fn zeros(k: usize) -> Self {
        Self { entries: vec![0.0; k * k], error: vec![0.0; k] }
    }

    pub fn size(&self) -> usize {
        self.error.len()
    }

    pub fn diagonal(&self, i: usize) -> f64 {
        self.entries[i * self.size() + i]
    }

    /// a A + b B of semidefinite A and B, to which the entries round by no more than 4 units of a A_ii + b B_ii, k times.
    pub fn combined(&self, a: f64, other: &Self, b: f64) -> Self {
        let k = self.size();
        let entries = self.entries.iter().zip(&other.entries).map(|(x, y)| a * x + b * y).collect();
        let unit = rounding(4 * k + 4);
        let error = |i: usize| {
            let size = a.abs() * self.diagonal(i).abs() + b.abs() * other.diagonal(i).abs();
            (a.abs() * self.error[i] + b.abs() * other.error[i]) * (1.0 + 4.0 * f64::EPSILON) + unit * size
        };
        let error = (0..k).map(error).collect();
        Self { entries, error }
    }

    /// y'Ay, and how far it may be off.
    pub fn along(&self, y: &[f64]) -> (f64, f64) {
        let k = self.size();
        let (mut value, mut size) = (0.0, 0.0);
        for i in 0..k {
            let row = &self.entries[i * k..(i + 1) * k];
            let image: f64 = row.iter().zip(y).map(|(a, y)| a * y).sum();
            let absolute: f64 = row.iter().zip(y).map(|(a, y)| (a * y).abs()).sum();
            value += y[i] * image;
            size += y[i].abs() * absolute;
        }
        let error: f64 = self.error.iter().zip(y).map(|(e, y)| e * y * y).sum();
        (value, error * (1.0 + rounding(k + 4)) + 2.0 * rounding(2 * k + 2) * size)
    }

    /// Whether the exact matrix is positive semidefinite for certain, with a vector of small y'Ay if a factor was found.
    ///
    /// B = D A D with D diagonal, powers of two near a_ii^(-1/2), less what e and the rounding of a factorisation may take: if a
    /// Cholesky factorisation of B - c I ends, with c the trace of B times 2 g(k + 2), B is semidefinite (Rump, BIT 46, 2006).
    pub fn definite(&self) -> Option<Definite> {
        let k = self.size();
        let scaling: Vec<f64> = (0..k).map(|i| (-0.5 * self.diagonal(i).log2()).round().exp2()).collect();
        if !scaling.iter().all(|s| s.is_normal()) {
            return None;
        }
        let trace: f64 = (0..k).map(|i| self.diagonal(i) * scaling[i] * scaling[i]).sum();
        let shift = 2.0 * rounding(k + 2) * trace;
        let entry = |i: usize, j: usize| {
            let value = self.entries[i * k + j] * scaling[i] * scaling[j];
            if i == j { value - (self.error[i] * scaling[i] * scaling[i] + shift) * ABOVE } else { value }
        };
        let factor = Cholesky::new(Mat::from_fn(k, k, entry))?;
        Some(Definite { factor, scaling })
    }
}

/// Three roundings upwards.
const ABOVE: f64 = 1.0 + 8.0 * f64::EPSILON;

/// The factor of a definite form.
pub(super) struct Definite {
    factor: Cholesky,
    scaling: Vec<f64>,
}

impl Definite {
    /// A vector y of nearly the smallest y'Ay over sum m_ii y_i^2, M of positive diagonal: some steps of inverse iteration.
    pub fn least(&self, start: &[f64], measure: &Form) -> Vec<f64> {
        let k = start.len();
        let mut y = start.to_vec();
        for _ in 0..STEPS {
            (0..k).for_each(|i| y[i] *= measure.diagonal(i) * self.scaling[i]);
            self.factor.solve(&mut y);
            (0..k).for_each(|i| y[i] *= self.scaling[i]);
            let length = (0..k).map(|i| y[i] * y[i] * measure.diagonal(i)).sum::<f64>().sqrt();
            y.iter_mut().for_each(|y| *y /= length);
        }
        y
    }
}

/// Steps of inverse iteration; each gains the ratio of the two smallest quotients, and next to a limit one is nearly 0.
const STEPS: usize = 6;
