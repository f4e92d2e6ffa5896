//! What one part is made of, as plain lists: they travel between processes and stand in files.

use std::collections::{HashMap, HashSet};

use crate::convex::patches::{ElementMatrices, Elements, Group};
use crate::convex::sharing::groups;
use crate::error::Refusal;
use crate::pencil::Gap;
use crate::sparse::SparseVector;

/// The elements and contacts of one part. Numbers in it are local: unknown i is `unknowns[i]` of the whole mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Share {
    /// The unknowns of the part by their numbers in the whole mesh, ascending.
    pub unknowns: Vec<u64>,
    /// The elements.
    pub elements: Elements,
    /// The patch of each element.
    pub patch: Vec<usize>,
    /// The contacts, or shares of them.
    pub contacts: Vec<Gap>,
    /// The patch that carries each contact; none where contacts are to be shared out among the patches of the part.
    pub carrier: Option<Vec<usize>>,
}

/// Refuses what does not fit.
fn fits(place: &str, holds: bool, value: impl ToString, allowed: &str) -> Result<(), Refusal> {
    if holds { Ok(()) } else { Err(Refusal::new(place, value, allowed)) }
}

impl Share {
    /// Refuses numbers that mean nothing: what comes from a file may be anything.
    ///
    /// # Errors
    /// Lists of lengths that do not fit together, numbers out of range, matrices that are not finite, square and symmetric.
    pub fn check(&self) -> Result<(), Refusal> {
        let n = self.unknowns.len();
        fits("unknowns", n > 0 && n < u32::MAX as usize, n, "1 to 2^32 - 2 of them")?;
        fits("unknowns", self.unknowns.is_sorted_by(|a, b| a < b), "unsorted numbers", "ascending ones")?;
        let count = self.elements.elements.len();
        fits("element_patch", self.patch.len() == count, self.patch.len(), "one number for each element")?;
        for (at, shape) in self.elements.shapes.iter().enumerate() {
            check_shape(at, shape)?;
        }
        for (at, (shape, unknowns)) in self.elements.elements.iter().enumerate() {
            let place = format!("element {at}");
            let known = self.elements.shapes.get(*shape).map(|s| s.mass.len().isqrt());
            fits(&place, known == Some(unknowns.len()), unknowns.len(), "as many unknowns as its shape has")?;
            let inside = unknowns.iter().flatten().all(|u| (*u as usize) < n);
            fits(&place, inside, format!("{unknowns:?}"), "unknowns of the part")?;
        }
        if let Some(carrier) = &self.carrier {
            let lengths = carrier.len() == self.contacts.len();
            fits("gap_patch", lengths, carrier.len(), "one number for each contact")?;
            let known: HashSet<usize> = self.patch.iter().copied().collect();
            let unknown = carrier.iter().find(|p| !known.contains(p));
            fits("gap_patch", unknown.is_none(), format!("{unknown:?}"), "the number of a patch")?;
        }
        Ok(())
    }

    /// The patches with the contacts that they carry.
    pub(super) fn groups(&self) -> Result<Vec<Group>, Refusal> {
        let Some(carrier) = &self.carrier else {
            return groups(&self.contacts, self.unknowns.len(), &self.elements, &self.patch);
        };
        let count = self.patch.iter().max().map_or(0, |most| most + 1);
        let mut found = vec![Group::default(); count];
        self.patch.iter().enumerate().for_each(|(e, p)| found[*p].0.push((e, 1.0)));
        carrier.iter().zip(&self.contacts).for_each(|(p, c)| found[*p].1.push(c.clone()));
        found.retain(|(members, _)| !members.is_empty());
        Ok(found)
    }

    /// Takes some patches out of a whole mesh of contacts already shared out. A share of an element is an element with
    /// that share of its matrices.
    pub(super) fn of(elements: &Elements, chosen: &[&Group]) -> Self {
        let mut share = Self::default();
        let members = || chosen.iter().flat_map(|(members, _)| members.iter().copied());
        let unknowns = members().flat_map(|(e, _)| elements.elements[e].1.iter().flatten());
        share.unknowns = unknowns.map(|u| u64::from(*u)).collect();
        share.unknowns.sort_unstable();
        share.unknowns.dedup();
        // Every number that is looked up was put there above.
        let local = |u: u32| share.unknowns.partition_point(|known| *known < u64::from(u)) as u32;
        let mut shapes: HashMap<(usize, u64), usize> = HashMap::new();
        for (e, part) in members() {
            let (shape, unknowns) = &elements.elements[e];
            let next = shapes.len();
            let number = *shapes.entry((*shape, part.to_bits())).or_insert(next);
            if number == share.elements.shapes.len() {
                share.elements.shapes.push(scaled(&elements.shapes[*shape], part));
            }
            share.elements.elements.push((number, unknowns.iter().map(|u| u.map(local)).collect()));
        }
        let mut carrier = Vec::new();
        for (number, (members, contacts)) in chosen.iter().enumerate() {
            share.patch.extend(members.iter().map(|_| number));
            for contact in contacts {
                let column = contact.column.0.iter().map(|(u, z)| (local(*u), *z)).collect();
                share.contacts.push(Gap { column: SparseVector(column), ..contact.clone() });
                carrier.push(number);
            }
        }
        share.carrier = Some(carrier);
        share
    }
}

fn scaled(shape: &ElementMatrices, part: f64) -> ElementMatrices {
    let times = |matrix: &[f64]| matrix.iter().map(|v| part * v).collect();
    ElementMatrices { stiffness: times(&shape.stiffness), mass: times(&shape.mass) }
}

fn check_shape(at: usize, shape: &ElementMatrices) -> Result<(), Refusal> {
    let size = shape.mass.len().isqrt();
    let place = format!("shape {at}");
    let square = size * size == shape.mass.len() && shape.stiffness.len() == shape.mass.len();
    fits(
        &place,
        square,
        format!("{} and {} entries", shape.stiffness.len(), shape.mass.len()),
        "two squares",
    )?;
    for matrix in [&shape.stiffness, &shape.mass] {
        let symmetric = (0..size).all(|i| (0..i).all(|j| matrix[i * size + j] == matrix[j * size + i]));
        fits(&place, symmetric, "a matrix that is not", "a symmetric one")?;
        fits(&place, matrix.iter().all(|v| v.is_finite()), "a number that is not", "finite ones")?;
    }
    Ok(())
}
