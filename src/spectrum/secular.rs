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
//! **Compression.** With l = p (1 + z) all poles have z <= 0, so in each octave 2^k <= z < 2^(k+1), mapped to
//! s in [-1, 1], T is analytic outside s <= -3. On the Bernstein ellipse through -2.5 (rho = 4.79) it is at most 4
//! times its size S = a l + |b| + sum v_j/(l - p_j) on the octave, so that the Chebyshev interpolant of degree 25
//! errs by at most 16/(rho - 1) rho^-25 S < 5e-17 S (Trefethen, Approximation Theory and Practice, thm 8.2), and an
//! error e S of T moves the root by at most e l, because T' l >= a l + sum v_j/(l - p_j).

use std::sync::OnceLock;

use super::chain::Chain;
use super::sturm::{Rows, rows};
use super::{
    Condensed, Enclosure, Engine, Segment, UNIT_ROUNDOFF, Uncertified, bisect, certify, find_sign_change,
    sturm_backward_error,
};
use crate::pencil::{ChainPencil, Penalty, Terms, last_pivot};

/// Degree of the interpolant in one octave.
const DEGREE: usize = 25;
/// Octaves of z that are compressed: from 2^-40 (closer to the pole its own rounding shows) to 2^60 (beyond, only
/// extreme penalties lead). Outside, T is evaluated directly.
const FIRST_OCTAVE: i32 = -40;
const OCTAVES: usize = 100;
/// Below this z a root is placed between neighbours of a lattice of z, 2^-46 apart.
const NEAREST: f64 = 1.0 / (1u64 << 40) as f64;
const LATTICE: usize = 64;

/// The engine `secular`: 26 eliminations of n rows for each octave a map touches, then O(1) a point. Several contacts
/// are handled by the determinant of the row of contacts, evaluated directly.
#[derive(Debug)]
pub struct Secular<'a> {
    pencil: ChainPencil<'a>,
    chain: Chain<Rows<'a>>,
    one_contact: Option<Compressed<'a>>,
}

impl<'a> Secular<'a> {
    /// The engine for `pencil`; finds the last pole, and compresses octaves when they are first asked for.
    pub fn new(pencil: ChainPencil<'a>) -> Self {
        let chain = rows(pencil);
        let one_contact = (pencil.gaps().len() == 1).then(|| Compressed::new(pencil, chain.clone()));
        Self { pencil, chain, one_contact }
    }

    fn solve(&self, terms: &[Terms]) -> (f64, f64, f64) {
        match &self.one_contact {
            Some(function) if terms[0].nodal_mass == 0.0 => {
                let (low, high) = function.root(&terms[0], self.pencil.upper_bound(terms));
                // Lebesgue constant of 26 Chebyshev points < 3.2; Clenshaw's sum adds 2 * 26 roundings of its own.
                let kappa = 3.2 * sturm_backward_error(self.pencil, terms, low) + 64.0 * UNIT_ROUNDOFF;
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
}

/// T(l) of the single contact of a pencil.
#[derive(Debug)]
struct Compressed<'a> {
    chain: Chain<Rows<'a>>,
    /// p, the last pole of T.
    pole: f64,
    octaves: Vec<OnceLock<[f64; DEGREE + 1]>>,
    /// T on the lattice next to the pole.
    near_pole: Vec<OnceLock<f64>>,
}

impl<'a> Compressed<'a> {
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

impl Compressed<'_> {
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

/// Chebyshev coefficients of the interpolant of f at the zeros of T_N, the first one halved.
pub(crate) fn chebyshev<const N: usize>(f: impl Fn(f64) -> f64) -> [f64; N] {
    let angle = |j: usize| std::f64::consts::PI * (j as f64 + 0.5) / N as f64;
    let values: [f64; N] = std::array::from_fn(|j| f(angle(j).cos()));
    std::array::from_fn(|k| {
        let sum: f64 = values.iter().enumerate().map(|(j, v)| v * (k as f64 * angle(j)).cos()).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / N as f64
    })
}

/// sum_k c_k T_k(s) by Clenshaw's recurrence.
fn clenshaw(coefficients: &[f64; DEGREE + 1], s: f64) -> f64 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for c in coefficients[1..].iter().rev() {
        (b1, b2) = (2.0 * s * b1 - b2 + c, b1);
    }
    s * b1 - b2 + coefficients[0]
}
