//! Which contour lines a map of C_r has.

use super::curve::{Curve, curves_of};
use super::maps::{MapGrid, number};
use crate::record::StabilityRow;
use figure::isolines;

/// A value of C_r that is worth a contour line, and its name there.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// C_r.
    pub value: f64,
    /// What stands in the line (markup).
    pub label: String,
}

/// Contour lines of one model: the level and the points (beta_s, r) of its line.
pub type ContourLines = Vec<(Level, Vec<(f64, f64)>)>;

/// The neutral level as a share of the contact-free limit C_0. Where contact costs nothing C_r *is* C_0, on areas: the line
/// that bounds them is that of the first thousandth lost.
const NEUTRAL: f64 = 0.999;
/// Levels closer than this share are one line to the eye.
const APART: f64 = 0.03;
/// Nor is there a level closer to an end of the range than this share of its logarithm.
const EDGE: f64 = 0.03;

/// The levels of the rows of one model: the `asked` ones if any are, else round values between the smallest and the
/// largest C_r, and the neutral level.
pub fn levels(rows: &[StabilityRow], asked: Option<&[f64]>) -> Vec<Level> {
    let named = |value: f64| Level { value, label: number(value) };
    if let Some(asked) = asked {
        return asked.iter().copied().map(named).collect();
    }
    let values = || rows.iter().filter_map(StabilityRow::stable_courant);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    let neutral = contact_free(rows).map(|free| NEUTRAL * free).filter(|level| low < *level && *level < high);
    let clear = |level: &f64| neutral.is_none_or(|neutral| (level / neutral).ln().abs() > APART);
    // A line along the edge of a map cannot be told from it and has no room for its name.
    let apart = APART.max(EDGE * (high / low).ln());
    let inside = |level: &f64| (level / low).ln() > apart && (high / level).ln() > apart;
    let round = round(low, high).into_iter().filter(inside).filter(clear).map(named);
    let neutral = neutral.map(|value| Level { value, label: format!("{NEUTRAL} *C*_{{0}}") });
    round.chain(neutral).collect()
}

/// Round values from `low` to `high`, a handful: powers of ten over many decades, with 2 and 5 between them over few, and
/// equal steps where there is not even one.
fn round(low: f64, high: f64) -> Vec<f64> {
    if !(low > 0.0 && low < high && high.is_finite()) {
        return Vec::new();
    }
    let digits: &[f64] = match (high / low).log10() {
        ..0.7 => return steps(low, high),
        ..3.0 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    // Magnitudes of f64 are small integers.
    let (first, last) = (low.log10().floor() as i32, high.log10().floor() as i32);
    let decimal = |exponent: i32| {
        // Parsed, since products of powers of ten are not the numbers that they print.
        move |digit: &f64| format!("{digit}e{exponent}").parse::<f64>().unwrap_or(f64::NAN)
    };
    (first..=last).flat_map(|exponent| digits.iter().map(decimal(exponent)).collect::<Vec<_>>()).collect()
}

/// Multiples of 1, 2 or 5 times a power of ten from `low` to `high`, about five of them.
fn steps(low: f64, high: f64) -> Vec<f64> {
    let raw = (high - low) / 5.0;
    let exponent = raw.log10().floor() as i32;
    let digit = [1.0, 2.0, 5.0, 10.0].into_iter().find(|digit| digit * 10_f64.powi(exponent) >= raw);
    let step = digit.unwrap_or(10.0) * 10_f64.powi(exponent);
    let decimals = usize::try_from(-exponent).unwrap_or(0);
    let value = |i: u32| {
        let value = ((low / step).floor() + f64::from(i)) * step;
        format!("{value:.decimals$}").parse::<f64>().unwrap_or(value)
    };
    (0..=6).map(value).filter(|value| *value <= high).collect()
}

/// The contact-free limit, which no row holds, from the curve that contact changes least: C_r at its smallest beta_s,
/// where the next one, at least a tenth larger, differs by so little that the neutral level is not moved; else `None`.
fn contact_free(rows: &[StabilityRow]) -> Option<f64> {
    // C_r - C_0 grows at least linearly, so that over a step of a tenth it is at most ten times the difference: a tenth of
    // what the neutral level is below C_0.
    const FLAT: f64 = 0.01 * (1.0 - NEUTRAL);
    let curves = curves_of(rows);
    // Stiff contacts change C_r by as little, but at another value: only a contact of a hundredth of an element will do.
    const WEAK: f64 = 0.01;
    let start = |curve: &Curve| match curve.points[..] {
        [one, two, ..] if one.beta_s <= WEAK * curve.ratio.min(1.0) && two.beta_s >= 1.1 * one.beta_s => {
            Some((one.courant, (two.courant / one.courant - 1.0).abs()))
        }
        _ => None,
    };
    let starts = curves.iter().filter_map(start);
    let flattest = starts.filter(|(_, change)| *change <= FLAT).min_by(|a, b| a.1.total_cmp(&b.1));
    flattest.map(|(courant, _)| courant)
}

/// The contour lines of the rows of one model, interpolated on their grid; what a map shows where the exact lines are not
/// known.
pub fn interpolated_contours(rows: &[StabilityRow], asked: Option<&[f64]>) -> ContourLines {
    let grid = MapGrid::of(rows);
    let lines = |level: Level| {
        let lines = isolines(&grid.x, &grid.y, &grid.values, level.value);
        lines.into_iter().map(move |line| (level.clone(), line))
    };
    levels(rows, asked).into_iter().flat_map(lines).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_a_handful_of_round_values() {
        assert_eq!(round(0.03, 1.1), [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0]);
        assert_eq!(round(1e-6, 1.0), [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0]);
        assert_eq!(round(0.81, 1.0), [0.8, 0.85, 0.9, 0.95, 1.0]);
        assert!(round(1.0, 1.0).is_empty() && round(f64::INFINITY, 0.0).is_empty());
    }
}
