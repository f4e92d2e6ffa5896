//! Eight-node quadrilateral (serendipity); 3 x 3 Gauss points.

use super::{Coordinates, Element, line, quadrature, shapes};

const NODES: [Coordinates; 8] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
];

/// Eight-node quadrilateral.
pub(super) static QUAD8: Element = Element {
    name: "quad8",
    dimension: 2,
    corners: 4,
    nodes: &NODES,
    shape: |at| shapes::serendipity(2, &NODES, at),
    quadrature: &quadrature::SQUARE_9,
    faces: &[&[0, 1, 4], &[1, 2, 5], &[2, 3, 6], &[3, 0, 7]],
    face: &line::LINE3,
    vtk_cell: 23,
};
