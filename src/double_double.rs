//! Double-double arithmetic: an unevaluated sum hi + lo of two f64, about 32 digits (Dekker, Numer. Math. 18, 1971).
//!
//! Each operation has a relative error of at most 16 * 2^-106 (Joldes, Muller, Popescu, ACM TOMS 44, 2017, bound the
//! same algorithms by at most 10 * 2^-106), as long as nothing leaves 1e-250 to 1e290.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers in which a formula is evaluated: f64 to find a root, [`Dd`] to prove a sign.
pub trait Real:
    Copy
    + PartialOrd
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A bound of the relative error of an operation, the square root among them.
    const ROUNDOFF: f64;

    /// The nearest f64.
    fn value(self) -> f64;

    /// The square root of a number of at least 0.
    #[must_use]
    fn sqrt(self) -> Self;
}

impl Real for f64 {
    const ROUNDOFF: f64 = f64::EPSILON / 2.0;

    fn value(self) -> f64 {
        self
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }
}

/// hi + lo with |lo| <= ulp(hi)/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dd {
    /// The nearest f64.
    pub hi: f64,
    /// What it leaves.
    pub lo: f64,
}

impl Real for Dd {
    const ROUNDOFF: f64 = 16.0 * Self::UNIT;

    fn value(self) -> f64 {
        self.hi
    }

    /// One step of Newton from the root of hi, which is off by little more than an ulp: it leaves the square of that.
    fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        if root == 0.0 {
            return Self::from(root);
        }
        let rest = self - two_product(root, root);
        quick_two_sum(root, rest.hi / (2.0 * root))
    }
}

impl Dd {
    /// 2^-106.
    const UNIT: f64 = (f64::EPSILON / 2.0) * (f64::EPSILON / 2.0);

    /// The sum of `a_k x[at_k]`: off by 2^-53 of itself, and for n terms by n^2 2^-106 of the sum of their absolute values (Ogita,
    /// Rump, Oishi, SIAM J. Sci. Comput. 26, 2005). The same bytes on every machine: a fused multiply-add is rounded once,
    /// as an instruction or without it.
    #[allow(unsafe_code)]
    pub fn dot(a: &[f64], at: &[u32], x: &[f64]) -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "fma")]
            fn fused(a: &[f64], at: &[u32], x: &[f64]) -> Dd {
                dot_loop(a, at, x)
            }
            if is_x86_feature_detected!("fma") {
                // SAFETY: the feature has just been found.
                return unsafe { fused(a, at, x) };
            }
        }
        dot_loop(a, at, x)
    }
}

/// s + e = a + b exactly (Knuth).
fn two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    let part = s - a;
    Dd { hi: s, lo: (a - (s - part)) + (b - part) }
}

/// s + e = a + b exactly, for |a| >= |b|.
fn quick_two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    Dd { hi: s, lo: b - (s - a) }
}

/// p + e = a b exactly (Veltkamp's splitting, no fused multiply-add needed).
fn two_product(a: f64, b: f64) -> Dd {
    let split = |x: f64| {
        let t = 134_217_729.0 * x;
        let high = t - (t - x);
        (high, x - high)
    };
    let p = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Dd { hi: p, lo: ((ah * bh - p) + ah * bl + al * bh) + al * bl }
}

/// The sums of products and of the errors of both, beside each other, so that neither waits for the other one.
#[inline(always)]
fn dot_loop(a: &[f64], at: &[u32], x: &[f64]) -> Dd {
    let (mut sum, mut errors) = (0.0, 0.0);
    for (a, at) in a.iter().zip(at) {
        let x = x[*at as usize];
        let product = a * x;
        let next = two_sum(sum, product);
        errors += next.lo + a.mul_add(x, -product);
        sum = next.hi;
    }
    quick_two_sum(sum, errors)
}

impl From<f64> for Dd {
    fn from(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }
}

impl Add for Dd {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (s, t) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let v = quick_two_sum(s.hi, s.lo + t.hi);
        quick_two_sum(v.hi, t.lo + v.lo)
    }
}

impl Neg for Dd {
    type Output = Self;

    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Dd {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Dd {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let p = two_product(self.hi, other.hi);
        quick_two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for Dd {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let q1 = self.hi / other.hi;
        let rest = self - other * Dd::from(q1);
        let q2 = rest.hi / other.hi;
        let rest = rest - other * Dd::from(q2);
        quick_two_sum(q1, q2) + Dd::from(rest.hi / other.hi)
    }
}

impl PartialOrd for Dd {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.hi.partial_cmp(&other.hi) {
            Some(Ordering::Equal) => self.lo.partial_cmp(&other.lo),
            unequal => unequal,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)]

    use super::{Dd, Real};

    #[test]
    fn a_third_has_thirty_two_digits() {
        let third = Dd::from(1.0) / Dd::from(3.0);
        let residual = third * Dd::from(3.0) - Dd::from(1.0);
        // Two operations of 16 * 2^-106 each.
        assert!(residual.hi.abs() <= 32.0 * 2f64.powi(-106), "{residual:?}");
        assert_ne!(third.lo, 0.0);
    }

    #[test]
    fn the_root_of_two_has_thirty_two_digits() {
        for square in [Dd::from(2.0), Dd::from(1.0) / Dd::from(3.0), Dd::from(1e-80) * Dd::from(7.0)] {
            let root = square.sqrt();
            let residual = (root * root - square).hi / square.hi;
            // The root twice, and a product.
            assert!(residual.abs() <= 3.0 * Dd::ROUNDOFF, "{residual:e}");
        }
        assert_eq!(Dd::from(0.0).sqrt(), Dd::from(0.0));
    }

    #[test]
    fn cancellation_keeps_the_low_part() {
        let x = Dd::from(1e16) + Dd::from(0.1);
        assert_eq!((x - Dd::from(1e16)).hi, 0.1);
        let y = Dd::from(1.0 + f64::EPSILON) * Dd::from(1.0 - f64::EPSILON);
        assert_eq!((y - Dd::from(1.0)).hi, -f64::EPSILON * f64::EPSILON);
    }
}
