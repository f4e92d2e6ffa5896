//! Three-node triangle; three points, degree 2.

use super::{Coordinates, Element, QuadraturePoint, Shape, line, quadrature, shapes};

/// Three-node triangle.
#[derive(Debug)]
pub(super) struct Tri3;

const NODES: [Coordinates; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

impl Element for Tri3 {
    fn name(&self) -> &'static str {
        "tri3"
    }
    fn nodes(&self) -> &'static [Coordinates] {
        &NODES
    }
    fn dimension(&self) -> usize {
        2
    }
    fn corners(&self) -> usize {
        3
    }
    fn shape(&self, at: Coordinates) -> Shape {
        shapes::linear_simplex(2, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::TRIANGLE_3
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[&[0, 1], &[1, 2], &[2, 0]]
    }
    fn face(&self) -> &'static dyn Element {
        &line::Line2
    }
    fn vtk_cell(&self) -> u8 {
        5
    }
}
