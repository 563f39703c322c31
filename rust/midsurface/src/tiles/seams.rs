//! What tiles agree on across the seams between them.
//!
//! A tile has patches of surface, and on each seam edge one triangle, of which the other one is another
//! tile's. An edge is told by its points, exact to the bit. All tiles together must have two triangles
//! on every seam edge, in two tiles: where that fails something was cut differently on both sides, and
//! the tiles do not make up a surface. Patches that are joined by seams are then wound the same way,
//! by disjoint sets that know their parity, and so that their normals point away from the middle of
//! all of them together. Where that is impossible (a Möbius band) neighbours go on disagreeing.
//!
//! Every process tells all others what there is along its tiles' seams, which is little, and decides by
//! itself, as all others do.

use std::cmp::Ordering;

use crate::error::{collected, extend, filled, push, Error, Result};
use crate::execution::Execution;
use crate::grid::{along, cross, dot, length, sub, Vec3};
use crate::hash::mixed;
use crate::processes::exchange::Team;
use crate::surface::halfedge::{ends, twins, NONE};
use crate::surface::manifold::Surface;

/// Numbers that sums, half an edge on a seam and a moved point are sent as.
const SUMS_LENGTH: usize = 8;
const SEAM_LENGTH: usize = 3;
const MOVE_LENGTH: usize = 8;

/// The patches of surface of one tile.
#[derive(Default)]
pub(crate) struct Patches {
    /// Of each own triangle its patch, and whether it is turned to be wound as the patch's first.
    pub of_triangle: Vec<(u32, bool)>,
    /// The points that triangles of other tiles use, too.
    pub shared: Vec<Point>,
    told: Told,
}

/// What a tile tells of its patches: what each adds up to, and the seams.
#[derive(Default)]
struct Told {
    sums: Vec<Sums>,
    seams: Vec<Seam>,
}

/// A point of a part of the component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub part: u32,
    pub place: Vec3,
}

impl Point {
    pub fn of(surface: &Surface, p: usize) -> Self {
        Self {
            part: surface.source[p],
            place: surface.points[p],
        }
    }

    /// Orders points by part and place, to the bit.
    pub fn order(&self, other: &Self) -> Ordering {
        let by_part = self.part.cmp(&other.part);
        by_part.then_with(|| along_axes(&self.place, &other.place))
    }
}

/// Orders places along x, then y, then z.
pub(crate) fn along_axes(a: &Vec3, b: &Vec3) -> Ordering {
    let along = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    along.fold(Ordering::Equal, Ordering::then)
}

/// Half an edge on a seam.
struct Seam {
    /// The number that both halves of the edge have in common.
    edge: u64,
    patch: u32,
    /// Whether the patch's triangle has the end first that comes first in order.
    is_forward: bool,
}

/// Sums over triangles: areas, centres times areas, vectors of area, and these times the centres.
#[derive(Clone, Copy, Default)]
struct Sums {
    area: f64,
    centre: Vec3,
    normal: Vec3,
    outward: f64,
}

impl Sums {
    fn add(&mut self, other: &Self, sign: f64) {
        self.area += other.area;
        self.centre = along(self.centre, 1.0, other.centre);
        self.normal = along(self.normal, sign, other.normal);
        self.outward += sign * other.outward;
    }

    fn of([a, b, c]: [Vec3; 3]) -> Self {
        let normal = cross(sub(b, a), sub(c, a));
        let centre: Vec3 = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
        let area = length(normal);
        Self {
            area,
            centre: centre.map(|v| area * v),
            normal,
            outward: dot(normal, centre),
        }
    }

    fn pack(&self) -> [i64; SUMS_LENGTH] {
        let ([x, y, z], [u, v, w]) = (self.centre, self.normal);
        let values = [self.area, x, y, z, u, v, w, self.outward];
        values.map(|v| v.to_bits() as i64)
    }

    fn unpack(numbers: &[i64]) -> Self {
        let value = |i: usize| f64::from_bits(numbers[i] as u64);
        Self {
            area: value(0),
            centre: [1, 2, 3].map(value),
            normal: [4, 5, 6].map(value),
            outward: value(7),
        }
    }

    /// Whether the normals point to the middle.
    fn is_inward(&self) -> bool {
        let middle = self.centre.map(|v| v / self.area.max(f64::MIN_POSITIVE));
        self.outward - dot(self.normal, middle) < 0.0
    }
}

impl Patches {
    /// The patches of those triangles of a surface that are the tile's own.
    pub fn new(surface: &Surface, is_own: &[bool], execution: &mut Execution) -> Result<Self> {
        let triangles = &surface.triangles;
        let twins = twins(triangles, surface.points.len(), execution)?;
        let mut found: Vec<Option<(u32, bool)>> = collected(triangles.iter().map(|_| None))?;
        let mut patches = Self::default();
        let mut stack = Vec::new();
        for seed in (0..triangles.len()).filter(|&t| is_own[t]) {
            if found[seed].is_some() {
                continue;
            }
            let patch = patches.told.sums.len() as u32;
            push(&mut patches.told.sums, Sums::default())?;
            found[seed] = Some((patch, false));
            push(&mut stack, seed)?;
            while let Some(t) = stack.pop() {
                let turned = found[t].is_some_and(|own| own.1);
                let sign = if turned { -1.0 } else { 1.0 };
                let corners = triangles[t].map(|p| surface.points[p as usize]);
                patches.told.sums[patch as usize].add(&Sums::of(corners), sign);
                for e in 3 * t as u32..3 * t as u32 + 3 {
                    let twin = twins[e as usize];
                    if twin == NONE {
                        continue;
                    }
                    let other = twin as usize / 3;
                    if !is_own[other] {
                        push(
                            &mut patches.told.seams,
                            Seam::new(surface, e, (patch, turned)),
                        )?;
                    } else if found[other].is_none() {
                        let agree = ends(triangles, e).0 != ends(triangles, twin).0;
                        found[other] = Some((patch, turned ^ !agree));
                        push(&mut stack, other)?;
                    }
                }
            }
        }
        patches.of_triangle = collected(found.into_iter().flatten())?;
        let own = used_by(surface, |t| is_own[t])?;
        let others = used_by(surface, |t| !is_own[t])?;
        let both = (0..surface.points.len()).filter(|&p| own[p] && others[p]);
        patches.shared = collected(both.map(|p| Point::of(surface, p)))?;
        Ok(patches)
    }
}

/// Whether each point is used by one of these triangles.
pub(crate) fn used_by(surface: &Surface, is_one: impl Fn(usize) -> bool) -> Result<Vec<bool>> {
    let mut is_used = filled(false, surface.points.len())?;
    for (_, triangle) in surface
        .triangles
        .iter()
        .enumerate()
        .filter(|(t, _)| is_one(*t))
    {
        triangle.iter().for_each(|&p| is_used[p as usize] = true);
    }
    Ok(is_used)
}

impl Seam {
    fn new(surface: &Surface, e: u32, (patch, turned): (u32, bool)) -> Self {
        let (a, b) = ends(&surface.triangles, e);
        let [a, b] = [a, b].map(|p| Point::of(surface, p as usize));
        let in_order = a.order(&b) == Ordering::Less;
        let (first, last) = if in_order { (a, b) } else { (b, a) };
        let places = first.place.into_iter().chain(last.place);
        Self {
            edge: mixed(places.map(f64::to_bits).chain([a.part.into()])),
            patch,
            is_forward: in_order ^ turned,
        }
    }
}

/// Disjoint sets of things each of which is, or is not, the other way round than the one that stands
/// for its set.
struct ParitySets(Vec<(u32, bool)>);

impl ParitySets {
    /// The one that stands for a set, and whether `i` is the other way round.
    fn find(&mut self, mut i: usize) -> (usize, bool) {
        let mut turned = false;
        while self.0[i].0 as usize != i {
            let (parent, own) = self.0[i];
            let (above, of_parent) = self.0[parent as usize];
            // Halves the way up for whoever comes next.
            if above != parent {
                self.0[i] = (above, own ^ of_parent);
            }
            turned ^= self.0[i].1;
            i = self.0[i].0 as usize;
        }
        (i, turned)
    }

    /// Joins the sets of two things of which one is `turned` as the other is not; what was joined
    /// before stays as it is.
    fn join(&mut self, a: usize, b: usize, turned: bool) {
        let ((a, from_a), (b, from_b)) = (self.find(a), self.find(b));
        if a != b {
            self.0[a.max(b)] = (a.min(b) as u32, turned ^ from_a ^ from_b);
        }
    }
}

/// Points that move, and where to, in order.
pub(crate) struct Moves(Vec<(Point, Vec3)>);

impl Moves {
    /// Where a point goes, if it does.
    pub fn of(&self, point: Point) -> Option<Vec3> {
        let found = self.0.binary_search_by(|(from, _)| from.order(&point));
        found.ok().map(|at| self.0[at].1)
    }
}

/// Lets all tiles move the points that they share to the same places: to where the first of the tiles that
/// share a point, `own` ones with their numbers, would move it.
pub(crate) fn moved_alike(own: &[(usize, Vec<(Point, Vec3)>)], team: &mut Team) -> Result<Moves> {
    let mut message = Vec::new();
    for (tile, moves) in own {
        for (point, to) in moves {
            let ([x, y, z], [u, v, w]) = (point.place, *to);
            extend(&mut message, [*tile as i64, point.part.into()])?;
            extend(&mut message, [x, y, z, u, v, w].map(|v| v.to_bits() as i64))?;
        }
    }
    let mut all = Vec::new();
    for message in team.share(&message)? {
        for numbers in message.chunks_exact(MOVE_LENGTH) {
            let value = |i: usize| f64::from_bits(numbers[i] as u64);
            let point = Point {
                part: numbers[1] as u32,
                place: [2, 3, 4].map(value),
            };
            push(&mut all, (point, numbers[0], [5, 6, 7].map(value)))?;
        }
    }
    all.sort_unstable_by(|a, b| a.0.order(&b.0).then(a.1.cmp(&b.1)));
    all.dedup_by(|b, a| a.0 == b.0);
    collected(all.into_iter().map(|(point, _, to)| (point, to))).map(Moves)
}

/// What all tiles agree on.
pub(crate) struct Agreement {
    /// Of each own tile whether each patch is to be turned.
    pub turns: Vec<Vec<bool>>,
    /// Whether all seams are wound the same way on both sides, as they came.
    pub is_wound: bool,
}

/// Lets all tiles agree, given the numbers of the own ones and their patches; `None` where they do not
/// make up a surface.
pub(crate) fn agree(
    own: &[usize],
    patches: &[Patches],
    team: &mut Team,
) -> Result<Option<Agreement>> {
    let all = told_by_all(own, patches, team)?;
    let mut seams: Vec<(u64, usize, usize, bool)> = Vec::new();
    let mut first = Vec::new();
    let mut count = 0;
    for (tile, told) in &all {
        push(&mut first, (*tile, count))?;
        for seam in &told.seams {
            let patch = count + seam.patch as usize;
            push(&mut seams, (seam.edge, *tile, patch, seam.is_forward))?;
        }
        count += told.sums.len();
    }
    seams.sort_unstable();
    let mut sets = ParitySets(collected((0..count as u32).map(|i| (i, false)))?);
    let mut is_wound = true;
    for halves in seams.chunk_by(|a, b| a.0 == b.0) {
        let &[a, b] = halves else {
            return Ok(None);
        };
        if a.1 == b.1 {
            return Ok(None);
        }
        is_wound &= a.3 != b.3;
        sets.join(a.2, b.2, a.3 == b.3);
    }
    let mut sums: Vec<Sums> = collected((0..count).map(|_| Sums::default()))?;
    for (patch, own) in all.iter().flat_map(|(_, told)| &told.sums).enumerate() {
        let (root, turned) = sets.find(patch);
        sums[root].add(own, if turned { -1.0 } else { 1.0 });
    }
    let mut turns = Vec::new();
    for (tile, patches) in own.iter().zip(patches) {
        let at = first.partition_point(|(other, _)| other < tile);
        let turn = |patch: usize| {
            let (root, turned) = sets.find(first[at].1 + patch);
            turned ^ sums[root].is_inward()
        };
        push(
            &mut turns,
            collected((0..patches.told.sums.len()).map(turn))?,
        )?;
    }
    Ok(Some(Agreement { turns, is_wound }))
}

/// What all tiles tell, in the order of their numbers, which does not depend on who has which.
fn told_by_all(own: &[usize], patches: &[Patches], team: &mut Team) -> Result<Vec<(usize, Told)>> {
    let mut message = Vec::new();
    for (tile, Patches { told, .. }) in own.iter().zip(patches) {
        let head = [*tile, told.sums.len(), told.seams.len()];
        extend(&mut message, head.map(|n| n as i64))?;
        extend(&mut message, told.sums.iter().flat_map(Sums::pack))?;
        let seams = told.seams.iter();
        let seams = seams.flat_map(|s| [s.edge as i64, s.patch.into(), i64::from(s.is_forward)]);
        extend(&mut message, seams)?;
    }
    let mut all = Vec::new();
    for message in team.share(&message)? {
        let mut left = &message[..];
        while let Some((&[tile, sums, seams], rest)) = left.split_first_chunk::<3>() {
            let (sums, rest) = rest
                .split_at_checked(SUMS_LENGTH * sums as usize)
                .ok_or(Error::Pieces)?;
            let (seams, rest) = rest
                .split_at_checked(SEAM_LENGTH * seams as usize)
                .ok_or(Error::Pieces)?;
            let seams = seams.chunks_exact(SEAM_LENGTH).map(|s| Seam {
                edge: s[0] as u64,
                patch: s[1] as u32,
                is_forward: s[2] != 0,
            });
            let told = Told {
                sums: collected(sums.chunks_exact(SUMS_LENGTH).map(Sums::unpack))?,
                seams: collected(seams)?,
            };
            push(&mut all, (tile as usize, told))?;
            left = rest;
        }
    }
    all.sort_unstable_by_key(|(tile, _)| *tile);
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Quiet;
    use crate::processes::exchange::Alone;

    /// A square of two triangles that are wound as told, and what a tile knows that has one of them.
    fn half(own: usize, turned: [bool; 2]) -> Patches {
        let mut surface = Surface {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            source: vec![0; 4],
        };
        for (triangle, turned) in surface.triangles.iter_mut().zip(turned) {
            if turned {
                triangle.swap(1, 2);
            }
        }
        let is_own = [own == 0, own == 1];
        let mut quiet = Quiet::default();
        let mut execution = Execution::new(1, &mut quiet).unwrap();
        Patches::new(&surface, &is_own, &mut execution).unwrap()
    }

    fn agreed(tiles: &[usize], patches: &[Patches]) -> Option<Agreement> {
        let mut alone = Alone;
        let team = &mut Team::new(&mut alone);
        agree(tiles, patches, team).unwrap()
    }

    #[test]
    fn tiles_wind_their_patches_alike() {
        let found = agreed(&[0, 1], &[half(0, [false; 2]), half(1, [false; 2])]).unwrap();
        assert!(found.is_wound);
        assert_eq!(found.turns[0], found.turns[1]);
        let turned = [false, true];
        let found = agreed(&[0, 1], &[half(0, turned), half(1, turned)]).unwrap();
        assert!(!found.is_wound);
        assert_ne!(found.turns[0], found.turns[1]);
    }

    #[test]
    fn a_seam_that_another_tile_does_not_know_is_told() {
        assert!(agreed(&[0], &[half(0, [false; 2])]).is_none());
        assert!(agreed(&[3, 3], &[half(0, [false; 2]), half(1, [false; 2])]).is_none());
    }
}
