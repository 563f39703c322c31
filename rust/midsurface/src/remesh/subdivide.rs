//! Every triangle becomes four: each edge gets a point in its middle, or only those that are too long.
//!
//! The new points have six edges each, four on a boundary, so that a coarse mesh of good triangles
//! becomes a fine one in which three points out of four are regular, and the costly changes of
//! connectivity are made where there are four times fewer triangles.

use super::blocks::Surface;
use super::patch::Vertex;
use super::reference::Reference;
use super::split::{middle_anyway, LONG};
use crate::error::{check_count, filled, push, reserved, zeros, Result};
use crate::execution::Execution;
use crate::grid::squared_distance;
use crate::surface::halfedge::{ends, next, previous, twins_if_wound, NONE};

/// Edges or triangles handed to a worker at a time.
const PIECE: usize = 4096;
/// The longest edges that passes can begin with, as multiples of those wanted: across the border of a
/// block longer ones stay, and what is made short beside them folds.
const LONGEST: f64 = 4.0;
/// A triangle with a side so many times as long as another is a needle. In a lattice of these whose long
/// sides are hardly too short to be split, short ones cannot be collapsed without making one too long.
const NEEDLE: f64 = 2.5;
/// Rounds of halving, at most.
const HALVINGS: usize = 16;

/// Halves edges until none is far longer than `wanted`, and those of needles that would never be split.
pub(super) fn halve_long(
    mut surface: Surface,
    wanted: f64,
    reference: &Reference,
    execution: &mut Execution,
) -> Result<Surface> {
    for _ in 0..HALVINGS {
        let count = surface.triangles.len();
        let is_wanted = |e: u32| squared_length(&surface, e) < wanted * wanted;
        if (0..3 * count as u32).all(is_wanted) {
            break;
        }
        surface = subdivide(&surface, wanted, reference, execution)?;
        if surface.triangles.len() == count {
            break;
        }
    }
    Ok(surface)
}

/// Whether passes would fail at an edge, longer than `wanted`.
fn is_long(surface: &Surface, twins: &[u32], e: u32, wanted: f64) -> bool {
    let own = squared_length(surface, e);
    let is_at_least = |times: f64| own >= (times * wanted).powi(2);
    if !is_at_least(1.0) || is_at_least(LONG) {
        return is_at_least(LONGEST);
    }
    let beside = [e, twins[e as usize]].into_iter().filter(|&e| e != NONE);
    let sides = beside.flat_map(|e| [next(e), previous(e)]);
    let shortest = sides
        .map(|e| squared_length(surface, e))
        .fold(own, f64::min);
    own >= NEEDLE * NEEDLE * shortest
}

/// Halves all edges that are long for what is `wanted`, or all where that is 0; the new points lie on the
/// reference.
pub(super) fn subdivide(
    surface: &Surface,
    wanted: f64,
    reference: &Reference,
    execution: &mut Execution,
) -> Result<Surface> {
    let old = &surface.triangles;
    check_count("triangles", 4 * old.len(), 3)?;
    let count = surface.vertices.len();
    let twins = twins_if_wound(old, count)?;
    // Beside triangles that are not remeshed edges stay whole.
    let is_kept = |e: usize| {
        let (a, b) = ends(old, e as u32);
        let is_frozen = |p: u32| surface.vertices[p as usize].is_frozen();
        (twins[e] == NONE && is_frozen(a) && is_frozen(b))
            || !is_long(surface, &twins, e as u32, wanted)
    };
    // The point in the middle of the edge that each half-edge belongs to, and the first half-edge of each.
    let mut middle: Vec<u32> = filled(NONE, twins.len())?;
    let mut firsts: Vec<u32> = Vec::new();
    for (e, &twin) in twins.iter().enumerate() {
        if twin != NONE && (twin as usize) < e {
            middle[e] = middle[twin as usize];
        } else if !is_kept(e) {
            middle[e] = (count + firsts.len()) as u32;
            push(&mut firsts, e as u32)?;
        }
    }
    let mut middles = filled(Vertex::default(), firsts.len())?;
    execution.fill(&mut middles, PIECE, |piece, out| {
        for (i, vertex) in out.iter_mut().enumerate() {
            let e = firsts[piece * PIECE + i];
            let (a, b) = ends(old, e);
            let ends = [a, b].map(|p| &surface.vertices[p as usize]);
            *vertex = middle_anyway(reference, ends, twins[e as usize] == NONE);
        }
    })?;
    let mut triangles: Vec<[u32; 3]> = zeros(4 * old.len())?;
    execution.fill(&mut triangles, 4 * PIECE, |piece, out| {
        for (i, four) in out.chunks_exact_mut(4).enumerate() {
            let t = piece * PIECE + i;
            let [a, b, c] = old[t];
            let [d, e, f] = [0, 1, 2].map(|k| middle[3 * t + k]);
            let kept = [d, e, f].map(|middle| middle == NONE);
            four.copy_from_slice(&match kept.iter().filter(|kept| **kept).count() {
                0 => [[a, d, f], [d, b, e], [f, e, c], [d, e, f]],
                _ => fewer([[a, d], [b, e], [c, f]], kept),
            });
        }
    })?;
    triangles.retain(|t| t[0] != NONE);
    let mut vertices = reserved(count + middles.len())?;
    vertices.extend_from_slice(&surface.vertices);
    vertices.extend(middles);
    Ok(Surface {
        vertices,
        triangles,
    })
}

fn squared_length(surface: &Surface, e: u32) -> f64 {
    let (a, b) = ends(&surface.triangles, e);
    let [a, b] = [a, b].map(|p| surface.vertices[p as usize].point);
    squared_distance(a, b)
}

/// The triangles that a triangle of which some edges are kept becomes; there may be less than four. Each
/// corner comes with the middle of the edge that leaves it.
fn fewer(corners: [[u32; 2]; 3], kept: [bool; 3]) -> [[u32; 3]; 4] {
    const NOTHING: [u32; 3] = [NONE; 3];
    let turned = |k: usize| -> [[u32; 2]; 3] { std::array::from_fn(|i| corners[(k + i) % 3]) };
    let count = kept.iter().filter(|kept| **kept).count();
    // The one edge that is kept, or the one that is not, is the first.
    let first = kept.iter().position(|kept| *kept == (count == 1));
    let [[a, d], [b, e], [c, f]] = turned(first.unwrap_or(0));
    match count {
        1 => [[f, e, c], [a, b, e], [a, e, f], NOTHING],
        2 => [[a, d, c], [d, b, c], NOTHING, NOTHING],
        _ => [[a, b, c], NOTHING, NOTHING, NOTHING],
    }
}
