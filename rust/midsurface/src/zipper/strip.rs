//! Triangulating a strip between two lines.

use crate::grid::{squared_distance, Vec3};
use crate::zipper::zip::SAME;

/// The points of one side of a strip, in order.
pub(crate) type Side = Vec<u32>;

/// Triangles between two sides that run the same way. At every step the shorter of the two
/// diagonals is taken, which is the one that splits the larger angle.
pub(crate) fn triangulate(points: &[Vec3], below: &Side, above: &Side) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(below.len() + above.len());
    let diagonal =
        |i: usize, j: usize| squared_distance(points[below[i] as usize], points[above[j] as usize]);
    let (mut i, mut j) = (0, 0);
    while i + 1 < below.len() || j + 1 < above.len() {
        let advance_below = match (i + 1 < below.len(), j + 1 < above.len()) {
            (true, true) => diagonal(i + 1, j) <= diagonal(i, j + 1) * (1.0 + SAME),
            (can, _) => can,
        };
        if advance_below {
            triangles.push([below[i], below[i + 1], above[j]]);
            i += 1;
        } else {
            triangles.push([below[i], above[j + 1], above[j]]);
            j += 1;
        }
    }
    triangles
}
