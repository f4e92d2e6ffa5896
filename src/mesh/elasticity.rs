//! Stiffness and mass of an element of linear elasticity.
//!
//! ```text
//! K_ab = t int lambda g_a g_b' + mu g_b g_a' + mu (g_a . g_b) I dV      g_a = grad N_a, a d x d block for each pair of nodes
//! M_ab = rho t int N_a N_b dV                                           the same for each direction
//! lambda = E nu/((1+nu)(1-2nu))     mu = E/(2(1+nu))     plane stress: 2 lambda mu/(lambda + 2 mu) for lambda
//! ```

use super::element::{Coordinates, Element, MOST_NODES};
use crate::error::Refusal;

/// What the third direction of a plane model does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Plane {
    /// No strain across the plane.
    Strain,
    /// No stress across the plane.
    Stress,
}

/// An isotropic linear elastic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Young's modulus E, Pa, positive.
    pub youngs_modulus: f64,
    /// Poisson's ratio nu, in (-1, 1/2).
    pub poissons_ratio: f64,
    /// Density rho, kg/m^3, positive.
    pub density: f64,
    /// Thickness t, m, of a plane model; 1 in space.
    pub thickness: f64,
}

impl Material {
    /// The Lamé constants (lambda, mu), Pa, lambda of plane stress as above; `plane` is `None` in space.
    pub(super) fn lame(&self, plane: Option<Plane>) -> (f64, f64) {
        let (e, nu) = (self.youngs_modulus, self.poissons_ratio);
        let mu = e / (2.0 * (1.0 + nu));
        let lambda = match plane {
            Some(Plane::Stress) => e * nu / (1.0 - nu * nu),
            Some(Plane::Strain) | None => e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        };
        (lambda, mu)
    }
}

/// How a consistent element mass becomes diagonal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lumping {
    /// The sum of each row: first order only.
    RowSums,
    /// The diagonal of the consistent mass, scaled to the element's mass (Hinton, Rock, Zienkiewicz, Earthquake Eng. Struct. Dyn. 4, 1976).
    ScaledDiagonal,
}

impl Lumping {
    /// Row sums for first order, the scaled diagonal for second order.
    pub fn of(element: &Element) -> Self {
        if element.order() == 1 { Self::RowSums } else { Self::ScaledDiagonal }
    }
}

/// The shape functions of an element in its place, at one quadrature point.
struct Sample {
    values: [f64; MOST_NODES],
    gradients: [Coordinates; MOST_NODES],
    /// Weight times Jacobian determinant, m^d.
    volume: f64,
}

/// The determinant and inverse of dx_i/dxi_j; in the plane the third row and column are those of the identity.
pub(super) fn inverse(j: &[Coordinates; 3]) -> (f64, [Coordinates; 3]) {
    let minor = |a: usize, b: usize, c: usize, d: usize| j[a][c] * j[b][d] - j[a][d] * j[b][c];
    let determinant = j[0][0] * minor(1, 2, 1, 2) - j[0][1] * minor(1, 2, 0, 2) + j[0][2] * minor(1, 2, 0, 1);
    let adjugate = [
        [minor(1, 2, 1, 2), -minor(0, 2, 1, 2), minor(0, 1, 1, 2)],
        [-minor(1, 2, 0, 2), minor(0, 2, 0, 2), -minor(0, 1, 0, 2)],
        [minor(1, 2, 0, 1), -minor(0, 2, 0, 1), minor(0, 1, 0, 1)],
    ];
    (determinant, adjugate.map(|row| row.map(|entry| entry / determinant)))
}

fn samples(element: &Element, nodes: &[Coordinates]) -> Result<Vec<Sample>, Refusal> {
    let dimension = element.dimension;
    let mut samples = Vec::with_capacity(element.quadrature.len());
    for point in element.quadrature {
        let shape = (element.shape)(point.at);
        let mut jacobian = [[0.0; 3], [0.0; 3], [0.0; 3]];
        (dimension..3).for_each(|i| jacobian[i][i] = 1.0);
        for (x, gradient) in nodes.iter().zip(&shape.gradients) {
            for i in 0..dimension {
                (0..dimension).for_each(|j| jacobian[i][j] += x[i] * gradient[j]);
            }
        }
        let (determinant, inverse) = inverse(&jacobian);
        // Also refuses NaN.
        if !(determinant > 0.0 && determinant.is_finite()) {
            return Err(Refusal::new(
                format!("Jacobian determinant of the {}", element.name),
                determinant,
                "a positive one: nodes in the order of the element type (counter-clockwise in the plane), no collapsed or folded element",
            ));
        }
        let mut gradients = [[0.0; 3]; MOST_NODES];
        for (g, reference) in gradients.iter_mut().zip(&shape.gradients).take(nodes.len()) {
            for (i, g) in g.iter_mut().enumerate().take(dimension) {
                *g = (0..dimension).map(|j| reference[j] * inverse[j][i]).sum();
            }
        }
        samples.push(Sample { values: shape.values, gradients, volume: point.weight * determinant });
    }
    Ok(samples)
}

/// K_e, N/m, and the consistent mass m_ab, kg, of one direction, both by rows.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementMatrices {
    /// K_e: (nodes d)^2 entries; degree of freedom `node d + direction`.
    pub stiffness: Vec<f64>,
    /// The mass between nodes: nodes^2 entries, the same in each direction.
    pub mass: Vec<f64>,
}

impl ElementMatrices {
    /// The matrices of `element` with its nodes at `nodes`, m; `plane` is `None` in space.
    ///
    /// # Errors
    /// A Jacobian determinant that is not positive at a quadrature point.
    pub fn new(
        element: &Element,
        nodes: &[Coordinates],
        material: &Material,
        plane: Option<Plane>,
    ) -> Result<Self, Refusal> {
        let (n, d) = (nodes.len(), element.dimension);
        let size = n * d;
        let (lambda, mu) = material.lame(plane);
        let (mut stiffness, mut mass) = (vec![0.0; size * size], vec![0.0; n * n]);
        for sample in samples(element, nodes)? {
            let volume = material.thickness * sample.volume;
            match d {
                2 => add_stiffness::<2>(&mut stiffness, &sample, n, lambda * volume, mu * volume),
                _ => add_stiffness::<3>(&mut stiffness, &sample, n, lambda * volume, mu * volume),
            }
            for a in 0..n {
                let inertia = material.density * volume * sample.values[a];
                let row = &mut mass[a * n + a..(a + 1) * n];
                row.iter_mut().zip(&sample.values[a..]).for_each(|(m, value)| *m += inertia * value);
            }
        }
        mirror(&mut stiffness, size);
        mirror(&mut mass, n);
        Ok(Self { stiffness, mass })
    }

    /// The diagonal of the lumped mass, kg a node.
    ///
    /// # Errors
    /// Row sums of a second-order element, which may be negative.
    pub fn lumped(&self, element: &Element, lumping: Lumping) -> Result<Vec<f64>, Refusal> {
        if lumping == Lumping::RowSums && element.order() > 1 {
            let allowed = "the scaled diagonal for second order, since row sums may be negative";
            return Err(Refusal::new("lumping", format!("row sums of {}", element.name), allowed));
        }
        Ok(self.diagonal(element, lumping))
    }

    fn diagonal(&self, element: &Element, lumping: Lumping) -> Vec<f64> {
        let n = element.nodes.len();
        if lumping == Lumping::RowSums {
            return self.mass.chunks(n).map(|row| row.iter().sum()).collect();
        }
        let total: f64 = self.mass.iter().sum();
        let trace: f64 = (0..n).map(|a| self.mass[a * n + a]).sum();
        (0..n).map(|a| self.mass[a * n + a] * (total / trace)).collect()
    }

    /// (1 - gamma) consistent + gamma lumped, by rows, kg; the same in each direction.
    pub fn mass(&self, element: &Element, gamma: f64) -> Vec<f64> {
        let n = element.nodes.len();
        let mut mass: Vec<f64> = self.mass.iter().map(|m| (1.0 - gamma) * m).collect();
        let lumped = self.diagonal(element, Lumping::of(element));
        lumped.iter().enumerate().for_each(|(a, m)| mass[a * n + a] += gamma * m);
        mass
    }
}

/// The mean stress of an element with its nodes at `nodes` (m) and displacements u (m, `node d + direction`), Pa: xx, yy, zz,
/// xy, yz, xz. With plane strain zz is what holds the plane, with plane stress 0.
///
/// # Errors
/// As [`ElementMatrices::new`].
pub fn mean_stress(
    element: &Element,
    nodes: &[Coordinates],
    material: &Material,
    plane: Option<Plane>,
    u: &[f64],
) -> Result<[f64; 6], Refusal> {
    let d = element.dimension;
    let (lambda, mu) = material.lame(plane);
    let (mut gradient, mut volume) = ([[0.0; 3]; 3], 0.0);
    for sample in samples(element, nodes)? {
        volume += sample.volume;
        for (a, g) in sample.gradients[..nodes.len()].iter().enumerate() {
            for i in 0..d {
                (0..d).for_each(|j| gradient[i][j] += sample.volume * u[a * d + i] * g[j]);
            }
        }
    }
    let strain = |i: usize, j: usize| 0.5 * (gradient[i][j] + gradient[j][i]) / volume;
    let trace: f64 = (0..d).map(|i| strain(i, i)).sum();
    let across = match plane {
        Some(Plane::Stress) => 0.0,
        Some(Plane::Strain) => lambda * trace,
        None => lambda * trace + 2.0 * mu * strain(2, 2),
    };
    let along = |i: usize| lambda * trace + 2.0 * mu * strain(i, i);
    let shear = |i: usize, j: usize| 2.0 * mu * strain(i, j);
    Ok([along(0), along(1), across, shear(0, 1), shear(1, 2), shear(0, 2)])
}

/// Adds one quadrature point to the blocks (a, b) with a <= b.
fn add_stiffness<const D: usize>(stiffness: &mut [f64], sample: &Sample, n: usize, lambda: f64, mu: f64) {
    for (a, ga) in sample.gradients[..n].iter().enumerate() {
        for (b, gb) in sample.gradients[..n].iter().enumerate().skip(a) {
            let shear = mu * (0..D).map(|i| ga[i] * gb[i]).sum::<f64>();
            for i in 0..D {
                let row = &mut stiffness[(a * D + i) * n * D + b * D..][..D];
                for j in 0..D {
                    row[j] += lambda * ga[i] * gb[j] + mu * ga[j] * gb[i];
                }
                row[i] += shear;
            }
        }
    }
}

/// Copies the upper triangle to the lower one, so that the matrix is symmetric to the last bit.
fn mirror(matrix: &mut [f64], size: usize) {
    for row in 1..size {
        for column in 0..row {
            matrix[row * size + column] = matrix[column * size + row];
        }
    }
}
