//! Beyond the contact-free step: where l M - K + t(l) Z Z' is definite.

use crate::pencil::Terms;
use crate::schemes::closed::{COMPLIANCE_ERROR, ClosedContacts};
use crate::spectrum::{Enclosure, UNIT_ROUNDOFF, Uncertified, WIDEST_ENCLOSURE, certify};

/// How closely the ends of an island are looked for, relative: far below what stepping tells apart, and 30 halvings.
pub(super) const RESOLUTION: f64 = 1e-9;

/// The sign of l M - K + t(l) Z Z' with t(l) = s' l/(l - q), q = 4 s' mu.
pub(super) struct Definite<'a> {
    pub closed: &'a ClosedContacts<'a>,
    pub q: f64,
    pub mu: f64,
}

impl Definite<'_> {
    /// Whether l M - K + t Z Z' > 0.
    pub fn holds(&self, l: f64, t: f64) -> bool {
        let contact = Terms { stiffness: -t, ..Terms::default() };
        let contacts = vec![contact; self.closed.compliance.diagonal.len()];
        self.closed.is_above(&contacts, l)
    }

    /// t(l), N/m.
    fn stiffness(&self, l: f64) -> f64 {
        0.25 * self.q / self.mu * (l / (l - self.q))
    }

    /// The highest interval of [low, high] in which definiteness is lost, narrowed to rounding; `None` if it is
    /// nowhere.
    pub fn last_loss(&self, low: f64, high: f64, depth: usize) -> Option<(f64, f64)> {
        if self.is_definite_over(low, high) {
            return None;
        }
        let middle = low + 0.5 * (high - low);
        // 64 halvings exhaust f64; an interval of 4 units in the last place is a point.
        if depth >= 64 || high - low <= 8.0 * UNIT_ROUNDOFF * high {
            return Some((low, high));
        }
        self.last_loss(middle, high, depth + 1).or_else(|| self.last_loss(low, middle, depth + 1))
    }

    /// Adds the intervals of [low, high] on which l M - K + t(l) Z Z' > 0 is proven, from above, neighbours joined. Within
    /// an interval the matrix is no larger than high M - K + t(low) Z Z': if that is indefinite, so is all of it.
    pub fn stable_within(&self, low: f64, high: f64, found: &mut Vec<(f64, f64)>) {
        if self.is_definite_over(low, high) {
            match found.last_mut() {
                Some(last) if last.0 == high => last.0 = low,
                _ => found.push((low, high)),
            }
        } else if self.holds(high, self.stiffness(low)) && high - low > 0.1 * RESOLUTION * high {
            let middle = low + 0.5 * (high - low);
            self.stable_within(middle, high, found);
            self.stable_within(low, middle, found);
        }
    }

    /// Whether l M - K + t(l) Z Z' > 0 is proven all over [low, high]: the tangent of t at the middle lies below t, and
    /// the matrix with the tangent is affine in l.
    fn is_definite_over(&self, low: f64, high: f64) -> bool {
        let middle = low + 0.5 * (high - low);
        let slope = -self.stiffness(middle) * (self.q / middle) / (middle - self.q);
        let tangent = |l: f64| self.stiffness(middle) + slope * (l - middle);
        let kept = 1.0 - self.contact_error(middle);
        let proven = |l: f64| self.holds(l * (1.0 - self.closed.rounding(l)), tangent(l) * kept);
        proven(high) && proven(low)
    }

    /// Relative error of t(l): that of mu and a few roundings, enlarged by the difference l - q.
    fn contact_error(&self, l: f64) -> f64 {
        (COMPLIANCE_ERROR + 8.0 * UNIT_ROUNDOFF) * (l / (l - self.q))
    }

    /// Above `high` nothing is lost, and below `floor` = 4 s' mu all is; between them a sign a little below `low`, with
    /// its rounding to the safe side, proves the loss.
    pub fn prove(&self, low: f64, high: f64, floor: f64) -> Result<Enclosure, Uncertified> {
        let value = low + 0.5 * (high - low);
        let mut spread = 4.0 * f64::EPSILON;
        let mut lower = floor;
        while spread < WIDEST_ENCLOSURE && low * (1.0 - spread) > floor.max(self.q) {
            let l = low * (1.0 - spread);
            if !self
                .holds(l * (1.0 + self.closed.rounding(l)), self.stiffness(l) * (1.0 + self.contact_error(l)))
            {
                lower = l;
                break;
            }
            spread *= 1.5;
        }
        certify(Enclosure { value, lower, upper: high })
    }
}
