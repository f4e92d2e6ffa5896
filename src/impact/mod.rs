//! Contact-impact runs: a scene stepped in time, its history, energies and summary, and exact solutions to compare with.

mod exact;
mod history;
mod mesh;
mod run;
mod summary;

pub use exact::Exact;
pub use history::{Ending, History, Recording, StressField};
pub use mesh::Mesh;
pub(crate) use run::contact_free_step;
pub use run::{MAX_STEPS, Progress, Run};
pub use summary::Summary;
pub(crate) use summary::potential_at_start;
