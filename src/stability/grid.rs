//! Exact axes of penalty parameters, and the grid they span.

use std::str::FromStr;

use crate::error::Refusal;
use crate::memory;
use crate::penalty::{Ratio, StiffnessPenalty};

/// More points than this are refused, whatever memory there is; see [`Grid::require_memory`].
pub const MAX_POINTS: usize = 100_000_000;

/// Bytes of a value of an axis: as typed, as given to a grid, and as checked in it, each of them twice.
const BYTES_PER_VALUE: u64 = 48;

/// Values along one axis, in the order given; `log` tells how a chart should space them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The values.
    pub values: Vec<f64>,
    /// Whether they are spaced by equal factors.
    pub log: bool,
}

impl Sweep {
    /// A list of values.
    pub fn list(values: impl Into<Vec<f64>>) -> Self {
        Self { values: values.into(), log: false }
    }

    /// `count` values from `start` to `stop`, both included, by equal steps.
    ///
    /// # Errors
    /// Refuses ends that are not finite, an empty or reversed range and fewer than 2 or too many points.
    pub fn linear(start: f64, stop: f64, count: usize) -> Result<Self, Refusal> {
        check_range(start, stop, count)?;
        let (span, steps) = (stop - start, (count - 1) as f64);
        let value = |i| match i as f64 {
            _ if i + 1 == count => stop,
            // Divided last, so that 0.15 comes out as 3/20 and not as 3 * 0.05.
            i if (span * steps).is_finite() => start + span * i / steps,
            i => start * (1.0 - i / steps) + stop * (i / steps),
        };
        Ok(Self { values: (0..count).map(value).collect(), log: false })
    }

    /// `count` values from `start` to `stop`, both included, by equal factors; whole powers of ten are exact.
    ///
    /// # Errors
    /// As [`Sweep::linear`]; also refuses a start that is not positive.
    pub fn log(start: f64, stop: f64, count: usize) -> Result<Self, Refusal> {
        check_range(start, stop, count)?;
        if start <= 0.0 {
            return Err(Refusal::new("log range", start, "a positive start"));
        }
        let (low, high) = (start.log10(), stop.log10());
        let value = |i: usize| match i {
            0 => start,
            i if i + 1 == count => stop,
            // The fraction is formed last, so that an exponent that is a whole number comes out as one.
            i => power_of_ten(low + (high - low) * i as f64 / (count - 1) as f64),
        };
        Ok(Self { values: (0..count).map(value).collect(), log: true })
    }
}

/// 10^x, exact for whole x.
fn power_of_ten(x: f64) -> f64 {
    let whole = x.round();
    if (x - whole).abs() <= 4.0 * f64::EPSILON * whole.abs().max(1.0) {
        // A decimal literal is rounded correctly, which repeated multiplication is not.
        return format!("1e{whole}").parse().unwrap_or(f64::NAN);
    }
    10f64.powf(x)
}

fn check_range(start: f64, stop: f64, count: usize) -> Result<(), Refusal> {
    if !start.is_finite() || !stop.is_finite() {
        return Err(Refusal::new("range", format!("{start}:{stop}"), "finite ends"));
    }
    if start >= stop {
        return Err(Refusal::new("range", format!("{start}:{stop}"), "a start below the stop"));
    }
    if !(2..=MAX_POINTS).contains(&count) {
        return Err(Refusal::new("range count", count, format!("an integer from 2 to {MAX_POINTS}")));
    }
    memory::require(("range count", &count.to_string()), "values", BYTES_PER_VALUE * count as u64, |left| {
        format!("at most {} values", left / BYTES_PER_VALUE)
    })
}

impl FromStr for Sweep {
    type Err = Refusal;

    /// `0,0.5,10`, `lin:0:10:401` or `log:1e-3:1e12:301` (start:stop:count, ends included).
    fn from_str(text: &str) -> Result<Self, Refusal> {
        let Some((kind, range)) = text.split_once(':') else {
            let values: Result<Vec<f64>, Refusal> = text.split(',').map(number).collect();
            return Ok(Self::list(values?));
        };
        let parts: Vec<&str> = range.split(':').collect();
        let [start, stop, count] = parts[..] else {
            return Err(Refusal::new(
                "range",
                format!("{text:?}"),
                "lin:start:stop:count or log:start:stop:count",
            ));
        };
        let (start, stop) = (number(start)?, number(stop)?);
        let allowed = format!("an integer from 2 to {MAX_POINTS}");
        let count = number(count)?;
        if count.fract() != 0.0 || !(2.0..=MAX_POINTS as f64).contains(&count) {
            return Err(Refusal::new("range count", count, allowed));
        }
        match kind {
            "lin" => Self::linear(start, stop, count as usize),
            "log" => Self::log(start, stop, count as usize),
            _ => Err(Refusal::new(
                "range",
                format!("{text:?}"),
                "lin:start:stop:count or log:start:stop:count",
            )),
        }
    }
}

fn number(text: &str) -> Result<f64, Refusal> {
    let text = text.trim();
    text.parse().map_err(|_| Refusal::new("number", format!("{text:?}"), "a number such as 0.5, 1e12 or inf"))
}

/// The penalties of a map: every stiffness penalty with every ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// beta_s, in the order given.
    pub stiffness_penalties: Vec<StiffnessPenalty>,
    /// r, in the order given.
    pub ratios: Vec<Ratio>,
}

impl Grid {
    /// The grid of two axes.
    ///
    /// # Errors
    /// Refuses an empty axis, a beta_s that is negative or not finite, an r that is not positive, and more than
    /// `MAX_POINTS` points.
    pub fn new(beta_s: &Sweep, ratio: &Sweep) -> Result<Self, Refusal> {
        let points = beta_s.values.len().checked_mul(ratio.values.len());
        if points.is_none_or(|points| points == 0 || points > MAX_POINTS) {
            let value = format!("a grid of {} x {} points", beta_s.values.len(), ratio.values.len());
            return Err(Refusal::new("grid", value, format!("from 1 to {MAX_POINTS} points")));
        }
        let stiffness_penalties: Result<_, _> =
            beta_s.values.iter().copied().map(StiffnessPenalty::new).collect();
        let ratios: Result<_, _> = ratio.values.iter().copied().map(Ratio::new).collect();
        Ok(Self { stiffness_penalties: stiffness_penalties?, ratios: ratios? })
    }

    /// Refuses a grid whose points, of `bytes` each, the memory does not hold.
    ///
    /// # Errors
    /// Names the bytes needed and the number of points that fit.
    pub fn require_memory(&self, bytes: u64) -> Result<(), Refusal> {
        let value = format!("a grid of {} points", self.len());
        memory::require(("grid", &value), "records", bytes * self.len() as u64, |left| {
            format!("at most {} points", left / bytes)
        })
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.stiffness_penalties.len() * self.ratios.len()
    }

    /// Never true for a grid made by [`Grid::new`].
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
