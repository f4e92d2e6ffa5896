//! Twenty-node hexahedron (serendipity); 3 x 3 x 3 Gauss points.

use super::{Coordinates, Element, quad8, quadrature, shapes};

const NODES: [Coordinates; 20] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

/// Twenty-node hexahedron.
pub(super) static HEX20: Element = Element {
    name: "hex20",
    dimension: 3,
    corners: 8,
    nodes: &NODES,
    shape: |at| shapes::serendipity(3, &NODES, at),
    quadrature: &quadrature::CUBE_27,
    faces: &[
        &[0, 4, 7, 3, 16, 15, 19, 11],
        &[1, 2, 6, 5, 9, 18, 13, 17],
        &[0, 1, 5, 4, 8, 17, 12, 16],
        &[3, 7, 6, 2, 19, 14, 18, 10],
        &[0, 3, 2, 1, 11, 10, 9, 8],
        &[4, 5, 6, 7, 12, 13, 14, 15],
    ],
    face: &quad8::QUAD8,
    vtk_cell: 25,
};
