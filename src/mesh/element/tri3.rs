//! Three-node triangle; three points, degree 2.

use super::{Coordinates, Element, line, quadrature, shapes};

const NODES: [Coordinates; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Three-node triangle.
pub(super) static TRI3: Element = Element {
    name: "tri3",
    dimension: 2,
    corners: 3,
    nodes: &NODES,
    shape: |at| shapes::linear_simplex(2, at),
    quadrature: &quadrature::TRIANGLE_3,
    faces: &[&[0, 1], &[1, 2], &[2, 0]],
    face: &line::LINE2,
    vtk_cell: 5,
};
