//! Four-node quadrilateral; 2 x 2 Gauss points.

use super::{Coordinates, Element, QuadraturePoint, Shape, line, quadrature, shapes};

/// Four-node quadrilateral.
#[derive(Debug)]
pub(super) struct Quad4;

const NODES: [Coordinates; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

impl Element for Quad4 {
    fn name(&self) -> &'static str {
        "quad4"
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
        shapes::multilinear(2, &NODES, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::SQUARE_4
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]]
    }
    fn face(&self) -> &'static dyn Element {
        &line::Line2
    }
    fn vtk_cell(&self) -> u8 {
        9
    }
}
