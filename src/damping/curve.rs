//! The limit of damped central differences for any mesh, by the one convex function of its map.

use std::sync::{Mutex, PoisonError};

use super::search::Search;
use super::{Damping, Unheld};
use crate::convex::{Asked, Curve, Enclosed, MeshPencil, TooWide};
use crate::pencil::{Penalty, PenaltyMass};
use crate::spectrum::{Enclosure, Evidence, Step, StepLimit, Uncertified};

/// The map of damped steps of one mesh.
#[derive(Debug)]
pub struct DampedCurve {
    curve: Curve,
    damping: Damping,
    unheld: bool,
}

impl DampedCurve {
    /// For the `curve` of `pencil`.
    pub fn new(pencil: &MeshPencil, curve: Curve, damping: Damping) -> Self {
        let unheld = Unheld::of(pencil.contacts(), pencil.size()).under(PenaltyMass::Consistent);
        Self { curve, damping, unheld }
    }

    /// The curve, with all that is known of it by now.
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// The limits of all points asked for, with l = 4/dt^2; the points are searched together, so that they share what is
    /// proven about the curve. Each step is enclosed to at most twice the tolerance of the curve.
    ///
    /// # Errors
    /// Of a point: the curve could not be enclosed there as closely as its tolerance asks for; the enclosure of the error holds.
    pub fn enclose(&mut self, asked: &[Asked]) -> Vec<Result<Step, TooWide>> {
        search(self.damping, self.unheld, asked, |problems| self.curve.enclose(problems))
    }
}

/// The limits of all points asked for on the `curve` of `pencil`, each curve point to a step as narrow as `width`, relative;
/// as [`DampedCurve::enclose`] otherwise.
pub fn enclose_damped(
    (pencil, curve): (&MeshPencil, &mut Curve),
    damping: Damping,
    asked: &[Asked],
    width: f64,
) -> Vec<Result<Step, TooWide>> {
    let unheld = Unheld::of(pencil.contacts(), pencil.size()).under(PenaltyMass::Consistent);
    search(damping, unheld, asked, |problems| curve.enclose_to(problems, width))
}

/// All limits together, by what `enclose` finds for undamped problems.
fn search(
    damping: Damping,
    unheld: bool,
    asked: &[Asked],
    mut enclose: impl FnMut(&[Asked]) -> Vec<Result<Enclosed, TooWide>>,
) -> Vec<Result<Step, TooWide>> {
    let mut known = enclose(asked);
    let as_enclosure = |l: Enclosed| Enclosure {
        value: (l.lower.max(f64::MIN_POSITIVE) * l.upper).sqrt().max(l.lower).min(l.upper),
        lower: l.lower,
        upper: l.upper,
    };
    if damping.is_none() {
        return known.into_iter().map(|found| found.map(|l| Step::proven(as_enclosure(l)))).collect();
    }
    let begin =
        |found: &Result<Enclosed, TooWide>| Search::new(damping, as_enclosure(held(found)).value, unheld);
    let mut searches: Vec<Search> = known.iter().map(begin).collect();
    loop {
        let open: Vec<usize> = (0..searches.len()).filter(|i| searches[*i].ask().is_some()).collect();
        let problem = |i: &usize| {
            let (point, undamped) = (asked[*i], searches[*i].ask()?);
            let (stiffness, mass) = (point.stiffness * undamped.stiffness, point.mass * undamped.mass);
            Some(Asked { stiffness, mass })
        };
        let problems: Vec<Asked> = open.iter().filter_map(problem).collect();
        if problems.is_empty() {
            break;
        }
        for (i, found) in open.into_iter().zip(enclose(&problems)) {
            searches[i].tell(as_enclosure(held(&found)));
            known[i] = found;
        }
    }
    searches.iter().zip(known).map(|(search, last)| result(search, last)).collect()
}

/// What is proven, as narrow as asked for or not.
fn held(found: &Result<Enclosed, TooWide>) -> Enclosed {
    match found {
        Ok(enclosed) | Err(TooWide { enclosed, .. }) => *enclosed,
    }
}

/// The limit that a search has found, from a last enclosure that was as narrow as asked for or not.
fn result(search: &Search, last: Result<Enclosed, TooWide>) -> Result<Step, TooWide> {
    let unknown = Enclosed { lower: 0.0, upper: f64::INFINITY };
    match (search.step(), last) {
        (Some(step), Ok(_)) => Ok(step),
        (Some(step), Err(wide)) => {
            let lower = if step.evidence == Evidence::Proven { step.l.lower } else { 0.0 };
            Err(TooWide { enclosed: Enclosed { lower, upper: step.l.upper }, ..wide })
        }
        (None, Err(wide)) => Err(TooWide { enclosed: unknown, ..wide }),
        (None, Ok(_)) => Err(TooWide { enclosed: unknown, tolerance: 0.0 }),
    }
}

/// The same limit point by point, for what takes any limit.
#[derive(Debug)]
pub struct DampedMesh(Mutex<DampedCurve>);

impl DampedMesh {
    /// Of a map.
    pub fn new(curve: DampedCurve) -> Self {
        Self(Mutex::new(curve))
    }
}

impl StepLimit for DampedMesh {
    fn name(&self) -> &'static str {
        "curve"
    }

    fn enclose(&self, penalty: &Penalty, _start: Option<f64>) -> Result<Step, Uncertified> {
        if penalty.form == PenaltyMass::Diagonalised {
            return Err(Uncertified { value: f64::NAN, width: f64::INFINITY });
        }
        let asked = Asked { stiffness: penalty.stiffness, mass: penalty.stiffness / penalty.rate };
        // A panic elsewhere leaves the curve with what was proven before.
        let mut curve = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = curve.enclose(&[asked]).pop();
        let lost = Uncertified { value: f64::NAN, width: f64::INFINITY };
        found.ok_or(lost)?.map_err(|TooWide { enclosed: Enclosed { lower, upper }, .. }| {
            let value = (lower * upper).sqrt();
            Uncertified { value, width: (upper - lower) / value }
        })
    }
}
