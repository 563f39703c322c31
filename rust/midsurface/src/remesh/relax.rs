//! Points move along the surface to the middle of their neighbours, those of the boundary along its curve.

use super::patch::{Kind, Patch, Vertex, ON_BOUNDARY};
use super::shape::{faces, squared_sine};
use super::split::LONG;
use crate::grid::{along, dot, sub, unit, Vec3};

/// No boundary point slides to where its edges are farther than this from the curve, in lengths of an edge.
const BEND: f64 = 0.15;
/// No move makes an angle smaller than this sine's (30°), unless one was there before.
const SHARP: f64 = 0.5;
/// A point that is this near to where it should be, as a share of the edge length wanted, stays.
const STILL: f64 = 0.01;
/// Shares of a move that are tried, until the triangles allow one. Going a little too far gets there
/// in fewer rounds (successive over-relaxation, Young 1954).
const SHARES: [f64; 2] = [1.5, 0.5];

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
            let way = sub(centre(patch, ring), vertex.point);
            let normal = vertex.normal();
            let way = along(way, -dot(way, normal), normal);
            if dot(way, way) < (STILL * patch.size(p)).powi(2) {
                return None;
            }
            let target = along(vertex.point, share, way);
            Some(patch.reference.vertex(vertex.at, target))
        }
        Kind::Boundary => slid(patch, p, share, ring),
        Kind::Corner => None,
    }
}

/// The mean of a point's neighbours. Weights by area or length would keep a lattice of stretched
/// triangles as it is; equal ones pull it towards equal edges.
fn centre(patch: &Patch, ring: &[u32]) -> Vec3 {
    let add = |(sum, count), q| (along(sum, 1.0, patch.point(q)), count + 1.0);
    let (sum, count) = patch.neighbours(ring).fold(([0.0; 3], 0.0), add);
    sum.map(|v| v / count)
}

/// The ways from a boundary point to its neighbours along the curve, back and ahead.
fn ways_to_neighbours(patch: &Patch, p: u32) -> Option<[f64; 2]> {
    let [before, after] = patch
        .along_boundary(p)?
        .map(|q| patch.vertices[q as usize].parameter);
    let vertex = &patch.vertices[p as usize];
    let curve = &patch.reference.curve;
    Some([
        curve.distance(vertex.at, before, vertex.parameter),
        curve.distance(vertex.at, vertex.parameter, after),
    ])
}

/// A boundary point on its way along the curve to the middle of all its neighbours: held at equal
/// distances rim points would stretch the triangles behind them. No edge gets too long for the curve, nor
/// cuts a bend of it off.
fn slid(patch: &Patch, p: u32, share: f64, ring: &[u32]) -> Option<Vertex> {
    let [before, after] = patch.along_boundary(p)?.map(|q| patch.point(q));
    let [back, ahead] = ways_to_neighbours(patch, p)?;
    let longest = (LONG * ON_BOUNDARY * patch.size(p)).max(0.5 * (back + ahead));
    let way = sub(centre(patch, ring), patch.point(p));
    let way = share * dot(way, unit(sub(after, before)));
    let way = way.max(ahead - longest).min(longest - back);
    let Vertex { at, parameter, .. } = patch.vertices[p as usize];
    let curve = &patch.reference.curve;
    let off = |way: f64| {
        let behind = curve.sagitta(at, parameter - back, back + way);
        behind.max(curve.sagitta(at, parameter + way, ahead - way))
    };
    let most = (BEND * patch.size(p)).max(off(0.0));
    (off(way) <= most).then(|| slid_by(patch, p, way))?
}

/// A boundary point that has slid some way along the curve, but not up to a neighbour.
pub(super) fn slid_by(patch: &Patch, p: u32, way: f64) -> Option<Vertex> {
    let [back, ahead] = ways_to_neighbours(patch, p)?;
    let way = way.clamp(-0.8 * back, 0.8 * ahead);
    let Patch { reference, .. } = patch;
    let vertex = &patch.vertices[p as usize];
    let parameter = vertex.parameter + way;
    Some(reference.curve.vertex(reference, vertex.at, parameter))
}

/// Whether the triangles around a point remain good if it moves: none turns away from the surface
/// or gets sharp.
pub(super) fn allows(patch: &Patch, p: u32, moved: &Vertex, ring: &[u32]) -> bool {
    let normal = moved.normal();
    ring.iter().all(|&e| {
        let [a, b] = [patch.end(e), patch.opposite(e)].map(|q| patch.point(q));
        let corners = [moved.point, a, b];
        faces(corners, normal)
            && (squared_sine(corners) > SHARP * SHARP
                || squared_sine(corners) > squared_sine([patch.point(p), a, b]))
    })
}
