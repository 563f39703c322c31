//! Along the boundary of a surface, and out of the surface there.

use crate::grid::{along, sub, Vec3};
use crate::surface::halfedge::{ends, previous, Fans, NONE};
use crate::surface::manifold::Surface;

/// The points before and after a point of the boundary.
pub(crate) fn beside(surface: &Surface, fans: &Fans, p: u32) -> [Option<u32>; 2] {
    let triangles = &surface.triangles;
    let is_side = |&e: &u32| fans.twin(triangles, e) == NONE;
    let leaving = || fans.of(p).iter().copied();
    let before = leaving().map(previous).find(is_side);
    let after = leaving().find(is_side);
    [
        before.map(|e| ends(triangles, e).0),
        after.map(|e| ends(triangles, e).1),
    ]
}

/// Away from the two rings of points around a point: out of the surface at its boundary.
pub(crate) fn away(surface: &Surface, fans: &Fans, p: u32) -> Vec3 {
    let around = |p: u32| {
        let corners = fans.of(p).iter();
        corners.flat_map(|&e| surface.triangles[e as usize / 3])
    };
    let from = surface.points[p as usize];
    let step = |way, q: u32| along(way, 1.0, sub(from, surface.points[q as usize]));
    around(p).flat_map(around).fold([0.0; 3], step)
}
