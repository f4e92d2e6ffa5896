//! Patches of the elements of a scene: boxes of one lattice for all bodies, which no contact surface cuts lengthwise.
//!
//! A contact must lie in one patch with all its unknowns, on both sides. So the planes of the lattice keep away from contacts
//! that face along their normal; where bodies meet with meshes that do not match, elements at the seam move over.

use std::collections::HashMap;

use crate::mesh::{Contact, Elements, HELD};

/// The patch of each element: about `edge` elements along each side.
pub(super) fn clusters(elements: &Elements, contacts: &[Contact], edge: usize) -> Vec<usize> {
    let lattice = Lattice::of(elements, contacts, edge.max(1));
    let mut numbers: HashMap<[i64; 3], usize> = HashMap::new();
    let mut patch: Vec<usize> = (0..elements.len())
        .map(|e| {
            let next = numbers.len();
            *numbers.entry(lattice.cell(elements.centre(e))).or_insert(next)
        })
        .collect();
    mend(elements, contacts, &mut patch);
    patch
}

struct Lattice {
    origin: [f64; 3],
    size: [f64; 3],
}

impl Lattice {
    fn of(elements: &Elements, contacts: &[Contact], edge: usize) -> Self {
        let (mut corner, mut widest) = ([f64::INFINITY; 3], [0.0; 3]);
        for body in &elements.bodies {
            let mut mean = [0.0; 3];
            let count = body.mesh.elements();
            for e in 0..count {
                let places = body.mesh.places(e);
                for axis in 0..3 {
                    let low = places.iter().map(|x| x[axis]).fold(f64::INFINITY, f64::min);
                    let high = places.iter().map(|x| x[axis]).fold(f64::NEG_INFINITY, f64::max);
                    mean[axis] += (high - low) / count as f64;
                    corner[axis] = f64::min(corner[axis], low);
                }
            }
            (0..3).for_each(|axis| widest[axis] = f64::max(widest[axis], mean[axis]));
        }
        let size = widest.map(|h| if h > 0.0 { edge as f64 * h } else { 1.0 });
        let origin = [0, 1, 2].map(|axis| {
            let planes = facing(elements, contacts, axis);
            let step = size[axis] / edge as f64;
            // As far from every plane of contacts as whole elements let it be.
            let distance = |shift: usize| {
                let origin = corner[axis] + shift as f64 * step;
                let off = planes.iter().map(|x| ((x - origin) / size[axis]).rem_euclid(1.0));
                off.map(|off| off.min(1.0 - off)).fold(f64::INFINITY, f64::min)
            };
            let best =
                (0..edge).fold(0, |best, next| if distance(next) > distance(best) { next } else { best });
            corner[axis] + best as f64 * step
        });
        Self { origin, size }
    }

    fn cell(&self, x: [f64; 3]) -> [i64; 3] {
        [0, 1, 2].map(|axis| ((x[axis] - self.origin[axis]) / self.size[axis]).floor() as i64)
    }
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
