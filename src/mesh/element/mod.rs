//! Elements of the plane and of space: shape functions, quadrature and faces; one element, one file.
//!
//! The nodes are numbered as VTK does: corners first, then one node an edge. Quadrature is full: the rule integrates the
//! consistent mass of an affine element exactly, and its stiffness with it, so that no zero-energy mode but the rigid ones
//! appears; all weights are positive, so that the consistent mass is definite wherever the Jacobian is positive.

mod hex20;
mod hex8;
mod line;
mod quad4;
mod quad8;
pub mod quadrature;
mod shapes;
mod tet10;
mod tet4;
mod tri3;
mod tri6;

pub use quadrature::QuadraturePoint;

/// A place, m, or a reference coordinate; the third entry is 0 in the plane.
pub type Coordinates = [f64; 3];

/// The most nodes of an element.
pub const MOST_NODES: usize = 20;

/// Shape functions and their reference gradients at one point; entries beyond the element's nodes are 0.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// N_a.
    pub values: [f64; MOST_NODES],
    /// dN_a/dxi_i.
    pub gradients: [Coordinates; MOST_NODES],
}

/// A reference element.
#[derive(Debug)]
pub struct Element {
    /// What scene files call it.
    pub name: &'static str,
    /// Number of reference coordinates.
    pub dimension: usize,
    /// Number of corners.
    pub corners: usize,
    /// Reference coordinates of its nodes, corners first.
    pub nodes: &'static [Coordinates],
    /// N and dN/dxi at reference coordinates.
    pub shape: fn(Coordinates) -> Shape,
    /// The quadrature of stiffness and mass.
    pub quadrature: &'static [QuadraturePoint],
    /// Local nodes of each face, outward normal by the right hand (in the plane: the body lies to the left).
    pub faces: &'static [&'static [usize]],
    /// The element that each face is, the element itself where it has none.
    pub face: &'static Element,
    /// Number of this cell in VTK files.
    pub vtk_cell: u8,
}

impl Element {
    /// 1 without nodes on the edges, 2 with them.
    pub fn order(&self) -> usize {
        if self.nodes.len() > self.corners { 2 } else { 1 }
    }

    /// Whether reference coordinates are barycentric, xi_i >= 0 and sum <= 1, instead of in [-1, 1].
    pub fn is_simplex(&self) -> bool {
        self.nodes[0] == [0.0; 3] && self.dimension > 1
    }

    /// The corners at the two ends of the edge on which node `node` lies; `None` for a corner.
    pub fn edge_of(&self, node: usize) -> Option<[usize; 2]> {
        let (x, corners) = (self.nodes, self.corners);
        let middle = |a: usize, b: usize| (0..3).all(|i| x[a][i] + x[b][i] == 2.0 * x[node][i]);
        let pairs = (0..corners).flat_map(|a| (a + 1..corners).map(move |b| [a, b]));
        if node < corners { None } else { pairs.into_iter().find(|[a, b]| middle(*a, *b)) }
    }
}

/// The elements that a mesh may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Three-node triangle.
    Tri3,
    /// Six-node triangle.
    Tri6,
    /// Four-node quadrilateral.
    Quad4,
    /// Eight-node quadrilateral (serendipity).
    Quad8,
    /// Four-node tetrahedron.
    Tet4,
    /// Ten-node tetrahedron.
    Tet10,
    /// Eight-node hexahedron.
    Hex8,
    /// Twenty-node hexahedron (serendipity).
    Hex20,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 8] =
        [Self::Tri3, Self::Tri6, Self::Quad4, Self::Quad8, Self::Tet4, Self::Tet10, Self::Hex8, Self::Hex20];

    /// The reference element.
    pub fn element(self) -> &'static Element {
        match self {
            Self::Tri3 => &tri3::TRI3,
            Self::Tri6 => &tri6::TRI6,
            Self::Quad4 => &quad4::QUAD4,
            Self::Quad8 => &quad8::QUAD8,
            Self::Tet4 => &tet4::TET4,
            Self::Tet10 => &tet10::TET10,
            Self::Hex8 => &hex8::HEX8,
            Self::Hex20 => &hex20::HEX20,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N_a is 1 at node a and 0 at the others, sums to 1, and its gradient is the difference quotient.
    #[test]
    fn shape_functions_interpolate() {
        let faces = Kind::ALL.map(|kind| kind.element().face);
        for element in Kind::ALL.map(Kind::element).into_iter().chain(faces) {
            let nodes = element.nodes;
            for (a, at) in nodes.iter().enumerate() {
                let shape = (element.shape)(*at);
                for (b, value) in shape.values.iter().enumerate() {
                    let expected = if a == b { 1.0 } else { 0.0 };
                    assert!((value - expected).abs() < 1e-14, "{} {a} {b}", element.name);
                }
            }
            let at = [0.21, if element.dimension > 1 { 0.13 } else { 0.0 }, 0.0];
            assert!(((element.shape)(at).values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            for i in 0..element.dimension {
                let step = 1e-6;
                let moved =
                    |by: f64| (element.shape)(std::array::from_fn(|k| at[k] + if k == i { by } else { 0.0 }));
                let (up, down) = (moved(step), moved(-step));
                for a in 0..nodes.len() {
                    let slope = (up.values[a] - down.values[a]) / (2.0 * step);
                    assert!((slope - (element.shape)(at).gradients[a][i]).abs() < 1e-8, "{}", element.name);
                }
            }
        }
    }

    #[test]
    fn every_middle_node_has_its_edge_and_every_face_its_nodes() {
        for element in Kind::ALL.map(Kind::element) {
            for node in 0..element.nodes.len() {
                assert_eq!(element.edge_of(node).is_none(), node < element.corners, "{}", element.name);
            }
            for face in element.faces {
                assert_eq!(face.len(), element.face.nodes.len());
                let corners = element.face.corners;
                for (k, node) in face.iter().enumerate().skip(corners) {
                    let ends = element.face.edge_of(k).unwrap().map(|end| face[end]);
                    let mut sorted = ends;
                    sorted.sort_unstable();
                    assert_eq!(element.edge_of(*node), Some(sorted), "{} {face:?}", element.name);
                }
            }
        }
    }
}
