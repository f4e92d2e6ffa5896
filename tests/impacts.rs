//! The schemes beside each other: what they gain and lose, on bars and on meshes with many contacts.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "impacts/gains.rs"]
mod gains;
#[path = "impacts/random.rs"]
mod random;
