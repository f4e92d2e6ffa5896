//! M^-1 (a K + t P), applied to vectors.

use std::cell::Cell;
use std::sync::Arc;

use super::factor::MassFactor;
use super::pencil::MeshPencil;
use super::vectors::{dot, scale};
use crate::error::Refusal;
use crate::interrupt;

/// The pencil with a way to apply M^-1: by its diagonal, or by a sparse Cholesky factor of M.
///
/// A factor is taken rather than an inner iteration: two triangular solves cost a few products, an iteration to the last
/// digits of a consistent mass matrix 30 to 70, and a Lanczos basis needs all digits.
#[derive(Debug, Clone)]
pub struct Operator {
    pencil: MeshPencil,
    inverse: Option<Arc<MassFactor>>,
    products: Cell<usize>,
}

impl Operator {
    /// The operator of a pencil; the factor of M may take `allowed` bytes.
    ///
    /// # Errors
    /// M is not positive definite, or its factor needs more memory.
    pub fn new(pencil: &MeshPencil, allowed: usize) -> Result<Self, Refusal> {
        let refusal = || {
            let allowed = format!("a positive definite matrix whose factor takes at most {allowed} bytes");
            Refusal::new("mass matrix", "a matrix that could not be factorised", allowed)
        };
        let inverse = if pencil.mass().is_diagonal() {
            None
        } else {
            Some(Arc::new(MassFactor::new(pencil, allowed).ok_or_else(refusal)?))
        };
        Ok(Self { pencil: pencil.clone(), inverse, products: Cell::new(0) })
    }

    /// The pencil.
    pub fn pencil(&self) -> &MeshPencil {
        &self.pencil
    }

    /// How many products with K were made so far.
    pub fn products(&self) -> usize {
        self.products.get()
    }

    /// Counts a product.
    pub(super) fn count(&self) {
        self.products.set(self.products.get() + 1);
    }

    /// y = (a K + t P) x.
    pub(super) fn multiply(&self, (a, t): (f64, f64), x: &[f64], y: &mut [f64]) {
        interrupt::look();
        self.count();
        self.pencil.multiply(a, t, x, y);
    }

    /// y -= c M x.
    pub(super) fn take_mass(&self, c: f64, x: &[f64], y: &mut [f64]) {
        if c == 0.0 {
            return;
        }
        if self.inverse.is_none() {
            let terms = y.iter_mut().zip(x).zip(self.pencil.mass_diagonal());
            terms.for_each(|((y, x), m)| *y -= c * m * x);
        } else {
            let mut image = vec![0.0; x.len()];
            self.pencil.multiply_mass(x, &mut image);
            y.iter_mut().zip(&image).for_each(|(y, image)| *y -= c * image);
        }
    }

    /// x = M^-1 x.
    pub(super) fn solve_mass(&self, x: &mut [f64]) {
        match &self.inverse {
            Some(factor) => factor.solve(x),
            None => x.iter_mut().zip(self.pencil.mass_diagonal()).for_each(|(x, m)| *x /= m),
        }
    }

    /// x scaled to x'Mx = 1; its length before.
    pub(super) fn normalise(&self, x: &mut [f64]) -> f64 {
        let mut y = vec![0.0; x.len()];
        self.pencil.multiply_mass(x, &mut y);
        let length = dot(x, &y).sqrt();
        scale(1.0 / length, x);
        length
    }

    /// Takes from x its part in the range of M^-1 Z: Z'x = 0 afterwards, and x is the M-nearest such vector.
    ///
    /// Conjugate gradients on Z'M^-1 Z y = Z'x, of the size of the contacts; dependent contacts do no harm.
    pub(super) fn close_gaps(&self, x: &mut [f64]) {
        let contacts = self.pencil.contacts();
        let root: Vec<f64> = contacts.iter().map(|c| c.scale.sqrt()).collect();
        let gaps = |x: &[f64]| -> Vec<f64> {
            contacts.iter().zip(&root).map(|(c, w)| w * c.column.dot(x)).collect()
        };
        let spread = |y: &[f64]| {
            let mut x = vec![0.0; self.pencil.size()];
            contacts.iter().zip(&root).zip(y).for_each(|((c, w), y)| c.column.add_to(w * y, &mut x));
            self.solve_mass(&mut x);
            x
        };
        // Twice: the second time takes what rounding left of the first.
        for _ in 0..2 {
            let mut residual = gaps(x);
            let mut direction = residual.clone();
            let mut square = dot(&residual, &residual);
            let goal = square * f64::EPSILON.powi(2);
            for _ in 0..2 * contacts.len().min(200) {
                if square <= goal {
                    break;
                }
                let step = spread(&direction);
                let image = gaps(&step);
                let length = square / dot(&direction, &image);
                if !length.is_finite() {
                    break;
                }
                x.iter_mut().zip(&step).for_each(|(x, step)| *x -= length * step);
                residual.iter_mut().zip(&image).for_each(|(r, image)| *r -= length * image);
                let next = dot(&residual, &residual);
                direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + next / square * *d);
                square = next;
            }
        }
    }
}
