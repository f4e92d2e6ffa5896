//! The rows of a node times u: the loops at the bottom of a step of a mesh.
//!
//! They wait for memory. Values come in one stream, but in pages of 4 KiB, at each of which a processor stops to read ahead,
//! and the rows of a node are too long for it to look past them: so each block asks for values some blocks further on.

use super::kernels::Instructions;

/// Entries between the block that is multiplied and what is read ahead: some lines of a cache, less than a page.
const AHEAD: usize = 384;

/// Consecutive rows of nodes with D directions each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nodes<'a> {
    /// The first column of every block, node by node.
    pub blocks: &'a [u32],
    /// Where each row starts among all values of the matrix; one more at the end.
    pub starts: &'a [usize],
    /// The values of these rows.
    pub values: &'a [f64],
}

impl<'a> Nodes<'a> {
    /// Takes the first node off: its blocks and its rows.
    #[inline(always)]
    fn take<const D: usize>(&mut self) -> (&'a [u32], [&'a [f64]; D]) {
        let length = self.starts[1] - self.starts[0];
        let (blocks, others) = self.blocks.split_at(length / D);
        let mut rows = [&[][..]; D];
        for row in &mut rows {
            let after;
            (*row, after) = self.values.split_at(length);
            self.values = after;
        }
        (self.blocks, self.starts) = (others, &self.starts[D..]);
        (blocks, rows)
    }
}

/// Asks for the values that will be needed after block `at` of a node whose values start here.
#[inline(always)]
#[allow(unsafe_code)]
fn read_ahead(values: &[f64], entries: usize, at: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let there = values.as_ptr().wrapping_add(AHEAD + entries * at);
        // SAFETY: part of every x86-64, and a hint: an address that is not mapped is ignored.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(there.cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (values, entries, at);
}

/// Two rows of a node times u; the columns come in pairs. Sums run over each direction by itself.
#[inline(always)]
pub(super) fn pair(blocks: &[u32], rows: [&[f64]; 2], u: &[f64]) -> [f64; 2] {
    let [a, b] = rows.map(|row| row.as_chunks::<2>().0);
    let (mut x, mut y) = ([0.0; 2], [0.0; 2]);
    for (at, ((block, a), b)) in blocks.iter().zip(a).zip(b).enumerate() {
        read_ahead(rows[0], 4, at);
        let u = &u[*block as usize..][..2];
        x = [x[0] + a[0] * u[0], x[1] + a[1] * u[1]];
        y = [y[0] + b[0] * u[0], y[1] + b[1] * u[1]];
    }
    [x[0] + x[1], y[0] + y[1]]
}

/// Three rows of a node times u; the columns come in threes.
#[inline(always)]
pub(super) fn triple(blocks: &[u32], rows: [&[f64]; 3], u: &[f64]) -> [f64; 3] {
    let [a, b, c] = rows.map(|row| row.as_chunks::<3>().0);
    let mut sums = [[0.0; 3]; 3];
    for (at, (((block, a), b), c)) in blocks.iter().zip(a).zip(b).zip(c).enumerate() {
        read_ahead(rows[0], 9, at);
        let u = &u[*block as usize..][..3];
        for (sum, row) in sums.iter_mut().zip([a, b, c]) {
            *sum = [sum[0] + row[0] * u[0], sum[1] + row[1] * u[1], sum[2] + row[2] * u[2]];
        }
    }
    sums.map(|sum| sum[0] + sum[1] + sum[2])
}

/// Two rows of every node times u; the same bytes whatever the instructions.
#[allow(unsafe_code)]
pub(super) fn pairs(set: Instructions, nodes: Nodes<'_>, u: &[f64], pulls: &mut [f64]) {
    match set {
        Instructions::Baseline => pairs_loop(nodes, u, pulls),
        // SAFETY: `Avx2` is made by `Instructions::detect` alone, after it has found the feature.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { pairs_avx2(nodes, u, pulls) },
    }
}

fn pairs_loop(mut nodes: Nodes<'_>, u: &[f64], pulls: &mut [f64]) {
    for to in pulls.as_chunks_mut::<2>().0 {
        let (blocks, rows) = nodes.take();
        *to = pair(blocks, rows, u);
    }
}

/// Four lanes: the two directions of one row, then those of the other one.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn pairs_avx2(mut nodes: Nodes<'_>, u: &[f64], pulls: &mut [f64]) {
    use core::arch::x86_64::{
        _mm_add_pd, _mm_cvtsd_f64, _mm_unpackhi_pd, _mm256_add_pd, _mm256_castpd256_pd128,
        _mm256_extractf128_pd, _mm256_mul_pd, _mm256_set_pd, _mm256_setzero_pd,
    };
    for to in pulls.as_chunks_mut::<2>().0 {
        let (blocks, [a, b]) = nodes.take();
        let mut sums = _mm256_setzero_pd();
        let pairs = a.as_chunks::<2>().0.iter().zip(b.as_chunks::<2>().0);
        for (at, (block, (k, l))) in blocks.iter().zip(pairs).enumerate() {
            read_ahead(a, 4, at);
            let u = &u[*block as usize..][..2];
            let u = _mm256_set_pd(u[1], u[0], u[1], u[0]);
            sums = _mm256_add_pd(sums, _mm256_mul_pd(_mm256_set_pd(l[1], l[0], k[1], k[0]), u));
        }
        let both = [_mm256_castpd256_pd128(sums), _mm256_extractf128_pd::<1>(sums)];
        *to = both.map(|row| _mm_cvtsd_f64(_mm_add_pd(row, _mm_unpackhi_pd(row, row))));
    }
}

/// Three rows of every node times u.
pub(super) fn triples(mut nodes: Nodes<'_>, u: &[f64], pulls: &mut [f64]) {
    for to in pulls.as_chunks_mut::<3>().0 {
        let (blocks, rows) = nodes.take();
        *to = triple(blocks, rows, u);
    }
}

#[cfg(test)]
mod tests {
    use super::{Instructions, Nodes, pairs, triples};

    /// Nodes with one, two, ... blocks each, and a vector; unlike numbers.
    fn unlike(directions: usize) -> (Vec<u32>, Vec<usize>, Vec<f64>, Vec<f64>) {
        let u: Vec<f64> = (0..40 * directions).map(|i| (i as f64).sin()).collect();
        let (mut blocks, mut starts, mut values) = (Vec::new(), vec![0], Vec::new());
        for node in 0..12 {
            blocks.extend((0..=node).map(|at| (((at * 3 + node) % 40) * directions) as u32));
            for _ in 0..directions {
                let row = (0..(node + 1) * directions).map(|at| ((values.len() + at) as f64).cos() * 1e3);
                let row: Vec<f64> = row.collect();
                values.extend(row);
                starts.push(values.len());
            }
        }
        (blocks, starts, values, u)
    }

    /// Row by row, each direction by itself.
    fn expected(
        (blocks, starts, values, u): &(Vec<u32>, Vec<usize>, Vec<f64>, Vec<f64>),
        d: usize,
    ) -> Vec<u64> {
        let mut first = 0;
        let mut sums = Vec::new();
        for (row, ends) in starts.windows(2).enumerate() {
            let row_values = &values[ends[0]..ends[1]];
            let count = row_values.len() / d;
            let direction = |way: usize| {
                (0..count).fold(0.0, |sum, at| {
                    sum + row_values[at * d + way] * u[blocks[first + at] as usize + way]
                })
            };
            sums.push((1..d).fold(direction(0), |sum, way| sum + direction(way)).to_bits());
            first += if row % d == d - 1 { count } else { 0 };
        }
        sums
    }

    #[test]
    fn rows_of_nodes_have_the_same_bytes_with_any_instructions() {
        for d in [2, 3] {
            let given = unlike(d);
            let (blocks, starts, values, u) = &given;
            for set in [Instructions::Baseline, Instructions::detect()] {
                let mut pulls = vec![0.0; 12 * d];
                let nodes = Nodes { blocks, starts, values };
                if d == 2 {
                    pairs(set, nodes, u, &mut pulls)
                } else {
                    triples(nodes, u, &mut pulls)
                }
                let found: Vec<u64> = pulls.iter().map(|pull| pull.to_bits()).collect();
                assert_eq!(found, expected(&given, d), "{d} {set:?}");
            }
        }
    }
}
