//! The search for the limit y* = 2/h* of one point, by enclosures of undamped problems.

use super::{Damping, Equivalent};
use crate::spectrum::{Enclosure, Step, UNIT_ROUNDOFF};

/// Relative error of l_max/kappa: 6 unit roundoffs of s, 15 of m, 5 of kappa and one of the quotient.
const ROUNDING: f64 = 32.0 * UNIT_ROUNDOFF;

/// Halving every third time at least, from any bracket of f64 (2^11 in the logarithm) to a unit in the last place.
const ROUNDS: usize = 3 * (11 + 53);

/// What is known of y*, and where to look next.
#[derive(Debug)]
pub(super) struct Search {
    damping: Damping,
    /// Whether y* >= A.
    unheld: bool,
    /// low <= y* <= high, if y* > A.
    low: f64,
    high: f64,
    next: f64,
    /// The last point, ln(kappa/l_max) there.
    last: Option<(f64, f64)>,
    rounds: usize,
    state: Outcome,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Outcome {
    Open,
    /// 1 lies within the last enclosure of kappa/l_max, or low and high are neighbours.
    Found,
    /// Stable as far as A.
    AtMass,
    Failed,
}

impl Search {
    /// From the undamped l_max, which is near where there is little damping.
    pub fn new(damping: Damping, undamped: f64, unheld: bool) -> Self {
        let next = damping.place(undamped).max(damping.floor());
        let (low, high) = (damping.floor(), f64::INFINITY);
        Self { damping, unheld, low, high, next, last: None, rounds: 0, state: Outcome::Open }
    }

    /// The next problem to enclose; `None` at the end.
    pub fn ask(&self) -> Option<Equivalent> {
        (self.state == Outcome::Open).then(|| self.damping.at(self.next))
    }

    /// Takes an enclosure of the l_max that was asked for.
    pub fn tell(&mut self, l_max: Enclosure) {
        let (y, kappa) = (self.next, self.damping.at(self.next).l);
        let (least, most) = (l_max.lower / kappa * (1.0 - ROUNDING), l_max.upper / kappa * (1.0 + ROUNDING));
        if !(least > 0.0 && most >= least && most.is_finite() && kappa.is_finite()) {
            self.state = Outcome::Failed;
            return;
        }
        // Powers are right to a few units in the last place; an exponent of at most 1 passes on no more than its base has.
        let (fall, rise) = (1.0 - 4.0 * f64::EPSILON, 1.0 + 4.0 * f64::EPSILON);
        let exponent = 1.0 / self.damping.steepness(y * most.max(1.0));
        let (below, above) = (least < 1.0, most > 1.0);
        self.low = self.low.max(if below { y * least.powf(exponent) * fall } else { y });
        self.high = self.high.min(if above { y * most.powf(exponent) * rise } else { y });
        self.rounds += 1;
        let neighbours = self.high <= self.low * (1.0 + 8.0 * f64::EPSILON);
        if y <= self.damping.floor() && !above {
            self.state = Outcome::AtMass;
        } else if (below && above) || neighbours {
            self.state = Outcome::Found;
        } else if self.rounds >= ROUNDS {
            self.state = Outcome::Failed;
        } else {
            self.choose(y, -(l_max.value / kappa).ln());
        }
    }

    /// The secant through the last two points; every third time, and where that leads nowhere, the middle.
    fn choose(&mut self, y: f64, excess: f64) {
        let secant = match self.last {
            Some((before, other)) if other != excess => y - excess * ((y - before) / (excess - other)),
            // A slope of 2 by ln y, as without damping.
            _ => y * (-0.5 * excess).exp(),
        };
        self.last = Some((y, excess));
        let inside = secant > self.low && secant < self.high && !self.rounds.is_multiple_of(3);
        let middle = self.low + 0.5 * (self.high - self.low);
        self.next = if inside { secant } else { middle.max(self.damping.floor()) };
    }

    /// The limit as l = y*^2; `None` where it was not found.
    pub fn step(&self) -> Option<Step> {
        let mass = self.damping.mass;
        let (low, high) = match self.state {
            Outcome::Found => (self.low, self.high),
            Outcome::AtMass => (mass, self.damping.floor()),
            Outcome::Open | Outcome::Failed => return None,
        };
        let square = |y: f64, margin: f64| y * y * (1.0 + margin);
        let (lower, upper) = (square(low, -2.0 * f64::EPSILON), square(high, 2.0 * f64::EPSILON));
        if lower > upper {
            return None;
        }
        let value = square(self.next, 0.0).max(lower).min(upper);
        let l = Enclosure { value, lower, upper };
        if low > self.damping.floor() {
            return Some(Step::proven(l));
        }
        // What lies below the floor is not seen, unless y* cannot lie below A.
        let lower = square(mass, -2.0 * f64::EPSILON);
        let l = Enclosure { lower, ..l };
        Some(if self.unheld { Step::proven(l) } else { Step::at_least(l) })
    }
}
