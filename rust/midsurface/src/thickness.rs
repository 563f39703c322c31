//! Local thickness: the distance between both faces of the label through a point.

use crate::grid::{along, unit, Vec3};
use crate::interpolation::Sampler;

/// Step along the ray, work units; the face is then found by linear interpolation.
const STEP: f64 = 0.25;

/// Thickness at (x, y) in slice z, work units. The ray runs both ways along the normal of the
/// ridge; where one way leaves the volume, the thickness is twice the other's length.
pub(crate) fn thickness(ridge: &Sampler, distance: &Sampler, at: [f64; 2], z: usize) -> f64 {
    let normal = ridge_normal(ridge.hessian(at, z));
    let h = distance.h;
    let from = [at[0], at[1], z as f64 * h[2]];
    match (face(distance, from, normal), face(distance, from, normal.map(|v| -v))) {
        (Reach::Face(a), Reach::Face(b)) => a + b,
        (Reach::Face(a), Reach::Border(_)) | (Reach::Border(_), Reach::Face(a)) => 2.0 * a,
        (Reach::Border(a), Reach::Border(b)) => a + b,
    }
}

/// How a ray ended.
enum Reach {
    Face(f64),
    Border(f64),
}

/// Follows a ray until the label ends.
fn face(distance: &Sampler, from: Vec3, direction: Vec3) -> Reach {
    let most = (2.0 * crate::distance::LARGEST / STEP) as usize;
    let mut before = labelled(distance, from).unwrap_or(0.0);
    for k in 1..most {
        let t = STEP * k as f64;
        let Some(now) = labelled(distance, along(from, t, direction)) else {
            return Reach::Border(t - STEP);
        };
        if now < 0.5 {
            let crossing = if before > 0.5 { (before - 0.5) / (before - now) } else { 0.0 };
            return Reach::Face(STEP * ((k - 1) as f64 + crossing));
        }
        before = now;
    }
    Reach::Face(STEP * most as f64)
}

/// The label's mask at a point, linear between voxels; `None` outside the volume.
fn labelled(distance: &Sampler, p: Vec3) -> Option<f64> {
    let voxel: Vec3 = std::array::from_fn(|a| p[a] / distance.h[a]);
    let dimensions = distance.directory.dimensions;
    if (0..3).any(|a| voxel[a] < 0.0 || voxel[a] > (dimensions[a] - 1) as f64) {
        return None;
    }
    let low = voxel.map(|v| v.floor());
    let mut sum = 0.0;
    for corner in 0..8 {
        let offset: [usize; 3] = std::array::from_fn(|a| corner >> a & 1);
        let weight: f64 = (0..3)
            .map(|a| if offset[a] == 1 { voxel[a] - low[a] } else { 1.0 - voxel[a] + low[a] })
            .product();
        if weight > 0.0 {
            let at: [usize; 3] = std::array::from_fn(|a| low[a] as usize + offset[a]);
            let entry = distance.directory.entry(at);
            sum += weight * f64::from(entry.is_some_and(|e| distance.field[e] > 0.0));
        }
    }
    Some(sum)
}

/// The eigenvector of the most negative eigenvalue of a Hessian xx, yy, zz, xy, xz, yz, by Jacobi
/// rotations.
fn ridge_normal([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> Vec3 {
    let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut vectors, p, q);
        }
    }
    let least = (0..3).fold(0, |best, i| if a[i][i] < a[best][best] { i } else { best });
    unit([vectors[0][least], vectors[1][least], vectors[2][least]])
}

/// One Jacobi rotation, which zeroes a[p][q].
fn rotate(a: &mut [Vec3; 3], vectors: &mut [Vec3; 3], p: usize, q: usize) {
    if a[p][q].abs() < 1e-300 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for row in a.iter_mut() {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
    for k in 0..3 {
        (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
    }
    for row in vectors.iter_mut() {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
}
