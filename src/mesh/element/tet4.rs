//! Four-node tetrahedron; four points, degree 2.

use super::{Coordinates, Element, quadrature, shapes, tri3};

const NODES: [Coordinates; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Four-node tetrahedron.
pub(super) static TET4: Element = Element {
    name: "tet4",
    dimension: 3,
    corners: 4,
    nodes: &NODES,
    shape: |at| shapes::linear_simplex(3, at),
    quadrature: &quadrature::TETRAHEDRON_4,
    faces: &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
    face: &tri3::TRI3,
    vtk_cell: 10,
};
