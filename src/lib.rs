//! Which time step is stable in explicit contact dynamics, and what does the contact penalty do to it?

#[cfg(feature = "cli")]
pub mod cli;
pub mod error;
pub mod fem;
pub mod penalty;
pub mod pencil;
#[cfg(feature = "plot")]
pub mod plot;
pub mod record;
pub mod scene;
pub mod spectrum;
pub mod stability;
