//! What the tools share: the command line, the records, the charts.
//!
//! A tool, `analyses/TOOL.rs`, reads like the method section of a paper: options, plan, what is computed, what is said.
//!
//! # Rooms
//! ```text
//! cli     narration: plan -> explain | compute, write, draw -> print, summary, exit status; one driver for the tools
//!         options, arguments: what is typed; output: files and standard output; progress, summary, redraw
//! record  rows -> CSV, JSON; the record of a figure; where rows come from; rows read back
//! charts  rows -> figures, each layer with the rows that it shows
//! meshes  the studies of meshes and what rules of thumb say of them
//! error   what can stop a tool
//! ```
//! `bipenalty` computes and knows no tool; `figure` draws and knows no physics; `precision` measures errors and times.

/// A line for the person who runs the tool, on standard error. That nobody reads it, a closed pipe, is no failure of a run.
#[macro_export]
macro_rules! tell {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($text)*);
    }};
}

pub mod charts;
pub mod cli;
pub mod error;
pub mod meshes;
pub mod record;
