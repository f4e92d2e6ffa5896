//! Eight-node hexahedron; 2 x 2 x 2 Gauss points.

use super::{Coordinates, Element, quad4, quadrature, shapes};

const NODES: [Coordinates; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Eight-node hexahedron.
pub(super) static HEX8: Element = Element {
    name: "hex8",
    dimension: 3,
    corners: 8,
    nodes: &NODES,
    shape: |at| shapes::multilinear(3, &NODES, at),
    quadrature: &quadrature::CUBE_8,
    faces: &[&[0, 4, 7, 3], &[1, 2, 6, 5], &[0, 1, 5, 4], &[3, 7, 6, 2], &[0, 3, 2, 1], &[4, 5, 6, 7]],
    face: &quad4::QUAD4,
    vtk_cell: 12,
};
