//! Surface → surface midway: every point moves to the middle between both faces of the label.
//!
//! A profile has its crest midway only where the sheet is flat and as thick on both sides. The faces
//! themselves have no such bias: from each point both are looked for along the normal
//! (`thickness.rs`), and half the difference of their distances is how far the point is off. Faces
//! are known to about a voxel, so the figure is averaged over the surface around, which, being a
//! number along the normals, neither shrinks nor bends what is curved.

use crate::bricks::Batch;
use crate::buckets::{self, Buckets};
use crate::error::{zeros, Result};
use crate::execution::Execution;
use crate::grid::{along, dot, Vec3};
use crate::halfedge::Fans;
use crate::interpolation::Sampler;
use crate::manifold::Surface;
use crate::mask::Mask;
use crate::normals::{average_normals, normal_of_fan};
use crate::ray::Inside;
use crate::thickness::View;

/// Sheet fraction below which the faces seen may be a rim's.
const INSIDE: f64 = 0.7;
/// Below this sheet fraction a rim is near, with few points to average over.
const WHOLE: f64 = 0.95;
/// Where the border of the volume holds more than this share of a step along the normal back, what
/// is left would be a long way along the border: the point stays.
const STEEP: f64 = 0.5;
/// A point sees both faces if this much before a ray meets one, work units, the outside is at least
/// this share of that away.
const BEFORE: f64 = 4.0;
const ACROSS: f64 = 0.5;
/// Times that points are moved, with normals of their own each time: the rounds of averaging over
/// neighbouring points, whose number is the variance in about two squared edges of the contour; by
/// how much a point may be off, work units; and that one in so many points looks for the faces,
/// since where many are averaged a few say as much. What is seen gets surer with each move.
const MOVES: [Move; 4] = [(12, 2.0, 4), (9, 1.0, 2), (7, 0.8, 2), (6, 0.7, 1)];
type Move = (usize, f64, u8);
/// Rounds of averaging normals: along rough ones neighbours would move apart, and fold the surface.
const NORMAL_ROUNDS: usize = 6;
/// Points handed to a worker at a time.
const PIECE: usize = 1024;
/// Passes over the points that [`move_midway`] makes, for its progress.
pub(crate) const PASSES: usize = {
    let rounds = MOVES[0].0 + MOVES[1].0 + MOVES[2].0 + MOVES[3].0;
    buckets::PASSES + MOVES.len() * (2 + NORMAL_ROUNDS) + rounds
};

/// How far off each point is, and how much of that was seen there.
type Seen = [f32; 2];

/// What is known of the label where a surface is moved.
pub(crate) struct Label<'a> {
    pub batch: &'a Batch<'a>,
    /// Distance to the outside at the voxels, work units.
    pub distance: &'a [f32],
    pub mask: &'a Mask,
    /// Sheet fraction at each point.
    pub fraction: &'a [f64],
    /// The work spacing.
    pub h: Vec3,
}

/// Moves the points of `surface`, each with its part as source, midway.
pub(crate) fn move_midway(
    label: &Label,
    surface: &mut Surface,
    execution: &mut Execution,
) -> Result<()> {
    let fans = Fans::new(&surface.triangles, surface.points.len())?;
    let neighbours = fans.neighbours(&surface.triangles, execution)?;
    for step in MOVES {
        move_once(label, surface, (&fans, &neighbours), step, execution)?;
    }
    Ok(())
}

fn move_once(
    label: &Label,
    surface: &mut Surface,
    (fans, neighbours): (&Fans, &Buckets<u32>),
    (rounds, most, one_in): Move,
    execution: &mut Execution,
) -> Result<()> {
    let mut rough: Vec<Vec3> = zeros(surface.points.len())?;
    execution.fill(&mut rough, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let leaving = fans.of((PIECE * piece + i) as u32);
            *out = normal_of_fan(&surface.points, &surface.triangles, leaving);
        }
    })?;
    let normals = average_normals(rough, neighbours, NORMAL_ROUNDS, execution)?;
    let mut seen = look(label, surface, &normals, (most, one_in), execution)?;
    let mut averaged: Vec<Seen> = zeros(seen.len())?;
    for _ in 0..rounds {
        execution.fill(&mut averaged, PIECE, |piece, out| {
            for (i, out) in out.iter_mut().enumerate() {
                *out = mean(&seen, neighbours, PIECE * piece + i);
            }
        })?;
        std::mem::swap(&mut averaged, &mut seen);
    }
    let Label { batch, h, .. } = label;
    let last: Vec3 = std::array::from_fn(|a| {
        batch
            .directories
            .first()
            .map_or(0.0, |d| (d.dimensions[a] as f64 - 1.0) * h[a])
    });
    for ((p, n), [off, weight]) in surface.points.iter_mut().zip(&normals).zip(&seen) {
        if *weight > 1e-3 {
            *p = within_volume(*p, *n, f64::from(off / weight), last);
        }
    }
    Ok(())
}

/// How far off the points are that look: up to `most`, and one in so many where no rim is near.
fn look(
    label: &Label,
    surface: &Surface,
    normals: &[Vec3],
    (most, one_in): (f64, u8),
    execution: &mut Execution,
) -> Result<Vec<Seen>> {
    let mut seen: Vec<Seen> = zeros(surface.points.len())?;
    execution.fill(&mut seen, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let p = PIECE * piece + i;
            let point = surface.points[p];
            let fraction = label.fraction[p];
            // One that looks in place of others counts for them too.
            let stands_for = if fraction < WHOLE { 1 } else { one_in };
            if fraction < INSIDE || !is_one_in(stands_for, point, label.h) {
                continue;
            }
            let distance = Sampler {
                directory: &label.batch.directories[surface.source[p] as usize],
                field: label.distance,
                h: label.h,
            };
            let mask = label.mask;
            let view = View::new(&Inside { distance, mask }, point, normals[p]);
            let middle = view.to_middle.filter(|off| off.abs() <= most);
            if let Some(off) = middle.filter(|&off| sees_faces(&distance, point, &view, off)) {
                let weight = f32::from(stands_for);
                *out = [weight * off as f32, weight];
            }
        }
    })?;
    Ok(seen)
}

/// Whether a point is one in so many, which its voxel alone decides: by a multiplicative hash (Knuth),
/// since anything regular would leave out whole sheets of one direction.
fn is_one_in(one_in: u8, p: Vec3, h: Vec3) -> bool {
    let hash = (0..3).fold(0u64, |hash, a| {
        (hash ^ (p[a] / h[a]) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    });
    (hash >> 32) % u64::from(one_in) == 0
}

/// Whether both rays end at faces of the sheet, not at the wall of its rim: just before a ray meets
/// a face, the outside is about as near as that face.
fn sees_faces(distance: &Sampler, p: Vec3, view: &View, off: f64) -> bool {
    [1.0, -1.0].into_iter().all(|side| {
        let reach = 0.5 * view.thickness + side * off;
        let before = reach.min(BEFORE);
        let there = along(p, side * (reach - before), view.normal);
        distance.linear(there) >= ACROSS * before
    })
}

/// Moves a point along its normal; one on the border of the volume stays on the border.
fn within_volume(p: Vec3, n: Vec3, off: f64, last: Vec3) -> Vec3 {
    let on_border = |a: usize| p[a] <= 0.0 || p[a] >= last[a];
    let way: Vec3 = std::array::from_fn(|a| if on_border(a) { 0.0 } else { n[a] });
    let share = dot(way, way);
    if share < STEEP {
        return p;
    }
    let moved = along(p, off / share, way);
    std::array::from_fn(|a| moved[a].clamp(0.0, last[a]))
}

/// Mean over a point and its neighbours.
fn mean(seen: &[Seen], neighbours: &Buckets<u32>, p: usize) -> Seen {
    let neighbours = neighbours.of(p);
    let [off, weight] = neighbours.iter().fold(seen[p], |[off, weight], &q| {
        let [next_off, next_weight] = seen[q as usize];
        [off + next_off, weight + next_weight]
    });
    let count = (1 + neighbours.len()) as f32;
    [off / count, weight / count]
}
