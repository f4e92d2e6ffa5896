//! What a scheme costs over the penalty: the time that one evaluation of the internal force buys.

use crate::pencil::Penalty;
use crate::spectrum::{Step, StepLimit, Uncertified};

/// The limit of one scheme over the stiffness penalty.
#[derive(Debug, Clone, PartialEq)]
pub struct CostCurve {
    /// The name of the scheme.
    pub scheme: String,
    /// Internal forces evaluated in a step.
    pub evaluations: usize,
    /// One entry a penalty, in their order.
    pub points: Vec<Cost>,
}

/// A point of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// The penalty of the closed contacts.
    pub penalty: Penalty,
    /// The largest stable step.
    pub step: Result<Step, Uncertified>,
    /// Internal forces that one step evaluates.
    pub evaluations: usize,
}

impl Cost {
    /// A time, s, that one evaluation of the internal force buys at the limit: dt/evaluations, from the lower end of the
    /// enclosure.
    pub fn time_per_evaluation(&self) -> Option<f64> {
        self.step.ok().map(|step| step.lower() / self.evaluations as f64)
    }

    /// The fewest evaluations for a second of motion.
    pub fn evaluations_per_second(&self) -> Option<f64> {
        self.time_per_evaluation().map(f64::recip)
    }
}

impl CostCurve {
    /// The curve of a scheme of so many `evaluations` a step, whose limit is `limit`, over `penalties`.
    pub fn new(scheme: &str, evaluations: usize, limit: &dyn StepLimit, penalties: &[Penalty]) -> Self {
        let mut near = None;
        let point = |penalty: &Penalty| {
            let step = limit.enclose(penalty, near);
            near = step.ok().map(|step| step.l.value);
            Cost { penalty: *penalty, step, evaluations }
        };
        Self { scheme: scheme.to_owned(), evaluations, points: penalties.iter().map(point).collect() }
    }
}
