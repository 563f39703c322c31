//! Following a ridge line through a slice.
//!
//! The line runs across the sheet's normal within the slice. That is a line field without a sign,
//! turned where it would go back by more than 90°. A midpoint step is corrected by moving across the
//! line onto the crest (MidSurfer, section "Mid-Polyline Extraction"; in place of the slice's own
//! Hessian and a search for the maximum, the normal and the offset come from `sheets/sheet.rs`, so that
//! neither a slope within the sheet nor a neighbouring rim bends the line). A line ends where it
//! closes, leaves the volume, meets another line, leaves the label dilated by a pixel, or where the
//! sheet fraction says that the sheet ends.

use crate::grid::Vec3;
use crate::zipper::resample::distance;
use crate::zipper::slice::{Point, Slice, LINE, TRACED};

/// Step of the trace, in units of the finest spacing of the slice: half the distance of the
/// points that are kept, so that the trace follows tight folds.
const STEP: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// The largest move across the line at once, in the same units.
const REACH: f64 = 0.75;
/// Where the normal's part within the slice is smaller, the sheet lies flat: no line.
const FLAT: f64 = 0.06;
/// A line does not see its own first and last steps.
const LAG: usize = 6;

/// A traced line and whether it is closed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    pub points: Vec<Point>,
    pub closed: bool,
}

impl Trace {
    /// Unit tangent at point i.
    pub fn tangent(&self, i: usize) -> Point {
        let n = self.points.len();
        let (before, after) = if self.closed {
            ((i + n - 1) % n, (i + 1) % n)
        } else {
            (i.saturating_sub(1), (i + 1).min(n - 1))
        };
        let (a, b) = (self.points[before], self.points[after]);
        let length = distance(a, b).max(1e-12);
        [(b[0] - a[0]) / length, (b[1] - a[1]) / length]
    }
}

/// Why a line ended.
#[derive(PartialEq)]
enum End {
    Closed,
    Open,
}

/// Traces the line through `start`, in both directions unless it closes. At most `limit` steps.
/// `None` where there is no sheet, or a line already.
pub(crate) fn trace(
    slice: &mut Slice,
    start: Point,
    component: u32,
    limit: usize,
) -> Option<Trace> {
    let start = slice.clamp(crest(slice, start)?);
    let direction = Across::at(slice, start)?.line();
    if slice.has(slice.pixel(start), LINE) || !is_sheet(slice, start) {
        return None;
    }
    let (mut points, end) = follow(slice, start, direction, component, limit);
    let closed = end == End::Closed;
    if !closed {
        let back = [-direction[0], -direction[1]];
        let (other, _) = follow(slice, start, back, component, limit);
        points.reverse();
        points.extend(&other[1..]);
    }
    for &p in &points {
        slice.clear(slice.pixel(p), TRACED);
    }
    Some(Trace { points, closed })
}

/// The step of a trace in work units.
fn step(slice: &Slice) -> f64 {
    STEP * slice.h()[0].min(slice.h()[1])
}

/// Normal of the sheet, its direction and length within the slice, and the offset to the crest;
/// `None` away from a sheet and where it lies flat in the slice.
struct Across {
    normal: Vec3,
    direction: Point,
    length: f64,
    offset: f64,
}

impl Across {
    fn at(slice: &Slice, p: Point) -> Option<Self> {
        let (normal, offset) = slice.sheet(p)?;
        let length = normal[0].hypot(normal[1]);
        (length > FLAT).then(|| Self {
            normal,
            direction: [normal[0] / length, normal[1] / length],
            length,
            offset,
        })
    }

    /// The direction of the line.
    fn line(&self) -> Point {
        [-self.direction[1], self.direction[0]]
    }
}

/// `v`, turned to the side of `along`.
fn turned(v: Point, along: Point) -> Point {
    if v[0] * along[0] + v[1] * along[1] < 0.0 {
        [-v[0], -v[1]]
    } else {
        v
    }
}

/// Moves a point near a sheet onto its crest, across the line. `None` where the sheet is lost.
pub(crate) fn crest(slice: &Slice, mut p: Point) -> Option<Point> {
    let reach = REACH * slice.h()[0].min(slice.h()[1]);
    for _ in 0..6 {
        let across = Across::at(slice, p)?;
        let t = (across.offset / across.length).clamp(-reach, reach);
        p = [
            p[0] + t * across.direction[0],
            p[1] + t * across.direction[1],
        ];
        if t.abs() < 1e-4 * reach {
            break;
        }
    }
    Some(p)
}

/// Whether the sheet is there: the sheet fraction is at least ½ at the point, or half a slice
/// towards a neighbouring slice, where a sheet ending between two slices is rounded to.
fn is_sheet(slice: &Slice, p: Point) -> bool {
    let own = slice.fraction.value(p, slice.z);
    if own >= 0.5 {
        return true;
    }
    let Some(across) = Across::at(slice, p) else {
        return false;
    };
    let last = slice.directory().dimensions[2] - 1;
    // Where the sheet is one slice up, seen from here.
    let shift = -across.normal[2] * slice.h()[2] / across.length;
    let half_way = |z: usize, t: f64| {
        let q = [
            p[0] + t * across.direction[0],
            p[1] + t * across.direction[1],
        ];
        0.5 * (own + slice.fraction.value(q, z)) >= 0.5
    };
    (slice.z > 0 && half_way(slice.z - 1, -shift))
        || (slice.z < last && half_way(slice.z + 1, shift))
}

/// Follows the ridge from `start` along `direction`. The first point is `start`.
fn follow(
    slice: &mut Slice,
    start: Point,
    direction: Point,
    component: u32,
    limit: usize,
) -> (Vec<Point>, End) {
    let step = step(slice);
    let mut points = vec![start];
    let (mut p, mut v) = (start, direction);
    for i in 0..limit {
        let middle = [p[0] + 0.5 * step * v[0], p[1] + 0.5 * step * v[1]];
        let Some(across) = Across::at(slice, middle) else {
            break;
        };
        let ahead = turned(across.line(), v);
        let predicted = [p[0] + step * ahead[0], p[1] + step * ahead[1]];
        let Some(q) = crest(slice, predicted) else {
            break;
        };
        // A sheet may leave through the very edge of the volume, and its line run along that.
        let q = slice.back_inside(q);
        if i > 2 && closes(p, q, start, direction, step) {
            return (points, End::Closed);
        }
        if !slice.inside(q) {
            points.push(to_border(slice, p, q));
            break;
        }
        let pixel = slice.pixel(q);
        // Back at its own start a line goes on until it closes.
        let home = (q[0] - start[0]).hypot(q[1] - start[1]) < 3.0 * step;
        let meets = slice.has(pixel, LINE) || (i > LAG && !home && slice.has(pixel, TRACED));
        if meets || !slice.near(pixel, component) {
            break;
        }
        let moved = [q[0] - p[0], q[1] - p[1]];
        let length = moved[0].hypot(moved[1]);
        if length < 0.2 * step {
            break;
        }
        if !is_sheet(slice, q) {
            points.push(bisect(p, q, |m| is_sheet(slice, m)));
            break;
        }
        points.push(q);
        v = turned([moved[0] / length, moved[1] / length], ahead);
        p = q;
        if points.len() > LAG {
            let behind = slice.pixel(points[points.len() - 1 - LAG]);
            slice.set(behind, TRACED);
        }
    }
    for &point in &points[points.len().saturating_sub(LAG)..] {
        let pixel = slice.pixel(point);
        slice.set(pixel, TRACED);
    }
    (points, End::Open)
}

/// Whether the step from p to q passes the start of the line, the way the line set out.
fn closes(p: Point, q: Point, start: Point, direction: Point, step: f64) -> bool {
    let d = [q[0] - p[0], q[1] - p[1]];
    let s = [start[0] - p[0], start[1] - p[1]];
    let length = d[0].hypot(d[1]);
    let ahead = (s[0] * d[0] + s[1] * d[1]) / length.max(1e-12);
    let aside = (s[0] * d[1] - s[1] * d[0]).abs() / length.max(1e-12);
    let same_way = d[0] * direction[0] + d[1] * direction[1] > 0.0;
    same_way && (0.0..=length).contains(&ahead) && aside < 0.75 * step
}

/// Where the step from p, inside the volume, to q, outside, meets the volume's border.
fn to_border(slice: &Slice, p: Point, q: Point) -> Point {
    bisect(p, q, |m| slice.inside(m))
}

fn bisect(mut p: Point, mut q: Point, holds: impl Fn(Point) -> bool) -> Point {
    for _ in 0..8 {
        let middle = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
        if holds(middle) {
            p = middle;
        } else {
            q = middle;
        }
    }
    p
}
