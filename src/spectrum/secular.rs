//! One scalar function for every penalty: the secular equation, compressed.
//!
//! A single contact enters as a rank-one term, so l_max solves T(l) = c(l) = s - l m with T = -1/phi and
//! phi(l) = Z'(K - l M)^-1 Z, the same for every (beta_s, r). T is a Pick function,
//!
//! ```text
//! T(l) = a l + b - sum_j v_j/(l - p_j)      a, v_j >= 0      p_1 < ... < p = the last pole
//! ```
//! concave and increasing beyond p, the largest eigenvalue with the gap held at zero. There lies exactly one root,
//! and it is l_max: above the contact-free maximum for c > 0, below it (interlacing) for c < 0, at p itself when the
//! top mode does not move the gap.
//!
//! # Compression
//! With l = p (1 + z) all poles have z <= 0, so in each octave 2^k <= z < 2^(k+1), mapped to t in [-1, 1], they lie at
//! t_j <= -3. The interpolant of degree N - 1 at the zeros of the Chebyshev polynomial T_N (N = [`NODES`]) takes over
//! a l + b exactly, and errs for each pole by exactly
//!
//! ```text
//! v_j/(l - p_j) T_N(t)/T_N(t_j)      |.| <= v_j/(l - p_j)/T_22(3) < v_j/(l - p_j) u/3      u = 2^-53
//! ```
//! since (1 - T_N(t)/T_N(t_j))/(t - t_j) is a polynomial of degree N - 1 that agrees with 1/(t - t_j) at the zeros of T_N.
//! (The last pole is found to rounding; that puts t_j at most 0.02 above -3 in the octave nearest to it.)
//!
//! # What an error of T does to the root
//! With F = T - c = T - s + l m, at the root l, and all sums over v_j/(l - p_j):
//!
//! ```text
//! b <= 0              because phi > 0, so T < 0, for every l < 0, where K - l M is definite
//! |b| = (a + m) l - s - sum <= (a + m) l - sum                                            because T = c
//! F' l = (a + m) l + sum v_j l/(l - p_j)^2 >= (a + m) l + sum
//! ```
//! F is concave: an error e F'(l) l of T puts the root at most e l off, to first order in e. In these units (F' l):
//! - *A node* l_i. The elimination is the exact one of a pencil whose entries are off by the backward error k of a Sturm
//!   count, so that T(l_i) is off by k l_i T'(l_i) at most: a root at z takes this over with the weight (z/z_i)^2 <= 4 of a
//!   node below it and z_i/z <= 2 of one above. The Lebesgue function of the nodes with these weights is at most
//!   [`WEIGHTED_LEBESGUE`]. Placing l_i and the series T_1 T_2/(T_1 + T_2) of two bars add 5 u before that weight.
//! - *The coefficients.* |T(l_i)| <= max(a l_i, |b| + sum_i) <= max(1, z_i/z), in the mean 1.5. Products are summed with
//!   their rounding; the cosines are off by 2.3 u: N - 1 coefficients by 2 * 1.5 * 2.3 u each, 145 u.
//! - *Clenshaw's sum.* The coefficients behind the first are at most 0.5, 0.09, 0.015, ... (those of a l + b - v/(l - p)),
//!   so are its partial sums: with the stored coefficients 14 u.
//!
//! Together with u/3 of the interpolation that is less than [`ROUNDOFFS`] u.

use std::sync::OnceLock;

use super::chain::Chain;
use super::sturm::{Rows, rows};
use super::{
    Condensed, Enclosure, Engine, Segment, UNIT_ROUNDOFF, Uncertified, bisect, certify, find_sign_change,
    sign_error, sturm_backward_error,
};
use crate::pencil::{ChainPencil, Penalty, Terms, last_pivot};

/// N, nodes of the interpolant in one octave: 1/T_22(3) < u/3.
const NODES: usize = 22;
/// The largest sum_i |l_i(t)| w_i over t in [-1, 1], with l_i the Lagrange polynomials of the nodes and
/// w_i = (z/z_i)^2 for z_i < z, else z_i/z: 3.470, at t = 1.
const WEIGHTED_LEBESGUE: f64 = 3.6;
/// What coefficients and sums add to an error of T, in unit roundoffs of F' l: 145 + 14 + 5 * 3.6 + 1/3.
const ROUNDOFFS: f64 = 180.0;
/// Octaves of z that are compressed: from 2^-40 (closer to the pole its own rounding shows) to 2^60 (beyond, only
/// extreme penalties lead). Outside, T is evaluated directly.
const FIRST_OCTAVE: i32 = -40;
const OCTAVES: usize = 100;
/// Below this z a root is placed between neighbours of a lattice of z, 2^-46 apart.
const NEAREST: f64 = 1.0 / (1u64 << 40) as f64;
const LATTICE: usize = 64;

/// The engine `secular`: 22 eliminations of n rows for each octave a map touches, then O(1) a point. Several contacts
/// are handled by the determinant of the row of contacts, evaluated directly.
#[derive(Debug)]
pub struct Secular<'a> {
    pencil: ChainPencil<'a>,
    chain: Chain<Rows<'a>>,
    one_contact: Option<CompressedFunction<'a>>,
}

impl<'a> Secular<'a> {
    /// The engine for `pencil`; finds the last pole, and compresses octaves when they are first asked for.
    pub fn new(pencil: ChainPencil<'a>) -> Self {
        let chain = rows(pencil);
        let one_contact = (pencil.gaps().len() == 1).then(|| CompressedFunction::new(pencil, chain.clone()));
        Self { pencil, chain, one_contact }
    }

    fn solve(&self, terms: &[Terms]) -> (f64, f64, f64) {
        match &self.one_contact {
            Some(function) if terms[0].nodal_mass == 0.0 => {
                let (low, high) = function.root(&terms[0], self.pencil.upper_bound(terms));
                let kappa = WEIGHTED_LEBESGUE * sturm_backward_error(self.pencil, terms, low)
                    + ROUNDOFFS * UNIT_ROUNDOFF;
                (low, high, kappa)
            }
            _ => {
                let above = |l: f64| self.chain.is_above_spectrum(terms, l);
                let mut low = 0.5 * self.pencil.lower_bound(terms);
                while above(low) {
                    low *= 0.5;
                }
                let high = self.pencil.upper_bound(terms) * (1.0 + 64.0 * f64::EPSILON);
                let (low, high) = bisect(low, high, above);
                (low, high, sturm_backward_error(self.pencil, terms, low))
            }
        }
    }
}

impl Engine for Secular<'_> {
    fn name(&self) -> &'static str {
        "secular"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Enclosure, Uncertified> {
        let (low, high, kappa) = penalty.with_terms(self.pencil.scales(), |terms| self.solve(terms));
        certify(Enclosure::from_bracket(low, high, kappa))
    }

    fn condensed(&self) -> Option<&dyn Condensed> {
        Some(self)
    }
}

impl Condensed for Secular<'_> {
    fn is_above(&self, terms: &[Terms], l: f64) -> bool {
        self.chain.is_above_spectrum(terms, l)
    }

    fn rounding(&self, l: f64) -> f64 {
        sign_error(self.pencil, self.pencil.pencil().bounds().stiffness, l)
    }
}

/// T(l) of the single contact of a pencil.
#[derive(Debug)]
struct CompressedFunction<'a> {
    chain: Chain<Rows<'a>>,
    /// p, the last pole of T.
    pole: f64,
    octaves: Vec<OnceLock<[f64; NODES]>>,
    /// T on the lattice next to the pole.
    near_pole: Vec<OnceLock<f64>>,
}

impl<'a> CompressedFunction<'a> {
    fn new(pencil: ChainPencil<'_>, chain: Chain<Rows<'a>>) -> Self {
        let octaves = (0..OCTAVES).map(|_| OnceLock::new()).collect();
        let near_pole = (0..=LATTICE).map(|_| OnceLock::new()).collect();
        let mut function = Self { chain, pole: 0.0, octaves, near_pole };
        let high = pencil.pencil().bounds().stiffness * (1.0 + 64.0 * f64::EPSILON);
        // Without an interior node there is no pole: T is defined for every l > 0.
        if function.direct(f64::MIN_POSITIVE).is_none() {
            function.pole = bisect(f64::MIN_POSITIVE, high, |l| function.direct(l).is_some()).1;
        } else {
            function.pole = high * f64::EPSILON;
        }
        function
    }

    /// T(l) by elimination of all rows towards the contact; `None` at and below the last pole.
    fn direct(&self, l: f64) -> Option<f64> {
        let seen = |end: Option<f64>| end.map(|stiffness| -stiffness);
        match self.chain.segments.as_slice() {
            [bar] if self.chain.left_wall => seen(bar.condense_backwards(l)),
            [bar] => seen(bar.condense(l, 0.0)),
            [left, right] => {
                let (t1, t2) = (seen(left.condense(l, 0.0))?, seen(right.condense_backwards(l))?);
                (t1 + t2 > 0.0).then(|| t1 * (t2 / (t1 + t2)))
            }
            _ => None,
        }
    }

    /// T(p (1 + z)) through the octave of z.
    fn at(&self, z: f64) -> f64 {
        let octave = ((z.to_bits() >> 52) as i32 - 1023) - FIRST_OCTAVE;
        if z <= 0.0 || octave < 0 || octave >= OCTAVES as i32 {
            return self.direct(self.pole + self.pole * z).unwrap_or(f64::NEG_INFINITY);
        }
        let width = 2f64.powi(octave + FIRST_OCTAVE);
        let coefficients = self.octaves[octave as usize].get_or_init(|| {
            chebyshev(|s| self.direct(self.pole + self.pole * (0.5 * width * (s + 3.0))).unwrap_or(f64::NAN))
        });
        clenshaw(coefficients, 2.0 * (z / width) - 3.0)
    }

    /// The bracket of the root of T(l) = c(l), to a few units of rounding of l.
    fn root(&self, terms: &Terms, upper_bound: f64) -> (f64, f64) {
        let excess = |z: f64| self.at(z) - terms.dynamic_stiffness(self.pole + self.pole * z);
        let (mut low, mut high) = (0.0, (upper_bound / self.pole - 1.0).max(0.0) + 64.0 * f64::EPSILON);
        while excess(high) < 0.0 && high < f64::MAX {
            low = high;
            high *= 2.0;
        }
        // Octave by octave towards the pole, so that the interpolation starts from a finite bracket.
        let mut f_low = f64::NEG_INFINITY;
        let mut f_high = excess(high);
        while low == 0.0 && high > NEAREST {
            let z = (high * 0.125).max(NEAREST);
            let value = excess(z);
            if value < 0.0 {
                (low, f_low) = (z, value);
            } else {
                (high, f_high) = (z, value);
            }
        }
        if low == 0.0 {
            return self.root_at_the_pole(terms);
        }
        let tolerance = 2.0 * f64::EPSILON * (1.0 + 1.0 / high);
        let (low, high) = find_sign_change((low, f_low), (high, f_high), tolerance, excess);
        (self.pole + self.pole * low, self.pole + self.pole * high)
    }
}

impl CompressedFunction<'_> {
    /// The root below z = [`NEAREST`], on a lattice of 64 values of T that are kept: there T is mostly rounding, and an
    /// elimination a point would cost more than the whole map.
    fn root_at_the_pole(&self, terms: &Terms) -> (f64, f64) {
        let l = |i: usize| self.pole + self.pole * (NEAREST / LATTICE as f64 * i as f64);
        let above = |i: usize| {
            let t = *self.near_pole[i].get_or_init(|| self.direct(l(i)).unwrap_or(f64::NEG_INFINITY));
            t - terms.dynamic_stiffness(l(i)) >= 0.0
        };
        let (mut low, mut high) = (0, LATTICE);
        while high - low > 1 {
            let middle = (low + high) / 2;
            if above(middle) { high = middle } else { low = middle }
        }
        (l(low), l(high))
    }
}

impl Rows<'_> {
    /// As `condense` from the right end to the left, with nothing carried.
    fn condense_backwards(&self, l: f64) -> Option<f64> {
        let last = self.stiffness.len() - 1;
        let row =
            |i: usize| (self.stiffness[i] - l * self.mass[i], self.stiffness_off[i] - l * self.mass_off[i]);
        let first = self.stiffness[last] - l * self.mass[last];
        last_pivot(first, (0..last).rev().map(row), |pivot, _| pivot < 0.0)
    }
}

/// Chebyshev coefficients of the interpolant of f at the zeros of T_N, the first one halved. The sums carry their
/// rounding along (Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26, 2005), so that only the cosines err.
pub(crate) fn chebyshev<const N: usize>(f: impl Fn(f64) -> f64) -> [f64; N] {
    let values: [f64; N] = std::array::from_fn(|j| f(cosine::<N>(2 * j + 1)));
    std::array::from_fn(|k| {
        let (mut sum, mut rest) = (0.0, 0.0);
        for (j, value) in values.iter().enumerate() {
            let factor = cosine::<N>(k * (2 * j + 1));
            let product = value * factor;
            let next = sum + product;
            let part = next - sum;
            rest += ((sum - (next - part)) + (product - part)) + value.mul_add(factor, -product);
            sum = next;
        }
        (sum + rest) * if k == 0 { 1.0 } else { 2.0 } / N as f64
    })
}

/// cos(pi m/(2N)), its argument reduced in whole numbers to at most pi/4: off by 2.3 unit roundoffs at most, one of the
/// function and 1.3 of the argument, which is off by 2.35 relative.
fn cosine<const N: usize>(m: usize) -> f64 {
    // The period is 4N and the cosine even.
    let m = (m % (4 * N)).min(4 * N - m % (4 * N));
    let (sign, m) = if m > N { (-1.0, 2 * N - m) } else { (1.0, m) };
    let angle = |m: usize| std::f64::consts::PI * m as f64 / (2 * N) as f64;
    sign * if 2 * m <= N { angle(m).cos() } else { angle(N - m).sin() }
}

/// sum_k c_k T_k(s) by Clenshaw's recurrence.
fn clenshaw(coefficients: &[f64; NODES], s: f64) -> f64 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for c in coefficients[1..].iter().rev() {
        (b1, b2) = (2.0 * s * b1 - b2 + c, b1);
    }
    s * b1 - b2 + coefficients[0]
}

#[cfg(test)]
mod tests {
    use super::{NODES, UNIT_ROUNDOFF, WEIGHTED_LEBESGUE, chebyshev, cosine};

    fn polynomial(degree: usize, t: f64) -> f64 {
        let (mut last, mut this) = (1.0, t);
        (1..degree).for_each(|_| (last, this) = (this, 2.0 * t * this - last));
        this
    }

    #[test]
    fn a_pole_outside_the_octave_errs_by_less_than_a_third_of_a_roundoff() {
        assert!(3.0 < UNIT_ROUNDOFF * polynomial(NODES, 3.0), "{:e}", polynomial(NODES, 3.0));
        // The formula of that error, seen where it is not below rounding: 8 nodes.
        let coefficients: [f64; 8] = chebyshev(|t| 1.0 / (t + 3.0));
        for i in 0..=40 {
            let t = -1.0 + 0.05 * i as f64;
            let mut sum = coefficients[0];
            (1..8).for_each(|k| sum += coefficients[k] * polynomial(k, t));
            let error = polynomial(8, t) / polynomial(8, -3.0) / (t + 3.0);
            let rest = 1.0 / (t + 3.0) - sum - error;
            assert!(rest.abs() <= 16.0 * UNIT_ROUNDOFF, "{t}: {rest:e} besides {error:e}");
        }
    }

    #[test]
    fn the_weighted_lebesgue_function_stays_below_its_bound() {
        let nodes: Vec<f64> = (0..NODES).map(|j| cosine::<NODES>(2 * j + 1)).collect();
        let lagrange = |i: usize, t: f64| {
            let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
            others.map(|(_, node)| (t - node) / (nodes[i] - node)).product::<f64>()
        };
        let largest = (0..=4000).map(|k| -1.0 + 5e-4 * k as f64).map(|t| {
            let weight = |i: usize| {
                let quotient = (t + 3.0) / (nodes[i] + 3.0);
                if quotient > 1.0 { quotient * quotient } else { 1.0 / quotient }
            };
            (0..NODES).map(|i| lagrange(i, t).abs() * weight(i)).sum::<f64>()
        });
        let largest = largest.fold(0.0, f64::max);
        // Between two of these t it changes by less than NODES^2 times their distance times itself.
        assert!((3.4..WEIGHTED_LEBESGUE).contains(&largest), "{largest}");
    }
}
