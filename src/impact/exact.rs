//! Exact solutions by d'Alembert of scenes with one contact: the Signorini and Hunek problems, the bouncing bar of
//! Doyen, Ern and Piperno (SIAM J. Sci. Comput. 33, 2011), and any other one or two bars with a free or fixed far end.
//!
//! Each bar k carries one unknown function of time, the wave O_k(t) that leaves the contact; it comes back from the far
//! end as I_k(t) = +-O_k(t - 2 L_k/c_k), + from a free end, - from a fixed one. With V_k = v_k + b t the free fall and
//! z_k = rho A c the impedance,
//!
//! ```text
//! open     O_k = I_k                       gap rate  Q = V_1 + 2 I_1 - V_2 - 2 I_2
//! closed   O_1 = I_1 - lambda/z_1          lambda = Q/(1/z_1 + 1/z_2),  as long as it is positive
//!          O_2 = I_2 + lambda/z_2          (a wall: V = I = 1/z = 0)
//! ```
//! O is piecewise linear, so that events are roots of linear and quadratic functions; nothing is discretised. At a jump
//! every function has its later value.

use crate::scene::{Bar, ContactSite, End, Scene};

/// More pieces than this and there is no exact solution: many bounces, each of which splits the waves.
const MAX_PIECES: usize = 100_000;

/// Times, speeds and gaps closer than this part of their scale are one: a few hundred roundings.
const COINCIDENCE: f64 = 1024.0 * f64::EPSILON;

/// A linear function of the time since the start of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Linear {
    value: f64,
    slope: f64,
}

impl Linear {
    fn at(self, t: f64) -> f64 {
        self.value + self.slope * t
    }

    /// From 0 to t.
    fn integral(self, t: f64) -> f64 {
        t * (self.value + 0.5 * self.slope * t)
    }
}

/// A bar seen from the contact.
#[derive(Debug, Clone)]
struct Side {
    bar: Bar,
    /// +1 for a free far end, -1 for a fixed one.
    reflection: f64,
    /// +1 for the bar left of the contact, -1 for the right one.
    hand: f64,
}

impl Side {
    /// 2 L/c, s.
    fn round_trip(&self) -> f64 {
        2.0 * self.bar.length / self.bar.wave_speed()
    }

    /// rho A c, N s/m.
    fn impedance(&self) -> f64 {
        self.bar.density * self.bar.area * self.bar.wave_speed()
    }
}

/// A stretch of time without an event.
#[derive(Debug, Clone)]
struct Piece {
    start: f64,
    closed: bool,
    force: Linear,
    /// O_k of either side, m/s, and its integral up to the start, m.
    emitted: [Linear; 2],
    integral: [f64; 2],
}

/// The exact solution of a scene.
#[derive(Debug, Clone)]
pub struct Exact {
    /// Left and right of the contact; a wall has no side.
    sides: [Option<Side>; 2],
    gravity: f64,
    duration: f64,
    pieces: Vec<Piece>,
}

impl Exact {
    /// The solution of `scene` up to `duration`, or `None` if it has no `[impact]`, not exactly one contact, a moving or
    /// falling bar that is held at its far end, or more events than are sensible.
    pub fn of(scene: &Scene, duration: f64) -> Option<Self> {
        let impact = scene.impact()?;
        let [site] = scene.contact_sites()[..] else { return None };
        let side = |bar: &Bar, end: End, hand: f64| {
            let reflection = if end == End::Fixed { -1.0 } else { 1.0 };
            Side { bar: bar.clone(), reflection, hand }
        };
        let (bars, last) = (scene.bars(), scene.bars().len() - 1);
        let sides = match site {
            ContactSite::LeftWall => [None, Some(side(&bars[0], scene.right(), -1.0))],
            ContactSite::RightWall => [Some(side(&bars[last], scene.left(), 1.0)), None],
            ContactSite::Between(_) => {
                [Some(side(&bars[0], scene.left(), 1.0)), Some(side(&bars[last], scene.right(), -1.0))]
            }
        };
        let held = |side: &Side| side.reflection < 0.0 && (side.bar.velocity != 0.0 || impact.gravity != 0.0);
        if sides.iter().flatten().any(held) {
            return None;
        }
        let gap = -impact.gaps.first().copied().unwrap_or(0.0);
        let exact = Self { sides, gravity: impact.gravity, duration, pieces: Vec::new() };
        exact.solved(gap)
    }

    /// Marches from event to event.
    fn solved(mut self, initial_gap: f64) -> Option<Self> {
        let speed = self.sides.iter().flatten().map(|s| s.bar.velocity.abs()).fold(0.0, f64::max)
            + self.gravity.abs() * self.duration;
        let tiny_gap = COINCIDENCE * (initial_gap.abs() + speed * self.duration);
        let (mut t, mut gap) = (0.0, initial_gap);
        while t < self.duration {
            if self.pieces.len() >= MAX_PIECES {
                return None;
            }
            let incoming = [0, 1].map(|k| self.incoming(k, t));
            let rate = self.closing_rate(t, &incoming);
            let mut end = self.next_break(t);
            let meets = rate.value > COINCIDENCE * speed
                || (rate.value >= -COINCIDENCE * speed && rate.slope * (end - t) > COINCIDENCE * speed);
            let closed = gap >= -tiny_gap && meets;
            if closed {
                gap = 0.0;
                let leaves = t - rate.value / rate.slope;
                if rate.slope < 0.0 && leaves > t + self.resolution() && leaves < end {
                    end = leaves;
                }
            } else if let Some(wait) = first_contact(gap.min(0.0), rate, self.resolution()) {
                end = end.min(t + wait);
            }
            self.push(t, closed, rate, incoming);
            if !closed {
                gap = gap.min(0.0) + rate.integral(end - t);
            }
            t = end;
        }
        Some(self)
    }

    fn push(&mut self, t: f64, closed: bool, rate: Linear, incoming: [Linear; 2]) {
        let compliance: f64 = self.sides.iter().flatten().map(|side| 1.0 / side.impedance()).sum();
        let share = if closed { 1.0 / compliance } else { 0.0 };
        let force = Linear { value: share * rate.value, slope: share * rate.slope };
        let emitted = [0, 1].map(|k| match &self.sides[k] {
            Some(side) => {
                let per_force = -side.hand / side.impedance();
                Linear {
                    value: incoming[k].value + per_force * force.value,
                    slope: incoming[k].slope + per_force * force.slope,
                }
            }
            None => Linear::default(),
        });
        let integral = self.pieces.last().map_or([0.0; 2], |last| {
            [0, 1].map(|k| last.integral[k] + last.emitted[k].integral(t - last.start))
        });
        self.pieces.push(Piece { start: t, closed, force, emitted, integral });
    }

    /// Q from time t on.
    fn closing_rate(&self, t: f64, incoming: &[Linear; 2]) -> Linear {
        let mut rate = Linear::default();
        for (side, wave) in self.sides.iter().zip(incoming) {
            let Some(side) = side else { continue };
            rate.value += side.hand * (side.bar.velocity + self.gravity * t + 2.0 * wave.value);
            rate.slope += side.hand * (self.gravity + 2.0 * wave.slope);
        }
        rate
    }

    /// I_k from time t on.
    fn incoming(&self, k: usize, t: f64) -> Linear {
        let Some(side) = &self.sides[k] else { return Linear::default() };
        let sent = t - side.round_trip();
        self.piece(sent).map_or_else(Linear::default, |piece| Linear {
            value: side.reflection * piece.emitted[k].at(sent - piece.start),
            slope: side.reflection * piece.emitted[k].slope,
        })
    }

    /// The next time at which a wave that comes back has a break.
    fn next_break(&self, t: f64) -> f64 {
        let later = |side: &Side| {
            let sent = t - side.round_trip() + self.resolution();
            let next = self.pieces.partition_point(|piece| piece.start <= sent);
            match self.pieces.get(next) {
                Some(piece) => piece.start + side.round_trip(),
                // Of the pieces to come the earliest is the one that starts now.
                None => t + side.round_trip(),
            }
        };
        self.sides.iter().flatten().map(later).fold(self.duration, f64::min)
    }

    /// Times closer than this are one, s.
    fn resolution(&self) -> f64 {
        COINCIDENCE * self.duration
    }

    /// The piece of time t; `None` before the start.
    fn piece(&self, t: f64) -> Option<&Piece> {
        let t = t + self.resolution();
        self.pieces.partition_point(|piece| piece.start <= t).checked_sub(1).map(|i| &self.pieces[i])
    }

    /// The contact force at time t, N, positive in compression.
    pub fn force(&self, t: f64) -> f64 {
        self.piece(t).map_or(0.0, |piece| piece.force.at(t - piece.start))
    }

    /// The contact force just before time t, N: differs from [`Exact::force`] where it jumps.
    pub fn force_before(&self, t: f64) -> f64 {
        let earlier = t - self.resolution();
        let last = self.pieces.partition_point(|piece| piece.start < earlier).checked_sub(1);
        last.map_or(0.0, |i| self.pieces[i].force.at(t - self.pieces[i].start))
    }

    /// The largest contact force, N.
    pub fn peak_force(&self) -> f64 {
        let ends = self.pieces.iter().skip(1).map(|piece| piece.start).chain([self.duration]);
        let peak = |(piece, end): (&Piece, f64)| piece.force.value.max(piece.force.at(end - piece.start));
        self.pieces.iter().zip(ends).map(peak).fold(0.0, f64::max)
    }

    /// The intervals with contact, s.
    pub fn contact_intervals(&self) -> Vec<(f64, f64)> {
        let ends = self.pieces.iter().skip(1).map(|piece| piece.start).chain([self.duration]);
        let mut intervals: Vec<(f64, f64)> = Vec::new();
        for (piece, end) in self.pieces.iter().zip(ends).filter(|(piece, _)| piece.closed) {
            match intervals.last_mut() {
                Some(last) if last.1 == piece.start => last.1 = end,
                _ => intervals.push((piece.start, end)),
            }
        }
        intervals
    }

    /// The side of `bar`, counted from the left.
    fn side(&self, bar: usize) -> Option<(usize, &Side)> {
        self.sides.iter().enumerate().filter_map(|(k, side)| side.as_ref().map(|side| (k, side))).nth(bar)
    }

    /// O_k of the waves that leave and come back at distance xi from the contact, with their times.
    fn waves(&self, side: &Side, xi: f64, t: f64, of: impl Fn(&Piece, f64) -> f64) -> [f64; 2] {
        let c = side.bar.wave_speed();
        let wave = |sent: f64| self.piece(sent).map_or(0.0, |piece| of(piece, sent - piece.start));
        [wave(t - xi / c), side.reflection * wave(t - (2.0 * side.bar.length - xi) / c)]
    }

    /// The distance from the contact of a point x from the left end of its bar.
    fn distance(side: &Side, x: f64) -> f64 {
        if side.hand > 0.0 { side.bar.length - x } else { x }
    }

    /// The velocity of the point x (m from the left end) of `bar` at time t, m/s; `None` for a bar that is not there.
    pub fn velocity(&self, bar: usize, x: f64, t: f64) -> Option<f64> {
        let (k, side) = self.side(bar)?;
        let [away, back] = self.waves(side, Self::distance(side, x), t, |p, s| p.emitted[k].at(s));
        Some(side.bar.velocity + self.gravity * t + away + back)
    }

    /// Its displacement, m.
    pub fn displacement(&self, bar: usize, x: f64, t: f64) -> Option<f64> {
        let (k, side) = self.side(bar)?;
        let integral = |p: &Piece, s: f64| p.integral[k] + p.emitted[k].integral(s);
        let [away, back] = self.waves(side, Self::distance(side, x), t, integral);
        Some(t * (side.bar.velocity + 0.5 * self.gravity * t) + away + back)
    }

    /// Its stress, Pa, positive in tension.
    pub fn stress(&self, bar: usize, x: f64, t: f64) -> Option<f64> {
        let (k, side) = self.side(bar)?;
        let [away, back] = self.waves(side, Self::distance(side, x), t, |p, s| p.emitted[k].at(s));
        Some(side.hand * side.bar.density * side.bar.wave_speed() * (away - back))
    }

    /// The contact force over time as a line (t, N) whose jumps are two points at the same time.
    pub fn force_line(&self) -> Vec<(f64, f64)> {
        let ends = self.pieces.iter().skip(1).map(|piece| piece.start).chain([self.duration]);
        let line = |(piece, end): (&Piece, f64)| {
            [(piece.start, piece.force.value), (end, piece.force.at(end - piece.start))]
        };
        self.pieces.iter().zip(ends).flat_map(line).collect()
    }

    /// The stress of `bar` at time t as a line (m from its left end, Pa) whose jumps are two points at the same place.
    pub fn stress_line(&self, bar: usize, t: f64) -> Vec<(f64, f64)> {
        let Some((_, side)) = self.side(bar) else { return Vec::new() };
        let fronts = self.fronts(side, t);
        let line = |pair: &[f64]| {
            // Linear between two breaks, so two points within give the values at the ends.
            let (from, width) = (pair[0], pair[1] - pair[0]);
            let at = |share: f64| self.stress(bar, from + share * width, t).unwrap_or(f64::NAN);
            let (near, far) = (at(0.25), at(0.75));
            let slope = far - near;
            [(from, near - 0.5 * slope), (pair[1], far + 0.5 * slope)]
        };
        fronts.windows(2).filter(|pair| pair[0] < pair[1]).flat_map(line).collect()
    }

    /// Kinetic and strain energy of all bars at time t, J.
    pub fn energies(&self, t: f64) -> (f64, f64) {
        let mut total = (0.0, 0.0);
        for bar in 0..2 {
            let Some((_, side)) = self.side(bar) else { continue };
            let fronts = self.fronts(side, t);
            for pair in fronts.windows(2) {
                let (kinetic, strain) = self.energy_between(bar, side, pair[0], pair[1], t);
                total = (total.0 + kinetic, total.1 + strain);
            }
        }
        total
    }

    /// The places x at which velocity or stress may have a break, ends included, in order.
    fn fronts(&self, side: &Side, t: f64) -> Vec<f64> {
        let (c, length) = (side.bar.wave_speed(), side.bar.length);
        let both = |piece: &Piece| {
            let travelled = c * (t - piece.start);
            [travelled, 2.0 * length - travelled]
        };
        let inside = self.pieces.iter().flat_map(both).filter(|xi| *xi > 0.0 && *xi < length);
        let mut fronts: Vec<f64> = inside.map(|xi| Self::distance(side, xi)).chain([0.0, length]).collect();
        fronts.sort_unstable_by(f64::total_cmp);
        fronts
    }

    /// Between two breaks both fields are linear: Gauss's rule of two points is exact.
    fn energy_between(&self, bar: usize, side: &Side, from: f64, to: f64, t: f64) -> (f64, f64) {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let at = [middle - half / 3.0_f64.sqrt(), middle + half / 3.0_f64.sqrt()];
        let square = |x: Option<f64>| x.map_or(0.0, |x| x * x);
        let v: f64 = at.iter().map(|x| square(self.velocity(bar, *x, t))).sum();
        let stress: f64 = at.iter().map(|x| square(self.stress(bar, *x, t))).sum();
        let volume = 0.5 * half * side.bar.area;
        (volume * side.bar.density * v, volume * stress / side.bar.youngs_modulus)
    }
}

/// The first time beyond `resolution` at which a gap < 0 that grows at `rate` comes to 0 from below.
fn first_contact(gap: f64, rate: Linear, resolution: f64) -> Option<f64> {
    let (a, b) = (0.5 * rate.slope, rate.value);
    let discriminant = b * b - 4.0 * a * gap;
    if discriminant < 0.0 {
        return None;
    }
    // a w^2 + b w + gap = 0 without cancellation.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let roots = [if a != 0.0 { q / a } else { f64::NAN }, if q != 0.0 { gap / q } else { f64::NAN }];
    let meets = |w: &f64| *w > resolution && rate.at(*w) > 0.0;
    roots.into_iter().filter(meets).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;

    fn exact(name: &str) -> Exact {
        let scene = built_in(name).unwrap().unwrap();
        let duration = scene.impact().unwrap().duration;
        Exact::of(&scene, duration).unwrap()
    }

    #[test]
    fn signorini_and_hunek_have_the_forces_of_the_paper() {
        let signorini = exact("signorini");
        assert_eq!(signorini.contact_intervals().len(), 1);
        let (start, end) = signorini.contact_intervals()[0];
        assert!(start == 0.0 && (end - 0.2).abs() < 1e-15);
        assert!((signorini.force(0.1) - 0.1).abs() < 1e-15 && signorini.force(0.21) == 0.0);
        assert!((signorini.velocity(0, 3.0, 0.25).unwrap() + 0.1).abs() < 1e-15);
        let hunek = exact("hunek");
        let found: Vec<_> = hunek.contact_intervals();
        assert_eq!(found.len(), 2, "{found:?}");
        for ((start, end), (a, b)) in found.iter().zip([(0.0, 0.2), (0.4, 0.6)]) {
            assert!((start - a).abs() < 1e-14 && (end - b).abs() < 1e-14, "{found:?}");
        }
        assert!((hunek.force(0.5) - 0.05).abs() < 1e-15 && hunek.force(0.3).abs() < 1e-15);
    }

    #[test]
    fn the_bar_bounces_with_the_pressure_and_the_period_of_the_literature() {
        let bar = exact("bouncing-bar");
        let intervals = bar.contact_intervals();
        assert_eq!(intervals.len(), 2, "{intervals:?}");
        let (start, end) = intervals[0];
        assert!((start - 1.0).abs() < 1e-13 && (end - 5.0 / 3.0).abs() < 1e-13);
        for s in [0.01, 0.3, 0.66] {
            assert!((bar.force(start + s) - 30.0 * (10.0 + 10.0 * s)).abs() < 1e-10);
        }
        // After one period the bar is back where it began, at rest.
        for x in [0.0, 2.5, 10.0] {
            assert!(bar.displacement(0, x, 16.0 / 3.0).unwrap().abs() < 1e-11);
            assert!(bar.velocity(0, x, 16.0 / 3.0).unwrap().abs() < 1e-11);
        }
    }

    #[test]
    fn energy_is_kept() {
        for (name, total) in [("signorini", 5e-4), ("hunek", 5e-4), ("symmetric", 1e-3)] {
            let exact = exact(name);
            for i in 0..60 {
                let (kinetic, strain) = exact.energies(0.005 * f64::from(i) + 0.0013);
                assert!((kinetic + strain - total).abs() < 1e-12 * total, "{name} {i} {kinetic} {strain}");
            }
        }
    }
}
