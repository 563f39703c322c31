//! Stage 7, triangles → 2-manifold: wound the same way, without pinches.
//!
//! The zipper gives every edge one or two triangles. What is left is to turn the triangles, and
//! to cut where that is impossible (a Möbius band) or where sheets touch in a point only. A cut
//! gives the points on it copies, each moved a little into its own sheet, so that no two points
//! coincide.

use crate::error::{collected, filled, push, zeros, Result};
use crate::execution::Execution;
use crate::grid::{along, sub, Vec3};
use crate::surface::halfedge::{
    self, ends, next, previous, triangles_at, twins, Fans, MOST_AROUND, NONE,
};

/// Half-edges or points handed to a worker at a time.
const PIECE: usize = 4096;
/// Passes that [`make_manifold`] makes, for its progress.
pub(crate) const PASSES: usize = halfedge::TWIN_PASSES + 2;

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
    /// A copy.
    pub fn copied(&self) -> Result<Self> {
        Ok(Self {
            points: collected(self.points.iter().copied())?,
            triangles: collected(self.triangles.iter().copied())?,
            source: collected(self.source.iter().copied())?,
        })
    }

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
pub(crate) fn make_manifold(surface: &mut Surface, execution: &mut Execution) -> Result<()> {
    let mut twins = twins(&surface.triangles, surface.points.len(), execution)?;
    orient(&mut surface.triangles, &mut twins, execution)?;
    split_points(surface, &twins, execution)
}

/// Makes a manifold of triangles that are wound as they are to stay: neighbours that disagree are cut
/// apart.
pub(crate) fn make_manifold_as_wound(
    surface: &mut Surface,
    execution: &mut Execution,
) -> Result<()> {
    let triangles = &surface.triangles;
    let mut twins = twins(triangles, surface.points.len(), execution)?;
    for e in 0..twins.len() {
        let twin = twins[e];
        if twin != NONE && ends(triangles, e as u32).0 == ends(triangles, twin).0 {
            (twins[e], twins[twin as usize]) = (NONE, NONE);
        }
    }
    split_points(surface, &twins, execution)
}

/// Winds the triangles of each connected piece like its first one; where two neighbours still
/// disagree, their edge is cut. The half-edges of a turned triangle change places.
fn orient(
    triangles: &mut [[u32; 3]],
    twins: &mut Vec<u32>,
    execution: &mut Execution,
) -> Result<()> {
    let turned = like_the_first(triangles, twins)?;
    // Corner order (0, 1, 2) becomes (0, 2, 1): edges 01, 12, 20 become 02, 21, 10.
    let moved = |e: u32| {
        if turned[e as usize / 3] == Some(true) {
            3 * (e / 3) + 2 - e % 3
        } else {
            e
        }
    };
    let mut moved_twins: Vec<u32> = zeros(twins.len())?;
    execution.fill(&mut moved_twins, PIECE, |piece, out| {
        for (i, twin) in out.iter_mut().enumerate() {
            *twin = match twins[moved((piece * PIECE + i) as u32) as usize] {
                NONE => NONE,
                twin => moved(twin),
            };
        }
    })?;
    *twins = moved_twins;
    for (triangle, turned) in triangles.iter_mut().zip(&turned) {
        if *turned == Some(true) {
            triangle.swap(1, 2);
        }
    }
    Ok(())
}

/// Whether each triangle has to be turned to be wound like the first one of its piece, all of them known;
/// cuts the edges of those that disagree.
fn like_the_first(triangles: &[[u32; 3]], twins: &mut [u32]) -> Result<Vec<Option<bool>>> {
    let mut turned = filled(None, triangles.len())?;
    let mut stack = Vec::new();
    for seed in 0..triangles.len() {
        if turned[seed].is_none() {
            turned[seed] = Some(false);
            push(&mut stack, seed)?;
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
                        push(&mut stack, other)?;
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
    Ok(turned)
}

/// Gives each fan of triangles around a point a point of its own.
fn split_points(surface: &mut Surface, twins: &[u32], execution: &mut Execution) -> Result<()> {
    let back = |at: u32| twins[previous(at) as usize];
    let ahead = |at: u32| match twins[at as usize] {
        NONE => NONE,
        twin => next(twin),
    };
    // Each point's number of corners, and one of them.
    let mut corners: Vec<(u32, u32)> = zeros(surface.points.len())?;
    for (corner, &p) in surface.triangles.as_flattened().iter().enumerate() {
        let known = &mut corners[p as usize];
        *known = (known.0 + 1, corner as u32);
    }
    let mut pinched: Vec<bool> = zeros(corners.len())?;
    execution.fill(&mut pinched, PIECE, |piece, out| {
        for (pinched, &(count, corner)) in out.iter_mut().zip(&corners[piece * PIECE..]) {
            let mut joined = 0;
            if count > 0 {
                for_each_in_fan(corner, back, ahead, |_| joined += 1);
            }
            *pinched = joined < count;
        }
    })?;
    if pinched.contains(&true) {
        let around = triangles_at(&surface.triangles, &pinched)?;
        let corners = Fans::of_points(&surface.triangles, &around, &pinched)?;
        let fans = fans_to_part(&corners, &pinched, |_| (back, ahead))?;
        part(surface, fans)?;
    }
    Ok(())
}

/// Gives each fan of triangles around a point a point of its own, where all are wound the same way
/// and only the points `among` can be pinched.
pub(crate) fn split_points_among(surface: &mut Surface, among: &[bool]) -> Result<()> {
    let triangles = &surface.triangles;
    let around = triangles_at(triangles, among)?;
    let corners = Fans::of_points(triangles, &around, among)?;
    let end = |e: u32| ends(triangles, e).1;
    let start_before = |e: u32| ends(triangles, previous(e)).0;
    let fans = fans_to_part(&corners, among, |around: &[u32]| {
        let find = move |is: &dyn Fn(u32) -> bool| {
            let found = around.iter().copied().find(|&e| is(e));
            found.unwrap_or(NONE)
        };
        (
            move |at: u32| find(&|e| end(e) == start_before(at)),
            move |at: u32| find(&|e| start_before(e) == end(at)),
        )
    })?;
    part(surface, fans)
}

/// The fans that share a point with another that comes before, by their first corners: those around
/// the points `among`. `steps` tells, given the corners of a point, how to get from one to the
/// next that shares an edge with it, back and ahead.
fn fans_to_part<'a, B: Fn(u32) -> u32, A: Fn(u32) -> u32>(
    corners: &'a Fans,
    among: &[bool],
    steps: impl Fn(&'a [u32]) -> (B, A),
) -> Result<Vec<Vec<u32>>> {
    let mut fans = Vec::new();
    for p in (0..among.len() as u32).filter(|&p| among[p as usize]) {
        let corners = corners.of(p);
        let (back, ahead) = steps(corners);
        let mut seen = vec![false; corners.len()];
        for (i, &corner) in corners.iter().enumerate() {
            if seen[i] {
                continue;
            }
            let mut fan = Vec::new();
            for_each_in_fan(corner, &back, &ahead, |c| fan.push(c));
            for c in &fan {
                seen[corners.partition_point(|other| other < c)] = true;
            }
            if i > 0 {
                push(&mut fans, fan)?;
            }
        }
    }
    fans.sort_unstable_by_key(|fan| fan[0]);
    Ok(fans)
}

/// Gives each of these fans a point of its own.
fn part(surface: &mut Surface, fans: Vec<Vec<u32>>) -> Result<()> {
    for fan in fans {
        let p = ends(&surface.triangles, fan[0]).0 as usize;
        let copy = surface.points.len() as u32;
        let place = moved_into(surface, p, &fan);
        push(&mut surface.points, place)?;
        let source = surface.source[p];
        push(&mut surface.source, source)?;
        for &c in &fan {
            surface.triangles[c as usize / 3][c as usize % 3] = copy;
        }
    }
    Ok(())
}

/// Visits the corners around the point at `corner` that are joined through shared edges, given the
/// steps from one to the next; [`NONE`] is a boundary.
fn for_each_in_fan(
    corner: u32,
    back: impl Fn(u32) -> u32,
    ahead: impl Fn(u32) -> u32,
    mut visit: impl FnMut(u32),
) {
    visit(corner);
    let mut at = corner;
    // Leave through the edge that enters the point, until a boundary or the start.
    for _ in 0..MOST_AROUND {
        at = back(at);
        if at == NONE || at == corner {
            break;
        }
        visit(at);
    }
    if at == NONE {
        at = corner;
        for _ in 0..MOST_AROUND {
            at = ahead(at);
            if at == NONE {
                break;
            }
            visit(at);
        }
    }
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
