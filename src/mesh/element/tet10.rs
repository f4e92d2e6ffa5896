//! Ten-node tetrahedron; 14 points, degree 5.

use super::{Coordinates, Element, quadrature, shapes, tri6};

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

/// Ten-node tetrahedron.
pub(super) static TET10: Element = Element {
    name: "tet10",
    dimension: 3,
    corners: 4,
    nodes: &NODES,
    shape: |at| shapes::quadratic_simplex(3, &EDGES, at),
    quadrature: &quadrature::TETRAHEDRON_14,
    faces: &[&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 8, 7], &[1, 2, 3, 5, 9, 8], &[0, 3, 2, 7, 9, 6]],
    face: &tri6::TRI6,
    vtk_cell: 24,
};
