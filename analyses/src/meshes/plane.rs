//! A mesh of the plane as polygons and lines.

use std::collections::{HashMap, HashSet};

use bipenalty::mesh::element::{Coordinates, Element};
use bipenalty::mesh::{Elements, HELD};

/// A line, m.
type Line = Vec<(f64, f64)>;

/// Where the nodes of all bodies are with `factor` times their displacements, m.
pub fn displaced(elements: &Elements, u: &[f64], factor: f64) -> Vec<Coordinates> {
    let d = elements.dimension;
    let nodes = elements.bodies.iter().flat_map(|body| &body.mesh.nodes).enumerate();
    let moved = |(node, place): (usize, &Coordinates)| {
        std::array::from_fn(|i| match elements.dofs.get(node * d + i) {
            Some(dof) if i < d && *dof != HELD => place[i] + factor * u[*dof as usize],
            _ => place[i],
        })
    };
    nodes.map(moved).collect()
}

/// The elements, in their order; `places` are those of all nodes.
pub fn polygons(elements: &Elements, places: &[Coordinates]) -> Vec<Line> {
    let ring =
        |e: usize| (0..kind(elements, e).faces.len()).flat_map(|k| side(elements, places, e, k)).collect();
    (0..elements.len()).map(ring).collect()
}

/// The edges of the bodies: the sides that belong to one element only.
pub fn outlines(elements: &Elements, places: &[Coordinates]) -> Vec<Line> {
    let mut sides: HashMap<[u32; 2], (usize, usize, usize)> = HashMap::new();
    for e in 0..elements.len() {
        for k in 0..kind(elements, e).faces.len() {
            let mut ends = corners(elements, e, k);
            ends.sort_unstable();
            sides.entry(ends).or_insert((0, e, k)).0 += 1;
        }
    }
    let mut free: Vec<(usize, usize)> =
        sides.values().filter(|(times, ..)| *times == 1).map(|(_, e, k)| (*e, *k)).collect();
    // A hash table has no order that lasts.
    free.sort_unstable();
    let edges: Vec<[u32; 2]> = free.iter().map(|(e, k)| corners(elements, *e, *k)).collect();
    let line = |chain: &Vec<usize>| -> Line {
        let mut line: Line =
            chain.iter().flat_map(|i| side(elements, places, free[*i].0, free[*i].1)).collect();
        let end = chain.last().map(|i| places[edges[*i][1] as usize]);
        line.extend(end.map(|place| (place[0], place[1])));
        line
    };
    chains(&edges).iter().map(line).collect()
}

/// Edges from node to node, end to end: their numbers, line by line. A line begins where none ends, if it has such an end.
pub(super) fn chains(edges: &[[u32; 2]]) -> Vec<Vec<usize>> {
    let from: HashMap<u32, usize> = edges.iter().enumerate().map(|(i, edge)| (edge[0], i)).collect();
    let ends: HashSet<u32> = edges.iter().map(|edge| edge[1]).collect();
    let mut used = vec![false; edges.len()];
    let open = (0..edges.len()).filter(|i| !ends.contains(&edges[*i][0]));
    let mut lines = Vec::new();
    for start in open.chain(0..edges.len()) {
        let (mut line, mut at) = (Vec::new(), Some(start));
        while let Some(i) = at.filter(|i| !used[*i]) {
            used[i] = true;
            line.push(i);
            at = from.get(&edges[i][1]).copied();
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    lines
}

fn kind(elements: &Elements, e: usize) -> &'static Element {
    let body = elements.body(e);
    elements.bodies[body].mesh.kind(e - elements.first[body].1).element()
}

fn corners(elements: &Elements, e: usize, k: usize) -> [u32; 2] {
    let nodes = elements.nodes(e);
    let face = kind(elements, e).faces[k];
    [nodes[face[0]], nodes[face[1]]]
}

/// Side `k` of element `e` without its end; four points of a parabola.
fn side(elements: &Elements, places: &[Coordinates], e: usize, k: usize) -> Line {
    let (element, nodes) = (kind(elements, e), elements.nodes(e));
    let ends: Vec<Coordinates> = element.faces[k].iter().map(|a| places[nodes[*a] as usize]).collect();
    let steps: &[f64] = if element.order() == 1 { &[-1.0] } else { &[-1.0, -0.5, 0.0, 0.5] };
    let point = |xi: &f64| {
        let shape = (element.face.shape)([*xi, 0.0, 0.0]);
        let along = |i: usize| ends.iter().zip(&shape.values).map(|(x, n)| n * x[i]).sum();
        (along(0), along(1))
    };
    steps.iter().map(point).collect()
}
