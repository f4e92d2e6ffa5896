//! Boxes cut into equal cells, of every element.
//!
//! The coordinates are right-handed: left and right are the ends of x, bottom and top of y, back and front of z.

use super::element::{Coordinates, Element, Kind};
use super::topology::{Face, Mesh};

/// Names of the sides: axis by axis, the low end first.
pub const SIDES: [[&str; 2]; 3] = [["left", "right"], ["bottom", "top"], ["back", "front"]];

/// The elements of one cell by the places of their corners in it, 0 or 1 along each axis.
fn cell(kind: Kind) -> &'static [&'static [[usize; 3]]] {
    const A: [usize; 3] = [0, 0, 0];
    const X: [usize; 3] = [1, 0, 0];
    const Y: [usize; 3] = [0, 1, 0];
    const Z: [usize; 3] = [0, 0, 1];
    const XY: [usize; 3] = [1, 1, 0];
    const XZ: [usize; 3] = [1, 0, 1];
    const YZ: [usize; 3] = [0, 1, 1];
    const ALL: [usize; 3] = [1, 1, 1];
    match kind {
        Kind::Tri3 | Kind::Tri6 => &[&[A, X, XY], &[A, XY, Y]],
        Kind::Quad4 | Kind::Quad8 => &[&[A, X, XY, Y]],
        // Kuhn's six around the long diagonal: faces of neighbouring cells fit.
        Kind::Tet4 | Kind::Tet10 => &[
            &[A, X, XY, ALL],
            &[A, XY, Y, ALL],
            &[A, Y, YZ, ALL],
            &[A, YZ, Z, ALL],
            &[A, Z, XZ, ALL],
            &[A, XZ, X, ALL],
        ],
        Kind::Hex8 | Kind::Hex20 => &[&[A, X, XY, Y, Z, XZ, ALL, YZ]],
    }
}

/// A box to be meshed.
#[derive(Debug, Clone, PartialEq)]
pub struct Cuboid {
    /// Edges, m; the third is not read in the plane.
    pub size: Coordinates,
    /// Cells along each edge, at least 1; 1 along the third axis in the plane.
    pub cells: [usize; 3],
    /// The lower corner, m.
    pub origin: Coordinates,
    /// The elements.
    pub kind: Kind,
}

/// The nodes of a box: points of the lattice of half cells (whole cells at first order), numbered along x first.
struct Lattice {
    order: usize,
    points: [usize; 3],
    number: Vec<u32>,
    nodes: Vec<Coordinates>,
}

impl Lattice {
    fn new(cuboid: &Cuboid, element: &Element) -> Self {
        let (order, dimension) = (element.order(), element.dimension);
        let points: [usize; 3] =
            std::array::from_fn(|k| if k < dimension { order * cuboid.cells[k] + 1 } else { 1 });
        let mut lattice = Self { order, points, number: Vec::new(), nodes: Vec::new() };
        let serendipity = order == 2 && !element.is_simplex();
        for at in 0..points.iter().product() {
            let place = [at % points[0], at / points[0] % points[1], at / (points[0] * points[1])];
            if serendipity && place.iter().filter(|k| *k % 2 == 1).count() > 1 {
                lattice.number.push(u32::MAX);
                continue;
            }
            lattice.number.push(lattice.nodes.len() as u32);
            lattice.nodes.push(std::array::from_fn(|k| {
                let cells = (order * cuboid.cells[k]) as f64;
                cuboid.origin[k]
                    + if k < dimension { cuboid.size[k] * (place[k] as f64 / cells) } else { 0.0 }
            }));
        }
        lattice
    }

    fn node(&self, place: [usize; 3]) -> u32 {
        self.number[place[0] + self.points[0] * (place[1] + self.points[1] * place[2])]
    }
}

impl Cuboid {
    /// Nodes of this box, before it is built; `None` beyond what can be counted.
    pub fn node_count(&self) -> Option<usize> {
        let element = self.kind.element();
        let (order, d) = (element.order(), element.dimension);
        let product = |per_cell: usize| {
            self.cells[..d]
                .iter()
                .try_fold(1_usize, |all, n| all.checked_mul(n.checked_mul(per_cell)?.checked_add(1)?))
        };
        if order == 1 || element.is_simplex() {
            return product(order);
        }
        // Corners, and the edges along each axis.
        (0..d).try_fold(product(1)?, |all, axis| {
            let edges =
                (0..d).try_fold(1_usize, |all, k| all.checked_mul(self.cells[k] + usize::from(k != axis)))?;
            all.checked_add(edges)
        })
    }

    /// The mesh with its sides as surfaces.
    pub fn mesh(&self) -> Mesh {
        let element = self.kind.element();
        let lattice = Lattice::new(self, element);
        let mut mesh = Mesh { congruent: Some(cell(self.kind).len()), ..Mesh::default() };
        let (edges, d): (Vec<_>, _) = (
            (0..element.nodes.len()).map(|a| element.edge_of(a).unwrap_or([a; 2])).collect(),
            element.dimension,
        );
        let depth = if d == 3 { self.cells[2] } else { 1 };
        for at in 0..self.cells[0] * self.cells[1] * depth {
            let first = [
                at % self.cells[0],
                at / self.cells[0] % self.cells[1],
                at / (self.cells[0] * self.cells[1]),
            ];
            for corners in cell(self.kind) {
                let nodes: Vec<[usize; 3]> = edges
                    .iter()
                    .map(|[a, b]| {
                        // A corner counts twice, the middle of an edge is half of both ends.
                        let half = |k: usize| lattice.order * (corners[*a][k] + corners[*b][k]) / 2;
                        std::array::from_fn(|k| lattice.order * first[k] + half(k))
                    })
                    .collect();
                self.name_sides(&mut mesh, element, &nodes, &lattice.points);
                mesh.push(self.kind, nodes.iter().map(|place| lattice.node(*place)));
            }
        }
        mesh.nodes = lattice.nodes;
        mesh
    }

    /// Adds the faces of the element to come, whose nodes are at `places`, to the sides that they lie in.
    fn name_sides(&self, mesh: &mut Mesh, element: &Element, places: &[[usize; 3]], points: &[usize; 3]) {
        for (axis, names) in SIDES.iter().enumerate().take(element.dimension) {
            for (name, end) in names.iter().zip([0, points[axis] - 1]) {
                if places.iter().all(|place| place[axis] != end) {
                    continue;
                }
                for (side, face) in element.faces.iter().enumerate() {
                    if face.iter().all(|a| places[*a][axis] == end) {
                        let face = Face { element: mesh.elements() as u32, side: side as u8 };
                        mesh.surfaces.entry((*name).to_owned()).or_default().push(face);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_side_is_covered_once_and_no_node_is_left_over() {
        for kind in Kind::ALL {
            let cuboid = Cuboid { size: [3.0, 2.0, 1.0], cells: [3, 2, 4], origin: [0.5, 0.0, -1.0], kind };
            let (mesh, element) = (cuboid.mesh(), kind.element());
            assert_eq!(cuboid.node_count(), Some(mesh.nodes.len()), "{}", element.name);
            let mut used = mesh.connectivity.clone();
            used.sort_unstable();
            used.dedup();
            assert_eq!(used.len(), mesh.nodes.len());
            assert_eq!(mesh.surfaces.len(), 2 * element.dimension);
            let split = if element.is_simplex() { 2 } else { 1 };
            let right = if element.dimension == 3 { 8 * split } else { 2 };
            assert_eq!(mesh.surfaces["right"].len(), right, "{}", element.name);
            let nodes = mesh.nodes_of(&mesh.surfaces["top"]);
            assert!(nodes.iter().all(|node| mesh.nodes[*node as usize][1] == 2.0));
        }
    }
}
