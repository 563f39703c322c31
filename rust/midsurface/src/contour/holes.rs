//! Surface → surface without holes inside the label.
//!
//! Where sheets meet, voxels know of several, and where neighbours settle on different ones the
//! contour of the sheet that goes through has holes; of two that go through each other each has
//! holes where the other passes. A hole of the label has a rim where the sheet fraction (`rim.rs`) is
//! ½; where it is more all around, and the label is there all over, there is none, and the
//! surface is closed: by the triangles between the points of the hole's rim whose edges are shortest
//! (dynamic programming, as in Liepa 2003, "Filling holes in meshes"). What passes through the hole
//! across is cut away, smaller holes first, so that in the end one of the two sheets goes through
//! and the other one ends at it on both sides.
//!
//! At the border of the volume only a short rim is one of a false hole: a tear next to it or, all on
//! it, a pipe between walls of the contour, whichever way these face.
//!
//! What is not closed: what is wider than [`WIDEST`], or could only be closed by turning over, as
//! the rim of a scrap could.

use std::ops::Range;

use crate::buckets::Buckets;
use crate::contour::scraps::drop_scraps_near;
use crate::error::{collected, extend, filled, push, zeros, Result};
use crate::execution::Execution;
use crate::fields::interpolation::Sampler;
use crate::fields::label::Label;
use crate::grid::{along, cross, dot, length, squared_distance, sub, unit, Vec3};
use crate::surface::cells::{all_bounds, bounds, near, overlap, Cells};
use crate::surface::halfedge::{ends, Fans, NONE};
use crate::surface::manifold::{split_points_among, Surface};
use crate::surface::normals::normal_of_fan;
use crate::surface::touching::{touch, TOUCHING};

/// The sheet fraction is at least this all along a rim that the label has no part in: it is ½ along one of
/// the label's. Beside such a one neighbours may settle on different sheets, too, where the label ends
/// askew or bends over.
const UNCUT: f64 = 0.6;
/// Points of a hole's rim at most, and the longest edge across it, work units.
const MOST: usize = 256;
const WIDEST: f64 = 8.0;
/// Across a hole the label is at least this share as deep as at its rim, looked at in such steps,
/// work units.
const DEEP: f64 = 0.5;
const STEP: f64 = 0.5;
/// The longest rim of a false hole that has some points on the border of the volume, and of one that has
/// all of them there, work units: that of a tube around one voxel of lumen is 2π long.
const LONGEST_AT_BORDER: f64 = 12.0;
const LONGEST_PIPE: f64 = 4.0;
/// Normals all round a pipe have a mean shorter than this.
const ALIKE: f64 = 0.7;
/// Triangles that close a hole turn no farther than this cosine away from the surface at its rim.
const TURNED: f64 = 0.3;
/// What passes through a hole does so with no more than this cosine between the normals.
const ACROSS: f64 = 0.8;
/// Rounds; in each one holes are closed that have nothing in common.
const ROUNDS: usize = 12;
/// Points handed to a worker at a time.
const PIECE: usize = 4096;
/// Passes over the points that [`close_holes`] makes where there is nothing to close.
pub(crate) const PASSES: usize = 1;

/// Closes the holes of a consistently wound 2-manifold that are none of the label's. `fraction` is
/// the sheet fraction at the voxels. Takes and returns the surface's fans.
pub(crate) fn close_holes(
    label: &Label,
    surface: &mut Surface,
    mut fans: Fans,
    fraction: &[f32],
    execution: &mut Execution,
) -> Result<Fans> {
    for _ in 0..ROUNDS {
        let holes = holes(label, surface, &fans, fraction, execution)?;
        let mut patches = Vec::new();
        for rim in holes {
            if let Some(triangles) = Rim::new(label, surface, &fans, &rim)?.closed()? {
                push(&mut patches, Patch { rim, triangles })?;
            }
        }
        if patches.is_empty() || !close(surface, &patches)? {
            break;
        }
        fans = Fans::new(&surface.triangles, surface.points.len())?;
    }
    Ok(fans)
}

/// What closes a hole: triangles between the points of its rim.
struct Patch {
    rim: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

/// Whether each point is on a rim that is none of the label's, nor on the border of the volume: the sheet
/// fraction is `least` there.
pub(crate) fn blind(
    label: &Label,
    surface: &Surface,
    fans: &Fans,
    (fraction, least): (&[f32], f64),
    execution: &mut Execution,
) -> Result<Vec<bool>> {
    let mut is_blind: Vec<bool> = zeros(surface.points.len())?;
    execution.fill(&mut is_blind, PIECE, |piece, out| {
        for (i, is_blind) in out.iter_mut().enumerate() {
            let p = (PIECE * piece + i) as u32;
            *is_blind = fans.is_boundary(&surface.triangles, p)
                && fraction_at(label, surface, fraction, p) >= least
                && !label.on_border(surface.points[p as usize]).contains(&true);
        }
    })?;
    Ok(is_blind)
}

/// The sheet fraction at a point of the surface, given that at the voxels.
pub(crate) fn fraction_at(label: &Label, surface: &Surface, fraction: &[f32], p: u32) -> f64 {
    let sampler = Sampler {
        directory: &label.batch.directories[surface.source[p as usize] as usize],
        field: fraction,
        h: label.h,
    };
    sampler.linear(surface.points[p as usize])
}

/// The rims of holes within the label, each as its points in the order of the boundary's half-edges,
/// those of few points first.
fn holes(
    label: &Label,
    surface: &Surface,
    fans: &Fans,
    fraction: &[f32],
    execution: &mut Execution,
) -> Result<Vec<Vec<u32>>> {
    let mut is_open = blind(label, surface, fans, (fraction, UNCUT), execution)?;
    let is_on_border = |p: u32| label.on_border(surface.points[p as usize]).contains(&true);
    let count = surface.points.len() as u32;
    for p in (0..count).filter(|&p| is_on_border(p)) {
        is_open[p as usize] = fans.is_boundary(&surface.triangles, p);
    }
    let after = |p: u32| {
        let mut leaving = fans.of(p).iter().copied();
        let on_rim = leaving.find(|&e| fans.twin(&surface.triangles, e) == NONE)?;
        Some(ends(&surface.triangles, on_rim).1)
    };
    let mut holes = Vec::new();
    for first in 0..count {
        let mut rim = Vec::new();
        let mut at = first;
        // A rim that is not of a hole all around ends where it was left before, or is not.
        while std::mem::take(&mut is_open[at as usize]) {
            push(&mut rim, at)?;
            match after(at) {
                Some(after) => at = after,
                None => break,
            }
        }
        let longest = match rim.iter().filter(|&&p| is_on_border(p)).count() {
            0 => f64::INFINITY,
            on_border if on_border < rim.len() => LONGEST_AT_BORDER,
            _ => LONGEST_PIPE,
        };
        if at == first && (3..=MOST).contains(&rim.len()) && perimeter(surface, &rim) <= longest {
            push(&mut holes, rim)?;
        }
    }
    holes.sort_by_key(Vec::len);
    Ok(holes)
}

/// How long a rim is.
fn perimeter(surface: &Surface, rim: &[u32]) -> f64 {
    let place = |p: &u32| surface.points[*p as usize];
    let sides = rim.iter().zip(rim.iter().cycle().skip(1));
    sides.map(|(p, q)| length(sub(place(q), place(p)))).sum()
}

/// The rim of a hole that may be closed.
struct Rim<'a> {
    surface: &'a Surface,
    fans: &'a Fans,
    points: &'a [u32],
    places: Vec<Vec3>,
    /// The surface's normals at the points.
    normals: Vec<Vec3>,
    /// How deep the label is at the points.
    depths: Vec<f64>,
    distance: Sampler<'a>,
    /// Whether it is a pipe's, whose walls face anyhow.
    is_pipe: bool,
}

impl<'a> Rim<'a> {
    fn new(
        label: &'a Label,
        surface: &'a Surface,
        fans: &'a Fans,
        points: &'a [u32],
    ) -> Result<Self> {
        let distance = label.distance(surface.source[points[0] as usize]);
        let places = collected(points.iter().map(|&p| surface.points[p as usize]))?;
        let normal = |&p: &u32| normal_of_fan(&surface.points, &surface.triangles, fans.of(p));
        let mut normals = collected(points.iter().map(normal))?;
        let on_border = places
            .iter()
            .filter(|p| label.on_border(**p).contains(&true))
            .count();
        let sum = normals.iter().fold([0.0; 3], |sum, n| along(sum, 1.0, *n));
        if on_border > 0 {
            // Those of the few triangles beside the border say little.
            normals.fill(unit(sum));
        }
        Ok(Self {
            normals,
            depths: collected(places.iter().map(|&p| distance.linear(p)))?,
            is_pipe: on_border == points.len() && length(sum) < ALIKE * points.len() as f64,
            surface,
            fans,
            points,
            places,
            distance,
        })
    }

    /// The triangles that close the hole with the shortest edges; `None` where it cannot be closed.
    fn closed(&self) -> Result<Option<Vec<[u32; 3]>>> {
        let n = self.points.len();
        // The least sum of squared edges that closes the rim from i to j, and the third corner.
        let mut best: Vec<(f64, u32)> = filled((f64::INFINITY, 0), n * n)?;
        for i in 1..n {
            best[(i - 1) * n + i].0 = 0.0;
        }
        for span in 2..n {
            for i in 0..n - span {
                let j = i + span;
                // The last edge is one of the rim's.
                if span < n - 1 && !self.is_clear(i, j) {
                    continue;
                }
                let own = squared_distance(self.places[i], self.places[j]);
                for k in i + 1..j {
                    let sum = own + best[i * n + k].0 + best[k * n + j].0;
                    if sum < best[i * n + j].0 && self.is_level(i, k, j) {
                        best[i * n + j] = (sum, k as u32);
                    }
                }
            }
        }
        if best[n - 1].0.is_infinite() {
            return Ok(None);
        }
        let mut triangles = Vec::new();
        let mut open = collected([(0, n - 1)])?;
        while let Some((i, j)) = open.pop() {
            let k = best[i * n + j].1 as usize;
            // The surface's half-edges run along the rim, so that these run back.
            push(&mut triangles, [k, i, j].map(|at| self.points[at]))?;
            for (from, to) in [(i, k), (k, j)] {
                if to - from > 1 {
                    push(&mut open, (from, to))?;
                }
            }
        }
        Ok(Some(triangles))
    }

    /// Whether an edge from one point to another would be new, short and within the label.
    fn is_clear(&self, i: usize, j: usize) -> bool {
        let across = sub(self.places[j], self.places[i]);
        let steps = (length(across) / STEP).ceil() as usize;
        let least = DEEP * self.depths[i].min(self.depths[j]);
        let is_deep = |step: usize| {
            let there = along(self.places[i], step as f64 / steps as f64, across);
            self.distance.linear(there) >= least
        };
        let leads_to = |p: u32, q: u32| {
            let mut leaving = self.fans.of(p).iter();
            leaving.any(|&e| ends(&self.surface.triangles, e).1 == q)
        };
        let (p, q) = (self.points[i], self.points[j]);
        length(across) <= WIDEST && !leads_to(p, q) && !leads_to(q, p) && (1..steps).all(is_deep)
    }

    /// Whether a triangle would lie as the surface does at its corners.
    fn is_level(&self, i: usize, k: usize, j: usize) -> bool {
        let [a, b, c] = [k, i, j].map(|at| self.places[at]);
        let normal = unit(cross(sub(b, a), sub(c, a)));
        let mut corners = [i, k, j].into_iter();
        self.is_pipe || corners.all(|at| dot(normal, self.normals[at]) >= TURNED)
    }
}

/// Closes the holes that have nothing in common with one before; whether there are any.
fn close(surface: &mut Surface, patches: &[Patch]) -> Result<bool> {
    let first = surface.triangles.len();
    for patch in patches {
        extend(&mut surface.triangles, patch.triangles.iter().copied())?;
    }
    let mut crossings = Crossings {
        pairs: crossed(surface, first)?,
        taken: zeros(surface.points.len())?,
        goes: zeros(surface.triangles.len())?,
        first,
    };
    let (mut any, mut from) = (false, first);
    for patch in patches {
        let own = from..from + patch.triangles.len();
        from = own.end;
        any |= crossings.settle(surface, &patch.rim, own);
    }
    remove(surface, &crossings.goes, first)?;
    Ok(any)
}

/// What patches cross, and what becomes of it.
struct Crossings {
    /// Triangles of patches, and others that they touch.
    pairs: Vec<[u32; 2]>,
    /// The points where something has changed.
    taken: Vec<bool>,
    /// The triangles that go.
    goes: Vec<bool>,
    /// The first triangle of a patch.
    first: usize,
}

impl Crossings {
    /// Lets a patch's triangles stay and what passes through them go, or the other way round;
    /// whether anything of the surface changes.
    fn settle(&mut self, surface: &Surface, rim: &[u32], own: Range<usize>) -> bool {
        let at = |triangle: usize| self.pairs.partition_point(|p| (p[0] as usize) < triangle);
        let pairs = &self.pairs[at(own.start)..at(own.end)];
        let corners = |t: u32| surface.triangles[t as usize];
        let is_rim = |t: u32| corners(t).iter().any(|p| rim.contains(p));
        let is_sound = |&[patch, other]: &[u32; 2]| {
            let cosine = dot(normal(surface, patch), normal(surface, other));
            match other as usize >= self.first {
                // Of patches that cross the first one stays.
                true => other as usize >= own.start || self.goes[other as usize],
                false => cosine.abs() <= ACROSS || is_rim(other),
            }
        };
        let others = || {
            let others = pairs.iter().map(|pair| pair[1]);
            others.filter(|&t| (t as usize) < self.first)
        };
        let mut points = rim.iter().copied().chain(others().flat_map(corners));
        if points.any(|p| self.taken[p as usize]) || !pairs.iter().all(is_sound) {
            self.goes[own].fill(true);
            return false;
        }
        let points = rim.iter().copied().chain(others().flat_map(corners));
        points.for_each(|p| self.taken[p as usize] = true);
        // A rim that runs to and fro is cut back first.
        let is_ragged = others().any(is_rim);
        others()
            .filter(|&t| !is_ragged || is_rim(t))
            .for_each(|t| self.goes[t as usize] = true);
        self.goes[own].fill(is_ragged);
        true
    }
}

/// Unit normal of a triangle.
fn normal(surface: &Surface, t: u32) -> Vec3 {
    let [a, b, c] = surface.triangles[t as usize].map(|p| surface.points[p as usize]);
    unit(cross(sub(b, a), sub(c, a)))
}

/// The triangles of the same part that those from `first` on touch, in pairs, ascending.
fn crossed(surface: &Surface, first: usize) -> Result<Vec<[u32; 2]>> {
    let own = collected(first as u32..surface.triangles.len() as u32)?;
    let boxes = all_bounds(surface, &own)?;
    let cells = Cells::around(&boxes, 0.0, surface);
    let in_cell = Buckets::new(cells.count(), || {
        let of = |&t: &u32| cells.reached_by(bounds(surface, t)).map(move |c| (c, t));
        own.iter().flat_map(of)
    })?;
    let source = |t: u32| surface.source[surface.triangles[t as usize][0] as usize];
    let mut pairs = Vec::new();
    for other in near(surface, &boxes, 0.0)? {
        let reached = cells.reached_by(bounds(surface, other));
        for &t in reached.flat_map(|cell| in_cell.of(cell as usize)) {
            let [a, b] = [t, other].map(|t| surface.triangles[t as usize]);
            if t != other
                && source(t) == source(other)
                && overlap(bounds(surface, t), bounds(surface, other))
                && touch(a, b, &surface.points, TOUCHING)
            {
                push(&mut pairs, [t, other])?;
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    Ok(pairs)
}

/// Removes the triangles that go; where these are of the surface itself, from before `first`, also
/// the scraps that they leave.
pub(crate) fn remove(surface: &mut Surface, goes: &[bool], first: usize) -> Result<()> {
    let mut among: Vec<bool> = zeros(surface.points.len())?;
    let cut = surface.triangles[..first].iter().zip(goes);
    for (triangle, _) in cut.filter(|(_, goes)| **goes) {
        triangle.iter().for_each(|&p| among[p as usize] = true);
    }
    let mut goes = goes.iter();
    surface.triangles.retain(|_| goes.next() == Some(&false));
    if among.contains(&true) {
        split_points_among(surface, &among)?;
        // Points that were split off are new.
        drop_scraps_near(surface, |p| among.get(p).is_none_or(|among| *among))?;
        *surface = std::mem::take(surface).compact()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Adds a row of squares of side 1, each cut in two; its corners are twice as many.
    fn add_row(surface: &mut Surface, squares: u32, place: impl Fn(f64, f64) -> Vec3) {
        let first = surface.points.len() as u32;
        for i in 0..=squares {
            let x = f64::from(i);
            surface.points.extend([place(x, 0.0), place(x, 1.0)]);
        }
        for a in (0..squares).map(|i| first + 2 * i) {
            surface
                .triangles
                .extend([[a, a + 2, a + 3], [a, a + 3, a + 1]]);
        }
        surface.source.resize(surface.points.len(), 0);
    }

    /// A flat row and another one after a gap, and what closes the gap; an upright row through it.
    fn crossing_rows() -> (Surface, Patch) {
        let mut surface = Surface::default();
        add_row(&mut surface, 12, |x, y| [x, y, 0.0]);
        add_row(&mut surface, 12, |x, y| [x + 14.0, y, 0.0]);
        let rim = vec![24, 26, 27, 25];
        let triangles = vec![[24, 26, 27], [24, 27, 25]];
        add_row(&mut surface, 40, |x, y| {
            [13.1, 0.9 * y + 0.05, 0.37 + x - 20.0]
        });
        (surface, Patch { rim, triangles })
    }

    #[test]
    fn what_passes_through_a_hole_is_cut() {
        let (mut surface, patch) = crossing_rows();
        let before = surface.triangles.len();
        assert!(close(&mut surface, &[patch]).unwrap());
        // The patch is there, and of the upright row only the square that it crossed is not.
        assert_eq!(surface.triangles.len(), before + 2 - 2);
        let crossed = crossed(&surface, 0).unwrap();
        assert!(crossed.is_empty(), "{crossed:?}");
    }

    #[test]
    fn of_two_patches_that_cross_the_first_stays() {
        let (mut surface, patch) = crossing_rows();
        // The upright row has a hole, too: where the other patch is.
        let upright: Vec<[u32; 3]> = surface.triangles.drain(48 + 2 * 19..48 + 2 * 20).collect();
        let first = upright[0][0];
        let rim = vec![first, first + 2, first + 3, first + 1];
        let other = Patch {
            rim,
            triangles: upright.clone(),
        };
        let before = surface.triangles.len();
        assert!(close(&mut surface, &[patch, other]).unwrap());
        assert_eq!(surface.triangles.len(), before + 2);
        assert!(!surface.triangles.contains(&upright[0]));
        let crossed = crossed(&surface, 0).unwrap();
        assert!(crossed.is_empty(), "{crossed:?}");
    }

    #[test]
    fn what_lies_in_a_hole_along_it_keeps_it_open() {
        let (mut surface, patch) = crossing_rows();
        surface.triangles.truncate(48);
        add_row(&mut surface, 20, |x, y| {
            [13.0 - 10.0 + x, y + 0.1, 0.2 * (x - 9.8)]
        });
        let before = surface.triangles.clone();
        assert!(!close(&mut surface, &[patch]).unwrap());
        assert_eq!(surface.triangles, before);
    }

    #[test]
    fn scraps_are_dropped_where_triangles_go_and_nowhere_else() {
        let mut surface = Surface::default();
        add_row(&mut surface, 30, |x, y| [x, y, 0.0]);
        add_row(&mut surface, 3, |x, y| [x, y, 9.0]);
        // All but three squares of the long row are left, in two pieces, the second one a scrap.
        let mut goes = vec![false; surface.triangles.len()];
        goes[2 * 22..2 * 25].fill(true);
        remove(&mut surface, &goes, 66).unwrap();
        assert_eq!(surface.triangles.len(), 2 * 22 + 2 * 3);
        let high = surface.points.iter().filter(|p| p[2] == 9.0).count();
        assert_eq!(high, 8);
    }
}
