//! Nodes, elements and named surfaces of one body, from whatever source.

use std::collections::BTreeMap;

use super::element::{Coordinates, Element, Kind};

/// One side of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Face {
    /// Its element.
    pub element: u32,
    /// Which of the element's faces.
    pub side: u8,
}

/// The mesh of one body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Where the nodes are, m.
    pub nodes: Vec<Coordinates>,
    pub(super) kinds: Vec<Kind>,
    pub(super) starts: Vec<u32>,
    pub(super) connectivity: Vec<u32>,
    /// Elements e and e + k are translates of each other where this is k.
    pub(super) congruent: Option<usize>,
    /// Sides of the body by name.
    pub surfaces: BTreeMap<String, Vec<Face>>,
}

impl Mesh {
    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.kinds.len()
    }

    /// The type of element `e`.
    pub fn kind(&self, e: usize) -> Kind {
        self.kinds[e]
    }

    /// The nodes of element `e`, in VTK's order.
    pub fn element(&self, e: usize) -> &[u32] {
        let end = self.starts.get(e + 1).map_or(self.connectivity.len(), |end| *end as usize);
        &self.connectivity[self.starts[e] as usize..end]
    }

    /// Where the nodes of element `e` are, m.
    pub fn places(&self, e: usize) -> Vec<Coordinates> {
        self.element(e).iter().map(|node| self.nodes[*node as usize]).collect()
    }

    pub(super) fn push(&mut self, kind: Kind, nodes: impl IntoIterator<Item = u32>) {
        self.kinds.push(kind);
        self.starts.push(self.connectivity.len() as u32);
        self.connectivity.extend(nodes);
    }

    /// Moves every corner by `f`, and the nodes of edges with the corners at their ends, so that edges stay straight.
    pub fn distort(&mut self, f: impl Fn(Coordinates) -> Coordinates) {
        let old = std::mem::take(&mut self.nodes);
        self.nodes = old.iter().map(|x| f(*x)).collect();
        for e in 0..self.elements() {
            let (element, nodes) = (self.kind(e).element(), self.element(e).to_vec());
            for a in element.corners..nodes.len() {
                if let Some([b, c]) = element.edge_of(a) {
                    let [b, c] = [b, c].map(|end| self.nodes[nodes[end] as usize]);
                    self.nodes[nodes[a] as usize] = std::array::from_fn(|i| 0.5 * (b[i] + c[i]));
                }
            }
        }
        self.congruent = None;
    }

    /// The nodes of a face and the element that it is.
    pub fn face(&self, face: Face) -> (Vec<u32>, &'static Element) {
        let element = self.kind(face.element as usize).element();
        let nodes = self.element(face.element as usize);
        let local = element.faces[face.side as usize];
        (local.iter().map(|a| nodes[*a]).collect(), element.face)
    }

    /// The nodes of some faces, ascending, each once.
    pub fn nodes_of(&self, faces: &[Face]) -> Vec<u32> {
        let mut nodes: Vec<u32> = faces.iter().flat_map(|face| self.face(*face).0).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}
