//! Which time step is stable in explicit contact dynamics, and what does the contact penalty do to it?

pub mod error;
pub mod fem;
pub mod impact;
pub mod pencil;
pub mod penalty;
pub mod scene;
pub mod schemes;
pub mod spectrum;
pub mod stability;
pub mod verify;
