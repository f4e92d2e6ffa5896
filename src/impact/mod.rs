//! Contact-impact runs: a scene stepped in time, its history, energies and summary, and exact solutions to compare with.
//!
//! ```
//! use bipenalty::impact::Exact;
//! use bipenalty::scene::load;
//! // The bar of Sec. 5.1 of the paper: 0.1 N while the wave runs to the free end and back.
//! let exact = Exact::of(&load("signorini")?, 0.3).expect("one contact");
//! assert!((exact.force(0.1) - 0.1).abs() < 1e-15 && exact.force(0.25) == 0.0);
//! # Ok::<(), bipenalty::error::Error>(())
//! ```

mod advance;
mod comparison;
mod encounter;
mod exact;
mod history;
mod mesh;
mod needs;
mod passage;
mod record;
mod run;
mod summary;
mod throw;

pub use advance::Observer;
pub use comparison::{Accuracy, Comparison};
pub use encounter::Encounter;
pub use exact::Exact;
pub use history::{Ending, History, Recording, StressField};
pub use mesh::Mesh;
pub use needs::least_every;
pub use passage::Passage;
pub use record::{Kept, Outcome, Record};
pub(crate) use run::contact_free_step;
pub use run::{MAX_STEPS, Run};
pub use summary::Summary;
pub(crate) use summary::potential_at_start;
pub use throw::{duration, exact};
