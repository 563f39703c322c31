//! A piece of the surface under work: points and triangles numbered from 0, half-edges as arrays.
//!
//! Half-edge 3 t + k goes from corner k of triangle t to the next corner. Points that triangles of
//! other blocks use too are frozen: they neither move nor go, and no decision may rest on their
//! neighbours, which are not all here. A half-edge without a twin is a boundary of the surface
//! wherever one of its ends is not frozen.

use super::reference::Reference;
use crate::error::{extend, filled, push, reserve, reserved, zeros, Result};
use crate::grid::Vec3;
use crate::surface::halfedge::{next, previous, twins_if_wound, NONE};

/// Where a point may go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    /// Anywhere on the reference surface.
    #[default]
    Interior,
    /// Along the boundary curve.
    Boundary,
    /// Nowhere: a corner of the boundary curve.
    Corner,
}

/// A point of the surface with what the reference says about its place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertex {
    pub point: Vec3,
    /// Boundary points: arc length along the boundary curve.
    pub parameter: f64,
    /// Unit normal of the reference.
    pub normal: [f32; 3],
    /// Edge length wanted here.
    pub size: f32,
    /// Interior points: the triangle of the reference; boundary points: the loop of its curve.
    pub at: u32,
    pub kind: Kind,
    /// Number of triangles around it that are not remeshed: where there are some the point stays for good.
    pub beyond: u8,
}

impl Vertex {
    pub fn normal(&self) -> Vec3 {
        self.normal.map(f64::from)
    }
    pub fn is_frozen(&self) -> bool {
        self.beyond > 0
    }
    pub fn is_boundary(&self) -> bool {
        self.kind != Kind::Interior
    }
}

/// The most triangles around a point that a step looks at.
pub(super) const MOST_AROUND: usize = 256;

/// Edges of the boundary are wanted so much shorter: inside, where a point has six edges and the shortest
/// is collapsed, their mean comes out below what is wanted, and along a curve above that.
pub(super) const ON_BOUNDARY: f64 = 0.9;

/// A piece of the surface.
#[derive(Clone)]
pub(super) struct Patch<'a> {
    pub reference: &'a Reference<'a>,
    /// Edges are wanted so many times longer than in the end,
    scale: f64,
    /// but no longer than this.
    longest: f64,
    pub vertices: Vec<Vertex>,
    pub frozen: Vec<bool>,
    /// Number of edges of each point on the whole surface.
    pub valence: Vec<i32>,
    /// Number of triangles of each point in this patch.
    pub fan: Vec<i32>,
    /// A half-edge that leaves each point; on a boundary, the one without a twin.
    out: Vec<u32>,
    /// A removed triangle has the corners [`NONE`].
    pub triangles: Vec<[u32; 3]>,
    pub twins: Vec<u32>,
    /// Removed triangles.
    free: Vec<u32>,
}

impl<'a> Patch<'a> {
    pub fn new(
        reference: &'a Reference<'a>,
        (scale, longest): (f64, f64),
        vertices: Vec<Vertex>,
        frozen: Vec<bool>,
        valence: Vec<i32>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self> {
        let count = vertices.len();
        let mut fan: Vec<i32> = zeros(count)?;
        for t in &triangles {
            t.iter().for_each(|&p| fan[p as usize] += 1);
        }
        let mut patch = Self {
            reference,
            scale,
            longest,
            vertices,
            frozen,
            valence,
            fan,
            out: filled(NONE, count)?,
            twins: Vec::new(),
            free: reserved(triangles.len())?,
            triangles,
        };
        patch.twins = twins_if_wound(&patch.triangles, count)?;
        for e in 0..patch.twins.len() as u32 {
            patch.set_out(e);
        }
        Ok(patch)
    }

    /// First point of a half-edge.
    pub fn origin(&self, e: u32) -> u32 {
        self.triangles[e as usize / 3][e as usize % 3]
    }

    /// Last point of a half-edge.
    pub fn end(&self, e: u32) -> u32 {
        self.origin(next(e))
    }

    /// The corner opposite a half-edge.
    pub fn opposite(&self, e: u32) -> u32 {
        self.origin(previous(e))
    }

    pub fn twin(&self, e: u32) -> u32 {
        self.twins[e as usize]
    }

    pub fn point(&self, p: u32) -> Vec3 {
        self.vertices[p as usize].point
    }

    /// Where a triangle's corners are.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|p| self.point(p))
    }

    pub fn is_alive(&self, triangle: u32) -> bool {
        self.triangles[triangle as usize][0] != NONE
    }

    /// Edge length wanted at a point.
    pub fn size(&self, p: u32) -> f64 {
        (self.scale * f64::from(self.vertices[p as usize].size)).min(self.longest)
    }

    /// Edge length wanted between two points.
    pub fn wanted(&self, a: u32, b: u32) -> f64 {
        0.5 * (self.size(a) + self.size(b))
    }

    /// Edge length wanted of the edge of a half-edge.
    pub fn wanted_of(&self, e: u32) -> f64 {
        let wanted = self.wanted(self.origin(e), self.end(e));
        match self.twin(e) {
            NONE => ON_BOUNDARY * wanted,
            _ => wanted,
        }
    }

    /// The neighbours of the point that the half-edges of a ring, as [`Self::around`] gives it, leave.
    pub fn neighbours<'r>(&'r self, ring: &'r [u32]) -> impl Iterator<Item = u32> + 'r {
        // On a boundary the last one is only found backwards.
        let last = ring.last().filter(|&&e| self.twin(previous(e)) == NONE);
        let ends = ring.iter().map(|&e| self.end(e));
        ends.chain(last.map(|&e| self.opposite(e)))
    }

    /// The half-edges that leave a point that is not frozen, counter-clockwise. On a boundary the
    /// first one has no twin.
    pub fn around(&self, p: u32) -> Around<'_> {
        Around {
            twins: &self.twins,
            first: self.out[p as usize],
            at: self.out[p as usize],
            left: MOST_AROUND,
        }
    }

    /// The previous point along the boundary and the next one.
    pub fn along_boundary(&self, p: u32) -> Option<[u32; 2]> {
        let first = self.out[p as usize];
        let last = self.around(p).last()?;
        (self.twin(first) == NONE && self.twin(previous(last)) == NONE)
            .then(|| [self.opposite(last), self.end(first)])
    }

    /// Whether two points, the first of which is not frozen, share an edge.
    pub fn joined(&self, p: u32, q: u32) -> bool {
        self.around(p)
            .any(|e| self.end(e) == q || self.opposite(e) == q)
    }

    /// Makes half-edge e the one known to leave its origin, unless a boundary needs another.
    fn set_out(&mut self, e: u32) {
        let p = self.origin(e) as usize;
        if self.out[p] == NONE || !self.vertices[p].is_boundary() || self.twin(e) == NONE {
            self.out[p] = e;
        }
    }

    fn link(&mut self, e: u32, f: u32) {
        for (e, f) in [(e, f), (f, e)] {
            if e != NONE {
                self.twins[e as usize] = f;
                self.set_out(e);
            }
        }
    }

    fn add_triangle(&mut self) -> Result<u32> {
        if let Some(t) = self.free.pop() {
            return Ok(t);
        }
        push(&mut self.triangles, [NONE; 3])?;
        extend(&mut self.twins, [NONE; 3])?;
        // Room for all of them, so that removing one asks for nothing.
        reserve(&mut self.free, self.triangles.len())?;
        Ok(self.triangles.len() as u32 - 1)
    }

    /// Appends a point that no triangle uses yet.
    fn add_point(&mut self, vertex: Vertex, valence: i32, fan: i32) -> Result<()> {
        push(&mut self.vertices, vertex)?;
        push(&mut self.frozen, false)?;
        push(&mut self.valence, valence)?;
        push(&mut self.fan, fan)?;
        push(&mut self.out, NONE)
    }

    /// Turns the edge of e, shared by triangles abc and bad, into cd.
    pub fn flip(&mut self, e: u32) {
        let f = self.twin(e);
        let ([a, b, c], d) = (
            [self.origin(e), self.end(e), self.opposite(e)],
            self.opposite(f),
        );
        let outer = [next(e), previous(e), next(f), previous(f)].map(|h| self.twin(h));
        let (s, t) = (e / 3, f / 3);
        self.triangles[s as usize] = [c, a, d];
        self.triangles[t as usize] = [d, b, c];
        self.link(3 * s, outer[1]);
        self.link(3 * s + 1, outer[2]);
        self.link(3 * t, outer[3]);
        self.link(3 * t + 1, outer[0]);
        self.link(3 * s + 2, 3 * t + 2);
        for (p, change) in [(a, -1), (b, -1), (c, 1), (d, 1)] {
            self.valence[p as usize] += change;
            self.fan[p as usize] += change;
        }
    }

    /// Puts a new point on the edge of e, and returns it.
    pub fn split(&mut self, e: u32, vertex: Vertex) -> Result<u32> {
        let m = self.vertices.len() as u32;
        let [a, b, c] = [self.origin(e), self.end(e), self.opposite(e)];
        let f = self.twin(e);
        let (valence, fan) = if f == NONE { (3, 2) } else { (4, 4) };
        self.add_point(vertex, valence, fan)?;
        let (bc, ca) = (self.twin(next(e)), self.twin(previous(e)));
        let (s, s2) = (e / 3, self.add_triangle()?);
        self.triangles[s as usize] = [a, m, c];
        self.triangles[s2 as usize] = [m, b, c];
        self.count(c, 1);
        if f == NONE {
            self.link(3 * s, NONE);
            self.link(3 * s2, NONE);
        } else {
            let d = self.opposite(f);
            let (ad, db) = (self.twin(next(f)), self.twin(previous(f)));
            let (t, t2) = (f / 3, self.add_triangle()?);
            self.triangles[t as usize] = [m, a, d];
            self.triangles[t2 as usize] = [b, m, d];
            self.count(d, 1);
            self.link(3 * s, 3 * t);
            self.link(3 * s2, 3 * t2);
            self.link(3 * t + 2, 3 * t2 + 1);
            self.link(3 * t + 1, ad);
            self.link(3 * t2 + 2, db);
        }
        self.link(3 * s + 1, 3 * s2 + 2);
        self.link(3 * s + 2, ca);
        self.link(3 * s2 + 1, bc);
        Ok(m)
    }

    fn count(&mut self, p: u32, change: i32) {
        self.valence[p as usize] += change;
        self.fan[p as usize] += change;
    }

    /// Removes point v by drawing it into its neighbour u along half-edge e, which joins the two
    /// in either direction. `ring` are the half-edges that leave v.
    pub fn collapse(&mut self, e: u32, v: u32, u: u32, ring: &[u32]) {
        let f = self.twin(e);
        let shared = if f == NONE { 1 } else { 2 };
        for &h in ring {
            self.triangles[h as usize / 3][h as usize % 3] = u;
        }
        self.fan[u as usize] += self.fan[v as usize] - 2 * shared;
        self.valence[u as usize] += self.valence[v as usize] - 2 - shared;
        for h in [e, f].into_iter().filter(|&h| h != NONE) {
            let c = self.opposite(h);
            self.count(c, -1);
            let (x, y) = (self.twin(next(h)), self.twin(previous(h)));
            self.triangles[h as usize / 3] = [NONE; 3];
            self.free.push(h / 3);
            self.link(x, y);
        }
        for &h in ring {
            if self.is_alive(h / 3) {
                self.set_out(h);
            }
        }
        self.out[v as usize] = NONE;
    }

    /// The triangles up to so many rings around a point that is not frozen, as a patch of their own.
    pub fn neighbourhood(&self, p: u32, rings: u8) -> Result<Neighbourhood<'a>> {
        let mut points = vec![p];
        let mut triangles: Vec<u32> = Vec::new();
        let mut done = 0;
        for _ in 0..rings {
            let end = points.len();
            for i in done..end {
                if self.frozen[points[i] as usize] {
                    continue;
                }
                for t in self.around(points[i]).map(|e| e / 3) {
                    if !triangles.contains(&t) {
                        triangles.push(t);
                        for q in self.triangles[t as usize] {
                            if !points.contains(&q) {
                                points.push(q);
                            }
                        }
                    }
                }
            }
            done = end;
        }
        let number = |p: u32| {
            points
                .iter()
                .position(|&q| q == p)
                .map_or(NONE, |i| i as u32)
        };
        let corners = triangles
            .iter()
            .map(|&t| self.triangles[t as usize].map(number));
        let mut patch = Patch::new(
            self.reference,
            (self.scale, self.longest),
            points.iter().map(|&p| self.vertices[p as usize]).collect(),
            vec![false; points.len()],
            points.iter().map(|&p| self.valence[p as usize]).collect(),
            corners.collect(),
        )?;
        for (i, &p) in points.iter().enumerate() {
            patch.frozen[i] = self.frozen[p as usize] || patch.fan[i] < self.fan[p as usize];
        }
        Ok(Neighbourhood {
            patch,
            points,
            triangles,
        })
    }

    /// Puts a neighbourhood back, changed.
    pub fn put_back(&mut self, place: Neighbourhood, changed: Patch) -> Result<()> {
        let mut points = place.points;
        for (i, vertex) in changed.vertices.iter().enumerate() {
            if i == points.len() {
                points.push(self.vertices.len() as u32);
                self.add_point(*vertex, 0, 0)?;
            }
            let p = points[i] as usize;
            self.vertices[p] = *vertex;
            self.valence[p] = changed.valence[i];
            self.fan[p] += changed.fan[i] - place.patch.fan.get(i).copied().unwrap_or(0);
            if self.out[p] != NONE && place.triangles.contains(&(self.out[p] / 3)) {
                self.out[p] = NONE;
            }
        }
        // The twins beyond, by the ends of the half-edges they belong to.
        let mut beyond: Vec<([u32; 2], u32)> = Vec::new();
        for e in place.triangles.iter().flat_map(|&t| 3 * t..3 * t + 3) {
            let f = self.twin(e);
            if f != NONE && !place.triangles.contains(&(f / 3)) {
                beyond.push(([self.origin(e), self.end(e)], f));
            }
        }
        for &t in &place.triangles {
            self.triangles[t as usize] = [NONE; 3];
            self.free.push(t);
        }
        let alive = |t: &u32| changed.is_alive(*t);
        let old: Vec<u32> = (0..changed.triangles.len() as u32).filter(alive).collect();
        let mut new = vec![NONE; changed.triangles.len()];
        for &t in &old {
            new[t as usize] = self.add_triangle()?;
            let corners = changed.triangles[t as usize];
            self.triangles[new[t as usize] as usize] = corners.map(|p| points[p as usize]);
        }
        let renumbered = |e: u32| 3 * new[e as usize / 3] + e % 3;
        for e in old.iter().flat_map(|&t| 3 * t..3 * t + 3) {
            let f = changed.twin(e);
            let e = renumbered(e);
            let twin = if f == NONE {
                let ends = [self.origin(e), self.end(e)];
                let found = beyond.iter().find(|b| b.0 == ends);
                found.map_or(NONE, |b| b.1)
            } else {
                renumbered(f)
            };
            self.link(e, twin);
        }
        Ok(())
    }

    /// Whether a point is used by no triangle any more.
    pub fn is_removed(&self, p: u32) -> bool {
        self.out[p as usize] == NONE
    }
}

/// A small part of a patch, taken out.
pub(super) struct Neighbourhood<'a> {
    pub patch: Patch<'a>,
    /// The numbers of its points and triangles in the patch that it is of.
    points: Vec<u32>,
    triangles: Vec<u32>,
}

/// Half-edges around a point.
pub(super) struct Around<'a> {
    twins: &'a [u32],
    first: u32,
    at: u32,
    left: usize,
}

impl Iterator for Around<'_> {
    type Item = u32;
    fn next(&mut self) -> Option<u32> {
        if self.at == NONE || self.left == 0 {
            return None;
        }
        let e = self.at;
        let back = self.twins[previous(e) as usize];
        self.at = if back == self.first { NONE } else { back };
        self.left -= 1;
        Some(e)
    }
}
