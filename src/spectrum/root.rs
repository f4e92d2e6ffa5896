//! One-dimensional sign changes: bisection, and Chandrupatla's bracketing interpolation.

/// Narrows [low, high] until the bracket is as narrow as f64 allows; `is_above(l)` is false at `low`, true at `high`.
pub fn bisect(mut low: f64, mut high: f64, is_above: impl Fn(f64) -> bool) -> (f64, f64) {
    // At most 1075 halvings separate any two positive f64; from bounds within a factor of 4 it takes 53.
    for _ in 0..1100 {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            break;
        }
        if is_above(middle) { high = middle } else { low = middle }
    }
    (low, high)
}

/// The sign change of an increasing `f` in [low, high] to a bracket of relative width `tolerance`, by inverse
/// quadratic interpolation where it is safe and bisection elsewhere (Chandrupatla, Adv. Eng. Softw. 28, 1997).
/// `f(low) < 0 <= f(high)` is assumed; f may be infinite.
pub fn find_sign_change(
    low: (f64, f64),
    high: (f64, f64),
    tolerance: f64,
    mut f: impl FnMut(f64) -> f64,
) -> (f64, f64) {
    // a is the newest point, b the other end of the bracket, c the point before.
    let ((mut b, mut fb), (mut a, mut fa)) = (low, high);
    let mut t = 0.5;
    for _ in 0..200 {
        let x = a + t * (b - a);
        let fx = f(x);
        let (c, fc);
        if (fx < 0.0) == (fa < 0.0) {
            (c, fc) = (a, fa);
        } else {
            (c, fc, b, fb) = (b, fb, a, fa);
        }
        (a, fa) = (x, fx);
        let best = if fa.abs() < fb.abs() { a } else { b };
        let reach = 0.5 * tolerance * best.abs() / (b - a).abs();
        if reach >= 0.5 || fx == 0.0 {
            break;
        }
        let xi = (a - b) / (c - b);
        let phi = (fa - fb) / (fc - fb);
        let interpolates = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        t = if interpolates && fc.is_finite() && fb.is_finite() {
            fa / (fb - fa) * (fc / (fb - fc)) + (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb))
        } else {
            0.5
        };
        t = t.clamp(reach, 1.0 - reach);
    }
    if fa == 0.0 { (a, a) } else { (a.min(b), a.max(b)) }
}
