//! Surface → surface that does not cross itself.
//!
//! Within the surface sheets keep apart, but a rim may lie against another sheet: where a sheet
//! ends at a junction, or along a cut through what cannot be wound one way, both sides of which are
//! rims in the same place. Moving midway, triangles as long as a voxel, and the low-pass then let
//! the one run into the other. A rim that touches another triangle is drawn back into its own
//! sheet, step by step and no farther than it takes, and what that has pressed is widened (`sharp.rs`).
//! What touches even so is cut away.
//!
//! Only rims and what is next to them are looked at, in the cells of a grid, so that it costs little
//! where nothing touches.

use crate::buckets::Buckets;
use crate::contour::scraps::drop_scraps_near;
use crate::error::{collected, extend, zeros, Result};
use crate::execution::Execution;
use crate::finish::sharp::widen;
use crate::grid::{along, cross, dot, sub, Vec3};
use crate::surface::cells::{all_bounds, bounds, near, overlap, Bounds, Cells};
use crate::surface::halfedge::{Fans, NONE};
use crate::surface::manifold::{make_manifold, Surface};
use crate::surface::touching::{touch, TOUCHING};

/// Share of the way to the points next to the rim that a rim point is drawn back in a step, and the
/// most steps: in all about half of the way.
const STEP: f64 = 0.12;
const STEPS: usize = 6;
/// Times that triangles are cut away, at most: mostly once or twice, but a rim that is crumpled all along
/// takes more.
const CUTS: usize = 24;
/// Rounds after which triangles that drawing back has made sharp are widened.
const WIDENED: usize = 6;
/// How far from a rim that is drawn back others may begin to touch, in lengths of an edge.
const REACH: f64 = 1.5;
/// How far from what has changed triangles are looked at again, in lengths of an edge: as far as they are
/// near a rim that a cut has made, and what these may touch.
const AGAIN: f64 = 6.0;
/// Rings of points beside a rim whose triangles are looked at, too: what is led on to where sheets meet
/// may crumple behind its rim.
type Ring = u8;
const RINGS: Ring = 2;
const FAR: Ring = Ring::MAX;
/// Triangles that have no point on a rim touch if they are nearer to each other than this, work units:
/// as far as rounding goes.
const CROSSING: f64 = 1e-4;
/// Triangles face alike up to this cosine.
const ALIKE: f64 = 0.5;
/// Triangles or points handed to a worker at a time.
const PIECE: usize = 4096;
/// Passes over the triangles that [`remove_self_intersections`] makes where nothing touches, for its
/// progress.
pub(crate) const PASSES: usize = 2;

/// Draws rims back, and cuts away what has to be, until no rim touches another triangle of its
/// component, as far as [`CUTS`] rounds reach. `component` is that of a source of the surface's
/// points, `edge` the length of its edges, `last` the last voxel of the volume, work coordinates. Takes
/// and returns the surface's fans.
pub(crate) fn remove_self_intersections(
    surface: &mut Surface,
    mut fans: Fans,
    component: &(impl Fn(u32) -> u32 + Sync),
    (edge, last): (f64, Vec3),
    execution: &mut Execution,
) -> Result<Fans> {
    let mut among = collected(0..surface.triangles.len() as u32)?;
    for cut in 1..=CUTS {
        let on_rim = on_rim(surface, &fans, execution)?;
        let rings = rings(surface, &on_rim)?;
        let mut touching = touching(surface, &rings, &among, component, execution)?;
        if touching.is_empty() {
            break;
        }
        let mut changing = all_bounds(surface, touching.as_flattened())?;
        rims_first(surface, &rings, &mut touching);
        let at_rims = all_bounds(surface, touching.as_flattened())?;
        let near = near(surface, &at_rims, REACH * edge)?;
        let rims = (&fans, on_rim.as_slice(), rings.as_slice());
        let (left, pressed) = draw_back(surface, rims, &near, touching, component, execution)?;
        // What touches after that is drawn back in the next round; the last rounds only draw back.
        if cut <= WIDENED {
            let widened = widen(surface, &fans, last, pressed)?;
            extend(&mut changing, widened.iter().map(|&t| bounds(surface, t)))?;
        }
        if !left.is_empty() {
            let all = cut == CUTS;
            cut_away(surface, (&fans, &on_rim), &left, all, execution)?;
            fans = Fans::new(&surface.triangles, surface.points.len())?;
        }
        // What was apart stays apart but for where the surface has changed.
        among = self::near(surface, &changing, AGAIN * edge)?;
    }
    Ok(fans)
}

/// Whether each point is on a rim.
fn on_rim(surface: &Surface, fans: &Fans, execution: &mut Execution) -> Result<Vec<bool>> {
    let mut on_rim: Vec<bool> = zeros(surface.points.len())?;
    execution.fill(&mut on_rim, PIECE, |piece, out| {
        for (i, on_rim) in out.iter_mut().enumerate() {
            *on_rim = fans.is_boundary(&surface.triangles, (PIECE * piece + i) as u32);
        }
    })?;
    Ok(on_rim)
}

/// How far each point is from a rim, counted in edges.
fn rings(surface: &Surface, on_rim: &[bool]) -> Result<Vec<Ring>> {
    let mut rings = collected(on_rim.iter().map(|on_rim| if *on_rim { 0 } else { FAR }))?;
    for ring in 1..=RINGS {
        for corners in surface.triangles.iter().map(|t| t.map(|p| p as usize)) {
            if corners.iter().any(|&p| rings[p] < ring) {
                corners.iter().for_each(|&p| rings[p] = rings[p].min(ring));
            }
        }
    }
    Ok(rings)
}

/// The pairs among some triangles that touch, one of them near a rim, ascending.
fn touching(
    surface: &Surface,
    rings: &[Ring],
    among: &[u32],
    component: &(impl Fn(u32) -> u32 + Sync),
    execution: &mut Execution,
) -> Result<Vec<[u32; 2]>> {
    let is_near_rim = |t: u32| ring(surface, rings, t) < FAR;
    let near_rims = collected(among.iter().copied().filter(|&t| is_near_rim(t)))?;
    if near_rims.is_empty() {
        return Ok(Vec::new());
    }
    let boxes = all_bounds(surface, &near_rims)?;
    let cells = Cells::around(&boxes, 0.0, surface);
    let entries = || {
        let of = |(i, own): (usize, &Bounds)| {
            let reached = cells.reached_by(*own);
            reached.map(move |cell| (cell, i as u32))
        };
        boxes.iter().enumerate().flat_map(of)
    };
    let in_cell = Buckets::new(cells.count(), entries)?;
    let touches = |t: u32, rim: u32| {
        let part = |t: u32| surface.source[surface.triangles[t as usize][0] as usize];
        component(part(t)) == component(part(rim)) && touches_rim(surface, rings, t, rim)
    };
    let pieces = collected(among.chunks(PIECE))?;
    let mut pairs = Vec::new();
    execution.stream(
        &pieces,
        |piece| {
            let mut found: Vec<[u32; 2]> = Vec::new();
            for &t in *piece {
                let own = bounds(surface, t);
                // Two near rims meet twice.
                let is_near_rim = is_near_rim(t);
                for cell in cells.reached_by(own) {
                    let rims = in_cell.of(cell as usize).iter().filter_map(|&i| {
                        let (rim, other) = (near_rims[i as usize], boxes[i as usize]);
                        let is_met = overlap(own, other)
                            && (t < rim || !is_near_rim)
                            && cells.is_first_of_both(cell, [own[0], other[0]])
                            && touches(t, rim);
                        is_met.then_some([t, rim])
                    });
                    extend(&mut found, rims)?;
                }
            }
            Ok(found)
        },
        |found: Result<_>| extend(&mut pairs, found?),
    )?;
    pairs.sort_unstable();
    Ok(pairs)
}

/// Whether a triangle touches one near a rim; what is no rim's own has to cross it.
fn touches_rim(surface: &Surface, rings: &[Ring], t: u32, rim: u32) -> bool {
    let [a, b] = [t, rim].map(|t| surface.triangles[t as usize]);
    if [t, rim].iter().any(|&t| ring(surface, rings, t) == 0) {
        return touch(a, b, &surface.points, TOUCHING);
    }
    let meet = a.iter().any(|p| b.contains(p));
    !(meet && face_alike(surface, [a, b])) && touch(a, b, &surface.points, CROSSING)
}

/// Keeps the pairs with a triangle at a rim, if there are any: what touches behind a rim may be rid of
/// together with that.
fn rims_first(surface: &Surface, rings: &[Ring], pairs: &mut Vec<[u32; 2]>) {
    let is_at_rim = |pair: &[u32; 2]| pair.iter().any(|&t| ring(surface, rings, t) == 0);
    if pairs.iter().any(is_at_rim) {
        pairs.retain(is_at_rim);
    }
}

/// How far a triangle is from a rim, counted in edges.
fn ring(surface: &Surface, rings: &[Ring], t: u32) -> Ring {
    let corners = surface.triangles[t as usize].iter();
    corners.map(|&p| rings[p as usize]).min().unwrap_or(FAR)
}

/// Whether two triangles face nearly the same way: such that share a point cross only where one between
/// them is turned over, which then crosses both.
fn face_alike(surface: &Surface, triangles: [[u32; 3]; 2]) -> bool {
    let [m, n] = triangles.map(|t| {
        let [a, b, c] = t.map(|p| surface.points[p as usize]);
        cross(sub(b, a), sub(c, a))
    });
    let cosine = dot(m, n);
    cosine > 0.0 && cosine * cosine > ALIKE * ALIKE * dot(m, m) * dot(n, n)
}

/// Draws the rims of pairs that touch back; returns the pairs that touch in the end, and the triangles at
/// the points that were drawn.
fn draw_back(
    surface: &mut Surface,
    (fans, on_rim, rings): (&Fans, &[bool], &[Ring]),
    near: &[u32],
    mut touching: Vec<[u32; 2]>,
    component: &(impl Fn(u32) -> u32 + Sync),
    execution: &mut Execution,
) -> Result<(Vec<[u32; 2]>, Vec<u32>)> {
    let mut pressed = Vec::new();
    for _ in 0..STEPS {
        let corners = touching.as_flattened().iter();
        let corners = corners.flat_map(|&t| surface.triangles[t as usize]);
        let mut rims = collected(corners.filter(|&p| on_rim[p as usize]))?;
        rims.sort_unstable();
        rims.dedup();
        for p in rims {
            extend(&mut pressed, fans.of(p).iter().map(|&e| e / 3))?;
            // Inner points stay, so that the order of the rim's does not matter.
            let around = fans
                .of(p)
                .iter()
                .flat_map(|&e| surface.triangles[e as usize / 3]);
            let (mut way, mut count) = ([0.0; 3], 0.0);
            for q in around.filter(|&q| !on_rim[q as usize]) {
                let to = sub(surface.points[q as usize], surface.points[p as usize]);
                (way, count) = (along(way, 1.0, to), count + 1.0);
            }
            if count > 0.0 {
                let point = &mut surface.points[p as usize];
                *point = along(*point, STEP / count, way);
            }
        }
        touching = self::touching(surface, rings, near, component, execution)?;
        rims_first(surface, rings, &mut touching);
        if touching.is_empty() {
            break;
        }
    }
    Ok((touching, pressed))
}

/// Cuts one of each pair away, as long as they have no points in common, unless they are `all` to go.
fn cut_away(
    surface: &mut Surface,
    (fans, on_rim): (&Fans, &[bool]),
    touching: &[[u32; 2]],
    all: bool,
    execution: &mut Execution,
) -> Result<()> {
    let triangles = &surface.triangles;
    let is_rim = |e: &u32| fans.twin(triangles, *e) == NONE;
    // What meets the rim in two places holds the surface together there.
    let worth = |t: u32| {
        let corners = triangles[t as usize].iter();
        let corners = corners.filter(|&&p| on_rim[p as usize]).count();
        let sides = (3 * t..3 * t + 3).filter(is_rim).count();
        (corners == sides + 1 || sides == 3, corners)
    };
    let mut taken: Vec<bool> = zeros(surface.points.len())?;
    let mut goes: Vec<bool> = zeros(triangles.len())?;
    for &[a, b] in touching {
        let cut = if worth(a) > worth(b) { a } else { b };
        let corners = triangles[cut as usize].map(|p| p as usize);
        if all || !corners.iter().any(|&p| taken[p]) {
            corners.iter().for_each(|&p| taken[p] = true);
            goes[cut as usize] = true;
        }
    }
    let mut goes = goes.into_iter();
    surface.triangles.retain(|_| goes.next() == Some(false));
    make_manifold(surface, execution)?;
    // Points that were split off are new.
    drop_scraps_near(surface, |p| taken.get(p).is_none_or(|taken| *taken))?;
    *surface = std::mem::take(surface).compact()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Quiet;

    /// Adds a lattice of squares with sides of 1, each cut in two.
    fn add_lattice(surface: &mut Surface, sides: [u32; 2], place: impl Fn(f64, f64) -> Vec3) {
        let [columns, rows] = sides;
        let first = surface.points.len() as u32;
        let at = |i: u32, j: u32| first + j * (columns + 1) + i;
        for j in 0..rows {
            for i in 0..columns {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                // All corners of the lattice have a point inside beside them.
                surface
                    .triangles
                    .extend(match (2 * i < columns) == (2 * j < rows) {
                        true => [[a, b, c], [a, c, d]],
                        false => [[a, b, d], [b, c, d]],
                    });
            }
        }
        let points = (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j)));
        let points = points.map(|(i, j)| place(f64::from(i), f64::from(j)));
        surface.points.extend(points);
        surface.source.resize(surface.points.len(), 0);
    }

    /// A flat sheet and an upright one whose lower rim is at this height.
    fn sheets_at(height: f64) -> Surface {
        let mut surface = Surface::default();
        add_lattice(&mut surface, [12, 12], |x, y| [x, y, 0.0]);
        add_lattice(&mut surface, [6, 8], |x, z| [3.2 + x, 6.3, height + z]);
        surface
    }

    fn uncrossed(mut surface: Surface, threads: usize) -> Surface {
        let mut quiet = Quiet::default();
        let fans = Fans::new(&surface.triangles, surface.points.len()).unwrap();
        let mut execution = Execution::new(threads, &mut quiet).unwrap();
        remove_self_intersections(
            &mut surface,
            fans,
            &|source| source,
            (1.0, [100.0; 3]),
            &mut execution,
        )
        .unwrap();
        surface
    }

    /// Pairs of triangles that touch, whether at a rim or not.
    fn count_touching(surface: &Surface) -> usize {
        let t = &surface.triangles;
        let touching =
            |a: usize| (0..a).filter(move |&b| touch(t[a], t[b], &surface.points, TOUCHING));
        (0..t.len()).flat_map(touching).count()
    }

    #[test]
    fn what_becomes_of_a_component_does_not_depend_on_others() {
        let alone = uncrossed(sheets_at(-0.9), 2);
        let mut both = sheets_at(-0.3);
        let first = both.points.len() as u32;
        let other = sheets_at(-0.9);
        let shifted = other.triangles.iter().map(|t| t.map(|p| p + first));
        both.triangles.extend(shifted);
        both.points.extend(&other.points);
        both.source.resize(both.points.len(), 1);
        let both = uncrossed(both, 2);
        let second = |t: &&[u32; 3]| both.source[t[0] as usize] == 1;
        let corners = |surface: &Surface, t: &[u32; 3]| t.map(|p| surface.points[p as usize]);
        let expected: Vec<_> = alone.triangles.iter().map(|t| corners(&alone, t)).collect();
        let found = both.triangles.iter().filter(second);
        let found: Vec<_> = found.map(|t| corners(&both, t)).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn what_does_not_touch_stays() {
        let before = sheets_at(0.3);
        let after = uncrossed(sheets_at(0.3), 2);
        assert_eq!(before.points, after.points);
        assert_eq!(before.triangles, after.triangles);
    }

    #[test]
    fn a_rim_that_touches_a_sheet_is_drawn_back() {
        let before = sheets_at(-0.3);
        assert!(count_touching(&before) > 0);
        let after = uncrossed(sheets_at(-0.3), 2);
        assert_eq!(count_touching(&after), 0);
        assert_eq!(before.triangles, after.triangles);
        let moved = before
            .points
            .iter()
            .zip(&after.points)
            .filter(|(a, b)| a != b);
        for (from, to) in moved {
            assert!(to[2] > from[2] && to[2] < from[2] + 0.6, "{from:?} {to:?}");
        }
        assert_eq!(uncrossed(sheets_at(-0.3), 1).points, after.points);
    }

    #[test]
    fn a_rim_that_goes_too_far_through_a_sheet_is_cut_away() {
        let after = uncrossed(sheets_at(-0.9), 2);
        assert_eq!(count_touching(&after), 0);
        // The flat sheet is whole, and of the upright one there is what lies above it.
        let flat = |t: &&[u32; 3]| t.iter().all(|&p| after.points[p as usize][2] == 0.0);
        assert_eq!(after.triangles.iter().filter(flat).count(), 2 * 12 * 12);
        let above = |t: &&[u32; 3]| t.iter().all(|&p| after.points[p as usize][2] > 0.5);
        assert!(after.triangles.iter().filter(above).count() >= 2 * 6 * 6);
    }

    #[test]
    fn what_crosses_behind_rims_goes_though_rims_touch_elsewhere() {
        let mut surface = sheets_at(-0.3);
        add_lattice(&mut surface, [4, 4], |x, y| [50.0 + x, y, 0.0]);
        let is_peak = |x: f64, y: f64| (x, y) == (2.0, 2.0);
        add_lattice(&mut surface, [4, 4], |x, y| {
            [50.1 + x, 0.2 + y, if is_peak(x, y) { 0.5 } else { -0.5 }]
        });
        let sheets = |surface: &Surface| {
            let is_far = |t: &&[u32; 3]| surface.points[t[0] as usize][0] > 40.0;
            surface.triangles.iter().filter(is_far).count()
        };
        let before = sheets(&surface);
        let after = uncrossed(surface, 2);
        assert_eq!(count_touching(&after), 0);
        assert!(sheets(&after) < before && sheets(&after) > before / 2);
    }

    #[test]
    fn what_is_cut_in_one_place_leaves_small_pieces_elsewhere() {
        let mut surface = sheets_at(-0.9);
        let cut = uncrossed(sheets_at(-0.9), 2).triangles.len();
        assert!(cut < surface.triangles.len());
        add_lattice(&mut surface, [2, 2], |x, y| [50.0 + x, y, 0.0]);
        assert_eq!(uncrossed(surface, 2).triangles.len(), cut + 8);
    }
}
