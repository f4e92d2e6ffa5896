//! The extended precision of the library, with which the tests judge what f64 cannot.

pub use bipenalty::double_double::Dd;
