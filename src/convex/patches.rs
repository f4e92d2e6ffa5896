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

use rayon::prelude::*;

use super::factor::{Factorisation, TooLarge, Verdict};
use super::pencil::MeshPencil;
use super::sharing;
use crate::error::Refusal;
use crate::pencil::{Gap, Matrix};
use crate::sparse::{Csr, SparseVector};

/// Element matrices of one shape: many elements share them.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementMatrices {
    /// K_e by rows.
    pub stiffness: Vec<f64>,
    /// M_e by rows.
    pub mass: Vec<f64>,
}

/// An element of a patch, and the share of it that is in this patch.
pub(super) type Member = (usize, f64);

/// The elements and contacts of a patch.
pub(super) type Group = (Vec<Member>, Vec<Gap>);

/// The elements of a mesh.
#[derive(Debug, Clone, Default)]
pub struct Elements {
    /// Matrices that elements refer to.
    pub shapes: Vec<ElementMatrices>,
    /// For each element its shape and its unknowns; `None` is an unknown that is held.
    pub elements: Vec<(usize, Vec<Option<u32>>)>,
}

impl Elements {
    /// K and M of n unknowns, assembled; M is kept as a diagonal if every element has one.
    pub fn assemble(&self, n: usize) -> (Matrix, Matrix) {
        let all: Vec<Member> = (0..self.elements.len()).map(|e| (e, 1.0)).collect();
        self.assemble_some(&all, n, |unknown| unknown)
    }

    fn assemble_some(&self, which: &[Member], n: usize, local: impl Fn(u32) -> u32) -> (Matrix, Matrix) {
        let (mut k, mut m) = (Vec::new(), Vec::new());
        for (e, share) in which {
            let (shape, unknowns) = &self.elements[*e];
            let (matrices, size) = (&self.shapes[*shape], unknowns.len());
            for (i, row) in unknowns.iter().enumerate() {
                for (j, column) in unknowns.iter().enumerate() {
                    let (Some(row), Some(column)) = (row, column) else { continue };
                    let (row, column) = (local(*row), local(*column));
                    let at = i * size + j;
                    k.push((row, column, share * matrices.stiffness[at]));
                    if matrices.mass[at] != 0.0 {
                        m.push((row, column, share * matrices.mass[at]));
                    }
                }
            }
        }
        let mass = if m.iter().all(|(row, column, _)| row == column) {
            let mut diagonal = vec![0.0; n];
            m.iter().for_each(|(row, _, value)| diagonal[*row as usize] += value);
            Matrix::Diagonal(diagonal)
        } else {
            Matrix::Sparse(Csr::from_triplets(n, n, &m))
        };
        (Matrix::Sparse(Csr::from_triplets(n, n, &k)), mass)
    }

    /// The largest row sums of |K_e| and |M_e| over diag(M), and the most elements at an unknown.
    fn sizes(&self, diagonal: &[f64]) -> (f64, f64, usize) {
        let n = diagonal.len();
        let (mut k, mut m, mut count) = (vec![0.0; n], vec![0.0; n], vec![0_usize; n]);
        for (shape, unknowns) in &self.elements {
            let (matrices, size) = (&self.shapes[*shape], unknowns.len());
            for (i, row) in unknowns.iter().enumerate() {
                let Some(row) = row.map(|row| row as usize) else { continue };
                k[row] += matrices.stiffness[i * size..(i + 1) * size].iter().map(|v| v.abs()).sum::<f64>();
                m[row] += matrices.mass[i * size..(i + 1) * size].iter().map(|v| v.abs()).sum::<f64>();
                count[row] += 1;
            }
        }
        let most = |v: &[f64]| v.iter().zip(diagonal).map(|(v, d)| v / d).fold(0.0, f64::max);
        (most(&k), most(&m), count.into_iter().max().unwrap_or(0))
    }
}

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
    distinct: Vec<(MeshPencil, Factorisation)>,
    total: usize,
    /// Row sums of |K_e|, |M_e| and |P| over diag(M), and roundings, of the sum of all patches.
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
        let groups = sharing::groups(pencil, elements, patch)?;
        let total = groups.len();
        let mut seen = HashMap::new();
        groups.iter().enumerate().for_each(|(g, group)| {
            seen.entry(key(elements, group)).or_insert(g);
        });
        let mut kept: Vec<usize> = seen.into_values().collect();
        kept.sort_unstable();
        let distinct =
            kept.into_par_iter().map(|g| build(elements, &groups[g], memory)).collect::<Result<_, _>>()?;
        let (k, m, count) = elements.sizes(pencil.mass_diagonal());
        Ok(Self { distinct, total, sizes: (k, m, penalty_size(pencil), count + 64) })
    }

    /// Number of patches, and of those among them that differ.
    pub fn counts(&self) -> (usize, usize) {
        (self.total, self.distinct.len())
    }

    /// Bytes of the factors of all different patches: no more are held at a time.
    pub fn memory(&self) -> usize {
        self.distinct.iter().map(|(_, factorisation)| factorisation.memory()).sum()
    }

    /// Unknowns of the largest patch.
    pub fn largest(&self) -> usize {
        self.distinct.iter().map(|(pencil, _)| pencil.size()).max().unwrap_or(0)
    }

    /// Whether u M - a K - t P is positive semidefinite, patch by patch.
    pub fn prove(&self, u: f64, a: f64, t: f64, margin: f64) -> Verdict {
        let (k, m, p, count) = self.sizes;
        // diag(M_p), scaled by powers of two, lies below 2; the rounding of shares and sums is covered by doubling.
        let lost = 4.0 * super::factor::rounding(count) * (a.abs() * k + u * m + t.abs() * p);
        let verdict = |(_, factorisation): &(MeshPencil, Factorisation)| {
            factorisation.prove_beyond(u, (a, t), margin, lost)
        };
        self.distinct.par_iter().map(verdict).reduce(|| Verdict::Proven, worse)
    }
}

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

fn build(
    elements: &Elements,
    (members, carried): &Group,
    memory: usize,
) -> Result<(MeshPencil, Factorisation), Refusal> {
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
    Ok((pencil, factorisation))
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
