//! Surface → surface without scraps.
//!
//! Where sheets meet, or a rim is ragged, the contour leaves small pieces beside the sheet. A part's
//! largest piece is never one of them: a small label keeps its surface. Nor is of the contour what the
//! border of the volume cuts off all round: of a sheet across a corner of the volume there may be no more.
//! What is cut later leaves scraps where it was cut, and only there they are looked for: what is far off
//! makes no difference.

use crate::error::{collected, zeros, Result};
use crate::grid::{cross, length, on_border, sub, Vec3};
use crate::reading::components::DisjointSets;
use crate::surface::halfedge::Edges;
use crate::surface::manifold::Surface;

/// Smaller pieces of surface are scraps, square work units.
const SCRAP: f64 = 15.0;

/// Drops the scraps of a surface, whose points have their parts as sources; the volume's last voxel is
/// at `last`.
pub(crate) fn drop_scraps(surface: &mut Surface, last: Vec3) -> Result<()> {
    drop_small(surface, SCRAP, |_| true, Some(last))
}

/// The same among the pieces of which a point `is_near` a cut.
pub(crate) fn drop_scraps_near(
    surface: &mut Surface,
    is_near: impl Fn(usize) -> bool,
) -> Result<()> {
    drop_small(surface, SCRAP, is_near, None)
}

/// Drops the pieces smaller than this, square work units, wherever they end.
pub(crate) fn drop_pieces(surface: &mut Surface, scrap: f64) -> Result<()> {
    drop_small(surface, scrap, |_| true, None)
}

/// Drops pieces smaller than `scrap` that are near a cut, but for those that the border of a volume with this
/// `last` voxel cuts off.
fn drop_small(
    surface: &mut Surface,
    scrap: f64,
    is_near: impl Fn(usize) -> bool,
    last: Option<Vec3>,
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
    let mut goes: Vec<bool> = zeros(surface.points.len())?;
    for t in &surface.triangles {
        let piece = pieces.find(t[0] as usize);
        goes[piece] = area[piece] < scrap && area[piece] < largest[part_of(t[0])] && may_go[piece];
    }
    if let Some(last) = last {
        keep_cut_off(surface, &mut pieces, &mut goes, last)?;
    }
    let triangles = &mut surface.triangles;
    triangles.retain(|t| !goes[pieces.find(t[0] as usize)]);
    Ok(())
}

/// Keeps those of the pieces that would go that end nowhere but on the border of the volume, and there
/// on several sides of it: a cap on one of them may be a scrap.
fn keep_cut_off(
    surface: &Surface,
    pieces: &mut DisjointSets,
    goes: &mut [bool],
    last: Vec3,
) -> Result<()> {
    let triangles = &surface.triangles;
    let mut is_small = |t: &u32| goes[pieces.find(triangles[*t as usize][0] as usize)];
    let small = collected((0..triangles.len() as u32).filter(&mut is_small))?;
    if small.is_empty() {
        return Ok(());
    }
    let edges = Edges::of_triangles(triangles, &small, surface.points.len())?;
    let border = |p: u32| on_border(surface.points[p as usize], last);
    let mut ends_on: Vec<[bool; 3]> = zeros(surface.points.len())?;
    let mut ends_within: Vec<bool> = zeros(surface.points.len())?;
    for (a, b, _) in edges.groups().filter(|(.., group)| group.len() == 1) {
        let piece = pieces.find(a as usize);
        let [of_a, of_b] = [a, b].map(border);
        let on: [bool; 3] = std::array::from_fn(|k| of_a[k] && of_b[k]);
        ends_within[piece] |= on == [false; 3];
        ends_on[piece] = std::array::from_fn(|k| ends_on[piece][k] || on[k]);
    }
    for ((goes, ends_on), ends_within) in goes.iter_mut().zip(ends_on).zip(ends_within) {
        let sides = ends_on.iter().filter(|on| **on).count();
        *goes &= sides < 2 || ends_within;
    }
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
        drop_scraps_near(&mut surface, is_near).unwrap();
        let first: Vec<u32> = surface.triangles.iter().step_by(2).map(|t| t[0]).collect();
        assert_eq!(first, [0, 8, 12]);
        drop_pieces(&mut surface, SCRAP).unwrap();
        let first: Vec<u32> = surface.triangles.iter().step_by(2).map(|t| t[0]).collect();
        assert_eq!(first, [0, 12]);
    }

    #[test]
    fn what_the_border_cuts_off_all_round_stays() {
        let mut surface = Surface::default();
        add_square(&mut surface, 0, 9.0);
        // A sheet across the corner of the volume, the same but for a rim within, one that lies on one
        // border, and a closed one.
        for corner in [[3.0, 0.0, 0.0], [3.0, 0.5, 0.0], [0.0, 5.0, 5.0]] {
            let first = surface.points.len() as u32;
            surface
                .points
                .extend([corner, [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]]);
            surface.triangles.push([0, 1, 2].map(|p| first + p));
            surface.source.extend([0; 3]);
        }
        let first = surface.points.len() as u32;
        surface
            .points
            .extend([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        surface.source.extend([0; 4]);
        let sides = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        surface
            .triangles
            .extend(sides.map(|t| t.map(|p| first + p)));
        drop_scraps(&mut surface, [100.0; 3]).unwrap();
        assert_eq!(surface.triangles, [[0, 1, 2], [0, 2, 3], [4, 5, 6]]);
    }
}
