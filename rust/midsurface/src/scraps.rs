//! Surface → surface without scraps.
//!
//! Where sheets meet, or a rim is ragged, the contour leaves small pieces beside the sheet. A part's
//! largest piece is never one of them: a small label keeps its surface. What is cut later leaves scraps
//! where it was cut, and only there they are looked for: what is far off makes no difference.

use crate::components::DisjointSets;
use crate::error::{zeros, Result};
use crate::grid::{cross, length, sub};
use crate::manifold::Surface;

/// Smaller pieces of surface are scraps, square work units.
const SCRAP: f64 = 15.0;

/// Drops the scraps of a surface, whose points have their parts as sources, among the pieces of which a
/// point `is_near` a cut.
pub(crate) fn drop_scraps(surface: &mut Surface, is_near: impl Fn(usize) -> bool) -> Result<()> {
    drop_pieces(surface, SCRAP, is_near)
}

/// The same for pieces smaller than this, square work units.
pub(crate) fn drop_pieces(
    surface: &mut Surface,
    scrap: f64,
    is_near: impl Fn(usize) -> bool,
) -> Result<()> {
    let mut pieces = DisjointSets::new(surface.points.len())?;
    for t in &surface.triangles {
        pieces.join(t[0] as usize, t[1] as usize);
        pieces.join(t[0] as usize, t[2] as usize);
    }
    let mut area: Vec<f64> = zeros(surface.points.len())?;
    let mut may_go: Vec<bool> = zeros(surface.points.len())?;
    for t in &surface.triangles {
        let [a, b, c] = t.map(|p| surface.points[p as usize]);
        let piece = pieces.find(t[0] as usize);
        area[piece] += 0.5 * length(cross(sub(b, a), sub(c, a)));
        may_go[piece] |= t.iter().any(|&p| is_near(p as usize));
    }
    let part_of = |p: u32| surface.source[p as usize] as usize;
    let parts = surface.source.iter().max().map_or(0, |p| *p as usize + 1);
    let mut largest: Vec<f64> = zeros(parts)?;
    for t in &surface.triangles {
        let own = &mut largest[part_of(t[0])];
        *own = own.max(area[pieces.find(t[0] as usize)]);
    }
    let mut triangles = std::mem::take(&mut surface.triangles);
    triangles.retain(|t| {
        let piece = pieces.find(t[0] as usize);
        area[piece] >= scrap || area[piece] >= largest[part_of(t[0])] || !may_go[piece]
    });
    surface.triangles = triangles;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Adds a square in two triangles, as a piece of its own.
    fn add_square(surface: &mut Surface, part: u32, side: f64) {
        let first = surface.points.len() as u32;
        let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
        surface.points.extend(corners.map(|[x, y]| [x, y, 0.0]));
        surface.source.extend([part; 4]);
        let triangles = [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|p| first + p));
        surface.triangles.extend(triangles);
    }

    #[test]
    fn scraps_near_a_cut_are_dropped_but_for_the_largest_piece_of_a_part() {
        let mut surface = Surface::default();
        // Of the first part, large, a scrap at the cut and one elsewhere; a small part, at the cut, too.
        for (part, side) in [(0, 9.0), (0, 2.0), (0, 3.0), (1, 1.0), (1, 0.5)] {
            add_square(&mut surface, part, side);
        }
        let is_near = |p: usize| [0, 4, 12, 16].contains(&p);
        drop_scraps(&mut surface, is_near).unwrap();
        let first: Vec<u32> = surface.triangles.iter().step_by(2).map(|t| t[0]).collect();
        assert_eq!(first, [0, 8, 12]);
        drop_scraps(&mut surface, |_| true).unwrap();
        let first: Vec<u32> = surface.triangles.iter().step_by(2).map(|t| t[0]).collect();
        assert_eq!(first, [0, 12]);
    }
}
