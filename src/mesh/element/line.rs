//! The edges of plane elements: faces only, without faces of their own.

use super::{Coordinates, Element, QuadraturePoint, Shape, quadrature, shapes};

/// A line has no faces, so nobody asks what they are.
fn self_face() -> &'static dyn Element {
    &Line2
}

/// Two-node edge.
#[derive(Debug)]
pub(super) struct Line2;

const LINE2: [Coordinates; 2] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];

impl Element for Line2 {
    fn name(&self) -> &'static str {
        "line2"
    }
    fn nodes(&self) -> &'static [Coordinates] {
        &LINE2
    }
    fn dimension(&self) -> usize {
        1
    }
    fn corners(&self) -> usize {
        2
    }
    fn shape(&self, at: Coordinates) -> Shape {
        shapes::multilinear(1, &LINE2, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::LINE_2
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[]
    }
    fn face(&self) -> &'static dyn Element {
        self_face()
    }
    fn vtk_cell(&self) -> u8 {
        3
    }
}

/// Three-node edge.
#[derive(Debug)]
pub(super) struct Line3;

const LINE3: [Coordinates; 3] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];

impl Element for Line3 {
    fn name(&self) -> &'static str {
        "line3"
    }
    fn nodes(&self) -> &'static [Coordinates] {
        &LINE3
    }
    fn dimension(&self) -> usize {
        1
    }
    fn corners(&self) -> usize {
        2
    }
    fn shape(&self, at: Coordinates) -> Shape {
        shapes::serendipity(1, &LINE3, at)
    }
    fn quadrature(&self) -> &'static [QuadraturePoint] {
        &quadrature::LINE_3
    }
    fn faces(&self) -> &'static [&'static [usize]] {
        &[]
    }
    fn face(&self) -> &'static dyn Element {
        self_face()
    }
    fn vtk_cell(&self) -> u8 {
        21
    }
}
