//! Stage 8, better triangles: edges are flipped, points stay where they are.
//!
//! A flip replaces the edge two triangles share by the other diagonal of their quadrilateral. It
//! is made where it brings the points' numbers of edges nearer to six (four on a boundary), or
//! leaves them and opens the smallest angle, and where the surface is flat enough not to change
//! shape.

use crate::error::{zeros, Result};
use crate::grid::{cross, dot, squared_distance, sub, unit, Vec3};
use crate::surface::halfedge::{ends, next, Edges, MOST_AROUND, NONE};

/// Passes over all edges; later passes find next to nothing.
const PASSES: usize = 6;
/// Least cosine between the normals before and after a flip.
const FLAT: f64 = 0.8;
/// No flip may leave an angle below this cosine's (25°), unless it was there before.
const SHARP: f64 = 0.906;

/// Number of edges at each point, and whether it lies on a boundary.
struct Valence {
    count: Vec<i32>,
    boundary: Vec<bool>,
}

/// Flips edges of a 2-manifold until the passes are done.
pub(crate) fn flip_edges(points: &[Vec3], triangles: &mut [[u32; 3]]) -> Result<()> {
    let mut twins = Edges::new(triangles, points.len())?.twins()?;
    let mut valence = Valence::new(triangles, &twins, points.len())?;
    for _ in 0..PASSES {
        let mut flipped = 0;
        for e in 0..twins.len() as u32 {
            if twins[e as usize] != NONE && e < twins[e as usize] {
                flipped += usize::from(try_flip(e, points, triangles, &mut twins, &mut valence));
            }
        }
        if flipped == 0 {
            break;
        }
    }
    Ok(())
}

impl Valence {
    fn new(triangles: &[[u32; 3]], twins: &[u32], points: usize) -> Result<Self> {
        let mut valence = Self {
            count: zeros(points)?,
            boundary: zeros(points)?,
        };
        for e in 0..twins.len() as u32 {
            let (a, b) = ends(triangles, e);
            let twin = twins[e as usize];
            if twin == NONE || e < twin {
                valence.count[a as usize] += 1;
                valence.count[b as usize] += 1;
            }
            if twin == NONE {
                valence.boundary[a as usize] = true;
                valence.boundary[b as usize] = true;
            }
        }
        Ok(valence)
    }

    /// Squared distance of a point's number of edges from the best one, after `change`.
    fn excess(&self, p: u32, change: i32) -> i32 {
        let best = if self.boundary[p as usize] { 4 } else { 6 };
        (self.count[p as usize] + change - best).pow(2)
    }
}

/// Flips the edge of half-edge e where that is better.
fn try_flip(
    e: u32,
    points: &[Vec3],
    triangles: &mut [[u32; 3]],
    twins: &mut [u32],
    valence: &mut Valence,
) -> bool {
    let f = twins[e as usize];
    let (a, b) = ends(triangles, e);
    let (c, d) = (
        ends(triangles, next(next(e))).0,
        ends(triangles, next(next(f))).0,
    );
    let before: i32 = [a, b, c, d].iter().map(|&p| valence.excess(p, 0)).sum();
    let after =
        valence.excess(a, -1) + valence.excess(b, -1) + valence.excess(c, 1) + valence.excess(d, 1);
    let least = |p: u32| if valence.boundary[p as usize] { 2 } else { 3 };
    let coincide = squared_distance(points[c as usize], points[d as usize]) == 0.0;
    if after > before
        || coincide
        || [a, b]
            .iter()
            .any(|&p| valence.count[p as usize] <= least(p))
    {
        return false;
    }
    let [a3, b3, c3, d3] = [a, b, c, d].map(|p| points[p as usize]);
    let old = sharpest(a3, b3, c3).max(sharpest(b3, a3, d3));
    let new = sharpest(c3, a3, d3).max(sharpest(d3, b3, c3));
    let opens = new < old - 1e-6;
    if !opens && (after == before || new > SHARP) {
        return false;
    }
    if !is_flat(a3, b3, c3, d3) || joined(c, d, next(next(e)), triangles, twins) {
        return false;
    }
    flip(e, f, triangles, twins);
    for (p, change) in [(a, -1), (b, -1), (c, 1), (d, 1)] {
        valence.count[p as usize] += change;
    }
    true
}

/// Cosine of a triangle's smallest angle.
fn sharpest(a: Vec3, b: Vec3, c: Vec3) -> f64 {
    let cosine = |p: Vec3, q: Vec3, r: Vec3| dot(unit(sub(q, p)), unit(sub(r, p)));
    cosine(a, b, c).max(cosine(b, c, a)).max(cosine(c, a, b))
}

/// Whether triangles abc, bad may become cad, dbc without a fold.
fn is_flat(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> bool {
    let normal = |p: Vec3, q: Vec3, r: Vec3| unit(cross(sub(q, p), sub(r, p)));
    let old = [normal(a, b, c), normal(b, a, d)];
    let new = [normal(c, a, d), normal(d, b, c)];
    dot(old[0], old[1]) > FLAT && old.iter().all(|o| new.iter().all(|n| dot(*o, *n) > FLAT))
}

/// Whether points c and d share an edge; `around` is a half-edge that leaves c.
fn joined(c: u32, d: u32, around: u32, triangles: &[[u32; 3]], twins: &[u32]) -> bool {
    let touches = |e: u32| {
        let (_, q) = ends(triangles, e);
        let opposite = ends(triangles, next(next(e))).0;
        q == d || opposite == d
    };
    let mut at = around;
    for _ in 0..MOST_AROUND {
        debug_assert_eq!(ends(triangles, at).0, c);
        if touches(at) {
            return true;
        }
        at = twins[next(next(at)) as usize];
        if at == around {
            return false;
        }
        if at == NONE {
            break;
        }
    }
    at = around;
    for _ in 0..MOST_AROUND {
        let twin = twins[at as usize];
        if twin == NONE {
            return false;
        }
        at = next(twin);
        if touches(at) {
            return true;
        }
    }
    true
}

/// Turns the shared edge ab of triangles abc and bad into cd.
fn flip(e: u32, f: u32, triangles: &mut [[u32; 3]], twins: &mut [u32]) {
    let (a, b) = ends(triangles, e);
    let (bc, ca) = (next(e), next(next(e)));
    let (ad, db) = (next(f), next(next(f)));
    let (c, d) = (ends(triangles, ca).0, ends(triangles, db).0);
    let outer = [bc, ca, ad, db].map(|h| twins[h as usize]);
    let (s, t) = (e / 3, f / 3);
    triangles[s as usize] = [c, a, d];
    triangles[t as usize] = [d, b, c];
    // Half-edges of s: ca, ad, dc; of t: db, bc, cd.
    let mut link = |h: u32, twin: u32| {
        twins[h as usize] = twin;
        if twin != NONE {
            twins[twin as usize] = h;
        }
    };
    link(3 * s, outer[1]);
    link(3 * s + 1, outer[2]);
    link(3 * t, outer[3]);
    link(3 * t + 1, outer[0]);
    link(3 * s + 2, 3 * t + 2);
}
