//! Plane geometry on the page: mm, x to the right, y down.

/// A point on the page, mm.
pub(super) type Point = (f64, f64);

/// An upright rectangle, `left <= right`, `top <= bottom`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Rect {
    pub(super) fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self { left, top, right: left + width, bottom: top + height }
    }

    pub(super) fn around(centre: Point, width: f64, height: f64) -> Self {
        Self::new(centre.0 - width / 2.0, centre.1 - height / 2.0, width, height)
    }

    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn centre(&self) -> Point {
        (f64::midpoint(self.left, self.right), f64::midpoint(self.top, self.bottom))
    }

    /// Larger by `margin` on every side.
    pub(super) fn grown(&self, margin: f64) -> Self {
        Self {
            left: self.left - margin,
            top: self.top - margin,
            right: self.right + margin,
            bottom: self.bottom + margin,
        }
    }

    pub(super) fn contains(&self, other: &Self) -> bool {
        self.left <= other.left
            && self.right >= other.right
            && self.top <= other.top
            && self.bottom >= other.bottom
    }

    pub(super) fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    /// Part of the segment inside, if any (Liang and Barsky).
    pub(super) fn clip_segment(&self, from: Point, to: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let sides = [
            (-dx, from.0 - self.left),
            (dx, self.right - from.0),
            (-dy, from.1 - self.top),
            (dy, self.bottom - from.1),
        ];
        for (rate, room) in sides {
            if rate == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if rate < 0.0 {
                enter = enter.max(room / rate);
            } else {
                leave = leave.min(room / rate);
            }
        }
        let at = |t: f64| (from.0 + t * dx, from.1 + t * dy);
        // The end points themselves are returned when they are inside: no rounding at joints.
        (enter <= leave)
            .then(|| (if enter == 0.0 { from } else { at(enter) }, if leave == 1.0 { to } else { at(leave) }))
    }

    /// Parts of a polyline inside.
    pub(super) fn clip(&self, line: &[Point]) -> Vec<Vec<Point>> {
        let mut parts: Vec<Vec<Point>> = Vec::new();
        for pair in line.windows(2) {
            let Some((from, to)) = self.clip_segment(pair[0], pair[1]) else {
                continue;
            };
            match parts.last_mut() {
                Some(part) if part.last() == Some(&from) => part.push(to),
                _ => parts.push(vec![from, to]),
            }
        }
        parts
    }
}

pub(super) fn distance(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

/// Length of a polyline.
pub(super) fn length(line: &[Point]) -> f64 {
    line.windows(2).map(|pair| distance(pair[0], pair[1])).sum()
}

/// Point at arc length `s` along a polyline and the index of the vertex before it.
pub(super) fn along(line: &[Point], s: f64) -> Option<(Point, usize)> {
    let mut walked = 0.0;
    for (index, pair) in line.windows(2).enumerate() {
        let step = distance(pair[0], pair[1]);
        if walked + step >= s && step > 0.0 {
            let t = ((s - walked) / step).clamp(0.0, 1.0);
            let (a, b) = (pair[0], pair[1]);
            return Some(((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)), index));
        }
        walked += step;
    }
    // Rounding may leave s a little beyond the end.
    Some((*line.last()?, line.len().saturating_sub(2)))
}

/// What is left of a polyline after the piece between arc lengths `from` and `to` is taken out.
pub(super) fn cut(line: &[Point], from: f64, to: f64) -> Vec<Vec<Point>> {
    let (Some((start, before)), Some((end, after))) = (along(line, from), along(line, to)) else {
        return vec![line.to_vec()];
    };
    let mut head = line[..=before].to_vec();
    head.push(start);
    let mut tail = vec![end];
    tail.extend_from_slice(&line[after + 1..]);
    vec![head, tail]
}

/// Fewer points, none farther than `tolerance` from the line before (Douglas and Peucker).
pub(super) fn simplify(line: &[Point], tolerance: f64) -> Vec<Point> {
    if line.len() < 3 {
        return line.to_vec();
    }
    let mut keep = vec![false; line.len()];
    keep[0] = true;
    keep[line.len() - 1] = true;
    let mut spans = vec![(0, line.len() - 1)];
    while let Some((first, last)) = spans.pop() {
        let farthest = (first + 1..last)
            .map(|index| (segment_distance(line[index], line[first], line[last]), index))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((far, index)) = farthest
            && far > tolerance
        {
            keep[index] = true;
            spans.push((first, index));
            spans.push((index, last));
        }
    }
    let kept = line.iter().zip(&keep).filter(|(_, keep)| **keep);
    kept.map(|(point, _)| *point).collect()
}

/// Distance of a point from a segment.
fn segment_distance(point: Point, from: Point, to: Point) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let square = dx * dx + dy * dy;
    if square == 0.0 {
        return distance(point, from);
    }
    let t = (((point.0 - from.0) * dx + (point.1 - from.1) * dy) / square).clamp(0.0, 1.0);
    distance(point, (from.0 + t * dx, from.1 + t * dy))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Rect = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };

    #[test]
    fn clipping_keeps_what_is_inside_and_splits_the_rest() {
        let line = [(-5.0, 5.0), (5.0, 5.0), (5.0, 20.0), (8.0, 20.0), (8.0, 8.0)];
        let parts = BOX.clip(&line);
        let expected = [vec![(0.0, 5.0), (5.0, 5.0), (5.0, 10.0)], vec![(8.0, 10.0), (8.0, 8.0)]];
        assert_eq!(parts, expected);
    }

    #[test]
    fn cutting_takes_the_middle_out() {
        let line = [(0.0, 0.0), (4.0, 0.0), (10.0, 0.0)];
        let parts = cut(&line, 3.0, 6.0);
        assert_eq!(parts, [vec![(0.0, 0.0), (3.0, 0.0)], vec![(6.0, 0.0), (10.0, 0.0)]]);
    }

    #[test]
    fn simplifying_drops_only_points_within_the_tolerance() {
        let line = [(0.0, 0.0), (1.0, 0.001), (2.0, 0.0), (3.0, 1.0), (4.0, 0.0)];
        let kept = simplify(&line, 0.01);
        assert_eq!(kept, [(0.0, 0.0), (2.0, 0.0), (3.0, 1.0), (4.0, 0.0)]);
    }
}
