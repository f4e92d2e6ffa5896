//! How right, and at what cost: [`extreme`] inputs against extended precision, and error against run time.
//!
//! Error against run time keeps four things apart: the problem ([`Eigenproblem`], [`Impactproblem`]), the [`Clock`], the
//! [`Measurement`] and the summary ([`mark_front`]). An error comes from one run, a time from others with nothing
//! recorded. Drawing and writing are elsewhere.
//!
//! # Rooms
//! ```text
//! extreme                        cases, spectra, limits, stepping, refusals, each against a reference
//! eigenproblem, impactproblem    what is measured, with its exact answer
//! methods, estimates             engines, and what codes use instead
//! clock, measuring               times of runs, forecasts of those that take too long
//! measurement, table             what was measured, its front, a summary
//! ```

mod clock;
mod eigenproblem;
mod estimates;
pub mod extreme;
mod impactproblem;
mod measurement;
mod measuring;
mod methods;
mod table;

pub use clock::{Clock, Forecast, median, seconds};
pub use eigenproblem::{EIGENPROBLEMS, Eigenproblem, ExactEigenvalue, ExactEigenvalues, SIZES};
pub use impactproblem::{ImpactErrors, Impactproblem, SCENES};
pub use measurement::{Family, Measurement, Status, mark_front};
pub use measuring::{measure_eigenvalues, measure_impacts};
pub use methods::Method;
pub use table::{distinct, markdown};

pub use extreme::{Answer, Case, Checked, Found, References, Unreadable, cases};
