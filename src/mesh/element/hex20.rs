//! Twenty-node hexahedron (serendipity); 3 x 3 x 3 Gauss points.

use super::{Coordinates, Element, QuadraturePoint, Shape, quad8, quadrature, shapes};

/// Twenty-node hexahedron.
#[derive(Debug)]
pub(super) struct Hex20;

const NODES: [Coordinates; 20] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

impl Element for Hex20 {
    fn name(&self) -> &'static str {
        "hex20"
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
        shapes::serendipity(3, &NODES, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::CUBE_27
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[
            &[0, 4, 7, 3, 16, 15, 19, 11],
            &[1, 2, 6, 5, 9, 18, 13, 17],
            &[0, 1, 5, 4, 8, 17, 12, 16],
            &[3, 7, 6, 2, 19, 14, 18, 10],
            &[0, 3, 2, 1, 11, 10, 9, 8],
            &[4, 5, 6, 7, 12, 13, 14, 15],
        ]
    }
    fn face(&self) -> &'static dyn Element {
        &quad8::Quad8
    }
    fn vtk_cell(&self) -> u8 {
        25
    }
}
