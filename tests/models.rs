//! The one face of models of any kind: scenes told apart, refusals, and bars as the conformance test of the convex curve.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "models/bars.rs"]
mod bars;
#[path = "models/chance.rs"]
mod chance;
#[path = "models/governing.rs"]
mod governing;
#[path = "models/largest.rs"]
mod largest;
#[path = "common/numbers.rs"]
mod numbers;
#[path = "models/orthogonality.rs"]
mod orthogonality;
#[path = "models/patches.rs"]
mod patches;
#[path = "models/reference.rs"]
mod reference;
#[path = "models/refusals.rs"]
mod refusals;
#[path = "models/scenes.rs"]
mod scenes;
#[path = "models/stepping.rs"]
mod stepping;
#[path = "models/transformed.rs"]
mod transformed;
