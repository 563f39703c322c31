//! Short edges are drawn together.
//!
//! One end of the edge is drawn into the other, whose place stays. The link condition (Dey et al.
//! 1999) keeps the topology: the ends may have no neighbours in common but the corners opposite
//! the edge. The triangles that are dragged along may neither fold nor become slivers.

use super::patch::{Kind, Patch};
use super::shape::{facing, squared_sine};
use crate::error::{collected, Result};
use crate::grid::squared_distance;
use crate::surface::halfedge::{next, previous, NONE};

/// An edge this much shorter than wanted is collapsed (Botsch and Kobbelt 2004).
const SHORT: f64 = 4.0 / 5.0;
/// No collapse makes an edge this much longer than wanted.
const LONG: f64 = 4.0 / 3.0;
/// The shortest edges go first: the limit grows from sweep to sweep, as shares of [`SHORT`].
const SWEEPS: [f64; 5] = [0.4, 0.6, 0.8, 1.0, 1.0];
/// No collapse makes an angle smaller than this sine's (12°), unless one was there before.
const SHARP: f64 = 0.2;
/// In place of the share of an edge that a collapse has changed, until it is asked for.
const STALE: f64 = -1.0;

/// Collapses edges that are too short, where that is possible.
pub(super) fn collapse_short_edges(patch: &mut Patch) -> Result<()> {
    let mut ring = Vec::new();
    let all = 0..patch.twins.len() as u32;
    let mut shares = collected(all.map(|e| squared_share(patch, e)))?;
    let shortest = shares.iter().copied().fold(f64::INFINITY, f64::min);
    for share in SWEEPS {
        let limit = (share * SHORT).powi(2);
        if shortest >= limit {
            continue;
        }
        for e in 0..patch.twins.len() as u32 {
            if shares[e as usize] == STALE {
                shares[e as usize] = squared_share(patch, e);
            }
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
                        changed_edges(patch, e, &ring).for_each(|h| shares[h as usize] = STALE);
                        patch.collapse(e, v, u, &ring);
                        break;
                    }
                }
            }
        }
    }
    Ok(())
}

/// The half-edges that change if half-edge e is collapsed, one of whose ends `ring` leaves: those of
/// the triangles around, and those across, two of which become one edge.
fn changed_edges<'a>(patch: &'a Patch, e: u32, ring: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    let around = ring.iter().copied().chain([e, patch.twin(e)]);
    let own = around
        .filter(|&h| h != NONE)
        .flat_map(|h| [h, next(h), previous(h)]);
    own.flat_map(|h| [h, patch.twin(h)]).filter(|&h| h != NONE)
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
    squared_distance(patch.point(a), patch.point(b)) / patch.wanted_of(e).powi(2)
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
    // The topology hardly ever forbids it, and takes longer.
    keeps_shape(patch, u, long, ring) && keeps_topology(patch, e, u, ring)
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
    let around_u: Vec<u32> = patch
        .around(u)
        .flat_map(|h| [patch.end(h), patch.opposite(h)])
        .collect();
    let is_common = |&q: &u32| q != u && around_u.contains(&q);
    let common = patch.neighbours(ring).filter(is_common).count();
    common == sides.iter().filter(|&&h| h != NONE).count()
}

fn keeps_shape(patch: &Patch, u: u32, long: f64, ring: &[u32]) -> bool {
    let place = patch.point(u);
    let mut sharpest: f64 = 1.0;
    for &h in ring {
        let (x, y) = (patch.end(h), patch.opposite(h));
        if x == u || y == u {
            continue;
        }
        let [px, py] = [x, y].map(|p| patch.point(p));
        let longest = long * patch.wanted(u, x);
        if squared_distance(place, px) > longest * longest
            || !facing(patch, [u, x, y], [place, px, py])
        {
            return false;
        }
        sharpest = sharpest.min(squared_sine([place, px, py]));
    }
    let before = |&h: &u32| squared_sine(patch.corners(h / 3));
    sharpest >= SHARP * SHARP || sharpest >= ring.iter().map(before).fold(1.0, f64::min)
}
