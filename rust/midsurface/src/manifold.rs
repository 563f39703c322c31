//! Stage 7, triangles → 2-manifold: wound the same way, without pinches.
//!
//! The zipper gives every edge one or two triangles. What is left is to turn the triangles, and
//! to cut where that is impossible (a Möbius band) or where sheets touch in a point only. A cut
//! gives the points on it copies, each moved a little into its own sheet, so that no two points
//! coincide.

use crate::error::{zeros, Result};
use crate::grid::{along, sub, Vec3};
use crate::halfedge::{ends, next, previous, Edges, MOST_AROUND, NONE};

/// How far a copy of a point moves towards its own triangles.
const APART: f64 = 0.01;

/// A triangle list under repair. `source` is what each point stems from, which its copies inherit:
/// a point of a line, or a part.
#[derive(Default)]
pub(crate) struct Surface {
    pub points: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    pub source: Vec<u32>,
}

impl Surface {
    /// The surface without points that no triangle uses.
    pub fn compact(mut self) -> Result<Self> {
        let mut number: Vec<u32> = zeros(self.points.len())?;
        let mut used = 0;
        for p in self.triangles.iter_mut().flatten() {
            let own = &mut number[*p as usize];
            if *own == 0 {
                used += 1;
                *own = used;
            }
            *p = *own - 1;
        }
        let mut points = zeros(used as usize)?;
        let mut source = zeros(used as usize)?;
        for (p, own) in number.iter().enumerate().filter(|(_, own)| **own > 0) {
            points[*own as usize - 1] = self.points[p];
            source[*own as usize - 1] = self.source[p];
        }
        (self.points, self.source) = (points, source);
        Ok(self)
    }
}

/// Turns triangles of `surface` so that neighbours agree, cuts where they cannot, and splits
/// pinched points.
pub(crate) fn make_manifold(surface: &mut Surface) {
    let mut twins = Edges::new(&surface.triangles, surface.points.len()).twins();
    orient(&mut surface.triangles, &mut twins);
    split_points(surface, &twins);
}

/// Winds the triangles of each connected piece like its first one; where two neighbours still
/// disagree, their edge is cut. The half-edges of a turned triangle change places.
fn orient(triangles: &mut [[u32; 3]], twins: &mut Vec<u32>) {
    let mut turned = vec![None; triangles.len()];
    let mut stack = Vec::new();
    for seed in 0..triangles.len() {
        if turned[seed].is_none() {
            turned[seed] = Some(false);
            stack.push(seed);
        }
        while let Some(t) = stack.pop() {
            let own = turned[t] == Some(true);
            for e in 3 * t as u32..3 * t as u32 + 3 {
                let twin = twins[e as usize];
                if twin == NONE {
                    continue;
                }
                let agree = ends(triangles, e).0 != ends(triangles, twin).0;
                let other = twin as usize / 3;
                let expected = own ^ !agree;
                match turned[other] {
                    None => {
                        turned[other] = Some(expected);
                        stack.push(other);
                    }
                    Some(is) if is != expected => {
                        twins[e as usize] = NONE;
                        twins[twin as usize] = NONE;
                    }
                    Some(_) => {}
                }
            }
        }
    }
    // Corner order (0, 1, 2) becomes (0, 2, 1): edges 01, 12, 20 become 02, 21, 10.
    let moved = |e: u32| {
        if turned[e as usize / 3] == Some(true) {
            3 * (e / 3) + 2 - e % 3
        } else {
            e
        }
    };
    let mut new_twins = vec![NONE; twins.len()];
    for e in 0..twins.len() as u32 {
        if twins[e as usize] != NONE {
            new_twins[moved(e) as usize] = moved(twins[e as usize]);
        }
    }
    *twins = new_twins;
    for (triangle, turned) in triangles.iter_mut().zip(&turned) {
        if *turned == Some(true) {
            triangle.swap(1, 2);
        }
    }
}

/// Gives each fan of triangles around a point a point of its own.
fn split_points(surface: &mut Surface, twins: &[u32]) {
    let corners = surface.triangles.len() * 3;
    let mut fan_of_corner = vec![false; corners];
    let mut claimed = vec![false; surface.points.len()];
    for corner in 0..corners as u32 {
        if fan_of_corner[corner as usize] {
            continue;
        }
        let fan = fan(corner, twins);
        for &c in &fan {
            fan_of_corner[c as usize] = true;
        }
        let p = ends(&surface.triangles, corner).0 as usize;
        if !std::mem::replace(&mut claimed[p], true) {
            continue;
        }
        let copy = surface.points.len() as u32;
        let place = moved_into(surface, p, &fan);
        surface.points.push(place);
        surface.source.push(surface.source[p]);
        for &c in &fan {
            surface.triangles[c as usize / 3][c as usize % 3] = copy;
        }
    }
}

/// The corners around the point at `corner` that are joined through shared edges.
fn fan(corner: u32, twins: &[u32]) -> Vec<u32> {
    let mut fan = vec![corner];
    let mut at = corner;
    // Leave through the edge that enters the point, until a boundary or the start.
    for _ in 0..MOST_AROUND {
        at = twins[previous(at) as usize];
        if at == NONE || at == corner {
            break;
        }
        fan.push(at);
    }
    if at == NONE {
        at = corner;
        for _ in 0..MOST_AROUND {
            let twin = twins[at as usize];
            if twin == NONE {
                break;
            }
            at = next(twin);
            fan.push(at);
        }
    }
    fan
}

/// The place of point p's copy for `fan`: a little towards the middle of the fan's triangles.
fn moved_into(surface: &Surface, p: usize, fan: &[u32]) -> Vec3 {
    let from = surface.points[p];
    let mut shift = [0.0; 3];
    for &c in fan {
        for &q in &surface.triangles[c as usize / 3] {
            let d = sub(surface.points[q as usize], from);
            shift = along(shift, APART / fan.len() as f64, d);
        }
    }
    along(from, 1.0, shift)
}
