//! What is still poor after polishing is mended by trial.
//!
//! Polishing takes one step at a time, and stays where no single step makes a place better: about
//! one triangle in ten thousand. Here the neighbourhood of a fault is taken out, each change of
//! connectivity near the fault is tried in it, with the points around moved to suit it, and the best
//! outcome is put back, where it is better than what was there.
//!
//! A place where the surface itself is creased more sharply than triangles of this size can follow
//! stays as it is.

use rayon::prelude::*;

use super::blocks::Surface;
use super::collapse::may_collapse;
use super::flip::{flip_edges, may_flip};
use super::patch::{Kind, Patch, Vertex};
use super::polish::mend_poor;
use super::reference::Reference;
use super::relax::relax;
use super::shape::{facing, sine_of_smallest_angle};
use super::split::near_middle;
use crate::error::{collected, reserved, zeros, Result};
use crate::execution::Execution;
use crate::surface::halfedge::{next, previous, NONE};

/// Triangles up to this many edges from a fault are taken out with it.
const RINGS: u8 = 3;
/// A triangle whose smallest angle is below this sine's (30°) is a fault. Above it no angle is
/// over 120°.
pub(crate) const SHARP: f64 = 0.5;
/// What such a triangle costs, and each unit of sine that it lacks; a point with an odd number of
/// edges costs 1.
const SHARP_COST: f64 = 0.5;
const SINE_COST: f64 = 4.0;
/// Where all costs more than this, the surface is creased.
const CREASED: f64 = 5.0;
/// An outcome is better if it costs less by this.
const GAIN: f64 = 1e-3;
/// No new edge is so many times longer than wanted.
const LONG: f64 = 1.7;
/// Changes that threads try at once.
const AT_ONCE: usize = 16;
/// Times that points are moved after a change.
const RELAXATIONS: usize = 3;

/// A change of connectivity.
#[derive(Clone, Copy)]
enum Change {
    Flip(u32),
    Split(u32),
    Collapse(u32, u32, u32),
}

/// Mends the faults of a finished surface, one after the other: there are few.
pub(super) fn repair(
    surface: Surface,
    reference: &Reference,
    longest: f64,
    execution: &Execution,
) -> Result<Surface> {
    let near = near_faults(&surface)?;
    if !near.contains(&true) {
        return Ok(surface);
    }
    let (mut patch, points) = cut_out(&surface, &near, reference, longest)?;
    execution.in_pool(|| {
        let mut all = 0..patch.vertices.len() as u32;
        all.try_for_each(|p| match is_fault(&patch, p) {
            true => repair_at(&mut patch, p),
            false => Ok(()),
        })
    })?;
    put_back(&surface, &near, &patch, &points)
}

/// Which triangles lie so near a fault that mending it may change them.
fn near_faults(surface: &Surface) -> Result<Vec<bool>> {
    let Surface {
        vertices,
        triangles,
    } = surface;
    let mut valence: Vec<u16> = zeros(vertices.len())?;
    for &p in triangles.as_flattened() {
        valence[p as usize] = valence[p as usize].saturating_add(1);
    }
    // Rings around the faults, whose points are 1.
    let mut ring: Vec<u8> = zeros(vertices.len())?;
    for (p, vertex) in vertices.iter().enumerate() {
        let odd =
            vertex.kind == Kind::Interior && !vertex.is_frozen() && !(5..=7).contains(&valence[p]);
        ring[p] = u8::from(odd);
    }
    for t in triangles {
        if sine_of_smallest_angle(t.map(|p| vertices[p as usize].point)) < SHARP {
            t.iter().for_each(|&p| ring[p as usize] = 1);
        }
    }
    for reached in 1..=RINGS {
        for t in triangles {
            if t.iter().any(|&p| ring[p as usize] == reached) {
                for p in t.map(|p| p as usize) {
                    if ring[p] == 0 {
                        ring[p] = reached + 1;
                    }
                }
            }
        }
    }
    let is_near = |t: &[u32; 3]| t.iter().any(|&p| ring[p as usize] > 0);
    collected(triangles.iter().map(is_near))
}

/// The triangles near faults as a patch, with the numbers of its points in the surface.
fn cut_out<'a>(
    surface: &Surface,
    near: &[bool],
    reference: &'a Reference<'a>,
    longest: f64,
) -> Result<(Patch<'a>, Vec<u32>)> {
    let of_interest = || {
        surface
            .triangles
            .iter()
            .zip(near)
            .filter(|t| *t.1)
            .map(|t| t.0)
    };
    let mut points = collected(of_interest().flatten().copied())?;
    points.sort_unstable();
    points.dedup();
    let mut number: Vec<u32> = zeros(surface.vertices.len())?;
    for (i, &p) in points.iter().enumerate() {
        number[p as usize] = i as u32 + 1;
    }
    let local = |p: u32| number[p as usize].checked_sub(1);
    // Points with triangles beyond are frozen.
    let vertices = collected(points.iter().map(|&p| surface.vertices[p as usize]))?;
    let mut frozen = collected(vertices.iter().map(|v| v.is_frozen()))?;
    let beyond = |v: &Vertex| i32::from(v.is_boundary()) + i32::from(v.beyond);
    let mut valence = collected(vertices.iter().map(beyond))?;
    for (t, &near) in surface.triangles.iter().zip(near) {
        for p in t.iter().filter_map(|&p| local(p)) {
            valence[p as usize] += 1;
            frozen[p as usize] |= !near;
        }
    }
    let triangles = collected(of_interest().map(|t| t.map(|p| number[p as usize] - 1)))?;
    let patch = Patch::new(
        reference,
        (1.0, longest),
        vertices,
        frozen,
        valence,
        triangles,
    )?;
    Ok((patch, points))
}

/// The surface with the triangles near faults replaced.
fn put_back(surface: &Surface, near: &[bool], patch: &Patch, points: &[u32]) -> Result<Surface> {
    let most = surface.vertices.len() + patch.vertices.len();
    let mut mended = Surface {
        vertices: reserved(most)?,
        triangles: reserved(surface.triangles.len() + patch.triangles.len())?,
    };
    let mut number: Vec<u32> = zeros(most)?;
    let mut numbered = |place: usize, vertex: &Vertex| {
        if number[place] == 0 {
            mended.vertices.push(*vertex);
            number[place] = mended.vertices.len() as u32;
        }
        number[place] - 1
    };
    for (t, _) in surface.triangles.iter().zip(near).filter(|t| !t.1) {
        let t = t.map(|p| numbered(p as usize, &surface.vertices[p as usize]));
        mended.triangles.push(t);
    }
    for t in patch.triangles.iter().filter(|t| t[0] != NONE) {
        // Points that the patch made come after all others.
        let place = |p: usize| {
            points
                .get(p)
                .map_or(surface.vertices.len() + p, |&p| p as usize)
        };
        let t = t.map(|p| numbered(place(p as usize), &patch.vertices[p as usize]));
        mended.triangles.push(t);
    }
    Ok(mended)
}

/// Whether a point that is not frozen has an odd number of edges, or the first corner of a sharp
/// triangle.
fn is_fault(patch: &Patch, p: u32) -> bool {
    if patch.frozen[p as usize] || patch.is_removed(p) {
        return false;
    }
    is_odd(patch, p)
        || patch.around(p).any(|e| {
            let t = patch.triangles[e as usize / 3];
            let first = t.into_iter().find(|&q| !patch.frozen[q as usize]);
            first == Some(p) && sine(patch, t) < SHARP
        })
}

/// Whether an interior point has fewer than five or more than seven edges.
fn is_odd(patch: &Patch, p: u32) -> bool {
    let interior = patch.vertices[p as usize].kind == Kind::Interior;
    interior && (patch.valence[p as usize] - 6).abs() > 1
}

fn sine(patch: &Patch, triangle: [u32; 3]) -> f64 {
    sine_of_smallest_angle(triangle.map(|p| patch.point(p)))
}

fn repair_at(patch: &mut Patch, p: u32) -> Result<()> {
    let place = patch.neighbourhood(p, RINGS)?;
    let before = cost(&place.patch);
    if before > CREASED {
        return Ok(());
    }
    let mut best = before - GAIN;
    let mut found = None;
    for some in changes(&place.patch).chunks(AT_ONCE) {
        let outcomes: Vec<_> = some
            .par_iter()
            .map(|change| outcome(&place.patch, *change))
            .collect();
        for outcome in outcomes {
            let Some((cost, trial)) = outcome? else {
                continue;
            };
            if cost < best {
                best = cost;
                found = Some(trial);
            }
        }
        if best == 0.0 {
            break;
        }
    }
    if let Some(trial) = found {
        patch.put_back(place, trial)?;
    }
    Ok(())
}

/// What becomes of a patch by a change, and what is wrong in it then.
fn outcome<'a>(patch: &Patch<'a>, change: Change) -> Result<Option<(f64, Patch<'a>)>> {
    let mut trial = patch.clone();
    let is_made = apply(&mut trial, change)?;
    Ok(is_made.then(|| {
        settle(&mut trial, matches!(change, Change::Flip(_)));
        (cost(&trial), trial)
    }))
}

/// What is wrong in a patch.
fn cost(patch: &Patch) -> f64 {
    let alive = patch.triangles.iter().filter(|t| t[0] != NONE);
    let sharp = alive
        .map(|&t| SHARP - sine(patch, t))
        .filter(|&lack| lack > 0.0)
        .map(|lack| SHARP_COST + SINE_COST * lack)
        .sum::<f64>();
    let used = |p: &u32| !patch.is_removed(*p);
    let points = (0..patch.vertices.len() as u32).filter(used);
    sharp + points.filter(|&p| is_odd(patch, p)).count() as f64
}

/// The changes that are tried near point 0, the fault.
fn changes(patch: &Patch) -> Vec<Change> {
    let mut near: Vec<u32> = Vec::new();
    for e in patch.around(0) {
        near.extend([e, next(e), previous(e)]);
        let q = patch.end(e);
        if !patch.frozen[q as usize] {
            near.extend(patch.around(q).flat_map(|e| [e, next(e), previous(e)]));
        }
    }
    // Of an edge's two half-edges the first; NONE is the largest number.
    near.iter_mut().for_each(|e| *e = patch.twin(*e).min(*e));
    near.sort_unstable();
    near.dedup();
    let mut changes = Vec::new();
    for e in near {
        let (a, b) = (patch.origin(e), patch.end(e));
        changes.extend([
            Change::Flip(e),
            Change::Split(e),
            Change::Collapse(e, a, b),
            Change::Collapse(e, b, a),
        ]);
    }
    changes
}

/// Makes a change where the topology and the shape of the surface allow it.
fn apply(patch: &mut Patch, change: Change) -> Result<bool> {
    Ok(match change {
        Change::Flip(e) => {
            let allowed = patch.twin(e) != NONE && may_flip(patch, e) && keeps_facing(patch, e);
            if allowed {
                patch.flip(e);
            }
            allowed
        }
        Change::Split(e) => {
            let ends = [patch.origin(e), patch.end(e)];
            if patch.twin(e) == NONE && ends.iter().all(|&p| patch.frozen[p as usize]) {
                return Ok(false);
            }
            let Some(vertex) = near_middle(patch, e) else {
                return Ok(false);
            };
            patch.split(e, vertex)?;
            true
        }
        Change::Collapse(e, v, u) => {
            let mut ring = Vec::new();
            let allowed = may_collapse(patch, e, v, u, LONG, &mut ring);
            if allowed {
                patch.collapse(e, v, u, &ring);
            }
            allowed
        }
    })
}

fn keeps_facing(patch: &Patch, e: u32) -> bool {
    let [a, b, c] = [patch.origin(e), patch.end(e), patch.opposite(e)];
    let d = patch.opposite(patch.twin(e));
    [[c, a, d], [d, b, c]]
        .into_iter()
        .all(|corners| facing(patch, corners, corners.map(|p| patch.point(p))))
}

/// Lets the points around a change find their places, and but for a flip, which that would undo,
/// the edges too.
fn settle(patch: &mut Patch, flipped: bool) {
    for _ in 0..RELAXATIONS {
        if !flipped {
            flip_edges(patch);
        }
        relax(patch);
    }
    mend_poor(patch);
}
