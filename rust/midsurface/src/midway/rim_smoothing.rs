//! Surface → surface whose rims are smooth, so that voxels flipped at a rim do not show.
//!
//! A rim is cut where the sheet fraction (`contour/rim.rs`) is ½, which follows every voxel. Each of its points
//! moves, within the surface, to the parabola over arc length that fits the rim around it best (local
//! regression, Cleveland 1979), which neither shrinks nor straightens what is curved. The parabola also
//! tells how the rim bends: where a mask is smoothed its level set is drawn towards the centre by σ²κ/2,
//! as in motion by curvature, and that is given back. What lies behind a rim follows it, less from ring
//! to ring. Where a triangle would turn the points around it stay.
//!
//! Blind rims (`reach.rs`), which are none of the label's, stay, and so do points on the border of the
//! volume.

use crate::contour::rim::BLIND;
use crate::contour::rim::SIGMA;
use crate::error::{collected, extend, filled, push, zeros, Result};
use crate::execution::Execution;
use crate::grid::{along, cross, dot, length, on_border, sub, unit, Vec3};
use crate::surface::boundary::beside;
use crate::surface::halfedge::Fans;
use crate::surface::manifold::Surface;
use crate::surface::normals::normal_of_fan;
use crate::surface::region::Region;

/// How far along a rim to both sides a parabola is fitted, work units, but no farther than this share of
/// a whole loop; and the least number of points.
const REACH: f64 = 8.0;
const SHARE: f64 = 0.25;
const LEAST: usize = 6;
/// No point moves farther onto its parabola, and none gets back more, work units: a voxel flipped at a rim
/// shows as less of a spur or notch than this; what is more is shape, which stays the more the farther it
/// stands out.
const MOST: f64 = 0.25;
/// Rings of points behind a rim that follow it.
const RINGS: usize = 6;
/// A triangle turns no farther than this cosine: the points of one that does go half as far, in so many
/// rounds, and after that not at all; and the rounds in all.
const TURNED: f64 = 0.5;
const HALVED: usize = 5;
const ROUNDS: usize = 12;
/// Points handed to a worker at a time.
const PIECE: usize = 1024;
/// Passes over the points that [`smooth_rims`] makes.
pub(crate) const PASSES: usize = 2;

/// Points along a rim, with the surface's normal at each and the length of the edge behind it.
struct Rim {
    points: Vec<u32>,
    normals: Vec<Vec3>,
    edges: Vec<f64>,
    is_closed: bool,
    /// How far along the rim to both sides is near.
    reach: f64,
}

/// Smooths the rims of a consistently wound 2-manifold. `fraction` is the sheet fraction at its points,
/// the volume's last voxel is at `last`.
pub(crate) fn smooth_rims(
    surface: &mut Surface,
    fraction: &[f64],
    fans: &Fans,
    last: Vec3,
    execution: &mut Execution,
) -> Result<()> {
    let mut is_rim: Vec<bool> = zeros(surface.points.len())?;
    execution.fill(&mut is_rim, PIECE, |piece, out| {
        for (i, is_rim) in out.iter_mut().enumerate() {
            let p = PIECE * piece + i;
            *is_rim = fraction[p] < BLIND && fans.is_boundary(&surface.triangles, p as u32);
        }
    })?;
    let rims = rims(surface, fans, &is_rim, last)?;
    let of = |rim: &'_ Rim| 0..rim.points.len();
    let all = rims.iter().flat_map(|rim| of(rim).map(move |i| (rim, i)));
    let stays = |p: u32| on_border(surface.points[p as usize], last).contains(&true);
    let all = collected(all.filter(|(rim, i)| !stays(rim.points[*i])))?;
    let mut ways: Vec<Option<Vec3>> = filled(None, all.len())?;
    execution.fill(&mut ways, PIECE, |piece, out| {
        for (way, (rim, i)) in out.iter_mut().zip(&all[PIECE * piece..]) {
            *way = rim.way(surface, *i);
        }
    })?;
    let found = all.iter().zip(ways);
    let found = found.filter_map(|((rim, i), way)| Some((rim.points[*i], way?)));
    let (points, moves) = collected(found)?.into_iter().unzip();
    follow(surface, fans, (points, moves), last)
}

/// The rims between points that are on one, other than along a border of the volume.
fn rims(surface: &Surface, fans: &Fans, is_rim: &[bool], last: Vec3) -> Result<Vec<Rim>> {
    let after = |p: u32| {
        let [_, q] = beside(surface, fans, p);
        let q = q?;
        let [u, v] = [p, q].map(|p| on_border(surface.points[p as usize], last));
        let is_along_border = (0..3).any(|a| u[a] && v[a]);
        (is_rim[q as usize] && !is_along_border).then_some(q)
    };
    let all = 0..is_rim.len() as u32;
    let some = collected(all.filter(|&p| is_rim[p as usize]))?;
    let next = collected(some.iter().map(|&p| after(p)))?;
    let number = |p: u32| some.binary_search(&p).ok();
    let mut is_first = filled(true, some.len())?;
    for i in next.iter().filter_map(|q| number((*q)?)) {
        is_first[i] = false;
    }
    let mut is_done = filled(false, some.len())?;
    let mut rims = Vec::new();
    let firsts = (0..some.len()).filter(|&i| is_first[i]);
    for first in firsts.chain(0..some.len()) {
        let (mut at, mut points) = (Some(first), Vec::new());
        while let Some(i) = at.filter(|&i| !is_done[i]) {
            is_done[i] = true;
            push(&mut points, some[i])?;
            at = next[i].and_then(number);
        }
        if points.len() >= LEAST {
            push(
                &mut rims,
                Rim::new(surface, fans, points, !is_first[first])?,
            )?;
        }
    }
    Ok(rims)
}

impl Rim {
    fn new(surface: &Surface, fans: &Fans, points: Vec<u32>, is_closed: bool) -> Result<Self> {
        let place = |i: usize| surface.points[points[i % points.len()] as usize];
        let edge = |i: usize| length(sub(place(i + 1), place(i)));
        let edges = collected((0..points.len()).map(edge))?;
        let reach = if is_closed {
            // By length, since the loop may begin anywhere.
            let mut sorted = collected(edges.iter().copied())?;
            sorted.sort_unstable_by(f64::total_cmp);
            REACH.min(SHARE * sorted.iter().sum::<f64>())
        } else {
            REACH
        };
        let normal = |&p: &u32| normal_of_fan(&surface.points, &surface.triangles, fans.of(p));
        Ok(Self {
            normals: collected(points.iter().map(normal))?,
            points,
            edges,
            is_closed,
            reach,
        })
    }

    /// The points within reach of one, itself first: their numbers and how far along the rim they are,
    /// counted from it, so that it does not matter where the rim begins.
    fn near(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let here = std::iter::once((i, 0.0));
        here.chain(self.onward(i, Self::after))
            .chain(self.onward(i, Self::before))
    }

    /// The points within reach of one, one `step` after the other.
    fn onward<'a>(
        &'a self,
        i: usize,
        step: impl Fn(&Self, usize) -> Option<(usize, f64)> + 'a,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let next = move |&(j, way): &(usize, f64)| {
            let (k, edge) = step(self, j)?;
            let way = way + edge;
            (k != i && way.abs() < self.reach).then_some((k, way))
        };
        std::iter::successors(next(&(i, 0.0)), next)
    }

    /// The next point, and the way there.
    fn after(&self, i: usize) -> Option<(usize, f64)> {
        let is_last = i + 1 == self.points.len();
        let next = if is_last { 0 } else { i + 1 };
        (!is_last || self.is_closed).then_some((next, self.edges[i]))
    }

    /// The point before, and the way there, which is negative.
    fn before(&self, i: usize) -> Option<(usize, f64)> {
        let last = self.points.len() - 1;
        let before = if i == 0 { last } else { i - 1 };
        (i > 0 || self.is_closed).then_some((before, -self.edges[before]))
    }

    /// The length of rim that a point stands for.
    fn share(&self, i: usize) -> f64 {
        let ways = [self.after(i), self.before(i)];
        let ways = ways.iter().flatten().map(|(_, way)| way.abs());
        0.5 * ways.sum::<f64>()
    }

    /// The way from a point to where it goes.
    fn way(&self, surface: &Surface, i: usize) -> Option<Vec3> {
        let place = |j: usize| surface.points[self.points[j] as usize];
        let (mut s, mut t, mut normal) = ([0.0; 5], [[0.0; 3]; 3], [0.0; 3]);
        for (j, x) in self.near(i) {
            let weight = (1.0 - (x / self.reach).abs().powi(3)).powi(3) * self.share(j);
            normal = along(normal, weight, self.normals[j]);
            let mut power = weight;
            for k in 0..5 {
                s[k] += power;
                if k < 3 {
                    t[k] = along(t[k], power, sub(place(j), place(i)));
                }
                power *= x;
            }
        }
        let [offset, slope, bend] = parabola(s, t)?;
        // Twice the coefficient is the curvature, but for how arc length passes.
        let bend = bend.map(|v| 2.0 * v / dot(slope, slope).max(0.25));
        let bend = along(bend, -dot(bend, unit(slope)), unit(slope));
        let normal = unit(normal);
        let [offset, bend] = [offset, bend].map(|way| along(way, -dot(way, normal), normal));
        let taken = bend.map(|v| 0.5 * SIGMA * SIGMA * v);
        let [less, bound] = [offset, taken].map(|way| MOST / length(way).max(MOST));
        Some(sub(
            offset.map(|v| v * less.powi(2)),
            taken.map(|v| v * bound),
        ))
    }
}

/// The coefficients of the parabola of least squares; `s` are the weighted sums of powers of the
/// parameter, `t` those of places times powers.
fn parabola(s: [f64; 5], t: [Vec3; 3]) -> Option<[Vec3; 3]> {
    let rows = [0, 1, 2].map(|k| [s[k], s[k + 1], s[k + 2]]);
    let of = [(1, 2), (2, 0), (0, 1)].map(|(a, b)| cross(rows[a], rows[b]));
    let determinant = dot(rows[0], of[0]);
    let is_sure = determinant > 1e-6 * s[0] * s[2] * s[4];
    let coefficient = |k: usize| -> Vec3 {
        std::array::from_fn(|a| (0..3).map(|r| of[r][k] * t[r][a]).sum::<f64>() / determinant)
    };
    is_sure.then(|| [0, 1, 2].map(coefficient))
}

/// Moves points, and those behind them less and less, but not so far that a triangle turns.
fn follow(
    surface: &mut Surface,
    fans: &Fans,
    (points, moves): (Vec<u32>, Vec<Vec3>),
    last: Vec3,
) -> Result<()> {
    let around = (surface.triangles.as_slice(), fans);
    let region = Region::new(points, RINGS, surface.points.len(), around)?;
    let mut ways = ways_behind(surface, fans, &region, moves, last)?;
    let mut new = collected(surface.points.iter().copied())?;
    for round in 1..=ROUNDS {
        for (&p, way) in region.points.iter().zip(&ways) {
            new[p as usize] = along(surface.points[p as usize], 1.0, *way);
        }
        let turned = turned(surface, fans, &region.points, &new)?;
        if !turned.contains(&true) {
            break;
        }
        let less = if round <= HALVED { 0.5 } else { 0.0 };
        for (way, _) in ways.iter_mut().zip(turned).filter(|(_, turned)| *turned) {
            *way = way.map(|v| less * v);
        }
    }
    surface.points = new;
    Ok(())
}

/// The ways of a region's points, of whose first ones the `moves` are given: other points of the
/// boundary and those on a border of the volume stay.
fn ways_behind(
    surface: &Surface,
    fans: &Fans,
    region: &Region,
    moves: Vec<Vec3>,
    last: Vec3,
) -> Result<Vec<Vec3>> {
    let count = moves.len();
    let stays = |&p: &u32| {
        fans.is_boundary(&surface.triangles, p)
            || on_border(surface.points[p as usize], last).contains(&true)
    };
    let stays = collected(region.points[count..].iter().map(stays))?;
    let mut ways = moves;
    let moves = collected(ways.iter().copied())?;
    extend(&mut ways, stays.iter().map(|_| [0.0; 3]))?;
    for _ in 0..RINGS {
        ways = region.average(ways, 1)?;
        ways[..count].copy_from_slice(&moves);
        let behind = ways[count..].iter_mut().zip(&stays);
        for (way, _) in behind.filter(|(_, stays)| **stays) {
            *way = [0.0; 3];
        }
    }
    Ok(ways)
}

/// Whether each of some points has a triangle that turns if all go to new places.
fn turned(surface: &Surface, fans: &Fans, points: &[u32], new: &[Vec3]) -> Result<Vec<bool>> {
    let area = |t: [Vec3; 3]| cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let turns = |t: [u32; 3]| {
        let before = area(t.map(|p| surface.points[p as usize]));
        let after = area(t.map(|p| new[p as usize]));
        dot(before, after) < TURNED * length(before) * length(after)
    };
    let of = |&p: &u32| {
        let mut triangles = fans
            .of(p)
            .iter()
            .map(|&e| surface.triangles[e as usize / 3]);
        triangles.any(turns)
    };
    collected(points.iter().map(of))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Quiet;

    const AROUND: u32 = 32;
    const ROWS: u32 = 12;
    const RADIUS: f64 = 4.0;

    /// The radii of the inner rim of a flat ring, after smoothing; `off` is how far each point is off before.
    fn radii(off: impl Fn(u32) -> f64, fraction: f64) -> Vec<f64> {
        let mut surface = Surface::default();
        for (row, i) in (0..ROWS).flat_map(|row| (0..AROUND).map(move |i| (row, i))) {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(AROUND)).sin_cos();
            let radius = RADIUS + 0.8 * f64::from(row) + if row == 0 { off(i) } else { 0.0 };
            surface
                .points
                .push([50.0 + radius * cos, 50.0 + radius * sin, 50.0]);
            let [a, b] = [i, (i + 1) % AROUND].map(|i| row * AROUND + i);
            let [c, d] = [a, b].map(|p| p + AROUND);
            if row + 1 < ROWS {
                surface.triangles.extend([[a, c, d], [a, d, b]]);
            }
        }
        surface.source.resize(surface.points.len(), 0);
        let fractions = vec![fraction; surface.points.len()];
        let fans = Fans::new(&surface.triangles, surface.points.len()).unwrap();
        let mut quiet = Quiet::default();
        let execution = &mut Execution::new(2, &mut quiet).unwrap();
        smooth_rims(&mut surface, &fractions, &fans, [100.0; 3], execution).unwrap();
        let rim = surface.points[..AROUND as usize].iter();
        rim.map(|p| length(sub(*p, [50.0; 3]))).collect()
    }

    #[test]
    fn a_rim_gets_back_what_smoothing_the_mask_took() {
        let wanted = RADIUS + 0.5 * SIGMA * SIGMA / RADIUS;
        assert!(radii(|_| 0.0, 0.5)
            .iter()
            .all(|r| (r - wanted).abs() < 0.04));
    }

    #[test]
    fn a_small_spur_all_but_goes_and_a_large_one_stays() {
        let smooth = radii(|_| 0.0, 0.5);
        let most_off = |spur: f64| {
            let found = radii(|i| if i == 5 { -spur } else { 0.0 }, 0.5);
            let off = found.iter().zip(&smooth).map(|(a, b)| (a - b).abs());
            off.fold(0.0, f64::max)
        };
        assert!(most_off(0.3) < 0.12);
        assert!(most_off(1.0) > 0.9);
    }

    #[test]
    fn a_rim_that_is_none_of_the_label_stays() {
        assert!(radii(|_| 0.0, 0.9)
            .iter()
            .all(|r| (r - RADIUS).abs() < 1e-9));
    }
}
