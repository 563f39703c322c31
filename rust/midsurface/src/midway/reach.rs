//! Surface → surface whose sheets meet: where a sheet ends before another one inside the label, it
//! is led on to it.
//!
//! In the corner where sheets meet a voxel's normal is that of neither, so that the contour ends a
//! voxel or two before the line where they do. Its rim there is told from a rim of the label by the
//! sheet fraction, which is ½ on that and about 1 within. Such a *blind* rim looks ahead along its
//! sheet, within the label: for a triangle across its way, or for where another blind rim would pass
//! across it, were it to go on straight. It is then led on to a smooth curve through such places
//! (`meeting.rs`). What runs on in the same sheet beyond is not looked for: a slit stays a slit, and so
//! does a tear, whose ways lead towards each other: their mean would lead out of the sheet, to the one
//! beside it.

use crate::buckets::Buckets;
use crate::contour::rim::BLIND;
use crate::error::{collected, filled, push, zeros, Result};
use crate::execution::Execution;
use crate::fields::label::Label;
use crate::grid::{along, cross, dot, length, sub, unit, Vec3};
use crate::midway::meeting;
use crate::surface::boundary::{away, beside};
use crate::surface::cells::{all_bounds, bounds, near, Cells};
use crate::surface::halfedge::Fans;
use crate::surface::manifold::Surface;

/// How far a blind rim looks ahead, work units.
const AHEAD: f64 = 6.0;
/// Sheets cross the way if their normal is at least this cosine off a right angle to it, and other
/// rims if their ways differ by more than this cosine's angle and are less than opposite.
const ACROSS: f64 = 0.35;
const OTHER_WAY: f64 = 0.75;
const OPPOSITE: f64 = -0.9;
/// Times that a rim's points and their ways ahead are averaged along the rim.
const POINT_ROUNDS: usize = 3;
pub(crate) const WAY_ROUNDS: usize = 12;
/// Up to so many points between blind ones are blind, too, where the sheet fraction is at least this.
const BETWEEN: usize = 3;
const NEARLY_WITHIN: f64 = 0.6;
/// Steps in which the way is tried for being in the label, work units.
const STEP: f64 = 0.5;
/// A rim that has less to go than this only moves, back by no more than that, work units.
const LEAST: f64 = 0.05;
const MOST_BACK: f64 = 0.15;
/// What is led on leans no more than this off the sheet.
const LEAN: f64 = 0.25;
/// Points handed to a worker at a time.
const PIECE: usize = 1024;
/// Passes over the points that [`reach`] makes, for its progress.
pub(crate) const PASSES: usize = 2;

/// A point of a blind rim.
pub(crate) struct Blind {
    pub point: u32,
    /// The points before and after it along the rim, where these are blind, too.
    pub beside: [Option<usize>; 2],
    /// Whether it lies on the border of the volume, for each axis.
    pub on_border: [bool; 3],
    /// Where it is once its rim is straightened a little, since that follows the grid.
    pub place: Vec3,
    /// Where it goes: a unit vector within its sheet.
    pub way: Vec3,
}

impl Blind {
    /// A place that is put onto the border of the volume where this point lies on that.
    pub fn on_same_border(&self, p: Vec3) -> Vec3 {
        std::array::from_fn(|a| {
            if self.on_border[a] {
                self.place[a]
            } else {
                p[a]
            }
        })
    }
}

/// Leads the blind rims of a surface on. `fraction` is the sheet fraction at its points, which have
/// their parts as sources.
pub(crate) fn reach(
    label: &Label,
    surface: &mut Surface,
    fraction: &[f64],
    fans: &Fans,
    execution: &mut Execution,
) -> Result<()> {
    let mut blind = blind_rims(label, surface, fraction, fans, execution)?;
    if blind.is_empty() {
        return execution.pass_done();
    }
    straighten(surface, &mut blind, fans)?;
    let seen = look_ahead(label, surface, &blind, fans, execution)?;
    let ends = meeting::ends(&blind, &seen)?;
    lead_on(surface, &blind, &ends)
}

/// The points of blind rims, in the order of their numbers. Where a blind rim meets the border of
/// the volume its last point lies on that; other points there are no rim's.
fn blind_rims(
    label: &Label,
    surface: &Surface,
    fraction: &[f64],
    fans: &Fans,
    execution: &mut Execution,
) -> Result<Vec<Blind>> {
    let triangles = &surface.triangles;
    let mut is_blind: Vec<bool> = zeros(surface.points.len())?;
    execution.fill(&mut is_blind, PIECE, |piece, out| {
        for (i, is_blind) in out.iter_mut().enumerate() {
            let p = PIECE * piece + i;
            *is_blind = fraction[p] >= BLIND && fans.is_boundary(triangles, p as u32);
        }
    })?;
    close_gaps(surface, fraction, fans, &mut is_blind)?;
    let border = |p: u32| label.on_border(surface.points[p as usize]);
    let is_inside = |p: u32| is_blind[p as usize] && !border(p).contains(&true);
    let is_of_rim = |&p: &u32| {
        let mut beside = beside(surface, fans, p).into_iter().flatten();
        is_inside(p) || beside.any(is_inside)
    };
    let all = 0..surface.points.len() as u32;
    let points = collected(all.filter(|&p| is_blind[p as usize]).filter(is_of_rim))?;
    let number = |p: u32| points.binary_search(&p).ok();
    let found = points.iter().map(|&point| {
        let is_joined = |other: &u32| is_inside(point) || is_inside(*other);
        let beside = beside(surface, fans, point).map(|p| number(p.filter(is_joined)?));
        Blind {
            point,
            beside,
            on_border: border(point),
            place: surface.points[point as usize],
            way: [0.0; 3],
        }
    });
    collected(found)
}

/// Makes a few points of a rim blind that lie between blind ones.
fn close_gaps(
    surface: &Surface,
    fraction: &[f64],
    fans: &Fans,
    is_blind: &mut [bool],
) -> Result<()> {
    let blind = collected((0..is_blind.len() as u32).filter(|&p| is_blind[p as usize]))?;
    for first in blind {
        let mut between = [first; BETWEEN];
        let mut at = first;
        for k in 0..=BETWEEN {
            let Some(after) = beside(surface, fans, at)[1] else {
                break;
            };
            if is_blind[after as usize] {
                for &p in &between[..k] {
                    is_blind[p as usize] = true;
                }
                break;
            }
            if k == BETWEEN || fraction[after as usize] < NEARLY_WITHIN {
                break;
            }
            between[k] = after;
            at = after;
        }
    }
    Ok(())
}

/// The mean over each point and those beside it; a rim's ends take the one that is there for both.
fn averaged<T: Copy>(blind: &[Blind], values: &[T], mean: impl Fn([T; 3]) -> T) -> Result<Vec<T>> {
    let of = |(own, &value): (&Blind, &T)| {
        let [before, after] = own.beside.map(|b| b.map(|b| values[b]));
        match before.or(after).zip(after.or(before)) {
            Some((before, after)) => mean([before, value, after]),
            None => value,
        }
    };
    collected(blind.iter().zip(values).map(of))
}

/// Finds where blind rims are once they are straight, and their ways ahead.
fn straighten(surface: &Surface, blind: &mut [Blind], fans: &Fans) -> Result<()> {
    let middle = |[a, b, c]: [Vec3; 3]| along(along(b.map(|v| 0.5 * v), 0.25, a), 0.25, c);
    let mut places = collected(blind.iter().map(|b| surface.points[b.point as usize]))?;
    let mut ways = collected(blind.iter().map(|b| outward(surface, fans, b)))?;
    for _ in 0..POINT_ROUNDS {
        let before = collected(places.iter().copied())?;
        places = averaged(blind, &places, middle)?;
        for ((own, place), before) in blind.iter().zip(&mut places).zip(before) {
            if own.beside.contains(&None) {
                *place = before;
            }
        }
    }
    for _ in 0..WAY_ROUNDS {
        ways = averaged(blind, &ways, |ways| unit(middle(ways)))?;
    }
    for ((own, place), way) in blind.iter_mut().zip(places).zip(ways) {
        own.place = place;
        own.way = unit(std::array::from_fn(|a| {
            if own.on_border[a] {
                0.0
            } else {
                way[a]
            }
        }));
    }
    Ok(())
}

/// The direction out of the surface at a point of its boundary: away from the two rings of points
/// behind it; none on the border of the volume.
fn outward(surface: &Surface, fans: &Fans, own: &Blind) -> Vec3 {
    if own.on_border.contains(&true) {
        return [0.0; 3];
    }
    let p = own.point;
    let way = away(surface, fans, p);
    let [before, after] = beside(surface, fans, p).map(|q| surface.points[q.unwrap_or(p) as usize]);
    let rim = unit(sub(after, before));
    unit(along(way, -dot(way, rim), rim))
}

/// How far ahead each point of the blind rims sees another sheet.
fn look_ahead(
    label: &Label,
    surface: &Surface,
    blind: &[Blind],
    fans: &Fans,
    execution: &mut Execution,
) -> Result<Vec<Option<f64>>> {
    let points = blind.iter().flat_map(|b| fans.of(b.point));
    let mut at_rims = collected(points.map(|e| e / 3))?;
    at_rims.sort_unstable();
    at_rims.dedup();
    let boxes = all_bounds(surface, &at_rims)?;
    let cells = Cells::around(&boxes, AHEAD, surface);
    let near = near(surface, &boxes, AHEAD)?;
    let sheets = Buckets::new(cells.count(), || {
        let of = |&t: &u32| cells.reached_by(bounds(surface, t)).map(move |c| (c, t));
        near.iter().flat_map(of)
    })?;
    let ribbons = Buckets::new(cells.count(), || {
        let of = |b: usize| {
            let reached = ribbon(blind, b).map(|r| cells.reached_by(enclosing(&r)));
            reached.into_iter().flatten().map(move |c| (c, b as u32))
        };
        (0..blind.len()).flat_map(of)
    })?;
    let mut seen = filled(None, blind.len())?;
    execution.fill(&mut seen, PIECE, |piece, out| {
        for (i, seen) in out.iter_mut().enumerate() {
            let own = &blind[PIECE * piece + i];
            let path = [own.place, along(own.place, AHEAD, own.way)];
            let mut nearest = f64::INFINITY;
            for cell in cells.reached_by(enclosing(&path)) {
                let sheets = sheets.of(cell as usize).iter();
                let sheets = sheets.filter_map(|&t| meets_triangle(surface, own, t));
                let rims = ribbons.of(cell as usize).iter();
                let rims = rims.filter_map(|&b| meets_rim(surface, blind, own, b as usize));
                nearest = sheets.chain(rims).fold(nearest, f64::min);
            }
            let is_free = nearest < AHEAD && stays_in_label(label, surface, own, nearest);
            *seen = is_free.then_some(nearest);
        }
    })?;
    Ok(seen)
}

/// The quadrilateral over which the rim from a blind point to the next would go on.
fn ribbon(blind: &[Blind], b: usize) -> Option<[Vec3; 4]> {
    let (own, after) = (&blind[b], &blind[blind[b].beside[1]?]);
    let ahead = |b: &Blind| along(b.place, AHEAD, b.way);
    Some([own.place, after.place, ahead(after), ahead(own)])
}

/// Lower and upper corner of what encloses some points.
fn enclosing(points: &[Vec3]) -> [Vec3; 2] {
    let fold = |with: fn(f64, f64) -> f64, start: f64| {
        let of = |k: usize| points.iter().map(|p| p[k]).fold(start, with);
        [of(0), of(1), of(2)]
    };
    [
        fold(f64::min, f64::INFINITY),
        fold(f64::max, f64::NEG_INFINITY),
    ]
}

/// How far ahead of a blind point a triangle of its part lies across its way.
fn meets_triangle(surface: &Surface, own: &Blind, t: u32) -> Option<f64> {
    let corners = surface.triangles[t as usize];
    let is_same = surface.source[corners[0] as usize] == surface.source[own.point as usize];
    if !is_same || corners.contains(&own.point) {
        return None;
    }
    meets(
        own.place,
        own.way,
        corners.map(|p| surface.points[p as usize]),
    )
}

/// How far ahead of a blind point another blind rim of its part would pass across its way.
fn meets_rim(surface: &Surface, blind: &[Blind], own: &Blind, other: usize) -> Option<f64> {
    let cosine = dot(own.way, blind[other].way);
    let is_own = [blind[other].point, blind[blind[other].beside[1]?].point].contains(&own.point);
    let part = |b: &Blind| surface.source[b.point as usize];
    if is_own || part(own) != part(&blind[other]) || !(OPPOSITE..OTHER_WAY).contains(&cosine) {
        return None;
    }
    let [a, b, c, d] = ribbon(blind, other)?;
    let halves = [[a, b, c], [a, c, d]];
    halves
        .into_iter()
        .find_map(|half| meets(own.place, own.way, half))
}

/// How far from a point a way meets a triangle across it.
fn meets(from: Vec3, way: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f64> {
    let normal = cross(sub(b, a), sub(c, a));
    let approach = dot(normal, way);
    if approach.abs() < ACROSS * length(normal) {
        return None;
    }
    let far = dot(normal, sub(a, from)) / approach;
    let place = along(from, far, way);
    let inside = |p: Vec3, q: Vec3| dot(cross(sub(q, p), sub(place, p)), normal) >= 0.0;
    let is_met = (0.0..AHEAD).contains(&far) && inside(a, b) && inside(b, c) && inside(c, a);
    is_met.then_some(far)
}

/// Whether the way ahead of a blind point is within its part as far as this.
fn stays_in_label(label: &Label, surface: &Surface, own: &Blind, far: f64) -> bool {
    let distance = label.distance(surface.source[own.point as usize]);
    let steps = (far / STEP).ceil() as usize;
    (1..=steps).all(|step| {
        let at = (STEP * step as f64).min(far);
        let there = along(own.place, at, own.way);
        label.within_volume(there) && distance.linear(there) > 0.0
    })
}

/// The normal of its sheet at a point of a blind rim.
fn across(blind: &[Blind], b: usize) -> Vec3 {
    let own = &blind[b];
    let [before, after] = own.beside.map(|beside| blind[beside.unwrap_or(b)].place);
    unit(cross(own.way, sub(after, before)))
}

/// Adds a strip of triangles to the blind rims, up to where each point ends.
fn lead_on(surface: &mut Surface, blind: &[Blind], ends: &[Option<Vec3>]) -> Result<()> {
    let mut moved = collected(blind.iter().map(|b| b.point))?;
    for (b, (end, moved)) in ends.iter().zip(&mut moved).enumerate() {
        let Some(end) = *end else { continue };
        let own = &blind[b];
        let step = sub(end, own.place);
        let ahead = dot(step, own.way);
        if ahead < LEAST {
            let place = along(own.place, ahead.max(-MOST_BACK), own.way);
            surface.points[own.point as usize] = place;
            continue;
        }
        *moved = surface.points.len() as u32;
        surface.points[own.point as usize] = own.place;
        let normal = across(blind, b);
        let (lift, most) = (dot(step, normal), LEAN * ahead);
        let leaning = along(end, lift.clamp(-most, most) - lift, normal);
        push(&mut surface.points, own.on_same_border(leaning))?;
        let source = surface.source[own.point as usize];
        push(&mut surface.source, source)?;
    }
    for (b, own) in blind.iter().enumerate() {
        let Some(after) = own.beside[1] else { continue };
        let [p, q] = [own.point, blind[after].point];
        let strip = [[q, p, moved[b]], [q, moved[b], moved[after]]];
        for triangle in strip {
            let [x, y, z] = triangle;
            if x != y && y != z && z != x {
                push(&mut surface.triangles, triangle)?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACROSS_X: [Vec3; 3] = [[2.0, -1.0, -1.0], [2.0, 2.0, -1.0], [2.0, -1.0, 2.0]];

    #[test]
    fn what_lies_across_the_way_is_met() {
        assert_eq!(meets([0.0; 3], [1.0, 0.0, 0.0], ACROSS_X), Some(2.0));
    }

    #[test]
    fn what_lies_behind_beside_or_too_far_is_not_met() {
        assert_eq!(meets([0.0; 3], [-1.0, 0.0, 0.0], ACROSS_X), None);
        assert_eq!(meets([0.0, 2.0, 2.0], [1.0, 0.0, 0.0], ACROSS_X), None);
        assert_eq!(
            meets([1.9 - AHEAD, 0.0, 0.0], [1.0, 0.0, 0.0], ACROSS_X),
            None
        );
    }

    #[test]
    fn what_is_nearly_along_the_way_is_not_met() {
        let along_it = [[0.0, 0.3, -1.0], [4.0, -0.3, -1.0], [2.0, 0.0, 2.0]];
        assert_eq!(meets([0.0; 3], [1.0, 0.0, 0.0], along_it), None);
    }
}
