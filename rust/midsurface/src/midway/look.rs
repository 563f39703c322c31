//! Surface → how far off the middle of the label its points are.
//!
//! A point looks along its normal both ways, and is off by half the difference of what it finds.
//! Where a leaning sheet leaves the volume it finds one face only. Parallel to the border there may be
//! another, but where the sheet bends the middle of such a line is not on the mid-surface. Instead
//! the sheet is taken to be as thick there as it is, on average, where the points next to it along the
//! surface find both faces: the middle is half of that from the face that is found.

use crate::error::{collected, filled, zeros, Result};
use crate::execution::Execution;
use crate::fields::label::Label;
use crate::grid::Vec3;
use crate::surface::halfedge::Fans;
use crate::surface::manifold::Surface;
use crate::surface::region::Region;

/// Sheet fraction below which the faces seen may be a rim's.
const INSIDE: f64 = 0.7;
/// Below this sheet fraction a rim is near, with few points to average over.
pub(crate) const WHOLE: f64 = 0.95;
/// and so is the border of the volume here, work units.
pub(crate) const AT_BORDER: f64 = 4.0;
/// From how many rings of points around those that find one face the thickness comes, and how often
/// it is averaged to get to all of them.
const RINGS: usize = 6;
const ROUNDS: usize = 24;
/// Less of a thickness than this has come to a point: none.
const LEAST: f64 = 1e-6;
/// Points handed to a worker at a time.
const PIECE: usize = 1024;

/// A figure times how much it counts, and how much that is.
pub(crate) type Seen = [f32; 2];

/// How far from a point the faces are, along its normal and against it: infinitely where the border of
/// the volume comes first; no numbers for a point that does not look.
type Faces = [f32; 2];

/// How far off the points of a surface are that look: up to `most`, and one in so many where no rim
/// is near. `fraction` is the sheet fraction at the points.
pub(crate) fn look(
    label: &Label,
    (surface, fraction): (&Surface, &[f64]),
    normals: &[Vec3],
    fans: &Fans,
    (most, one_in): (f64, u8),
    execution: &mut Execution,
) -> Result<Vec<Seen>> {
    // One that looks in place of others counts for them too.
    let is_alone = |p: usize| fraction[p] < WHOLE || label.depth(surface.points[p]) < AT_BORDER;
    let stands_for = |p: usize| if is_alone(p) { 1 } else { one_in };
    let mut faces: Vec<Faces> = filled([f32::NAN; 2], surface.points.len())?;
    execution.fill(&mut faces, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let p = PIECE * piece + i;
            let point = surface.points[p];
            if fraction[p] >= INSIDE && is_one_in(stands_for(p), point, label.h) {
                if let Some(found) = label.faces(surface.source[p], point, normals[p]) {
                    *out = found.map(|face| face as f32);
                }
            }
        }
    })?;
    let weight = |p: usize| f32::from(stands_for(p));
    let weighted = |p: usize, value: f32| [weight(p) * value, weight(p)];
    let is_near = |off: &f32| off.abs() <= most as f32;
    let off = |p: usize| Some(0.5 * (faces[p][0] - faces[p][1])).filter(is_near);
    let mut seen: Vec<Seen> = zeros(faces.len())?;
    for (p, seen) in seen.iter_mut().enumerate() {
        if let Some(off) = off(p) {
            *seen = weighted(p, off);
        }
    }
    let thickness = |p: usize| match off(p) {
        Some(_) => weighted(p, faces[p][0] + faces[p][1]),
        None => [0.0; 2],
    };
    for (p, thickness) in thickness_beside(&faces, thickness, (&surface.triangles, fans))? {
        let [ahead, behind] = faces[p as usize];
        let half = 0.5 * thickness;
        let off = if behind.is_finite() {
            half - behind
        } else {
            ahead - half
        };
        if is_near(&off) {
            seen[p as usize] = weighted(p as usize, off);
        }
    }
    Ok(seen)
}

/// The points that find one face, each with how thick the sheet is beside them, from the `thickness`
/// where points find both.
fn thickness_beside(
    faces: &[Faces],
    thickness: impl Fn(usize) -> Seen,
    surface: (&[[u32; 3]], &Fans),
) -> Result<Vec<(u32, f32)>> {
    let is_single = |p: &u32| {
        let [ahead, behind] = faces[*p as usize];
        ahead.is_finite() && behind == f32::INFINITY || behind.is_finite() && ahead == f32::INFINITY
    };
    let singles = collected((0..faces.len() as u32).filter(is_single))?;
    if singles.is_empty() {
        return Ok(Vec::new());
    }
    let count = singles.len();
    let region = Region::new(singles, RINGS, faces.len(), surface)?;
    let own = region
        .points
        .iter()
        .map(|&p| thickness(p as usize).map(f64::from));
    let found = region.average(collected(own)?, ROUNDS)?;
    let found = region.points[..count].iter().zip(found);
    let found = found.filter(|(_, [_, weight])| *weight > LEAST);
    collected(found.map(|(&p, [sum, weight])| (p, (sum / weight) as f32)))
}

/// Whether a point is one in so many, which its voxel alone decides: by a multiplicative hash (Knuth),
/// since anything regular would leave out whole sheets of one direction.
fn is_one_in(one_in: u8, p: Vec3, h: Vec3) -> bool {
    let hash = (0..3).fold(0u64, |hash, a| {
        (hash ^ (p[a] / h[a]) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    });
    (hash >> 32) % u64::from(one_in) == 0
}

/// Mean of what is seen at a point and around it.
pub(crate) fn mean(here: Seen, around: impl Iterator<Item = Seen>) -> Seen {
    let (mut sum, mut count) = (here, 1.0);
    for [value, weight] in around {
        sum = [sum[0] + value, sum[1] + weight];
        count += 1.0;
    }
    sum.map(|v| v / count)
}
