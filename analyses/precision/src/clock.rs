//! Time: the smallest of repeated runs, and when a run is not worth its time.

use std::time::{Duration, Instant};

/// How long a measurement may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Runs that would take longer are not made, s.
    pub limit: f64,
    /// Runs are repeated for so long, s.
    pub budget: f64,
}

impl Clock {
    /// At most 3 s a run, repeated for 60 ms.
    pub const FULL: Self = Self { limit: 3.0, budget: 0.06 };
    /// At most 0.1 s a run, repeated for 10 ms.
    pub const QUICK: Self = Self { limit: 0.1, budget: 0.01 };

    /// The smallest time of a run, s, after one that does not count. At least 3 runs; what is shorter than 20 us is
    /// timed in batches of that length, since reading the clock takes some 50 ns.
    pub fn smallest(&self, mut run: impl FnMut()) -> f64 {
        const BATCH: f64 = 20e-6;
        const LEAST: usize = 3;
        const MOST: usize = 1000;
        let once = seconds(&mut run);
        // At most 1e6 runs of a batch, should the clock not have moved.
        let batch = (BATCH / once.max(1e-11)).clamp(1.0, 1e6) as u32;
        let (begun, budget) = (Instant::now(), Duration::from_secs_f64(self.budget));
        let mut smallest = f64::INFINITY;
        for repeat in 0..MOST {
            if repeat >= LEAST && begun.elapsed() > budget {
                break;
            }
            let batch_seconds = seconds(|| (0..batch).for_each(|_| run()));
            smallest = smallest.min(batch_seconds / f64::from(batch));
        }
        smallest
    }
}

/// The middle of some values, the upper one of two; NaN of none.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Seconds that `run` takes.
pub fn seconds(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64()
}

/// Foretells the time of a run from the one before, of smaller size: cost grows like size^order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    order: i32,
    last: Option<(usize, f64)>,
}

impl Forecast {
    /// For a method whose cost grows like size^order.
    pub fn new(order: i32) -> Self {
        Self { order, last: None }
    }

    /// Notes that a run of `size` took `seconds`.
    pub fn note(&mut self, size: usize, seconds: f64) {
        self.last = Some((size, seconds));
    }

    /// The time that a run of `size` should take, s; 0 before the first.
    pub fn seconds(&self, size: usize) -> f64 {
        self.last.map_or(0.0, |(last, seconds)| seconds * (size as f64 / last as f64).powi(self.order))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_of_unequal_runs_is_kept() {
        let mut runs = 0;
        let clock = Clock { limit: 1.0, budget: 0.0 };
        // The first run does not count; the third is the shortest of the rest.
        let seconds = clock.smallest(|| {
            runs += 1;
            std::thread::sleep(Duration::from_millis([1, 60, 5, 60][(runs - 1) % 4]));
        });
        assert_eq!(runs, 4);
        assert!((0.005..0.06).contains(&seconds), "{seconds}");
    }

    #[test]
    fn a_short_run_is_timed_in_batches() {
        let clock = Clock { limit: 1.0, budget: 0.0 };
        let mut runs = 0_u64;
        let seconds = clock.smallest(|| runs = std::hint::black_box(runs + 1));
        assert!(runs > 100 && seconds < 1e-6, "{runs} runs of {seconds} s");
    }

    #[test]
    fn a_forecast_grows_with_its_order() {
        let mut forecast = Forecast::new(3);
        assert_eq!(forecast.seconds(1000), 0.0);
        forecast.note(100, 0.5);
        assert_eq!(forecast.seconds(1000), 500.0);
    }
}
