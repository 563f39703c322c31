//! Normals of a mesh's points.

use crate::buckets::Buckets;
use crate::error::{zeros, Result};
use crate::execution::Execution;
use crate::grid::{along, cross, dot, length, sub, unit, Vec3};
use crate::surface::halfedge::{ends, previous, Fans};

/// Corners handed to a worker at a time, or points.
const PIECE: usize = 2048;
/// Passes that [`normals`] makes, for its progress.
pub(crate) const NORMAL_PASSES: usize = 2;

/// Unit normals of the points (Thürmer and Wüthrich 1998: weighted by the angle at the point).
/// `fans` are those of the triangles.
pub(crate) fn normals(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    fans: &Fans,
    execution: &mut Execution,
) -> Result<Vec<Vec3>> {
    let mut weighted: Vec<[Vec3; 3]> = zeros(triangles.len())?;
    execution.fill(&mut weighted, PIECE, |piece, out| {
        for (t, out) in triangles[piece * PIECE..].iter().zip(out) {
            let [a, b, c] = t.map(|p| points[p as usize]);
            let normal = unit(cross(sub(b, a), sub(c, a)));
            let corners = [(a, b, c), (b, c, a), (c, a, b)];
            *out = corners.map(|(p, q, r)| {
                let cosine = dot(unit(sub(q, p)), unit(sub(r, p)));
                normal.map(|v| cosine.clamp(-1.0, 1.0).acos() * v)
            });
        }
    })?;
    let mut normals: Vec<Vec3> = zeros(points.len())?;
    execution.fill(&mut normals, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let corners = fans.of((piece * PIECE + i) as u32);
            let add = |sum, &e: &u32| along(sum, 1.0, weighted[e as usize / 3][e as usize % 3]);
            let mut normal = corners.iter().fold([0.0; 3], add);
            if length(normal) < 1e-6 {
                // Where triangles fold back on each other their normals cancel: any will do.
                let sharp = |e: &&u32| length(weighted[**e as usize / 3][**e as usize % 3]) > 0.0;
                if let Some(&e) = corners.iter().find(sharp) {
                    normal = weighted[e as usize / 3][e as usize % 3];
                }
            }
            *out = unit(normal);
        }
    })?;
    Ok(normals)
}

/// Unit normal of the point that half-edges leave, its triangles weighted so that on a sphere it is
/// exact (Max 1999); quick, but nothing where triangles fold back on each other.
pub(crate) fn normal_of_fan(points: &[Vec3], triangles: &[[u32; 3]], leaving: &[u32]) -> Vec3 {
    let mut sum = [0.0; 3];
    for &e in leaving {
        let (p, q) = ends(triangles, e);
        let r = ends(triangles, previous(e)).0;
        let [p, q, r] = [p, q, r].map(|p| points[p as usize]);
        let (u, v) = (sub(q, p), sub(r, p));
        let squares = dot(u, u) * dot(v, v);
        if squares > 0.0 {
            sum = along(sum, 1.0 / squares, cross(u, v));
        }
    }
    unit(sum)
}

/// Unit normals averaged so many rounds over the points around, so that noise and terraces of the
/// surface do not show in them.
pub(crate) fn average_normals(
    mut normals: Vec<Vec3>,
    neighbours: &Buckets<u32>,
    rounds: usize,
    execution: &mut Execution,
) -> Result<Vec<Vec3>> {
    let mut averaged: Vec<Vec3> = zeros(normals.len())?;
    for _ in 0..rounds {
        execution.fill(&mut averaged, PIECE, |piece, out| {
            for (i, out) in out.iter_mut().enumerate() {
                let p = PIECE * piece + i;
                let add = |sum, &q: &u32| along(sum, 1.0, normals[q as usize]);
                *out = unit(neighbours.of(p).iter().fold(normals[p], add));
            }
        })?;
        std::mem::swap(&mut averaged, &mut normals);
    }
    Ok(normals)
}
