//! The search: Courant numbers 2^(k/P), k a whole number, and nothing in between.

use std::collections::BTreeMap;

use super::trial::{STRIDE, Trial, Trials};
use super::{Bracket, Search};
use crate::error::Refusal;

/// Octaves of Courant numbers on either side of 1 beyond which no limit is looked for.
const OCTAVES: i64 = 60;

/// Points of the scan in an octave: it sees a loss of stability that spans a factor 2^(1/8), 9 %.
const SCANNED: i64 = 8;

/// Octaves below the limit that are scanned.
const SCANNED_OCTAVES: i64 = 2;

/// Trials of the scan are shorter by this factor: together they cost a fraction of one trial.
const SHORTER: u64 = 64;

/// Multiples of the step at which growth that begins at a limit is told from growth at every step. Two, as the first may
/// be stable again.
const BEYOND: [u64; 2] = [2, 4];

/// Growth a step in proportion to dt (of the motion itself) up to dt^4 (of a scheme) is one at every step.
const ORDER: u32 = 5;

/// The search for one limit, which remembers its trials.
pub(super) struct Lattice<'a> {
    trials: &'a Trials<'a>,
    /// P: points in an octave, a power of two, so that the scan is on the lattice.
    octave: i64,
    seen: BTreeMap<i64, Trial>,
    total_steps: u64,
}

impl<'a> Lattice<'a> {
    /// The lattice with neighbours at most the tolerance apart.
    pub fn new(trials: &'a Trials<'a>) -> Self {
        Self { trials, octave: points_of_octave(&trials.search), seen: BTreeMap::new(), total_steps: 0 }
    }

    /// The limit; `first` is where to look first.
    pub fn limit(mut self, first: f64) -> Result<Bracket, Refusal> {
        let end = OCTAVES * self.octave;
        let place = (first.log2() * self.octave as f64).floor();
        // A guess that is no number, or beyond every limit, says nothing.
        let start = if place.abs() < end as f64 { place as i64 } else { 0 };
        let mut stable =
            self.below(start)?.map(|(stable, unstable)| self.between(stable, unstable)).transpose()?;
        while let Some(found) = stable {
            match self.scan(found)? {
                Some((low, high)) => stable = Some(self.between(low, high)?),
                None => break,
            }
        }
        let limit = match stable {
            Some(found) if !(self.tells(found)? && self.begins(found)?) => None,
            other => other,
        };
        self.answer(limit)
    }

    fn answer(mut self, stable: Option<i64>) -> Result<Bracket, Refusal> {
        let lowest = self.seen.iter().find(|(_, trial)| trial.grows).map(|(k, _)| *k);
        let (stable_at, unstable) = match (stable, lowest) {
            (Some(k), _) => (self.courant(k), k + 1),
            (None, Some(k)) => (0.0, k),
            (None, None) => {
                return Err(Refusal::new(
                    "Courant number",
                    self.courant(OCTAVES * self.octave),
                    "a model that some step makes unstable",
                ));
            }
        };
        let growth = self.at(unstable)?.growth;
        let (unstable_at, steps) = (self.courant(unstable), self.trials.search.steps);
        Ok(Bracket { stable_at, unstable_at, growth, steps, total_steps: self.total_steps })
    }

    fn courant(&self, k: i64) -> f64 {
        (k as f64 / self.octave as f64).exp2()
    }

    fn at(&mut self, k: i64) -> Result<Trial, Refusal> {
        if let Some(trial) = self.seen.get(&k) {
            return Ok(*trial);
        }
        let trial = self.trials.run(self.courant(k), self.trials.search.steps)?;
        self.total_steps += trial.steps;
        self.seen.insert(k, trial);
        Ok(trial)
    }

    /// A stable place below an unstable one, found from `start` with strides that double. `None` without a stable one,
    /// or without an unstable one.
    fn below(&mut self, start: i64) -> Result<Option<(i64, i64)>, Refusal> {
        let end = OCTAVES * self.octave;
        let grew = self.at(start)?.grows;
        let (mut last, mut stride) = (start, if grew { -1 } else { 1 });
        while last.abs() < end {
            let next = (last + stride).clamp(-end, end);
            if self.at(next)?.grows != grew {
                return Ok(Some((last.min(next), last.max(next))));
            }
            (last, stride) = (next, 2 * stride);
        }
        Ok(None)
    }

    /// The stable one of two neighbours of which the upper one grows.
    fn between(&mut self, mut stable: i64, mut unstable: i64) -> Result<i64, Refusal> {
        while unstable - stable > 1 {
            let middle = stable + (unstable - stable) / 2;
            if self.at(middle)?.grows { unstable = middle } else { stable = middle }
        }
        Ok(stable)
    }

    /// Looks for a loss of stability below `stable` with short trials: the lowest place of the scan that grows, and the
    /// next lower one.
    fn scan(&mut self, stable: i64) -> Result<Option<(i64, i64)>, Refusal> {
        let apart = self.octave / SCANNED;
        let top = stable.div_euclid(apart);
        let steps = (self.trials.search.steps / SHORTER).max(self.trials.search.steps.min(1000));
        for place in top - SCANNED * SCANNED_OCTAVES..=top {
            let k = place * apart;
            let trial = self.trials.run(self.courant(k), steps)?;
            self.total_steps += trial.steps;
            if trial.grows && self.at(k)?.grows && !self.at(k - apart)?.grows {
                return Ok(Some((k - apart, k)));
            }
        }
        Ok(None)
    }

    /// Whether the trial at `stable` could have seen what that at its neighbour saw.
    fn tells(&mut self, stable: i64) -> Result<bool, Refusal> {
        Ok(!self.at(stable + 1)?.late || self.trials.sees_late(self.courant(stable)))
    }

    /// Whether growth begins above `stable`. Growth a step in proportion to dt^p, which no step ends, has not reached the
    /// threshold in N steps there; so it does not in N/f^p steps of f times the length. What does in N/f^5 began.
    fn begins(&mut self, stable: i64) -> Result<bool, Refusal> {
        for factor in BEYOND {
            let courant = self.courant(stable + 1) * factor as f64;
            let steps = (self.trials.search.steps / factor.pow(ORDER)).max(STRIDE);
            let trial = self.trials.run(courant, steps)?;
            self.total_steps += trial.steps;
            if trial.grows {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// The smallest power of two, at least [`SCANNED`], that sets neighbours at most the tolerance apart.
fn points_of_octave(search: &Search) -> i64 {
    let mut points = SCANNED;
    while std::f64::consts::LN_2 > search.tolerance * points as f64 {
        points *= 2;
    }
    points
}
