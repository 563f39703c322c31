//! Where sheets meet along a line: how near does each of them reach?

use crate::accuracy::spread;
use crate::phantom::{Frame, Junction};
use crate::triangle_shape::area;
use crate::vector::{add, cross, dot, length, scale, sub, unit, Vec3};

/// A triangle belongs to a sheet where its normal is at most 30° off the sheet's.
const ALIKE: f64 = 0.866;

/// And where it lies no farther from the sheet than this, voxels.
const NEAR: f64 = 0.75;

/// The ends of the line that are nearer to the border than this, voxels, are not looked at.
const MARGIN: f64 = 4.0;

/// The widest gap between the junction's line and any of its sheets, in voxels; infinite where a
/// sheet is not there at all. Looked at in steps of one voxel along the line.
pub(crate) fn widest_gap(triangles: &[[Vec3; 3]], junction: &Junction, frame: &Frame) -> f64 {
    let unit_length = frame.unit();
    let along = unit(junction.along);
    let place = |step: i64| add(junction.point, scale(step as f64 * unit_length, along));
    let is_inside = |step: &i64| frame.from_border(place(*step)) >= MARGIN * unit_length;
    let end = |way: i64| (0..10_000).take_while(|s| is_inside(&(way * s))).count() as i64;
    let (first, last) = (1 - end(-1), end(1) - 1);
    if last < first {
        return f64::INFINITY;
    }
    let gaps = junction.sheets.iter().map(|&sheet| {
        // Least distance from the line in each step; one step more at both ends.
        let mut nearest = vec![f64::INFINITY; (last - first + 3) as usize];
        for p in points_of_sheet(triangles, junction, sheet, unit_length) {
            let d = sub(p, junction.point);
            let t = dot(d, along);
            let step = (t / unit_length).round() as i64 - first + 1;
            if let Some(entry) = usize::try_from(step).ok().and_then(|s| nearest.get_mut(s)) {
                *entry = entry.min(length(sub(d, scale(t, along))) / unit_length);
            }
        }
        let steps = nearest.windows(3);
        steps.map(|w| w[0].min(w[1]).min(w[2])).fold(0.0, f64::max)
    });
    gaps.fold(0.0, f64::max)
}

/// Points on the triangles that belong to a sheet, which runs from the line towards `sheet`.
fn points_of_sheet<'a>(
    triangles: &'a [[Vec3; 3]],
    junction: &'a Junction,
    sheet: Vec3,
    unit_length: f64,
) -> impl Iterator<Item = Vec3> + 'a {
    let sheet = unit(sheet);
    let normal = unit(cross(junction.along, sheet));
    let alike = triangles.iter().filter(move |t| {
        let own = unit(cross(sub(t[1], t[0]), sub(t[2], t[0])));
        dot(own, normal).abs() > ALIKE
    });
    let points = alike.flat_map(move |t| {
        let count = (8.0 * area(t) / (unit_length * unit_length)).ceil() as usize;
        spread(t, count).chain(*t)
    });
    points.filter(move |&p| {
        let d = sub(p, junction.point);
        dot(d, normal).abs() <= NEAR * unit_length && dot(d, sheet) > -NEAR * unit_length
    })
}
