//! Short edges are drawn together.
//!
//! One end of the edge is drawn into the other, whose place stays. The link condition (Dey et al.
//! 1999) keeps the topology: the ends may have no neighbours in common but the corners opposite
//! the edge. The triangles that are dragged along may neither fold nor become slivers.

use super::patch::{Kind, Patch};
use super::shape::{facing, sine_of_smallest_angle};
use crate::grid::squared_distance;
use crate::halfedge::{next, previous, NONE};

/// An edge this much shorter than wanted is collapsed (Botsch and Kobbelt 2004).
const SHORT: f64 = 4.0 / 5.0;
/// No collapse makes an edge this much longer than wanted.
const LONG: f64 = 4.0 / 3.0;
/// The shortest edges go first: the limit grows from sweep to sweep, as shares of [`SHORT`].
const SWEEPS: [f64; 5] = [0.4, 0.6, 0.8, 1.0, 1.0];
/// No collapse makes an angle smaller than this sine's (12°), unless one was there before.
const SHARP: f64 = 0.2;

/// Collapses edges that are too short, where that is possible.
pub(super) fn collapse_short_edges(patch: &mut Patch) {
    let mut ring = Vec::new();
    let mut shares: Vec<f64> = (0..patch.twins.len() as u32)
        .map(|e| squared_share(patch, e))
        .collect();
    let shortest = shares.iter().copied().fold(f64::INFINITY, f64::min);
    for share in SWEEPS {
        let limit = (share * SHORT).powi(2);
        if shortest >= limit {
            continue;
        }
        for e in 0..patch.twins.len() as u32 {
            if shares[e as usize] < limit {
                let (a, b) = (patch.origin(e), patch.end(e));
                // The end with fewer edges goes.
                let order = if patch.valence[a as usize] <= patch.valence[b as usize] {
                    [(a, b), (b, a)]
                } else {
                    [(b, a), (a, b)]
                };
                for (v, u) in order {
                    if may_collapse(patch, e, v, u, LONG, &mut ring) {
                        let changed = changed_edges(patch, e, &ring);
                        patch.collapse(e, v, u, &ring);
                        for h in changed {
                            shares[h as usize] = squared_share(patch, h);
                        }
                        break;
                    }
                }
            }
        }
    }
}

/// The half-edges that change if half-edge e is collapsed, one of whose ends `ring` leaves: those of
/// the triangles around, and those across, two of which become one edge.
fn changed_edges(patch: &Patch, e: u32, ring: &[u32]) -> Vec<u32> {
    let sides = [e, patch.twin(e)].into_iter().filter(|&h| h != NONE);
    let around = ring.iter().copied().chain(sides);
    let own = around.flat_map(|h| [h, next(h), previous(h)]);
    own.flat_map(|h| [h, patch.twin(h)])
        .filter(|&h| h != NONE)
        .collect()
}

/// Square of an edge's length over the one wanted; infinite for an edge that may not be collapsed,
/// and for the second half-edge of an edge.
fn squared_share(patch: &Patch, e: u32) -> f64 {
    let f = patch.twin(e);
    if !patch.is_alive(e / 3) || (f != NONE && f < e) {
        return f64::INFINITY;
    }
    let (a, b) = (patch.origin(e), patch.end(e));
    if patch.frozen[a as usize] || patch.frozen[b as usize] {
        return f64::INFINITY;
    }
    squared_distance(patch.point(a), patch.point(b)) / patch.wanted(a, b).powi(2)
}

/// Whether v may be drawn into u along half-edge e, which joins them in either direction; fills
/// `ring` with the half-edges that leave v. No new edge may be `long` times what is wanted.
pub(super) fn may_collapse(
    patch: &Patch,
    e: u32,
    v: u32,
    u: u32,
    long: f64,
    ring: &mut Vec<u32>,
) -> bool {
    let border = patch.twin(e) == NONE;
    let movable = match patch.vertices[v as usize].kind {
        Kind::Interior => true,
        Kind::Boundary => border,
        Kind::Corner => false,
    };
    if !movable || patch.frozen[v as usize] || patch.frozen[u as usize] {
        return false;
    }
    ring.clear();
    ring.extend(patch.around(v));
    keeps_topology(patch, e, u, ring) && keeps_shape(patch, v, u, long, ring)
}

fn keeps_topology(patch: &Patch, e: u32, u: u32, ring: &[u32]) -> bool {
    let sides = [e, patch.twin(e)];
    for h in sides.into_iter().filter(|&h| h != NONE) {
        let c = patch.opposite(h) as usize;
        let lone = patch.twin(next(h)) == NONE && patch.twin(previous(h)) == NONE;
        let least = if patch.vertices[c].is_boundary() {
            2
        } else {
            3
        };
        let least_here = if patch.frozen[c] { 2 } else { 1 };
        if lone || patch.valence[c] <= least || patch.fan[c] <= least_here {
            return false;
        }
    }
    // Neighbours of v: the ends of the ring, and on a boundary the last one's opposite corner.
    let mut common = 0;
    let mut count = |q: u32| common += usize::from(q != u && patch.joined(u, q));
    for &h in ring {
        count(patch.end(h));
    }
    if let Some(&last) = ring
        .last()
        .filter(|&&last| patch.twin(previous(last)) == NONE)
    {
        count(patch.opposite(last));
    }
    common == sides.iter().filter(|&&h| h != NONE).count()
}

fn keeps_shape(patch: &Patch, v: u32, u: u32, long: f64, ring: &[u32]) -> bool {
    let place = patch.point(u);
    let mut sharpest: f64 = 1.0;
    let mut sharpest_before: f64 = 1.0;
    for &h in ring {
        let (x, y) = (patch.end(h), patch.opposite(h));
        let [px, py] = [x, y].map(|p| patch.point(p));
        sharpest_before = sharpest_before.min(sine_of_smallest_angle([patch.point(v), px, py]));
        if x == u || y == u {
            continue;
        }
        let longest = long * patch.wanted(u, x);
        if squared_distance(place, px) > longest * longest
            || !facing(patch, [u, x, y], [place, px, py])
        {
            return false;
        }
        sharpest = sharpest.min(sine_of_smallest_angle([place, px, py]));
    }
    sharpest >= SHARP.min(sharpest_before)
}
