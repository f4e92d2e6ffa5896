//! The ends of what f64 can do: a named list of extreme inputs, each held against a reference in extended precision.
//!
//! A case computes one quantity the way every tool does and compares it with a reference that was made without this
//! crate (`tests/data/extreme_cases.py`). The error allowed is a formula in the unit roundoff u = 2^-53. Inputs that f64
//! cannot hold must be refused, with the quantity that leaves its range by name: such a case holds when the refusal comes.

mod case;
mod limits;
mod references;
mod refusals;
mod spectra;
mod stepping;

pub use case::{Answer, Case, Checked, Found};
pub use references::{References, Unreadable};

/// Every extreme case, in a fixed order.
pub fn cases() -> Vec<Case> {
    let lists = [spectra::cases(), stepping::cases(), limits::cases(), refusals::cases()];
    lists.into_iter().flatten().collect()
}

/// A number as short as it can be written, as the names of cases have it.
fn short(x: f64) -> String {
    let (plain, power) = (format!("{x}"), format!("{x:e}"));
    if plain.len() <= power.len() { plain } else { power }
}
