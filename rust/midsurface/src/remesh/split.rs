//! Long edges get a point in their middle.

use super::patch::{Patch, Vertex};
use super::reference::Reference;
use crate::error::Result;
use crate::grid::{squared_distance, Vec3};
use crate::surface::halfedge::NONE;

/// An edge this much longer than wanted is split (Botsch and Kobbelt 2004): its halves are then as
/// much too short as it was too long.
pub(super) const LONG: f64 = 4.0 / 3.0;
/// The longest edges go first, since a split in their triangles would leave others as long: the
/// limit shrinks from sweep to sweep, as multiples of [`LONG`].
const SWEEPS: [f64; 6] = [16.0, 8.0, 4.0, 2.0, 1.0, 1.0];
/// The new point may be this share of the edge's length off its middle; nearer than the second share,
/// nothing better is looked for.
const OFF: f64 = 0.3;
const NEAR: f64 = 0.1;

/// Splits edges until none is too long.
pub(super) fn split_long_edges(patch: &mut Patch) -> Result<()> {
    let longest = (0..patch.twins.len() as u32)
        .map(|e| squared_excess(patch, e))
        .fold(0.0, f64::max);
    for share in SWEEPS {
        let limit = (share * LONG).powi(2);
        if longest <= limit {
            continue;
        }
        for e in 0..patch.twins.len() as u32 {
            if squared_excess(patch, e) > limit {
                if let Some(vertex) = near_middle(patch, e) {
                    patch.split(e, vertex)?;
                }
            }
        }
    }
    Ok(())
}

/// Square of an edge's length over the one wanted; 0 for an edge that may not be split, and for
/// the second half-edge of an edge.
fn squared_excess(patch: &Patch, e: u32) -> f64 {
    let f = patch.twin(e);
    if !patch.is_alive(e / 3) || (f != NONE && f < e) {
        return 0.0;
    }
    let (a, b) = (patch.origin(e), patch.end(e));
    if f == NONE && patch.frozen[a as usize] && patch.frozen[b as usize] {
        return 0.0;
    }
    squared_distance(patch.point(a), patch.point(b)) / patch.wanted_of(e).powi(2)
}

/// A vertex in the middle of an edge, unless the reference has none near.
pub(super) fn near_middle(patch: &Patch, e: u32) -> Option<Vertex> {
    let ends = [patch.origin(e), patch.end(e)].map(|p| &patch.vertices[p as usize]);
    let vertex = middle(patch.reference, ends, patch.twin(e) == NONE);
    is_within(OFF, &vertex, ends).then_some(vertex)
}

/// Whether a vertex lies within a share of an edge's length of its middle.
fn is_within(share: f64, vertex: &Vertex, ends: [&Vertex; 2]) -> bool {
    let near = share * share * squared_distance(ends[0].point, ends[1].point);
    squared_distance(vertex.point, centre(ends)) < near
}

/// A vertex in the middle of an edge, off the reference where that has none near.
pub(super) fn middle_anyway(reference: &Reference, ends: [&Vertex; 2], border: bool) -> Vertex {
    let mut vertex = middle(reference, ends, border);
    if !is_within(OFF, &vertex, ends) {
        vertex.point = centre(ends);
    }
    vertex
}

/// The vertex of the reference in the middle of an edge, which may be on its boundary.
fn middle(reference: &Reference, ends: [&Vertex; 2], border: bool) -> Vertex {
    let [a, b] = ends;
    if border {
        let way = reference.curve.distance(a.at, a.parameter, b.parameter);
        return reference
            .curve
            .vertex(reference, a.at, a.parameter + 0.5 * way);
    }
    let centre = centre(ends);
    let from = |end| reference.vertex(reference.triangle_of(end), centre);
    let v = from(a);
    if is_within(NEAR, &v, ends) {
        return v;
    }
    // The walk may have ended at an obstacle: from the other end there may be none.
    let w = from(b);
    if squared_distance(v.point, centre) <= squared_distance(w.point, centre) {
        v
    } else {
        w
    }
}

fn centre([a, b]: [&Vertex; 2]) -> Vec3 {
    std::array::from_fn(|k| 0.5 * (a.point[k] + b.point[k]))
}
