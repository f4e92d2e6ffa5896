//! Is the answer right where f64 ends? Extreme inputs against references in extended precision.
//!
//! Each case computes one quantity the way every tool does, for one extreme input, and compares it with a reference that
//! was made without this crate (`tests/data/extreme_cases.py`). The allowed error is a formula in the unit roundoff. What
//! f64 cannot hold must be refused by a message that names the quantity; such a case holds when the refusal comes.

use std::process::ExitCode;

use analyses::cli::{
    Analysis, Frame, Intent, Output, OutputOptions, Progress, Verdict, narrate, print_table,
};
use analyses::error::{Refusal, Result};
use clap::Parser;
use precision::{Case, Checked, References, cases, distinct};
use rayon::prelude::*;

/// Extreme inputs against extended precision; exit status 1 if a case does not hold.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    /// Cases whose names contain one of these words [default: all]
    #[arg(value_name = "WORD")]
    words: Vec<String>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  extreme-cases                       all cases, into figures/extreme-cases/
  extreme-cases beta-s ratio          the extreme penalties only
  extreme-cases --stdout csv --quiet  records on standard output";

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "extreme-cases";
    type Plan = Vec<Case>;
    type Found = Vec<Checked>;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Vec<Case>> {
        choose(&self.words)
    }

    fn explain(&self, cases: &Vec<Case>) -> Result<Vec<Intent>> {
        let cases = format!("{} cases against tests/data/extreme_cases.csv; left out: figures", cases.len());
        Ok(vec![Intent::of_all(cases)])
    }

    fn frames(&self, _cases: &Vec<Case>) -> Vec<Frame> {
        Vec::new()
    }

    fn compute(&self, cases: Vec<Case>, output: &Output) -> Result<(Self::Found, usize)> {
        let references = References::built_in();
        let progress = Progress::new(cases.len(), "cases", self.output.quiet);
        let check = |case: &Case| {
            let reference = references.of(case).map_err(|missing| {
                Refusal::new(&case.name, missing, "cases with a reference in the table that was built in")
            })?;
            let checked = case.check(&reference);
            progress.add(1);
            Ok(checked)
        };
        let checked: Vec<Checked> = cases.par_iter().map(check).collect::<Result<_>>()?;
        let files = output.write_rows(Self::NAME, &checked)?.len();
        Ok((checked, files))
    }

    fn print(&self, checked: &Vec<Checked>, output: &Output) -> Result<()> {
        output.print(checked)
    }

    fn summarise(&self, checked: &Vec<Checked>) {
        summarise(checked);
    }

    fn verdict(&self, checked: &Vec<Checked>) -> Verdict {
        if checked.iter().all(|case| case.holds) { Verdict::Holds } else { Verdict::Fails }
    }
}

/// The cases whose names contain one of `words`; all without words.
fn choose(words: &[String]) -> Result<Vec<Case>> {
    let asked = |case: &Case| words.is_empty() || words.iter().any(|word| case.name.contains(word.as_str()));
    let chosen: Vec<Case> = cases().into_iter().filter(asked).collect();
    if chosen.is_empty() {
        let mut names: Vec<String> = cases().into_iter().map(|case| case.name).collect();
        names.dedup();
        return Err(Refusal::new("WORD", words.join(" "), format!("parts of {}", names.join(", "))).into());
    }
    Ok(chosen)
}

/// One line a quantity and what computes it, one line a case that does not hold.
fn summarise(checked: &[Checked]) {
    let kinds = distinct(checked.iter().map(|case| case.quantity.as_str()));
    let header = ["quantity", "cases", "hold", "largest relative error", "largest error/allowed", "allowed"];
    let line = |kind: &&str| {
        let of_kind: Vec<&Checked> = checked.iter().filter(|case| case.quantity == **kind).collect();
        let hold = of_kind.iter().filter(|case| case.holds).count();
        let errors = of_kind.iter().filter_map(|case| case.relative_error);
        let shares = of_kind.iter().filter_map(|case| Some(case.relative_error? / case.allowed?));
        let largest = |numbers: Vec<f64>| match numbers.is_empty() {
            true => "-".to_owned(),
            false => format!("{:.1e}", numbers.into_iter().fold(0.0, f64::max)),
        };
        vec![
            kind.to_string(),
            of_kind.len().to_string(),
            if hold == of_kind.len() { "all".to_owned() } else { format!("{hold}, NOT ALL") },
            largest(errors.collect()),
            largest(shares.collect()),
            of_kind.first().map_or_else(String::new, |case| case.formula.to_owned()),
        ]
    };
    print_table(&header, kinds.iter().map(line));
    for case in checked.iter().filter(|case| !case.holds) {
        analyses::tell!(
            "does not hold: {}, {}: {:?} instead of {:?}",
            case.case,
            case.quantity,
            case.computed,
            case.reference
        );
    }
}
