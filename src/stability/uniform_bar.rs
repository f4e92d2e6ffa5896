//! A uniform bar reduced to its ends, in closed form.
//!
//! With x = l/omega_e^2, y = x - 1 and L = 12/(1+2g), the difference equation of a uniform bar of n elements has the
//! solutions (-1)^j e^(+-j theta), and its ends, everything between eliminated, have the dynamic stiffness
//!
//! ```text
//! EA/h [ -q  o ; o  -q ]     q = sqrt(w) coth(n theta)     o = sqrt(w)/sinh(n theta)     w = L x y
//! sinh^2(theta/2) = y/D      D = 1 + L x (1-g)/6           (y < 0: theta = i phi, inside the band)
//! ```
//! So stiffness a (in units of EA/h) at the left end becomes o^2/(q - a) - q at the right end, with o^2 from its own
//! formula: q^2 - w would lose it on a long bar, and with it the gap between two contact modes.

use crate::fem::MassMatrix;
use crate::scene::Bar;
use crate::spectrum::Segment;

/// Above this n theta, coth(n theta) = 1 in f64: 2 exp(-2z) < 2^-54.
const SATURATION: f64 = 19.1;

/// A uniform bar reduced to its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformBar {
    /// EA/h, N/m.
    pub(super) stiffness: f64,
    /// omega_e^2, rad^2/s^2.
    pub(super) eigenvalue: f64,
    /// n.
    elements: f64,
    /// L = 12/(1+2g).
    factor: f64,
    /// L (1-g)/6, the slope of D.
    slope: f64,
    /// L (2+g)/6, the diagonal of the element mass.
    diagonal: f64,
    /// y/D from which on coth(n theta) = 1 in f64.
    saturation: f64,
    /// rho h A, kg.
    pub(super) element_mass: f64,
    pub(super) left_fixed: bool,
    pub(super) right_fixed: bool,
}

impl UniformBar {
    /// The bar with the ends that its scene fixes.
    pub fn new(bar: &Bar, mass: MassMatrix, left_fixed: bool, right_fixed: bool) -> Self {
        let factor = mass.element_factor();
        Self {
            stiffness: bar.element_stiffness(),
            eigenvalue: mass.element_eigenvalue(bar),
            elements: bar.elements as f64,
            factor,
            slope: factor * mass.entries().1,
            diagonal: factor * mass.entries().0,
            saturation: (SATURATION / (2.0 * bar.elements as f64)).sinh().powi(2),
            element_mass: bar.element_mass(),
            left_fixed,
            right_fixed,
        }
    }

    /// q, o and w of the module head at l, dimensionless; `None` where the bar with both ends held has an
    /// eigenvalue at or above l.
    #[inline]
    fn ends(&self, l: f64) -> Option<Ends> {
        let y = (l - self.eigenvalue) / self.eigenvalue;
        let x = l / self.eigenvalue;
        let d = 1.0 + self.slope * x;
        let w = self.factor * x * y;
        if self.elements == 1.0 {
            // One element by its matrix: far below omega_e its angle nears pi, where the cotangent loses all digits.
            return Some(Ends { q: self.diagonal * x - 1.0, o: Coupling::Element(d), w });
        }
        if y > 0.0 {
            // Far above omega_e^2 of a soft bar, w itself may leave the range of f64.
            let root = if w.is_finite() { w.sqrt() } else { (self.factor * x).sqrt() * y.sqrt() };
            let q = match y >= self.saturation * d {
                true => root,
                false => root / (2.0 * self.elements * (y / d).sqrt().asinh()).tanh(),
            };
            return Some(Ends { q, o: Coupling::Above { elements: self.elements, rise: y / d }, w });
        }
        if y == 0.0 {
            let q = (self.factor * d).sqrt() / (2.0 * self.elements);
            return Some(Ends { q, o: Coupling::Element(q), w });
        }
        let z = 2.0 * self.elements * (-y / d).sqrt().min(1.0).asin();
        (z < std::f64::consts::PI).then(|| Ends { q: (-w).sqrt() / z.tan(), o: Coupling::Within(z), w })
    }

    /// T(l) = -1/phi(l) of the bar alone seen from one end, N/m; `far_fixed` tells what holds the other.
    /// `None` where the bar with that end held has an eigenvalue at or above l.
    #[inline]
    pub(super) fn seen_from_contact(&self, l: f64, far_fixed: bool) -> Option<f64> {
        let Ends { q, w, .. } = self.ends(l)?;
        match far_fixed {
            true => Some(self.stiffness * q),
            false if w.is_finite() => (q > 0.0).then(|| self.stiffness * (w / q)),
            false => {
                let x = l / self.eigenvalue;
                (q > 0.0).then(|| self.stiffness * (self.factor * (x / q) * (x - 1.0)))
            }
        }
    }

    /// l_max of the bar alone, rad^2/s^2: omega_e^2 with two free ends; with fixed ends the n theta = i phi at which
    /// its last pivot vanishes, pi/2 (one) or pi (both).
    pub fn top_eigenvalue(&self) -> f64 {
        let held = f64::from(u8::from(self.left_fixed)) + f64::from(u8::from(self.right_fixed));
        // sin^2(phi/2) = v/(1 + slope (1 - v)) solved for v = -y.
        let sin2 = (0.25 * std::f64::consts::PI * held / self.elements).sin().powi(2);
        let v = sin2 * (1.0 + self.slope) / (1.0 + self.slope * sin2);
        self.eigenvalue * (1.0 - v)
    }

    /// A bound of e' M^-1 e at an end node: M exceeds the mass of the end element alone.
    pub(super) fn compliance_bound(&self, mass: MassMatrix) -> f64 {
        let (diagonal, off) = mass.entries();
        diagonal / ((diagonal - off) * (diagonal + off)) / self.element_mass
    }
}

/// The ends of a bar at one l, everything between eliminated.
#[derive(Debug, Clone, Copy)]
struct Ends {
    q: f64,
    o: Coupling,
    w: f64,
}

/// What o of the module head follows from; only a row of bars needs it.
#[derive(Debug, Clone, Copy)]
enum Coupling {
    /// o itself.
    Element(f64),
    /// n and sinh^2(theta/2), above the band.
    Above { elements: f64, rise: f64 },
    /// n phi, inside the band.
    Within(f64),
}

impl Ends {
    /// o^2/(q - a); o^2 underflows to 0 on a very long bar.
    fn passed_on(&self, a: f64) -> f64 {
        if self.w.is_finite() {
            return self.coupling_squared() / (self.q - a);
        }
        let o = match self.o {
            Coupling::Element(o) => o,
            Coupling::Above { elements, rise } => self.q / (2.0 * elements * rise.sqrt().asinh()).cosh(),
            Coupling::Within(z) => self.q / z.cos(),
        };
        o * (o / (self.q - a))
    }

    fn coupling_squared(&self) -> f64 {
        match self.o {
            Coupling::Element(o) => o * o,
            Coupling::Above { elements, rise } => {
                self.w / (2.0 * elements * rise.sqrt().asinh()).sinh().powi(2)
            }
            Coupling::Within(z) => -self.w / z.sin().powi(2),
        }
    }
}

impl Segment for UniformBar {
    fn condense(&self, l: f64, carried: f64) -> Option<f64> {
        let ends = self.ends(l)?;
        let q = ends.q;
        let a = carried / self.stiffness;
        let end = match (self.left_fixed, self.right_fixed) {
            (true, true) => -1.0,
            (true, false) => -q,
            (false, true) => a - q,
            (false, false) if a < q => ends.passed_on(a) - q,
            (false, false) => return None,
        };
        Some(self.stiffness * end)
    }
}

impl UniformBar {
    /// y = l_max/omega_e^2 - 1 of the bar with a free far end and one contact c/(EA/h) = b - b_mass x, or `None` if
    /// the iteration has not settled (the general solver then takes over).
    ///
    /// For a long bar coth = 1 and L x y = (p - b_mass y)^2, p = b - b_mass, is a quadratic, solved without
    /// cancellation; tanh is then restored by Newton's method, monotone because T is concave in l.
    #[inline]
    pub(super) fn relative_rise(&self, b: f64, b_mass: f64) -> Option<f64> {
        let p = b - b_mass;
        if p <= 0.0 {
            return if p == 0.0 { Some(0.0) } else { self.in_band(-p, b_mass) };
        }
        let l = self.factor / p;
        let mut y = 2.0 * p / (2.0 * b_mass + l + (l * l + 4.0 * self.factor * (b / p)).sqrt());
        for _ in 0..40 {
            let x = 1.0 + y;
            let d = 1.0 + self.slope * x;
            if y >= self.saturation * d {
                return Some(y);
            }
            if !(self.factor * x * y).is_finite() {
                return None;
            }
            let sinh = (y / d).sqrt();
            let z = 2.0 * self.elements * sinh.asinh();
            let t = (self.factor * x * y).sqrt() * z.tanh();
            let theta_slope = (1.0 + self.slope) / (d * d * sinh * (1.0 + sinh * sinh).sqrt());
            let t_slope =
                t * (0.5 * (1.0 + 2.0 * y) / (x * y) + 2.0 * self.elements * theta_slope / (2.0 * z).sinh());
            let step = (p - b_mass * y - t) / (t_slope + b_mass);
            y += step;
            // The next step would be about step^2/(2y).
            if step * step <= 0.125 * f64::EPSILON * y * x || step.abs() <= 0.25 * f64::EPSILON {
                return Some(y);
            }
        }
        None
    }

    /// The same inside the band, where p = -`depth` < 0: v = -y solves n phi = atan2(depth - b_mass v, sqrt(L x v)),
    /// by Newton's method in sqrt(v), in which both sides are nearly linear.
    fn in_band(&self, depth: f64, b_mass: f64) -> Option<f64> {
        let reach = self.elements / (1.0 + self.slope).sqrt();
        let quarter = 4.0 * reach / std::f64::consts::PI;
        // From tan z ~ z/(1 - (2z/pi)^2); divided through by depth, which may be near f64::MAX.
        let first = 1.0 / ((2.0 * reach * self.factor.sqrt() + b_mass) / depth + quarter * quarter);
        let mut u = first.min(0.5).sqrt();
        for _ in 0..40 {
            let v = u * u;
            let (x, d) = (1.0 - v, 1.0 + self.slope * (1.0 - v));
            let sin = (v / d).sqrt();
            let (s, c) = ((self.factor * x * v).sqrt(), depth - b_mass * v);
            let phi_slope = (1.0 + self.slope) / (d * d * sin * (1.0 - sin * sin).sqrt());
            let scale = s.abs().max(c.abs());
            let (s1, c1) = (s / scale, c / scale);
            let s_slope = self.factor * (1.0 - 2.0 * v) / (2.0 * s);
            let angle_slope = (-(b_mass / scale) * s1 - c1 * (s_slope / scale)) / (s1 * s1 + c1 * c1);
            let miss = 2.0 * self.elements * sin.asin() - c.atan2(s);
            let step = miss / (2.0 * u * (self.elements * phi_slope - angle_slope));
            u -= step;
            if u.is_nan() || u <= 0.0 || u >= 1.0 {
                return None;
            }
            // The next step would be about step^2/(2u), and move u^2 by step^2.
            if step * step <= 0.0625 * f64::EPSILON || (step * u).abs() <= 0.125 * f64::EPSILON {
                return Some(-u * u);
            }
        }
        None
    }
}
