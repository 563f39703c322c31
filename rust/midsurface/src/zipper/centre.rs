//! Putting the points of a line midway between both faces of the label.
//!
//! A Gaussian as wide as half the sheet leaves its crest a little off the middle where the sheet is
//! bent, or thicker on one side, and where a border of the volume cuts off one face. What is left is
//! measured, as half the difference of the distances to both faces, and averaged along the line.
//! Faces are known to about a voxel, so that a small average says nothing and is left alone.

use crate::fields::thickness::View;
use crate::zipper::slice::{Point, Slice};
use crate::zipper::trace::Trace;

/// Sheets thinner than this many work units have a crest that is exact, within the volume and at
/// its border.
const LEAST_THICKNESS: f64 = 5.0;
const LEAST_AT_BORDER: f64 = 2.5;
/// An average below this is within the uncertainty of the faces, work units.
const UNCERTAIN: f64 = 0.06;
/// No point moves by more, work units.
const MOST: f64 = 1.5;
/// Standard deviation of the average, in points, within the volume and at its border, where the
/// error fades over a few voxels: over more points, the smaller the angle at which the line comes near
/// the border, but no more than within the volume.
const SIGMA: f64 = 4.0;
const SIGMA_AT_BORDER: f64 = 1.0;
/// Sheet fraction below which the faces seen may be the rim's.
const RIM: f64 = 0.9;

/// The points that are moved.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Which {
    All,
    AtBorder,
}

/// Points with both faces in view that tell one with a single face how thick the sheet is.
const WITNESSES: usize = 9;

/// In a corner of the volume no line across the sheet sees both faces. Where one is seen, the
/// middle is half a thickness from it: that of the nearest points of the line that see both.
pub(crate) fn complete(views: &mut [Option<View>]) {
    let thickness: Vec<(usize, f64)> = views
        .iter()
        .enumerate()
        .filter_map(|(i, view)| view.as_ref().map(|view| (i, view)))
        .filter(|(_, view)| view.to_middle.is_some())
        .map(|(i, view)| (i, view.thickness))
        .collect();
    for (i, view) in views.iter_mut().enumerate() {
        let Some((view, face)) = view.as_mut().and_then(|v| v.one_face.map(|face| (v, face)))
        else {
            continue;
        };
        let after = thickness.partition_point(|(at, _)| *at < i);
        let first = after.saturating_sub(WITNESSES / 2 + 1);
        let last = (first + WITNESSES).min(thickness.len());
        let mut near: Vec<f64> = thickness[last.saturating_sub(WITNESSES)..last]
            .iter()
            .map(|(_, thick)| *thick)
            .collect();
        if near.is_empty() {
            continue;
        }
        let middle = near.len() / 2;
        view.thickness = *near.select_nth_unstable_by(middle, f64::total_cmp).1;
        view.to_middle = Some(face - (0.5 * view.thickness).copysign(face));
    }
}

/// Moves the points of `line`, from which `views` have been taken, to the middle. That may be
/// beyond the border of the volume, or off it for an end on it: `ends.rs` sees to that.
pub(crate) fn centre(slice: &Slice, line: &mut Trace, views: &[Option<View>], which: Which) {
    let last = line.points.len().saturating_sub(1);
    let is_end = |i: usize| !line.closed && (i == 0 || i == last);
    let moves: Vec<Option<Point>> = views
        .iter()
        .zip(&line.points)
        .enumerate()
        .map(|(i, (view, &p))| needed_move(slice, view.as_ref()?, slice.clamp(p), is_end(i)))
        .collect();
    let tangents: Vec<Point> = (0..line.points.len()).map(|i| line.tangent(i)).collect();
    for (i, view) in views.iter().enumerate() {
        let at_border = view.as_ref().is_some_and(View::at_border);
        if which == Which::AtBorder && !at_border {
            continue;
        }
        let sigma = match view {
            Some(view) if at_border => sigma_at_border(&tangents[i], view.near_border),
            _ => SIGMA,
        };
        // In a corner of the volume no line sees both faces: what its neighbours need is taken.
        let missing = at_border && moves[i].is_none();
        if let Some(mean) = average(
            &moves,
            i,
            line.closed,
            if missing { SIGMA } else { sigma },
            missing,
        ) {
            let length = (mean[0] * mean[0] + mean[1] * mean[1]).sqrt();
            let scale = (length - UNCERTAIN).clamp(0.0, MOST) / length.max(1e-12);
            let p = line.points[i];
            line.points[i] = [p[0] + scale * mean[0], p[1] + scale * mean[1]];
        }
    }
}

/// Standard deviation of the average at the borders that are near, for a line with this tangent.
fn sigma_at_border(tangent: &Point, near_border: [bool; 3]) -> f64 {
    let towards = |a: usize| {
        if near_border[a] {
            tangent[a].abs()
        } else {
            0.0
        }
    };
    let fastest = towards(0).max(towards(1));
    (SIGMA_AT_BORDER / fastest.max(SIGMA_AT_BORDER / SIGMA)).min(SIGMA)
}

/// The move within the slice that brings a point to the middle; normals have no sign of their own,
/// so that moves can be averaged and offsets cannot.
fn needed_move(slice: &Slice, view: &View, p: Point, is_end: bool) -> Option<Point> {
    let least = if view.at_border() {
        LEAST_AT_BORDER
    } else {
        LEAST_THICKNESS
    };
    let measured = view.to_middle.filter(|_| view.thickness >= least)?;
    if slice.fraction.value(p, slice.z) < RIM {
        return None;
    }
    let [x, y, _] = view.normal;
    // A line along the volume's border stays on it.
    let on_border = slice.on_border(p).map(|on| on && !is_end);
    let across = [
        if on_border[0] { 0.0 } else { x },
        if on_border[1] { 0.0 } else { y },
    ];
    let within = across[0] * across[0] + across[1] * across[1];
    (within > 0.05).then(|| across.map(|v| v * measured / within))
}

/// Gaussian mean of the moves around point i, where unknown moves count as none unless `known_only`;
/// `None` where too few are known.
fn average(
    moves: &[Option<Point>],
    i: usize,
    closed: bool,
    sigma: f64,
    known_only: bool,
) -> Option<Point> {
    let n = moves.len() as isize;
    let window = (2.0 * sigma).ceil() as isize;
    let (mut sum, mut total, mut possible) = ([0.0; 2], 0.0, 0.0);
    for offset in -window..=window {
        let at = i as isize + offset;
        let at = if closed { at.rem_euclid(n) } else { at };
        if !(0..n).contains(&at) {
            continue;
        }
        let weight = (-0.5 * (offset as f64 / sigma).powi(2)).exp();
        possible += weight;
        if let Some(step) = moves[at as usize] {
            sum = [sum[0] + weight * step[0], sum[1] + weight * step[1]];
            total += weight;
        }
    }
    let weight = if known_only { total } else { possible };
    (total > 0.3 * possible).then(|| sum.map(|v| v / weight))
}
