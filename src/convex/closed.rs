//! Limits of a scheme that sees closed contacts by their flexibility alone, on any mesh.
//!
//! Let a scheme with the step alpha dt_c, dt_c = 2/l_c^(1/2), l_max(K, M) <= l_c, be stable exactly when
//!
//! ```text
//! 1/s Y^-1 + 1/R G - W(alpha) >= 0        Y = diag(w_j)    G = Z'M^-1 Z    s = beta_s    R = r omega_ref^2
//! W(alpha) = p Z'(a l_c M - K)^-1 Z - v Z'(b l_c M + K)^-1 Z                    with a, b, p, v functions of alpha
//! ```
//! and let every form y'W(alpha) y be a convex, increasing function of alpha that is 0 at 0. Then the flexibility of some steps
//! tells that of all others: chords between two of them lie above W, their extensions below, for every y at once. So a
//! chord proves a step stable without another solution, one vector y and an extension prove it unstable, and where that is
//! too wide, one more flexibility is computed ([`Responder`]). The flexibilities serve all points of a map.

use super::dense::Form;
use super::pencil::MeshPencil;
use super::response::{Responder, Shifted};
use crate::double_double::{Dd, Real};
use crate::interrupt;

/// a, b, p and v at one alpha.
#[derive(Debug, Clone, Copy)]
pub struct Poles {
    /// a > 1.
    pub above: Dd,
    /// b > 0; `None` where v = 0.
    pub below: Option<Dd>,
    /// p.
    pub gain: Dd,
    /// v.
    pub loss: Dd,
}

/// alpha of a limit: stable at the first, not beyond the second; 1 where the contact-free mesh limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Proven stable.
    pub stable: f64,
    /// Proven unstable, or 1.
    pub unstable: f64,
}

/// What is given where the other of s and R is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Given {
    /// R, rad^2/s^2.
    Rate(f64),
    /// 1/s.
    Softness(f64),
}

/// W at one alpha.
#[derive(Debug)]
struct Node {
    alpha: f64,
    flexibility: Form,
}

/// The flexibility of the contacts of a pencil at some steps.
pub struct Flexibilities {
    responder: Responder,
    poles: Box<dyn Fn(f64) -> Poles + Send>,
    /// l_c, rad^2/s^2.
    top: f64,
    scales: Vec<f64>,
    compliance: Form,
    /// alpha ascends; the first is 0.
    nodes: Vec<Node>,
}

impl std::fmt::Debug for Flexibilities {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Flexibilities").field("top", &self.top).field("nodes", &self.nodes.len()).finish()
    }
}

/// The first alpha that is computed, and the first that follow while the limit lies above: 1 - alpha is squared.
const FIRST: f64 = 0.5;
/// Flexibilities that a point may take.
const MOST_NODES: usize = 48;

impl Flexibilities {
    /// The flexibilities of a pencil with l_max(K, M) <= `top` and M >= diag(M)/`condition`.
    pub fn new(
        pencil: &MeshPencil,
        top: f64,
        condition: f64,
        poles: Box<dyn Fn(f64) -> Poles + Send>,
    ) -> Self {
        let responder = Responder::new(pencil, condition);
        let own = Shifted { mass: Dd::from(1.0), stiffness: 0.0, least: 1.0 };
        let k = pencil.contacts().len();
        let response = responder.respond(own, CLOSEST / k.max(1) as f64);
        let compliance = form(&response.entries, |i| {
            2.0 * (response.error + f64::EPSILON) * k as f64 * response.entries[i * k + i].hi
        });
        let scales = pencil.contacts().iter().map(|contact| contact.scale).collect();
        let nodes = vec![Node { alpha: 0.0, flexibility: Form::zeros(k) }];
        Self { responder, poles, top, scales, compliance, nodes }
    }

    /// l_c, rad^2/s^2.
    pub fn top(&self) -> f64 {
        self.top
    }

    /// The alpha of a limit, to `tolerance` relative as far as rounding lets it: of 1/s and R, rad^2/s^2, which lies between
    /// two numbers. The larger R, the less is stable.
    pub fn limit(&mut self, softness: f64, rate: (f64, f64), tolerance: f64) -> Share {
        let contacts = self.contacts(softness, rate.1);
        let stiffer = self.contacts(softness, rate.0);
        let mut best = Share { stable: 0.0, unstable: 1.0 };
        for _ in 0..MOST_NODES {
            let last = self.stable_nodes(&contacts) - 1;
            let Some(right) = self.nodes.get(last + 1).map(|node| node.alpha) else {
                let alpha = self.nodes[last].alpha;
                best.stable = best.stable.max(alpha);
                if best.unstable - alpha <= tolerance * alpha {
                    return best;
                }
                let beside = (1.0 - alpha).powi(2).max(0.5 * tolerance);
                self.compute(if alpha == 0.0 { FIRST } else { 1.0 - beside }, tolerance);
                continue;
            };
            let left = self.nodes[last].alpha;
            let (stable, y) = self.chord(&contacts, last, tolerance);
            best.stable = best.stable.max(stable);
            best.unstable = best.unstable.min(self.extension(&stiffer, last, &y));
            if best.unstable - best.stable <= tolerance * best.stable {
                return best;
            }
            let next = next((left, right), best, tolerance);
            if !(next > left && next < right) {
                return best;
            }
            self.compute(next, tolerance);
        }
        best
    }

    /// The smallest 1/s, or 1/R, that `alpha` is stable with: proven from above, and from below.
    pub fn least(&mut self, alpha: f64, given: Given, tolerance: f64) -> (f64, f64) {
        let at = self.at(alpha, tolerance);
        let (rest, own) = match given {
            Given::Rate(rate) => (self.contacts(0.0, rate), self.contacts(1.0, f64::INFINITY)),
            Given::Softness(softness) => (self.contacts(softness, f64::INFINITY), self.compliance.clone()),
        };
        let flexibility = &self.nodes[at].flexibility;
        let missing = |x: f64| rest.combined(1.0, &own, x).combined(1.0, flexibility, -1.0);
        if missing(0.0).definite().is_some() {
            return (0.0, 0.0);
        }
        // Of one contact, W_jj over its own; all together take no more than k times the largest.
        let size = |i: usize| flexibility.diagonal(i) / own.diagonal(i);
        let most = (0..own.size()).map(size).fold(0.0, f64::max);
        let (mut low, mut high) = (0.0, 2.0 * most * own.size() as f64);
        while high - low > 0.25 * tolerance * high && high > most * f64::EPSILON {
            let middle = 0.5 * (low + high);
            if missing(middle).definite().is_some() { high = middle } else { low = middle }
        }
        let Some(definite) = missing(high).definite() else { return (f64::INFINITY, 0.0) };
        let y = definite.least(&self.start(), &own);
        // y'(W - rest) y/y'own y is no more than the smallest.
        let (lost, error) = rest.combined(1.0, flexibility, -1.0).along(&y);
        let (unit, more) = own.along(&y);
        let below = (-lost - error) / (unit + more) * (1.0 - 8.0 * f64::EPSILON);
        (high, below.max(0.0))
    }

    /// The node of an alpha, computed if there is none.
    fn at(&mut self, alpha: f64, tolerance: f64) -> usize {
        if self.nodes.iter().all(|node| node.alpha.to_bits() != alpha.to_bits()) {
            self.compute(alpha, tolerance);
        }
        self.nodes.partition_point(|node| node.alpha < alpha)
    }

    /// 1/s Y^-1 + 1/R G.
    fn contacts(&self, softness: f64, rate: f64) -> Form {
        let k = self.scales.len();
        let mut own = Form::zeros(k);
        for (i, scale) in self.scales.iter().enumerate() {
            own.entries[i * k + i] = softness / scale;
            own.error[i] = 4.0 * f64::EPSILON * softness / scale;
        }
        own.combined(1.0, &self.compliance, if rate.is_finite() { 1.0 / rate } else { 0.0 })
    }

    /// How many nodes are proven to be stable; 0 always is.
    fn stable_nodes(&self, contacts: &Form) -> usize {
        let unstable = |node: &Node| contacts.combined(1.0, &node.flexibility, -1.0).definite().is_none();
        1 + self.nodes[1..].partition_point(|node| !unstable(node))
    }

    /// The largest alpha between node `last` and the next that the chord proves, and a vector that tells what limits it.
    fn chord(&self, contacts: &Form, last: usize, tolerance: f64) -> (f64, Vec<f64>) {
        let (left, right) = (&self.nodes[last], &self.nodes[last + 1]);
        let at = |share: f64| {
            let chord = left.flexibility.combined(1.0 - share, &right.flexibility, share);
            contacts.combined(1.0, &chord, -1.0).definite()
        };
        let place = |share: f64| left.alpha + share * (right.alpha - left.alpha);
        let (mut low, mut high) = (0.0, 1.0);
        while place(high) - place(low) > 0.1 * tolerance * place(low) && high - low > f64::EPSILON * high {
            let middle = 0.5 * (low + high);
            if at(middle).is_some() { low = middle } else { high = middle }
        }
        let start = self.start();
        let y = at(low).map_or_else(|| start.clone(), |definite| definite.least(&start, contacts));
        // The place itself rounds.
        (place(low) * (1.0 - 4.0 * f64::EPSILON), y)
    }

    /// Somewhat of every contact.
    fn start(&self) -> Vec<f64> {
        super::vectors::pseudo_random(self.scales.len(), 1).iter().map(|y| y + 1.5).collect()
    }

    /// An alpha beyond which y is proven to grow; 1 where it is not.
    fn extension(&self, contacts: &Form, last: usize, y: &[f64]) -> f64 {
        let (own, error) = contacts.along(y);
        let needed = (own + error) * (1.0 + 8.0 * f64::EPSILON);
        let known = |at: usize| self.nodes.get(at).map(|node| (node.alpha, node.flexibility.along(y)));
        let mut found = 1.0_f64;
        // From the nodes below: W(alpha) >= (1 + x) W_i - x W_i-1, x = (alpha - alpha_i)/(alpha_i - alpha_i-1).
        if let (Some(before), Some((left, (w, e)))) = (last.checked_sub(1).and_then(known), known(last)) {
            let (at, (lower, off)) = before;
            let slope = (w - e - lower - off) / (left - at);
            if slope > 0.0 {
                found = found.min(left + (needed - (w - e)).max(0.0) / slope);
            }
        }
        if let Some((right, (w, e))) = known(last + 1)
            && w - e >= needed
        {
            found = found.min(right);
            // From the nodes above, downwards.
            if let Some((at, (upper, off))) = known(last + 2) {
                let slope = (upper + off - w + e) / (at - right);
                found = found.min(right - (w - e - needed) / slope);
            }
        }
        (found * (1.0 + 64.0 * f64::EPSILON)).min(1.0)
    }

    /// Computes W at alpha in (0, 1).
    fn compute(&mut self, alpha: f64, tolerance: f64) {
        interrupt::look();
        let k = self.scales.len();
        let Poles { above, below, gain, loss } = (self.poles)(alpha);
        let top = Dd::from(self.top);
        // For small steps the two parts cancel: W has this share of the first.
        let distance = (above - Dd::from(1.0)).hi;
        let ratio = below.map_or(0.0, |below| (loss * above / (gain * below)).hi);
        let goal = (0.01 * tolerance * (1.0 - ratio) / k as f64).max(SMALLEST);
        let shifted = Shifted { mass: top * above, stiffness: -1.0, least: self.top * distance * BELOW };
        let gained = self.responder.respond(shifted, goal);
        let mut entries: Vec<Dd> = gained.entries.iter().map(|w| gain * *w).collect();
        let mut error: Vec<f64> = (0..k).map(|i| gained.error * k as f64 * entries[i * k + i].hi).collect();
        if let Some(below) = below {
            // Beside l M rounding leaves K as good as semidefinite.
            let shifted = Shifted { mass: top * below, stiffness: 1.0, least: self.top * below.hi * BELOW };
            let lost = self.responder.respond(shifted, goal);
            for (i, error) in error.iter_mut().enumerate() {
                *error += lost.error * k as f64 * (loss * lost.entries[i * k + i]).hi;
            }
            entries.iter_mut().zip(&lost.entries).for_each(|(w, l)| *w = *w - loss * *l);
        }
        // What e, the poles and the parts round to is covered by doubling; the entries of W round to f64.
        let unit = f64::EPSILON * (k + 4) as f64;
        let cancelled = 1.0 + 256.0 * Dd::ROUNDOFF / f64::EPSILON / ((1.0 - ratio) * distance.min(1.0));
        let flexibility = form(&entries, |i| 2.0 * error[i] + unit * cancelled * entries[i * k + i].hi.abs());
        let at = self.nodes.partition_point(|node| node.alpha < alpha);
        self.nodes.insert(at, Node { alpha, flexibility });
    }
}

/// Where to compute next between two nodes, of which the first is stable and the second was not proven to be: at what is known
/// of the limit, on the side where the node is farther; where that is not within a factor of 4 yet, of alpha or, next to the
/// pole of W beyond 1, of 1 - alpha, at the mean of the ends.
fn next((left, right): (f64, f64), best: Share, tolerance: f64) -> f64 {
    let (low, high) = (best.stable.max(left), best.unstable.min(right));
    if left > 0.0 && high > FAR * low {
        return (low * high).sqrt();
    }
    if 1.0 - low > FAR * (1.0 - high) {
        return 1.0 - ((1.0 - low) * (1.0 - high)).sqrt();
    }
    if right - best.unstable >= best.stable - left {
        best.unstable + 0.25 * tolerance * best.stable
    } else {
        best.stable * (1.0 - 0.25 * tolerance)
    }
}

/// A factor beyond which chords tell little.
const FAR: f64 = 4.0;

/// e of a response that is not asked for more closely, and the smallest that can be asked for.
const CLOSEST: f64 = 1e-14;
const SMALLEST: f64 = 1e-26;
/// Below a bound by more than rounding.
const BELOW: f64 = 1.0 - 1e-6;

/// A form with the errors of its diagonal.
fn form(entries: &[Dd], error: impl Fn(usize) -> f64) -> Form {
    let entries: Vec<f64> = entries.iter().map(|w| w.hi).collect();
    let k = (entries.len() as f64).sqrt().round() as usize;
    Form { entries, error: (0..k).map(error).collect() }
}
