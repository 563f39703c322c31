//! Edges are turned so that points come nearer to six edges, four on a boundary, and where that
//! makes no difference, so that the smallest angle opens.

use super::patch::{Kind, Patch};
use super::polish::POOR;
use super::shape::{facing, sine_of_smallest_angle};
use crate::grid::squared_distance;
use crate::surface::halfedge::NONE;

/// A flip for the sake of valence may not leave an angle below this sine's (15°), unless one was
/// there before.
const SHARP: f64 = 0.26;
/// Loss of valence that a flip may cost for the sake of a poor triangle: less than it costs to make
/// a point one edge too many off.
const MOST_LOST: i32 = 8;
/// A flip for the sake of shape opens the smallest angle's sine by at least this.
const GAIN: f64 = 0.01;

/// Flips edges once where that improves the patch.
pub(super) fn flip_edges(patch: &mut Patch) {
    for e in 0..patch.twins.len() as u32 {
        let f = patch.twin(e);
        if f != NONE && f > e && patch.is_alive(e / 3) && is_better(patch, e, false) {
            patch.flip(e);
        }
    }
}

/// Flips edges of poor triangles once, where that opens their smallest angle.
pub(super) fn flip_edges_of(patch: &mut Patch, poor: &[u32]) {
    for e in poor.iter().flat_map(|&t| 3 * t..3 * t + 3) {
        if patch.twin(e) != NONE && is_better(patch, e, true) {
            patch.flip(e);
        }
    }
}

/// How far a number of edges is from the best for a point; more than one off in the interior is
/// to be had nowhere.
pub(super) fn excess(kind: Kind, valence: i32) -> i32 {
    let best = match kind {
        Kind::Interior => 6,
        Kind::Boundary => 4,
        Kind::Corner => 3,
    };
    let off = valence - best;
    let far = match kind {
        Kind::Interior => 20,
        _ => 2,
    };
    off * off + if off.abs() > 1 { far } else { 0 }
}

/// Change of the sum of [`excess`] for changes of some points' numbers of edges.
pub(super) fn change<const N: usize>(patch: &Patch, changes: [(u32, i32); N]) -> i32 {
    let mut sum = 0;
    for (p, by) in changes {
        let (kind, valence) = (patch.vertices[p as usize].kind, patch.valence[p as usize]);
        sum += excess(kind, valence + by) - excess(kind, valence);
    }
    sum
}

/// Whether a flip of half-edge e makes the patch better: for its valences, or `poor`, for the worst
/// angle at almost any cost.
fn is_better(patch: &Patch, e: u32, poor: bool) -> bool {
    let f = patch.twin(e);
    let [a, b, c] = [patch.origin(e), patch.end(e), patch.opposite(e)];
    let d = patch.opposite(f);
    let gain = -change(patch, [(a, -1), (b, -1), (c, 1), (d, 1)]);
    let lost = if poor { MOST_LOST } else { 0 };
    if gain < -lost {
        return false;
    }
    let [pa, pb, pc, pd] = [a, b, c, d].map(|p| patch.point(p));
    // The longer diagonal hardly opens an angle.
    if gain <= 0 && squared_distance(pc, pd) >= squared_distance(pa, pb) {
        return false;
    }
    let old = sine_of_smallest_angle([pa, pb, pc]).min(sine_of_smallest_angle([pb, pa, pd]));
    let new = sine_of_smallest_angle([pc, pa, pd]).min(sine_of_smallest_angle([pd, pb, pc]));
    let better = match (poor, gain > 0) {
        (true, _) => old < POOR && new > old + GAIN,
        (false, true) => new >= SHARP.min(old),
        (false, false) => new > old + GAIN,
    };
    better
        && may_flip(patch, e)
        && facing(patch, [c, a, d], [pc, pa, pd])
        && facing(patch, [d, b, c], [pd, pb, pc])
}

/// Whether the topology allows half-edge e to be flipped.
pub(super) fn may_flip(patch: &Patch, e: u32) -> bool {
    let (c, d) = (patch.opposite(e), patch.opposite(patch.twin(e)));
    let keeps_edges = |p: u32| {
        let p = p as usize;
        let least = if patch.vertices[p].is_boundary() {
            2
        } else {
            3
        };
        patch.valence[p] > least && (!patch.frozen[p] || patch.fan[p] > 2)
    };
    if !keeps_edges(patch.origin(e)) || !keeps_edges(patch.end(e)) || c == d {
        return false;
    }
    match (patch.frozen[c as usize], patch.frozen[d as usize]) {
        (true, true) => false,
        (false, _) => !patch.joined(c, d),
        (true, false) => !patch.joined(d, c),
    }
}
