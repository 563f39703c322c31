//! Putting the points of a line midway between both faces of the label.
//!
//! A Gaussian as wide as half the sheet leaves its crest a little off the middle where the sheet is
//! bent, or thicker on one side, and where a border of the volume cuts off one face. What is left is
//! measured, as half the difference of the distances to both faces, and averaged along the line.
//! Faces are known to about a voxel, so that a small average says nothing and is left alone.

use crate::slice::{Point, Slice};
use crate::thickness::View;
use crate::trace::Trace;

/// Sheets thinner than this many work units have a crest that is exact, within the volume and at
/// its border.
const LEAST_THICKNESS: f64 = 5.0;
const LEAST_AT_BORDER: f64 = 2.5;
/// An average below this is within the uncertainty of the faces, work units.
const UNCERTAIN: f64 = 0.06;
/// No point moves by more, work units.
const MOST: f64 = 1.5;
/// Standard deviation of the average, in points, within the volume and at its border, where the
/// error fades over a few voxels.
const SIGMA: f64 = 4.0;
const SIGMA_AT_BORDER: f64 = 1.5;
/// Sheet fraction below which the faces seen may be the rim's.
const RIM: f64 = 0.9;

/// Moves the points of `line`, from which `views` have been taken, to the middle.
pub(crate) fn centre(slice: &Slice, line: &mut Trace, views: &[Option<View>]) {
    let moves: Vec<Option<Point>> = views
        .iter()
        .zip(&line.points)
        .map(|(view, &p)| needed_move(slice, view.as_ref()?, p))
        .collect();
    for (i, view) in views.iter().enumerate() {
        let at_border = view.as_ref().is_some_and(|view| view.at_border);
        let sigma = if at_border { SIGMA_AT_BORDER } else { SIGMA };
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
            line.points[i] = slice.clamp([p[0] + scale * mean[0], p[1] + scale * mean[1]]);
        }
    }
}

/// The move within the slice that brings a point to the middle; normals have no sign of their own,
/// so that moves can be averaged and offsets cannot.
fn needed_move(slice: &Slice, view: &View, p: Point) -> Option<Point> {
    let least = if view.at_border {
        LEAST_AT_BORDER
    } else {
        LEAST_THICKNESS
    };
    let measured = view.to_middle.filter(|_| view.thickness >= least)?;
    if slice.fraction.value(p, slice.z) < RIM {
        return None;
    }
    let [x, y, _] = view.normal;
    // A point on the volume's border stays on it.
    let on_border = slice.on_border(p);
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
