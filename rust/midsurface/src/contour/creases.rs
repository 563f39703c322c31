//! Surface → surface without creases where sheets meet.
//!
//! Where two sheets leave each other at a small angle the label between them is filled, and the
//! contour takes now one and now the other for what goes on, with bridges from sheet to sheet. No
//! membrane bends like that. Beside a blind rim (`midway/reach.rs`) the surface is cut away around its
//! creases; so is what lies ahead of a blind rim that this reaches, however smoothly it goes on, or a
//! sheet would be joined to the one beside it here and to the other there. Then all of them end,
//! and each is led on by itself to where they meet.
//!
//! How sharply a surface bends is told by how long the mean of the unit normals around a point is:
//! next to a sharp crease the cosine of half the angle by which it turns. What bends as sharply away
//! from blind rims, such as the edge of a fold, stays as it is.

use crate::buckets::Buckets;
use crate::contour::holes::{blind, fraction_at, remove};
use crate::contour::rim::BLIND;
use crate::error::{collected, push, zeros, Result};
use crate::execution::Execution;
use crate::fields::label::Label;
use crate::grid::{dot, length, sub, unit, Vec3};
use crate::surface::boundary::away;
use crate::surface::cells::{all_bounds, bounds, near, Cells};
use crate::surface::halfedge::{ends, Fans, NONE};
use crate::surface::manifold::Surface;
use crate::surface::normals::normal_of_fan;
use crate::surface::region::Region;

/// Rings of points around blind rims that are looked at.
const RINGS: usize = 8;
/// A rim nearer to the border of the volume, work units, within so many points along it, is where the
/// contour ends or tears before that, and no sheet meets another.
const BORDER: f64 = 2.0;
const ALONG_BORDER: usize = 12;
/// Rounds of averaging normals, and how long their mean is at least where there is no crease.
const ROUNDS: usize = 3;
const SMOOTH: f64 = 0.9;
/// What is this near to a crease is cut away, work units;
const CLEAR: f64 = 1.0;
/// and what is this near to a blind rim that this reaches, no farther off the way ahead than this
/// cosine, nor more points along the rim.
const AHEAD: f64 = 2.5;
const ONWARD: f64 = 0.3;
const ALONG: usize = 24;
/// Passes over the points that [`cut_creases`] makes.
pub(crate) const PASSES: usize = 1;

/// A point around which the surface is cut away: all around, or ahead.
struct Seed {
    point: u32,
    way: Option<Vec3>,
}

/// Cuts a consistently wound 2-manifold where it is creased beside blind rims. `fraction` is the
/// sheet fraction at the voxels. Returns the surface's fans.
pub(crate) fn cut_creases(
    label: &Label,
    surface: &mut Surface,
    fraction: &[f32],
    execution: &mut Execution,
) -> Result<Fans> {
    let fans = Fans::new(&surface.triangles, surface.points.len())?;
    let is_blind = blind(label, surface, &fans, (fraction, BLIND), execution)?;
    let numbers = 0..surface.points.len() as u32;
    let blind = collected(numbers.filter(|&p| is_blind[p as usize]))?;
    let sides = sides(surface, &fans, (&blind, &is_blind))?;
    let mut goes_inside: Vec<bool> = zeros(surface.points.len())?;
    for p in blind.iter().map(|&p| p as usize) {
        goes_inside[p] = label.depth(surface.points[p]) >= BORDER;
    }
    spread_along(&sides, &mut goes_inside, ALONG_BORDER)?;
    let blind = collected(blind.into_iter().filter(|&p| goes_inside[p as usize]))?;
    let mut creases = creases(surface, &fans, &blind)?;
    creases.retain(|seed| fraction_at(label, surface, fraction, seed.point) >= BLIND);
    if creases.is_empty() {
        return Ok(fans);
    }
    let mut goes = near_seeds(surface, &fans, &creases, CLEAR)?;
    let reached = reached_rims(surface, &fans, (&blind, &is_blind, &sides), &goes)?;
    let ahead = near_seeds(surface, &fans, &reached, AHEAD)?;
    for (goes, is_ahead) in goes.iter_mut().zip(ahead) {
        *goes |= is_ahead;
    }
    let count = goes.len();
    remove(surface, &goes, count)?;
    Fans::new(&surface.triangles, surface.points.len())
}

/// The points around blind ones where the surface is creased.
fn creases(surface: &Surface, fans: &Fans, blind: &[u32]) -> Result<Vec<Seed>> {
    let (points, triangles) = (&surface.points, &surface.triangles);
    let seeds = collected(blind.iter().copied())?;
    let region = Region::new(seeds, RINGS, points.len(), (triangles, fans))?;
    let normal = |&p: &u32| normal_of_fan(points, triangles, fans.of(p));
    let normals = collected(region.points.iter().map(normal))?;
    let normals = region.average(normals, ROUNDS)?;
    let creased = region.points.iter().zip(normals);
    let creased = creased.filter(|(_, normal)| length(*normal) < SMOOTH);
    collected(creased.map(|(&point, _)| Seed { point, way: None }))
}

/// The sides of triangles that make up blind rims.
fn sides(
    surface: &Surface,
    fans: &Fans,
    (blind, is_blind): (&[u32], &[bool]),
) -> Result<Vec<[usize; 2]>> {
    let triangles = &surface.triangles;
    let mut sides = Vec::new();
    for &p in blind {
        for &e in fans.of(p) {
            let side = [p, ends(triangles, e).1].map(|p| p as usize);
            if is_blind[side[1]] && fans.twin(triangles, e) == NONE {
                push(&mut sides, side)?;
            }
        }
    }
    Ok(sides)
}

/// Spreads what is true of points to so many more along their rims.
fn spread_along(sides: &[[usize; 2]], is_true: &mut [bool], points: usize) -> Result<()> {
    for _ in 0..points {
        let is_news = |side: &&[usize; 2]| is_true[side[0]] != is_true[side[1]];
        let told = collected(sides.iter().filter(is_news).flatten().copied())?;
        if told.is_empty() {
            break;
        }
        told.into_iter().for_each(|p| is_true[p] = true);
    }
    Ok(())
}

/// The points of blind rims that what goes reaches, each with its way ahead.
fn reached_rims(
    surface: &Surface,
    fans: &Fans,
    (blind, is_blind, sides): (&[u32], &[bool], &[[usize; 2]]),
    goes: &[bool],
) -> Result<Vec<Seed>> {
    let triangles = &surface.triangles;
    let mut is_reached: Vec<bool> = zeros(surface.points.len())?;
    for (triangle, _) in triangles.iter().zip(goes).filter(|(_, goes)| **goes) {
        for p in triangle.map(|p| p as usize) {
            is_reached[p] = is_blind[p];
        }
    }
    spread_along(sides, &mut is_reached, ALONG)?;
    let mut reached = Vec::new();
    for &point in blind {
        if is_reached[point as usize] {
            let way = Some(unit(away(surface, fans, point)));
            push(&mut reached, Seed { point, way })?;
        }
    }
    Ok(reached)
}

/// Which triangles of the same part have a corner no farther than this from a seed, ahead of it if
/// it has a way.
fn near_seeds(surface: &Surface, fans: &Fans, seeds: &[Seed], far: f64) -> Result<Vec<bool>> {
    let mut goes: Vec<bool> = zeros(surface.triangles.len())?;
    if seeds.is_empty() {
        return Ok(goes);
    }
    let place = |p: u32| surface.points[p as usize];
    let half_edges = seeds.iter().flat_map(|seed| fans.of(seed.point));
    let mut own = collected(half_edges.map(|e| e / 3))?;
    own.sort_unstable();
    own.dedup();
    let boxes = all_bounds(surface, &own)?;
    let cells = Cells::around(&boxes, far, surface);
    let in_cell = Buckets::new(cells.count(), || {
        let of = |s: usize| {
            let cells = cells.reached_by([place(seeds[s].point); 2]);
            cells.map(move |cell| (cell, s as u32))
        };
        (0..seeds.len()).flat_map(of)
    })?;
    let is_near = |seed: &Seed, corner: u32| {
        let step = sub(place(corner), place(seed.point));
        let is_ahead = |way: Vec3| dot(way, step) > ONWARD * length(step);
        dot(step, step) <= far * far && seed.way.is_none_or(is_ahead)
    };
    let source = |p: u32| surface.source[p as usize];
    for t in near(surface, &boxes, far)? {
        let corners = surface.triangles[t as usize];
        let [low, high] = bounds(surface, t);
        let mut cells = cells.reached_by([low.map(|v| v - far), high.map(|v| v + far)]);
        goes[t as usize] = cells.any(|cell| {
            let mut seeds = in_cell
                .of(cell as usize)
                .iter()
                .map(|&s| &seeds[s as usize]);
            seeds.any(|seed| {
                source(seed.point) == source(corners[0])
                    && corners.iter().any(|&corner| is_near(seed, corner))
            })
        });
    }
    Ok(goes)
}
