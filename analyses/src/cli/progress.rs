//! Progress of long work: a bar on a terminal, silence in pipes.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar on standard error, hidden with `--quiet` and where standard error is not a terminal.
#[derive(Debug)]
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar of `total` units called `unit`, such as "points".
    pub fn new(total: usize, unit: &str, quiet: bool) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let template = format!("{{msg}} [{{bar:30}}] {{pos}}/{{len}} {unit}, {{per_sec}}, {{eta}} left");
        let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
        Self(ProgressBar::new(total as u64).with_style(style.progress_chars("=> ")))
    }

    /// Names what is being done.
    pub fn doing(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }

    /// Adds finished units.
    pub fn add(&self, finished: usize) {
        self.0.inc(finished as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
