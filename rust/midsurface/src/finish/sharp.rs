//! Finished triangles, of which a few have become sharp → the same, none of them sharp.
//!
//! Triangles are nearly equilateral when they are made, and what moves their points afterwards, along
//! normals, hardly changes that. But where a sheet bends sharply neighbours move different ways, and
//! a rim that is drawn back (`self_intersections.rs`) presses what lies behind it: a triangle or two in
//! ten thousand become sharp. Each of their corners goes to the best of some places around it, where
//! its triangles lack least (local optimisation of angles, as in Freitag and Ollivier-Gooch 1997,
//! "Tetrahedral mesh improvement using swapping and smoothing").
//!
//! Points on a border of the volume stay. Where no corner can move to any gain a triangle stays sharp.

use crate::error::{collected, extend, Result};
use crate::execution::Execution;
use crate::grid::{along, dot, length, on_border, sub, Vec3};
use crate::remesh::{sine_of_smallest_angle, SHARP};
use crate::surface::halfedge::{ends, Fans};
use crate::surface::manifold::Surface;
use crate::surface::normals::normal_of_fan;

/// Times that corners move, at most.
const STEPS: usize = 24;
/// Shares of an edge that a point tries to move by.
const SHARES: [f64; 3] = [0.25, 0.12, 0.06];
/// A triangle whose smallest angle is this sine's (31°) lacks nothing, others the square of what is
/// missing; this share of what its triangles lack a point has to gain.
const ENOUGH: f64 = 0.52;
const GAIN: f64 = 0.01;
/// Triangles handed to a worker at a time.
const PIECE: usize = 4096;
/// Passes over the triangles that [`widen_all`] makes, for its progress.
pub(crate) const PASSES: usize = 1;

/// Makes the sharp triangles of a surface less so; `last` is the last voxel of the volume, work
/// coordinates.
pub(crate) fn widen_all(
    surface: &mut Surface,
    fans: &Fans,
    last: Vec3,
    execution: &mut Execution,
) -> Result<()> {
    let pieces = collected(0..surface.triangles.len().div_ceil(PIECE))?;
    let mut sharp = Vec::new();
    execution.stream(
        &pieces,
        |piece| {
            let first = piece * PIECE;
            let last = surface.triangles.len().min(first + PIECE);
            let all = first as u32..last as u32;
            collected(all.filter(|&t| is_sharp(surface, t)))
        },
        |found: Result<Vec<u32>>| extend(&mut sharp, found?),
    )?;
    widen(surface, fans, last, sharp)?;
    Ok(())
}

/// Makes those of some triangles that are sharp less so; returns the triangles that have changed.
pub(crate) fn widen(
    surface: &mut Surface,
    fans: &Fans,
    last: Vec3,
    mut some: Vec<u32>,
) -> Result<Vec<u32>> {
    let mut changed = Vec::new();
    for _ in 0..STEPS {
        some.retain(|&t| is_sharp(surface, t));
        let mut corners = collected(some.iter().flat_map(|&t| surface.triangles[t as usize]))?;
        // By place, as all tiles of a component would.
        corners.sort_unstable_by_key(|&p| (surface.points[p as usize].map(f64::to_bits), p));
        corners.dedup();
        corners.retain(|&p| has_gained(surface, fans.of(p), p, last));
        if corners.is_empty() {
            break;
        }
        some = collected(corners.iter().flat_map(|&p| fans.of(p)).map(|&e| e / 3))?;
        some.sort_unstable();
        some.dedup();
        extend(&mut changed, some.iter().copied())?;
    }
    Ok(changed)
}

fn is_sharp(surface: &Surface, t: u32) -> bool {
    sine(surface, surface.triangles[t as usize]) < SHARP
}

/// Whether a point has moved to where its triangles lack less: along the surface, or where that is of no
/// use along the normal.
fn has_gained(surface: &mut Surface, leaving: &[u32], p: u32, last: Vec3) -> bool {
    let lack = |surface: &Surface| -> f64 {
        let triangles = leaving.iter().map(|&e| surface.triangles[e as usize / 3]);
        let lack = triangles.map(|t| (ENOUGH - sine(surface, t)).max(0.0));
        lack.map(|lack| lack * lack).sum()
    };
    let from = surface.points[p as usize];
    let before = (1.0 - GAIN) * lack(surface);
    let mut best = (before, from);
    for ways in ways(surface, leaving, p, last) {
        for (way, share) in ways
            .iter()
            .flat_map(|way| SHARES.map(|share| (*way, share)))
        {
            surface.points[p as usize] = along(from, share, way);
            let lack = lack(surface);
            if lack < best.0 {
                best = (lack, surface.points[p as usize]);
            }
        }
        if best.0 < before {
            break;
        }
    }
    surface.points[p as usize] = best.1;
    best.0 < before
}

/// Ways that a point may go, as long as an edge: along the surface to and from each point beside it, and
/// along the normal; one on the border of the volume, none.
fn ways(surface: &Surface, leaving: &[u32], p: u32, last: Vec3) -> [Vec<Vec3>; 2] {
    let (triangles, points) = (&surface.triangles, &surface.points);
    let from = points[p as usize];
    if on_border(from, last).contains(&true) {
        return Default::default();
    }
    let normal = normal_of_fan(points, triangles, leaving);
    let ends = leaving.iter().map(|&e| ends(triangles, e).1 as usize);
    let spokes = ends.map(|q| sub(points[q], from));
    let across = spokes.clone();
    let across = across.map(|way| along(way, -dot(way, normal), normal));
    let up = spokes.take(1).map(|way| normal.map(|v| length(way) * v));
    let both = |way: Vec3| [way, way.map(|v| -v)];
    [across.flat_map(both).collect(), up.flat_map(both).collect()]
}

fn sine(surface: &Surface, triangle: [u32; 3]) -> f64 {
    sine_of_smallest_angle(triangle.map(|p| surface.points[p as usize]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Quiet;

    /// A hexagon of equilateral triangles and, far from it, another one; both centres have moved.
    fn hexagons(moves: [Vec3; 2]) -> Surface {
        let mut surface = Surface::default();
        for (x, way) in [5.0, 50.0].into_iter().zip(moves) {
            let centre = surface.points.len() as u32;
            surface.points.push(along([x, 5.0, 5.0], 1.0, way));
            for k in 0..6 {
                let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
                surface.points.push([x + cos, 5.0 + sin, 5.0]);
                let k = k as u32;
                let spoke = [centre, centre + 1 + k, centre + 1 + (k + 1) % 6];
                surface.triangles.push(spoke);
            }
        }
        surface.source.resize(surface.points.len(), 0);
        surface
    }

    fn widened(mut surface: Surface, threads: usize) -> Surface {
        let mut quiet = Quiet::default();
        let fans = Fans::new(&surface.triangles, surface.points.len()).unwrap();
        let mut execution = Execution::new(threads, &mut quiet).unwrap();
        widen_all(&mut surface, &fans, [100.0; 3], &mut execution).unwrap();
        surface
    }

    fn is_any_sharp(surface: &Surface) -> bool {
        (0..surface.triangles.len() as u32).any(|t| is_sharp(surface, t))
    }

    #[test]
    fn what_is_sharp_is_widened_and_all_else_stays() {
        let hexagons = || hexagons([[0.7, 0.0, 0.0], [0.0, 0.2, 0.0]]);
        assert!(is_any_sharp(&hexagons()));
        let found = widened(hexagons(), 2);
        assert!(!is_any_sharp(&found));
        assert_eq!(found.points[7..], hexagons().points[7..]);
    }

    #[test]
    fn points_on_a_border_of_the_volume_stay() {
        // Two squares side by side, each cut in two; the middle of the lower side is off to the left.
        let lower = [1.0, 1.4, 3.0].map(|x| [x, 0.0, 1.0]);
        let upper = [1.0, 2.0, 3.0].map(|x| [x, 1.0, 1.0]);
        let squares = |height: f64| Surface {
            points: [lower, upper]
                .concat()
                .iter()
                .map(|p| along(*p, height, [0.0, 1.0, 0.0]))
                .collect(),
            triangles: vec![[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]],
            source: vec![0; 6],
        };
        let is_unmoved = |p: usize, height: f64| {
            widened(squares(height), 1).points[p] == squares(height).points[p]
        };
        assert!(is_any_sharp(&squares(0.0)));
        assert!((0..3).all(|p| is_unmoved(p, 0.0)));
        assert!(!(0..3).all(|p| is_unmoved(p, 1.0)));
        assert!(!is_any_sharp(&widened(squares(1.0), 1)));
    }

    #[test]
    fn any_number_of_threads_finds_the_same() {
        let moved = || hexagons([[0.7, 0.0, 0.0], [0.1, 0.6, 0.3]]);
        assert_eq!(widened(moved(), 1).points, widened(moved(), 2).points);
    }
}
