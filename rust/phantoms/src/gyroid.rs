//! The gyroid: sin x cos y + sin y cos z + sin z cos x = 0, a surface without an end.

use crate::shape::Closest;
use crate::vector::{add, dot, length, scale, sub, unit, Vec3};

/// A distance that the surface is at least away from p, k its wave number: the function's gradient
/// is nowhere longer than √3 k.
pub(crate) fn least_distance(p: Vec3, centre: Vec3, k: f64) -> f64 {
    gyroid(p, centre, k).0.abs() / (3f64.sqrt() * k)
}

/// Value and gradient of the gyroid's function, k its wave number.
fn gyroid(p: Vec3, centre: Vec3, k: f64) -> (f64, Vec3) {
    let [(sx, cx), (sy, cy), (sz, cz)] = sub(p, centre).map(|v| (k * v).sin_cos());
    let gradient = [cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz];
    (sx * cy + sy * cz + sz * cx, scale(k, gradient))
}

/// The nearest point found while alternating between falling onto the surface and sliding along
/// it towards p. Exact near the surface; half-way between two sheets it may name the farther one.
pub(crate) fn closest_on_gyroid(p: Vec3, centre: Vec3, k: f64) -> Closest {
    let mut point = fall_onto_gyroid(p, centre, k);
    let mut best = point;
    for _ in 0..12 {
        let normal = unit(gyroid(point, centre, k).1);
        let away = sub(p, point);
        let slide = sub(away, scale(dot(away, normal), normal));
        if length(slide) < 1e-6 / k {
            break;
        }
        let step = (0.4 / k / length(slide)).min(1.0);
        point = fall_onto_gyroid(add(point, scale(step, slide)), centre, k);
        if length(sub(p, point)) < length(sub(p, best)) {
            best = point;
        }
    }
    let distance = length(sub(p, best));
    Closest {
        point: best,
        distance,
        offset: distance.copysign(gyroid(p, centre, k).0),
        normal: unit(gyroid(best, centre, k).1),
        from_rim: f64::INFINITY,
        within_rim: true,
    }
}

/// Newton's method along the gradient, in steps short enough not to jump to another sheet.
fn fall_onto_gyroid(mut point: Vec3, centre: Vec3, k: f64) -> Vec3 {
    for _ in 0..30 {
        let (value, gradient) = gyroid(point, centre, k);
        if value.abs() < 1e-9 {
            break;
        }
        let longest = 0.3 / k;
        let step = (value / length(gradient)).clamp(-longest, longest);
        point = sub(point, scale(step, unit(gradient)));
    }
    point
}
