//! Uniform bars in closed form: one evaluation costs the same for 1 element and for 1e6.
//!
//! With x = l/omega_e^2, y = x - 1 and L = 12/(1+2g), the difference equation of a uniform bar of n elements has the
//! solutions (-1)^j e^(+-j theta), and its ends, everything between eliminated, have the dynamic stiffness
//!
//! ```text
//! EA/h [ -q  o ; o  -q ]     q = sqrt(w) coth(n theta)     o = sqrt(w)/sinh(n theta)     w = L x y
//! sinh^2(theta/2) = y/D      D = 1 + L x (1-g)/6           (y < 0: theta = i phi, inside the band)
//! ```
//! So stiffness a (in units of EA/h) at the left end becomes o^2/(q - a) - q at the right end, with o^2 from its own
//! formula: q^2 - w would lose it on a long bar, and with it the gap between two contact modes. A single contact
//! obeys T(l) = c(l) = s - l m with T = w/q for a free far end and T = q for a fixed one (the secular equation
//! 1 + c phi = 0 with phi = -1/T). Eliminating whole bars and counting signs is the algorithm of Wittrick and Williams
//! (Q. J. Mech. Appl. Math. 24, 1971).

use crate::fem::{MassMatrix, assemble_shortened};
use crate::pencil::{Penalty, Pencil};
use crate::scene::{Bar, End, Scene};
use crate::spectrum::{
    Chain, Enclosure, Engine, Segment, UNIT_ROUNDOFF, Uncertified, bisect, certify, find_sign_change,
};

/// Above this n theta, coth(n theta) = 1 in f64: 2 exp(-2z) < 2^-54.
const SATURATION: f64 = 19.1;

/// A uniform bar reduced to its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformBar {
    /// EA/h, N/m.
    stiffness: f64,
    /// omega_e^2, rad^2/s^2.
    eigenvalue: f64,
    /// n.
    elements: f64,
    /// L = 12/(1+2g).
    factor: f64,
    /// L (1-g)/6, the slope of D.
    slope: f64,
    /// L (2+g)/6, the diagonal of the element mass.
    diagonal: f64,
    /// rho h A, kg.
    element_mass: f64,
    left_fixed: bool,
    right_fixed: bool,
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
            let z = 2.0 * self.elements * (y / d).sqrt().asinh();
            let root = w.sqrt();
            let q = if z > SATURATION { root } else { root / z.tanh() };
            return Some(Ends { q, o: Coupling::Above(z), w });
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
    fn seen_from_contact(&self, l: f64, far_fixed: bool) -> Option<f64> {
        let Ends { q, w, .. } = self.ends(l)?;
        match far_fixed {
            true => Some(self.stiffness * q),
            false => (q > 0.0).then(|| self.stiffness * (w / q)),
        }
    }

    /// A bound of e' M^-1 e at an end node: M exceeds the mass of the end element alone.
    fn compliance_bound(&self, mass: MassMatrix) -> f64 {
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
    /// n theta, above the band.
    Above(f64),
    /// n phi, inside the band.
    Within(f64),
}

impl Ends {
    /// o^2, which underflows to 0 on a very long bar.
    fn coupling_squared(&self) -> f64 {
        match self.o {
            Coupling::Element(o) => o * o,
            Coupling::Above(z) => self.w / z.sinh().powi(2),
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
            (false, false) if a < q => ends.coupling_squared() / (q - a) - q,
            (false, false) => return None,
        };
        Some(self.stiffness * end)
    }
}

/// What the contacts of a scene make of its equations.
#[derive(Debug)]
enum Kind {
    /// One contact of one bar with a free far end, or of two such bars that are equal: nearly explicit.
    Alone { bar: UniformBar, pair: bool },
    /// One contact: a scalar equation T(l) = c(l).
    OneContact { left: Option<(UniformBar, bool)>, right: Option<(UniformBar, bool)> },
    /// None or several: the row is eliminated and l bisected.
    Row,
}

/// The engine `closed-form`, for every scene of uniform bars.
#[derive(Debug)]
pub struct ClosedForm {
    chain: Chain<UniformBar>,
    kind: Kind,
    element_bound: f64,
    lower_bound: f64,
    compliance: Vec<f64>,
    /// The pencil of short bars, for the bound of the stiffness.
    shortened: Pencil,
}

impl ClosedForm {
    /// The engine for `scene` with `mass`.
    pub fn new(scene: &Scene, mass: MassMatrix) -> Self {
        let last = scene.bars().len() - 1;
        let fixed =
            |i: usize| (i == 0 && scene.left() == End::Fixed, i == last && scene.right() == End::Fixed);
        let uniform = |(i, bar)| UniformBar::new(bar, mass, fixed(i).0, fixed(i).1);
        let segments: Vec<UniformBar> = scene.bars().iter().enumerate().map(uniform).collect();
        let element_bound = segments.iter().map(|bar| bar.eigenvalue).fold(0.0, f64::max);
        let chain =
            Chain { left_wall: scene.left() == End::Wall, right_wall: scene.right() == End::Wall, segments };
        // K_ii/M_ii is the same for every node of a bar: 6/(2+g) EA/h/(rho h A).
        let node = |bar: &UniformBar| bar.stiffness / bar.element_mass / mass.entries().0;
        Self {
            kind: kind(&chain, scene.contact_sites().len()),
            element_bound,
            lower_bound: chain.segments.iter().map(node).fold(0.0, f64::max),
            compliance: compliance_bounds(&chain, mass),
            shortened: assemble_shortened(scene, mass),
            chain,
        }
    }

    /// T(l) = -1/phi(l) of a scene with a single contact, N/m; `None` with several contacts, and where the scene with
    /// its gap held has an eigenvalue at or above l.
    pub fn gap_stiffness(&self, l: f64) -> Option<f64> {
        let t = match self.kind {
            Kind::Row => return None,
            _ => self.excess(&[Penalty::default()], l),
        };
        t.is_finite().then_some(t)
    }

    /// Whether every eigenvalue lies below l.
    pub fn is_above_spectrum(&self, penalties: &[Penalty], l: f64) -> bool {
        self.excess(penalties, l) > 0.0
    }

    fn contact_bound(&self, penalties: &[Penalty]) -> f64 {
        let term =
            |(mu, p): (&f64, &Penalty)| p.stiffness * (mu / (1.0 + p.mass * mu)).min(2.0 / p.nodal_mass);
        self.compliance.iter().zip(penalties).map(term).sum()
    }

    /// As `sturm_backward_error`, for the formulas: q, w and the elimination take fewer than 24 roundings, each a
    /// relative error of T, which shifts the root by no more than itself because T' l >= |T|; the stored entries of
    /// the pencil differ from EA/h and rho h A by 4 more.
    fn backward_error(&self, penalties: &[Penalty], l: f64) -> f64 {
        28.0 * UNIT_ROUNDOFF * (1.0 + (self.shortened.stiffness_bound(penalties) + self.contact_bound(penalties)) / l)
    }

    /// The sign function of the spectrum: negative where an eigenvalue lies at or above l.
    fn excess(&self, penalties: &[Penalty], l: f64) -> f64 {
        match &self.kind {
            Kind::Alone { bar, pair } => alone(bar, *pair, &penalties[0], l),
            Kind::OneContact { left, right } => one_contact(left, right, &penalties[0], l),
            Kind::Row => -self.chain.last_pivot(penalties, l),
        }
    }

    fn bounds(&self, penalties: &[Penalty]) -> (f64, f64) {
        let ratio = |p: &Penalty| match p.stiffness {
            0.0 => 0.0,
            s => s / (p.mass + 0.5 * p.nodal_mass),
        };
        let mediant = penalties.iter().map(ratio).fold(self.element_bound, f64::max);
        let high = mediant.min(self.element_bound + self.contact_bound(penalties));
        // The penalty mass may pull the spectrum below the stiffest node it acts on: then look below.
        let mut low = 0.5 * self.lower_bound.min(high);
        while self.excess(penalties, low) >= 0.0 && low > f64::MIN_POSITIVE {
            low *= 0.125;
        }
        let mut high = high * (1.0 + 64.0 * f64::EPSILON);
        while self.excess(penalties, high) < 0.0 && high < f64::MAX {
            high *= 1.0 + 64.0 * f64::EPSILON;
        }
        (low, high)
    }

    fn bracket(&self, penalties: &[Penalty], start: Option<f64>) -> (f64, f64) {
        let (low, high) = self.bounds(penalties);
        if let Kind::Row = self.kind {
            return bisect(low, high, |l| self.excess(penalties, l) > 0.0);
        }
        let excess = |l: f64| self.excess(penalties, l);
        let ((low, f_low), (high, f_high)) = around(start, (low, excess(low)), (high, excess(high)), excess);
        find_sign_change((low, f_low), (high, f_high), 2.0 * f64::EPSILON, excess)
    }
}

/// Narrows a bracket around a good guess, if the guess proves to be one.
fn around(
    start: Option<f64>,
    mut low: (f64, f64),
    mut high: (f64, f64),
    f: impl Fn(f64) -> f64,
) -> ((f64, f64), (f64, f64)) {
    let Some(start) = start.filter(|l| low.0 < *l && *l < high.0) else { return (low, high) };
    let value = f(start);
    if value < 0.0 {
        low = (start, value)
    } else {
        high = (start, value)
    }
    (low, high)
}

fn compliance_bounds(chain: &Chain<UniformBar>, mass: MassMatrix) -> Vec<f64> {
    let bounds: Vec<f64> = chain.segments.iter().map(|bar| bar.compliance_bound(mass)).collect();
    let mut compliance = Vec::new();
    compliance.extend(chain.left_wall.then(|| bounds[0]));
    compliance.extend(bounds.windows(2).map(|pair| pair[0] + pair[1]));
    compliance.extend(chain.right_wall.then(|| bounds[bounds.len() - 1]));
    compliance
}

fn kind(chain: &Chain<UniformBar>, contacts: usize) -> Kind {
    let bars = &chain.segments;
    match (contacts, bars.len()) {
        (1, 1) if !bars[0].left_fixed && !bars[0].right_fixed => Kind::Alone { bar: bars[0], pair: false },
        (1, 2) if bars[0] == bars[1] && !bars[0].left_fixed => Kind::Alone { bar: bars[0], pair: true },
        (1, 1) => Kind::OneContact { left: Some((bars[0], true)), right: None },
        (1, 2) => Kind::OneContact {
            left: Some((bars[0], bars[0].left_fixed)),
            right: Some((bars[1], bars[1].right_fixed)),
        },
        _ => Kind::Row,
    }
}

/// T(l) - c(l) of [`Kind::Alone`]. Of two equal bars the gap feels half of each; their common motion does not feel
/// it at all, and bounds the spectrum from below.
#[inline]
fn alone(bar: &UniformBar, pair: bool, penalty: &Penalty, l: f64) -> f64 {
    let Some(t) = bar.seen_from_contact(l, false) else { return f64::NEG_INFINITY };
    if !pair {
        return t - (penalty.dynamic_stiffness(l) - l * penalty.nodal_mass);
    }
    let common = t + l * penalty.nodal_mass;
    if common > 0.0 { 0.5 * common - penalty.dynamic_stiffness(l) } else { f64::NEG_INFINITY }
}

/// T(l) - c(l) of one contact, N/m; -inf where the bars, joined rigidly at the contact, have an eigenvalue at or
/// above l. Two bodies act in series: T = T_1 T_2/(T_1 + T_2).
fn one_contact(
    left: &Option<(UniformBar, bool)>,
    right: &Option<(UniformBar, bool)>,
    penalty: &Penalty,
    l: f64,
) -> f64 {
    let seen = |side: &Option<(UniformBar, bool)>| {
        side.as_ref()
            .map(|(bar, far_fixed)| Some(bar.seen_from_contact(l, *far_fixed)? + l * penalty.nodal_mass))
    };
    let t = match (seen(left), seen(right)) {
        (Some(Some(t)), None) | (None, Some(Some(t))) => t,
        (Some(Some(t1)), Some(Some(t2))) if t1 + t2 > 0.0 => t1 * (t2 / (t1 + t2)),
        _ => return f64::NEG_INFINITY,
    };
    t - penalty.dynamic_stiffness(l)
}

impl Engine for ClosedForm {
    fn name(&self) -> &'static str {
        "closed-form"
    }

    #[inline]
    fn estimate(&self, penalties: &[Penalty], start: Option<f64>) -> f64 {
        if let Kind::Alone { bar, pair } = &self.kind {
            let p = &penalties[0];
            let share = if *pair { 2.0 } else { 1.0 } / bar.stiffness;
            let b = share * p.stiffness;
            let b_mass = share * (p.mass + 0.5 * p.nodal_mass) * bar.eigenvalue;
            if let Some(y) = bar.relative_rise(b, b_mass) {
                // The common motion of two equal bars keeps its frequency unless mass is added to it.
                let y = if *pair && p.nodal_mass == 0.0 { y.max(0.0) } else { y };
                return bar.eigenvalue + bar.eigenvalue * y;
            }
        }
        let (low, high) = self.bracket(penalties, start);
        low + 0.5 * (high - low)
    }

    fn enclose(&self, penalties: &[Penalty], start: Option<f64>) -> Result<Enclosure, Uncertified> {
        let value = self.estimate(penalties, start);
        let kappa = self.backward_error(penalties, value);
        // Two signs of the secular function, a little to either side of the value, prove it.
        let spread = 16.0 * f64::EPSILON;
        let (low, high) = (value * (1.0 - spread), value * (1.0 + spread));
        if self.excess(penalties, low) >= 0.0 || self.excess(penalties, high) < 0.0 {
            return Err(Uncertified { value, width: f64::INFINITY });
        }
        certify(Enclosure { value, lower: low * (1.0 - kappa), upper: high * (1.0 + kappa) })
    }
}

impl UniformBar {
    /// y = l_max/omega_e^2 - 1 of the bar with a free far end and one contact c/(EA/h) = b - b_mass x, or `None` if
    /// the iteration has not settled (the general solver then takes over).
    ///
    /// For a long bar coth = 1 and L x y = (p - b_mass y)^2, p = b - b_mass, is a quadratic, solved without
    /// cancellation; tanh is then restored by Newton's method, monotone because T is concave in l.
    #[inline]
    fn relative_rise(&self, b: f64, b_mass: f64) -> Option<f64> {
        let p = b - b_mass;
        if p <= 0.0 {
            return if p == 0.0 { Some(0.0) } else { self.in_band(-p, b_mass) };
        }
        let l = self.factor / p;
        let mut y = 2.0 * p / (2.0 * b_mass + l + (l * l + 4.0 * self.factor * (b / p)).sqrt());
        for _ in 0..40 {
            let x = 1.0 + y;
            let d = 1.0 + self.slope * x;
            let sinh = (y / d).sqrt();
            let z = 2.0 * self.elements * sinh.asinh();
            if z > SATURATION {
                return Some(y);
            }
            let t = (self.factor * x * y).sqrt() * z.tanh();
            let theta_slope = (1.0 + self.slope) / (d * d * sinh * (1.0 + sinh * sinh).sqrt());
            let t_slope =
                t * (0.5 * (1.0 + 2.0 * y) / (x * y) + 2.0 * self.elements * theta_slope / (2.0 * z).sinh());
            let step = (p - b_mass * y - t) / (t_slope + b_mass);
            y += step;
            if step.abs() <= 4.0 * f64::EPSILON * y || step.abs() <= 0.25 * f64::EPSILON {
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
            if step.abs() <= 2.0 * f64::EPSILON * u || (step * u).abs() <= 0.125 * f64::EPSILON {
                return Some(-u * u);
            }
        }
        None
    }
}
