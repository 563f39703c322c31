//! Finished triangles whose points have moved → the same, none of them sharp.
//!
//! Triangles are nearly equilateral when they are made, and what moves their points afterwards, along
//! normals, hardly changes that. But where a sheet bends sharply, or at a rim, neighbours move different
//! ways, and a triangle or two in ten thousand become sharp. The corners of these go back towards where
//! they were, step by step and no farther than it takes.
//!
//! What was sharp before and has not become worse stays as it is.

use crate::error::{collected, extend, Result};
use crate::execution::Execution;
use crate::grid::{along, sub, Vec3};
use crate::halfedge::Fans;
use crate::manifold::Surface;
use crate::remesh::{sine_of_smallest_angle, SHARP};

/// Share of the way back that points go in a step, and the most steps: hardly anything is left in the end.
const STEP: f64 = 0.25;
const STEPS: usize = 12;
/// Triangles handed to a worker at a time.
const PIECE: usize = 4096;
/// Passes over the triangles that [`take_back`] makes where none is sharp, for its progress.
pub(crate) const PASSES: usize = 1;

/// Takes back the moves from `before` of the points of triangles that these have made sharp.
pub(crate) fn take_back(
    before: &[Vec3],
    surface: &mut Surface,
    fans: &Fans,
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
            collected(all.filter(|&t| is_sharpened(before, surface, t)))
        },
        |found: Result<Vec<u32>>| extend(&mut sharp, found?),
    )?;
    for _ in 0..STEPS {
        let mut moved = Vec::new();
        extend(
            &mut moved,
            sharp.iter().flat_map(|&t| surface.triangles[t as usize]),
        )?;
        moved.sort_unstable();
        moved.dedup();
        for p in moved.iter().map(|&p| p as usize) {
            let way = sub(before[p], surface.points[p]);
            surface.points[p] = along(surface.points[p], STEP, way);
        }
        let around = moved.iter().flat_map(|&p| fans.of(p));
        let mut near = collected(around.map(|&e| e / 3))?;
        near.sort_unstable();
        near.dedup();
        near.retain(|&t| is_sharpened(before, surface, t));
        if near.is_empty() {
            break;
        }
        sharp = near;
    }
    Ok(())
}

/// Whether a triangle is sharp, and was less so before.
fn is_sharpened(before: &[Vec3], surface: &Surface, t: u32) -> bool {
    let corners = surface.triangles[t as usize].map(|p| p as usize);
    let now = sine_of_smallest_angle(corners.map(|p| surface.points[p]));
    now < SHARP && now < sine_of_smallest_angle(corners.map(|p| before[p]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Quiet;

    /// A hexagon of equilateral triangles and, far from it, another one; both centres have moved.
    fn hexagons(moves: [Vec3; 2]) -> (Vec<Vec3>, Surface) {
        let mut surface = Surface::default();
        for x in [0.0, 50.0] {
            let centre = surface.points.len() as u32;
            surface.points.push([x, 0.0, 0.0]);
            for k in 0..6 {
                let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
                surface.points.push([x + cos, sin, 0.0]);
                let k = k as u32;
                let spoke = [centre, centre + 1 + k, centre + 1 + (k + 1) % 6];
                surface.triangles.push(spoke);
            }
        }
        surface.source.resize(surface.points.len(), 0);
        let before = surface.points.clone();
        for (centre, way) in [0, 7].into_iter().zip(moves) {
            surface.points[centre] = along(before[centre], 1.0, way);
        }
        (before, surface)
    }

    fn taken_back((before, mut surface): (Vec<Vec3>, Surface), threads: usize) -> Surface {
        let mut quiet = Quiet::default();
        let fans = Fans::new(&surface.triangles, surface.points.len()).unwrap();
        let mut execution = Execution::new(threads, &mut quiet).unwrap();
        take_back(&before, &mut surface, &fans, &mut execution).unwrap();
        surface
    }

    #[test]
    fn a_move_that_makes_a_triangle_sharp_is_taken_back_as_far_as_it_takes() {
        let found = taken_back(hexagons([[0.7, 0.0, 0.0], [0.0, 0.2, 0.0]]), 2);
        let sine = |t: &[u32; 3]| sine_of_smallest_angle(t.map(|p| found.points[p as usize]));
        assert!(found.triangles.iter().all(|t| sine(t) >= SHARP));
        // Two steps are enough for the one, and the other one has done no harm.
        assert!((found.points[0][0] - 0.7 * 0.75 * 0.75).abs() < 1e-12);
        assert_eq!(found.points[7], [50.0, 0.2, 0.0]);
    }

    #[test]
    fn what_was_sharp_before_stays_moved() {
        let (mut before, surface) = hexagons([[0.7, 0.0, 0.0], [0.0; 3]]);
        before[0][0] = 0.75;
        assert_eq!(taken_back((before, surface), 1).points[0][0], 0.7);
    }

    #[test]
    fn any_number_of_threads_takes_the_same_back() {
        let moved = || hexagons([[0.7, 0.0, 0.0], [0.1, 0.6, 0.3]]);
        assert_eq!(taken_back(moved(), 1).points, taken_back(moved(), 2).points);
    }
}
