//! Normals of sheets near the border of the volume.
//!
//! Where a leaning sheet leaves the volume the distance knows one of its faces only, and the ridge
//! field leans with it: normals are up to 20° off. They are taken from farther inside instead, along
//! the sheet, and carried back: n(0) = 2 n(s) − n(2 s), which is right where the sheet bends evenly.

use crate::fields::interpolation::Sampler;
use crate::grid::{along, dot, last_voxel, length, round, unit, Vec3};
use crate::sheets::sheet::{self, Sheet};

/// How far from a border the normals are trusted, in thicknesses of the label.
const TRUSTED: f64 = 1.25;
/// A sheet leaning less against a border loses nothing to it.
const UPRIGHT: f64 = 0.15;
/// No step along the sheet is longer, in thicknesses.
const FARTHEST: f64 = 3.0;
/// The way along the sheet depends on the normal, which becomes better from round to round.
const ROUNDS: usize = 4;
/// Shares of the way that are tried.
const STEPS: [f64; 3] = [1.0, 0.5, 0.25];

/// The normal at `p`, where the voxels around say `normal` and the label is about `thickness` thick.
pub(crate) fn normal_near_border(
    distance: &Sampler,
    sheets: &[Sheet],
    p: Vec3,
    normal: Vec3,
    thickness: f64,
) -> Vec3 {
    let normal_at = |q: Vec3| {
        let voxel = std::array::from_fn(|a| round(q[a] / distance.h[a]));
        sheet::normal(&sheets[distance.directory.entry_at(voxel)?])
    };
    let mut found = normal;
    for _ in 0..ROUNDS {
        let Some(step) = inward(distance, p, found, thickness) else {
            return found;
        };
        // With a wrong normal a long step may lead off the sheet.
        let shorter = STEPS.map(|share| step.map(|v| share * v));
        let known = |step: Vec3| normal_at(along(p, 1.0, step)).map(|n| (step, n));
        let Some((step, once)) = shorter.into_iter().find_map(known) else {
            return found;
        };
        let once = turned(once, normal);
        let twice = normal_at(along(p, 2.0, step)).map_or(once, |n| turned(n, normal));
        found = unit(std::array::from_fn(|k| 2.0 * once[k] - twice[k]));
    }
    found
}

fn turned(n: Vec3, like: Vec3) -> Vec3 {
    n.map(|v| v * dot(n, like).signum())
}

/// The way along the sheet to where no border is near; `None` where none is near here.
fn inward(distance: &Sampler, p: Vec3, normal: Vec3, thickness: f64) -> Option<Vec3> {
    let last = last_voxel(distance.directory.dimensions, distance.h);
    let wanted: Vec3 = std::array::from_fn(|a| {
        let missing = TRUSTED * thickness - p[a].min(last[a] - p[a]);
        if missing <= 0.0 || normal[a].abs() < UPRIGHT {
            0.0
        } else {
            missing.copysign(last[a] - 2.0 * p[a])
        }
    });
    let way = along(wanted, -dot(wanted, normal), normal);
    let (needed, given) = (length(wanted), length(way));
    if needed == 0.0 || given < 0.3 * needed {
        return None;
    }
    // As far as it takes to get away from each border.
    let share = (0..3)
        .filter(|&a| wanted[a] * way[a] > 0.0)
        .map(|a| wanted[a] / way[a])
        .fold(1.0, f64::max);
    let share = share.min(FARTHEST * thickness / given);
    Some(way.map(|v| share * v))
}
