//! Uniform bars in closed form: one evaluation costs the same for 1 element and for 1e6.
//!
//! A [`UniformBar`] is reduced to its ends. A single contact obeys T(l) = c(l) = s - l m with T = w/q for a free far end
//! and T = q for a fixed one (the secular equation 1 + c phi = 0 with phi = -1/T). Eliminating whole bars and counting
//! signs is the algorithm of Wittrick and Williams (Q. J. Mech. Appl. Math. 24, 1971).

use super::UniformBar;
use super::uniform_bar::Compressed;
use crate::fem::{MassMatrix, assemble_shortened};
use crate::pencil::{Penalty, Pencil};
use crate::scene::{End, Scene};
use crate::spectrum::{
    Chain, Enclosure, Engine, UNIT_ROUNDOFF, Uncertified, bisect, certify, find_sign_change,
};

/// Roundings of T(l) and of the stored mass, in units of the roundoff, of [`ClosedForm::backward_error`]: 24 + 12.
pub(super) const ROUNDINGS: f64 = 24.0 + 12.0;

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
    /// the pencil differ from EA/h and rho h A by 4 more, of which those of the mass count thrice.
    fn backward_error(&self, penalties: &[Penalty], l: f64) -> f64 {
        let stiffness = self.shortened.stiffness_bound(penalties) + self.contact_bound(penalties);
        UNIT_ROUNDOFF * (ROUNDINGS + 28.0 * stiffness / l)
    }

    /// The sign function of the spectrum: negative where an eigenvalue lies at or above l.
    fn excess(&self, penalties: &[Penalty], l: f64) -> f64 {
        match &self.kind {
            Kind::Alone { bar, pair, .. } => alone(bar, *pair, &penalties[0], l),
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
        // Rounding may put the bound a few units on the wrong side; the doubling ends the search whatever happens.
        let mut widening = 64.0 * f64::EPSILON;
        while self.excess(penalties, high) < 0.0 && high < f64::MAX {
            high *= 1.0 + widening;
            widening *= 2.0;
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
        if let Kind::Alone { bar, compressed, pair, share } = &self.kind {
            let p = &penalties[0];
            let b = share * p.stiffness;
            let b_mass = share * (p.mass + 0.5 * p.nodal_mass) * bar.eigenvalue;
            if let Some(y) = bar.relative_rise(compressed, b, b_mass) {
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
