//! Surface → surface without short edges: points that nearly coincide become one.
//!
//! Where a sheet passes close by a voxel, cubes around it have corners that all but coincide, with
//! slivers between them whose normals say nothing. Whatever comes later relies on normals, so their
//! short edges are drawn together, as are those that a cut at the border of the volume leaves on it. The
//! link condition (Dey et al. 1999) keeps the topology, and no triangle may turn over; an edge for which
//! either fails stays.

use rayon::prelude::*;

use crate::error::{collected, push, zeros, Result};
use crate::execution::Execution;
use crate::grid::{along, cross, dot, length, on_border, squared_distance, sub, Vec3};
use crate::hash::mixed;
use crate::surface::halfedge::{ends, next, triangles_at, Fans, NONE};
use crate::surface::manifold::Surface;

/// Edges shorter than this are drawn together, work units.
const SHORT: f64 = 0.25;
/// Rounds; in each one edges are taken that have no triangle in common.
const ROUNDS: usize = 6;
/// A triangle turns no farther than this cosine away from the surface around.
const TURNED: f64 = 0.3;

/// Draws the short edges of a consistently wound 2-manifold together.
pub(crate) fn weld(surface: &mut Surface, execution: &mut Execution) -> Result<()> {
    weld_some(surface, |_| true, |p, q| Some(middle(p, q)), execution)
}

/// The same for edges that a cut at the border of the volume has left there: what lies on two borders
/// stays on both. `last` is the last voxel of the volume, work coordinates.
pub(crate) fn weld_at_border(
    surface: &mut Surface,
    last: Vec3,
    execution: &mut Execution,
) -> Result<()> {
    let place = |p: Vec3, q: Vec3| {
        let [of_p, of_q] = [p, q].map(|p| on_border(p, last));
        let holds = |all: [bool; 3], some: [bool; 3]| (0..3).all(|a| all[a] || !some[a]);
        match (holds(of_p, of_q), holds(of_q, of_p)) {
            (true, true) => Some(middle(p, q)),
            (true, false) => Some(p),
            (false, true) => Some(q),
            (false, false) => None,
        }
    };
    let is_at_border = |p: Vec3| on_border(p, last).contains(&true);
    weld_some(surface, is_at_border, place, execution)
}

fn middle(p: Vec3, q: Vec3) -> Vec3 {
    along(p, 0.5, sub(q, p))
}

/// Draws short edges together whose ends are both `wanted`, to a `place` that is given two points of the
/// boundary or two others; none where the edge has to stay.
fn weld_some(
    surface: &mut Surface,
    wanted: impl Fn(Vec3) -> bool + Sync,
    place: impl Fn(Vec3, Vec3) -> Option<Vec3>,
    execution: &mut Execution,
) -> Result<()> {
    for _ in 0..ROUNDS {
        let short = short_edges(surface, &wanted, execution)?;
        if short.is_empty() {
            break;
        }
        let pairs = pairs(surface, &fans_near(surface, &short)?, short, &place)?;
        if pairs.is_empty() {
            break;
        }
        let mut into = collected(0..surface.points.len() as u32)?;
        for (from, to, place) in pairs {
            into[from as usize] = to;
            surface.points[to as usize] = place;
        }
        for p in surface.triangles.iter_mut().flatten() {
            *p = into[*p as usize];
        }
        surface
            .triangles
            .retain(|[a, b, c]| a != b && b != c && c != a);
    }
    Ok(())
}

/// The half-edges of short edges, in the order in which they go: as a hash of their places tells. Along a
/// straight rim lengths may go on falling, and the shortest first would decide about those far off.
fn short_edges(
    surface: &Surface,
    wanted: impl Fn(Vec3) -> bool + Sync,
    execution: &Execution,
) -> Result<Vec<u32>> {
    let is_wanted = |e: u32| {
        let (a, b) = ends(&surface.triangles, e);
        let [p, q] = [a, b].map(|p| surface.points[p as usize]);
        squared_distance(p, q) < SHORT * SHORT && wanted(p) && wanted(q)
    };
    let mut is_short: Vec<bool> = zeros(3 * surface.triangles.len())?;
    execution.in_pool(|| {
        let all = is_short.par_iter_mut().enumerate();
        all.for_each(|(e, is_short)| *is_short = is_wanted(e as u32));
    });
    let all = 0..is_short.len() as u32;
    let mut short = collected(all.filter(|&e| is_short[e as usize]))?;
    short.sort_unstable_by_key(|&e| (hash(surface, e), e));
    Ok(short)
}

/// A number made of the places of an edge's ends, whichever comes first.
fn hash(surface: &Surface, e: u32) -> u64 {
    let (a, b) = ends(&surface.triangles, e);
    let of = |p: u32| mixed(surface.points[p as usize].into_iter().map(f64::to_bits));
    of(a) ^ of(b)
}

/// The fans of the ends of short edges, which are few, and of the points next to them; other points
/// have none.
fn fans_near(surface: &Surface, short: &[u32]) -> Result<Fans> {
    let triangles = &surface.triangles;
    let mut is_end: Vec<bool> = zeros(surface.points.len())?;
    for &e in short {
        let (a, b) = ends(triangles, e);
        (is_end[a as usize], is_end[b as usize]) = (true, true);
    }
    let mut near = collected(is_end.iter().copied())?;
    for t in triangles_at(triangles, &is_end)? {
        for p in triangles[t as usize] {
            near[p as usize] = true;
        }
    }
    let around = triangles_at(triangles, &near)?;
    Fans::of_points(triangles, &around, &near)
}

/// Points to be drawn into others and where to, none of them near another's triangles.
fn pairs(
    surface: &Surface,
    fans: &Fans,
    short: Vec<u32>,
    place: impl Fn(Vec3, Vec3) -> Option<Vec3>,
) -> Result<Vec<(u32, u32, Vec3)>> {
    let mut taken: Vec<bool> = zeros(surface.points.len())?;
    let mut pairs = Vec::new();
    for e in short {
        let (a, b) = ends(&surface.triangles, e);
        let around = || {
            let triangles = fans.of(a).iter().chain(fans.of(b));
            triangles.flat_map(|&f| surface.triangles[f as usize / 3])
        };
        if around().any(|p| taken[p as usize]) || !keeps_topology(surface, fans, e) {
            continue;
        }
        // A point of the boundary stays on it.
        let on_boundary = [a, b].map(|p| fans.is_boundary(&surface.triangles, p));
        let (from, to) = if on_boundary[1] { (a, b) } else { (b, a) };
        let [p, q] = [from, to].map(|p| surface.points[p as usize]);
        let place = match on_boundary[0] == on_boundary[1] {
            true => place(p, q),
            false => Some(q),
        };
        let keeps_shape = |place: &Vec3| keeps_shape(surface, fans, [from, to], *place);
        if let Some(place) = place.filter(keeps_shape) {
            around().for_each(|p| taken[p as usize] = true);
            push(&mut pairs, (from, to, place))?;
        }
    }
    Ok(pairs)
}

/// Whether the surface's topology allows the edge of e to be drawn together.
fn keeps_topology(surface: &Surface, fans: &Fans, e: u32) -> bool {
    let triangles = &surface.triangles;
    let (a, b) = ends(triangles, e);
    let sides = [e, fans.twin(triangles, e)];
    let sides = || sides.into_iter().filter(|&f| f != NONE);
    let is_boundary = |p: u32| fans.is_boundary(triangles, p);
    if sides().count() == 2 && is_boundary(a) && is_boundary(b) {
        return false;
    }
    let opposite = |f: u32| ends(triangles, next(f)).1;
    let enough = |c: u32| fans.of(c).len() > if is_boundary(c) { 1 } else { 3 };
    let neighbours = |p: u32| {
        let corners = fans.of(p).iter();
        let mut all: Vec<u32> = corners
            .flat_map(|&f| triangles[f as usize / 3])
            .filter(|&q| q != p)
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let others = neighbours(b);
    let common = neighbours(a)
        .iter()
        .filter(|p| others.binary_search(p).is_ok())
        .count();
    common == sides().count() && sides().all(|f| enough(opposite(f)))
}

/// Whether the triangles around two points face as the surface does if both points are at `place`, or
/// have not done so before: on the border of the volume a row of slivers may be folded over.
fn keeps_shape(surface: &Surface, fans: &Fans, points: [u32; 2], place: Vec3) -> bool {
    let triangles = || {
        let around = points.iter().flat_map(|&p| fans.of(p));
        around.map(|&f| surface.triangles[f as usize / 3])
    };
    let twice_area = |t: [Vec3; 3]| cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let facing = triangles().fold([0.0; 3], |sum, t| {
        along(sum, 1.0, twice_area(t.map(|p| surface.points[p as usize])))
    });
    let stays = |t: &[u32; 3]| !(t.contains(&points[0]) && t.contains(&points[1]));
    let faces = |area: Vec3| dot(area, facing) > TURNED * length(area) * length(facing);
    triangles().filter(stays).all(|t| {
        let before = t.map(|p| surface.points[p as usize]);
        let moved: [Vec3; 3] = std::array::from_fn(|k| match points.contains(&t[k]) {
            true => place,
            false => before[k],
        });
        faces(twice_area(moved)) || !faces(twice_area(before))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Quiet;

    /// A lattice of squares, each cut in two, on a plane or bent to a closed ring.
    fn lattice(columns: u32, rows: u32, place: impl Fn(u32, u32) -> Vec3) -> Surface {
        let at = |i: u32, j: u32| j * (columns + 1) + i;
        let mut triangles = Vec::new();
        for j in 0..rows {
            for i in 0..columns {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        let points = (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j)));
        let points: Vec<Vec3> = points.map(|(i, j)| place(i, j)).collect();
        let source = vec![0; points.len()];
        Surface {
            points,
            triangles,
            source,
        }
    }

    fn weld_all(surface: &mut Surface) {
        let mut quiet = Quiet::default();
        weld(surface, &mut Execution::new(2, &mut quiet).unwrap()).unwrap();
    }

    #[test]
    fn points_that_nearly_coincide_become_one() {
        let mut surface = lattice(4, 4, |i, j| [f64::from(i), f64::from(j), 0.0]);
        // The middle point and its neighbour, and two points of the boundary.
        surface.points[12] = [2.9, 2.0, 0.0];
        surface.points[1] = [1.95, 0.0, 0.0];
        let before = surface.triangles.len();
        weld_all(&mut surface);
        assert_eq!(surface.triangles.len(), before - 2 - 1);
        let corners = surface.triangles.iter().flatten();
        let on_boundary = |p: &&u32| surface.points[**p as usize][1] == 0.0;
        let mut boundary: Vec<u32> = corners.filter(on_boundary).copied().collect();
        boundary.sort_unstable();
        boundary.dedup();
        assert_eq!(boundary.len(), 4);
    }

    #[test]
    fn a_row_folded_over_at_the_boundary_is_drawn_together() {
        const ROWS: [f64; 4] = [0.0, 1.0, 2.02, 1.97];
        let mut surface = lattice(6, 3, |i, j| [f64::from(i), ROWS[j as usize], 0.0]);
        weld_all(&mut surface);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|p| surface.points[p as usize]);
            0.5 * cross(sub(b, a), sub(c, a))[2]
        };
        // None is left that faces downward, nor a sliver.
        assert_eq!(surface.triangles.len(), 24);
        assert!(surface.triangles.iter().all(|t| area(t) > 0.2));
    }

    #[test]
    fn at_a_cut_short_edges_go_and_what_lies_on_two_borders_stays_there() {
        let mut surface = lattice(4, 4, |i, j| [f64::from(i), f64::from(j), 5.0]);
        // Beside the corner of the volume, along a border, and away from all.
        surface.points[1] = [0.02, 0.0, 5.0];
        surface.points[3] = [2.1, 0.0, 5.0];
        surface.points[12] = [2.9, 2.0, 5.0];
        let before = surface.triangles.len();
        let mut quiet = Quiet::default();
        let execution = &mut Execution::new(2, &mut quiet).unwrap();
        weld_at_border(&mut surface, [9.0; 3], execution).unwrap();
        assert_eq!(surface.triangles.len(), before - 2);
        let is_used = |p: &Vec3| {
            let mut corners = surface.triangles.iter().flatten();
            corners.any(|&q| surface.points[q as usize] == *p)
        };
        for place in [[0.0, 0.0, 5.0], [2.05, 0.0, 5.0], [2.9, 2.0, 5.0]] {
            assert!(is_used(&place), "{place:?}");
        }
        assert!(!is_used(&[0.02, 0.0, 5.0]));
    }

    #[test]
    fn a_narrow_neck_is_not_drawn_together() {
        // Both ends of its short edges lie on the boundary.
        let mut surface = lattice(6, 1, |i, j| [f64::from(i), 0.1 * f64::from(j), 0.0]);
        weld_all(&mut surface);
        // At its two ends it may get shorter by a triangle.
        assert!(surface.triangles.len() >= 12 - 2);
    }
}
