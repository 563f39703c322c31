//! The boundary of the reference as curves with an arc length.
//!
//! A boundary point of the remeshed surface is known by its loop and its arc length along it, so
//! that sliding is a matter of one number and can neither leave the curve nor overtake a
//! neighbour. Between the points of the reference the curve is bent as `reference.rs` bends
//! triangles, with tangents instead of normals.

use super::patch::{Kind, Vertex};
use super::reference::Reference;
use crate::error::{collected, extend, filled, push, Result};
use crate::grid::{along, dot, length, sub, unit, Vec3};
use crate::surface::halfedge::{ends, NONE};

/// Lengths over which the direction of the boundary is compared, to find corners: a corner is one
/// over both, a step in a ragged rim over the shorter one only.
const REACHES: [f64; 2] = [1.5, 3.0];
/// Cosine of the least turn of a corner, 55°.
const CORNER: f64 = 0.57;
/// A shorter loop turns sharply all along and has no corners.
const ROUND: f64 = 12.0;

/// A closed boundary curve: a range of the arrays of [`Curve`].
#[derive(Clone, Copy, Debug)]
struct Loop {
    first: usize,
    count: usize,
    length: f64,
}

/// All boundary curves of a reference.
#[derive(Debug, Default)]
pub(super) struct Curve {
    loops: Vec<Loop>,
    /// Half-edges of the reference in the direction of its triangles; each starts at its point.
    half_edges: Vec<u32>,
    points: Vec<Vec3>,
    /// Arc length at each point.
    parameters: Vec<f64>,
    /// Unit tangent at each point; zero at a corner.
    tangents: Vec<Vec3>,
}

impl Curve {
    /// Links the half-edges without a twin to loops.
    pub fn new(points: &[Vec3], triangles: &[[u32; 3]], twins: &[u32]) -> Result<Self> {
        let mut curve = Self::default();
        let border = (0..twins.len() as u32).filter(|&e| twins[e as usize] == NONE);
        let mut leaving = collected(border.map(|e| (ends(triangles, e).0, e)))?;
        leaving.sort_unstable();
        let position = |p: u32| leaving.binary_search_by_key(&p, |l| l.0).ok();
        let mut seen = filled(false, leaving.len())?;
        for start in 0..leaving.len() {
            let first = curve.half_edges.len();
            let mut at = Some(start);
            while let Some(i) = at.filter(|&i| !seen[i]) {
                seen[i] = true;
                push(&mut curve.half_edges, leaving[i].1)?;
                push(&mut curve.points, points[leaving[i].0 as usize])?;
                at = position(ends(triangles, leaving[i].1).1);
            }
            curve.close_loop(first)?;
        }
        Ok(curve)
    }

    /// Makes a loop of all points from `first` on.
    fn close_loop(&mut self, first: usize) -> Result<()> {
        let points = &self.points[first..];
        let count = points.len();
        if count == 0 {
            return Ok(());
        }
        let mut length_so_far = 0.0;
        for i in 0..count {
            push(&mut self.parameters, length_so_far)?;
            length_so_far += length(sub(points[(i + 1) % count], points[i]));
        }
        let curve = Loop {
            first,
            count,
            length: length_so_far,
        };
        push(&mut self.loops, curve)?;
        let number = self.loops.len() as u32 - 1;
        let turn = |i| self.turn(number, self.parameters[first + i]);
        let turns = collected((0..count).map(turn))?;
        let is_corner = |i: usize| {
            let sharpest = |j: usize| turns[i] <= turns[j % count];
            curve.length > ROUND && turns[i] < CORNER && sharpest(i + 1) && sharpest(i + count - 1)
        };
        let tangent = |i| match is_corner(i) {
            true => [0.0; 3],
            false => self.tangent(curve, i),
        };
        let tangents = collected((0..count).map(tangent))?;
        extend(&mut self.tangents, tangents)
    }

    /// Cosine of the angle by which a loop turns around a place, over the reach where it is less.
    fn turn(&self, number: u32, parameter: f64) -> f64 {
        let turns = REACHES.map(|reach| self.turn_over(number, parameter, reach));
        turns.into_iter().fold(-1.0, f64::max)
    }

    fn turn_over(&self, number: u32, parameter: f64, reach: f64) -> f64 {
        let here = self.place(number, parameter);
        let back = sub(here, self.place(number, parameter - reach));
        let ahead = sub(self.place(number, parameter + reach), here);
        dot(unit(back), unit(ahead))
    }

    /// The place at an arc length of a loop, straight between the points of the reference.
    fn place(&self, number: u32, parameter: f64) -> Vec3 {
        let (i, j, t) = self.locate(number, parameter);
        along(self.points[i], t, sub(self.points[j], self.points[i]))
    }

    /// How far a loop goes, on so long a way from an arc length, from the chord of that.
    pub fn sagitta(&self, number: u32, from: f64, way: f64) -> f64 {
        let Loop { first, count, .. } = self.loops[number as usize];
        let start = self.place(number, from);
        let chord = sub(self.place(number, from + way), start);
        let here = self.locate(number, from).0 - first;
        let between = (here + 1..here + count).map(|i| first + i % count);
        let between = between
            .take_while(|&i| self.distance(number, from, self.parameters[i]) < way)
            .map(|i| sub(self.points[i], start));
        let share = |p: Vec3| dot(p, chord) / dot(chord, chord).max(1e-12);
        let off = between.map(|p| length(along(p, -share(p).clamp(0.0, 1.0), chord)));
        off.fold(0.0, f64::max)
    }

    /// Direction of the parabola through a point of a loop and its neighbours.
    fn tangent(&self, curve: Loop, i: usize) -> Vec3 {
        let point = |i: usize| self.points[curve.first + i % curve.count];
        let back = sub(point(i), point(i + curve.count - 1));
        let ahead = sub(point(i + 1), point(i));
        let (a, b) = (length(back).max(1e-9), length(ahead).max(1e-9));
        unit(along(back.map(|v| v * b / a), a / b, ahead))
    }

    /// The two points around an arc length, and the share of the way between them.
    fn locate(&self, number: u32, parameter: f64) -> (usize, usize, f64) {
        let Loop {
            first,
            count,
            length,
        } = self.loops[number as usize];
        let s = parameter.rem_euclid(length.max(1e-12));
        let after = self.parameters[first..first + count].partition_point(|&p| p <= s);
        let i = after.max(1) - 1;
        let j = (i + 1) % count;
        let start = self.parameters[first + i];
        let end = if j == 0 {
            length
        } else {
            self.parameters[first + j]
        };
        let t = (s - start) / (end - start).max(1e-12);
        (first + i, first + j, t.clamp(0.0, 1.0))
    }

    /// How far it is along a loop from one arc length on to another.
    pub fn distance(&self, number: u32, from: f64, to: f64) -> f64 {
        (to - from).rem_euclid(self.loops[number as usize].length.max(1e-12))
    }

    /// Length of a loop.
    pub fn loop_length(&self, number: u32) -> f64 {
        self.loops[number as usize].length
    }

    /// Each point of the curve: its half-edge, its loop, its arc length, whether it is a corner.
    pub fn vertices(&self) -> impl Iterator<Item = (u32, u32, f64, bool)> + '_ {
        (0..self.loops.len() as u32).flat_map(move |number| {
            let curve = self.loops[number as usize];
            (curve.first..curve.first + curve.count).map(move |i| {
                let corner = self.tangents[i] == [0.0; 3];
                (self.half_edges[i], number, self.parameters[i], corner)
            })
        })
    }

    /// Curvature of the curve around a point; none next to a corner.
    pub fn curvature(&self, number: u32, parameter: f64) -> f64 {
        if self.is_near_corner(number, parameter) {
            return 0.0;
        }
        let reach = REACHES[0];
        let cosine = self.turn_over(number, parameter, reach);
        cosine.clamp(-1.0, 1.0).acos() / reach
    }

    fn is_near_corner(&self, number: u32, parameter: f64) -> bool {
        let Loop { first, count, .. } = self.loops[number as usize];
        let here = self.locate(number, parameter).0 - first;
        let near = |i: &usize| {
            let s = self.parameters[first + i % count];
            let ahead = self.distance(number, parameter, s);
            ahead.min(self.distance(number, s, parameter)) < REACHES[1]
        };
        let corner = |i: usize| self.tangents[first + i % count] == [0.0; 3];
        let mut ahead = (here..here + count).take_while(near);
        let mut back = (here..here + count)
            .map(|i| 2 * here + count - i)
            .take_while(near);
        ahead.any(corner) || back.any(corner)
    }

    /// The half-edge of the reference below a boundary point, and the share of the way along it.
    pub fn origin(&self, vertex: &Vertex) -> (u32, f64) {
        let (i, _, t) = self.locate(vertex.at, vertex.parameter);
        (self.half_edges[i], t)
    }

    /// The boundary point at an arc length of a loop.
    pub fn vertex(&self, reference: &Reference, number: u32, parameter: f64) -> Vertex {
        let (i, j, t) = self.locate(number, parameter);
        let (a, b) = (self.points[i], self.points[j]);
        let flat = along(a, t, sub(b, a));
        let on_tangent = |x: Vec3, tangent: Vec3| match tangent {
            [0.0, 0.0, 0.0] => flat,
            _ => along(x, dot(sub(flat, x), tangent), tangent),
        };
        let (p, q) = (
            on_tangent(a, self.tangents[i]),
            on_tangent(b, self.tangents[j]),
        );
        let bent = along(p, t, sub(q, p));
        let (v, w) = ends(reference.triangles, self.half_edges[i]);
        let mix = |x: f32, y: f32| x + (y - x) * t as f32;
        let (m, n) = (reference.normals[v as usize], reference.normals[w as usize]);
        let normal = unit(std::array::from_fn(|k| f64::from(mix(m[k], n[k]))));
        Vertex {
            point: std::array::from_fn(|k| 0.5 * (flat[k] + bent[k])),
            parameter: parameter.rem_euclid(self.loops[number as usize].length.max(1e-12)),
            normal: normal.map(|v| v as f32),
            size: mix(reference.sizes[v as usize], reference.sizes[w as usize]),
            at: number,
            kind: Kind::Boundary,
            ..Vertex::default()
        }
    }
}
