//! Finding a free place for a name: try many, keep the one with most air around it.

use super::geometry::{Point, Rect, along, distance, length};
use super::theme::{GAP, MARKER};
use super::trace::Trace;

/// Air asked for between a name and foreign lines, mm; more is tried first.
const CLEARANCES: [f64; 5] = [3.0, 2.0, 1.4, 0.9, 0.5];
/// Least air between a name and its own line, mm.
const OWN_CLEARANCE: f64 = 0.3;
/// Least air between a name and the frame, mm.
const FRAME_CLEARANCE: f64 = 0.6;
/// Distance between places tried along a line, mm.
const STRIDE: f64 = 1.2;
/// Where along a line names are best placed, as a share of its length.
const BEST_SHARE: f64 = 0.7;
/// The same along a row of markers: at the last one.
const BEST_MARKER: f64 = 1.0;
/// Least number of places tried along a line, however short.
const PLACES: f64 = 12.0;
/// Cost of bending, mm off the best place per unit of missing straightness.
const BEND_COST: f64 = 1e3;
/// Chord over arc below which a line bends too much to carry text.
const STRAIGHT: f64 = 0.985;
/// Air on both sides of a name set into its line, mm.
const INSET: f64 = 0.8;

/// What names must keep clear of.
pub(super) struct Obstacles<'a> {
    pub(super) frame: Rect,
    pub(super) traces: &'a [Trace],
    /// Names placed already.
    pub(super) taken: Vec<Rect>,
}

/// A name set into a gap of its line.
pub(super) struct Inset {
    pub(super) centre: Point,
    /// Clockwise, degrees, never upside down.
    pub(super) turn: f64,
    /// Index of the line and arc lengths where its gap begins and ends.
    pub(super) gap: (usize, f64, f64),
    /// Squares along the text that cover it.
    pub(super) boxes: Vec<Rect>,
}

impl Obstacles<'_> {
    /// Whether a name of `owner` may stand at `rect`, with this much air to the others and `own` to its own line, `None` if
    /// it stands upon that.
    fn allows(&self, rect: &Rect, owner: usize, clearance: f64, own: Option<f64>) -> bool {
        self.frame.grown(-FRAME_CLEARANCE).contains(rect)
            && !self.taken.iter().any(|other| other.meets(&rect.grown(GAP)))
            && !self.traces.iter().enumerate().any(|(index, trace)| {
                let air = if index == owner { own } else { Some(clearance) };
                air.is_some_and(|air| trace.touches(&rect.grown(air)))
            })
    }

    /// Of the candidates (rectangle, cost) with most air the cheapest.
    fn best(&self, candidates: &[(Rect, f64)], owner: usize) -> Option<Rect> {
        CLEARANCES.iter().find_map(|clearance| {
            candidates
                .iter()
                .filter(|(rect, _)| self.allows(rect, owner, *clearance, Some(OWN_CLEARANCE)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(rect, _)| *rect)
        })
    }

    /// A place of `size` beside the lines and dots of `owner`.
    pub(super) fn beside(&self, owner: usize, size: (f64, f64)) -> Option<Rect> {
        let trace = &self.traces[owner];
        let (bulge, best) = if trace.dots.is_empty() { (0.0, BEST_SHARE) } else { (MARKER, BEST_MARKER) };
        let total: f64 = trace.lines.iter().map(|line| length(line)).sum();
        let mut walked = 0.0;
        let mut candidates = Vec::new();
        for line in &trace.lines {
            let own = length(line);
            let stride = STRIDE.min(own / PLACES).max(f64::MIN_POSITIVE);
            for step in 0..=steps(own, stride) {
                let s = (step as f64 * stride).min(own);
                if let Some((point, _)) = along(line, s) {
                    let share = (walked + s) / total.max(f64::MIN_POSITIVE);
                    around(point, size, GAP + bulge, (share - best).abs(), &mut candidates);
                }
            }
            walked += own;
        }
        if trace.lines.is_empty() {
            for (index, dot) in trace.dots.iter().enumerate() {
                let share = (index + 1) as f64 / trace.dots.len() as f64;
                around(*dot, size, GAP + bulge, (share - best).abs(), &mut candidates);
            }
        }
        self.best(&candidates, owner)
    }

    /// A place of `size` inside the shaded areas of `owner`, as near to their middle as possible.
    pub(super) fn inside(&self, owner: usize, size: (f64, f64)) -> Option<Rect> {
        let areas = &self.traces[owner].areas;
        let corners: Vec<Point> = areas.concat();
        let bounds = corners.iter().fold(None, |bounds: Option<Rect>, p| {
            let dot = Rect::around(*p, 0.0, 0.0);
            Some(bounds.map_or(dot, |b| Rect {
                left: b.left.min(p.0),
                top: b.top.min(p.1),
                right: b.right.max(p.0),
                bottom: b.bottom.max(p.1),
            }))
        })?;
        let middle = bounds.centre();
        let mut candidates = Vec::new();
        for i in 0..=steps(bounds.width(), STRIDE) {
            for j in 0..=steps(bounds.height(), STRIDE) {
                let (dx, dy) = (i as f64 * STRIDE, j as f64 * STRIDE);
                let rect = Rect::around((bounds.left + dx, bounds.top + dy), size.0, size.1);
                let covered = areas.iter().any(|area| covers(area, &rect));
                if covered {
                    candidates.push((rect, distance(rect.centre(), middle)));
                }
            }
        }
        self.best(&candidates, owner)
    }

    /// A straight stretch of a line of `owner` to set a name of `size` into, near its middle.
    pub(super) fn inset(&self, owner: usize, size: (f64, f64)) -> Option<Inset> {
        let lines = &self.traces[owner].lines;
        let half = size.0 / 2.0 + INSET;
        let mut candidates = Vec::new();
        for (index, line) in lines.iter().enumerate() {
            let own = length(line);
            for step in 1..=steps(own - 2.0 * half, STRIDE) {
                let s = half + step as f64 * STRIDE;
                if s + half > own {
                    break;
                }
                let (from, to) = (along(line, s - half)?.0, along(line, s + half)?.0);
                let straightness = distance(from, to) / (2.0 * half);
                if straightness >= STRAIGHT {
                    // Longer lines first, then the middle of the line.
                    let cost = (s - own / 2.0).abs() - own + BEND_COST * (1.0 - straightness);
                    candidates.push((straight(from, to, size, (index, s - half, s + half)), cost));
                }
            }
        }
        candidates.sort_by(|a, b| a.1.total_cmp(&b.1));
        let clearance = CLEARANCES.iter().find_map(|clearance| {
            candidates.iter().position(|(inset, _)| {
                inset.boxes.iter().all(|part| self.allows(part, owner, *clearance, None))
            })
        })?;
        Some(candidates.swap_remove(clearance).0)
    }
}

/// Whole steps in a length; none in a negative one.
fn steps(length: f64, stride: f64) -> usize {
    // Lengths on a page are small, and a float below zero becomes 0.
    (length / stride) as usize
}

/// Rectangles of `size` on all sides of a point; above and right are preferred a little.
fn around(point: Point, size: (f64, f64), gap: f64, cost: f64, candidates: &mut Vec<(Rect, f64)>) {
    /// Cost of each step down the list of sides, in shares of the line's length.
    const SIDE_COST: f64 = 0.02;
    let (dx, dy) = (size.0 / 2.0 + gap, size.1 / 2.0 + gap);
    let sides = [(0.0, -dy), (dx, -dy), (-dx, -dy), (dx, 0.0), (-dx, 0.0), (0.0, dy), (dx, dy), (-dx, dy)];
    for (rank, (x, y)) in sides.into_iter().enumerate() {
        let rect = Rect::around((point.0 + x, point.1 + y), size.0, size.1);
        candidates.push((rect, cost + rank as f64 * SIDE_COST));
    }
}

/// Text of `size` centred between two points of its line.
fn straight(from: Point, to: Point, size: (f64, f64), gap: (usize, f64, f64)) -> Inset {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let centre = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
    let mut turn = dy.atan2(dx).to_degrees();
    if turn > 90.0 {
        turn -= 180.0;
    } else if turn <= -90.0 {
        turn += 180.0;
    }
    let chord = dx.hypot(dy);
    let count = (size.0 / size.1).ceil().max(1.0);
    let boxes = (0..count as usize).map(|index| {
        let share = ((index as f64 + 0.5) / count - 0.5) * size.0 / chord;
        Rect::around((centre.0 + share * dx, centre.1 + share * dy), size.1, size.1)
    });
    Inset { centre, turn, gap, boxes: boxes.collect() }
}

/// Whether a polygon covers a rectangle: all corners inside and no side of it cuts through.
fn covers(ring: &[Point], rect: &Rect) -> bool {
    let corners =
        [(rect.left, rect.top), (rect.right, rect.top), (rect.right, rect.bottom), (rect.left, rect.bottom)];
    let mut sides = ring.iter().zip(ring.iter().cycle().skip(1));
    corners.iter().all(|corner| holds(ring, *corner))
        && !sides.any(|(a, b)| rect.clip_segment(*a, *b).is_some())
}

/// Whether a point lies inside a polygon (even-odd rule).
fn holds(ring: &[Point], point: Point) -> bool {
    let sides = ring.iter().zip(ring.iter().cycle().skip(1));
    let crossings = sides.filter(|(a, b)| {
        (a.1 > point.1) != (b.1 > point.1) && point.0 < a.0 + (point.1 - a.1) / (b.1 - a.1) * (b.0 - a.0)
    });
    crossings.count() % 2 == 1
}
