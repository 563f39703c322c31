//! Contour → surface with true rims: what reaches beyond the label is cut off.
//!
//! The contour runs on a little beyond the rims and over the holes of the label. It is cut where the
//! sheet fraction (`ridge.rs`) is ½, between the points, so that rims and holes are where the data
//! put them and not on the grid. What noise alone makes is left: a region below ½ is a hole only
//! where its fraction falls far enough, and a region above ½ is a piece of sheet only where its
//! fraction rises far enough (hysteresis, as in Canny 1986).

use crate::components::DisjointSets;
use crate::error::Result;
use crate::grid::{along, cross, length, sub};
use crate::halfedge::{ends, Edges};
use crate::manifold::Surface;

/// The sheet fraction at a rim.
const RIM: f64 = 0.5;
/// A hole is at least this empty somewhere, and a sheet this full.
const HOLE: f64 = 0.25;
const SHEET: f64 = 0.75;
/// A cut keeps this share of an edge away from its ends: no triangle becomes a point.
const CLEAR: f64 = 0.02;

/// Cuts `surface` where `fraction`, given at its points, is ½.
pub(crate) fn trim(surface: &mut Surface, fraction: &[f64]) -> Result<()> {
    let above = sides(surface, fraction);
    if above.iter().all(|&a| a) {
        return Ok(());
    }
    let triangles = std::mem::take(&mut surface.triangles);
    let edges = Edges::new(&triangles, surface.points.len());
    let mut cut = vec![0u32; 3 * triangles.len()];
    for (a, b, group) in edges.groups() {
        if above[a as usize] != above[b as usize] {
            let new = surface.points.len() as u32;
            let [p, q] = [a, b].map(|p| p as usize);
            // Where hysteresis overruled the fraction, the cut is next to the point it kept.
            let t = (RIM - fraction[p]) / (fraction[q] - fraction[p]);
            let t = if t.is_finite() { t } else { 0.5 };
            let t = t.clamp(CLEAR, 1.0 - CLEAR);
            let (from, to) = (surface.points[p], surface.points[q]);
            surface.points.push(along(from, t, sub(to, from)));
            surface.source.push(surface.source[p]);
            for &(_, half_edge) in group {
                cut[half_edge as usize] = new;
            }
        }
    }
    for (t, triangle) in triangles.iter().enumerate() {
        keep(
            triangle,
            3 * t as u32,
            &above,
            &cut,
            &triangles,
            &mut surface.triangles,
        );
    }
    Ok(())
}

/// Whether each point stays.
fn sides(surface: &Surface, fraction: &[f64]) -> Vec<bool> {
    let mut above: Vec<bool> = fraction.iter().map(|f| *f >= RIM).collect();
    let mut regions = DisjointSets::new(above.len());
    for t in &surface.triangles {
        for (p, q) in [(t[0], t[1]), (t[1], t[2])] {
            if above[p as usize] == above[q as usize] {
                regions.join(p as usize, q as usize);
            }
        }
        if above[t[0] as usize] == above[t[2] as usize] {
            regions.join(t[0] as usize, t[2] as usize);
        }
    }
    let mut certain = vec![false; above.len()];
    for (p, f) in fraction.iter().enumerate() {
        certain[regions.find(p)] |= if above[p] { *f >= SHEET } else { *f <= HOLE };
    }
    for p in 0..above.len() {
        above[p] ^= !certain[regions.find(p)];
    }
    above
}

/// Appends what is left of one triangle, whose first half-edge is given.
fn keep(
    triangle: &[u32; 3],
    first: u32,
    above: &[bool],
    cut: &[u32],
    triangles: &[[u32; 3]],
    kept: &mut Vec<[u32; 3]>,
) {
    let stays = triangle.map(|p| above[p as usize]);
    let count = stays.iter().filter(|s| **s).count();
    if count == 3 {
        kept.push(*triangle);
    }
    if count == 0 || count == 3 {
        return;
    }
    // Turned so that the corner that is alone on its side comes first.
    let alone = (0..3).find(|&k| stays[k] == (count == 1)).unwrap_or(0);
    let half_edge = |k: usize| first + ((alone + k) % 3) as u32;
    let [a, b, c] = [0, 1, 2].map(|k| ends(triangles, half_edge(k)).0);
    let (ab, ca) = (cut[half_edge(0) as usize], cut[half_edge(2) as usize]);
    if count == 1 {
        kept.push([a, ab, ca]);
    } else {
        kept.push([ab, b, c]);
        kept.push([ab, c, ca]);
    }
}

/// Pieces of surface smaller than this, square work units, are scraps that the contour left beside
/// the sheet, unless a part has no larger one.
const SCRAP: f64 = 15.0;

/// Drops scraps. `part` is the part of each point's source.
pub(crate) fn drop_scraps(surface: &mut Surface, part: &[u32]) {
    let mut pieces = DisjointSets::new(surface.points.len());
    for t in &surface.triangles {
        pieces.join(t[0] as usize, t[1] as usize);
        pieces.join(t[0] as usize, t[2] as usize);
    }
    let mut area = vec![0.0; surface.points.len()];
    for t in &surface.triangles {
        let [a, b, c] = t.map(|p| surface.points[p as usize]);
        area[pieces.find(t[0] as usize)] += 0.5 * length(cross(sub(b, a), sub(c, a)));
    }
    let part_of = |p: u32| part[surface.source[p as usize] as usize] as usize;
    let parts = part.iter().max().map_or(0, |p| *p as usize + 1);
    let mut largest = vec![0.0f64; parts];
    for t in &surface.triangles {
        let own = &mut largest[part_of(t[0])];
        *own = own.max(area[pieces.find(t[0] as usize)]);
    }
    let mut triangles = std::mem::take(&mut surface.triangles);
    triangles.retain(|t| {
        let own = area[pieces.find(t[0] as usize)];
        own >= SCRAP || own >= largest[part_of(t[0])]
    });
    surface.triangles = triangles;
}
