//! Surface → surface midway: every point moves to the middle between both faces of the label.
//!
//! A profile has its crest midway only where the sheet is flat and as thick on both sides. The faces
//! themselves have no such bias: from each point both are looked for along the normal
//! (`look.rs`), and half the difference of their distances is how far the point is off. Faces
//! are known to about a voxel, so the figure is averaged over the surface around, which, being a
//! number along the normals, neither shrinks nor bends what is curved. Where sheets meet and none of
//! the points around sees both faces, the surface is made fair (`fairing.rs`).
//!
//! The finished mesh takes one more step: what a point alone sees is noise more than it is shape, so
//! it goes a small share of that way, as a Wiener filter would have it. Being off the middle falls in
//! proportion to that share. Normals pay for it: on the phantoms their mean error is 1.9° in place of
//! 1.1°, and 2.4° in place of 1.6° with noise.
//!
//! | step | file |
//! | --- | --- |
//! | the surface is led on beyond the border of the volume, and cut there in the end | `beyond.rs` |
//! | how far off the middle its points are | `look.rs` |
//! | where none of the points around sees both faces | `fairing.rs` |
//! | rims that voxels have made ragged | `rim_smoothing.rs` |
//! | rims where sheets meet are led on to the line where they do | `reach.rs`, `meeting.rs` |

pub(crate) mod beyond;
mod fairing;
mod look;
mod meeting;
pub(crate) mod reach;
pub(crate) mod rim_smoothing;

use rayon::prelude::*;

use crate::buckets::{self, Buckets};
use crate::error::{collected, zeros, Result};
use crate::execution::Execution;
use crate::fields::label::Label;
use crate::grid::{along, dot, on_border, Vec3};
use crate::surface::halfedge::Fans;
use crate::surface::manifold::Surface;
use crate::surface::normals::{average_normals, normal_of_fan};
use fairing::fair;
use look::{look, mean, Seen, AT_BORDER, WHOLE};

/// Where the border of the volume holds more than this share of a step along the normal back, what
/// is left would be a long way along the border: the point stays.
const STEEP: f64 = 0.5;
/// Times that points are moved, with normals of their own each time: the rounds of averaging over
/// neighbouring points, whose number is the variance in about two squared edges of the contour; by
/// how much a point may be off, work units; and that one in so many points looks for the faces,
/// since where many are averaged a few say as much. What is seen gets surer with each move.
const MOVES: [Move; 4] = [(12, 2.0, 4), (9, 1.0, 4), (7, 0.8, 2), (6, 0.7, 1)];
type Move = (usize, f64, u8);
/// At the border of the volume, where points lie on one side only and often see one face, so many times as
/// many rounds more.
const MORE_AT_BORDER: usize = 2;
/// Rounds of averaging normals: along rough ones neighbours would move apart, and fold the surface.
const NORMAL_ROUNDS: usize = 6;
/// Where fewer of the points around see both faces than this share, the surface is made fair.
const SIGHT: f32 = 0.8;
/// Points handed to a worker at a time.
const PIECE: usize = 1024;
/// The share of the way that a point of the finished mesh goes by itself, and from where on what it
/// sees is a bump of noise, work units: a voxel flipped on a face shows as half of one.
const OWN_SHARE: f64 = 0.155;
const BUMP: f64 = 0.4;
/// Passes over the points that [`move_closer`] makes, for its progress.
pub(crate) const CLOSER_PASSES: usize = 1;
/// Passes over the points that [`move_midway`] makes, for its progress.
pub(crate) const PASSES: usize = {
    let rounds = MOVES[0].0 + MOVES[1].0 + MOVES[2].0 + MOVES[3].0;
    buckets::PASSES + MOVES.len() * (2 + NORMAL_ROUNDS) + rounds + fairing::PASSES
};

/// Moves the points of a finished surface, with their parts as sources and with their normals, a
/// little closer to the middle that each sees.
pub(crate) fn move_closer(
    label: &Label,
    surface: &mut Surface,
    normals: &[Vec3],
    execution: &mut Execution,
) -> Result<()> {
    let mut moved: Vec<Vec3> = zeros(surface.points.len())?;
    let last = label.last();
    execution.fill(&mut moved, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let p = PIECE * piece + i;
            let (point, normal) = (surface.points[p], normals[p]);
            let faces = label.faces(surface.source[p], point, normal);
            let off = faces.map(|[ahead, behind]| 0.5 * (ahead - behind));
            *out = match off.filter(|off| off.abs() <= BUMP) {
                Some(off) => within_volume(point, normal, OWN_SHARE * off, last),
                None => point,
            };
        }
    })?;
    surface.points = moved;
    Ok(())
}

/// Moves the points of `surface`, each with its part as source and the sheet fraction there, midway.
pub(crate) fn move_midway(
    label: &Label,
    surface: &mut Surface,
    fraction: &[f64],
    fans: &Fans,
    execution: &mut Execution,
) -> Result<()> {
    let neighbours = fans.neighbours(&surface.triangles, execution)?;
    let (mut normals, mut seen) = (Vec::new(), Vec::new());
    for step in MOVES {
        (normals, seen) = move_once(
            label,
            (surface, fraction),
            (fans, &neighbours),
            step,
            execution,
        )?;
    }
    let blind = blind(surface, fraction, &seen, (fans, &neighbours))?;
    let off = fair(surface, &normals, &blind, (fans, &neighbours), execution)?;
    for (p, off) in off {
        let p = p as usize;
        surface.points[p] = along(surface.points[p], off, normals[p]);
    }
    Ok(())
}

/// Whether each point is where too few see both faces, though no rim of the label is near, and none
/// of the surface, either.
fn blind(
    surface: &Surface,
    fraction: &[f64],
    seen: &[Seen],
    (fans, neighbours): (&Fans, &Buckets<u32>),
) -> Result<Vec<bool>> {
    let is_on_rim = |&p: &u32| fans.is_boundary(&surface.triangles, p);
    let around = |&p: &u32| neighbours.of(p as usize).iter();
    let is_inside = |p: u32| {
        let mut near = around(&p).flat_map(around);
        !near.any(is_on_rim)
    };
    let points = fraction.iter().zip(seen).enumerate();
    let is_blind = |(p, (fraction, [_, weight])): (usize, (&f64, &Seen))| {
        *fraction >= WHOLE && *weight < SIGHT && is_inside(p as u32)
    };
    collected(points.map(is_blind))
}

/// Moves the points once; the normals along which, and what was seen around each.
fn move_once(
    label: &Label,
    (surface, fraction): (&mut Surface, &[f64]),
    (fans, neighbours): (&Fans, &Buckets<u32>),
    (rounds, most, one_in): Move,
    execution: &mut Execution,
) -> Result<(Vec<Vec3>, Vec<Seen>)> {
    let mut rough: Vec<Vec3> = zeros(surface.points.len())?;
    execution.fill(&mut rough, PIECE, |piece, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let leaving = fans.of((PIECE * piece + i) as u32);
            *out = normal_of_fan(&surface.points, &surface.triangles, leaving);
        }
    })?;
    let normals = average_normals(rough, neighbours, NORMAL_ROUNDS, execution)?;
    let mut seen = look(
        label,
        (surface, fraction),
        &normals,
        fans,
        (most, one_in),
        execution,
    )?;
    let mut averaged: Vec<Seen> = zeros(seen.len())?;
    for _ in 0..rounds {
        execution.fill(&mut averaged, PIECE, |piece, out| {
            for (i, out) in out.iter_mut().enumerate() {
                *out = mean_around(&seen, neighbours, PIECE * piece + i);
            }
        })?;
        std::mem::swap(&mut averaged, &mut seen);
    }
    let at_border = at_one_border(&surface.points, label.last())?;
    let more = MORE_AT_BORDER * rounds;
    average_more(&at_border, neighbours, more, &mut seen, execution)?;
    for ((p, n), [off, weight]) in surface.points.iter_mut().zip(&normals).zip(&seen) {
        if *weight > 1e-3 {
            *p = along(*p, f64::from(off / weight), *n);
        }
    }
    Ok((normals, seen))
}

/// The points near one border of the volume. Near two the contour may be off by more than wide means can
/// mend.
fn at_one_border(points: &[Vec3], last: Vec3) -> Result<Vec<usize>> {
    let is_near = |p: Vec3, a: usize| p[a].min(last[a] - p[a]) < AT_BORDER;
    let is_at_one = |p: Vec3| (0..3).filter(|&a| is_near(p, a)).count() == 1;
    collected((0..points.len()).filter(|&p| is_at_one(points[p])))
}

/// Averages what `some` of the points see over more of the surface, so many rounds.
fn average_more(
    some: &[usize],
    neighbours: &Buckets<u32>,
    rounds: usize,
    seen: &mut [Seen],
    execution: &Execution,
) -> Result<()> {
    let mut averaged: Vec<Seen> = zeros(some.len())?;
    for _ in 0..rounds {
        let before = &*seen;
        execution.in_pool(|| {
            let all = averaged.par_iter_mut().with_min_len(PIECE).zip(some);
            all.for_each(|(averaged, &p)| *averaged = mean_around(before, neighbours, p));
        });
        for (&p, averaged) in some.iter().zip(&averaged) {
            seen[p] = *averaged;
        }
    }
    Ok(())
}

/// Mean of what is seen at a point and those around it.
fn mean_around(seen: &[Seen], neighbours: &Buckets<u32>, p: usize) -> Seen {
    let around = neighbours.of(p).iter();
    mean(seen[p], around.map(|&q| seen[q as usize]))
}

/// Moves a point along its normal; one on the border of the volume stays on the border.
fn within_volume(p: Vec3, n: Vec3, off: f64, last: Vec3) -> Vec3 {
    let on_border = on_border(p, last);
    let way: Vec3 = std::array::from_fn(|a| if on_border[a] { 0.0 } else { n[a] });
    let share = dot(way, way);
    if share < STEEP {
        return p;
    }
    let moved = along(p, off / share, way);
    std::array::from_fn(|a| moved[a].clamp(0.0, last[a]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_is_averaged_near_one_border_and_not_near_two() {
        let points = [
            [1.0, 50.0, 50.0],
            [-1.0, 50.0, 50.0],
            [50.0, 50.0, 95.0],
            [50.0, 50.0, 50.0],
            [1.0, 50.0, 94.0],
            [-1.0, -1.0, 50.0],
        ];
        assert_eq!(at_one_border(&points, [95.0; 3]).unwrap(), [0, 1, 2]);
    }
}
