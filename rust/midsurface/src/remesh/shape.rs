//! What a triangle looks like.

use super::patch::Patch;
use crate::grid::{cross, dot, length, squared_distance, sub, Vec3};

/// Least cosine between a triangle's normal and the reference's at its corners, 60°.
const FACING: f64 = 0.5;

/// Sine of a triangle's smallest angle; 0 where it has no area.
pub(super) fn sine_of_smallest_angle([a, b, c]: [Vec3; 3]) -> f64 {
    // Twice the area is the product of the two longer sides and the sine between them.
    let [u, v, w] = [
        squared_distance(b, c),
        squared_distance(c, a),
        squared_distance(a, b),
    ];
    let product = (u * v).max(v * w).max(w * u);
    if product > 0.0 {
        let area = cross(sub(b, a), sub(c, a));
        (dot(area, area) / product).sqrt()
    } else {
        0.0
    }
}

/// Whether a triangle of these corners, placed so, looks where the surface looks there.
pub(super) fn facing(patch: &Patch, corners: [u32; 3], [a, b, c]: [Vec3; 3]) -> bool {
    let normal = cross(sub(b, a), sub(c, a));
    let least = FACING * length(normal);
    corners
        .iter()
        .all(|&p| dot(normal, patch.vertices[p as usize].normal()) > least)
}
