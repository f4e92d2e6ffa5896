//! The schemes beside each other: what they gain and lose, on bars and on meshes with many contacts.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "impacts/comparison.rs"]
mod comparison;
#[path = "common/conformance/mod.rs"]
#[macro_use]
mod conformance;
#[path = "impacts/gains.rs"]
mod gains;
#[path = "impacts/meshes.rs"]
mod meshes;
#[path = "impacts/random.rs"]
mod random;
#[path = "impacts/redistribution.rs"]
mod redistribution;
#[path = "impacts/statics.rs"]
mod statics;
