//! The limit of damped central differences by any engine of the spectrum.

use super::search::Search;
use super::{Damping, Unheld};
use crate::pencil::{Penalty, Pencil};
use crate::spectrum::{Engine, Step, StepLimit, Uncertified};

/// The largest stable step of central differences with damping that lags half a step; the theory is that of
/// [the module](super).
pub struct DampedLimit<'a> {
    spectrum: Box<dyn Engine + 'a>,
    damping: Damping,
    unheld: Unheld,
}

impl<'a> DampedLimit<'a> {
    /// The limit for `pencil`, of which `spectrum` is an engine.
    pub fn new(pencil: &Pencil, spectrum: Box<dyn Engine + 'a>, damping: Damping) -> Self {
        Self { spectrum, damping, unheld: Unheld::of(pencil.gaps(), pencil.size()) }
    }

    /// C.
    pub fn damping(&self) -> Damping {
        self.damping
    }
}

impl StepLimit for DampedLimit<'_> {
    fn name(&self) -> &'static str {
        self.spectrum.name()
    }

    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Step, Uncertified> {
        self.enclose_by(penalty, start).0
    }

    /// The limit lies in the enclosure. It is wider than those of the engine by what the search leaves, at most twice: by the
    /// slope rho > 1 of the [theory](super) the width of l = y*^2 is at most 2/rho times that of l_max.
    fn enclose_by(&self, penalty: &Penalty, start: Option<f64>) -> (Result<Step, Uncertified>, &'static str) {
        let (undamped, mut by) = self.spectrum.enclose_by(penalty, start);
        let undamped = match undamped {
            Ok(found) if !self.damping.is_none() => found,
            other => return (other.map(Step::proven), by),
        };
        let mut search = Search::new(self.damping, undamped.value, self.unheld.under(penalty.form));
        let mut near = undamped.value;
        while let Some(problem) = search.ask() {
            let (found, name) = self.spectrum.enclose_by(&problem.penalty(penalty), Some(near));
            by = name;
            match found {
                Ok(found) => {
                    near = found.value;
                    search.tell(found);
                }
                Err(uncertified) => return (Err(uncertified), by),
            }
        }
        let lost = Uncertified { value: f64::NAN, width: f64::INFINITY };
        (search.step().ok_or(lost), by)
    }
}
