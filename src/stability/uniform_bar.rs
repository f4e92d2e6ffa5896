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

use super::band::{Angle, Band, fall_at};
use crate::fem::MassMatrix;
use crate::scene::Bar;
use crate::spectrum::Segment;

/// Above this n theta, coth(n theta) = 1 in f64: 2 exp(-2z) < 2^-54.
const SATURATION: f64 = 19.1;

/// A change of x that rounding hides.
const NOTHING: f64 = f64::EPSILON / 8.0;

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
    /// y from which on coth(n theta) = 1 in f64.
    saturated_rise: f64,
    /// n theta/sqrt(y) near y = 0.
    reach: f64,
    /// sqrt(L) = sqrt(w/y) near y = 0.
    speed: f64,
    /// rho h A, kg.
    pub(super) element_mass: f64,
    pub(super) left_fixed: bool,
    pub(super) right_fixed: bool,
}

impl UniformBar {
    /// The bar with the ends that its scene fixes.
    pub fn new(bar: &Bar, mass: MassMatrix, left_fixed: bool, right_fixed: bool) -> Self {
        let factor = mass.element_factor();
        let elements = bar.elements as f64;
        let slope = factor * mass.entries().1;
        let saturation = (SATURATION / (2.0 * elements)).sinh().powi(2);
        // y/(1 + slope (1 + y)) stays below 1/slope: a short bar never gets there.
        let saturated_rise = match saturation * slope < 1.0 {
            true => saturation * (1.0 + slope) / (1.0 - saturation * slope),
            false => f64::INFINITY,
        };
        Self {
            stiffness: bar.element_stiffness(),
            eigenvalue: mass.element_eigenvalue(bar),
            elements,
            factor,
            slope,
            diagonal: factor * mass.entries().0,
            saturation,
            saturated_rise,
            reach: 2.0 * elements / (1.0 + slope).sqrt(),
            speed: factor.sqrt(),
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

    /// What the bar makes of l inside and above its band.
    pub(super) fn compressed(&self) -> Compressed {
        Compressed {
            band: Band::new(self.elements, self.factor, self.slope),
            angle: Angle::new(self.elements, self.slope, self.saturated_rise),
        }
    }

    /// l_max of the bar alone, rad^2/s^2: omega_e^2 with two free ends; with fixed ends the n theta = i phi at which
    /// its last pivot vanishes, pi/2 (one) or pi (both).
    pub fn top_eigenvalue(&self) -> f64 {
        let held = f64::from(u8::from(self.left_fixed)) + f64::from(u8::from(self.right_fixed));
        self.eigenvalue * (1.0 - fall_at(0.5 * std::f64::consts::PI * held / self.elements, self.slope))
    }

    /// A bound of e' M^-1 e at an end node: M exceeds the mass of the end element alone.
    pub(super) fn compliance_bound(&self, mass: MassMatrix) -> f64 {
        let (diagonal, off) = mass.entries();
        diagonal / ((diagonal - off) * (diagonal + off)) / self.element_mass
    }
}

/// The functions of one bar that are compressed; `None` for short bars.
#[derive(Debug, Clone, Copy)]
pub(super) struct Compressed {
    band: Option<Band>,
    angle: Option<Angle>,
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
    /// With p = b - b_mass the equation is T = p - b_mass y. Where tanh(n theta) = 1 in f64 it is the quadratic
    /// L x y = (p - b_mass y)^2, whose root is formed without cancellation.
    #[inline]
    pub(super) fn relative_rise(&self, compressed: &Compressed, b: f64, b_mass: f64) -> Option<f64> {
        let p = b - b_mass;
        if p <= 0.0 {
            return if p == 0.0 { Some(0.0) } else { Some(-compressed.band.as_ref()?.root(-p, b_mass)?) };
        }
        let l = self.factor / p;
        let y = 2.0 * p / (2.0 * b_mass + l + (l * (l + 4.0 * b)).sqrt());
        if y >= self.saturated_rise {
            Some(y)
        } else {
            self.above_band(compressed.angle.as_ref(), p, b_mass, y)
        }
    }

    /// The same for the few elements or small p that need T = sqrt(w) tanh(n theta), from the root for tanh = 1.
    ///
    /// Halley's method in y. The guess takes x = 1, n theta = z = reach sqrt(y), and inverts t = z tanh z by
    /// z^2 = t^2 + t g(t), where g falls from 1 to 0; the rational g is within 0.05, so that z^2 is within 2 %.
    /// An error e of theta, from the 1 in its logarithm, moves y by e sqrt(y).
    fn above_band(&self, angle: Option<&Angle>, p: f64, b_mass: f64, saturated: f64) -> Option<f64> {
        let root = saturated.sqrt();
        let t = self.reach * root;
        let inertia = b_mass / (self.reach * self.speed);
        let mut y =
            saturated + root / (self.reach * (1.0 + t * (0.667 + t * (0.302 + 0.308 * t))) * (1.0 + inertia));
        for _ in 0..40 {
            if y <= NOTHING {
                return Some(y);
            }
            let x = 1.0 + y;
            let w = self.factor * x * y;
            if !w.is_finite() {
                return None;
            }
            let (z, z_slope) = match angle {
                Some(angle) => angle.at(y),
                None => self.angle(y),
            };
            let decay = (-2.0 * z).exp();
            let part = 1.0 / (1.0 + decay);
            let (tanh, sech2) = ((1.0 - decay) * part, 4.0 * decay * part * part);
            let root = w.sqrt();
            let t = root * tanh;
            let t_slope = t * (0.5 + y) / (x * y) + root * sech2 * z_slope;
            // T'' as for a long bar, where z grows like sqrt(y).
            let bend = (z * sech2 * (1.0 - 2.0 * z * tanh) - tanh) * root / (4.0 * y * y);
            let (value, slope) = (p - b_mass * y - t, t_slope + b_mass);
            let step = value * slope / (slope * slope + 0.5 * value * bend);
            y += step;
            // T bends little more than sqrt(y): the next step would be less than step^2/(3y) of Newton's method times
            // what Halley's leaves of it, step/(4y) and the error of T'', which is relative to T'' less than y.
            if step * step * (step.abs() / y + y) <= 0.5 * f64::EPSILON * y * x || step.abs() <= NOTHING * x {
                return Some(y);
            }
        }
        None
    }
    /// n theta above the band and its derivative by y, by e^theta = 1 + 2 (y + half)/d and sinh(theta) = 2 half/d.
    #[inline]
    fn angle(&self, y: f64) -> (f64, f64) {
        let d = 1.0 + self.slope * (1.0 + y);
        let half = (y * (d + y)).sqrt();
        let z = self.elements * (1.0 + 2.0 * (y + half) / d).ln();
        (z, self.elements * (1.0 + self.slope) / (d * half))
    }
}
