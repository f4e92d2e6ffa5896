//! The inverse of f: how far t may go until the largest eigenvalue passes l.
//!
//! From above by Newton's method on the lines of vectors: each line lies below f, so that f > l beyond the t at which the
//! line passes l, and as f is convex the zeros of its tangents descend to the solution. From below by a proof of f(t) <= l a
//! little before it.

use super::curve::Curve;
use super::factor::Verdict;
use super::source::Source;
use super::span::Line;
use super::upper::ProvenPoint;

/// Where f passes l.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passing {
    /// Proven: f(t) <= l up to here; -infinity where nothing is.
    pub lower: f64,
    /// Proven: f(t) > l beyond; infinite where nothing is.
    pub upper: f64,
}

/// Newton steps; each doubles the digits once it is near.
const MOST_STEPS: usize = 60;

impl Line {
    /// A t beyond which the line lies above l; infinite where it does nowhere.
    fn passes(&self, l: f64) -> f64 {
        let missing = l - self.stiffness;
        let slope = if missing >= 0.0 { self.least_penalty } else { self.most_penalty };
        if slope <= 0.0 {
            return if missing < 0.0 { f64::NEG_INFINITY } else { f64::INFINITY };
        }
        // The line takes off four roundings of its terms, and the division rounds.
        let t = (missing + 16.0 * f64::EPSILON * (l.abs() + self.stiffness.abs())) / slope;
        t + 16.0 * f64::EPSILON * t.abs()
    }
}

impl<S: Source> Curve<S> {
    /// Where f passes l >= f(0), to `tolerance` relative as far as proofs reach.
    pub fn passing(&mut self, l: f64, tolerance: f64) -> Passing {
        let upper = self.passed(l, tolerance);
        if !self.source.has_contacts() {
            return Passing { lower: self.upper.reach(l), upper };
        }
        if upper.is_finite() && upper > 0.0 && self.upper.reach(l) < upper * (1.0 - tolerance) {
            self.prove_before(l, upper, tolerance);
        }
        Passing { lower: self.upper.reach(l).min(upper), upper }
    }

    /// The t beyond which f is above l >= f(0), as [`Curve::passing`] has it; no proof is needed to know that it is.
    pub fn passed(&mut self, l: f64, tolerance: f64) -> f64 {
        self.options.tolerance = tolerance;
        let mut upper = self.beyond(l);
        for _ in 0..MOST_STEPS {
            if !upper.is_finite() || upper <= 0.0 {
                break;
            }
            self.sample(upper, false);
            self.lower_at(upper);
            let next = self.beyond(l);
            let settled = upper - next <= 0.01 * tolerance * next.abs();
            upper = next;
            if settled {
                break;
            }
        }
        upper
    }

    /// The smallest t beyond which some line lies above l.
    fn beyond(&self, l: f64) -> f64 {
        self.lines.iter().map(|line| line.passes(l)).fold(f64::INFINITY, f64::min)
    }

    /// Proves f(t) <= l at a t as close below `upper` as rounding, or the size of the patches, lets it.
    fn prove_before(&mut self, l: f64, upper: f64, tolerance: f64) {
        let (mut before, mut failed) = (0.25 * tolerance, 0.0);
        while before < 1.0 {
            if self.prove_at(l, upper * (1.0 - before), before) {
                break;
            }
            (failed, before) = (before, 4.0 * before);
        }
        // Patches are too high by their nature: how far is looked for closely. By chance each trial is a search.
        if before < 4.0 && failed > 0.0 && self.source.is_patched() {
            for _ in 0..4 {
                let middle = (failed * before).sqrt();
                if middle < 1.0 && self.prove_at(l, upper * (1.0 - middle), middle) {
                    before = middle;
                } else {
                    failed = middle;
                }
            }
        }
    }

    /// Tries to prove f(t) <= l; a part `room` of l may go to rounding.
    fn prove_at(&mut self, l: f64, t: f64, room: f64) -> bool {
        let mut margin = 0.01 * room;
        // The margin that rounding needs is known after one trial, and hardly changes with itself.
        for _ in 0..3 {
            match self.try_to_prove(l, (1.0, t), margin) {
                Verdict::Proven => {
                    self.upper.add(ProvenPoint { t, u: l });
                    return true;
                }
                Verdict::Refuted => break,
                Verdict::TooClose(needed) => margin = 2.0 * needed,
            }
        }
        false
    }
}
