//! Ticks of linear and logarithmic axes.

use super::model::Scale;

/// Ticks of one axis, in the units of the axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ticks {
    /// Long ticks and their labels (markup).
    pub(super) major: Vec<(f64, String)>,
    /// Short ticks.
    pub(super) minor: Vec<f64>,
    /// Power of ten taken out of the labels, to be written at the end of the axis.
    pub(super) power: Option<i32>,
}

/// A tick this far outside the range, as a share of the range, still counts as inside.
const SLACK: f64 = 1e-9;
/// Logarithmic axes over more decades than this have no minor ticks between the powers of ten.
const MINOR_DECADES: f64 = 8.0;
/// Powers of ten written out as decimal numbers if all labels of an axis are among them.
const PLAIN_DECADES: std::ops::RangeInclusive<i32> = -3..=3;

/// Least distance of two digits, in rooms of a label.
const CLOSEST: f64 = 0.55;

/// ... and if the axis shows no more powers of ten than this.
const MOST_PLAIN: usize = 3;

/// Ticks for `low < high`, at most about `most` of them labelled.
pub(super) fn ticks(scale: Scale, low: f64, high: f64, most: usize) -> Ticks {
    let most = most.max(2);
    match scale {
        Scale::Linear => linear(low, high, most),
        Scale::Log => logarithmic(low, high, most),
    }
}

/// Multiples of 1, 2 or 5 times a power of ten.
fn linear(low: f64, high: f64, most: usize) -> Ticks {
    let (digit, exponent) = nice_step((high - low) / most as f64);
    let step = f64::from(digit) * 10_f64.powi(exponent);
    let power = common_power(low.abs().max(high.abs()));
    let decimals = usize::try_from(power.unwrap_or(0) - exponent).unwrap_or(0);
    let unit = 10_f64.powi(power.unwrap_or(0));
    let major = multiples(low, high, step)
        .into_iter()
        .map(|value| (value, decimal(value / unit, decimals)))
        .collect();
    // Fifths of 1 and 5, quarters of 2: again 1-2-5 numbers.
    let parts = if digit == 2 { 4.0 } else { 5.0 };
    Ticks { major, minor: multiples(low, high, step / parts), power }
}

/// Smallest 1, 2 or 5 times a power of ten that is not below `raw`.
fn nice_step(raw: f64) -> (u8, i32) {
    let exponent = raw.log10().floor() as i32;
    let mantissa = raw / 10_f64.powi(exponent);
    match mantissa {
        m if m <= 1.0 + SLACK => (1, exponent),
        m if m <= 2.0 + SLACK => (2, exponent),
        m if m <= 5.0 + SLACK => (5, exponent),
        _ => (1, exponent + 1),
    }
}

/// All multiples of `step` from `low` to `high`.
fn multiples(low: f64, high: f64, step: f64) -> Vec<f64> {
    let slack = SLACK * (high - low);
    let (first, last) = (((low - slack) / step).ceil() as i64, ((high + slack) / step).floor() as i64);
    (first..=last).map(|index| index as f64 * step).collect()
}

/// The power of ten to take out if the labels would otherwise be long.
fn common_power(largest: f64) -> Option<i32> {
    let exponent = largest.log10().floor() as i32;
    (exponent >= 4 || exponent <= -3).then_some(exponent)
}

/// A decimal number with a proper minus sign and no negative zero.
fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| matches!(c, '0' | '.')) => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// `10^{n}` with a proper minus sign.
pub(super) fn power_of_ten(exponent: i32) -> String {
    format!("10^{{{}}}", decimal(f64::from(exponent), 0))
}

/// Powers of ten, with 2 and 5 between them where they are few.
fn logarithmic(low: f64, high: f64, most: usize) -> Ticks {
    let decades = (high / low).log10();
    let inside = |value: f64| value >= low * (1.0 - SLACK) && value <= high * (1.0 + SLACK);
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let at = |digit: u8, exponent: i32| f64::from(digit) * 10_f64.powi(exponent);
    let list = |digits: &[u8], stride: i32| -> Vec<(u8, i32)> {
        (first..=last)
            .filter(|exponent| exponent.rem_euclid(stride) == 0)
            .flat_map(|exponent| digits.iter().map(move |digit| (*digit, exponent)))
            .filter(|(digit, exponent)| inside(at(*digit, *exponent)))
            .collect()
    };
    let powers = list(&[1], 1);
    // Fewer than three labelled powers do not show the scale: fill up with 2 and 5, or with all digits.
    let labelled = if powers.len() >= 3 {
        let stride = powers.len().div_ceil(most);
        list(&[1], i32::try_from(stride).unwrap_or(i32::MAX))
    } else {
        let some = list(&[1, 2, 5], 1);
        // Digits crowd together towards the next power: as many of them as stand apart.
        let apart = |labels: &Vec<(u8, i32)>| {
            let place = |&(digit, exponent): &(u8, i32)| at(digit, exponent).log10() / decades;
            labels.windows(2).all(|pair| place(&pair[1]) - place(&pair[0]) >= CLOSEST / most as f64)
        };
        let digits: [&[u8]; 4] =
            [&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 2, 3, 4, 6, 8], &[1, 2, 3, 5], &[1, 2, 4]];
        let mut sets = digits.into_iter().map(|digits| list(digits, 1)).filter(apart);
        if some.len() >= 3 { some } else { sets.next().unwrap_or(some) }
    };
    if labelled.len() < 2 {
        // Less than one digit wide: the axis is nearly linear, and so are its ticks.
        return linear(low, high, most);
    }
    let minor = if decades < MINOR_DECADES { list(&[1, 2, 3, 4, 5, 6, 7, 8, 9], 1) } else { powers.clone() };
    let plain = powers.len() <= MOST_PLAIN && labelled.iter().all(|(_, e)| PLAIN_DECADES.contains(e));
    let name = |digit: u8, exponent: i32| {
        if plain {
            decimal(at(digit, exponent), usize::try_from(-exponent).unwrap_or(0))
        } else if digit == 1 {
            power_of_ten(exponent)
        } else {
            format!("{digit}·{}", power_of_ten(exponent))
        }
    };
    Ticks {
        major: labelled.iter().map(|&(d, e)| (at(d, e), name(d, e))).collect(),
        minor: minor.iter().map(|&(d, e)| at(d, e)).collect(),
        power: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn linear_ticks_are_round_numbers_inside_the_range() {
        let result = ticks(Scale::Linear, 0.4, 1.05, 6);
        assert_eq!(labels(&result), ["0.4", "0.6", "0.8", "1.0"]);
        let result = ticks(Scale::Linear, -0.3, 0.3, 6);
        assert_eq!(labels(&result), ["−0.3", "−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3"]);
    }

    #[test]
    fn small_and_large_numbers_share_one_power_of_ten() {
        let result = ticks(Scale::Linear, 0.0, 2e-4, 4);
        assert_eq!(result.power, Some(-4));
        assert_eq!(labels(&result), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
    }

    #[test]
    fn many_decades_are_thinned_out_evenly() {
        let result = ticks(Scale::Log, 1e-3, 1e12, 6);
        assert_eq!(labels(&result), ["10^{−3}", "10^{0}", "10^{3}", "10^{6}", "10^{9}", "10^{12}"]);
        assert_eq!(result.minor.len(), 16);
    }

    #[test]
    fn few_decades_show_twos_and_fives() {
        let result = ticks(Scale::Log, 0.03, 1.1, 6);
        assert_eq!(labels(&result), ["0.05", "0.1", "0.2", "0.5", "1"]);
        // Less than a decade: 0.7, 0.8 and 0.9 would stand in each other where there is room for four labels.
        let result = ticks(Scale::Log, 0.13, 0.92, 4);
        assert_eq!(labels(&result), ["0.2", "0.3", "0.4", "0.6", "0.8"]);
        let result = ticks(Scale::Log, 0.13, 0.92, 10);
        assert_eq!(result.major.len(), 8, "{result:?}");
        let result = ticks(Scale::Log, 0.31, 0.34, 6);
        assert!(result.major.len() >= 2, "{result:?}");
    }
}
