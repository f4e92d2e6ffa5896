//! The sampled vectors themselves: M-orthonormal, whole or one part of each.

use super::operator::Operator;
use super::pencil::MeshPencil;
use super::span::{Row, Sizes, Span};
use super::vectors::{combine, dot, project, scale, subtract};

/// Sampled vectors, or what lies of them on one part of the unknowns.
#[derive(Debug, Clone, Default)]
pub struct Vectors(Vec<Vec<f64>>);

impl Vectors {
    /// Adds a vector, orthonormalised, and gives its forms with all vectors; none if it lies in their span already.
    ///
    /// `sum` adds up numbers over all parts, in place; of a whole pencil it does nothing. It must give every part the same
    /// bits, or an unknown that two parts share would have two values. `unknowns` counts those of all parts. The gaps of
    /// the row are those of this part alone.
    pub fn add(
        &mut self,
        pencil: &MeshPencil,
        x: &[f64],
        unknowns: usize,
        sum: &mut dyn FnMut(&mut [f64]),
    ) -> Option<Row> {
        let (mut x, mut image) = (x.to_vec(), vec![0.0; x.len()]);
        let length = |x: &[f64], image: &mut [f64], sum: &mut dyn FnMut(&mut [f64])| {
            pencil.multiply_mass(x, image);
            let mut square = [dot(x, image)];
            sum(&mut square);
            square[0].sqrt()
        };
        let whole = length(&x, &mut image, sum);
        scale(1.0 / whole, &mut x);
        for _ in 0..2 {
            pencil.multiply_mass(&x, &mut image);
            let mut shares = project(&self.0, &image);
            sum(&mut shares);
            subtract(&self.0, &shares, &mut x);
            // What is left of a vector of the span is rounding alone, or nothing.
            let left = length(&x, &mut image, sum);
            if left.is_nan() || left <= 1e2 * f64::EPSILON * self.0.len() as f64 || self.0.len() == unknowns {
                return None;
            }
            scale(1.0 / left, &mut x);
        }
        self.0.push(x);
        Some(self.row(pencil, sum))
    }

    /// The forms of the last vector.
    fn row(&self, pencil: &MeshPencil, sum: &mut dyn FnMut(&mut [f64])) -> Row {
        let x = &self.0[self.0.len() - 1];
        let mut image = vec![0.0; x.len()];
        pencil.multiply_mass(x, &mut image);
        let mass = project(&self.0, &image);
        pencil.multiply(1.0, 0.0, x, &mut image);
        let stiffness = project(&self.0, &image);
        let square: f64 = x.iter().zip(pencil.mass_diagonal()).map(|(x, m)| m * x * x).sum();
        let mut all = [&mass[..], &stiffness, &[square]].concat();
        sum(&mut all);
        let contacts = pencil.contacts();
        let size = |z: &[(u32, f64)]| z.iter().map(|(i, z)| (z * x[*i as usize]).abs()).sum();
        let k = self.0.len();
        Row {
            mass: all[..k].to_vec(),
            stiffness: all[k..2 * k].to_vec(),
            gaps: contacts.iter().map(|c| c.column.dot(x)).collect(),
            gap_sizes: contacts.iter().map(|c| size(&c.column.0)).collect(),
            square: all[2 * k],
        }
    }

    /// V y.
    pub fn combine(&self, y: &[f64]) -> Vec<f64> {
        combine(&self.0, y)
    }
}

/// The span of all sampled vectors, on one machine.
#[derive(Debug, Clone)]
pub struct Subspace {
    vectors: Vectors,
    span: Span,
}

impl Subspace {
    /// The empty span of a pencil.
    pub fn new(pencil: &MeshPencil) -> Self {
        let scales = pencil.contacts().iter().map(|c| c.scale).collect();
        Self { vectors: Vectors::default(), span: Span::new(Sizes::of(pencil), scales) }
    }

    /// The forms of the vectors.
    pub fn span(&self) -> &Span {
        &self.span
    }

    /// Adds a vector to the span, unless it lies in it already.
    pub fn add(&mut self, operator: &Operator, x: &[f64]) {
        let pencil = operator.pencil();
        if let Some(row) = self.vectors.add(pencil, x, pencil.size(), &mut |_| ()) {
            operator.count();
            self.span.push(row);
        }
    }

    /// V y.
    pub fn vector(&self, y: &[f64]) -> Vec<f64> {
        self.vectors.combine(y)
    }
}
