//! Matrices of other codes: K, M, gaps and scales from files, checked entry by entry.
//!
//! Matrix Market and the text matrices of Abaqus are read by a parser of our own: the readers at hand (nalgebra-sparse
//! 0.12, sprs 0.11) name neither line nor value of what they refuse, and none reads Abaqus.

mod check;
mod reader;
mod scene;

pub use reader::{Entries, Form, parse, read};
pub use scene::{Matrices, MatrixImpact, MatrixScene, Reference, Throw};
