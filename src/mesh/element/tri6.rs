//! Six-node triangle; six points, degree 4.

use super::{Coordinates, Element, QuadraturePoint, Shape, line, quadrature, shapes};

/// Six-node triangle.
#[derive(Debug)]
pub(super) struct Tri6;

const NODES: [Coordinates; 6] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]];
/// The corners at the ends of each edge.
const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

impl Element for Tri6 {
    fn name(&self) -> &'static str {
        "tri6"
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
        shapes::quadratic_simplex(2, &EDGES, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::TRIANGLE_6
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[&[0, 1, 3], &[1, 2, 4], &[2, 0, 5]]
    }
    fn face(&self) -> &'static dyn Element {
        &line::Line3
    }
    fn vtk_cell(&self) -> u8 {
        22
    }
}
