//! Unknowns of which some are the gaps themselves, so that t P stands on their diagonal alone.
//!
//! Each gap z_j takes an unknown s that no earlier gap took, of one of its largest entries, and gives it up for itself:
//!
//! ```text
//! x_s = y_s - sum_k (z_k/z_s) x_k      over the unknowns k that no gap took, so that z_j'x = z_s y_s + earlier gaps
//! x = T y      T'(u M - a K - t P) T      P becomes C' W C, C = Z'T with columns at the unknowns taken alone
//! ```
//! A row of T that a gap took has 1 at its own unknown and besides only unknowns taken later, or by none: in that order T is
//! unit triangular, whatever its entries were rounded to, and T'AT is semidefinite exactly where A is. Gaps that depend on earlier ones
//! find no unknown and need none. That of node to face is the node, which occurs in no other gap, and T has no more entries than Z.
//!
//! What a row of T rounds by leaves Z'T with remainders at unknowns that no gap took, some eps of its entries. They belong to the
//! pencil: C is evaluated with twice the digits, and its entries carry what even that may be off.

use std::collections::{BTreeMap, HashMap};

use super::factor::{Weighted, rounding};
use crate::double_double::Dd;
use crate::pencil::{Gap, Matrix};
use crate::sparse::Csr;

/// An unknown is taken if its entry is no smaller than this part of the largest: no multiplier exceeds its inverse.
const PIVOT: f64 = 0.5;

/// What is left of a gap that others already determine is rounding, by no more than this of its entries.
const NOTHING: f64 = 1e-8;

/// Products of two entries no smaller than this, and no larger than its inverse, can be had with twice the digits.
const SMALLEST: f64 = 1e-100;

/// Entries in the rows of T for each of Z, and for any pencil: beyond, T fills up like an inverse.
const FILL: (usize, usize) = (8, 20_000);

/// The rows of T that differ from those of the identity.
#[derive(Debug)]
pub(super) struct GapUnknowns {
    rows: HashMap<u32, Form>,
}

/// T'AT, rounded: its entries are off by no more than `unit` of those of |T|'|A||T|.
pub(super) struct Congruent {
    pub matrix: Matrix,
    pub unit: f64,
}

/// Unknowns with factors.
type Form = Vec<(u32, f64)>;

/// Rows under elimination: x_s less y_s, with the place of s in the order.
#[derive(Default)]
struct Elimination {
    order: HashMap<u32, usize>,
    rows: Vec<(u32, Form)>,
}

impl Elimination {
    /// A form of x in the unknowns: what it has of those taken, by their values y, and of all others.
    fn substituted(&self, form: &[(u32, f64)]) -> (Form, Form) {
        let place = |i: u32| (self.order.get(&i).copied().unwrap_or(usize::MAX), i);
        let mut left: BTreeMap<(usize, u32), f64> = form.iter().map(|(i, z)| (place(*i), *z)).collect();
        let mut taken = Vec::new();
        while let Some(((order, i), z)) = left.pop_first() {
            if order == usize::MAX {
                left.insert((order, i), z);
                break;
            }
            taken.push((i, z));
            // All of them stand later in the order.
            self.rows[order].1.iter().for_each(|(k, c)| *left.entry(place(*k)).or_default() += z * c);
        }
        (taken, left.into_iter().map(|((_, i), z)| (i, z)).collect())
    }

    /// Lets a gap take an unknown, if one is left to it.
    ///
    /// One that occurs in few gaps, for short rows, and is light: what a heavy one gives up is nearly all of the mass of the others.
    fn take(&mut self, gap: &Gap, occurrences: &HashMap<u32, usize>, masses: &[f64]) {
        let largest = |form: &[(u32, f64)]| form.iter().map(|(_, z)| z.abs()).fold(0.0, f64::max);
        let (_, free) = self.substituted(&gap.column.0);
        let most = largest(&free);
        if most <= NOTHING * largest(&gap.column.0) {
            return;
        }
        let rare = |i: &u32| std::cmp::Reverse(occurrences.get(i).copied().unwrap_or(0));
        let worth = |(i, z): &(u32, f64)| (rare(i), z * z / masses[*i as usize]);
        let choice = free
            .iter()
            .filter(|(_, z)| z.abs() >= PIVOT * most)
            .max_by(|a, b| worth(a).0.cmp(&worth(b).0).then(worth(a).1.total_cmp(&worth(b).1)));
        let Some((s, pivot)) = choice.copied() else { return };
        let row = free.iter().filter(|(i, z)| *i != s && *z != 0.0).map(|(i, z)| (*i, -z / pivot)).collect();
        self.order.insert(s, self.rows.len());
        self.rows.push((s, row));
    }
}

impl GapUnknowns {
    /// The unknowns of these contacts among some of these masses, those of the largest scales first: `None` where T fills up, or entries leave the range
    /// in which twice the digits can be had.
    pub fn new(contacts: &[Gap], masses: &[f64]) -> Option<Self> {
        let entries = || contacts.iter().flat_map(|contact| &contact.column.0);
        if entries().any(|(_, z)| *z != 0.0 && !(SMALLEST..1.0 / SMALLEST).contains(&z.abs())) {
            return None;
        }
        let most = FILL.0 * entries().count() + FILL.1;
        let mut occurrences: HashMap<u32, usize> = HashMap::new();
        entries().for_each(|(i, _)| *occurrences.entry(*i).or_default() += 1);
        let mut order: Vec<&Gap> = contacts.iter().collect();
        order.sort_by(|a, b| b.scale.total_cmp(&a.scale));
        let (mut elimination, mut filled) = (Elimination::default(), 0);
        for gap in order {
            elimination.take(gap, &occurrences, masses);
            filled += elimination.rows.last().map_or(0, |(_, row)| row.len());
            if filled > most {
                return None;
            }
        }
        let mut rows = HashMap::new();
        let mut filled = 0;
        for (s, row) in &elimination.rows {
            let (taken, free) = elimination.substituted(row);
            let mut whole = [&[(*s, 1.0)], &taken[..], &free[..]].concat();
            // Whatever T is rounded to, it is T.
            whole.retain(|(_, c)| c.abs() >= SMALLEST);
            filled += whole.len();
            if filled > most || whole.iter().any(|(_, c)| !c.is_finite() || c.abs() > 1.0 / SMALLEST) {
                return None;
            }
            rows.insert(*s, whole);
        }
        Some(Self { rows })
    }

    /// Row i of T.
    fn row(&self, i: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        let given = self.rows.get(&i);
        let own = given.is_none().then_some((i, 1.0));
        own.into_iter().chain(given.into_iter().flatten().copied())
    }

    /// T'z of a gap, with what its entries are measured by: they are off by no more than rounding(1) of it.
    pub fn gap(&self, gap: &Gap) -> Weighted {
        let mut sums: BTreeMap<u32, (Dd, f64)> = BTreeMap::new();
        let mut terms = 0;
        for (i, z) in &gap.column.0 {
            for (k, c) in self.row(*i) {
                let (sum, size) = sums.entry(k).or_insert((Dd::from(0.0), 0.0));
                (*sum, *size) = (*sum + Dd::from(*z) * Dd::from(c), *size + (z * c).abs());
                terms += 1;
            }
        }
        // A sum of so many terms is off by 16 * 2^-106 of their sizes at each operation; halved into units of 2^-53.
        let unit = 16.0 * f64::EPSILON * (2 * terms) as f64;
        let entry = |(k, (sum, size)): (u32, (Dd, f64))| (k, sum.hi, sum.hi.abs() + unit * size);
        Weighted { scale: gap.scale, entries: sums.into_iter().map(entry).collect() }
    }

    /// T'AT.
    pub fn congruent(&self, matrix: &Matrix) -> Congruent {
        let n = matrix.size();
        let mut triplets: Vec<(u32, u32, f64)> = Vec::new();
        for i in 0..n {
            for (j, a) in matrix.row(i) {
                for (p, left) in self.row(i as u32) {
                    let right = self.row(j as u32).filter(|(q, _)| *q >= p);
                    triplets.extend(right.map(|(q, right)| (p, q, left * a * right)));
                }
            }
        }
        let counts: Vec<_> = triplets.iter().map(|(p, q, _)| (*p, *q, 1.0)).collect();
        let terms = Csr::from_triplets(n, n, &counts).parts().2.iter().copied().fold(0.0, f64::max);
        let upper = Csr::from_triplets(n, n, &triplets);
        let mut both = Vec::new();
        for p in 0..n {
            let (columns, values) = upper.row(p);
            for (q, value) in columns.iter().zip(values) {
                both.push((p as u32, *q, *value));
                if *q as usize != p {
                    both.push((*q, p as u32, *value));
                }
            }
        }
        let unit = rounding(terms as usize + 2);
        Congruent { matrix: Matrix::Sparse(Csr::from_triplets(n, n, &both)), unit }
    }

    /// The largest row sum of D |T|'|A||T| D.
    pub fn size(&self, matrix: &Matrix, scaling: &[f64]) -> f64 {
        let n = scaling.len();
        let spread =
            |i: usize, x: &[f64]| self.row(i as u32).map(|(k, c)| c.abs() * x[k as usize]).sum::<f64>();
        let at: Vec<f64> = (0..n).map(|i| spread(i, scaling)).collect();
        let mut sums = vec![0.0; n];
        for i in 0..n {
            let image: f64 = matrix.row(i).map(|(j, a)| a.abs() * at[j]).sum();
            self.row(i as u32).for_each(|(k, c)| sums[k as usize] += c.abs() * image);
        }
        sums.iter().zip(scaling).map(|(sum, d)| sum * d).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::GapUnknowns;
    use crate::pencil::{Gap, Matrix, Tridiagonal};
    use crate::sparse::SparseVector;

    fn gap(entries: &[(u32, f64)], scale: f64) -> Gap {
        Gap { column: SparseVector(entries.to_vec()), scale, initial: 0.0 }
    }

    /// Gaps that share unknowns, of unlike scales, the last but one the difference of the first two, and the last one again the first.
    fn contacts() -> Vec<Gap> {
        let (first, second) = ([(0, 0.6), (1, -0.3), (2, -0.7)], [(1, 0.9), (2, -0.35), (3, -0.55)]);
        let difference = [(0, 0.6), (1, -0.3 - 0.9), (2, -0.7 + 0.35), (3, 0.55)];
        vec![
            gap(&first, 1.0),
            gap(&second, 3.0),
            gap(&[(3, 1.0), (4, -1.0 / 3.0)], 1e-6),
            gap(&difference, 2.0),
            gap(&first, 0.5),
        ]
    }

    #[test]
    fn gaps_stand_at_the_unknowns_that_they_took() {
        let contacts = contacts();
        let unknowns = GapUnknowns::new(&contacts, &[1.0; 6]).unwrap();
        // As many as are independent.
        assert_eq!(unknowns.rows.len(), 3);
        let y = [0.3, -1.2, 0.7, 2.1, -0.4, 5.0];
        let x: Vec<f64> = (0..6).map(|i| unknowns.row(i).map(|(k, c)| c * y[k as usize]).sum()).collect();
        for contact in &contacts {
            let found = unknowns.gap(contact);
            let value: f64 = found.entries.iter().map(|(i, z, _)| z * y[*i as usize]).sum();
            assert!((value - contact.column.dot(&x)).abs() < 1e-14, "{contact:?}: {found:?}");
            for (i, z, size) in &found.entries {
                assert!(unknowns.rows.contains_key(i) || z.abs() < 1e-15, "{contact:?}: {found:?}");
                assert!(*size >= z.abs() && *size < z.abs() + 1e-12, "{contact:?}: {found:?}");
            }
        }
    }

    /// y'(T'AT) y = x'Ax, and |T|'|A||T| is no smaller.
    #[test]
    fn matrices_are_those_of_the_new_unknowns() {
        let unknowns = GapUnknowns::new(&contacts(), &[1.0; 6]).unwrap();
        let diagonal = vec![2.0, 3.0, 5.0, 7.0, 11.0, 13.0];
        let a = Matrix::Chain(Tridiagonal { diagonal, off_diagonal: vec![-1.0, 0.5, -1.5, 0.25, -2.0] });
        let congruent = unknowns.congruent(&a);
        let y = [0.3, -1.2, 0.7, 2.1, -0.4, 5.0];
        let x: Vec<f64> = (0..6).map(|i| unknowns.row(i).map(|(k, c)| c * y[k as usize]).sum()).collect();
        let (old, new) = (a.quadratic(&x, &x), congruent.matrix.quadratic(&y, &y));
        assert!((old - new).abs() < 1e-14 * old, "{old} {new}");
        let ones = unknowns.size(&a, &[1.0; 6]);
        let rows = (0..6).map(|i| congruent.matrix.row(i).map(|(_, a)| a.abs()).sum::<f64>());
        let most = rows.fold(0.0, f64::max);
        assert!(ones >= most && ones < 10.0 * most, "{ones} {most}");
    }

    #[test]
    fn the_light_unknown_of_a_gap_is_taken() {
        let contact = [gap(&[(0, 1.0), (1, -1.0)], 1.0)];
        for (masses, taken) in [([1.0, 0.1], 1), ([0.1, 1.0], 0)] {
            assert!(GapUnknowns::new(&contact, &masses).unwrap().rows.contains_key(&taken), "{masses:?}");
        }
    }
}
