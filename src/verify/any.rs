//! Limits found by stepping for models of any kind, in seconds.

use super::lattice::Lattice;
use super::trial::{Stepped, Trials};
use super::{Limit, Point, Search};
use crate::error::Result;
use crate::schemes::Scheme;
use crate::stability::{AnyModel, Asking};

/// A limit between two steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seconds {
    /// The step below the limit, whose trial did not grow, s; 0 if no step was found that is stable.
    pub stable_at: f64,
    /// Its neighbour, whose trial did, s.
    pub unstable_at: f64,
    /// The same in Courant numbers: c0 dt/h of bars, omega_ref dt/2 of matrices and meshes.
    pub courant: Limit,
}

/// The largest stable step of `scheme` with the contacts of `model` held closed, by stepping alone; the search begins at
/// the contact-free step, which the Park scheme has as a parameter. The time goes with n times the steps of a trial.
///
/// # Errors
/// A step that is not positive, what [`Scheme::start`] and [`Search::to`] refuse, penalties that f64 cannot hold, a
/// contact-free limit that is not enclosed, and a model that no step makes unstable.
pub fn limit_of_any(model: &AnyModel, scheme: &dyn Scheme, point: Point, search: &Search) -> Result<Seconds> {
    let penalty = model.penalty(point.stiffness_penalty, point.ratio)?;
    let (stepped, first) = match model {
        AnyModel::Bars(bars) => {
            bars.check(point.stiffness_penalty, point.ratio)?;
            (Stepped::bars(bars, &penalty)?, 1.0)
        }
        AnyModel::Mesh(mesh) => {
            let free = model.contact_free(&Asking::default())?.step?;
            let unit = model.time_step(1.0)?;
            let critical_step = unit * free.lower;
            let slowest = f64::INFINITY;
            (Stepped { pencil: mesh.stepping_pencil()?, critical_step, unit, slowest }, free.lower)
        }
    };
    let unit = stepped.unit;
    let courant = Lattice::new(&Trials::new(stepped, scheme, penalty, search)?).limit(first)?;
    Ok(Seconds { stable_at: courant.stable_at * unit, unstable_at: courant.unstable_at * unit, courant })
}
