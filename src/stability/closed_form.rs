//! Uniform bars in closed form: one evaluation costs the same for 1 element and for 1e6.
//!
//! A [`UniformBar`] is reduced to its ends. A single contact obeys T(l) = c(l) = s - l m with T = w/q for a free far end
//! and T = q for a fixed one (the secular equation 1 + c phi = 0 with phi = -1/T). Eliminating whole bars and counting
//! signs is the algorithm of Wittrick and Williams (Q. J. Mech. Appl. Math. 24, 1971).

use super::UniformBar;
use super::uniform_bar::Compressed;
use crate::fem::{MassMatrix, assemble_shortened, contact_scales};
use crate::pencil::{Penalty, Pencil, Scale, Terms, contact_sum};
use crate::scene::{End, Scene};
use crate::spectrum::{
    Chain, Condensed, Enclosure, Engine, UNIT_ROUNDOFF, Uncertified, bisect, certify, find_sign_change,
};

/// The sign of the computed T(l) - c(l) is right outside [l (1 - e), l (1 + e)] around the root l, e = ROUNDOFFS u (1 + B/l)
/// with u = 2^-53 and B a bound of the stiffness, contacts included, relative to the mass.
///
/// q, w and the elimination take fewer than 24 roundings. Each is a relative error of T or of a part of it, which shifts the root by no
/// more than itself, because |T| <= F' l at the root, F = T - c: where T = s - l m > 0, T = a l + b - sum <= a l <= T' l since b <= 0
/// (T is negative for l < 0), and where it is negative, |T| = l m - s <= m l. (|T| <= T' l alone is false: a fixed element far
/// below its band has T' l near 0 and T near -EA/h.) Inside the band, and close to its edge, the roundings of
/// y = l/omega_e^2 - 1 and of the angle are relative errors of y, at most 14 of them, and shift l by B |y|, not by l: they are
/// part of the term B/l. The stored entries of the pencil differ from EA/h and rho h A by 4 more, of which those of the
/// mass count thrice: 24 + 12 for what goes with l, 28 and fewer for what goes with B.
const ROUNDOFFS: f64 = 36.0;

/// What the contacts of a scene make of its equations.
#[derive(Debug)]
enum Kind {
    /// One contact of one bar with a free far end, or of two such bars that are equal: nearly explicit.
    /// `share` is 1/(EA/h) of the bar, twice that where the gap is shared.
    Alone { bar: UniformBar, compressed: Compressed, pair: bool, share: f64 },
    /// One contact: a scalar equation T(l) = c(l).
    OneContact { left: Option<(UniformBar, bool)>, right: Option<(UniformBar, bool)> },
    /// None or several: the row is eliminated and l bisected.
    Row,
}

/// The engine `closed-form`, for every scene of uniform bars.
#[derive(Debug)]
pub struct ClosedForm {
    chain: Chain<UniformBar>,
    scales: Vec<Scale>,
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
            scales: contact_scales(scene),
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
            _ => self.excess(&[Terms::default()], l),
        };
        t.is_finite().then_some(t)
    }

    /// l_max without its proof: what the proof costs can then be measured.
    #[inline]
    pub fn unproven(&self, penalty: &Penalty) -> f64 {
        penalty.with_terms(&self.scales, |terms| self.estimate(terms, None))
    }

    /// Whether every eigenvalue lies below l.
    pub fn is_above_spectrum(&self, penalty: &Penalty, l: f64) -> bool {
        penalty.with_terms(&self.scales, |terms| self.is_above(terms, l))
    }

    /// The relative distance that rounding may shift the root of the computed T(l) = c(l): [`ROUNDOFFS`].
    fn backward_error(&self, terms: &[Terms], l: f64) -> f64 {
        let bars = self.shortened.chain().map_or(self.element_bound, |chain| chain.stiffness_bound(terms));
        let stiffness = bars + contact_sum(&self.compliance, terms);
        UNIT_ROUNDOFF * ROUNDOFFS * (1.0 + stiffness / l)
    }

    /// The sign function of the spectrum: negative where an eigenvalue lies at or above l.
    fn excess(&self, terms: &[Terms], l: f64) -> f64 {
        match &self.kind {
            Kind::Alone { bar, pair, .. } => alone(bar, *pair, &terms[0], l),
            Kind::OneContact { left, right } => one_contact(left, right, &terms[0], l),
            Kind::Row => -self.chain.last_pivot(terms, l),
        }
    }

    fn bounds(&self, terms: &[Terms]) -> (f64, f64) {
        let ratio = |p: &Terms| match p.stiffness {
            0.0 => 0.0,
            s => s / (p.mass + 0.5 * p.nodal_mass),
        };
        let mediant = terms.iter().map(ratio).fold(self.element_bound, f64::max);
        let high = mediant.min(self.element_bound + contact_sum(&self.compliance, terms));
        // The penalty mass may pull the spectrum below the stiffest node it acts on: then look below.
        let mut low = 0.5 * self.lower_bound.min(high);
        while self.excess(terms, low) >= 0.0 && low > f64::MIN_POSITIVE {
            low *= 0.125;
        }
        let mut high = high * (1.0 + 64.0 * f64::EPSILON);
        // Rounding may put the bound a few units on the wrong side; the doubling ends the search whatever happens.
        let mut widening = 64.0 * f64::EPSILON;
        while self.excess(terms, high) < 0.0 && high < f64::MAX {
            high *= 1.0 + widening;
            widening *= 2.0;
        }
        (low, high)
    }

    fn bracket(&self, terms: &[Terms], start: Option<f64>) -> (f64, f64) {
        let (low, high) = self.bounds(terms);
        if let Kind::Row = self.kind {
            return bisect(low, high, |l| self.excess(terms, l) > 0.0);
        }
        let excess = |l: f64| self.excess(terms, l);
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
        (1, 1) if !bars[0].left_fixed && !bars[0].right_fixed => Kind::Alone {
            bar: bars[0],
            compressed: bars[0].compressed(),
            pair: false,
            share: 1.0 / bars[0].stiffness,
        },
        (1, 2) if bars[0] == bars[1] && !bars[0].left_fixed => Kind::Alone {
            bar: bars[0],
            compressed: bars[0].compressed(),
            pair: true,
            share: 2.0 / bars[0].stiffness,
        },
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
fn alone(bar: &UniformBar, pair: bool, terms: &Terms, l: f64) -> f64 {
    let Some(t) = bar.seen_from_contact(l, false) else { return f64::NEG_INFINITY };
    if !pair {
        return t - (terms.dynamic_stiffness(l) - l * terms.nodal_mass);
    }
    let common = t + l * terms.nodal_mass;
    if common > 0.0 { 0.5 * common - terms.dynamic_stiffness(l) } else { f64::NEG_INFINITY }
}

/// T(l) - c(l) of one contact, N/m; -inf where the bars, joined rigidly at the contact, have an eigenvalue at or
/// above l. Two bodies act in series: T = T_1 T_2/(T_1 + T_2).
fn one_contact(
    left: &Option<(UniformBar, bool)>,
    right: &Option<(UniformBar, bool)>,
    terms: &Terms,
    l: f64,
) -> f64 {
    let seen = |side: &Option<(UniformBar, bool)>| {
        side.as_ref()
            .map(|(bar, far_fixed)| Some(bar.seen_from_contact(l, *far_fixed)? + l * terms.nodal_mass))
    };
    let t = match (seen(left), seen(right)) {
        (Some(Some(t)), None) | (None, Some(Some(t))) => t,
        (Some(Some(t1)), Some(Some(t2))) if t1 + t2 > 0.0 => t1 * (t2 / (t1 + t2)),
        _ => return f64::NEG_INFINITY,
    };
    t - terms.dynamic_stiffness(l)
}

impl ClosedForm {
    #[inline]
    fn estimate(&self, terms: &[Terms], start: Option<f64>) -> f64 {
        if let Kind::Alone { bar, compressed, pair, share } = &self.kind {
            let p = &terms[0];
            let b = share * p.stiffness;
            let b_mass = share * (p.mass + 0.5 * p.nodal_mass) * bar.eigenvalue;
            if let Some(y) = bar.relative_rise(compressed, b, b_mass) {
                // The common motion of two equal bars keeps its frequency unless mass is added to it.
                let y = if *pair && p.nodal_mass == 0.0 { y.max(0.0) } else { y };
                return bar.eigenvalue + bar.eigenvalue * y;
            }
        }
        let (low, high) = self.bracket(terms, start);
        low + 0.5 * (high - low)
    }

    fn certified(&self, terms: &[Terms], start: Option<f64>) -> Result<Enclosure, Uncertified> {
        let value = self.estimate(terms, start);
        let kappa = self.backward_error(terms, value);
        // Two signs of the secular function, a little to either side of the value, prove it.
        let spread = 16.0 * f64::EPSILON;
        let (low, high) = (value * (1.0 - spread), value * (1.0 + spread));
        if self.excess(terms, low) >= 0.0 || self.excess(terms, high) < 0.0 {
            return Err(Uncertified { value, width: f64::INFINITY });
        }
        certify(Enclosure { value, lower: low * (1.0 - kappa), upper: high * (1.0 + kappa) })
    }
}

impl Engine for ClosedForm {
    fn name(&self) -> &'static str {
        "closed-form"
    }

    #[inline]
    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Enclosure, Uncertified> {
        penalty.with_terms(&self.scales, |terms| self.certified(terms, start))
    }

    fn condensed(&self) -> Option<&dyn Condensed> {
        Some(self)
    }
}

impl Condensed for ClosedForm {
    fn is_above(&self, terms: &[Terms], l: f64) -> bool {
        self.excess(terms, l) > 0.0
    }

    fn rounding(&self, l: f64) -> f64 {
        UNIT_ROUNDOFF * ROUNDOFFS * (1.0 + self.element_bound / l)
    }
}
