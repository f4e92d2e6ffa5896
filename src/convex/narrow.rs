//! Where the curve is sampled and proven: at the widest enclosure of the points asked for, until none is too wide.

use super::curve::Curve;
use super::point::{Asked, Enclosed, TooWide};
use super::source::Source;

/// Intervals of asinh(t/unit): in a twenty-fifth of an e-fold nothing bends.
const NARROWEST: f64 = 0.04;

impl<S: Source> Curve<S> {
    /// Proves points for a t far below 0 where the proof at t itself is not close: without gaps for unknowns the rounding of t P,
    /// not f, limits it, and since f does not decrease a point at a larger t serves as well. With x = |t| mu/f, f(t) exceeds
    /// f(-infinity) by a part of some 1/x and rounding takes a part of some n eps x: at best, x = (n eps)^(-1/2), (n eps)^(1/2) is left.
    fn prove_far_below(&mut self, t: f64) {
        for power in 4..13 {
            let at = -self.unit * 10_f64.powi(power);
            if at > t {
                self.prove(at);
            }
        }
    }

    /// As [`Curve::enclose`] with a width of its own, which later questions keep.
    ///
    /// # Errors
    /// As [`Curve::enclose`].
    pub fn enclose_to(&mut self, asked: &[Asked], tolerance: f64) -> Vec<Result<Enclosed, TooWide>> {
        self.options.tolerance = tolerance;
        self.enclose(asked)
    }

    /// Encloses all points asked for, one result for each.
    ///
    /// # Errors
    /// Of a point: its enclosure, which holds, is wider than the tolerance. A proof takes n roundings of l, and far below t = 0, where
    /// gaps make no good unknowns, of t P, which may be as large as f itself; patches are too high by what they are too small.
    pub fn enclose(&mut self, asked: &[Asked]) -> Vec<Result<Enclosed, TooWide>> {
        let tolerance = self.options.tolerance;
        self.narrow(asked).into_iter().map(|known| known.within(tolerance)).collect()
    }

    fn narrow(&mut self, asked: &[Asked]) -> Vec<Enclosed> {
        let mut known = self.known(asked);
        // What is known closely enough already is not sampled again: every line that is added costs all later questions.
        if known.iter().all(|known| known.step_width() <= self.options.tolerance) {
            return known;
        }
        self.sample_for(asked, &known);
        known = self.known(asked);
        // Each round adds a point where the widest enclosure is; a round that changes nothing there ends it.
        let mut hopeless = vec![false; asked.len()];
        while let Some(worst) = self.worst(&known, &hopeless) {
            let before = known[worst].step_width();
            let t = self.polish(asked[worst]);
            self.improve(asked[worst], t);
            known[worst] = self.bounds(asked[worst]);
            // Patches, and chance, are too high by a part that varies slowly, and are asked once: close by nothing else can
            // be expected.
            let patches = !self.source.is_sharp();
            hopeless[worst] |= patches || known[worst].step_width() > 0.9 * before.min(1e300);
            let place = |t: f64| (t / self.unit).asinh();
            for i in 0..if patches { asked.len() } else { 0 } {
                let other = asked[i].place(known[i].lower);
                hopeless[i] |= (place(other) - place(t)).abs() < 0.05;
            }
            self.renew(asked, &mut known);
        }
        self.effort.products = self.source.products();
        known
    }

    /// Follows the lower bound of a point to the t of its solution with the vectors there are; that t.
    fn polish(&mut self, asked: Asked) -> f64 {
        let mut lower = self.bounds(asked).lower;
        // Where m is large, t moves by powers of ten; each round takes one at least, and f64 has 308.
        for _ in 0..308 {
            self.lower_at(asked.place(lower));
            let next = self.bounds(asked).lower;
            let settled = next - lower <= 0.01 * self.goal() * next.abs();
            lower = next;
            if settled {
                break;
            }
        }
        asked.place(lower)
    }

    /// Samples and proves what is missing at t.
    fn improve(&mut self, asked: Asked, t: f64) {
        // Farther below, a search in a large basis would drown in the spectrum of -t P.
        let few = self.source.unknowns() <= self.options.basis;
        self.sample(if few { t } else { t.max(-1e4 * self.unit) }, false);
        let t = self.polish(asked);
        let wide = |this: &Self| this.bounds(asked).step_width() > this.options.tolerance;
        if wide(self) {
            self.prove(t);
        }
        let below = asked.place(self.bounds(asked).lower * (1.0 + 0.25 * self.goal()));
        if wide(self) && self.source.is_sharp() && below < t {
            // Where l m is large, t is not known closely enough: what the last digits of l move it by, f may not stand. A bound of
            // f no larger than l (1 + e), where s - l m is for that l, is as good.
            self.prove(below);
        }
        if wide(self) && t < -1e4 * self.unit {
            self.prove_far_below(t);
        }
    }

    fn worst(&self, known: &[Enclosed], hopeless: &[bool]) -> Option<usize> {
        let wide =
            (0..known.len()).filter(|i| !hopeless[*i] && known[*i].step_width() > self.options.tolerance);
        wide.max_by(|a, b| known[*a].step_width().total_cmp(&known[*b].step_width()))
    }

    fn renew(&self, asked: &[Asked], known: &mut [Enclosed]) {
        for (known, asked) in known.iter_mut().zip(asked) {
            if known.step_width() > self.options.tolerance {
                *known = self.bounds(*asked);
            }
        }
    }

    fn known(&self, asked: &[Asked]) -> Vec<Enclosed> {
        asked.iter().map(|asked| self.bounds(*asked)).collect()
    }

    /// What is known about a point, from all lines and all proven points.
    fn bounds(&self, asked: Asked) -> Enclosed {
        let Asked { stiffness: s, mass: m } = asked;
        let lower = self.lines.iter().map(|line| line.with_mass(s, m)).fold(f64::NEG_INFINITY, f64::max);
        Enclosed { lower, upper: self.upper.solve(s, m, lower) }
    }

    /// Samples f over the range of t that is asked for, halving intervals of asinh(t/unit) until a sample changes little.
    fn sample_for(&mut self, asked: &[Asked], known: &[Enclosed]) {
        let t = |i: usize| asked[i].place(known[i].lower);
        let range = (0..asked.len())
            .map(t)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
        // Nearer to 0 than what bends, the vector of t itself serves.
        if range.0 < -NARROWEST * self.unit {
            self.sample(range.0, true);
        }
        // Beyond 1e4 units f is its asymptote to 1e-4 of 1e-4; and a Lanczos search drowns in the spectrum of -t P.
        let most = 1e4 * self.unit;
        let ends = [range.0.max(-most), range.1.min(most)].map(|t| (t / self.unit).asinh());
        self.sample(ends[0].sinh() * self.unit, false);
        self.sample(ends[1].sinh() * self.unit, false);
        let mut open = vec![(ends[0], ends[1])];
        while let Some((left, right)) = open.pop() {
            let middle = 0.5 * (left + right);
            let change = self.sample(middle.sinh() * self.unit, false);
            self.lower_at(middle.sinh() * self.unit);
            if change > 0.05 * self.goal() && right - left > NARROWEST {
                open.extend([(left, middle), (middle, right)]);
            }
        }
        let steps = 200;
        for i in 0..=steps {
            let share = f64::from(i) / f64::from(steps);
            self.lower_at((ends[0] + share * (ends[1] - ends[0])).sinh() * self.unit);
        }
        self.lower_at(range.0);
        self.lower_at(range.1);
    }
}
