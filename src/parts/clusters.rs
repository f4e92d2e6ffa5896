//! Patches of the elements of a scene: boxes of one lattice for all bodies, which no contact surface cuts lengthwise.
//!
//! A contact must lie in one patch with all its unknowns, on both sides. So the lattice has no cut near contacts that face
//! along its normal; where bodies meet with meshes that do not match, elements at the seam move over.

use std::collections::HashMap;

use crate::mesh::{Contact, Elements, HELD};

/// The patch of each element: about `edge` elements along each side.
pub(super) fn clusters(elements: &Elements, contacts: &[Contact], edge: usize) -> Vec<usize> {
    let lattice = Lattice::of(elements, contacts, edge.max(1));
    let mut numbers: HashMap<[usize; 3], usize> = HashMap::new();
    let mut patch: Vec<usize> = (0..elements.len())
        .map(|e| {
            let next = numbers.len();
            *numbers.entry(lattice.cell(elements.centre(e))).or_insert(next)
        })
        .collect();
    mend(elements, contacts, &mut patch);
    patch
}

/// Where the lattice is cut along each axis, ascending.
struct Lattice([Vec<f64>; 3]);

impl Lattice {
    fn of(elements: &Elements, contacts: &[Contact], edge: usize) -> Self {
        let (mut low, mut high, mut widest) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], [0.0_f64; 3]);
        for body in &elements.bodies {
            let mut mean = [0.0; 3];
            let count = body.mesh.elements();
            for e in 0..count {
                let places = body.mesh.places(e);
                for axis in 0..3 {
                    let least = places.iter().map(|x| x[axis]).fold(f64::INFINITY, f64::min);
                    let most = places.iter().map(|x| x[axis]).fold(f64::NEG_INFINITY, f64::max);
                    mean[axis] += (most - least) / count as f64;
                    (low[axis], high[axis]) = (low[axis].min(least), high[axis].max(most));
                }
            }
            (0..3).for_each(|axis| widest[axis] = widest[axis].max(mean[axis]));
        }
        Self([0, 1, 2].map(|axis| {
            let ends = (low[axis], high[axis]);
            cuts(ends, &facing(elements, contacts, axis), edge as f64 * widest[axis])
        }))
    }

    fn cell(&self, x: [f64; 3]) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.0[axis].partition_point(|cut| *cut <= x[axis]))
    }
}

/// Cuts between two ends into pieces of about `size`, none of them in a zone of contacts that face along this axis: the
/// pieces on both sides of a zone are one. Equal pieces: a thin one would be as high as a single element.
fn cuts((low, high): (f64, f64), planes: &[f64], size: f64) -> Vec<f64> {
    // A zone as high as several pieces would leave one patch for all of it: it is cut.
    let mut zones: Vec<(f64, f64)> = Vec::new();
    for x in planes {
        match zones.last_mut() {
            Some((first, last)) if x - *last < size && x - *first <= 3.0 * size => *last = *x,
            _ => zones.push((*x, *x)),
        }
    }
    let begins = std::iter::once(low).chain(zones.iter().map(|zone| zone.1));
    let ends = zones.iter().map(|zone| zone.0).chain([high]);
    let pieces = |(from, to): (f64, f64)| {
        let count = if size > 0.0 { ((to - from) / size).round().max(1.0) as usize } else { 1 };
        (1..count).map(move |i| from + (to - from) * (i as f64 / count as f64))
    };
    begins.zip(ends).flat_map(pieces).collect()
}

/// The coordinates along `axis` of contacts whose normal has its largest part there.
fn facing(elements: &Elements, contacts: &[Contact], axis: usize) -> Vec<f64> {
    let d = elements.dimension;
    let normal = |contact: &Contact| -> [f64; 3] {
        let entry = |i: usize| {
            let dof = if i < d { elements.dofs[contact.place.node * d + i] } else { HELD };
            contact.column.0.iter().find(|(at, _)| *at == dof).map_or(0.0, |(_, z)| z.abs())
        };
        [0, 1, 2].map(entry)
    };
    let along = contacts.iter().filter(|contact| {
        let normal = normal(contact);
        normal[axis] > 0.0 && (0..3).all(|other| normal[other] <= normal[axis])
    });
    let mut planes: Vec<f64> = along.map(|contact| contact.place.coordinates[axis]).collect();
    planes.sort_by(f64::total_cmp);
    planes.dedup();
    planes
}

/// Rounds of moving: a move may part a contact next to it, which a second one mends.
const ROUNDS: usize = 3;

/// Moves elements at the node of a contact to a patch at the face that it touches, where they have none in common.
fn mend(elements: &Elements, contacts: &[Contact], patch: &mut [usize]) {
    let at = around(elements, contacts);
    for _ in 0..ROUNDS {
        let mut moved = false;
        for contact in contacts {
            let own = elements.first.partition_point(|(first, _)| *first <= contact.place.node) - 1;
            let (node, face): (Vec<u32>, Vec<u32>) =
                contact.column.0.iter().map(|(u, _)| *u).partition(|u| at[u].0 == own);
            let (node, face) = (holding(&at, &node), holding(&at, &face));
            let joint = node.iter().any(|e| face.iter().any(|f| patch[*e] == patch[*f]));
            if let (false, Some(e), Some(f)) = (joint, node.first(), face.first()) {
                patch[*e] = patch[*f];
                moved = true;
            }
        }
        if !moved {
            break;
        }
    }
}

/// The body and the elements of each unknown that a contact touches.
fn around(elements: &Elements, contacts: &[Contact]) -> HashMap<u32, (usize, Vec<usize>)> {
    let touched = contacts.iter().flat_map(|contact| contact.column.0.iter().map(|(u, _)| *u));
    let mut at: HashMap<u32, (usize, Vec<usize>)> = touched.map(|u| (u, (0, Vec::new()))).collect();
    for e in 0..elements.len() {
        for dof in elements.dofs(e) {
            if let Some((body, found)) = at.get_mut(&dof) {
                *body = elements.body(e);
                found.push(e);
            }
        }
    }
    at
}

/// The elements that hold all of some unknowns.
fn holding(at: &HashMap<u32, (usize, Vec<usize>)>, unknowns: &[u32]) -> Vec<usize> {
    let mut lists = unknowns.iter().map(|u| &at[u].1);
    let first = lists.next().cloned().unwrap_or_default();
    lists.fold(first, |kept, next| kept.into_iter().filter(|e| next.contains(e)).collect())
}
