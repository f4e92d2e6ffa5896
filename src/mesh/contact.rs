//! Contact of the nodes of one surface with the faces of another, or with a rigid wall.
//!
//! Node s faces the point sum_k N_k x_k of a face with outward normal n:
//! ```text
//! g = n . (sum_k N_k (x_k + u_k) - (x_s + u_s)) = z'u + g0      positive in penetration
//! ```
//! so the weights sum to zero and a common translation closes nothing. On a wall z = n, the outward normal of the body at
//! the node, and g0 = 0: the wall touches.

use std::collections::HashMap;

use rayon::prelude::*;

use super::element::{Coordinates, Element};
use super::topology::{Face, Mesh};

/// Coordinates of meshes come from text, often with half of the digits; what differs by less than sqrt(eps) of a face is
/// the same place.
pub(super) const SAME: f64 = 1.490_116_119_384_765_6e-8;

/// Face sizes from the middle of a face: a point whose projection is farther off does not come back onto the face.
const FAR: f64 = 1e3;

/// A surface of a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface<'a> {
    pub mesh: &'a Mesh,
    pub faces: &'a [Face],
}

/// One contact: (which of the two surfaces, its node, the weight of its displacement) and g0, m.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NodeContact {
    pub node: u32,
    pub weights: Vec<(usize, u32, Coordinates)>,
    pub initial: f64,
}

pub(super) fn dot(a: &Coordinates, b: &Coordinates) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: &Coordinates, b: &Coordinates) -> Coordinates {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: &Coordinates, b: &Coordinates) -> Coordinates {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A face in its place.
struct Patch {
    nodes: Vec<u32>,
    places: Vec<Coordinates>,
    element: &'static Element,
    centre: Coordinates,
    /// No node is farther from the centre.
    radius: f64,
    /// The normal of a face whose nodes lie in one plane.
    flat: Option<Coordinates>,
}

/// x and its tangents dx/dxi_i at reference coordinates, with the weights N.
struct At {
    x: Coordinates,
    tangents: [Coordinates; 2],
    weights: [f64; super::element::MOST_NODES],
}

impl Patch {
    fn new(surface: &Surface, face: Face) -> Self {
        let (nodes, element) = surface.mesh.face(face);
        let places: Vec<_> = nodes.iter().map(|node| surface.mesh.nodes[*node as usize]).collect();
        let n = places.len() as f64;
        let centre = std::array::from_fn(|i| places.iter().map(|x| x[i]).sum::<f64>() / n);
        let distance = |x: &Coordinates| dot(&minus(x, &centre), &minus(x, &centre)).sqrt();
        let radius = places.iter().map(distance).fold(0.0, f64::max);
        let mut patch = Self { nodes, places, element, centre, radius, flat: None };
        let normal = patch.normal(&patch.at(if element.is_simplex() { [1.0 / 3.0; 3] } else { [0.0; 3] }));
        let off = |x: &Coordinates| dot(&minus(x, &centre), &normal).abs();
        patch.flat = patch.places.iter().all(|x| off(x) <= SAME * radius).then_some(normal);
        patch
    }

    fn at(&self, reference: Coordinates) -> At {
        let shape = (self.element.shape)(reference);
        let mut at = At { x: [0.0; 3], tangents: [[0.0; 3]; 2], weights: shape.values };
        for ((place, value), gradient) in self.places.iter().zip(&shape.values).zip(&shape.gradients) {
            for i in 0..3 {
                at.x[i] += value * place[i];
                (0..2).for_each(|k| at.tangents[k][i] += gradient[k] * place[i]);
            }
        }
        at
    }

    /// The outward unit normal.
    fn normal(&self, at: &At) -> Coordinates {
        let [a, b] = &at.tangents;
        let normal = if self.element.dimension == 1 { [a[1], -a[0], 0.0] } else { cross(a, b) };
        let length = dot(&normal, &normal).sqrt();
        normal.map(|entry| entry / length)
    }

    /// The reference coordinates of the point of the face next to `x`, by Gauss-Newton steps: one for a flat face with
    /// straight parallel edges.
    fn project(&self, x: &Coordinates) -> Option<Coordinates> {
        let simplex = self.element.is_simplex();
        let mut reference = if simplex { [1.0 / 3.0, 1.0 / 3.0, 0.0] } else { [0.0; 3] };
        for _ in 0..50 {
            let at = self.at(reference);
            let off = minus(x, &at.x);
            let [a, b] = &at.tangents;
            let (aa, fa) = (dot(a, a), dot(a, &off));
            let step = if self.element.dimension == 1 {
                [fa / aa, 0.0]
            } else {
                let (ab, bb, fb) = (dot(a, b), dot(b, b), dot(b, &off));
                let determinant = aa * bb - ab * ab;
                [(bb * fa - ab * fb) / determinant, (aa * fb - ab * fa) / determinant]
            };
            reference[0] += step[0];
            reference[1] += step[1];
            let size = step[0].abs().max(step[1].abs());
            if size < SAME * SAME.sqrt() {
                return self.inside(reference);
            }
            // Far outside and going: a curved face that does not face this node. Also ends on NaN.
            if reference.iter().any(|r| !r.is_finite() || r.abs() > FAR) {
                return None;
            }
        }
        None
    }

    /// The reference coordinates, moved onto the edge where they lie beyond it by rounding; `None` outside.
    fn inside(&self, reference: Coordinates) -> Option<Coordinates> {
        let low = if self.element.is_simplex() { 0.0 } else { -1.0 };
        if reference[..self.element.dimension].iter().any(|r| !(low - SAME..=1.0 + SAME).contains(r))
            || (self.element.is_simplex() && reference[0] + reference[1] > 1.0 + SAME)
        {
            return None;
        }
        Some(reference.map(|r| r.clamp(low, 1.0)))
    }

    /// Whether `x` is too far to the side of a flat face to project onto it, or farther than `best` from any face.
    fn misses(&self, x: &Coordinates, best: f64) -> bool {
        let off = minus(x, &self.centre);
        let distance = dot(&off, &off).sqrt();
        if distance - self.radius > best {
            return true;
        }
        let Some(normal) = &self.flat else { return false };
        let height = dot(&off, normal);
        // Between its nodes an edge of second order stays within twice their distance from the centre.
        let reach = if self.element.order() == 1 { self.radius } else { 2.0 * self.radius };
        (distance * distance - height * height).max(0.0).sqrt() > reach * (1.0 + SAME) + SAME * distance
    }
}

/// The outward normal of a surface at each of its nodes, the mean over its faces there.
fn normals(surface: &Surface) -> HashMap<u32, Coordinates> {
    let mut normals: HashMap<u32, Coordinates> = HashMap::new();
    for face in surface.faces {
        let patch = Patch::new(surface, *face);
        for (node, reference) in patch.nodes.iter().zip(patch.element.nodes) {
            let normal = patch.normal(&patch.at(*reference));
            let sum = normals.entry(*node).or_default();
            (0..3).for_each(|i| sum[i] += normal[i]);
        }
    }
    for sum in normals.values_mut() {
        let length = dot(sum, sum).sqrt();
        *sum = sum.map(|entry| entry / length);
    }
    normals
}

/// The nodes of `surface` against a rigid wall.
pub(super) fn with_wall(surface: &Surface) -> Vec<NodeContact> {
    let normals = normals(surface);
    let contact = |node: u32| NodeContact { node, weights: vec![(0, node, normals[&node])], initial: 0.0 };
    surface.mesh.nodes_of(surface.faces).into_iter().map(contact).collect()
}

/// The nodes of `first` against the faces of `second`; a node that projects onto no face that looks at it is left out.
pub(super) fn between(first: &Surface, second: &Surface) -> Vec<NodeContact> {
    let normals = normals(first);
    let patches: Vec<Patch> = second.faces.iter().map(|face| Patch::new(second, *face)).collect();
    let nodes = first.mesh.nodes_of(first.faces);
    let contact = |node: &u32| nearest(&patches, &first.mesh.nodes[*node as usize], &normals[node], *node);
    nodes.par_iter().filter_map(contact).collect()
}

fn nearest(patches: &[Patch], x: &Coordinates, facing: &Coordinates, node: u32) -> Option<NodeContact> {
    let mut best: Option<(f64, f64, Coordinates, &Patch, At)> = None;
    for patch in patches {
        let limit = best.as_ref().map_or(f64::INFINITY, |(distance, ..)| *distance);
        if patch.misses(x, limit) {
            continue;
        }
        let Some(reference) = patch.project(x) else { continue };
        let at = patch.at(reference);
        let normal = patch.normal(&at);
        let gap = dot(&normal, &minus(&at.x, x));
        if dot(&normal, facing) < 0.0 && gap.abs() < limit {
            best = Some((gap.abs(), gap, normal, patch, at));
        }
    }
    let (_, gap, normal, patch, at) = best?;
    let mut weights = vec![(0, node, normal.map(|n| -n))];
    let shares = whole(&at.weights[..patch.nodes.len()]);
    for (node, share) in patch.nodes.iter().zip(shares).filter(|(_, share)| *share != 0.0) {
        weights.push((1, *node, normal.map(|n| share * n)));
    }
    // What is closer than the digits of the coordinates touches.
    let initial = if gap.abs() <= SAME * patch.radius { 0.0 } else { gap };
    Some(NodeContact { node, weights, initial })
}

/// The weights without those that are rounding, with the sum 1: matching nodes meet node to node.
fn whole(weights: &[f64]) -> Vec<f64> {
    let kept = |weight: f64| if weight.abs() < SAME { 0.0 } else { weight };
    let sum: f64 = weights.iter().map(|weight| kept(*weight)).sum();
    weights.iter().map(|weight| kept(*weight) / sum).collect()
}
