//! Points move along the surface to the middle of their triangles.

use super::patch::{Kind, Patch, Vertex};
use super::shape::{facing, sine_of_smallest_angle};
use crate::grid::{along, cross, dot, length, sub, Vec3};

/// No move makes an angle smaller than this sine's (12°), unless one was there before.
const SHARP: f64 = 0.2;
/// Shares of a move that are tried, until the triangles allow one.
const SHARES: [f64; 2] = [1.0, 0.4];

/// Moves every point once, one after the other.
pub(super) fn relax(patch: &mut Patch) {
    let mut ring = Vec::new();
    for p in 0..patch.vertices.len() as u32 {
        if patch.frozen[p as usize] || patch.is_removed(p) {
            continue;
        }
        ring.clear();
        ring.extend(patch.around(p));
        for share in SHARES {
            let Some(moved) = moved(patch, p, share, &ring) else {
                break;
            };
            if allows(patch, p, &moved, &ring) {
                patch.vertices[p as usize] = moved;
                break;
            }
        }
    }
}

fn moved(patch: &Patch, p: u32, share: f64, ring: &[u32]) -> Option<Vertex> {
    let vertex = &patch.vertices[p as usize];
    match vertex.kind {
        Kind::Interior => {
            let way = sub(centre(patch, p, ring), vertex.point);
            let normal = vertex.normal();
            let way = along(way, -dot(way, normal), normal);
            let target = along(vertex.point, share, way);
            Some(patch.reference.vertex(vertex.at, target))
        }
        Kind::Boundary => slid(patch, p, share),
        Kind::Corner => None,
    }
}

/// The mean of the centres of a point's triangles, weighted by their areas.
fn centre(patch: &Patch, p: u32, ring: &[u32]) -> Vec3 {
    let here = patch.point(p);
    let (mut sum, mut total) = ([0.0; 3], 0.0);
    for &e in ring {
        let [u, v] = [patch.end(e), patch.opposite(e)].map(|q| sub(patch.point(q), here));
        let weight = length(cross(u, v));
        sum = along(along(sum, weight, u), weight, v);
        total += 3.0 * weight;
    }
    if total > 0.0 {
        along(here, 1.0 / total, sum)
    } else {
        here
    }
}

/// A boundary point on its way to the middle between its neighbours along the curve.
fn slid(patch: &Patch, p: u32, share: f64) -> Option<Vertex> {
    let [before, after] = patch
        .along_boundary(p)?
        .map(|q| patch.vertices[q as usize].parameter);
    let vertex = &patch.vertices[p as usize];
    let curve = &patch.reference.curve;
    let back = curve.distance(vertex.at, before, vertex.parameter);
    let ahead = curve.distance(vertex.at, vertex.parameter, after);
    let parameter = vertex.parameter + share * 0.5 * (ahead - back);
    Some(curve.vertex(patch.reference, vertex.at, parameter))
}

/// Whether the triangles around a point remain good if it moves.
pub(super) fn allows(patch: &Patch, p: u32, moved: &Vertex, ring: &[u32]) -> bool {
    ring.iter().all(|&e| {
        let (a, b) = (patch.end(e), patch.opposite(e));
        let [pa, pb] = [a, b].map(|q| patch.point(q));
        let sharp = sine_of_smallest_angle([moved.point, pa, pb]);
        facing(patch, [p, a, b], [moved.point, pa, pb])
            && (sharp > SHARP || sharp > sine_of_smallest_angle([patch.point(p), pa, pb]))
    })
}
