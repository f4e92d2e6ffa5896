//! Proofs by patches of elements: no matrix of the whole mesh, O(n) work, in parallel.
//!
//! Let the patches p share out the elements and the contacts, K = sum K_p, M = sum M_p, P = sum P_p. Where every u M_p - a K_p - t P_p is
//! semidefinite, so is their sum: l_max(a K + t P, M) <= max_p l_max(a K_p + t P_p, M_p) (mediant inequality). Elements as
//! patches give the element bound of other codes, one patch gives the exact value. A contact goes to patches that
//! hold all its unknowns, its scale shared out like the stiffness z'K_p z that their elements give it. Any shares that
//! are not negative and add up are right, for either sign of t. What the rounding of sums and shares may take from
//! u M - a K - t P is at most e D, e = g(q) max_i (row sums of |K_e|, u |M_e| and |t P| at i)/d_i, D = diag(M) = sum diag(M_p): each
//! patch proves that much more.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

pub use super::elements::{ElementMatrices, Elements};
use super::factor::{Factorisation, TooLarge, Verdict};
use super::pencil::MeshPencil;
use super::sharing;
use crate::error::Refusal;
use crate::interrupt;
use crate::pencil::Gap;
use crate::sparse::SparseVector;

/// An element of a patch, and the share of it that is in this patch.
pub type Member = (usize, f64);

/// The elements and contacts of a patch.
pub type Group = (Vec<Member>, Vec<Gap>);

/// A patch of each element by the box of a grid that its centre lies in; `size` are the edges of the boxes.
pub fn boxes(centres: &[[f64; 3]], size: [f64; 3]) -> Vec<usize> {
    let corner = |axis: usize| centres.iter().map(|c| c[axis]).fold(f64::INFINITY, f64::min);
    let origin = [corner(0), corner(1), corner(2)];
    let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
    let cell = |c: &[f64; 3]| [0, 1, 2].map(|axis| ((c[axis] - origin[axis]) / size[axis]) as u64);
    centres
        .iter()
        .map(|c| {
            let next = numbers.len();
            *numbers.entry(cell(c)).or_insert(next)
        })
        .collect()
}

/// Patches as pencils of their own; identical ones are kept once.
#[derive(Debug)]
pub struct Patches {
    distinct: Vec<Patch>,
    total: usize,
    /// Row sums of |K_e|, |M_e| and |P|, as far as it is shared out, over diag(M), and roundings, of the sum of all patches.
    sizes: (f64, f64, f64, usize),
}

impl Patches {
    /// The patches of a mesh: `patch` numbers the patch of each element. Two patches that contacts join become one as long as
    /// that is no more than [`sharing::JOINED`] times as large as the largest was; elsewhere the elements that a contact touches are
    /// shared out to the patch that takes it.
    ///
    /// # Errors
    /// An unknown without an element, or a patch that is too large to factorise in `memory` bytes.
    pub fn new(
        pencil: &MeshPencil,
        elements: &Elements,
        patch: &[usize],
        memory: usize,
    ) -> Result<Self, Refusal> {
        let groups = sharing::groups(pencil.contacts(), pencil.size(), elements, patch)?;
        let mut patches = Self::of(pencil, elements, &groups, memory)?;
        patches.sizes.2 = penalty_size(pencil);
        Ok(patches)
    }

    /// The patches of a mesh whose contacts are those of the patches, term by term: nothing is shared out any more.
    ///
    /// # Errors
    /// A patch that is too large to factorise in `memory` bytes.
    pub fn of(
        pencil: &MeshPencil,
        elements: &Elements,
        groups: &[Group],
        memory: usize,
    ) -> Result<Self, Refusal> {
        let mut seen = HashMap::new();
        groups.iter().enumerate().for_each(|(g, group)| {
            seen.entry(key(elements, group)).or_insert(g);
        });
        let mut kept: Vec<usize> = seen.into_values().collect();
        kept.sort_unstable();
        let watch = interrupt::handed();
        let one = |g: usize| {
            watch.look();
            build(elements, &groups[g], memory)
        };
        let distinct = kept.into_par_iter().map(one).collect::<Result<_, _>>()?;
        let (k, m, count) = elements.sizes(pencil.mass_diagonal());
        Ok(Self { distinct, total: groups.len(), sizes: (k, m, 0.0, count + 64) })
    }

    /// Number of patches, and of those among them that differ.
    pub fn counts(&self) -> (usize, usize) {
        (self.total, self.distinct.len())
    }

    /// Bytes of the factors of all different patches: no more are held at a time.
    pub fn memory(&self) -> usize {
        self.distinct.iter().map(|patch| patch.factorisation.memory()).sum()
    }

    /// Unknowns of the largest patch.
    pub fn largest(&self) -> usize {
        self.distinct.iter().map(|patch| patch.pencil.size()).max().unwrap_or(0)
    }

    /// Whether u M - a K - t P is positive semidefinite, patch by patch.
    pub fn prove(&self, u: f64, a: f64, t: f64, margin: f64) -> Verdict {
        let (k, m, p, count) = self.sizes;
        // diag(M_p), scaled by powers of two, lies below 2; the rounding of shares and sums is covered by doubling.
        let unit = 4.0 * super::factor::rounding(count);
        let lost = Lost { mass: unit * m, other: unit * (a.abs() * k + t.abs() * p) };
        let watch = interrupt::handed();
        let verdict = |patch: &Patch| {
            watch.look();
            patch.prove(u, (a, t), margin, lost)
        };
        self.distinct.par_iter().map(verdict).reduce(|| Verdict::Proven, worse)
    }
}

impl Patches {
    /// Whether M >= `share` diag(M)/2, patch by patch.
    pub(super) fn proves_mass(&self, share: f64) -> bool {
        let lost = 4.0 * super::factor::rounding(self.sizes.3) * self.sizes.1;
        let margin = (1.0 + MASS_MARGIN) * share + 2.0 * lost + MASS_MARGIN;
        let proves = |patch: &Patch| {
            patch.factorisation.prove_beyond(1.0, (0.0, 0.0), margin, share + lost) == Verdict::Proven
        };
        self.distinct.par_iter().all(proves)
    }
}

/// What the rounding of sums and shares may take, in units of D: mass u + other.
#[derive(Debug, Clone, Copy)]
struct Lost {
    mass: f64,
    other: f64,
}

/// A patch with what is known about it.
#[derive(Debug)]
struct Patch {
    pencil: MeshPencil,
    factorisation: Factorisation,
    /// Of a patch without contacts: a u that is proven for a = 1, with what rounding was allowed to take besides u.
    known: Mutex<Option<(f64, f64)>>,
}

impl Patch {
    fn prove(&self, u: f64, (a, t): (f64, f64), margin: f64, lost: Lost) -> Verdict {
        let beyond = |u: f64| lost.mass * u + lost.other;
        let free = self.pencil.contacts().is_empty() && a == 1.0;
        // No panic happens while it is held; and what is known stays true after one.
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if free && known().is_some_and(|(least, other)| u >= least && lost.other <= other) {
            return Verdict::Proven;
        }
        let verdict = self.factorisation.prove_beyond(u, (a, t), margin, beyond(u));
        // A larger u adds (u - least) D M D, which must be worth what rounding takes more: that is a proof of its own.
        let mass = || self.factorisation.prove_beyond(1.0, (0.0, 0.0), MASS_MARGIN, lost.mass);
        if free && verdict == Verdict::Proven && (known().is_some() || mass() == Verdict::Proven) {
            *known() = Some((u, lost.other));
        }
        verdict
    }
}

/// The part of M that may go to rounding where its own definiteness is proven; element masses are definite by far more.
const MASS_MARGIN: f64 = 1e-6;

/// The verdict on both of two patches.
fn worse(one: Verdict, other: Verdict) -> Verdict {
    match (one, other) {
        (Verdict::Refuted, _) | (_, Verdict::Refuted) => Verdict::Refuted,
        (Verdict::TooClose(a), Verdict::TooClose(b)) => Verdict::TooClose(a.max(b)),
        (Verdict::Proven, other) => other,
        (one, Verdict::Proven) => one,
    }
}

/// Unknowns of a patch, numbered in the order in which its elements name them.
fn numbering(elements: &Elements, members: &[Member]) -> HashMap<u32, u32> {
    let mut local = HashMap::new();
    for unknown in members.iter().flat_map(|(e, _)| elements.elements[*e].1.iter().flatten()) {
        let next = local.len() as u32;
        local.entry(*unknown).or_insert(next);
    }
    local
}

/// What two patches have in common exactly when their pencils are identical.
fn key(elements: &Elements, (members, carried): &Group) -> Vec<u64> {
    let local = numbering(elements, members);
    let mut key = Vec::new();
    for (e, share) in members {
        let (shape, unknowns) = &elements.elements[*e];
        key.extend([*shape as u64, share.to_bits()]);
        key.extend(unknowns.iter().map(|i| i.map_or(u64::MAX, |i| u64::from(local[&i]))));
    }
    for contact in carried {
        key.extend([u64::MAX - 1, contact.scale.to_bits()]);
        key.extend(
            contact
                .column
                .0
                .iter()
                .flat_map(|(i, z)| [local.get(i).map_or(u64::MAX, |i| u64::from(*i)), z.to_bits()]),
        );
    }
    key
}

fn build(elements: &Elements, (members, carried): &Group, memory: usize) -> Result<Patch, Refusal> {
    let local = numbering(elements, members);
    let (stiffness, mass) = elements.assemble_some(members, local.len(), |i| local[&i]);
    let contacts = carried
        .iter()
        .map(|contact| {
            let mut gap: Vec<(u32, f64)> =
                contact.column.0.iter().filter_map(|(i, z)| Some((*local.get(i)?, *z))).collect();
            gap.sort_by_key(|(i, _)| *i);
            Gap { column: SparseVector(gap), ..*contact }
        })
        .collect();
    let pencil = MeshPencil::new(stiffness, mass, contacts)?;
    let factorisation = Factorisation::new(&pencil, memory).map_err(|TooLarge { needed, allowed }| {
        Refusal::new(
            "memory of a patch",
            format!("{needed} bytes"),
            format!("at most {allowed} bytes; smaller patches"),
        )
    })?;
    Ok(Patch { pencil, factorisation, known: Mutex::default() })
}

/// The largest row sum of sum_j w_j |z_j||z_j|' over diag(M).
fn penalty_size(pencil: &MeshPencil) -> f64 {
    let mut rows = vec![0.0; pencil.size()];
    for contact in pencil.contacts() {
        let sum: f64 = contact.column.0.iter().map(|(_, z)| z.abs()).sum();
        contact.column.0.iter().for_each(|(i, z)| rows[*i as usize] += contact.scale * z.abs() * sum);
    }
    rows.iter().zip(pencil.mass_diagonal()).map(|(p, d)| p / d).fold(0.0, f64::max)
}
