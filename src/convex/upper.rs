//! Upper bounds of f between proven points: convexity, in two coordinates.
//!
//! A proven point (t, u) says f(t) <= u. Between proven points f lies below
//!
//! 1. *the chord in (t, u)*, since f is a maximum of functions linear in t; beyond the last point below the line of slope
//!    mu = l_max(P, M); before the first one below its u, since f does not decrease;
//! 2. *the chord in (1/u, u/t)*, for t > 0. With v = 1/u and B = W^1/2 Z' the condition u M - K - t P >= 0 reads
//!    N(v) = l_max(u B (u M - K)^-1 B') <= u/t, and N is convex in v: u (u M - K)^-1 is sum_i x_i x_i'/(1 - l_i v), each term
//!    convex for 1 - l_i v > 0, and so is the largest eigenvalue of a matrix function that is convex for each vector. At
//!    v = 0 it is mu. So a few points serve all large t, where f is nearly mu t + c and u/t is flat.
//!
//! Both bound the inverse of f from below, which is what a point of the map asks for.

/// f(t) <= u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProvenPoint {
    /// t.
    pub t: f64,
    /// u.
    pub u: f64,
}

/// The upper bound that proven points make.
#[derive(Debug, Clone, Default)]
pub struct Upper {
    /// mu: proven, l_max(P, M) <= mu.
    slope: f64,
    points: Vec<ProvenPoint>,
    /// The lower convex hull of (t, u), ascending.
    chords: Vec<(f64, f64)>,
    /// The lower convex hull of (1/u, u/t), ascending, from (0, mu) on.
    curves: Vec<(f64, f64)>,
}

/// The lower convex hull of points, ascending.
fn lower_hull(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points.dedup_by_key(|point| point.0);
    let mut hull: Vec<(f64, f64)> = Vec::new();
    for next in points {
        while let [.., a, b] = hull[..] {
            // b is above the chord from a to next: it says nothing.
            if (b.1 - a.1) * (next.0 - a.0) >= (next.1 - a.1) * (b.0 - a.0) {
                hull.pop();
            } else {
                break;
            }
        }
        hull.push(next);
    }
    hull
}

impl Upper {
    /// No point yet; `slope` is a proven bound of l_max(P, M).
    pub fn new(slope: f64) -> Self {
        Self { slope, ..Self::default() }
    }

    /// mu.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// All proven points, in the order of their proofs.
    pub fn points(&self) -> &[ProvenPoint] {
        &self.points
    }

    /// Adds a proven point.
    pub fn add(&mut self, point: ProvenPoint) {
        self.points.push(point);
        // What follows from another point alone says nothing, and would spoil the hull.
        let follows = |q: &ProvenPoint, p: &ProvenPoint| q.u + self.slope * (p.t - q.t).max(0.0) < p.u;
        let dominated = |p: &ProvenPoint| self.points.iter().any(|q| follows(q, p));
        let useful: Vec<ProvenPoint> = self.points.iter().filter(|p| !dominated(p)).copied().collect();
        self.chords = lower_hull(useful.iter().map(|p| (p.t, p.u)).collect());
        let curve = |p: &ProvenPoint| (p.t > 0.0).then_some((1.0 / p.u, p.u / p.t));
        self.curves = lower_hull(useful.iter().filter_map(curve).chain([(0.0, self.slope)]).collect());
    }

    /// A t up to which f(t) <= u is proven; -infinity where nothing is.
    pub fn reach(&self, u: f64) -> f64 {
        self.reach_by_chords(u).max(self.reach_by_curves(u))
    }

    fn reach_by_chords(&self, u: f64) -> f64 {
        let after = self.chords.partition_point(|(_, at)| *at <= u);
        let Some((t, below)) = after.checked_sub(1).map(|at| self.chords[at]) else {
            return f64::NEG_INFINITY;
        };
        match self.chords.get(after) {
            Some((next, above)) => t + (next - t) * ((u - below) / (above - below)).min(1.0),
            None if self.slope > 0.0 => t + (u - below) / self.slope,
            None => f64::INFINITY,
        }
    }

    fn reach_by_curves(&self, u: f64) -> f64 {
        let v = 1.0 / u;
        let after = self.curves.partition_point(|(at, _)| *at < v);
        match (after.checked_sub(1).map(|at| self.curves[at]), self.curves.get(after)) {
            (Some((left, low)), Some((right, high))) => {
                let share = (v - left) / (right - left);
                u / (low + share * (high - low))
            }
            _ => f64::NEG_INFINITY,
        }
    }

    /// An upper bound of the l with l = f(s - l m), where `lower` is a lower bound of it; infinite where nothing is proven.
    ///
    /// The bound grows by eight roundings: moving u by one covers the rounding of u m and of v, and f(t (1 + e)) <= (1 + e) f(t) for
    /// t > 0 that of s.
    pub fn solve(&self, s: f64, m: f64, lower: f64) -> f64 {
        let safe = |u: f64| self.reach(u) >= s - u * m;
        let mut low = lower;
        if safe(low) {
            return low * (1.0 + 8.0 * f64::EPSILON);
        }
        let mut high = self.points.iter().map(|p| p.u).fold(low, f64::min).max(low);
        while !safe(high) {
            low = high;
            high *= 2.0;
            if !(high.is_finite() && high > 0.0) {
                return f64::INFINITY;
            }
        }
        while high - low > 4.0 * f64::EPSILON * high {
            let middle = 0.5 * (low + high);
            if safe(middle) { high = middle } else { low = middle }
        }
        high * (1.0 + 8.0 * f64::EPSILON)
    }

    /// An upper bound of f(t), where `lower` is a lower bound of it.
    pub fn at(&self, t: f64, lower: f64) -> f64 {
        self.solve(t, 0.0, lower)
    }
}
