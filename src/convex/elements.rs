//! Elements by their matrices: what patches and parts are made of.

use rayon::prelude::*;

use super::patches::Member;
use crate::pencil::Matrix;
use crate::sparse::Csr;

/// Element matrices of one shape: many elements share them.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementMatrices {
    /// K_e by rows.
    pub stiffness: Vec<f64>,
    /// M_e by rows.
    pub mass: Vec<f64>,
}

/// The elements of a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Elements {
    /// Matrices that elements refer to.
    pub shapes: Vec<ElementMatrices>,
    /// For each element its shape and its unknowns; `None` is an unknown that is held.
    pub elements: Vec<(usize, Vec<Option<u32>>)>,
}

/// Rows that one task assembles.
const ROWS: usize = 4096;

impl Elements {
    /// K and M of n unknowns, assembled; M is kept as a diagonal if every element has one.
    pub fn assemble(&self, n: usize) -> (Matrix, Matrix) {
        let all: Vec<Member> = (0..self.elements.len()).map(|e| (e, 1.0)).collect();
        self.assemble_some(&all, n, |unknown| unknown)
    }

    /// K and M of some elements and shares of them, whose unknowns `local` numbers below n. Row by row: no list of all entries is held.
    pub(super) fn assemble_some(
        &self,
        which: &[Member],
        n: usize,
        local: impl Fn(u32) -> u32 + Sync,
    ) -> (Matrix, Matrix) {
        let at = Incidence::of(self, which, n, &local);
        let diagonal = self.shapes.iter().all(ElementMatrices::has_diagonal_mass);
        let mass = if diagonal {
            let sum = |row: usize| at.of_row(row).map(|(e, i, share)| share * self.entry(e, i, i).1).sum();
            Matrix::Diagonal((0..n).map(sum).collect())
        } else {
            Matrix::Sparse(self.rows(&at, n, &local, |entry| Some(entry.1).filter(|m| *m != 0.0)))
        };
        (Matrix::Sparse(self.rows(&at, n, &local, |entry| Some(entry.0))), mass)
    }

    /// Entry (i, j) of K_e and M_e.
    fn entry(&self, e: usize, i: usize, j: usize) -> (f64, f64) {
        let (shape, unknowns) = &self.elements[e];
        let (matrices, at) = (&self.shapes[*shape], i * unknowns.len() + j);
        (matrices.stiffness[at], matrices.mass[at])
    }

    /// Entries of one place are added in the order of the elements, so that (i, j) and (j, i) get the same bits.
    fn rows(
        &self,
        at: &Incidence,
        n: usize,
        local: &(impl Fn(u32) -> u32 + Sync),
        part: impl Fn((f64, f64)) -> Option<f64> + Sync,
    ) -> Csr {
        let chunk = |first: usize| {
            let rows = first..(first + ROWS).min(n);
            let mut found: (Vec<usize>, Vec<u32>, Vec<f64>) = Default::default();
            let mut entries: Vec<(u32, f64)> = Vec::new();
            for row in rows {
                entries.clear();
                for (e, i, share) in at.of_row(row) {
                    for (j, unknown) in self.elements[e].1.iter().enumerate() {
                        let entry =
                            unknown.and_then(|u| Some((local(u), share * part(self.entry(e, i, j))?)));
                        entries.extend(entry);
                    }
                }
                entries.sort_by_key(|(column, _)| *column);
                let before = found.1.len();
                for (column, value) in &entries {
                    match found.2.last_mut() {
                        Some(sum) if found.1.len() > before && found.1.last() == Some(column) => {
                            *sum += value
                        }
                        _ => {
                            found.1.push(*column);
                            found.2.push(*value);
                        }
                    }
                }
                found.0.push(found.1.len() - before);
            }
            found
        };
        let chunks: Vec<_> = (0..n.div_ceil(ROWS)).into_par_iter().map(|c| chunk(c * ROWS)).collect();
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for (lengths, mut next, mut more) in chunks {
            lengths.iter().for_each(|length| starts.push(starts[starts.len() - 1] + length));
            columns.append(&mut next);
            values.append(&mut more);
        }
        Csr::from_parts(n, starts, columns, values)
    }

    /// The largest row sums of |K_e| and |M_e| over diag(M), and the most elements at an unknown.
    pub fn sizes(&self, diagonal: &[f64]) -> (f64, f64, usize) {
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

impl ElementMatrices {
    fn has_diagonal_mass(&self) -> bool {
        let size = self.mass.len().isqrt();
        self.mass.iter().enumerate().all(|(at, m)| *m == 0.0 || at % (size + 1) == 0)
    }
}

/// The elements at each unknown in their order, with the place of the unknown in each and the share of it.
struct Incidence {
    starts: Vec<usize>,
    places: Vec<(u32, u16, f64)>,
}

impl Incidence {
    fn of(elements: &Elements, which: &[Member], n: usize, local: &impl Fn(u32) -> u32) -> Self {
        let all = || {
            which.iter().flat_map(|(e, share)| {
                let unknowns = elements.elements[*e].1.iter().enumerate();
                unknowns.filter_map(move |(i, u)| Some(((*e as u32, i as u16, *share), (*u)?)))
            })
        };
        let mut starts = vec![0; n + 1];
        all().for_each(|(_, u)| starts[local(u) as usize + 1] += 1);
        (0..n).for_each(|row| starts[row + 1] += starts[row]);
        let (mut next, mut places) = (starts.clone(), vec![(0, 0, 0.0); starts[n]]);
        for (place, u) in all() {
            let row = local(u) as usize;
            places[next[row]] = place;
            next[row] += 1;
        }
        Self { starts, places }
    }

    fn of_row(&self, row: usize) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let range = self.starts[row]..self.starts[row + 1];
        self.places[range].iter().map(|(e, i, share)| (*e as usize, *i as usize, *share))
    }
}
