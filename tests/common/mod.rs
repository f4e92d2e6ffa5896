//! What several test files share: extended precision, random scenes, and the exact inertia of a pencil.

// Each test file uses its own part of this module.
#![allow(dead_code)]

pub mod double_double;
pub mod exact;
pub mod numbers;
pub mod scenes;

use proptest::test_runner::{Config, RngSeed};

/// `cases` cases of a fixed seed, so that a run can be repeated; PROPTEST_CASES and PROPTEST_RNG_SEED widen the search.
pub fn config(cases: u32) -> Config {
    let default = Config::default();
    let seed = match default.rng_seed {
        RngSeed::Random => RngSeed::Fixed(189),
        fixed => fixed,
    };
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { default.cases } else { cases };
    Config { cases, rng_seed: seed, failure_persistence: None, ..default }
}
