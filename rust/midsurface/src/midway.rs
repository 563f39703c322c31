//! Surface → surface midway: every point moves to the middle between both faces of the label.
//!
//! A profile has its crest midway only where the sheet is flat and as thick on both sides. The faces
//! themselves have no such bias: from each point both are looked for along the normal
//! (`thickness.rs`), and half the difference of their distances is how far the point is off. Faces
//! are known to about a voxel, so the figure is averaged over the surface around, which, being a
//! number along the normals, neither shrinks nor bends what is curved.

use crate::bricks::Batch;
use crate::buckets::Buckets;
use crate::error::{zeros, Result};
use crate::execution::Execution;
use crate::grid::{along, dot, Vec3};
use crate::halfedge::Fans;
use crate::interpolation::Sampler;
use crate::manifold::Surface;
use crate::normals::{average_normals, normals, NORMAL_PASSES};
use crate::thickness::View;

/// Sheet fraction below which the faces seen may be a rim's.
const INSIDE: f64 = 0.7;
/// Where the border of the volume holds more than this share of a step along the normal back, what
/// is left would be a long way along the border: the point stays.
const STEEP: f64 = 0.5;
/// A point sees both faces if this much before a ray meets one, work units, the outside is at least
/// this share of that away.
const BEFORE: f64 = 4.0;
const ACROSS: f64 = 0.5;
/// Times that points are moved, with normals of their own each time: the rounds of averaging over
/// neighbouring points, whose number is the variance in about two squared edges of the contour, and
/// by how much a point may be off, work units. What is seen gets surer with each.
const MOVES: [(usize, f64); 4] = [(12, 2.0), (9, 1.0), (7, 0.8), (6, 0.7)];
/// Rounds of averaging normals: along rough ones neighbours would move apart, and fold the surface.
const NORMAL_ROUNDS: usize = 6;
/// Points handed to a worker at a time.
const PIECE: usize = 1024;
/// Passes over the points that [`move_midway`] makes, for its progress.
pub(crate) const PASSES: usize = {
    let rounds = MOVES[0].0 + MOVES[1].0 + MOVES[2].0 + MOVES[3].0;
    MOVES.len() * (1 + NORMAL_PASSES + NORMAL_ROUNDS) + rounds
};

/// How far off each point is, and how much of that was seen there.
type Seen = [f32; 2];

/// What is known of the label where a surface is moved.
pub(crate) struct Label<'a> {
    pub batch: &'a Batch<'a>,
    /// Distance to the outside at the voxels, work units.
    pub distance: &'a [f32],
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
    let fans = Fans::new(&surface.triangles, surface.points.len());
    let neighbours = fans.neighbours(&surface.triangles);
    for (rounds, most) in MOVES {
        move_once(
            label,
            surface,
            (&fans, &neighbours),
            (rounds, most),
            execution,
        )?;
    }
    Ok(())
}

fn move_once(
    label: &Label,
    surface: &mut Surface,
    (fans, neighbours): (&Fans, &Buckets<u32>),
    (rounds, most): (usize, f64),
    execution: &mut Execution,
) -> Result<()> {
    let Label {
        batch,
        distance,
        fraction,
        h,
    } = *label;
    let triangles = &surface.triangles;
    let rough = normals(&surface.points, triangles, fans, execution)?;
    let normals = &average_normals(rough, neighbours, NORMAL_ROUNDS, execution)?;
    let mut seen: Vec<Seen> = zeros(surface.points.len())?;
    let points = &surface.points;
    let source = &surface.source;
    execution.fill(&mut seen, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let p = PIECE * piece + i;
            if fraction[p] < INSIDE {
                continue;
            }
            let directory = &batch.directories[source[p] as usize];
            let sampler = Sampler {
                directory,
                field: distance,
                h,
            };
            let view = View::new(&sampler, points[p], normals[p]);
            let middle = view.to_middle.filter(|off| off.abs() <= most);
            if let Some(off) = middle.filter(|&off| sees_faces(&sampler, points[p], &view, off)) {
                *out = [off as f32, 1.0];
            }
        }
    })?;
    let mut averaged: Vec<Seen> = zeros(seen.len())?;
    for _ in 0..rounds {
        execution.fill(&mut averaged, PIECE, |piece, out| {
            for (i, out) in out.iter_mut().enumerate() {
                *out = mean(&seen, neighbours, PIECE * piece + i);
            }
        })?;
        std::mem::swap(&mut averaged, &mut seen);
    }
    let last: Vec3 = std::array::from_fn(|a| {
        batch
            .directories
            .first()
            .map_or(0.0, |d| (d.dimensions[a] as f64 - 1.0) * h[a])
    });
    for ((p, n), [off, weight]) in surface.points.iter_mut().zip(normals).zip(&seen) {
        if *weight > 1e-3 {
            *p = within_volume(*p, *n, f64::from(off / weight), last);
        }
    }
    Ok(())
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
