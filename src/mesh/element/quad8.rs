//! Eight-node quadrilateral (serendipity); 3 x 3 Gauss points.

use super::{Coordinates, Element, QuadraturePoint, Shape, line, quadrature, shapes};

/// Eight-node quadrilateral.
#[derive(Debug)]
pub(super) struct Quad8;

const NODES: [Coordinates; 8] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
];

impl Element for Quad8 {
    fn name(&self) -> &'static str {
        "quad8"
    }
    fn nodes(&self) -> &'static [Coordinates] {
        &NODES
    }
    fn dimension(&self) -> usize {
        2
    }
    fn corners(&self) -> usize {
        4
    }
    fn shape(&self, at: Coordinates) -> Shape {
        shapes::serendipity(2, &NODES, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::SQUARE_9
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[&[0, 1, 4], &[1, 2, 5], &[2, 3, 6], &[3, 0, 7]]
    }
    fn face(&self) -> &'static dyn Element {
        &line::Line3
    }
    fn vtk_cell(&self) -> u8 {
        23
    }
}
