//! What is used today where no engine is at hand: bounds from single elements and rows, power and Lanczos iterations.
//!
//! The bounds lie above l_max, a time step too small; the iterations below it, a time step too large, which is unsafe.

use bipenalty::pencil::{Bounds, ChainPencil, EndGap, Matrix, Penalty, Pencil, Terms, Tridiagonal};
use bipenalty::spectrum::{Engine, Sturm};

/// max(largest element eigenvalue, s/m of each contact), rad^2/s^2: the mediant bound, infinite without a mass penalty.
pub fn element_bound(pencil: ChainPencil<'_>, penalty: &Penalty) -> f64 {
    let own = |p: &Terms| if p.stiffness == 0.0 { 0.0 } else { p.stiffness / p.mass };
    pencil.terms(penalty).iter().map(own).fold(pencil.pencil().bounds().stiffness, f64::max)
}

/// max_i sum_j |K_ij|/(M_ii - sum_(j != i) |M_ij|) of the summed matrices, rad^2/s^2; infinite unless M is dominant. In the
/// row i of the largest |x_i|, l |(M x)_i| = |(K x)_i|.
pub fn gershgorin(stiffness: &Tridiagonal, mass: &Tridiagonal) -> f64 {
    let quotient = |i: usize| {
        let rest = mass.diagonal[i] - beside(mass, i);
        if rest > 0.0 { (stiffness.diagonal[i] + beside(stiffness, i)) / rest } else { f64::INFINITY }
    };
    (0..mass.diagonal.len()).map(quotient).fold(0.0, f64::max)
}

/// The sum of |A_ij| beside the diagonal of row i.
fn beside(matrix: &Tridiagonal, i: usize) -> f64 {
    let left = if i > 0 { matrix.off_diagonal[i - 1].abs() } else { 0.0 };
    left + matrix.off_diagonal.get(i).map_or(0.0, |off| off.abs())
}

/// K + sum s zz' and M + sum m zz', as a program that knows no contacts would hold them.
pub fn summed(pencil: ChainPencil<'_>, penalty: &Penalty) -> (Tridiagonal, Tridiagonal) {
    let (mut stiffness, mut mass) = (pencil.stiffness().clone(), pencil.mass().clone());
    for (gap, p) in pencil.gaps().iter().zip(pencil.terms(penalty)) {
        for (matrix, value) in [(&mut stiffness, p.stiffness), (&mut mass, p.mass)] {
            gap.nodes().for_each(|node| matrix.diagonal[node] += value);
            if let EndGap::Pair { left } = *gap {
                matrix.off_diagonal[left] -= value;
            }
        }
    }
    (stiffness, mass)
}

/// M = L D L', tridiagonal.
struct Factored {
    /// 1/D.
    inverse_pivots: Vec<f64>,
    /// The entries of L below the diagonal.
    factors: Vec<f64>,
}

impl Factored {
    fn new(mass: &Tridiagonal) -> Self {
        let mut inverse_pivots = vec![1.0 / mass.diagonal[0]];
        let mut factors = Vec::with_capacity(mass.off_diagonal.len());
        for (i, off) in mass.off_diagonal.iter().enumerate() {
            let factor = off * inverse_pivots[i];
            factors.push(factor);
            inverse_pivots.push(1.0 / (mass.diagonal[i + 1] - factor * off));
        }
        Self { inverse_pivots, factors }
    }

    /// x <- M^-1 x.
    fn solve(&self, x: &mut [f64]) {
        for (i, factor) in self.factors.iter().enumerate() {
            x[i + 1] -= factor * x[i];
        }
        x.iter_mut().zip(&self.inverse_pivots).for_each(|(x, inverse)| *x *= inverse);
        for (i, factor) in self.factors.iter().enumerate().rev() {
            x[i] -= factor * x[i + 1];
        }
    }
}

/// A start that every mode has a part in, the jagged ones most: +-(1 + a pseudo-random part).
fn start(size: usize) -> Vec<f64> {
    let mut state: u64 = 1;
    let value = |i: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let part = (state >> 11) as f64 / (1u64 << 53) as f64;
        if i.is_multiple_of(2) { 1.0 + part } else { -1.0 - part }
    };
    (0..size).map(value).collect()
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// The Rayleigh quotient after `steps` of x <- M^-1 K x, x = x/|x|.
pub fn power(stiffness: &Tridiagonal, mass: &Tridiagonal, steps: usize) -> f64 {
    let factored = Factored::new(mass);
    let mut x = start(mass.diagonal.len());
    let mut y = vec![0.0; x.len()];
    for _ in 0..steps {
        stiffness.multiply(&x, &mut y);
        factored.solve(&mut y);
        let scale = 1.0 / y.iter().fold(0.0, |a: f64, y| a.max(y.abs()));
        x.iter_mut().zip(&y).for_each(|(x, y)| *x = scale * y);
    }
    stiffness.multiply(&x, &mut y);
    let energy = dot(&x, &y);
    mass.multiply(&x, &mut y);
    energy / dot(&x, &y)
}

/// The largest Ritz value after `steps` of Lanczos' method with M^-1 K in the inner product of M.
pub fn lanczos(stiffness: &Tridiagonal, mass: &Tridiagonal, steps: usize) -> f64 {
    let factored = Factored::new(mass);
    // v of M-norm 1, and M v.
    let mut v = start(mass.diagonal.len());
    let mut mv = vec![0.0; v.len()];
    mass.multiply(&v, &mut mv);
    let norm = dot(&v, &mv).sqrt();
    [&mut v, &mut mv].into_iter().for_each(|x| x.iter_mut().for_each(|x| *x /= norm));
    let (mut mv_before, mut w, mut mw) = (vec![0.0; v.len()], vec![0.0; v.len()], vec![0.0; v.len()]);
    let mut ritz = Tridiagonal::default();
    let mut beta = 0.0;
    for step in 0..steps.min(v.len()) {
        if step > 0 {
            ritz.off_diagonal.push(beta);
        }
        // M w = K v - alpha M v - beta M v_before.
        stiffness.multiply(&v, &mut mw);
        let alpha = dot(&v, &mw);
        ritz.diagonal.push(alpha);
        let older = mv.iter().zip(&mv_before);
        mw.iter_mut().zip(older).for_each(|(mw, (mv, before))| *mw -= alpha * mv + beta * before);
        w.copy_from_slice(&mw);
        factored.solve(&mut w);
        beta = dot(&w, &mw).max(0.0).sqrt();
        // An invariant subspace: nothing is left to add.
        if beta <= f64::EPSILON * alpha {
            break;
        }
        std::mem::swap(&mut mv_before, &mut mv);
        mv.iter_mut().zip(&mw).for_each(|(mv, mw)| *mv = mw / beta);
        v.iter_mut().zip(&w).for_each(|(v, w)| *v = w / beta);
    }
    largest_of(ritz)
}

/// The largest eigenvalue of a symmetric tridiagonal matrix.
fn largest_of(matrix: Tridiagonal) -> f64 {
    let n = matrix.diagonal.len();
    let identity = Tridiagonal { diagonal: vec![1.0; n], off_diagonal: vec![0.0; n - 1] };
    let bound = gershgorin(&matrix, &identity);
    let bounds = Bounds { stiffness: bound, mass: 1.0 };
    // Without a value there is no estimate: NaN.
    let pencil = Pencil::new(Matrix::Chain(matrix), Matrix::Chain(identity), Vec::new(), bounds, bound);
    let found = |pencil: Pencil| Some(Sturm::new(pencil.chain()?).enclose(&Penalty::NONE, None).ok()?.value);
    pencil.ok().and_then(found).unwrap_or(f64::NAN)
}
