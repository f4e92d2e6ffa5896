//! Six-node triangle; six points, degree 4.

use super::{Coordinates, Element, line, quadrature, shapes};

const NODES: [Coordinates; 6] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]];
/// The corners at the ends of each edge.
const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Six-node triangle.
pub(super) static TRI6: Element = Element {
    name: "tri6",
    dimension: 2,
    corners: 3,
    nodes: &NODES,
    shape: |at| shapes::quadratic_simplex(2, &EDGES, at),
    quadrature: &quadrature::TRIANGLE_6,
    faces: &[&[0, 1, 3], &[1, 2, 4], &[2, 0, 5]],
    face: &line::LINE3,
    vtk_cell: 22,
};
