//! Contour → surface with true rims: what reaches beyond the label is cut off.
//!
//! The contour runs on a little beyond the rims and over the holes of the label. It is cut where the
//! sheet fraction (`rim.rs`) is ½, between the points, so that rims and holes are where the data
//! put them and not on the grid. What noise alone makes is left: a region below ½ is a hole only
//! where its fraction falls far enough, and a region above ½ is a piece of sheet only where its
//! fraction rises far enough (hysteresis, as in Canny 1986). A region below ½ that comes to the end of
//! the contour is no hole: it lies beyond a rim, and only the contour ends before it falls farther.

use crate::error::{check_count, collected, extend, filled, push, reserved, zeros, Result};
use crate::grid::{along, sub, Vec3};
use crate::surface::halfedge::{ends, Edges};
use crate::surface::manifold::{split_points_among, Surface};

/// The sheet fraction at a rim.
const RIM: f64 = 0.5;
/// A hole is at least this empty somewhere, and a sheet this full.
const HOLE: f64 = 0.25;
const SHEET: f64 = 0.75;
/// as far as so many rings of points around tell: along a rim something is certain somewhere, however
/// far.
const RINGS: usize = 16;
/// Points this near to the cut, in the length of the edge that it crosses, are moved onto it.
const SNAP: f32 = 0.3;
/// Where hysteresis overruled the field a cut is this share of an edge away from its end.
const CLEAR: f64 = 0.02;
/// and elsewhere by this share at least.
const LEAST: f64 = 1e-7;

/// Which side of the cut a point is on.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Kept,
    Rim,
    Cut,
}

/// Cuts `surface` where `fraction`, given at its points, is ½. The volume's last voxel is at `last`.
pub(crate) fn trim(surface: &mut Surface, fraction: &[f64], last: Vec3) -> Result<()> {
    let above = above(surface, fraction, last)?;
    if above.iter().all(|&a| a) {
        return Ok(());
    }
    cut(surface, fraction, RIM, &above)
}

/// Cuts off the points that are not `above`, where `field`, given at the points, has this value.
pub(crate) fn cut(surface: &mut Surface, field: &[f64], value: f64, above: &[bool]) -> Result<()> {
    let triangles = std::mem::take(&mut surface.triangles);
    // Only these are cut; those with the same edges are among them.
    let mixed = |t: &[u32; 3]| t.iter().any(|&p| above[p as usize] != above[t[0] as usize]);
    let numbers = 0..triangles.len() as u32;
    let mixed = collected(numbers.filter(|&t| mixed(&triangles[t as usize])))?;
    let edges = Edges::of_triangles(&triangles, &mixed, surface.points.len())?;
    let side = |a: &bool| if *a { Side::Kept } else { Side::Cut };
    let mut side = collected(above.iter().map(side))?;
    snap(surface, (field, value), &edges, &mut side)?;
    let mut cut: Vec<u32> = zeros(3 * triangles.len())?;
    for (a, b, group) in edges.groups() {
        let [p, q] = [a, b].map(|p| p as usize);
        if matches!(
            (side[p], side[q]),
            (Side::Kept, Side::Cut) | (Side::Cut, Side::Kept)
        ) {
            let new = surface.points.len() as u32;
            let (from, to) = (surface.points[p], surface.points[q]);
            let t = crossing(field[p], field[q], value);
            push(&mut surface.points, along(from, t, sub(to, from)))?;
            let source = surface.source[p];
            push(&mut surface.source, source)?;
            for &(_, half_edge) in group {
                cut[half_edge as usize] = new;
            }
        }
    }
    // A triangle that is cut may leave two.
    let most = triangles.len() + mixed.len();
    check_count("triangles", most, 3)?;
    surface.triangles = reserved(most)?;
    for (t, triangle) in triangles.iter().enumerate() {
        if triangle.iter().all(|&p| side[p as usize] == Side::Kept) {
            surface.triangles.push(*triangle);
        } else {
            keep(
                3 * t as u32,
                &side,
                &cut,
                &triangles,
                &mut surface.triangles,
            );
        }
    }
    // Where two cuts met in a point.
    let mut at_cut = filled(true, surface.points.len())?;
    at_cut[..above.len()].fill(false);
    for &t in &mixed {
        for p in triangles[t as usize] {
            at_cut[p as usize] = true;
        }
    }
    split_points_among(surface, &at_cut)
}

/// Where between two points the field has this value; next to the first one's end where hysteresis
/// overruled the field. Never quite at an end: no triangle becomes a point.
fn crossing(from: f64, to: f64, value: f64) -> f64 {
    let t = (value - from) / (to - from);
    let clear = if (0.0..=1.0).contains(&t) {
        LEAST
    } else {
        CLEAR
    };
    let t = if t.is_finite() { t } else { 0.5 };
    t.clamp(clear, 1.0 - clear)
}

/// Moves points that the cut passes close by onto it, so that it leaves no slivers.
fn snap(
    surface: &mut Surface,
    (field, value): (&[f64], f64),
    edges: &Edges,
    side: &mut [Side],
) -> Result<()> {
    // For each point the nearest crossing on its edges: share of the edge, and the other end.
    let mut nearest: Vec<(f32, u32)> = zeros(side.len())?;
    for (a, b, _) in edges.groups() {
        let [p, q] = [a, b].map(|p| p as usize);
        if side[p] == side[q] {
            continue;
        }
        let t = crossing(field[p], field[q], value) as f32;
        for (own, share, other) in [(p, t, b), (q, 1.0 - t, a)] {
            if share < SNAP && (nearest[own].0 == 0.0 || share < nearest[own].0) {
                nearest[own] = (share, other);
            }
        }
    }
    let before = collected(surface.points.iter().copied())?;
    for (p, (share, other)) in nearest.into_iter().enumerate() {
        if share > 0.0 {
            let way = sub(before[other as usize], before[p]);
            surface.points[p] = along(before[p], share.into(), way);
            side[p] = Side::Rim;
        }
    }
    Ok(())
}

/// Whether each point stays.
fn above(surface: &Surface, fraction: &[f64], last: Vec3) -> Result<Vec<bool>> {
    let mut above = collected(fraction.iter().map(|f| *f >= RIM))?;
    let is_certain = |f: &f64| *f >= SHEET || *f <= HOLE;
    let mut certain = collected(fraction.iter().map(is_certain))?;
    tell_around(surface, &above, &mut certain)?;
    let may_be_kept = |p: usize| !above[p] && !certain[p];
    let at_end = at_end(surface, may_be_kept, last)?;
    if !at_end.is_empty() {
        at_end.into_iter().for_each(|p| certain[p] = true);
        tell_around(surface, &above, &mut certain)?;
    }
    for (above, certain) in above.iter_mut().zip(certain) {
        *above ^= !certain;
    }
    Ok(above)
}

/// Lets points that are certain tell those around on the same side of the cut.
fn tell_around(surface: &Surface, above: &[bool], certain: &mut [bool]) -> Result<()> {
    let mut open = Vec::new();
    for &[a, b, c] in &surface.triangles {
        for [p, q] in [[a, b], [b, c], [a, c]].map(|edge| edge.map(|p| p as usize)) {
            if above[p] == above[q] && !(certain[p] && certain[q]) {
                push(&mut open, [p, q])?;
            }
        }
    }
    for _ in 0..RINGS {
        let is_news = |side: &&[usize; 2]| certain[side[0]] != certain[side[1]];
        let told = collected(open.iter().filter(is_news).flatten().copied())?;
        if told.is_empty() {
            break;
        }
        told.into_iter().for_each(|p| certain[p] = true);
        open.retain(|side| !side.iter().all(|&p| certain[p]));
    }
    Ok(())
}

/// Points of edges where a contour of points below ½ ends, other than on the border of the volume.
fn at_end(surface: &Surface, below: impl Fn(usize) -> bool, last: Vec3) -> Result<Vec<usize>> {
    let triangles = &surface.triangles;
    let any_below = |t: &u32| triangles[*t as usize].iter().any(|&p| below(p as usize));
    let near = collected((0..triangles.len() as u32).filter(any_below))?;
    if near.is_empty() {
        return Ok(Vec::new());
    }
    let edges = Edges::of_triangles(triangles, &near, surface.points.len())?;
    let on_border = |[p, q]: [usize; 2]| {
        let [p, q] = [p, q].map(|p| surface.points[p]);
        (0..3).any(|a| p[a].max(q[a]) <= 0.0 || p[a].min(q[a]) >= last[a])
    };
    let mut found = Vec::new();
    for (a, b, group) in edges.groups() {
        let edge = [a, b].map(|p| p as usize);
        if group.len() == 1 && edge.into_iter().all(&below) && !on_border(edge) {
            extend(&mut found, edge)?;
        }
    }
    Ok(found)
}

/// Appends what is left of the triangle with this first half-edge.
fn keep(first: u32, side: &[Side], cut: &[u32], triangles: &[[u32; 3]], kept: &mut Vec<[u32; 3]>) {
    let corner = |k: u32| ends(triangles, first + k % 3).0;
    let is = |k: u32, which: Side| side[corner(k) as usize] == which;
    let count = |which: Side| (0..3).filter(|&k| is(k, which)).count();
    let turned = |which: Side| (0..3).find(|&k| is(k, which)).unwrap_or(0);
    let new = |k: u32| cut[(first + k % 3) as usize];
    match (count(Side::Kept), count(Side::Cut)) {
        (0, _) => {}
        (_, 0) => kept.push([0, 1, 2].map(corner)),
        (1, 2) => {
            let k = turned(Side::Kept);
            kept.push([corner(k), new(k), new(k + 2)]);
        }
        (2, _) => {
            let k = turned(Side::Cut);
            let (b, c) = (corner(k + 1), corner(k + 2));
            kept.push([new(k), b, c]);
            kept.push([new(k), c, new(k + 2)]);
        }
        _ => {
            // One corner of each kind: the cut runs from the rim's to the edge across.
            let k = turned(Side::Cut);
            if is(k + 1, Side::Kept) {
                kept.push([new(k), corner(k + 1), corner(k + 2)]);
            } else {
                kept.push([corner(k + 1), corner(k + 2), new(k + 2)]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{cross, length};

    const SIDE: u32 = 12;

    /// What is left of a flat square, its fraction as given, and of its area.
    fn trimmed(fraction: impl Fn(u32, u32) -> f64, last: Vec3) -> (Surface, f64) {
        let mut surface = Surface::default();
        let mut of_points = Vec::new();
        for (j, i) in (0..=SIDE).flat_map(|j| (0..=SIDE).map(move |i| (j, i))) {
            surface.points.push([f64::from(i), f64::from(j), 5.0]);
            surface.source.push(0);
            of_points.push(fraction(i, j));
        }
        for (j, i) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (j, i))) {
            let a = j * (SIDE + 1) + i;
            let [b, c, d] = [a + 1, a + SIDE + 2, a + SIDE + 1];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
        trim(&mut surface, &of_points, last).unwrap();
        let area = surface.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|p| surface.points[p as usize]);
            0.5 * length(cross(sub(b, a), sub(c, a)))
        });
        let area = area.sum();
        (surface, area)
    }

    const FAR: Vec3 = [100.0; 3];
    const WHOLE: f64 = (SIDE * SIDE) as f64;

    #[test]
    fn a_shallow_dip_is_no_hole() {
        let is_in_dip = |i, j| (5..8).contains(&i) && (5..8).contains(&j);
        let (_, area) = trimmed(|i, j| if is_in_dip(i, j) { 0.35 } else { 1.0 }, FAR);
        assert_eq!(area, WHOLE);
    }

    #[test]
    fn where_the_contour_ends_in_a_dip_it_is_cut() {
        let fraction = [1.0, 0.65, 0.35];
        let beyond = |i: u32, _| fraction[(i.max(8) - 8).min(2) as usize];
        let (surface, area) = trimmed(beyond, FAR);
        assert!((area - 9.5 * f64::from(SIDE)).abs() < 1e-9, "{area}");
        assert!(surface
            .triangles
            .iter()
            .flatten()
            .all(|&p| surface.points[p as usize][0] < 9.5 + 1e-9));
    }

    #[test]
    fn where_the_volume_ends_in_a_dip_it_stays() {
        let beyond = |i: u32, j: u32| {
            if i > 9 && (4..9).contains(&j) {
                0.35
            } else {
                1.0
            }
        };
        let (_, area) = trimmed(beyond, [f64::from(SIDE), 100.0, 100.0]);
        assert_eq!(area, WHOLE);
        let (_, area) = trimmed(beyond, FAR);
        assert!(area < WHOLE - 8.0, "{area}");
    }
}
