//! Ends of lines on the border of the volume, after the lines were moved to the middle.
//!
//! A sheet that leaves the volume at a small angle leaves it voxels away from where a line off the
//! middle does. A line that ended on the border is therefore cut where it meets the border now, or
//! carried on to it, straight.

use crate::zipper::resample::distance;
use crate::zipper::slice::{Point, Slice};
use crate::zipper::trace::Trace;

/// No line is carried on farther, in distances of its points: by this much a line half a voxel off the
/// middle misses a border that it meets at 3°.
const FARTHEST: f64 = 8.0;
/// A last edge is no shorter, and a new point no nearer, in distances of the points.
const SHORTEST: f64 = 0.3;
const NEAREST: f64 = 0.75;
/// Points over which a line's direction is taken.
const BACK: usize = 3;

/// A line with the thickness at its points.
pub(crate) struct Line {
    pub points: Vec<Point>,
    pub thickness: Vec<f64>,
    pub closed: bool,
}

/// The first and the last point of an open line where they lie on the border of the volume.
pub(crate) fn ends_on_border(slice: &Slice, line: &Trace) -> [Option<Point>; 2] {
    let on_border = |p: &&Point| !line.closed && slice.on_border(**p).contains(&true);
    [line.points.first(), line.points.last()].map(|p| p.filter(on_border).copied())
}

/// Puts the ends that lay on the border, at `ends`, back onto it. `spacing` is the distance of the
/// points. All points are in the volume afterwards.
pub(crate) fn put_on_border(
    slice: &Slice,
    line: &mut Line,
    ends: [Option<Point>; 2],
    spacing: f64,
) {
    for end in ends {
        line.points.reverse();
        line.thickness.reverse();
        if let Some(end) = end.filter(|_| line.points.len() > 1) {
            put_last_on_border(slice, line, end, spacing);
        }
    }
    for p in &mut line.points {
        *p = slice.clamp(*p);
    }
}

/// As [`put_on_border`] for the last point, which was at `end`.
fn put_last_on_border(slice: &Slice, line: &mut Line, end: Point, spacing: f64) {
    let Line {
        points, thickness, ..
    } = line;
    while points.len() > 2 && !slice.inside(points[points.len() - 2]) {
        points.pop();
        thickness.pop();
    }
    let last = points.len() - 1;
    if !slice.inside(points[last]) {
        points[last] = slice.way_out(points[last - 1], points[last]);
        if last > 1 && distance(points[last - 1], points[last]) < SHORTEST * spacing {
            points.remove(last - 1);
            thickness.remove(last - 1);
        }
        return;
    }
    let (back, from) = (points[last.saturating_sub(BACK)], points[last]);
    let length = distance(back, from).max(1e-12);
    let way = [(from[0] - back[0]) / length, (from[1] - back[1]) / length];
    let far = FARTHEST * spacing;
    let beyond = [from[0] + far * way[0], from[1] + far * way[1]];
    if slice.inside(beyond) {
        points[last] = end;
        return;
    }
    let met = slice.way_out(from, beyond);
    let count = (distance(from, met) / spacing + 1.0 - NEAREST) as usize;
    if count == 0 {
        points[last] = met;
    }
    for k in 1..=count {
        let share = k as f64 / count as f64;
        points.push([0, 1].map(|a| from[a] + share * (met[a] - from[a])));
        thickness.push(thickness[last]);
    }
}
