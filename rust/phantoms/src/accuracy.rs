//! How far a mesh is from the truth, and the truth from the mesh.

use crate::phantom::Phantom;
use crate::triangle_shape::area;
use crate::triangle_tree::triangle_tree;
use crate::vector::{add, cross, dot, scale, sub, unit, Vec3};

/// What lies farther than this many voxels from every rim and from the border of the volume
/// counts as inside.
pub const INSIDE: f64 = 3.0;

/// Distances between mesh and truth, in voxels. NaN for an empty mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Root mean square distance of the mesh to the truth, over its area.
    pub rms: f64,
    /// Largest distance of the mesh to the truth.
    pub max_error: f64,
    /// Root mean square distance farther than [`INSIDE`] from rims and the border.
    pub rms_inside: f64,
    /// Largest distance farther than [`INSIDE`] from rims and the border.
    pub max_inside: f64,
    /// Mean signed distance of the mesh to the truth, positive on the side of its normal: a bias.
    pub mean_signed: f64,
    /// Mean angle between the triangles' normals and the true normal, degrees, sign ignored.
    pub normal_error: f64,
    /// Area farther than 1 voxel from the truth, square voxels: walls that should not be there.
    pub stray_area: f64,
}

/// Distances of points spread evenly over each triangle, at least 4 a square voxel, weighted by
/// the area they stand for; and of the corners, which stand for none, but may be farthest.
pub(crate) fn accuracy(triangles: &[[Vec3; 3]], phantom: &Phantom) -> Accuracy {
    let unit_length = phantom.frame.unit();
    let (mut all, mut inside) = (Sums::default(), Sums::default());
    let mut angles = 0.0;
    for t in triangles {
        let area = area(t) / (unit_length * unit_length);
        let count = (4.0 * area).ceil() as usize;
        let share = area / count as f64;
        let corners = t.iter().map(|&p| (p, 0.0));
        for (p, share) in spread(t, count).map(|p| (p, share)).chain(corners) {
            let (closest, _) = phantom.closest(p);
            let (distance, offset) = (closest.distance / unit_length, closest.offset / unit_length);
            all.add(share, distance, offset);
            let from_rim = closest
                .from_rim
                .min(phantom.frame.from_border(closest.point));
            if from_rim > INSIDE * unit_length {
                inside.add(share, distance, offset);
            }
        }
        angles += area * normal_error(t, phantom);
    }
    Accuracy {
        rms: (all.squares / all.weight).sqrt(),
        max_error: all.max(),
        rms_inside: (inside.squares / inside.weight).sqrt(),
        max_inside: inside.max(),
        mean_signed: all.signed / all.weight,
        normal_error: angles / all.weight,
        stray_area: all.stray,
    }
}

#[derive(Default)]
struct Sums {
    weight: f64,
    squares: f64,
    signed: f64,
    most: f64,
    stray: f64,
}

impl Sums {
    fn add(&mut self, share: f64, distance: f64, offset: f64) {
        self.weight += share;
        self.squares += share * distance * distance;
        self.signed += share * offset;
        self.most = self.most.max(distance);
        self.stray += if distance > 1.0 { share } else { 0.0 };
    }

    fn max(&self) -> f64 {
        if self.weight > 0.0 {
            self.most
        } else {
            f64::NAN
        }
    }
}

/// Angle between a triangle's normal and the true one next to its middle, degrees.
fn normal_error(t: &[Vec3; 3], phantom: &Phantom) -> f64 {
    let middle = scale(1.0 / 3.0, add(add(t[0], t[1]), t[2]));
    let (closest, _) = phantom.closest(middle);
    let normal = unit(cross(sub(t[1], t[0]), sub(t[2], t[0])));
    let cosine = dot(normal, closest.normal).abs();
    cosine.min(1.0).acos().to_degrees()
}

/// `count` points spread over a triangle: the R2 sequence, folded from the unit square.
pub(crate) fn spread(t: &[Vec3; 3], count: usize) -> impl Iterator<Item = Vec3> {
    let (a, ab, ac) = (t[0], sub(t[1], t[0]), sub(t[2], t[0]));
    (0..count).map(move |i| {
        let n = i as f64 + 1.0;
        let (mut u, mut v) = if count == 1 {
            (1.0 / 3.0, 1.0 / 3.0)
        } else {
            ((n * 0.754_877_666_2).fract(), (n * 0.569_840_290_9).fract())
        };
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        add(a, add(scale(u, ab), scale(v, ac)))
    })
}

/// How much of the truth the mesh is near to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Share of the truth, 0 to 1, that lies within 1 voxel of the mesh.
    pub within_1: f64,
    /// Share of the truth, 0 to 1, that lies within 0.6 voxel of the mesh.
    pub within_06: f64,
    /// Distance of the point of the truth that is farthest from the mesh, voxels.
    pub farthest: f64,
}

/// Looks from one point a square voxel of the truth.
pub(crate) fn coverage(triangles: &[[Vec3; 3]], phantom: &Phantom) -> Coverage {
    let unit_length = phantom.frame.unit();
    let tree = triangle_tree(triangles);
    let samples = phantom.truth_samples(unit_length);
    let distances: Vec<f64> = samples
        .iter()
        .map(|p| {
            let nearest = tree.nearest_neighbor_iter_with_distance_2(p).next();
            nearest.map_or(f64::INFINITY, |(_, d)| d.sqrt() / unit_length)
        })
        .collect();
    let within = |reach: f64| {
        distances.iter().filter(|&&d| d <= reach).count() as f64 / distances.len() as f64
    };
    Coverage {
        within_1: within(1.0),
        within_06: within(0.6),
        farthest: distances.iter().copied().fold(0.0, f64::max),
    }
}
