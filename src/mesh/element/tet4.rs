//! Four-node tetrahedron; four points, degree 2.

use super::{Coordinates, Element, QuadraturePoint, Shape, quadrature, shapes, tri3};

/// Four-node tetrahedron.
#[derive(Debug)]
pub(super) struct Tet4;

const NODES: [Coordinates; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Element for Tet4 {
    fn name(&self) -> &'static str {
        "tet4"
    }
    fn nodes(&self) -> &'static [Coordinates] {
        &NODES
    }
    fn dimension(&self) -> usize {
        3
    }
    fn corners(&self) -> usize {
        4
    }
    fn shape(&self, at: Coordinates) -> Shape {
        shapes::linear_simplex(3, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::TETRAHEDRON_4
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]]
    }
    fn face(&self) -> &'static dyn Element {
        &tri3::Tri3
    }
    fn vtk_cell(&self) -> u8 {
        10
    }
}
