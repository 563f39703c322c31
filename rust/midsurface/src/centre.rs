//! Putting the points of a line midway between both faces of the label.
//!
//! A Gaussian as wide as half the sheet leaves its crest a little off the middle where the sheet is
//! bent, or thicker on one side. What is left is measured, as half the difference of the distances
//! to both faces, and averaged along the line. Faces are known to about a voxel, so that a small
//! average says nothing and is left alone.

use crate::slice::Slice;
use crate::thickness::Faces;
use crate::trace::Trace;

/// Sheets thinner than this many work units have a crest that is exact.
const LEAST_THICKNESS: f64 = 5.0;
/// An average below this is within the uncertainty of the faces, work units.
const UNCERTAIN: f64 = 0.06;
/// No point moves by more, work units.
const MOST: f64 = 1.0;
/// Points on either side that an average takes in, and its standard deviation in points.
const WINDOW: usize = 8;
const SIGMA: f64 = 4.0;
/// Sheet fraction below which the faces seen may be the rim's.
const RIM: f64 = 0.9;

/// Moves the points of `line`, whose `faces` have been measured, to the middle.
pub(crate) fn centre(slice: &Slice, line: &mut Trace, faces: &[Option<Faces>]) {
    let n = line.points.len();
    let measured: Vec<Option<f64>> = (0..n)
        .map(|i| {
            let faces = faces[i].filter(|faces| faces.thickness() >= LEAST_THICKNESS)?;
            let inside = slice.fraction.value(line.points[i], slice.z) >= RIM;
            faces.to_middle().filter(|_| inside)
        })
        .collect();
    // Normals have no sign of their own, so offsets are compared as moves within the slice.
    let moves: Vec<Option<[f64; 2]>> = (0..n)
        .map(|i| {
            let (normal, _) = slice.sheet(line.points[i])?;
            let within = normal[0] * normal[0] + normal[1] * normal[1];
            let scale = measured[i]? / within.max(0.05);
            Some([scale * normal[0], scale * normal[1]])
        })
        .collect();
    for i in 0..n {
        let (mut sum, mut total, mut possible) = ([0.0; 2], 0.0, 0.0);
        for offset in -(WINDOW as isize)..=WINDOW as isize {
            let at = i as isize + offset;
            let at = if line.closed { at.rem_euclid(n as isize) } else { at };
            let weight = (-0.5 * (offset as f64 / SIGMA).powi(2)).exp();
            possible += weight;
            let known = usize::try_from(at).ok().and_then(|at| *moves.get(at)?);
            if let Some(step) = known {
                sum = [sum[0] + weight * step[0], sum[1] + weight * step[1]];
                total += weight;
            }
        }
        if total > 0.3 * possible {
            let mean = [sum[0] / possible, sum[1] / possible];
            let length = mean[0].hypot(mean[1]);
            let scale = (length - UNCERTAIN).clamp(0.0, MOST) / length.max(1e-12);
            line.points[i][0] += scale * mean[0];
            line.points[i][1] += scale * mean[1];
        }
    }
}
