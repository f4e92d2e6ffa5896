//! The edges of plane elements: faces only, without faces of their own.

use super::{Coordinates, Element, quadrature, shapes};

const NODES_2: [Coordinates; 2] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];

/// Two-node edge.
pub(super) static LINE2: Element = Element {
    name: "line2",
    dimension: 1,
    corners: 2,
    nodes: &NODES_2,
    shape: |at| shapes::multilinear(1, &NODES_2, at),
    quadrature: &quadrature::LINE_2,
    faces: &[],
    face: &LINE2,
    vtk_cell: 3,
};

const NODES_3: [Coordinates; 3] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];

/// Three-node edge.
pub(super) static LINE3: Element = Element {
    name: "line3",
    dimension: 1,
    corners: 2,
    nodes: &NODES_3,
    shape: |at| shapes::serendipity(1, &NODES_3, at),
    quadrature: &quadrature::LINE_3,
    faces: &[],
    face: &LINE3,
    vtk_cell: 21,
};
