//! The triangles of a mesh, to be asked for those near a point.

use rstar::primitives::CachedEnvelope;
use rstar::{PointDistance, RTree, RTreeObject, AABB};

use crate::vector::{cross, dot, length, scale, sub, Vec3};

/// A triangle in a tree.
pub(crate) struct Leaf {
    pub corners: [Vec3; 3],
}

impl RTreeObject for Leaf {
    type Envelope = AABB<Vec3>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(&self.corners)
    }
}

impl PointDistance for Leaf {
    fn distance_2(&self, p: &Vec3) -> f64 {
        distance_to_triangle(*p, &self.corners).powi(2)
    }
}

pub(crate) fn triangle_tree(triangles: &[[Vec3; 3]]) -> RTree<CachedEnvelope<Leaf>> {
    let leaf = |&corners: &[Vec3; 3]| CachedEnvelope::new(Leaf { corners });
    RTree::bulk_load(triangles.iter().map(leaf).collect())
}

/// Exact distance of a point from a triangle with an area: from its plane where the foot lies
/// inside, else from the nearest edge.
pub fn distance_to_triangle(p: Vec3, t: &[Vec3; 3]) -> f64 {
    let normal = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let inside = (0..3).all(|i| {
        let edge = sub(t[(i + 1) % 3], t[i]);
        dot(cross(edge, sub(p, t[i])), normal) >= 0.0
    });
    if inside {
        return dot(sub(p, t[0]), normal).abs() / length(normal);
    }
    (0..3)
        .map(|i| distance_to_segment(p, t[i], t[(i + 1) % 3]))
        .fold(f64::INFINITY, f64::min)
}

fn distance_to_segment(p: Vec3, a: Vec3, b: Vec3) -> f64 {
    let (ap, ab) = (sub(p, a), sub(b, a));
    let t = (dot(ap, ab) / dot(ab, ab)).clamp(0.0, 1.0);
    length(sub(ap, scale(t, ab)))
}
