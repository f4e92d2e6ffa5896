//! Arguments -> plan -> run -> write: what the command line tools share.
//!
//! Records go to files or standard output, everything else to standard error. Exit status 0: done, and what was
//! checked holds; 1: done, and a check did not hold; 2: refused, nothing computed or written.

mod answers;
mod arguments;
mod fields;
mod forces;
mod frames;
mod impact_files;
mod impacts;
mod intents;
mod limit;
mod maps;
mod names;
mod narration;
mod opening;
mod options;
mod output;
mod passages;
mod peers;
mod plan;
mod progress;
mod redraw;
mod samples;
mod steps;
mod style;
mod summary;
mod verification;

pub use answers::{governing_answer, point_answers};
pub use arguments::arguments;
pub use fields::{check_fields, check_instants, draw_fields};
pub use forces::{ForceOptions, ForcePlan};
pub use frames::Frame;
pub use impact_files::{draw_impacts, draw_passages, write_impacts};
pub use impacts::{
    FinishedRun, PlannedRun, check_memory, exact_energy, exact_force, exact_stress, execute, suffix,
};
pub use intents::{Intent, redrawn};
pub use limit::{Limit, LimitOptions};
pub use maps::{Chart, Job, Solved, check_touches, checked_grid, paper, require_memory};
pub use names::{axis_word, check_stems, question};
pub use narration::{Analysis, narrate};
pub use opening::{Contact, OpeningOptions, OpeningPlan, OpeningResult};
pub use options::{
    Format, OutputOptions, RatioSpec, SceneOptions, StandardOutput, Units, WidthOption, penalties_of,
};
pub use output::{Output, print_line};
pub use passages::{FinishedPassage, Kept, PlannedPassage, StepOptions, check_passages, execute_passages};
pub use peers::{PeerRows, Peers, machine, restarted_with_one_blas_thread};
use plan::seconds_of;
pub use plan::{explain, step_and_cost};
pub use progress::Progress;
pub use redraw::{Redrawn, redraw_costs, redraw_optimal_ratio, redraw_stability};
pub use samples::Samples;
pub use steps::{HeldStep, hold_step};
pub use style::{ColourMapOption, Limits, StyleOptions, TextOption};
pub use summary::{
    FEW_POINTS, MapSummary, print_costs, print_impacts, print_summaries, print_table, tabulate_ratios,
};
pub use verification::{print_reasons, print_verification};

use std::process::ExitCode;

use crate::error::{Error, Result};

/// Whether what a run checked holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Every check holds.
    Holds,
    /// A check does not hold; its row says which.
    Fails,
}

/// Turns the outcome of a tool into its exit status, with one message on standard error.
pub fn finish(outcome: Result<Verdict>) -> ExitCode {
    match outcome {
        Ok(Verdict::Holds) => ExitCode::SUCCESS,
        Ok(Verdict::Fails) => ExitCode::from(1),
        // A reader that stops early, such as `head`, is not an error.
        Err(Error::File { source, .. }) if source.kind() == std::io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(error) => {
            crate::tell!("error: {}", options::by_option(error));
            ExitCode::from(2)
        }
    }
}
