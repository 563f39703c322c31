//! What a triangle looks like.

use super::patch::Patch;
use crate::grid::{cross, dot, sub, Vec3};

/// Least cosine between a triangle's normal and the reference's at its corners, 60°.
const FACING: f64 = 0.5;

/// Square of the sine of a triangle's smallest angle; 0 where it has no area.
pub(super) fn squared_sine([a, b, c]: [Vec3; 3]) -> f64 {
    // Twice the area is the product of the two longer sides and the sine between them.
    let (ab, ac, bc) = (sub(b, a), sub(c, a), sub(c, b));
    let [u, v, w] = [ab, ac, bc].map(|side| dot(side, side));
    let product = (u * v).max(v * w).max(w * u);
    if product > 0.0 {
        let area = cross(ab, ac);
        dot(area, area) / product
    } else {
        0.0
    }
}

/// Sine of a triangle's smallest angle; 0 where it has no area.
pub(crate) fn sine_of_smallest_angle(corners: [Vec3; 3]) -> f64 {
    squared_sine(corners).sqrt()
}

/// Whether a triangle of these corners, placed so, looks where the surface looks there.
pub(super) fn facing(patch: &Patch, corners: [u32; 3], place: [Vec3; 3]) -> bool {
    let area = area(place);
    let normal = |p: u32| patch.vertices[p as usize].normal();
    corners.iter().all(|&p| looks(area, normal(p)))
}

/// Whether a triangle looks about where a unit normal does.
pub(super) fn faces(corners: [Vec3; 3], normal: Vec3) -> bool {
    looks(area(corners), normal)
}

/// The normal of a triangle, as long as twice its area.
fn area([a, b, c]: [Vec3; 3]) -> Vec3 {
    cross(sub(b, a), sub(c, a))
}

fn looks(area: Vec3, normal: Vec3) -> bool {
    let height = dot(area, normal);
    height > 0.0 && height * height > FACING * FACING * dot(area, area)
}
