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

#[cfg(test)]
mod tests {
    use super::super::{Blocks, Direction, ELEMENTS, Hertz, direction, spots};
    use super::*;
    use bipenalty::fem::MassMatrix;
    use bipenalty::mesh::{Assembled, Place};
    use bipenalty::stability::AnyScene;

    fn area(polygon: &[(f64, f64)]) -> f64 {
        let next = polygon.iter().cycle().skip(1);
        0.5 * polygon.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>()
    }

    fn blocks(element: &'static str) -> Assembled {
        let scene = Blocks { name: "blocks".to_owned(), element, cells: [6, 4] }.scene().expect("a scene");
        let AnyScene::Mesh(scene) = scene else { panic!("a mesh") };
        scene.assemble(MassMatrix::LUMPED).expect("matrices")
    }

    /// Two blocks of 0.2 m by 0.1 m, also when they are stretched, and the contact between them. Sums of some 500 numbers.
    #[test]
    fn polygons_edges_and_shares_have_the_sizes_of_the_bodies() {
        const ROUNDING: f64 = 500.0 * f64::EPSILON;
        for element in ELEMENTS[0] {
            let assembled = blocks(element);
            let (elements, gaps) = (&assembled.elements, &assembled.gaps()[..]);
            let places: Vec<Place> = assembled.contacts.iter().map(|contact| contact.place.clone()).collect();
            let places = &places[..];
            // u = x along x: twice as wide, but below, where it is held.
            let mut u = vec![0.0; elements.unknowns()];
            let nodes = elements.bodies.iter().flat_map(|body| &body.mesh.nodes).enumerate();
            for (node, place) in nodes {
                if let Some(free) = u.get_mut(elements.dofs[2 * node] as usize) {
                    *free = place[0];
                }
            }
            for (factor, upper) in [(0.0, 0.02), (0.5, 0.03)] {
                let moved = displaced(elements, &u, factor);
                let polygons = polygons(elements, &moved);
                assert_eq!(polygons.len(), elements.len(), "{element}");
                let of_upper = &polygons[elements.first[1].1..];
                let found: f64 = of_upper.iter().map(|polygon| area(polygon)).sum();
                assert!((found - upper).abs() < ROUNDING, "{element}: {found}");
                assert!(polygons.iter().all(|polygon| area(polygon) > 0.0), "{element}");
            }
            let lines = outlines(elements, &displaced(elements, &u, 0.0));
            assert_eq!(lines.len(), 2, "{element}");
            for line in &lines {
                let length: f64 = line.windows(2).map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1)).sum();
                assert!(
                    (length - 0.6).abs() < ROUNDING && line.first() == line.last(),
                    "{element}: {length}"
                );
            }
            let spots = spots(elements, places, gaps);
            let all: f64 = spots.iter().map(|spot| spot.area).sum();
            assert!((all - 0.2).abs() < ROUNDING, "{element}: {all}");
            for (spot, place) in spots.iter().zip(places) {
                assert!((spot.position - place.coordinates[0]).abs() < ROUNDING, "{element}");
            }
            assert_eq!(direction(elements, places, gaps), Direction::Normal([0.0, 1.0]), "{element}");
            // Flat surfaces are none of Hertz'.
            assert_eq!(Hertz::of(elements, places, gaps), None, "{element}");
        }
    }
}
