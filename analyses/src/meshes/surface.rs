//! Contact surfaces: where on them a contact is, how much of them is its own, and where they look.

use std::collections::HashMap;

use super::plane::chains;
use bipenalty::mesh::element::{Coordinates, Element};
use bipenalty::mesh::topology::{Face, Mesh};
use bipenalty::mesh::{Body, Elements, HELD, Place};
use bipenalty::pencil::Gap;

/// A contact on its surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Arc length from the left end in the plane, distance from the point that touches first in space, m.
    pub position: f64,
    /// int N dA, m^2, thickness included.
    pub area: f64,
}

/// What stress is shown: the one across the contact, if the contacts look into one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Direction {
    /// n.sigma n with this unit normal.
    Normal([f64; 2]),
    /// von Mises.
    None,
}

pub(super) fn minus(a: &Coordinates, b: &Coordinates) -> Coordinates {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn norm(a: &Coordinates) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The faces of the surface whose node a contact is, its body, and the number of the first node of that body.
pub(super) fn surface_of<'a>(elements: &'a Elements, place: &Place) -> Option<(&'a Body, &'a [Face], usize)> {
    let body = elements.bodies.iter().position(|body| body.name == place.bodies[0])?;
    let of = &elements.bodies[body];
    let name = place.surfaces[0].strip_prefix(&of.name)?.strip_prefix('.')?;
    Some((of, of.mesh.surfaces.get(name)?, elements.first[body].0))
}

/// The contacts on their surfaces, in their order.
pub fn spots(elements: &Elements, places: &[Place], gaps: &[Gap]) -> Vec<Spot> {
    /// Of the nodes of a surface, numbered from the first of its body.
    struct Known {
        areas: HashMap<u32, f64>,
        positions: HashMap<u32, f64>,
        first: usize,
    }
    let mut known: HashMap<&[String; 2], Known> = HashMap::new();
    for place in places {
        if known.contains_key(&place.surfaces) {
            continue;
        }
        let Some((body, faces, first)) = surface_of(elements, place) else { continue };
        let positions = match elements.dimension {
            2 => arc_lengths(&body.mesh, faces),
            _ => distances(&body.mesh, faces, apex(places, gaps, &place.surfaces)),
        };
        known.insert(&place.surfaces, Known { areas: areas(body, faces), positions, first });
    }
    let spot = |place: &Place| {
        let found = known.get(&place.surfaces).and_then(|of| {
            let node = (place.node - of.first) as u32;
            Some(Spot { position: *of.positions.get(&node)?, area: *of.areas.get(&node)? })
        });
        // Every contact is a node of its surface.
        found.unwrap_or(Spot { position: f64::NAN, area: f64::NAN })
    };
    places.iter().map(spot).collect()
}

/// The contact of these surfaces that is least open at first.
pub(super) fn apex<'a>(places: &'a [Place], gaps: &[Gap], surfaces: &[String; 2]) -> Option<&'a Place> {
    let of = places.iter().zip(gaps).filter(|(place, _)| place.surfaces == *surfaces);
    // The first of equal ones.
    of.reduce(|best, next| if next.1.initial > best.1.initial { next } else { best }).map(|(place, _)| place)
}

fn distances(mesh: &Mesh, faces: &[Face], apex: Option<&Place>) -> HashMap<u32, f64> {
    let Some(apex) = apex else { return HashMap::new() };
    let distance = |node: u32| (node, norm(&minus(&mesh.nodes[node as usize], &apex.coordinates)));
    mesh.nodes_of(faces).into_iter().map(distance).collect()
}

/// |dx/dxi| in the plane, |dx/dxi x dx/deta| in space, times the weight, and N, at the quadrature points of a face.
fn samples(face: &Element, places: &[Coordinates]) -> Vec<(f64, Vec<f64>)> {
    let sample = |point: &bipenalty::mesh::element::QuadraturePoint| {
        let shape = (face.shape)(point.at);
        let tangent = |k: usize| -> Coordinates {
            std::array::from_fn(|i| places.iter().zip(&shape.gradients).map(|(x, g)| x[i] * g[k]).sum())
        };
        let (a, b) = (tangent(0), tangent(1));
        let across = if face.dimension == 1 {
            norm(&a)
        } else {
            norm(&[a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
        };
        (point.weight * across, shape.values[..places.len()].to_vec())
    };
    face.quadrature.iter().map(sample).collect()
}

/// The share of each node of the faces, m^2.
fn areas(body: &Body, faces: &[Face]) -> HashMap<u32, f64> {
    let mut areas = HashMap::new();
    for face in faces {
        let (nodes, element) = body.mesh.face(*face);
        let places: Vec<Coordinates> = nodes.iter().map(|node| body.mesh.nodes[*node as usize]).collect();
        for (area, shares) in samples(element, &places) {
            for (node, share) in nodes.iter().zip(shares) {
                *areas.entry(*node).or_insert(0.0) += body.material.thickness * area * share;
            }
        }
    }
    areas
}

/// The arc length of each node of the faces, from left to right; pieces one after the other.
fn arc_lengths(mesh: &Mesh, faces: &[Face]) -> HashMap<u32, f64> {
    let sides: Vec<(Vec<u32>, &Element)> = faces.iter().map(|face| mesh.face(*face)).collect();
    let edges: Vec<[u32; 2]> = sides.iter().map(|(nodes, _)| [nodes[0], nodes[1]]).collect();
    let x = |node: u32| mesh.nodes[node as usize][0];
    let (mut positions, mut s) = (HashMap::new(), 0.0);
    for mut chain in chains(&edges) {
        let ends = chain.first().zip(chain.last()).map(|(first, last)| (edges[*first][0], edges[*last][1]));
        let backwards = ends.is_some_and(|(start, end)| x(end) < x(start));
        if backwards {
            chain.reverse();
        }
        for i in chain {
            let (nodes, element) = &sides[i];
            let places: Vec<Coordinates> = nodes.iter().map(|node| mesh.nodes[*node as usize]).collect();
            let length: f64 = samples(element, &places).iter().map(|(length, _)| length).sum();
            let at = |xi: f64| s + length * if backwards { 0.5 * (1.0 - xi) } else { 0.5 * (1.0 + xi) };
            nodes.iter().zip(element.nodes).for_each(|(node, reference)| {
                positions.entry(*node).or_insert(at(reference[0]));
            });
            s += length;
        }
    }
    positions
}

/// The direction of the contacts: the principal one of sum w n n', if its share of the trace says that the normals lie within
/// some 18 degrees of it (cos^2 = 0.9).
pub fn direction(elements: &Elements, places: &[Place], gaps: &[Gap]) -> Direction {
    const SHARE: f64 = 0.9;
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (place, gap) in places.iter().zip(gaps) {
        let entry = |i: usize| {
            let dof = elements.dofs[place.node * elements.dimension + i];
            let known = gap.column.0.iter().find(|(at, _)| dof != HELD && *at == dof);
            known.map_or(0.0, |(_, z)| *z)
        };
        let (x, y) = (entry(0), entry(1));
        let length = x * x + y * y;
        if length > 0.0 {
            xx += gap.scale * x * x / length;
            yy += gap.scale * y * y / length;
            xy += gap.scale * x * y / length;
        }
    }
    let (mean, radius) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    if mean > 0.0 && mean + radius >= SHARE * 2.0 * mean {
        // Of the two ends the upper, or the right one; what is an axis to rounding is that axis.
        let whole = |x: f64| if x.abs() < 1e-12 { 0.0 } else { x };
        let (sin, cos) = angle.sin_cos();
        let sign = if whole(sin) < 0.0 || (whole(sin) == 0.0 && cos < 0.0) { -1.0 } else { 1.0 };
        return Direction::Normal([whole(sign * cos), whole(sign * sin)]);
    }
    Direction::None
}
