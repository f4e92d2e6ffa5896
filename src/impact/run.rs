//! One contact-impact run: a model, penalties, a scheme and a step.

use std::sync::Arc;

use super::advance::{self, Observer, Pace, advance};
use super::comparison::Comparison;
use super::{Ending, History, Mesh, Recording, StressField};
use crate::error::Refusal;
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::pencil::Penalty;
use crate::scene::Bar;
use crate::schemes::{ContactRule, Motion, Scheme, State, System};
use crate::spectrum::{Engine as _, Uncertified};
use crate::stability::Model;

/// More steps than this are refused: years of computing.
pub const MAX_STEPS: f64 = 1e9;

/// A run that has passed its checks.
#[derive(Debug, Clone)]
pub struct Run {
    model: Model,
    penalty: Penalty,
    scheme: Arc<dyn Scheme>,
    rule: ContactRule,
    critical_step: f64,
    duration: f64,
    relative_courant: f64,
}

impl Run {
    /// C = dt/dt_cr where nothing else is said.
    pub const RELATIVE_COURANT: f64 = 0.5;

    /// The run of `model` with (beta_s, r) at C = 1/2 over the duration of its scene.
    ///
    /// # Errors
    /// Refuses penalties that f64 cannot hold, a scene without `[impact]`, and one whose contact-free limit is not certified.
    pub fn new(
        model: Model,
        scheme: impl Into<Arc<dyn Scheme>>,
        beta_s: StiffnessPenalty,
        ratio: Ratio,
    ) -> Result<Self, Refusal> {
        model.check(beta_s, ratio)?;
        let Some(impact) = model.scene().impact() else {
            let place = format!("scene {}, impact", model.scene().name());
            let allowed = "an [impact] table with a duration (s), which time stepping needs";
            return Err(Refusal::new(place, "no [impact]", allowed));
        };
        let run = Self {
            duration: impact.duration,
            penalty: model.penalty(beta_s, ratio),
            critical_step: contact_free_step(&model)?,
            rule: ContactRule::Unilateral,
            relative_courant: Self::RELATIVE_COURANT,
            scheme: scheme.into(),
            model,
        };
        run.checked()
    }

    /// The same run with dt = C dt_cr, dt_cr of the contact-free scene.
    ///
    /// # Errors
    /// Refuses a C that is not positive and finite.
    pub fn with_relative_courant(self, relative_courant: f64) -> Result<Self, Refusal> {
        Self { relative_courant, ..self }.checked()
    }

    /// The same run over another duration, s.
    ///
    /// # Errors
    /// Refuses a duration that is not positive and finite.
    pub fn with_duration(self, duration: f64) -> Result<Self, Refusal> {
        Self { duration, ..self }.checked()
    }

    /// The same run with contacts held open or closed.
    pub fn with_rule(self, rule: ContactRule) -> Self {
        Self { rule, ..self }
    }

    fn checked(self) -> Result<Self, Refusal> {
        let positive = |place: &str, value: f64, unit: &str| {
            let held = value > 0.0 && value.is_finite();
            let refusal = || Refusal::new(place, value, format!("a positive finite number{unit}"));
            held.then_some(()).ok_or_else(refusal)
        };
        positive("relative Courant number", self.relative_courant, "")?;
        positive("duration", self.duration, " (s)")?;
        positive("time step", self.time_step(), " (s)")?;
        self.check_energy()?;
        Ok(self)
    }

    /// What [`Run::execute`] refuses before the first step: it depends on duration, step and recording together.
    ///
    /// # Errors
    /// More than [`MAX_STEPS`] steps, a recording every 0 steps, more elements or rows than the memory holds, and the stress
    /// at a time outside the run.
    pub fn check(&self, recording: &Recording) -> Result<(), Refusal> {
        let (duration, steps) = (self.duration, self.duration / self.time_step());
        if steps > MAX_STEPS {
            let value = format!("{duration:e}, which makes {steps:.3e} steps of {:e} s", self.time_step());
            return Err(Refusal::new("duration", value, format!("at most {MAX_STEPS:e} steps")));
        }
        if recording.every == 0 {
            return Err(Refusal::new("steps between records", 0, "at least 1"));
        }
        self.check_memory(recording)?;
        match recording.stress_times.iter().find(|time| !(0.0..=duration).contains(*time)) {
            Some(time) => {
                let allowed = format!("a time in the run, from 0 to {duration:e} (s)");
                Err(Refusal::new("stress time", time, allowed))
            }
            None => Ok(()),
        }
    }

    /// Refuses velocities whose energy f64 cannot hold, with room for the work of the contacts.
    fn check_energy(&self) -> Result<(), Refusal> {
        let energy = |bar: &Bar| 0.5 * bar.element_mass() * bar.elements as f64 * bar.velocity * bar.velocity;
        let energy: f64 = self.model.scene().bars().iter().map(energy).sum();
        let largest = f64::MAX / 256.0;
        if energy > largest {
            let place = format!("scene {}, velocity", self.model.scene().name());
            let value = format!("kinetic energy rho A L v^2/2 = {energy:e} J");
            return Err(Refusal::new(place, value, format!("at most {largest:e} J")));
        }
        Ok(())
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The penalty of closed contacts.
    pub fn penalty(&self) -> Penalty {
        self.penalty
    }

    /// The scheme.
    pub fn scheme(&self) -> &dyn Scheme {
        &*self.scheme
    }

    /// C = dt/dt_cr.
    pub fn relative_courant(&self) -> f64 {
        self.relative_courant
    }

    /// T, s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// dt, s.
    pub fn time_step(&self) -> f64 {
        self.relative_courant * self.critical_step
    }

    /// dt_cr = 2/omega_max of the contact-free scene, s.
    pub fn critical_step(&self) -> f64 {
        self.critical_step
    }

    /// Steps until the duration is reached or, if it is no multiple of dt, passed.
    pub fn steps(&self) -> u64 {
        advance::steps(self.duration, self.time_step())
    }

    /// The motion at time 0.
    ///
    /// # Errors
    /// Refuses the diagonalised mass penalty.
    pub fn prepare(&self, account: bool) -> Result<Box<dyn Motion>, Refusal> {
        let mesh = Mesh::new(self.model.scene());
        let system = System {
            pencil: &self.model.pencil(),
            penalty: self.penalty,
            load: mesh.load(),
            time_step: self.time_step(),
            critical_step: self.critical_step,
            rule: self.rule,
            account,
        };
        self.scheme.start(system, vec![0.0; mesh.nodes()], mesh.velocity())
    }

    /// Steps through the run. A run that blows up or is stopped returns what it has, and says so.
    ///
    /// # Errors
    /// As [`Run::prepare`] and [`Run::check`].
    pub fn execute(&self, recording: &Recording, progress: Option<Observer>) -> Result<History, Refusal> {
        self.check(recording)?;
        let mut motion = self.prepare(recording.energies)?;
        let mut recorder = Recorder::new(self, recording);
        let pace = Pace {
            steps: self.steps(),
            time_step: self.time_step(),
            reference_speed: self.reference_speed(motion.state()),
        };
        recorder.history.first_and_last[0] = motion.energy();
        let note = |step: u64, last: bool, motion: &mut dyn Motion| recorder.note(step, last, motion);
        let ending = advance(&mut *motion, pace, progress, note);
        let last = motion.energy();
        let mut history = recorder.history;
        history.first_and_last[1] = last;
        history.accuracy = recorder.comparison.map(Comparison::finish);
        history.switches = motion.state().switches;
        history.steps = motion.state().steps;
        history.ending = ending;
        Ok(history)
    }

    /// The largest initial speed plus the body force over the whole run, m/s.
    fn reference_speed(&self, state: &State) -> f64 {
        let initial = state.velocity.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        let gravity = self.model.scene().impact().map_or(0.0, |impact| impact.gravity.abs());
        initial + gravity * self.duration
    }
}

/// A certified critical step 2/omega_max without contacts, s, as computed: in the middle of its enclosure.
///
/// # Errors
/// A contact-free limit that is not certified.
pub(crate) fn contact_free_step(model: &Model) -> Result<f64, Refusal> {
    let refused = |e: Uncertified| {
        Refusal::new(
            format!("scene {}", model.scene().name()),
            e,
            "scenes whose contact-free limit is certified",
        )
    };
    Ok(2.0 / model.auto().enclose(&Penalty::NONE, None).map_err(refused)?.value.sqrt())
}

/// Writes rows while a run goes on.
struct Recorder<'a> {
    recording: &'a Recording,
    mesh: Mesh,
    lengths: Vec<f64>,
    /// Steps at which the stress is taken, in order.
    stress_steps: Vec<u64>,
    dt: f64,
    comparison: Option<Comparison>,
    history: History,
}

impl<'a> Recorder<'a> {
    fn new(run: &Run, recording: &'a Recording) -> Self {
        let mesh = Mesh::new(run.model.scene());
        let nearest = |time: &f64| (time / run.time_step()).round() as u64;
        let mut stress_steps: Vec<u64> = recording.stress_times.iter().map(nearest).collect();
        stress_steps.sort_unstable();
        let history = History {
            contacts: run.model.scales().len(),
            time: Vec::new(),
            force: Vec::new(),
            relative_gap: Vec::new(),
            energy: Vec::new(),
            stress: Vec::new(),
            accuracy: None,
            first_and_last: Default::default(),
            switches: 0,
            steps: 0,
            ending: Ending::Finished,
        };
        let lengths = mesh.contact_lengths(run.model.mass());
        let compared = lengths.first().filter(|_| recording.compare);
        let comparison = compared.and_then(|length| Comparison::of(run, *length));
        Self { recording, mesh, lengths, stress_steps, dt: run.time_step(), comparison, history }
    }

    fn note(&mut self, step: u64, last: bool, motion: &mut dyn Motion) {
        let time = step as f64 * self.dt;
        while self.stress_steps.get(self.history.stress.len()) == Some(&step) {
            let stress = self.mesh.stress(&motion.state().displacement);
            self.history.stress.push(StressField { time, stress });
        }
        if let Some(comparison) = &mut self.comparison {
            motion.synchronise();
            comparison.note(time, motion.state().force[0], motion.state().gap[0]);
        }
        if !step.is_multiple_of(self.recording.every) && !last {
            return;
        }
        motion.synchronise();
        let state = motion.state();
        self.history.time.push(time);
        self.history.force.extend_from_slice(&state.force);
        let relative = state.gap.iter().zip(&self.lengths).map(|(gap, h)| gap / h);
        self.history.relative_gap.extend(relative);
        if self.recording.energies {
            self.history.energy.push(motion.energy());
        }
    }
}
