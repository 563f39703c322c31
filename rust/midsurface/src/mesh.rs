//! The result: a triangle mesh, and the invariants it keeps.

use rayon::prelude::*;

use crate::error::{check_count, collected, extend, filled, zeros, Error, Result};
use crate::execution::Execution;
use crate::grid::{along, cross, dot, length, sub, Vec3};
use crate::reading::components::DisjointSets;
use crate::surface::halfedge::{Edges, NONE};
use crate::surface::manifold::{make_manifold, Surface};

/// A triangle mesh: a 2-manifold with boundary, consistently wound in each connected piece.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// World coordinates, x, y, z.
    pub points: Vec<[f32; 3]>,
    /// Three point indices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normal of each point: of its triangles' normals, weighted by their angle at the point.
    pub normals: Vec<[f32; 3]>,
    /// Distance between both faces of the label at each point, world units.
    pub thickness: Vec<f32>,
    /// Label of each triangle.
    pub labels: Vec<i64>,
    /// Component of each triangle: the label's 26-connected component, from 0, ordered by label,
    /// then by size, the largest first.
    pub components: Vec<u32>,
}

/// How a mesh is not what it should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum InvariantViolation {
    /// The arrays do not have one entry a point or a triangle.
    #[error("an array of the mesh has {found} entries instead of {expected}")]
    ArrayLength {
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// A triangle names a point that is not there.
    #[error("triangle {0} names a point that is not there")]
    PointIndex(usize),
    /// A coordinate or a normal is not a finite number.
    #[error("point {0} has a coordinate, normal or thickness that is no finite number")]
    NotFinite(usize),
    /// A triangle without an area.
    #[error("triangle {0} has no area")]
    Degenerate(usize),
    /// The same three points twice.
    #[error("triangle {0} is there twice")]
    Duplicate(usize),
    /// More than two triangles at an edge.
    #[error("points {0} and {1} share an edge with more than two triangles")]
    NonManifoldEdge(u32, u32),
    /// Two triangles that are wound against each other.
    #[error("the triangles at the edge of points {0} and {1} are wound against each other")]
    Misoriented(u32, u32),
    /// Triangles that touch in a point only.
    #[error("at point {0} triangles touch that share no edge there")]
    Pinched(u32),
    /// A point no triangle uses.
    #[error("point {0} belongs to no triangle")]
    Unused(usize),
    /// Memory for checking was refused.
    #[error("the mesh could not be checked: not enough memory")]
    Unchecked,
}

/// What a refusal of memory, the only error of the buffers that checking takes, becomes.
fn unchecked(_: Error) -> InvariantViolation {
    InvariantViolation::Unchecked
}

impl Mesh {
    /// Appends another mesh that shares no point with this one.
    pub(crate) fn append(&mut self, other: Self) -> Result<()> {
        check_count("points", self.points.len() + other.points.len(), 1)?;
        check_count("triangles", self.triangles.len() + other.triangles.len(), 3)?;
        let first = self.points.len() as u32;
        let triangles = other.triangles.iter().map(|t| t.map(|p| first + p));
        extend(&mut self.triangles, triangles)?;
        extend(&mut self.points, other.points)?;
        extend(&mut self.normals, other.normals)?;
        extend(&mut self.thickness, other.thickness)?;
        extend(&mut self.labels, other.labels)?;
        extend(&mut self.components, other.components)
    }

    /// Checks that the mesh is a 2-manifold with boundary, consistently wound, with nothing
    /// duplicate, degenerate or unused.
    pub fn check_invariants(&self) -> std::result::Result<(), InvariantViolation> {
        self.check_arrays()?;
        let edges = Edges::new(&self.triangles, self.points.len()).map_err(unchecked)?;
        for (a, b, group) in edges.groups() {
            match group {
                [_] => {}
                [(_, e), (_, f)] => {
                    let [p, q] =
                        [e, f].map(|h| crate::surface::halfedge::ends(&self.triangles, *h));
                    if self.sorted(*e) == self.sorted(*f) {
                        return Err(InvariantViolation::Duplicate(*f as usize / 3));
                    }
                    if p == q {
                        return Err(InvariantViolation::Misoriented(a, b));
                    }
                }
                _ => return Err(InvariantViolation::NonManifoldEdge(a, b)),
            }
        }
        self.check_fans(&edges.twins().map_err(unchecked)?)
    }

    /// The points of a half-edge's triangle, ascending.
    fn sorted(&self, half_edge: u32) -> [u32; 3] {
        let mut triangle = self.triangles[half_edge as usize / 3];
        triangle.sort_unstable();
        triangle
    }

    fn check_arrays(&self) -> std::result::Result<(), InvariantViolation> {
        let lengths = [
            (self.points.len(), self.normals.len()),
            (self.points.len(), self.thickness.len()),
            (self.triangles.len(), self.labels.len()),
            (self.triangles.len(), self.components.len()),
        ];
        for (expected, found) in lengths {
            if expected != found {
                return Err(InvariantViolation::ArrayLength { expected, found });
            }
        }
        for (i, (point, normal)) in self.points.iter().zip(&self.normals).enumerate() {
            let finite = point.iter().chain(normal).all(|v| v.is_finite());
            if !finite || !self.thickness[i].is_finite() {
                return Err(InvariantViolation::NotFinite(i));
            }
        }
        let mut used: Vec<bool> = zeros(self.points.len()).map_err(unchecked)?;
        for (i, triangle) in self.triangles.iter().enumerate() {
            for &p in triangle {
                *used
                    .get_mut(p as usize)
                    .ok_or(InvariantViolation::PointIndex(i))? = true;
            }
            if is_degenerate(triangle.map(|p| self.points[p as usize])) {
                return Err(InvariantViolation::Degenerate(i));
            }
        }
        used.iter()
            .position(|u| !u)
            .map_or(Ok(()), |i| Err(InvariantViolation::Unused(i)))
    }

    /// Every point's corners must hang together through shared edges.
    fn check_fans(&self, twins: &[u32]) -> std::result::Result<(), InvariantViolation> {
        let mut fans = DisjointSets::new(twins.len()).map_err(unchecked)?;
        for e in 0..twins.len() as u32 {
            let twin = twins[e as usize];
            if twin != NONE {
                fans.join(e as usize, crate::surface::halfedge::next(twin) as usize);
            }
        }
        let mut fan_of = filled(NONE, self.points.len()).map_err(unchecked)?;
        for corner in 0..twins.len() {
            let p = self.triangles[corner / 3][corner % 3];
            let fan = fans.find(corner) as u32;
            let known = &mut fan_of[p as usize];
            if *known == NONE {
                *known = fan;
            } else if *known != fan {
                return Err(InvariantViolation::Pinched(p));
            }
        }
        Ok(())
    }
}

/// Whether a triangle has no area to speak of.
fn is_degenerate(corners: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(|p| p.map(f64::from));
    let area = length(cross(sub(b, a), sub(c, a)));
    let longest = length(sub(b, a))
        .max(length(sub(c, b)))
        .max(length(sub(a, c)));
    area.is_nan() || area <= 1e-9 * longest * longest
}

/// Rounds of dropping triangles without area.
const MENDINGS: usize = 4;

/// Drops triangles that have no area in the mesh's own precision, and tells whether there were any;
/// `rounded` is what becomes of a point. Far from the origin it may be all of them.
pub(crate) fn drop_degenerate(
    surface: &mut Surface,
    rounded: impl Fn(Vec3) -> [f32; 3] + Sync,
    execution: &mut Execution,
) -> Result<bool> {
    for mending in 0..MENDINGS {
        let Surface {
            points, triangles, ..
        } = &mut *surface;
        let corner = |p: u32| rounded(points[p as usize]);
        let has_area = |triangle: &[u32; 3]| !is_degenerate(triangle.map(corner));
        if execution.in_pool(|| triangles.par_iter().all(has_area)) {
            return Ok(mending > 0);
        }
        triangles.retain(has_area);
        make_manifold(surface, execution)?;
    }
    Ok(true)
}

/// Turns each connected piece as a whole so that its normals point away from its middle.
pub(crate) fn turn_outward(points: &[Vec3], triangles: &mut [[u32; 3]]) -> Result<()> {
    let mut sets = DisjointSets::new(points.len())?;
    for t in triangles.iter() {
        sets.join(t[0] as usize, t[1] as usize);
        sets.join(t[0] as usize, t[2] as usize);
    }
    let roots = collected(triangles.iter().map(|t| sets.find(t[0] as usize)))?;
    let mut middle: Vec<(Vec3, f64)> = zeros(points.len())?;
    let mut outward: Vec<f64> = zeros(points.len())?;
    let normal_and_centre = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|p| points[p as usize]);
        let centre: Vec3 = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
        (cross(sub(b, a), sub(c, a)), centre)
    };
    for (t, &root) in triangles.iter().zip(&roots) {
        let (normal, centre) = normal_and_centre(t);
        let area = length(normal);
        middle[root].0 = along(middle[root].0, area, centre);
        middle[root].1 += area;
    }
    for (t, &root) in triangles.iter().zip(&roots) {
        let (normal, centre) = normal_and_centre(t);
        let (sum, area) = middle[root];
        outward[root] += dot(normal, sub(centre, sum.map(|v| v / area)));
    }
    for (t, &root) in triangles.iter_mut().zip(&roots) {
        if outward[root] < 0.0 {
            t.swap(1, 2);
        }
    }
    Ok(())
}
