//! The names of files: by the question that they answer, so that no run writes over the answer to another one.

use std::collections::HashSet;

use super::OutputOptions;
use super::summary::short;
use crate::error::{Refusal, Result};
use bipenalty::stability::Sweep;

/// What the names of files say of the options that were given beside scene and mass, so that no run writes over the answer
/// to another question: `-word` of each, in the order of `given`.
pub fn question(given: impl IntoIterator<Item = Option<String>>) -> String {
    given.into_iter().flatten().map(|word| format!("-{word}")).collect()
}

/// `name` with the values of an axis: all of them if they are few, else its ends and their number, and for a list of no
/// regular steps a number that is hardly that of another list.
pub fn axis_word(name: &str, axis: &Sweep) -> String {
    const LONGEST: usize = 40;
    let values = &axis.values;
    // More values than that are longer in any case.
    let listed = values.iter().take(LONGEST).map(|value| short(*value)).collect::<Vec<_>>().join("-");
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return name.to_owned() };
    if listed.len() <= LONGEST {
        return format!("{name}{listed}");
    }
    let (ends, count) = (format!("{}-{}", short(*first), short(*last)), values.len());
    let is = |made: Result<Sweep, Refusal>| made.is_ok_and(|made| made.values == *values);
    if is(Sweep::linear(*first, *last, count)) {
        return format!("{name}lin-{ends}-{count}");
    }
    if is(Sweep::log(*first, *last, count)) {
        return format!("{name}log-{ends}-{count}");
    }
    // FNV-1a of the bits.
    let mix = |hash: u64, value: &f64| (hash ^ value.to_bits()).wrapping_mul(0x0100_0000_01b3);
    let hash = values.iter().fold(0xcbf2_9ce4_8422_2325, mix);
    format!("{name}list-{ends}-{count}-{hash:016x}")
}

/// Refuses two parts of a run that would write the same files; the records of both may well be printed.
///
/// # Errors
/// Names the first name of a file that comes twice.
pub fn check_stems(options: &OutputOptions, stems: impl Iterator<Item = String>) -> Result<(), Refusal> {
    let mut known = HashSet::new();
    let mut stems = stems.filter(|_| options.stdout.is_none());
    match stems.find(|stem| !known.insert(stem.clone())) {
        None => Ok(()),
        Some(stem) => Err(Refusal::new(
            "SCENE, --mass or a list",
            format!("a second run that writes {stem}"),
            "scenes of different names and lists without repetition, or --stdout",
        )),
    }
}
