//! The last few poor triangles and points are mended one by one.
//!
//! Moving points to the middle of their neighbours is right on average and leaves, mostly along
//! boundaries, a few small angles; flips leave a few points with four edges. Here a point of a poor
//! triangle goes where the worst angle around it is best, found by trying places around it
//! (Freitag and Ollivier-Gooch 1997 optimise the same aim), and a point with four edges is drawn
//! into a neighbour.

use super::collapse::may_collapse;
use super::flip::{change, flip_edges_of};
use super::patch::{Kind, Patch, Vertex};
use super::relax::{allows, slid_by};
use super::shape::{sine_of_smallest_angle, squared_sine};
use crate::grid::{along, cross, dot, length, sub, unit, Vec3};

/// A triangle whose smallest angle is below this sine's (34°) is poor.
pub(super) const POOR: f64 = 0.56;
/// Sweeps over the poor triangles; what is poor after them stays so.
const SWEEPS: usize = 3;
/// Lengths of the steps that are tried, as shares of the edge length wanted.
const STEPS: [f64; 3] = [0.3, 0.15, 0.07];
/// A collapse for the sake of valence may make edges this much longer than wanted.
const LONG: f64 = 1.7;

/// Mends poor triangles and points with too few edges.
pub(super) fn polish(patch: &mut Patch) {
    let mut ring = Vec::new();
    for p in 0..patch.vertices.len() as u32 {
        if patch.valence[p as usize] <= 4 {
            draw_away(patch, p, &mut ring);
        }
    }
    mend_poor(patch);
}

/// Flips edges and moves points of poor triangles.
pub(super) fn mend_poor(patch: &mut Patch) {
    let mut ring = Vec::new();
    for _ in 0..SWEEPS {
        let poor = poor_triangles(patch);
        if poor.is_empty() {
            return;
        }
        flip_edges_of(patch, &poor);
        let corners = |t: u32| patch.triangles[t as usize];
        let mut points: Vec<u32> = poor_triangles(patch)
            .into_iter()
            .flat_map(corners)
            .collect();
        points.sort_unstable();
        points.dedup();
        points.retain(|&p| !patch.frozen[p as usize]);
        for p in points {
            ring.clear();
            ring.extend(patch.around(p));
            mend(patch, p, &ring);
        }
    }
}

fn poor_triangles(patch: &Patch) -> Vec<u32> {
    let is_poor = |t: &u32| squared_sine(patch.corners(*t)) < POOR * POOR;
    let all = 0..patch.triangles.len() as u32;
    all.filter(|&t| patch.is_alive(t)).filter(is_poor).collect()
}

/// Draws an interior point with few edges into the neighbour where that is best for valence.
fn draw_away(patch: &mut Patch, p: u32, ring: &mut Vec<u32>) {
    let interior = patch.vertices[p as usize].kind == Kind::Interior;
    if !interior || patch.frozen[p as usize] || patch.is_removed(p) {
        return;
    }
    let spokes: Vec<u32> = patch.around(p).collect();
    let worth = |e: u32| {
        let (c, d) = (patch.opposite(e), patch.opposite(patch.twin(e)));
        let gained = patch.valence[p as usize] - 4;
        change(patch, [(c, -1), (d, -1), (patch.end(e), gained)])
    };
    let mut order: Vec<(i32, u32)> = spokes.iter().map(|&e| (worth(e), e)).collect();
    order.sort_unstable();
    for (_, e) in order {
        let u = patch.end(e);
        if may_collapse(patch, e, p, u, LONG, ring) {
            patch.collapse(e, p, u, ring);
            return;
        }
    }
}

/// The sine of the smallest angle of a point's triangles, if it were at `place`.
fn worst(patch: &Patch, place: Vec3, ring: &[u32]) -> f64 {
    ring.iter()
        .map(|&e| {
            let [a, b] = [patch.end(e), patch.opposite(e)].map(|q| patch.point(q));
            sine_of_smallest_angle([place, a, b])
        })
        .fold(1.0, f64::min)
}

/// Moves a point of a poor triangle to the best of the places around it.
fn mend(patch: &mut Patch, p: u32, ring: &[u32]) {
    let mut best = worst(patch, patch.point(p), ring);
    for share in STEPS {
        if best >= POOR {
            return;
        }
        for vertex in places(patch, p, share * patch.size(p)) {
            let worst = worst(patch, vertex.point, ring);
            if worst > best && allows(patch, p, &vertex, ring) {
                best = worst;
                patch.vertices[p as usize] = vertex;
            }
        }
    }
}

/// Places at a distance around a point on the surface, or along the boundary.
fn places(patch: &Patch, p: u32, step: f64) -> Vec<Vertex> {
    let vertex = patch.vertices[p as usize];
    match vertex.kind {
        Kind::Corner => Vec::new(),
        Kind::Boundary => [-step, step]
            .into_iter()
            .filter_map(|way| slid_by(patch, p, way))
            .collect(),
        Kind::Interior => {
            let normal = vertex.normal();
            let Some(e) = patch.around(p).next() else {
                return Vec::new();
            };
            let spoke = sub(patch.point(patch.end(e)), vertex.point);
            let x = unit(along(spoke, -dot(spoke, normal), normal));
            let y = cross(normal, x);
            if length(x) == 0.0 {
                return Vec::new();
            }
            (0..8)
                .map(|k| {
                    let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
                    let target = along(along(vertex.point, step * cos, x), step * sin, y);
                    patch.reference.vertex(vertex.at, target)
                })
                .collect()
        }
    }
}
