//! Stepping through a run, whatever is in it.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Ending;
use crate::interrupt;
use crate::schemes::Motion;

/// The stop flag is looked at, and progress told, every so many steps.
const STEPS_BETWEEN_CHECKS: u64 = 4096;

/// The velocities are looked at every so many steps.
const STEPS_BETWEEN_LOOKS: u64 = 64;

/// A velocity above the reference speed by this factor counts as blown up.
const BLOW_UP: f64 = 1e6;

/// Who wants to know how far a run is, and may stop it.
pub struct Observer<'a> {
    /// Set from elsewhere to stop the run; what is finished is kept.
    pub stop: &'a AtomicBool,
    /// Called now and then with the steps done and the steps to do.
    pub report: &'a mut dyn FnMut(u64, u64),
}

/// How far and how fast.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    pub steps: u64,
    /// dt, s.
    pub time_step: f64,
    /// The largest initial speed, plus what the body force adds over the run, m/s; 0 if there is neither.
    pub reference_speed: f64,
}

/// Steps of a run over `duration`: until it is reached or, if it is no multiple of dt, passed. The quotient carries the
/// rounding of dt, which must not add a step.
pub(super) fn steps(duration: f64, time_step: f64) -> u64 {
    (duration / time_step * (1.0 - 8.0 * f64::EPSILON)).ceil().max(1.0) as u64
}

/// Steps through a run; `note` sees every state with its step and whether it is the last.
pub(super) fn advance(
    motion: &mut dyn Motion,
    pace: Pace,
    mut progress: Option<Observer>,
    mut note: impl FnMut(u64, bool, &mut dyn Motion),
) -> Ending {
    let Pace { steps, time_step, reference_speed } = pace;
    let bound = BLOW_UP * if reference_speed > 0.0 { reference_speed } else { f64::MAX / BLOW_UP };
    for step in 0..=steps {
        let time = step as f64 * time_step;
        if step % STEPS_BETWEEN_LOOKS == 0 {
            interrupt::look();
            if !within(&motion.state().velocity, bound) {
                return Ending::BlewUp { step, time };
            }
        }
        if let Some(Observer { stop, report }) = &mut progress
            && step % STEPS_BETWEEN_CHECKS == 0
        {
            report(step, steps);
            if stop.load(Ordering::Relaxed) {
                return Ending::Stopped { step, time };
            }
        }
        note(step, step == steps, motion);
        if step < steps {
            motion.step();
        }
    }
    if within(&motion.state().velocity, bound) {
        Ending::Finished
    } else {
        Ending::BlewUp { step: steps, time: steps as f64 * time_step }
    }
}

fn within(velocity: &[f64], bound: f64) -> bool {
    velocity.iter().all(|v| v.abs() <= bound)
}
