//! Stability limits found by stepping alone: no eigenvalue, no amplification matrix, no use of how the matrices look.
//!
//! All contacts are held closed. From u = 0 and pseudo-random velocities, which excite every mode, a trial makes
//! [`Search::steps`] steps and watches the size of the motion,
//!
//! ```text
//! sqrt(v' diag(M) v + u'K u)
//! ```
//! which neither the exchange of kinetic and strain energy nor rigid motion moves: rigid motion is no growth, though its
//! displacement grows without bound. The trial is unstable when the size exceeds its start by the factor
//!
//! ```text
//! threshold = 3/sqrt(tolerance)
//! ```
//! Below its limit by the relative distance e, central difference amplitudes reach 1/sqrt(8 e), kinetic and strain energy
//! alike, and v' diag(M) v is up to three times v'M v: a stable trial is taken for unstable only where e < tolerance/12. Above it they grow by 2 sqrt(2 e) a step: 9/sqrt(tolerance) steps
//! give e^18 at e = tolerance/2. The other schemes damp what reaches the contact and grow by about e a step above their
//! limits, sometimes by far less ([`Prediction::growth`]); without a prediction they are given 100/tolerance steps.
//! Trials of at least 100/sqrt(tolerance) steps, in which all the beats of a mode next to its limit have passed many
//! times, are unstable too when the last quarter of them exceeds the third by a factor [`LATE_RISE`]. What growth was
//! seen is reported.
//!
//! [`largest_stable_courant`] knows nothing of the limit; [`confirm`] begins at a prediction, which saves most trials,
//! but whatever the prediction is, it ends at a limit that the trials show.

mod prediction;

pub use prediction::{Confirmation, Prediction, Predictor, VISIBLE_GROWTH, confirm};

pub mod opening;

use rayon::prelude::*;

use crate::error::Refusal;
use crate::impact::contact_free_step;
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::pencil::Pencil;
use crate::schemes::{ContactRule, Onset, Scheme, State, System};
use crate::stability::Model;

/// The motion is looked at every so many steps.
const STRIDE: u64 = 7;

/// A rise from the third to the last quarter of a long trial that no interference of its modes makes.
pub const LATE_RISE: f64 = 1.2;

/// A trial that has decayed by this factor holds no growing mode: rounding alone keeps a share of 1e-16.
const DECAYED: f64 = 1e-30;

/// Enlargements of the first bracket, each to the square and at most to the double, before the search gives up: beyond
/// the range of f64.
const MOST_ENLARGEMENTS: u32 = 1100;

/// Steps that show a growth of `growth` (ln of the factor a step) in a search to `tolerance`, if the growing mode holds
/// about `share` of the start. A short trial must exceed the threshold, from one part in e^10 of this share; in a long one
/// a part in e^5 makes the late rise within e^6.
pub fn steps_to_show(tolerance: f64, growth: f64, share: f64) -> f64 {
    let missing = -share.ln();
    let short = (10.0 + missing + (3.0 / tolerance.sqrt()).ln()) / growth;
    ((6.0 + missing) / growth).max(short.min(long(tolerance))).ceil()
}

/// Steps of a trial in which a late rise counts.
fn long(tolerance: f64) -> f64 {
    100.0 / tolerance.sqrt()
}

/// How closely and how long a limit is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// (unstable - stable)/unstable of the answer.
    pub tolerance: f64,
    /// Steps of a trial that does not blow up.
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
            Onset::SquareRoot => 9.0 / tolerance.sqrt(),
            Onset::Linear => 100.0 / tolerance,
        };
        Self { tolerance, steps: steps.ceil() as u64 }.checked()
    }

    /// The search with the steps that show `prediction`, or those of [`Search::to`] if these would be too many or are
    /// not known.
    ///
    /// # Errors
    /// As [`Search::to`].
    pub fn for_prediction(
        tolerance: f64,
        scheme: &dyn Scheme,
        prediction: &Prediction,
    ) -> Result<Self, Refusal> {
        let usual = Self::to(tolerance, scheme)?;
        let needed = prediction.steps_needed.filter(|_| prediction.is_visible());
        // The bracket ends at half the tolerance above the prediction, and growth at least halves with the distance.
        needed.map_or(Ok(usual), |steps| Self { tolerance, steps: 2 * steps as u64 }.checked())
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
pub struct Limit {
    /// The largest Courant number whose trial did not grow.
    pub stable_at: f64,
    /// The smallest whose trial did.
    pub unstable_at: f64,
    /// Growth there, ln of the factor a step, over the last half of the trial.
    pub growth: f64,
    /// Steps of a stable trial.
    pub steps: u64,
    /// Steps of all trials.
    pub total_steps: u64,
}

impl Limit {
    /// The middle of the bracket.
    pub fn courant(&self) -> f64 {
        0.5 * (self.stable_at + self.unstable_at)
    }

    /// Whether `predicted` lies within the relative distance `tolerance` of the bracket.
    pub fn agrees(&self, predicted: f64, tolerance: f64) -> bool {
        let margin = tolerance * predicted;
        self.stable_at - margin <= predicted && predicted <= self.unstable_at + margin
    }

    /// Whether the limit confirms `prediction` to the relative `tolerance`. `None` if no trial below the prediction grew,
    /// the limit was found above it, and the growth in between is predicted to be too slow to be seen.
    pub fn judge(&self, prediction: &Prediction, tolerance: f64) -> Option<bool> {
        let unseen = self.stable_at > prediction.courant && !prediction.is_visible();
        let agrees = self.agrees(prediction.courant, tolerance);
        (agrees || !unseen).then_some(agrees)
    }
}

/// The point of a map at which a limit is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// beta_s.
    pub stiffness_penalty: StiffnessPenalty,
    /// r.
    pub ratio: Ratio,
}

/// The largest stable Courant number of `scheme` with the contacts of `model` held closed. If a scheme is stable again above its first limit, one of its limits is found.
///
/// # Errors
/// Refuses what [`Scheme::start`], [`Model::check`] and [`Search::to`] refuse, and a model that no step makes stable or
/// unstable.
pub fn largest_stable_courant(
    model: &Model,
    scheme: &dyn Scheme,
    point: Point,
    search: &Search,
) -> Result<Limit, Refusal> {
    Trials::new(model, scheme, point, search)?.bisect((1.0, 2.0))
}

/// [`largest_stable_courant`] of every point, in parallel; in the order of `points`.
///
/// # Errors
/// The first refusal.
pub fn limits(
    model: &Model,
    scheme: &dyn Scheme,
    points: &[Point],
    search: &Search,
) -> Result<Vec<Limit>, Refusal> {
    points.par_iter().map(|point| largest_stable_courant(model, scheme, *point, search)).collect()
}

/// A stable Courant number and an unstable one with its growth: `start` divided and multiplied by `factor`, or further
/// away.
fn bracket(
    (start, factor): (f64, f64),
    grows: &mut impl FnMut(f64) -> Result<Option<f64>, Refusal>,
) -> Result<(f64, f64, f64), Refusal> {
    let (mut stable, mut step, mut unstable) = (start / factor, factor, None);
    for _ in 0..MOST_ENLARGEMENTS {
        match (grows(stable)?, unstable) {
            (Some(growth), _) => unstable = Some((stable, growth)),
            (None, Some((above, growth))) => return Ok((stable, above, growth)),
            (None, None) => return upwards(stable, start, factor, grows),
        }
        step = (step * step).min(2.0);
        stable /= step;
    }
    Err(Refusal::new("Courant number", stable, "a model that some step makes stable"))
}

fn upwards(
    mut stable: f64,
    start: f64,
    factor: f64,
    grows: &mut impl FnMut(f64) -> Result<Option<f64>, Refusal>,
) -> Result<(f64, f64, f64), Refusal> {
    let (mut courant, mut step) = (start * factor, factor);
    for _ in 0..MOST_ENLARGEMENTS {
        if let Some(growth) = grows(courant)? {
            return Ok((stable, courant, growth));
        }
        (stable, step) = (courant, (step * step).min(2.0));
        courant *= step;
    }
    Err(Refusal::new("Courant number", stable, "a model that some step makes unstable"))
}

/// What the trials of one point share.
struct Trials<'a> {
    model: &'a Model,
    scheme: &'a dyn Scheme,
    pencil: Pencil,
    critical_step: f64,
    point: Point,
    search: Search,
}

/// How a trial ended.
struct Trial {
    /// `None` for a stable one.
    growth: Option<f64>,
    steps: u64,
}

impl<'a> Trials<'a> {
    fn new(model: &'a Model, scheme: &'a dyn Scheme, point: Point, search: &Search) -> Result<Self, Refusal> {
        let search = search.checked()?;
        model.check(point.stiffness_penalty, point.ratio)?;
        let critical_step = contact_free_step(model)?;
        Ok(Self { model, scheme, pencil: model.pencil().at_rest(), critical_step, point, search })
    }

    /// The limit, beginning with a bracket as wide as the tolerance around `courant`.
    fn near(&self, courant: f64) -> Result<Limit, Refusal> {
        self.bisect((courant, (1.0 + self.search.tolerance).sqrt()))
    }

    /// Brackets the limit from a first guess and a factor, and bisects the bracket.
    fn bisect(&self, guess: (f64, f64)) -> Result<Limit, Refusal> {
        let mut total_steps = 0;
        let mut grows = |courant: f64| {
            let trial = self.run(courant)?;
            total_steps += trial.steps;
            Ok::<_, Refusal>(trial.growth)
        };
        let (mut stable_at, mut unstable_at, mut growth) = bracket(guess, &mut grows)?;
        while unstable_at - stable_at > self.search.tolerance * unstable_at {
            let middle = 0.5 * (stable_at + unstable_at);
            match grows(middle)? {
                Some(seen) => (unstable_at, growth) = (middle, seen),
                None => stable_at = middle,
            }
        }
        Ok(Limit { stable_at, unstable_at, growth, steps: self.search.steps, total_steps })
    }

    fn run(&self, courant: f64) -> Result<Trial, Refusal> {
        let (pencil, n) = (&self.pencil, self.pencil.size());
        let system = System {
            pencil,
            penalty: self.model.penalty(self.point.stiffness_penalty, self.point.ratio),
            load: Vec::new(),
            time_step: self.model.time_step(courant),
            critical_step: self.critical_step,
            rule: ContactRule::HeldClosed,
            account: false,
        };
        let mut motion = self.scheme.start(system, vec![0.0; n], pseudo_random(n))?;
        let start = size(pencil, motion.state());
        let bound = self.search.threshold() * start;
        let mut seen = Vec::with_capacity((self.search.steps / STRIDE) as usize + 1);
        for step in 1..=self.search.steps {
            motion.step();
            if step % STRIDE == 0 {
                let now = size(pencil, motion.state());
                seen.push(now);
                if now.is_nan() || now > bound {
                    return Ok(Trial { growth: Some(late_growth(start, &seen)), steps: step });
                }
                if now < DECAYED * start {
                    return Ok(Trial { growth: None, steps: step });
                }
            }
        }
        let growth = late_growth(start, &seen);
        let rises = growth * 0.25 * self.search.steps as f64 > LATE_RISE.ln();
        let is_long = self.search.steps as f64 >= long(self.search.tolerance);
        Ok(Trial { growth: (is_long && rises).then_some(growth), steps: self.search.steps })
    }
}

/// sqrt(v' diag(M) v + u'K u), J^(1/2). In differences: a rigid translation has no strain, however far.
fn size(pencil: &Pencil, state: &State) -> f64 {
    let (u, v) = (&state.displacement, &state.velocity);
    let kinetic: f64 = v.iter().enumerate().map(|(i, v)| pencil.mass().diagonal(i) * v * v).sum();
    let strain = pencil.stiffness().strain(u, u);
    (kinetic + strain).sqrt()
}

/// ln of the factor a step over the last half, from the largest values of its third and fourth quarter.
fn late_growth(start: f64, seen: &[f64]) -> f64 {
    let quarter = seen.len() / 4;
    let last = seen.last().copied().unwrap_or(start);
    if quarter == 0 {
        return (last / start).ln() / (seen.len().max(1) as f64 * STRIDE as f64);
    }
    let end = seen.len();
    let (third, fourth) = (largest(&seen[end - 2 * quarter..end - quarter]), largest(&seen[end - quarter..]));
    (fourth / third).ln() / (quarter as f64 * STRIDE as f64)
}

/// The largest of sizes >= 0.
fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |a: f64, b| a.max(*b))
}

/// Numbers between -1 and 1 without a pattern, the same in every run (SplitMix64; Steele, Lea, Flood 2014).
fn pseudo_random(n: usize) -> Vec<f64> {
    let mut seed = 0_u64;
    let mut next = || {
        seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = seed;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let bits = (z ^ (z >> 31)) >> 11;
        bits as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| next()).collect()
}
