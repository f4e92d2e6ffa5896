//! Eight-node hexahedron; 2 x 2 x 2 Gauss points.

use super::{Coordinates, Element, QuadraturePoint, Shape, quad4, quadrature, shapes};

/// Eight-node hexahedron.
#[derive(Debug)]
pub(super) struct Hex8;

const NODES: [Coordinates; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

impl Element for Hex8 {
    fn name(&self) -> &'static str {
        "hex8"
    }
    fn nodes(&self) -> &'static [Coordinates] {
        &NODES
    }
    fn dimension(&self) -> usize {
        3
    }
    fn corners(&self) -> usize {
        8
    }
    fn shape(&self, at: Coordinates) -> Shape {
        shapes::multilinear(3, &NODES, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::CUBE_8
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[&[0, 4, 7, 3], &[1, 2, 6, 5], &[0, 1, 5, 4], &[3, 7, 6, 2], &[0, 3, 2, 1], &[4, 5, 6, 7]]
    }
    fn face(&self) -> &'static dyn Element {
        &quad4::Quad4
    }
    fn vtk_cell(&self) -> u8 {
        12
    }
}
