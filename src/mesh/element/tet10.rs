//! Ten-node tetrahedron; 14 points, degree 5.

use super::{Coordinates, Element, QuadraturePoint, Shape, quadrature, shapes, tri6};

/// Ten-node tetrahedron.
#[derive(Debug)]
pub(super) struct Tet10;

const NODES: [Coordinates; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];
/// The corners at the ends of each edge.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

impl Element for Tet10 {
    fn name(&self) -> &'static str {
        "tet10"
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
        shapes::quadratic_simplex(3, &EDGES, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::TETRAHEDRON_14
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 8, 7], &[1, 2, 3, 5, 9, 8], &[0, 3, 2, 7, 9, 6]]
    }
    fn face(&self) -> &'static dyn Element {
        &tri6::Tri6
    }
    fn vtk_cell(&self) -> u8 {
        24
    }
}
