//! A traced line → points at even distances, placed so that neighbouring slices interlock.
//!
//! Triangles between two lines are best where the points of one face the middles of the other's
//! edges. Every other slice therefore starts half an edge later: a closed line is counted from
//! where a ray along x from its centroid leaves it, which moves little from slice to slice, and an
//! open line from its end, with half an edge at both ends. Closed lines get numbers of edges in
//! steps, so that neighbours mostly have the same number and interlock all the way round.

use crate::zipper::slice::{Point, Slice};
use crate::zipper::trace::{crest, Trace};

/// A line of fewer edges is not shifted.
const LEAST_SHIFTED: usize = 4;
/// The number of a closed line's edges may be off its best by one in twice this.
const STEPS: f64 = 24.0;

pub(crate) fn distance(a: Point, b: Point) -> f64 {
    let d = [a[0] - b[0], a[1] - b[1]];
    (d[0] * d[0] + d[1] * d[1]).sqrt()
}

pub(crate) fn arc_length(line: &Trace) -> f64 {
    let open: f64 = line.points.windows(2).map(|w| distance(w[0], w[1])).sum();
    match (line.closed, line.points.first(), line.points.last()) {
        (true, Some(&first), Some(&last)) => open + distance(first, last),
        _ => open,
    }
}

/// Points at even distances near `spacing` along a line, put back onto the ridge; `odd` slices are
/// shifted by half an edge. The ends of an open line stay. `None` where the line is shorter than a
/// third of an edge.
pub(crate) fn resample(slice: &Slice, line: Trace, spacing: f64, odd: bool) -> Option<Trace> {
    let length = arc_length(&line);
    if length < 0.3 * spacing {
        return None;
    }
    let best = length / spacing;
    let count = if line.closed {
        edge_count(best).max(3)
    } else {
        (best.round() as usize).max(1)
    };
    let edge = length / count as f64;
    let shift = f64::from(u8::from(odd)) * 0.5;
    let along: Vec<f64> = if line.closed {
        let anchor = anchor(&line.points);
        (0..count)
            .map(|k| (anchor + (k as f64 + shift) * edge).rem_euclid(length))
            .collect()
    } else if odd && count >= LEAST_SHIFTED {
        let inner = (0..count).map(|k| (k as f64 + shift) * edge);
        std::iter::once(0.0).chain(inner).chain([length]).collect()
    } else {
        (0..=count).map(|k| (k as f64 * edge).min(length)).collect()
    };
    let curve = Curve::new(&line);
    let last = along.len() - 1;
    let points = along.iter().enumerate().map(|(k, &s)| {
        let p = curve.at(s);
        let end = !line.closed && (k == 0 || k == last);
        let on_crest = crest(slice, p).filter(|q| !end && distance(p, *q) < 0.5 * spacing);
        slice.clamp(on_crest.unwrap_or(p))
    });
    Some(Trace {
        points: points.collect(),
        closed: line.closed,
    })
}

/// The number of edges of a closed line of `best` edges, in steps that grow with it.
fn edge_count(best: f64) -> usize {
    let step = (best / STEPS).max(1.0).log2().floor().exp2();
    ((best / step).round() * step) as usize
}

/// Arc length from the first point of a closed line to where a ray along x from its centroid
/// leaves it for good; 0 where the ray does not meet the line.
fn anchor(points: &[Point]) -> f64 {
    let edges = || points.iter().zip(points.iter().cycle().skip(1));
    let origin = points[0];
    let (mut area, mut moment) = (0.0, 0.0);
    for (p, q) in edges() {
        let (p, q) = (
            [p[0] - origin[0], p[1] - origin[1]],
            [q[0] - origin[0], q[1] - origin[1]],
        );
        let cross = p[0] * q[1] - p[1] * q[0];
        area += cross;
        moment += cross * (p[1] + q[1]) / 3.0;
    }
    let level = if area.abs() > 1e-9 {
        origin[1] + moment / area
    } else {
        origin[1]
    };
    let (mut passed, mut best) = (0.0, (f64::NEG_INFINITY, 0.0));
    for (p, q) in edges() {
        if (p[1] <= level) != (q[1] <= level) {
            let t = (level - p[1]) / (q[1] - p[1]);
            let x = p[0] + t * (q[0] - p[0]);
            if x > best.0 {
                best = (x, passed + t * distance(*p, *q));
            }
        }
        passed += distance(*p, *q);
    }
    best.1
}

/// A line with the arc length at each of its corners.
struct Curve {
    corners: Vec<Point>,
    passed: Vec<f64>,
}

impl Curve {
    fn new(line: &Trace) -> Self {
        let mut corners = line.points.clone();
        if line.closed {
            corners.push(line.points[0]);
        }
        let mut passed = vec![0.0; corners.len()];
        for i in 1..corners.len() {
            passed[i] = passed[i - 1] + distance(corners[i - 1], corners[i]);
        }
        Self { corners, passed }
    }

    /// The point at arc length s.
    fn at(&self, s: f64) -> Point {
        let i = self
            .passed
            .partition_point(|&passed| passed < s)
            .clamp(1, self.corners.len() - 1);
        let (a, b) = (self.corners[i - 1], self.corners[i]);
        let span = (self.passed[i] - self.passed[i - 1]).max(1e-12);
        let t = ((s - self.passed[i - 1]) / span).clamp(0.0, 1.0);
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    }
}
