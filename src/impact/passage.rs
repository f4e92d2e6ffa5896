//! The passage of an encounter in time.

use std::sync::Arc;

use super::advance::{Observer, Pace, advance, steps};
use super::run::MAX_STEPS;
use super::{Encounter, Ending, Outcome, Record};
use crate::error::Refusal;
use crate::memory;
use crate::pencil::{Matrix, Penalty};
use crate::schemes::{ContactRule, Energy, Motion, Scheme, State, System};

/// An encounter stepped in time.
#[derive(Debug, Clone)]
pub struct Passage {
    encounter: Encounter,
    scheme: Arc<dyn Scheme>,
    penalty: Penalty,
    rule: ContactRule,
    relative_courant: f64,
    duration: f64,
}

impl Passage {
    /// `encounter` by `scheme` with the time step C dt_cr over `duration` (s).
    ///
    /// # Errors
    /// A C or a duration that is not positive and finite, more than [`MAX_STEPS`] steps.
    pub fn new(
        encounter: Encounter,
        scheme: impl Into<Arc<dyn Scheme>>,
        penalty: Penalty,
        relative_courant: f64,
        duration: f64,
    ) -> Result<Self, Refusal> {
        for (place, value) in [("relative Courant number", relative_courant), ("duration", duration)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Refusal::new(place, value, "a positive finite number"));
            }
        }
        let (scheme, rule) = (scheme.into(), ContactRule::Unilateral);
        let passage = Self { encounter, scheme, penalty, rule, relative_courant, duration };
        let steps = duration / passage.time_step();
        if steps > MAX_STEPS {
            let value = format!("{duration:e}, which makes {steps:.3e} steps");
            return Err(Refusal::new("duration", value, format!("at most {MAX_STEPS:e} steps")));
        }
        Ok(passage)
    }

    /// The same passage with contacts held open or closed.
    pub fn with_rule(self, rule: ContactRule) -> Self {
        Self { rule, ..self }
    }

    /// The encounter.
    pub fn encounter(&self) -> &Encounter {
        &self.encounter
    }

    /// dt, s.
    pub fn time_step(&self) -> f64 {
        self.relative_courant * self.encounter.critical_step
    }

    /// Steps until the duration is reached or passed.
    pub fn steps(&self) -> u64 {
        steps(self.duration, self.time_step())
    }

    /// The scheme.
    pub fn scheme(&self) -> &dyn Scheme {
        &*self.scheme
    }

    /// Bytes taken while the passage goes on, about: the matrices as they are and as the steps have them, ten vectors of
    /// the unknowns, and for contacts that act on each other three matrices between them.
    pub fn working_bytes(&self) -> u64 {
        let pencil = &self.encounter.pencil;
        let stored = |matrix: &Matrix| match matrix {
            Matrix::Sparse(a) => 12 * a.len() + 8 * a.rows(),
            Matrix::Chain(_) | Matrix::Diagonal(_) => 16 * matrix.size(),
        };
        let matrices = 2 * (stored(pencil.stiffness()) + stored(pencil.mass()));
        let k = pencil.gaps().len();
        (matrices + 80 * pencil.size() + 24 * k * k) as u64
    }

    /// Rows of one every so many steps, the start and the end.
    pub fn rows(&self, every: u64) -> u64 {
        self.steps() / every.max(1) + 2
    }

    /// The motion at time 0; `account` as in [`System`].
    ///
    /// # Errors
    /// As [`Scheme::start`].
    pub fn prepare(&self, account: bool) -> Result<Box<dyn Motion>, Refusal> {
        let Encounter { pencil, velocity, load, critical_step } = &self.encounter;
        let system = System {
            pencil,
            penalty: self.penalty,
            load: load.clone(),
            time_step: self.time_step(),
            critical_step: *critical_step,
            rule: self.rule,
            account,
        };
        self.scheme.start(system, vec![0.0; pencil.size()], velocity.clone())
    }

    /// Steps through the passage, with a row every so many steps, the first and the last among them. `see` is shown each
    /// recorded state, for pictures.
    ///
    /// # Errors
    /// As [`Passage::prepare`]; rows every 0 steps, and more rows than the memory holds.
    pub fn execute(
        &self,
        every: u64,
        progress: Option<Observer>,
        mut see: impl FnMut(f64, &dyn Motion),
    ) -> Result<Record, Refusal> {
        self.check_rows(every)?;
        let mut record = Record::new(self.encounter.pencil.gaps().len());
        let outcome = self.stream(every, progress, |time, motion| {
            record.note(time, motion);
            see(time, motion);
        })?;
        (record.switches, record.steps, record.ending) = (outcome.switches, outcome.steps, outcome.ending);
        Ok(record)
    }

    /// Steps through the passage and keeps nothing: `see` is shown the state every so many steps, the first and the last among
    /// them, synchronised.
    ///
    /// # Errors
    /// As [`Passage::prepare`]; rows every 0 steps.
    pub fn stream(
        &self,
        every: u64,
        progress: Option<Observer>,
        mut see: impl FnMut(f64, &mut dyn Motion),
    ) -> Result<Outcome, Refusal> {
        if every == 0 {
            return Err(Refusal::new("steps between records", 0, "at least 1"));
        }
        let mut motion = self.prepare(true)?;
        let dt = self.time_step();
        let pace = Pace { steps: self.steps(), time_step: dt, reference_speed: self.reference_speed() };
        let first = motion.energy();
        let note = |step: u64, last: bool, motion: &mut dyn Motion| {
            if step.is_multiple_of(every) || last {
                motion.synchronise();
                see(step as f64 * dt, motion);
            }
        };
        let ending = advance(&mut *motion, pace, progress, note);
        let energy = [first, motion.energy()];
        let State { switches, steps, .. } = *motion.state();
        Ok(Outcome { energy, switches, steps, ending })
    }

    fn check_rows(&self, every: u64) -> Result<(), Refusal> {
        let rows = self.rows(every);
        let row = (8 + 16 * self.encounter.pencil.gaps().len() + size_of::<Energy>()) as u64;
        memory::require(
            ("steps between records", &every.to_string()),
            &format!("{rows} rows"),
            rows * row,
            |available| super::least_every(self.steps(), 1, row, available),
        )
    }

    /// The largest initial speed plus what the load adds over the duration, m/s.
    fn reference_speed(&self) -> f64 {
        let Encounter { pencil, velocity, load, .. } = &self.encounter;
        let initial = velocity.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        let rate = |(i, f): (usize, &f64)| f.abs() / pencil.mass().diagonal(i);
        initial + self.duration * load.iter().enumerate().map(rate).fold(0.0, f64::max)
    }
}

impl Ending {
    /// Whether the duration was reached.
    pub fn is_finished(self) -> bool {
        self == Self::Finished
    }
}
