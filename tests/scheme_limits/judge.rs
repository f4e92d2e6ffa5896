//! Whether a scheme grows, where f64 cannot tell: its amplification matrix and the powers of it in double-double arithmetic.
//!
//! T^N is found by squaring: its norm stays where T is stable and grows like exp(N g) where a multiplier has |z| = 1 + g.
//! The multiplier 1 of rigid motion is defective, and rounding would split it by sqrt(2^-106). So the translation of all
//! bars, which no closed contact sees, is given a frequency: K + c (M 1)(M 1)'/(1'M 1) leaves every other mode as it is. What
//! remains moves by 2^-106 times its condition, which is large where two multipliers nearly meet at -1: at the limit of
//! central differences, whose growth begins so fast that shorter powers do.

use bipenalty::double_double::Dd;
use bipenalty::pencil::{Matrix, Penalty, Pencil};

/// N = 2^64 for schemes that grow slowly above a limit, 2^44 for central differences: growth of 20/N is seen, 1.1e-18 and
/// 1.2e-12 a step.
const SQUARINGS: u32 = 64;
const FEWER: u32 = 44;

/// What ln |T^N| gains over the last four squarings at most where T is stable: 4 ln 2 while two multipliers at -1 are not
/// yet apart, and room for the beats of multipliers on the circle.
const STABLE_GAIN: f64 = 20.0;

/// Norms beyond exp(150) are growth at once: the states are scaled, and 2^64 = exp(44).
const CERTAIN: f64 = 150.0;

/// A dense matrix row by row.
#[derive(Clone)]
pub struct Block {
    columns: usize,
    entries: Vec<Dd>,
}

impl Block {
    fn new(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> Dd) -> Self {
        let entries = (0..rows * columns).map(|i| entry(i / columns, i % columns)).collect();
        Self { columns, entries }
    }

    fn rows(&self) -> usize {
        self.entries.len() / self.columns
    }

    fn row(&self, i: usize) -> &[Dd] {
        &self.entries[i * self.columns..(i + 1) * self.columns]
    }

    fn at(&self, i: usize, j: usize) -> Dd {
        self.entries[i * self.columns + j]
    }

    fn times(&self, other: &Self) -> Self {
        let mut product = Self::new(self.rows(), other.columns, |_, _| Dd::from(0.0));
        for (i, sums) in product.entries.chunks_mut(other.columns).enumerate() {
            for (k, a) in self.row(i).iter().enumerate().filter(|(_, a)| a.hi != 0.0) {
                sums.iter_mut().zip(other.row(k)).for_each(|(sum, b)| *sum = *sum + *a * *b);
            }
        }
        product
    }

    /// self + factor other.
    fn plus(&self, factor: Dd, other: &Self) -> Self {
        Self::new(self.rows(), self.columns, |i, j| self.at(i, j) + factor * other.at(i, j))
    }

    /// self^-1 other for a positive definite matrix.
    fn solve(mut self, mut other: Self) -> Self {
        let n = self.rows();
        for pivot in 0..n {
            for i in (0..n).filter(|i| *i != pivot) {
                let share = self.at(i, pivot) / self.at(pivot, pivot);
                for (matrix, from) in [(&mut self, pivot), (&mut other, 0)] {
                    for j in from..matrix.columns {
                        matrix.entries[i * matrix.columns + j] =
                            matrix.at(i, j) - share * matrix.at(pivot, j);
                    }
                }
            }
        }
        Self::new(n, other.columns, |i, j| other.at(i, j) / self.at(i, i))
    }

    fn norm(&self) -> f64 {
        self.entries.iter().map(|a| a.hi * a.hi).sum::<f64>().sqrt()
    }
}

/// The two matrices with which a scheme acts, in the unknowns of a pencil.
pub struct Judge {
    /// The root of each mass: the unit of a node.
    units: Vec<f64>,
    /// M^-1 K.
    free: Block,
    /// (M + Z m Z')^-1 Z s Z'.
    contact: Block,
    /// (M + Z m Z')^-1 (K + Z s Z').
    closed: Block,
}

fn full(matrix: &Matrix) -> Block {
    let mut full = Block::new(matrix.size(), matrix.size(), |_, _| Dd::from(0.0));
    let n = matrix.size();
    (0..n).for_each(|i| matrix.row(i).for_each(|(j, a)| full.entries[i * n + j] = Dd::from(a)));
    full
}

/// Gives the translation of all bars, where nothing holds it, a frequency far below the highest.
fn hold_translation(pencil: &Pencil, k: &mut Block, m: &Block) {
    let (n, zero) = (pencil.size(), Dd::from(0.0));
    let sum = |matrix: &Block, i: usize| matrix.row(i).iter().fold(zero, |sum, a| sum + *a);
    let is_seen = pencil.gaps().iter().any(|gap| gap.column.0.iter().map(|(_, z)| z).sum::<f64>() != 0.0);
    if is_seen || (0..n).any(|i| sum(k, i) != zero) {
        return;
    }
    let mass: Vec<Dd> = (0..n).map(|i| sum(m, i)).collect();
    let total = mass.iter().fold(zero, |sum, m| sum + *m);
    // The mean of l is about the trace of K over that of M.
    let trace = |matrix: &Block| (0..n).map(|i| matrix.at(i, i).hi).sum::<f64>();
    let frequency = Dd::from(trace(k) / trace(m) / 64.0);
    for i in 0..n {
        for j in 0..n {
            k.entries[i * n + j] = k.at(i, j) + frequency * mass[i] * mass[j] / total;
        }
    }
}

impl Judge {
    pub fn new(pencil: &Pencil, penalty: &Penalty) -> Self {
        let n = pencil.size();
        let (mut k, m) = (full(pencil.stiffness()), full(pencil.mass()));
        hold_translation(pencil, &mut k, &m);
        let (mut kp, mut mp) = (Block::new(n, n, |_, _| Dd::from(0.0)), m.clone());
        for gap in pencil.gaps() {
            let s = Dd::from(penalty.stiffness) * Dd::from(gap.scale);
            for (i, a) in &gap.column.0 {
                for (j, b) in &gap.column.0 {
                    let entry = *i as usize * n + *j as usize;
                    let share = s * Dd::from(a * b);
                    kp.entries[entry] = kp.entries[entry] + share;
                    if penalty.rate.is_finite() {
                        mp.entries[entry] = mp.entries[entry] + share / Dd::from(penalty.rate);
                    }
                }
            }
        }
        let units = (0..n).map(|i| pencil.mass().diagonal(i).sqrt()).collect();
        let closed = mp.clone().solve(k.plus(Dd::from(1.0), &kp));
        Self { units, free: m.solve(k), contact: mp.solve(kp), closed }
    }

    /// u and v as functions of (u, v).
    fn start(&self) -> [Block; 2] {
        let n = self.units.len();
        [0, 1].map(|part| Block::new(n, 2 * n, |i, j| Dd::from(f64::from(u8::from(j == part * n + i)))))
    }

    /// Whether central differences grow at dt.
    pub fn central_difference_grows(&self, dt: f64) -> bool {
        let ([u, v], step) = (self.start(), Dd::from(dt));
        let v = v.plus(-step, &self.closed.times(&u));
        self.grows(&u.plus(step, &v), &v, dt, FEWER)
    }

    /// Whether the predictor-corrector grows at dt.
    pub fn predictor_corrector_grows(&self, dt: f64) -> bool {
        let ([u, v], step) = (self.start(), Dd::from(dt));
        let v = v.plus(-step, &self.free.times(&u));
        let predicted = u.plus(step, &v);
        let v = v.plus(-step, &self.contact.times(&predicted));
        self.grows(&u.plus(step, &v), &v, dt, SQUARINGS)
    }

    /// Whether the Park scheme as the paper writes it (4.5) grows at dt, with dt_c = `far`. Its a = -(M^-1 K + C) u.
    pub fn park_grows(&self, dt: f64, far: f64, theta: f64) -> bool {
        let ([u, v], one) = (self.start(), Dd::from(1.0));
        let [step, far, theta] = [dt, far, theta].map(Dd::from);
        let half = Dd::from(0.5);
        let alpha = step / far;
        let sixth = alpha / Dd::from(6.0);
        let (b1, b2) = (sixth * (one + Dd::from(3.0) * alpha - alpha * alpha), sixth * (alpha * alpha - one));
        let force = self.free.plus(one, &self.contact);
        let minus = Dd::from(-1.0);
        let zero = u.plus(minus, &u);
        let a = zero.plus(minus, &force.times(&u));
        let ahead = u.plus(far, &v).plus(half * far * far, &a);
        let ahead_rate = zero.plus(minus, &self.free.times(&ahead));
        let pulled = u.plus(step, &v).plus(far * far * b1, &a).plus(far * far * b2, &ahead_rate);
        let pushed = u.plus(step, &v).plus(half * step * step, &a);
        let displacement = zero.plus(theta, &pulled).plus(one - theta, &pushed);
        let rate = zero.plus(minus, &force.times(&displacement));
        self.grows(&displacement, &v.plus(half * step, &a).plus(half * step, &rate), dt, SQUARINGS)
    }

    /// Whether some multiplier of the map (u, v) -> (`u`, `v`) is outside the unit circle by more than 20/2^`squarings`; in the
    /// states (u, dt v), each node in its unit.
    fn grows(&self, u: &Block, v: &Block, dt: f64, squarings: u32) -> bool {
        let n = self.units.len();
        let unit = |i: usize| self.units[i % n] * if i < n { 1.0 } else { dt };
        let mut power = Block::new(2 * n, 2 * n, |i, j| {
            let entry = if i < n { u.at(i, j) } else { v.at(i - n, j) };
            entry * Dd::from(unit(i)) / Dd::from(unit(j))
        });
        // T^N = 2^exponent power; a whole number, as each rounding would be doubled with every squaring.
        let mut exponent = 0.0;
        let mut gained = 0.0;
        for squaring in 0..=squarings {
            let own = power.norm().log2().round();
            // A power of two, so that nothing is rounded.
            let scale = Dd::from(2f64.powi(-own as i32));
            exponent += own;
            let logarithm = exponent * std::f64::consts::LN_2;
            if logarithm < -1.0 {
                return false;
            }
            if logarithm > CERTAIN {
                return true;
            }
            if squaring == squarings - 4 {
                gained = logarithm;
            }
            power.entries.iter_mut().for_each(|a| *a = *a * scale);
            if squaring < squarings {
                power = power.times(&power);
                exponent *= 2.0;
            }
        }
        exponent * std::f64::consts::LN_2 - gained > STABLE_GAIN
    }
}
