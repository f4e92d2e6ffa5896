//! Contour lines of constant C_r in the plane (beta_s, r), without a grid.
//!
//! A level fixes l. With one contact the secular equation is then linear in the penalty,
//!
//! ```text
//! beta_s EA/h (1 - x/r) = T(l)      x = l/omega_e^2
//! ```
//! so beta_s is explicit for given r and r for given beta_s. With several contacts C_r is monotone in beta_s for given
//! r, and one bisection on the sign of the last pivot finds the point.

use super::{ClosedForm, Model};
use crate::error::Refusal;
use crate::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use crate::spectrum::{StepLimit, bisect};

/// The points (beta_s, r) at which C_r takes one value, ordered by beta_s; empty if it does not on the rectangle.
pub fn contour(
    model: &Model,
    critical_courant: f64,
    beta_s: (f64, f64),
    ratio: (f64, f64),
) -> Result<Vec<(f64, f64)>, Refusal> {
    let engine = ClosedForm::new(model.scene(), model.mass());
    let l = 4.0 * model.reference_rate() / (critical_courant * critical_courant);
    match (engine.gap_stiffness(l), model.form(), model.scales()) {
        (Some(t), PenaltyMass::Consistent, [scale]) => {
            Ok(explicit(t / scale.stiffness, l / model.reference_eigenvalue(), beta_s, ratio))
        }
        _ => Ok(within(by_bisection(model, &engine, l, beta_s, ratio)?, beta_s, ratio)),
    }
}

/// As [`contour`] for the limit of a scheme: explicit too, since 1/(beta_s k_e) + mu/(r omega_e^2) is one number along a
/// line. Empty for several contacts and above the contact-free limit.
pub fn scheme_contour(
    model: &Model,
    limit: &dyn StepLimit,
    critical_courant: f64,
    beta_s: (f64, f64),
    ratio: (f64, f64),
) -> Vec<(f64, f64)> {
    let l = 4.0 * model.reference_rate() / (critical_courant * critical_courant);
    let (Some((w, mu)), [scale]) = (limit.line(l), model.scales()) else { return Vec::new() };
    on_line((1.0 / (w * scale.stiffness), mu / (w * model.reference_eigenvalue())), beta_s, ratio)
}

/// The points of b/beta_s + r/ratio = 1 in a rectangle, ordered by beta_s.
pub(super) fn on_line((b, r): (f64, f64), beta_s: (f64, f64), ratio: (f64, f64)) -> Vec<(f64, f64)> {
    let over_beta = samples(beta_s).map(|beta_s| (beta_s, r / (1.0 - b / beta_s)));
    let over_ratio = samples(ratio).map(|ratio| (b / (1.0 - r / ratio), ratio));
    within(over_beta.chain(over_ratio).collect(), beta_s, ratio)
}

/// The points in the rectangle, ordered by beta_s.
fn within(mut points: Vec<(f64, f64)>, beta_s: (f64, f64), ratio: (f64, f64)) -> Vec<(f64, f64)> {
    points.retain(|(b, r)| (beta_s.0..=beta_s.1).contains(b) && (ratio.0..=ratio.1).contains(r));
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    points
}

/// Points along each axis; the line is steep in one variable where it is flat in the other.
const SAMPLES: usize = 256;

fn samples((low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    let step = (high / low).ln() / (SAMPLES - 1) as f64;
    (0..SAMPLES).map(move |i| (low * (step * i as f64).exp()).min(high))
}

/// b (1 - x/r) = t solved for r at given b and for b at given r, in the rectangle.
pub(super) fn explicit(t: f64, x: f64, beta_s: (f64, f64), ratio: (f64, f64)) -> Vec<(f64, f64)> {
    let over_beta = samples(beta_s).map(|b| (b, x / (1.0 - t / b)));
    let over_ratio = samples(ratio).map(|r| (t / (1.0 - x / r), r));
    let positive = |(b, r): &(f64, f64)| *b > 0.0 && *r > 0.0;
    within(over_beta.chain(over_ratio).filter(positive).collect(), beta_s, ratio)
}

fn by_bisection(
    model: &Model,
    engine: &ClosedForm,
    l: f64,
    beta_s: (f64, f64),
    ratio: (f64, f64),
) -> Result<Vec<(f64, f64)>, Refusal> {
    let mut points = Vec::new();
    for r in samples(ratio) {
        let r_valid = Ratio::new(r)?;
        // beta_s is positive and finite between its bounds, so the penalty cannot be refused.
        let above = |b: f64| {
            StiffnessPenalty::new(b).is_ok_and(|b| engine.is_above_spectrum(&model.penalty(b, r_valid), l))
        };
        let rises = above(beta_s.1);
        if rises != above(beta_s.0) {
            let (low, high) = bisect(beta_s.0, beta_s.1, |b| above(b) == rises);
            points.push((0.5 * (low + high), r));
        }
    }
    Ok(points)
}
