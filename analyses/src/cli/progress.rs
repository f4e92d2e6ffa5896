//! Progress of long work: a bar on a terminal, silence in pipes.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

/// Seconds left at the mean pace of the whole run; `None` before there is one, after a second and a unit. What is shown is
/// the least of all so far: pieces that take longer than those before make it stand, not grow.
fn time_left(elapsed: Duration, done: u64, all: u64) -> Option<u64> {
    let pace = elapsed.as_secs_f64() / done as f64;
    (done > 0 && elapsed.as_secs() > 0).then(|| (pace * all.saturating_sub(done) as f64).ceil() as u64)
}

/// A progress bar on standard error, hidden with `--quiet` and where standard error is not a terminal.
#[derive(Debug)]
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar of `total` units called `unit`, such as "points".
    pub fn new(total: usize, unit: &str, quiet: bool) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        // 28 + 14 + two counts + the time left fit into 80 columns up to a hundred million units.
        let template = format!("{{msg:28!}} [{{bar:10}}] {{pos}}/{{len}} {unit}{{left}}");
        let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let shown = Arc::new(AtomicU64::new(u64::MAX));
        let left = move |state: &ProgressState, text: &mut dyn Write| {
            let estimate = time_left(state.elapsed(), state.pos(), state.len().unwrap_or(0));
            if let Some(left) = estimate.map(|left| left.min(shown.load(Ordering::Relaxed))) {
                shown.store(left, Ordering::Relaxed);
                // The bar is drawn without it if it cannot be written.
                let _ = write!(text, ", {:#} left", HumanDuration(Duration::from_secs(left)));
            }
        };
        let style = style.progress_chars("=> ").with_key("left", left);
        Self(ProgressBar::new(total as u64).with_style(style).with_message(unit.to_owned()))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_that_of_the_mean_pace() {
        let seconds = Duration::from_secs;
        assert_eq!(time_left(seconds(10), 0, 100), None);
        assert_eq!(time_left(Duration::from_millis(10), 5, 100), None);
        assert_eq!(time_left(seconds(10), 25, 100), Some(30));
        assert_eq!(time_left(seconds(10), 100, 100), Some(0));
    }
}
