//! Whether a step limit lies below a number, decided in double-double arithmetic.

use bipenalty::convex::{Asked, MeshPencil};
use bipenalty::pencil::Matrix;

use crate::definite::is_definite;
use crate::double_double::Dd;

/// Relative error of a double-double operation at most.
const UNIT: f64 = 16.0 / (1_u128 << 106) as f64;

fn dense(matrix: &Matrix) -> Vec<Vec<Dd>> {
    let n = matrix.size();
    let mut a = vec![vec![Dd::from(0.0); n]; n];
    (0..n).for_each(|i| matrix.row(i).for_each(|(j, value)| a[i][j] = Dd::from(value)));
    a
}

/// K, M and P of a small pencil, whole, in double-double.
pub struct Exact {
    stiffness: Vec<Vec<Dd>>,
    mass: Vec<Vec<Dd>>,
    penalty: Vec<Vec<Dd>>,
}

impl Exact {
    pub fn new(pencil: &MeshPencil) -> Self {
        let n = pencil.size();
        let mut penalty = vec![vec![Dd::from(0.0); n]; n];
        for contact in pencil.contacts() {
            for (i, y) in &contact.column.0 {
                for (j, z) in &contact.column.0 {
                    let product = Dd::from(contact.scale) * Dd::from(*y) * Dd::from(*z);
                    let entry = &mut penalty[*i as usize][*j as usize];
                    *entry = *entry + product;
                }
            }
        }
        Self { stiffness: dense(pencil.stiffness()), mass: dense(pencil.mass()), penalty }
    }

    /// Whether l (M + m P) - (K + s P) is positive definite: l above every eigenvalue. The pivots of an elimination.
    pub fn above(&self, l: f64, asked: Asked) -> bool {
        let n = self.mass.len();
        let (l, c) = (Dd::from(l), Dd::from(l) * Dd::from(asked.mass) - Dd::from(asked.stiffness));
        let entry = |i: usize, j: usize| l * self.mass[i][j] + c * self.penalty[i][j] - self.stiffness[i][j];
        is_definite((0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect())
    }

    /// What [`Exact::above`] may be wrong by, relative to l: n^2 roundings of the largest of the terms, whose sizes in M are l,
    /// s mu and l m mu.
    pub fn error(&self, l: f64, mu: f64, asked: Asked) -> f64 {
        let n = self.mass.len() as f64;
        let c = l.mul_add(asked.mass, -asked.stiffness).abs();
        let rounded = f64::EPSILON * f64::EPSILON * (asked.stiffness + l * asked.mass);
        n * n * UNIT * (2.0 + (c + rounded) * mu / l)
    }
}
