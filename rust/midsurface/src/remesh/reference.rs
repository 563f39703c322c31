//! The surface that the new mesh must lie on: the mesh that came in.
//!
//! A place on it is a triangle and a point in it, found by walking from triangle to triangle, so
//! that a point never jumps to another sheet, however close. Flat triangles would flatten what is
//! curved: a place is lifted half of the way to the tangent planes of the triangle's corners
//! (Phong tessellation, Boubekeur and Alexa 2008), which with a half is exact for every surface of
//! second order.

use super::curve::Curve;
use super::patch::Vertex;
use super::sizing;
use crate::error::{zeros, Result};
use crate::execution::Execution;
use crate::grid::{along, dot, sub, unit, Vec3};
use crate::surface::halfedge::{Fans, NONE};
use crate::surface::normals::normal_of_fan;

/// Items handed to a worker at a time.
const PIECE: usize = 4096;
/// Passes over the reference that learning it takes, for its progress.
pub(super) const PASSES: usize = 2 + sizing::PASSES;
/// The most triangles that a walk crosses.
const LONGEST_WALK: usize = 256;
/// A walk ends after so many triangles without coming nearer.
const PATIENCE: usize = 8;

/// The mesh that came in, with what the remesher wants to know about it.
pub(super) struct Reference<'a> {
    pub points: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
    pub twins: Vec<u32>,
    pub normals: Vec<[f32; 3]>,
    /// Edge length wanted at each point.
    pub sizes: Vec<f32>,
    pub curve: Curve,
}

/// A place on the reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub triangle: u32,
    /// Barycentric coordinates, none of them negative.
    pub weights: Vec3,
}

impl<'a> Reference<'a> {
    /// Learns what there is to know about a consistently wound manifold.
    pub fn new(
        points: &'a [Vec3],
        triangles: &'a [[u32; 3]],
        edge_length: f64,
        execution: &mut Execution,
    ) -> Result<Self> {
        let fans = Fans::new(triangles, points.len())?;
        let mut twins = zeros(3 * triangles.len())?;
        execution.fill(&mut twins, 3 * PIECE, |piece, out| {
            for (i, twin) in out.iter_mut().enumerate() {
                *twin = fans.twin(triangles, (piece * 3 * PIECE + i) as u32);
            }
        })?;
        let mut normals: Vec<[f32; 3]> = zeros(points.len())?;
        execution.fill(&mut normals, PIECE, |piece, out| {
            for (i, normal) in out.iter_mut().enumerate() {
                let leaving = fans.of((piece * PIECE + i) as u32);
                *normal = normal_of_fan(points, triangles, leaving).map(|v| v as f32);
            }
        })?;
        let curve = Curve::new(points, triangles, &twins)?;
        let mut reference = Self {
            points,
            triangles,
            twins,
            normals,
            sizes: Vec::new(),
            curve,
        };
        reference.sizes = sizing::sizes(&reference, &fans, edge_length, execution)?;
        Ok(reference)
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|p| self.points[p as usize])
    }

    /// The vertex nearest to `target`, found by walking from triangle `from`.
    pub fn vertex(&self, from: u32, target: Vec3) -> Vertex {
        self.lift(self.walk(from, target))
    }

    /// The place nearest to `target`, as far as a walk downhill from a triangle finds it.
    pub fn walk(&self, from: u32, target: Vec3) -> Place {
        let mut best = Place {
            triangle: from,
            weights: [1.0, 0.0, 0.0],
        };
        let (mut least, mut since) = (f64::INFINITY, 0);
        let (mut before, mut at) = (NONE, from);
        for _ in 0..LONGEST_WALK {
            let corners = self.corners(at);
            let foot = barycentric(corners, target);
            let (weights, side) = nearest(corners, target, foot);
            let gap = sub(target, mix(corners, weights));
            let distance = dot(gap, gap);
            if distance < least {
                (least, since) = (distance, 0);
                best = Place {
                    triangle: at,
                    weights,
                };
            } else {
                since += 1;
            }
            let Some(side) = side.filter(|_| since < PATIENCE) else {
                break;
            };
            // Leaves over the side opposite corner k, never back. At a corner of the reference this
            // turns around it.
            let way_out = |k: usize| {
                let twin = self.twins[3 * at as usize + (k + 1) % 3];
                (twin != NONE && twin / 3 != before).then_some(twin / 3)
            };
            let mut other = (0..3).filter(|&k| k != side && foot[k] < 0.0);
            let Some(to) = way_out(side).or_else(|| other.find_map(way_out)) else {
                break;
            };
            (before, at) = (at, to);
        }
        best
    }

    /// The curved surface over a place.
    fn lift(&self, place: Place) -> Vertex {
        let corners = self.corners(place.triangle);
        let flat = mix(corners, place.weights);
        let mut point = flat;
        let mut normal = [0.0; 3];
        let mut size = 0.0;
        for (k, &p) in self.triangles[place.triangle as usize].iter().enumerate() {
            let n = self.normals[p as usize].map(f64::from);
            let w = place.weights[k];
            point = along(point, 0.5 * w * dot(sub(corners[k], flat), n), n);
            normal = along(normal, w, n);
            size += w as f32 * self.sizes[p as usize];
        }
        Vertex {
            point,
            normal: unit(normal).map(|v| v as f32),
            size,
            at: place.triangle,
            ..Vertex::default()
        }
    }

    /// The triangle that a point of the new mesh lies on, or next to.
    pub fn triangle_of(&self, vertex: &Vertex) -> u32 {
        if vertex.is_boundary() {
            self.curve.origin(vertex).0 / 3
        } else {
            vertex.at
        }
    }

    /// The place of a point of the new mesh.
    pub fn place(&self, vertex: &Vertex) -> Place {
        if vertex.is_boundary() {
            let (e, t) = self.curve.origin(vertex);
            let mut weights = [0.0; 3];
            weights[e as usize % 3] = 1.0 - t;
            weights[(e as usize + 1) % 3] = t;
            return Place {
                triangle: e / 3,
                weights,
            };
        }
        self.walk(vertex.at, vertex.point)
    }
}

/// The point of barycentric coordinates.
pub(super) fn mix(corners: [Vec3; 3], weights: Vec3) -> Vec3 {
    let [a, b, c] = corners;
    std::array::from_fn(|k| a[k] * weights[0] + b[k] * weights[1] + c[k] * weights[2])
}

/// Barycentric coordinates of the foot of a point on a triangle's plane.
fn barycentric([a, b, c]: [Vec3; 3], p: Vec3) -> Vec3 {
    let (u, v, w) = (sub(b, a), sub(c, a), sub(p, a));
    let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
    let (wu, wv) = (dot(w, u), dot(w, v));
    let determinant = uu * vv - uv * uv;
    if determinant <= 1e-14 * uu * vv {
        // No area: the foot on its first side is as good as any.
        let t = if uu > 0.0 { wu / uu } else { 0.0 };
        return [1.0 - t, t, -1e-9];
    }
    let second = (wu * vv - wv * uv) / determinant;
    let third = (wv * uu - wu * uv) / determinant;
    [1.0 - second - third, second, third]
}

/// Barycentric coordinates of the nearest point of a triangle; where that is on a side, which side:
/// the one opposite that corner.
fn nearest(corners: [Vec3; 3], p: Vec3, foot: Vec3) -> (Vec3, Option<usize>) {
    let mut best = (foot, None);
    let mut least = f64::INFINITY;
    for k in (0..3).filter(|&k| foot[k] < 0.0) {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let side = sub(corners[j], corners[i]);
        let squared = dot(side, side);
        let t = if squared > 0.0 {
            (dot(sub(p, corners[i]), side) / squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let gap = sub(p, along(corners[i], t, side));
        let distance = dot(gap, gap);
        if distance < least {
            let mut weights = [0.0; 3];
            (weights[i], weights[j]) = (1.0 - t, t);
            (best, least) = ((weights, Some(k)), distance);
        }
    }
    best
}
