//! Following a ridge line through a slice.
//!
//! The ridge direction is the eigenvector of least curvature of the ridge field's Hessian in the
//! slice: a line field without a sign, turned where it would go back by more than 90°. A midpoint
//! step along it is corrected by a golden-section search across it (MidSurfer, section
//! "Mid-Polyline Extraction"). A line ends where it closes, leaves the volume, meets another line,
//! leaves the label dilated by a pixel, or where the sheet fraction says that the sheet ends.

use crate::slice::{Point, Slice, LINE};

/// Step of the trace, in units of the finest spacing of the slice: half the distance of the
/// points that are kept, so that the trace follows tight folds.
const STEP: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Reach of the search across the line, in the same units.
const REACH: f64 = 0.75;
/// A line does not look for other lines during its first steps, nor see its own last ones.
const LAG: usize = 6;

/// A traced line and whether it is closed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    pub points: Vec<Point>,
    pub closed: bool,
}

/// Why a line ended.
#[derive(PartialEq)]
enum End {
    Closed,
    Open,
}

/// Traces the line through `start`, in both directions unless it closes. At most `limit` steps.
pub(crate) fn trace(slice: &mut Slice, start: Point, component: u32, limit: usize) -> Option<Trace> {
    let (start, direction) = on_ridge(slice, start)?;
    if !slice.inside(start) || !is_sheet(slice, start, direction) {
        return None;
    }
    let (mut points, end) = follow(slice, start, direction, component, limit);
    if end == End::Closed {
        return Some(Trace { points, closed: true });
    }
    let back = [-direction[0], -direction[1]];
    let (other, _) = follow(slice, start, back, component, limit);
    points.reverse();
    points.extend(&other[1..]);
    Some(Trace { points, closed: false })
}

/// The step of a trace in work units.
fn step(slice: &Slice) -> f64 {
    STEP * slice.h()[0].min(slice.h()[1])
}

/// Direction of least curvature, and whether the field falls off across it.
fn ridge_direction(slice: &Slice, p: Point) -> (Point, bool) {
    let [xx, xy, yy] = slice.ridge.planar(p, slice.z).hessian;
    let mean = 0.5 * (xx + yy);
    let spread = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
    let falls = mean - spread < 0.0;
    // The eigenvector of the larger eigenvalue; of the two ways to write it, the longer one.
    let larger = mean + spread;
    let (a, b) = ([larger - yy, xy], [xy, larger - xx]);
    let v = if a[0] * a[0] + a[1] * a[1] >= b[0] * b[0] + b[1] * b[1] { a } else { b };
    let length = v[0].hypot(v[1]);
    if length > 0.0 {
        ([v[0] / length, v[1] / length], falls)
    } else {
        ([1.0, 0.0], falls)
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

/// Moves a point near a ridge onto it; gives the ridge's direction there too.
fn on_ridge(slice: &Slice, mut p: Point) -> Option<(Point, Point)> {
    let mut direction = ridge_direction(slice, p);
    for _ in 0..4 {
        p = crest(slice, p, direction.0);
        direction = ridge_direction(slice, p);
    }
    direction.1.then_some((p, direction.0))
}

/// The maximum of the ridge field across `direction`, by golden-section search.
pub(crate) fn crest(slice: &Slice, p: Point, direction: Point) -> Point {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let reach = REACH * slice.h()[0].min(slice.h()[1]);
    let at = |t: f64| [p[0] - t * direction[1], p[1] + t * direction[0]];
    let value = |t: f64| slice.ridge.value(at(t), slice.z);
    let (mut low, mut high) = (-reach, reach);
    let mut inner = [high - RATIO * (high - low), low + RATIO * (high - low)];
    let mut values = [value(inner[0]), value(inner[1])];
    // 16 rounds leave 5e-4 of the interval.
    for _ in 0..16 {
        if values[0] > values[1] {
            high = inner[1];
            inner = [high - RATIO * (high - low), inner[0]];
            values = [value(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + RATIO * (high - low)];
            values = [values[1], value(inner[1])];
        }
    }
    at(0.5 * (low + high))
}

/// Whether the sheet is there: the sheet fraction is at least ½ at the point, or half a slice
/// towards a neighbouring slice, where a sheet ending between two slices is rounded to.
fn is_sheet(slice: &Slice, p: Point, direction: Point) -> bool {
    let own = slice.fraction.value(p, slice.z);
    if own >= 0.5 {
        return true;
    }
    let [hx, hy, hz] = slice.h();
    let last = slice.ridge.directory.dimensions[2] - 1;
    let across = |z: usize| {
        // A sheet tilted by up to 60° from upright has moved sideways by up to √3 slices.
        (-4..=4).map(|k| 0.45 * hz.max(hx.min(hy)) * f64::from(k)).any(|t| {
            let q = [p[0] - t * direction[1], p[1] + t * direction[0]];
            0.5 * (own + slice.fraction.value(q, z)) >= 0.5
        })
    };
    (slice.z > 0 && across(slice.z - 1)) || (slice.z < last && across(slice.z + 1))
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
        let (ahead, falls) = ridge_direction(slice, middle);
        let ahead = turned(ahead, v);
        let predicted = [p[0] + step * ahead[0], p[1] + step * ahead[1]];
        let q = crest(slice, predicted, ahead);
        if i > 2 && closes(p, q, start, direction, step) {
            return (points, End::Closed);
        }
        if !slice.inside(q) {
            points.push(to_border(slice, p, q));
            break;
        }
        let pixel = slice.pixel(q);
        if !falls || !slice.near(pixel, component) || (i > LAG && slice.has(pixel, LINE)) {
            break;
        }
        let moved = [q[0] - p[0], q[1] - p[1]];
        let length = moved[0].hypot(moved[1]);
        if length < 0.2 * step {
            break;
        }
        if !is_sheet(slice, q, ahead) {
            points.push(to_rim(slice, p, q, ahead));
            break;
        }
        points.push(q);
        v = turned([moved[0] / length, moved[1] / length], ahead);
        p = q;
        if points.len() > LAG {
            let behind = slice.pixel(points[points.len() - 1 - LAG]);
            slice.set(behind, LINE);
        }
    }
    for &point in &points[points.len().saturating_sub(LAG)..] {
        let pixel = slice.pixel(point);
        slice.set(pixel, LINE);
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

/// Where the sheet ends between p, on it, and q, off it.
fn to_rim(slice: &Slice, p: Point, q: Point, direction: Point) -> Point {
    bisect(p, q, |m| is_sheet(slice, m, direction))
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
