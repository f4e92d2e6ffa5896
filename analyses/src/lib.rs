//! What the tools share: the command line, the records, the charts.

pub mod charts;
pub mod cli;
pub mod error;
pub mod record;
