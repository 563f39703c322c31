//! Surface → surface without scraps.
//!
//! Where sheets meet, or a rim is ragged, the contour leaves small pieces beside the sheet. A part's
//! largest piece is never one of them: a small label keeps its surface.

use crate::components::DisjointSets;
use crate::error::{zeros, Result};
use crate::grid::{cross, length, sub};
use crate::manifold::Surface;

/// Smaller pieces of surface are scraps, square work units.
const SCRAP: f64 = 15.0;

/// Drops the scraps of a surface, whose points have their parts as sources, from the parts that
/// `has_scraps` names.
pub(crate) fn drop_scraps(surface: &mut Surface, has_scraps: impl Fn(usize) -> bool) -> Result<()> {
    drop_pieces(surface, SCRAP, has_scraps)
}

/// Drops pieces smaller than this, square work units, of a surface, whose points have their parts as
/// sources, from the parts that `has_scraps` names.
pub(crate) fn drop_pieces(
    surface: &mut Surface,
    scrap: f64,
    has_scraps: impl Fn(usize) -> bool,
) -> Result<()> {
    let mut pieces = DisjointSets::new(surface.points.len())?;
    for t in &surface.triangles {
        pieces.join(t[0] as usize, t[1] as usize);
        pieces.join(t[0] as usize, t[2] as usize);
    }
    let mut area: Vec<f64> = zeros(surface.points.len())?;
    for t in &surface.triangles {
        let [a, b, c] = t.map(|p| surface.points[p as usize]);
        area[pieces.find(t[0] as usize)] += 0.5 * length(cross(sub(b, a), sub(c, a)));
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
        let own = area[pieces.find(t[0] as usize)];
        own >= scrap || own >= largest[part_of(t[0])] || !has_scraps(part_of(t[0]))
    });
    surface.triangles = triangles;
    Ok(())
}
