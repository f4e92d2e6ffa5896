//! Sums over long vectors in a fixed order: results do not depend on the number of threads.

use rayon::prelude::*;

/// Entries that one task takes: 16 kB, so that a chunk of one vector stays in the first cache while others pass.
pub(super) const CHUNK: usize = 2048;
/// Partial sums within a chunk.
const LANES: usize = 8;

/// x'y of one chunk, in eight lanes.
fn chunk_dot(x: &[f64], y: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (xs, ys) = (x.chunks_exact(LANES), y.chunks_exact(LANES));
    let tail: f64 = xs.remainder().iter().zip(ys.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in xs.zip(ys) {
        for i in 0..LANES {
            lanes[i] += x[i] * y[i];
        }
    }
    lanes.iter().sum::<f64>() + tail
}

/// x'y.
pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let parts: Vec<f64> =
        x.par_chunks(CHUNK).zip(y.par_chunks(CHUNK)).map(|(x, y)| chunk_dot(x, y)).collect();
    parts.iter().sum()
}

/// How many additions a term of [`dot`] goes through at most, for vectors of n entries, and its multiplication.
pub(super) fn dot_depth(n: usize) -> usize {
    CHUNK / LANES + 2 * LANES + n / CHUNK + 2
}

/// V'w for the vectors of a basis.
pub(super) fn project(basis: &[Vec<f64>], w: &[f64]) -> Vec<f64> {
    let parts: Vec<Vec<f64>> = w
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(chunk, w)| {
            let at = chunk * CHUNK;
            basis.iter().map(|v| chunk_dot(&v[at..at + w.len()], w)).collect()
        })
        .collect();
    (0..basis.len()).map(|j| parts.iter().map(|part| part[j]).sum()).collect()
}

/// w -= V h.
pub(super) fn subtract(basis: &[Vec<f64>], h: &[f64], w: &mut [f64]) {
    w.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, w)| {
        let at = chunk * CHUNK;
        for (v, h) in basis.iter().zip(h) {
            w.iter_mut().zip(&v[at..]).for_each(|(w, v)| *w -= h * v);
        }
    });
}

/// V y.
pub(super) fn combine(basis: &[Vec<f64>], y: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; basis.first().map_or(0, Vec::len)];
    let negative: Vec<f64> = y.iter().map(|y| -y).collect();
    subtract(basis, &negative, &mut x);
    x
}

/// x *= factor.
pub(super) fn scale(factor: f64, x: &mut [f64]) {
    x.par_chunks_mut(CHUNK).for_each(|x| x.iter_mut().for_each(|x| *x *= factor));
}

/// Numbers between -1 and 1 that are the same in every run (the generator of Steele and Vigna, "splitmix64").
pub(super) fn pseudo_random(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| next()).collect()
}

/// Normally distributed numbers, the same in every run (Box and Muller).
pub(super) fn pseudo_normal(n: usize, seed: u64) -> Vec<f64> {
    let uniform = pseudo_random(2 * n, seed);
    let pair = |pair: &[f64]| {
        // From (-1, 1) to (0, 1); 0 itself is one of 2^53.
        let u = (0.5 * (pair[0] + 1.0)).max(f64::MIN_POSITIVE);
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::PI * pair[1]).cos()
    };
    uniform.chunks(2).map(pair).collect()
}
