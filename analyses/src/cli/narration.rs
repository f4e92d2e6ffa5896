//! The narration that the tools share: plan, then explain or compute, write, print, summarise.

use std::process::ExitCode;

use clap::Parser;

use super::intents::{Intent, told};
use super::output::start_threads;
use super::{Frame, Output, OutputOptions, Verdict, arguments, finish};
use crate::error::Result;

/// A tool: what it plans, computes and says.
pub trait Analysis: Parser {
    /// The name of the tool and of its folder of figures.
    const NAME: &'static str;
    /// What will be computed, checked.
    type Plan;
    /// What was found, with all that is printed of it.
    type Found;

    /// Where the results go.
    fn output(&self) -> &OutputOptions;

    /// The folder below that of the tool for files of another question than the usual one; empty for the usual one.
    fn folder(&self) -> String {
        String::new()
    }

    /// What will be computed.
    ///
    /// # Errors
    /// Everything that can be refused before anything is computed or written.
    fn plan(&self) -> Result<Self::Plan>;

    /// What `--explain` says.
    ///
    /// # Errors
    /// What describing the plan refuses.
    fn explain(&self, plan: &Self::Plan) -> Result<Vec<Intent>>;

    /// The figures to come, as far as the plan tells: what of a style does not suit them is refused.
    fn frames(&self, plan: &Self::Plan) -> Vec<Frame>;

    /// Computes, writes the rows and then draws them; the number of files.
    ///
    /// # Errors
    /// What computing refuses, and what the system says of the files.
    fn compute(&self, plan: Self::Plan, output: &Output) -> Result<(Self::Found, usize)>;

    /// Prints the rows on standard output where they are asked for there.
    ///
    /// # Errors
    /// A closed pipe.
    fn print(&self, found: &Self::Found, output: &Output) -> Result<()>;

    /// The summary on standard error.
    fn summarise(&self, found: &Self::Found);

    /// Whether what was checked holds.
    fn verdict(&self, found: &Self::Found) -> Verdict;
}

/// Runs a tool with the options that the user typed.
pub fn narrate<A: Analysis>() -> ExitCode {
    finish(run(&arguments::<A>()))
}

fn run<A: Analysis>(analysis: &A) -> Result<Verdict> {
    start_threads(analysis.output())?;
    let plan = analysis.plan()?;
    let output = Output::prepare(analysis.output(), A::NAME, &analysis.folder())?;
    output.check_style(&analysis.frames(&plan))?;
    if analysis.output().explain {
        Output::print_text(&told(&analysis.explain(&plan)?))?;
        return Ok(Verdict::Holds);
    }
    let (found, files) = analysis.compute(plan, &output)?;
    analysis.print(&found, &output)?;
    if !analysis.output().quiet {
        analysis.summarise(&found);
        output.report(files);
    }
    output.check_drawn()?;
    Ok(if output.check_redrawn() { analysis.verdict(&found) } else { Verdict::Fails })
}
