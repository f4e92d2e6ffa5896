//! Extreme inputs against extended precision: every case holds, the checks can fail, and the references are what their
//! generator makes.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::Command;

use precision::{Answer, Case, Checked, References, cases};
use rayon::prelude::*;

fn checked(alter: impl Fn(&Checked) -> Answer + Sync) -> Vec<(Checked, Checked)> {
    let references = References::built_in();
    let both = |case: &Case| {
        let plain = case.check(&references.of(case).unwrap());
        let altered = case.check(&alter(&plain));
        (plain, altered)
    };
    cases().par_iter().map(both).collect()
}

/// A reference off by twice the allowed error, and a refusal that should name another quantity.
fn perturbed(checked: &Checked) -> Answer {
    match &checked.reference {
        Answer::Value(0.0) => Answer::Value(f64::MIN_POSITIVE),
        Answer::Value(exact) => Answer::Value(exact * (1.0 + 2.5 * checked.allowed.unwrap_or(0.0))),
        Answer::Refused(quantity) => Answer::Refused(format!("{quantity} of another kind")),
    }
}

#[test]
fn every_case_holds_and_none_holds_against_a_perturbed_reference() {
    let all = checked(perturbed);
    assert!(all.len() > 500, "{} cases", all.len());
    let failing: Vec<_> = all.iter().map(|(plain, _)| plain).filter(|case| !case.holds).collect();
    assert!(failing.is_empty(), "{failing:#?}");
    let blind: Vec<_> = all.iter().map(|(_, altered)| altered).filter(|case| case.holds).collect();
    assert!(blind.is_empty(), "hold against a wrong reference: {blind:#?}");
}

#[test]
fn every_reference_is_used_and_every_name_is_unique() {
    let (cases, references) = (cases(), References::built_in());
    for row in references.rows() {
        let used = cases.iter().any(|case| case.name == row[0] && case.quantity == row[1]);
        assert!(used, "no case for {row:?}");
    }
    let mut keys: Vec<_> = cases.iter().map(|case| (&case.name, case.quantity, case.by)).collect();
    keys.sort_unstable();
    let count = keys.len();
    keys.dedup();
    assert_eq!(keys.len(), count);
}

/// A few references made anew by Python with mpmath, where it is installed.
#[test]
fn a_sample_of_the_references_is_what_the_generator_makes() {
    let sample = [
        "beta-s-1e300-r-inf",
        "elements-1000000-fixed-r-1",
        "massless-contact-node-r-2",
        "stiffest-contact-predictor-corrector-gamma-0",
        "step-1.000000001-central-difference-gamma-1",
    ];
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/extreme_cases.py");
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has_mpmath = Command::new(&python).args(["-c", "import mpmath"]).output();
    if !has_mpmath.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: {python} with mpmath is not here, so no reference was made anew");
        return;
    }
    let output = Command::new(&python).arg(script).args(sample).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let (made, kept) = (References::read(&text), References::built_in());
    assert!(made.rows().len() >= sample.len());
    for row in made.rows() {
        let [_, _, _, value] = kept.rows().iter().find(|kept| kept[..3] == row[..3]).unwrap();
        // Versions of mpmath may differ in the last of the 30 digits.
        assert_eq!(value[..20.min(value.len())], row[3][..20.min(row[3].len())], "{row:?}");
    }
}
