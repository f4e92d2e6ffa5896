//! Euler-Bernoulli beams: cubic elements of two nodes, deflection and rotation each, consistent mass.

use bipenalty::error::Refusal;
use bipenalty::fem::{FiniteElement, assemble_elements};
use bipenalty::pencil::{Gap, Pencil};
use bipenalty::sparse::SparseVector;

/// An element of length h, m, with E I and rho A of 1; unknowns by pairs from `first` on.
struct Beam {
    first: u32,
    h: f64,
}

impl FiniteElement for Beam {
    fn unknowns(&self) -> Vec<u32> {
        (self.first..self.first + 4).collect()
    }

    fn matrices(&self) -> (Vec<f64>, Vec<f64>) {
        let h = self.h;
        let k =
            [12.0, 6.0 * h, -12.0, 6.0 * h, 4.0 * h * h, -6.0 * h, 2.0 * h * h, 12.0, -6.0 * h, 4.0 * h * h];
        let m = [
            156.0,
            22.0 * h,
            54.0,
            -13.0 * h,
            4.0 * h * h,
            13.0 * h,
            -3.0 * h * h,
            156.0,
            -22.0 * h,
            4.0 * h * h,
        ];
        // The upper halves by rows: entry (i, j), i <= j, at i (7 - i)/2 + j.
        let full = |half: [f64; 10], factor: f64| {
            let at = |i: usize, j: usize| factor * half[i.min(j) * (7 - i.min(j)) / 2 + i.max(j)];
            (0..16).map(|e| at(e / 4, e % 4)).collect()
        };
        (full(k, 1.0 / (h * h * h)), full(m, h / 420.0))
    }
}

/// A beam of unit length that is free at one end and held by springs at the other, with a stop half way and one at its tip.
pub fn cantilever(elements: u32) -> Result<Pencil, Refusal> {
    let h = 1.0 / f64::from(elements);
    let beams: Vec<Beam> = (0..elements).map(|e| Beam { first: 2 * e, h }).collect();
    let all: Vec<&dyn FiniteElement> = beams.iter().map(|beam| beam as &dyn FiniteElement).collect();
    let stop = |node: u32| Gap {
        column: SparseVector(vec![(2 * node, 1.0)]),
        scale: 12.0 / h.powi(3),
        initial: 0.0,
    };
    assemble_elements(2 * elements as usize + 2, &all, vec![stop(elements / 2), stop(elements)], None)
}
