//! One run with closed contacts at one step: does the motion grow?

use crate::error::Refusal;
use crate::impact::contact_free_step;
use crate::interrupt;
use crate::pencil::{Penalty, Pencil};
use crate::schemes::{ContactRule, Energy, Motion, Scheme, System};
use crate::stability::Model;

use super::Search;
use super::slowest::slowest_period;

/// The motion is looked at every so many steps. Odd, so that an oscillation of even period does not look constant.
pub(super) const STRIDE: u64 = 7;

/// ln of the rise of size^2 from one window to the next that counts as growth. Of a steady oscillation with p periods in
/// a window the mean with Hann weights leaves less than 1/p^3: with ten periods less than a tenth of this.
pub const LATE_RISE: f64 = 0.01;

/// Periods of the slowest swing in a window from which on a late rise counts.
pub(super) const SWINGS: f64 = 10.0;

/// The part of a trial that each of the two windows takes.
pub(super) const WINDOW: f64 = 0.375;

/// A trial that has decayed by this factor holds no growing mode: rounding alone keeps a share of 1e-16.
const DECAYED: f64 = 1e-30;

/// How a trial ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    /// Whether it grew.
    pub grows: bool,
    /// Whether it did so by a late rise alone.
    pub late: bool,
    /// ln of the factor a step by which size grew late in the trial.
    pub growth: f64,
    /// Steps made.
    pub steps: u64,
}

/// What is stepped.
pub(super) struct Stepped {
    /// K, M and the contacts, at rest.
    pub pencil: Pencil,
    /// dt_c, s, without contact: a parameter of the Park scheme.
    pub critical_step: f64,
    /// dt of the Courant number 1, s.
    pub unit: f64,
    /// Bound of the period of the slowest swing, s; infinite where none is known, and then no late rise counts.
    pub slowest: f64,
}

impl Stepped {
    /// Bars.
    pub fn bars(model: &Model, penalty: &Penalty) -> Result<Self, Refusal> {
        let (critical_step, unit) = (contact_free_step(model)?, model.time_step(1.0));
        let slowest = slowest_period(model, penalty);
        Ok(Self { pencil: model.pencil().at_rest(), critical_step, unit, slowest })
    }
}

/// What the trials of one point share: no part of it comes from a prediction.
pub(super) struct Trials<'a> {
    stepped: Stepped,
    penalty: Penalty,
    scheme: &'a dyn Scheme,
    pub search: Search,
    /// v at the start, m/s.
    velocity: Vec<f64>,
}

impl<'a> Trials<'a> {
    /// Trials with `penalty`, from contacts at rest.
    pub fn new(
        stepped: Stepped,
        scheme: &'a dyn Scheme,
        penalty: Penalty,
        search: &Search,
    ) -> Result<Self, Refusal> {
        let velocity = pseudo_random(stepped.pencil.size());
        let mut trials = Self { stepped, penalty, scheme, search: search.checked()?, velocity };
        let Energy { kinetic, penalty, .. } = trials.start(1.0)?.energy();
        if penalty > 0.0 {
            let part = (kinetic / (kinetic + penalty)).sqrt();
            scale_gaps(&trials.stepped.pencil, part, &mut trials.velocity);
        }
        Ok(trials)
    }

    /// Whether late rises count at a Courant number.
    pub fn sees_late(&self, courant: f64) -> bool {
        self.search.is_long(self.stepped.slowest / (courant * self.stepped.unit))
    }

    /// The motion at a Courant number, from u = 0 and pseudo-random velocities. Where a mass penalty is an inertia, it would
    /// hold nearly all energy of such a start; so the gap rates are made smaller until it holds about what the bodies do.
    pub fn start(&self, courant: f64) -> Result<Box<dyn Motion>, Refusal> {
        let system = System {
            pencil: &self.stepped.pencil,
            penalty: self.penalty,
            load: Vec::new(),
            time_step: courant * self.stepped.unit,
            critical_step: self.stepped.critical_step,
            rule: ContactRule::HeldClosed,
            account: false,
        };
        self.scheme.start(system, vec![0.0; self.velocity.len()], self.velocity.clone())
    }

    /// A trial of at most `steps` steps.
    pub fn run(&self, courant: f64, steps: u64) -> Result<Trial, Refusal> {
        let mut motion = self.start(courant)?;
        let start = squared_size(&mut *motion);
        let bound = self.search.threshold().powi(2) * start;
        let mut windows = Windows::new(steps);
        for step in 1..=steps {
            motion.step();
            if step % STRIDE != 0 {
                continue;
            }
            interrupt::look();
            let now = squared_size(&mut *motion);
            if now.is_nan() || now > bound {
                // Not a number follows from infinity: the last finite size told the growth as well as any.
                let last = if now.is_finite() { now } else { f64::MAX.min(bound) };
                return Ok(Trial {
                    grows: true,
                    late: false,
                    growth: 0.5 * (last / start).ln() / step as f64,
                    steps: step,
                });
            }
            if now < DECAYED * DECAYED * start {
                return Ok(Trial {
                    grows: false,
                    late: false,
                    growth: 0.5 * (now / start).ln() / step as f64,
                    steps: step,
                });
            }
            windows.add(step, now);
        }
        let (rise, growth) = windows.rise();
        let grows = steps == self.search.steps && rise > LATE_RISE && self.sees_late(courant);
        Ok(Trial { grows, late: grows, growth, steps })
    }
}

/// Means of size^2 with Hann weights over the two windows [N/4, 5 N/8] and [5 N/8, N].
struct Windows {
    start: f64,
    length: f64,
    sums: [f64; 2],
}

impl Windows {
    fn new(steps: u64) -> Self {
        let steps = steps as f64;
        Self { start: 0.25 * steps, length: WINDOW * steps, sums: [0.0; 2] }
    }

    fn add(&mut self, step: u64, size: f64) {
        let x = (step as f64 - self.start) / self.length;
        if x >= 0.0 {
            let weight = 1.0 - (std::f64::consts::TAU * x.fract()).cos();
            self.sums[usize::from(x >= 1.0)] += weight * size;
        }
    }

    /// ln of the rise from the first to the second, and half of it a step.
    fn rise(&self) -> (f64, f64) {
        let rise = (self.sums[1] / self.sums[0]).ln();
        (rise, 0.5 * rise / self.length)
    }
}

/// v'M v + u'K u and twice what the closed contacts store, J. In differences: a rigid translation has no strain, however
/// far. With all of the energy modes add up without cross terms, so that their beats are no rise. Beyond dt^2 s' mu = 1 the
/// predictor-corrector leaves gaps of the other sign, and contacts store less than nothing: they count by the modulus.
fn squared_size(motion: &mut dyn Motion) -> f64 {
    let Energy { kinetic, strain, penalty, .. } = motion.energy();
    2.0 * (kinetic + strain + penalty.abs())
}

/// Makes the gap rates z'v smaller by the factor `part`, gap by gap along z; where gaps share nodes nearly so.
fn scale_gaps(pencil: &Pencil, part: f64, v: &mut [f64]) {
    let columns = || pencil.gaps().iter().map(|gap| &gap.column);
    let wanted: Vec<f64> = columns().map(|z| part * z.dot(v)).collect();
    for (z, wanted) in columns().zip(wanted) {
        let square: f64 = z.0.iter().map(|(_, z)| z * z).sum();
        z.add_to((wanted - z.dot(v)) / square, v);
    }
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
