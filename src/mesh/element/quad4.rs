//! Four-node quadrilateral; 2 x 2 Gauss points.

use super::{Coordinates, Element, line, quadrature, shapes};

const NODES: [Coordinates; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

/// Four-node quadrilateral.
pub(super) static QUAD4: Element = Element {
    name: "quad4",
    dimension: 2,
    corners: 4,
    nodes: &NODES,
    shape: |at| shapes::multilinear(2, &NODES, at),
    quadrature: &quadrature::SQUARE_4,
    faces: &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
    face: &line::LINE2,
    vtk_cell: 9,
};
