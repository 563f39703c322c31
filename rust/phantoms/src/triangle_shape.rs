//! The shape of triangles: areas, angles and the quality figure of MidSurfer's tables.

use crate::vector::{cross, dot, length, sub, unit, Vec3};

/// The shape of all triangles of a mesh that have an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shapes {
    /// Sum of their areas.
    pub area: f64,
    /// Smallest Q = 6/√3 · area / (half perimeter · longest edge): 1 for equilateral triangles.
    pub quality_least: f64,
    /// Mean of Q.
    pub quality_mean: f64,
    /// Mean of each triangle's smallest angle, degrees.
    pub smallest_angle_mean: f64,
    /// Smallest angle anywhere, degrees.
    pub smallest_angle: f64,
    /// Largest angle anywhere, degrees.
    pub largest_angle: f64,
    /// Number of angles under 25°.
    pub angles_under_25: usize,
    /// Number of angles under 30°.
    pub angles_under_30: usize,
    /// Number of angles over 120°.
    pub angles_over_120: usize,
    /// Mean length of the triangles' edges.
    pub edge_mean: f64,
}

/// Measures triangles that have an area. Means are NaN where there is none.
pub fn shapes(triangles: &[[Vec3; 3]]) -> Shapes {
    let mut shapes = Shapes {
        area: 0.0,
        quality_least: f64::INFINITY,
        quality_mean: 0.0,
        smallest_angle_mean: 0.0,
        smallest_angle: f64::INFINITY,
        largest_angle: 0.0,
        angles_under_25: 0,
        angles_under_30: 0,
        angles_over_120: 0,
        edge_mean: 0.0,
    };
    for t in triangles {
        let (q, angles) = (quality(t), angles(t));
        let least = angles.into_iter().fold(f64::INFINITY, f64::min);
        let count = |test: &dyn Fn(f64) -> bool| angles.iter().filter(|&&a| test(a)).count();
        shapes.area += area(t);
        shapes.quality_least = shapes.quality_least.min(q);
        shapes.quality_mean += q;
        shapes.smallest_angle_mean += least;
        shapes.smallest_angle = shapes.smallest_angle.min(least);
        shapes.largest_angle = angles.into_iter().fold(shapes.largest_angle, f64::max);
        shapes.angles_under_25 += count(&|a| a < 25.0);
        shapes.angles_under_30 += count(&|a| a < 30.0);
        shapes.angles_over_120 += count(&|a| a > 120.0);
        shapes.edge_mean += sides(t).iter().sum::<f64>() / 3.0;
    }
    let count = triangles.len() as f64;
    shapes.quality_mean /= count;
    shapes.smallest_angle_mean /= count;
    shapes.edge_mean /= count;
    shapes
}

pub(crate) fn area(t: &[Vec3; 3]) -> f64 {
    0.5 * length(cross(sub(t[1], t[0]), sub(t[2], t[0])))
}

fn sides(t: &[Vec3; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| length(sub(t[(i + 1) % 3], t[i])))
}

fn quality(t: &[Vec3; 3]) -> f64 {
    let [a, b, c] = sides(t);
    6.0 / 3f64.sqrt() * area(t) / (0.5 * (a + b + c) * a.max(b).max(c))
}

/// The three angles, degrees.
fn angles(t: &[Vec3; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let to = |j: usize| unit(sub(t[(i + j) % 3], t[i]));
        dot(to(1), to(2)).clamp(-1.0, 1.0).acos().to_degrees()
    })
}
