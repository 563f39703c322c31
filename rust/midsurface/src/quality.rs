//! The figures a mesh is judged by (MidSurfer, section "Mesh quality").

use crate::grid::{cross, dot, length, sub, unit, Vec3};
use crate::halfedge::Edges;
use crate::mesh::Mesh;

/// Shape and valence of a mesh's triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Quality {
    /// Area of all triangles, world units squared.
    pub area: f64,
    /// Smallest Q = (6 / √3) · area / (half the perimeter · longest edge); 1 is equilateral.
    pub smallest: f64,
    /// Mean of Q.
    pub mean: f64,
    /// Mean of each triangle's smallest angle, degrees.
    pub mean_smallest_angle: f64,
    /// Share of angles under 30°, of all angles.
    pub share_under_30: f64,
    /// Share of angles over 120°, of all angles.
    pub share_over_120: f64,
    /// Share of the interior points that have five, six or seven edges.
    pub valence_567: f64,
}

impl Mesh {
    /// Shape and valence of the triangles; all zero for an empty mesh.
    pub fn quality(&self) -> Quality {
        let corners = self
            .triangles
            .iter()
            .map(|t| t.map(|p| self.points[p as usize].map(f64::from)));
        Quality {
            valence_567: valence_567(
                &Edges::new(&self.triangles, self.points.len()),
                self.points.len(),
            ),
            ..Quality::of_shapes(corners)
        }
    }
}

impl Quality {
    /// The figures that need no neighbours, of triangles given by their corners.
    pub(crate) fn of_shapes(triangles: impl ExactSizeIterator<Item = [Vec3; 3]>) -> Self {
        let count = triangles.len() as f64;
        let mut quality = Self::default();
        if triangles.len() == 0 {
            return quality;
        }
        quality.smallest = f64::INFINITY;
        for triangle in triangles {
            let (area, q, angles) = shape(triangle);
            quality.area += area;
            quality.smallest = quality.smallest.min(q);
            quality.mean += q / count;
            let least = angles.iter().copied().fold(f64::INFINITY, f64::min);
            quality.mean_smallest_angle += least / count;
            let share = |f: &dyn Fn(f64) -> bool| {
                angles.iter().filter(|&&a| f(a)).count() as f64 / (3.0 * count)
            };
            quality.share_under_30 += share(&|a| a < 30.0);
            quality.share_over_120 += share(&|a| a > 120.0);
        }
        quality
    }
}

/// Share of the points off the boundary that have five to seven edges; all points must be in use.
pub(crate) fn valence_567(edges: &Edges, points: usize) -> f64 {
    let mut valence = vec![0u32; points];
    let mut boundary = vec![false; points];
    for (a, b, group) in edges.groups() {
        for p in [a, b] {
            valence[p as usize] += 1;
            boundary[p as usize] |= group.len() == 1;
        }
    }
    let interior = boundary.iter().filter(|b| !**b).count();
    let good = valence
        .iter()
        .zip(&boundary)
        .filter(|(v, b)| !**b && (5..=7).contains(*v));
    good.count() as f64 / interior.max(1) as f64
}

/// Area, Q and the angles in degrees.
fn shape([a, b, c]: [Vec3; 3]) -> (f64, f64, [f64; 3]) {
    let area = 0.5 * length(cross(sub(b, a), sub(c, a)));
    let sides = [length(sub(c, b)), length(sub(a, c)), length(sub(b, a))];
    let half = 0.5 * sides.iter().sum::<f64>();
    let longest = sides.iter().copied().fold(0.0, f64::max);
    let q = if longest > 0.0 {
        6.0 / 3f64.sqrt() * area / (half * longest)
    } else {
        0.0
    };
    let angle = |p: Vec3, q: Vec3, r: Vec3| {
        dot(unit(sub(q, p)), unit(sub(r, p)))
            .clamp(-1.0, 1.0)
            .acos()
            .to_degrees()
    };
    (area, q, [angle(a, b, c), angle(b, c, a), angle(c, a, b)])
}
