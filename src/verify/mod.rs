//! Stability limits found by stepping alone.
//!
//! # A trial
//! All contacts are held closed. From u = 0 and pseudo-random velocities, which excite every mode, a trial makes
//! [`Search::steps`] steps, a number N that follows from scheme and tolerance, and watches the size of the motion,
//!
//! ```text
//! sqrt(v'M v + u'K u + 2 |what the closed contacts store|)
//! ```
//! which neither the exchange of kinetic, strain and contact energy nor rigid motion moves: rigid motion is no growth,
//! though its displacement grows without bound. What contacts store is the scheme's ([`Energy::penalty`]): with the kinetic
//! energy of the mass penalty for central differences, where it is an inertia. It counts at the start too, and gap rates
//! begin so small that contacts and bodies hold about the same; a stiff penalty would else begin with beta_s times the
//! energy of the bodies and hand it to them. The motion grows if the size exceeds its start by the factor
//!
//! ```text
//! threshold = 3/sqrt(tolerance)
//! ```
//! or, in long trials, if the mean of size^2 over the last window of the trial, 3/8 of it, exceeds that over the window
//! before by [`LATE_RISE`]. A trial is long if
//!
//! ```text
//! N >= 100/sqrt(tolerance)      and      3/8 N dt >= 10 T      T = bound of the period of the slowest swing
//! ```
//!
//! *Threshold.* Below its limit by the relative distance e, the size of central differences stays below 1/sqrt(2 e) times
//! its start, as 1 - dt^2 l/4 >= 2 e to first order in each mode: a stable trial is taken for unstable only where e is below
//! a 1/18 of the tolerance. Above it they grow by 2 sqrt(2 e) a step, so
//! that 13/sqrt(tolerance) steps give e^18 at e = tolerance/4. The other schemes damp what reaches the contact and grow
//! by about e a step above their limits, sometimes by far less ([`Prediction::growth`]): they are given 100/tolerance.
//!
//! *Late rise.* A swing of which a window does not hold some ten periods may look like growth: it could make a false
//! limit, as at steps so small that a trial ends within a swing of the bars (Park, beta_s = 1e6, r = inf). T is at most
//! 2 pi sqrt(m f), m the mass of all bars, f the sum of the compliances of bars and contacts. A late rise is missed where
//! a decaying motion that is larger still hides it.
//!
//! *What a trial can see.* If the growing mode holds one part in e^10 of the start, a growth of (10 + ln threshold)/N a
//! step shows, whatever else moves; in long trials, if it holds one part in e^5, 6/N does ([`Search::visible_growth`]).
//! Slower growth may show ([`LATE_RISE`] within 3/8 of the trial at best) or not. So a trial that did not grow does not
//! prove a stable step. Growth seen by the threshold is growth unless the motion is one that swells and shrinks again;
//! growth seen by a late rise is measured, not proven.
//!
//! # The search
//! Courant numbers are tried on the lattice 2^(k/P) only, P the smallest power of two that sets neighbours at most the
//! tolerance apart. The answer is a pair of neighbours of which the lower one does not grow and the upper one does. If
//! trials stay as they are below one number and grow above it, there is only one such pair, and the search ends there
//! wherever it begins: a prediction only says where to look first. *Islands*, steps that are stable again above a loss:
//! two octaves below the pair are scanned by shorter trials, eight to an octave, and where one grows the search goes on
//! below it. A loss narrower than 9 %, or too slow for a trial of 1/64 of the length, is not seen by the scan, and then
//! the pair may depend on where the search began. Nothing above the pair is looked at.
//!
//! *Growth at every step.* A motion that grows in time, whatever the step, looks stable where the step is so small that a
//! trial no longer sees it. Growth that begins at a limit is fast beyond it: unless a trial at two or four times the step
//! passes the threshold within 1/2^5 or 1/4^5 of the steps, the pair says how much a trial can see and nothing about
//! stability, and no stable step is reported ([`Bracket::stable_at`] = 0). Nor is one where the upper trial of the pair grew by a late
//! rise alone and the lower one is too short for late rises to count. Growth a step in proportion to dt^p, p < 5, is so
//! found out wherever N/4^5 steps are at least the 7 between two looks at the size (derived for that form of growth,
//! tried on p = 1). A limit beyond which all growth is slower than that is reported as none.
//!
//! # What is used
//! K, M and the contact terms, through the stepper and its energies. No eigenvalue and no amplification matrix enters a
//! trial, with one exception: the Park scheme has the contact-free critical step dt_c as a parameter, and that comes
//! from the contact-free spectrum.

mod any;
mod lattice;
mod linear;
mod prediction;
mod slowest;
mod trial;

pub use any::{Seconds, check_any, confirm_any, limit_of_any, points_of, predict_any};
pub use linear::{Basis, LinearStep, STEPPED_TO, linear_step};
pub use prediction::{Confirmation, Prediction, Predictor, confirm};
pub use trial::LATE_RISE;

pub mod opening;

use rayon::prelude::*;

use crate::error::Refusal;
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::pencil::Penalty;
#[cfg(doc)]
use crate::schemes::Energy;
use crate::schemes::{Onset, Scheme};
use crate::spectrum::Evidence;
use crate::stability::Model;

use lattice::Lattice;
use trial::{SWINGS, Stepped, Trials, WINDOW};

/// Steps that show a growth of `growth` (ln of the factor a step) in a search to `tolerance`, if the growing mode holds
/// about `share` of the start and the slowest swing takes `swing` steps. A short trial must exceed the threshold, from one
/// part in e^10 of this share; in a long one a part in e^5 makes the late rise within e^6.
pub fn steps_to_show(tolerance: f64, growth: f64, share: f64, swing: f64) -> f64 {
    let missing = -share.ln();
    let short = (10.0 + missing + (3.0 / tolerance.sqrt()).ln()) / growth;
    ((6.0 + missing) / growth).max(short.min(long(tolerance, swing))).ceil()
}

/// Steps of a trial in which a late rise counts: with ten of the slowest swings, of `swing` steps, in a window.
fn long(tolerance: f64, swing: f64) -> f64 {
    (100.0 / tolerance.sqrt()).max(SWINGS * swing / WINDOW)
}

/// How closely and how long a limit is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// (unstable - stable)/unstable of the answer, at most.
    pub tolerance: f64,
    /// Steps of a trial that neither blows up nor dies out.
    pub steps: u64,
}

impl Search {
    /// The search to `tolerance` with the steps that `scheme` needs for it.
    ///
    /// # Errors
    /// Refuses a tolerance outside [1e-12, 0.1], where rounding or the threshold would decide, and one that asks for
    /// more than 1e9 steps a trial.
    pub fn to(tolerance: f64, scheme: &dyn Scheme) -> Result<Self, Refusal> {
        if !(1e-12..=0.1).contains(&tolerance) {
            return Err(Refusal::new("tolerance", tolerance, "a number in [1e-12, 0.1]"));
        }
        let steps = match scheme.facts().onset {
            Onset::SquareRoot => 13.0 / tolerance.sqrt(),
            Onset::Linear => 100.0 / tolerance,
        };
        Self { tolerance, steps: steps.ceil() as u64 }.checked()
    }

    /// The growth, ln of the factor a step, from which on a trial shows it: whatever else moves if the growing mode holds
    /// one part in e^10 of the start; in `long` trials, if it holds one part in e^5.
    pub fn visible_growth(&self, long: bool) -> f64 {
        let needed = if long { 6.0 } else { 10.0 + self.threshold().ln() };
        needed / self.steps as f64
    }

    /// Whether a late rise counts where the slowest swing takes `swing` steps.
    pub fn is_long(&self, swing: f64) -> bool {
        self.steps as f64 >= long(self.tolerance, swing)
    }

    fn checked(self) -> Result<Self, Refusal> {
        let held = (1..=1_000_000_000).contains(&self.steps);
        held.then_some(self).ok_or_else(|| Refusal::new("steps of a trial", self.steps, "1 to 1e9"))
    }

    fn threshold(&self) -> f64 {
        3.0 / self.tolerance.sqrt()
    }
}

/// A limit between two Courant numbers c0 dt/h of the reference element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bracket {
    /// The Courant number below the limit, whose trial did not grow; 0 if no step was found that is stable.
    pub stable_at: f64,
    /// Its neighbour, whose trial did; without a stable step, the smallest that was tried and grew.
    pub unstable_at: f64,
    /// Growth there, ln of the factor a step: over the whole trial if it exceeded the threshold, else over its last part.
    pub growth: f64,
    /// Steps of a stable trial.
    pub steps: u64,
    /// Steps of all trials.
    pub total_steps: u64,
}

impl Bracket {
    /// The middle of the bracket.
    pub fn courant(&self) -> f64 {
        0.5 * (self.stable_at + self.unstable_at)
    }

    /// Whether `predicted` lies within the relative distance `tolerance` of the bracket.
    pub fn agrees(&self, predicted: f64, tolerance: f64) -> bool {
        let margin = tolerance * predicted;
        self.stable_at > 0.0 && self.stable_at - margin <= predicted && predicted <= self.unstable_at + margin
    }

    /// Whether the limit confirms `prediction` to the relative `tolerance`; of a lower bound, whether the limit is not
    /// below it. `None` if no trial below the prediction grew and stepping cannot tell more: the limit was found above it
    /// and the growth in between is predicted to be too slow to be seen in trials of this length, or no stable step was
    /// found.
    pub fn judge(&self, prediction: &Prediction, tolerance: f64) -> Option<bool> {
        if self.unstable_at < prediction.courant * (1.0 - tolerance) {
            return Some(false);
        }
        if self.agrees(prediction.courant, tolerance) {
            return Some(true);
        }
        let above = self.stable_at > prediction.courant;
        match prediction.evidence {
            Evidence::LowerBound => above.then_some(true),
            Evidence::Proven | Evidence::Probability(_) => {
                (above && prediction.is_visible(self.steps)).then_some(false)
            }
        }
    }
}

/// The point of a map at which a limit is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PenaltyPoint {
    /// beta_s.
    pub stiffness_penalty: StiffnessPenalty,
    /// r.
    pub ratio: Ratio,
}

/// The largest stable Courant number of `scheme` with the contacts of `model` held closed. The search begins at 1; see the [module](self) for schemes that are stable again above a limit.
///
/// # Errors
/// Refuses what [`Scheme::start`], [`Model::check`] and [`Search::to`] refuse, and a model
/// that no step makes unstable.
pub fn largest_stable_courant(
    model: &Model,
    scheme: &dyn Scheme,
    point: PenaltyPoint,
    search: &Search,
) -> Result<Bracket, Refusal> {
    model.check(point.stiffness_penalty, point.ratio)?;
    limit_from(1.0, model, scheme, model.penalty(point.stiffness_penalty, point.ratio), search)
}

/// [`largest_stable_courant`] with any penalty, and a Courant number to look at first, which
/// does not change the answer as far as the [module](self) says.
///
/// # Errors
/// As [`largest_stable_courant`].
pub fn limit_from(
    first: f64,
    model: &Model,
    scheme: &dyn Scheme,
    penalty: Penalty,
    search: &Search,
) -> Result<Bracket, Refusal> {
    Lattice::new(&Trials::new(Stepped::bars(model, &penalty)?, scheme, penalty, search)?).limit(first)
}

/// Refuses what cannot be stepped at all: the diagonalised mass penalty of a pair.
///
/// # Errors
/// See [`Scheme::start`].
pub fn check(model: &Model, scheme: &dyn Scheme, search: &Search) -> Result<(), Refusal> {
    let penalty = model.penalty(StiffnessPenalty::new(1.0)?, Ratio::OPTIMAL);
    Trials::new(Stepped::bars(model, &penalty)?, scheme, penalty, search)?.start(1.0).map(|_| ())
}

/// [`largest_stable_courant`] of every point, in parallel; in the order of `points`.
///
/// # Errors
/// The first refusal.
pub fn limits(
    model: &Model,
    scheme: &dyn Scheme,
    points: &[PenaltyPoint],
    search: &Search,
) -> Result<Vec<Bracket>, Refusal> {
    points.par_iter().map(|point| largest_stable_courant(model, scheme, *point, search)).collect()
}
