//! The result: a triangle mesh, and the invariants it keeps.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::components::DisjointSets;
use crate::error::{check_count, collected, extend, filled, push, reserved, zeros, Error, Result};
use crate::execution::Execution;
use crate::flips::flip_edges;
use crate::grid::{along, cross, dot, length, sub, unit, Vec3};
use crate::halfedge::{Edges, Fans, NONE};
use crate::lattice::planes_across_slices;
use crate::manifold::{self, make_manifold, Surface};
use crate::normals::{normals, NORMAL_PASSES};
use crate::polylines::Polylines;
use crate::terraces::{self, flatten_terraces, LineOfPoint, OnBoundary};
use crate::zipper::Zipped;

/// Passes over the mesh that [`Mesh::assemble`] makes, for its progress.
pub(crate) const PASSES: usize =
    2 + manifold::PASSES + 2 * NORMAL_PASSES + terraces::OF_LINES.passes();

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

    /// Builds the mesh from the zipper's triangles.
    pub(crate) fn assemble(
        polylines: &Polylines,
        zipped: Vec<Zipped>,
        execution: &mut Execution,
    ) -> Result<Self> {
        let mut surface = Surface {
            points: collected(polylines.points.iter().copied())?,
            source: collected(0..polylines.points.len() as u32)?,
            triangles: collected(zipped.iter().map(|z| z.0))?,
        };
        make_manifold(&mut surface, execution)?;
        flip_edges(&surface.points, &mut surface.triangles)?;
        execution.pass_done()?;
        turn_outward(&surface.points, &mut surface.triangles)?;
        execution.pass_done()?;
        let fans = Fans::new(&surface.triangles, surface.points.len())?;
        let rough = normals(&surface.points, &surface.triangles, &fans, execution)?;
        let lines = lines_of_points(polylines, &surface.source)?;
        flatten_terraces(
            &mut surface.points,
            (&surface.triangles, &fans),
            &rough,
            &lines,
            (
                terraces::OF_LINES,
                &planes_across_slices(polylines.voxel_steps),
            ),
            execution,
        )?;
        let fans = match drop_degenerate(&mut surface, |p| p.map(|v| v as f32), execution)? {
            true => Fans::new(&surface.triangles, surface.points.len())?,
            false => fans,
        };
        let line_of = line_of_points(polylines)?;
        let line = |t: &[u32; 3]| &polylines.lines[line_of[surface.source[t[0] as usize] as usize]];
        let mut mesh = Self {
            labels: collected(surface.triangles.iter().map(|t| line(t).label))?,
            components: collected(surface.triangles.iter().map(|t| line(t).component))?,
            ..Self::default()
        };
        let normals = normals(&surface.points, &surface.triangles, &fans, execution)?;
        // Number of each point in the mesh plus one; 0 for points that no triangle uses.
        let mut number: Vec<u32> = zeros(surface.points.len())?;
        mesh.triangles = reserved(surface.triangles.len())?;
        for triangle in &surface.triangles {
            for p in triangle.map(|p| p as usize) {
                if number[p] == 0 {
                    push(&mut mesh.points, surface.points[p].map(|v| v as f32))?;
                    push(&mut mesh.normals, normals[p].map(|v| v as f32))?;
                    let thickness = polylines.thickness[surface.source[p] as usize];
                    push(&mut mesh.thickness, thickness)?;
                    number[p] = mesh.points.len() as u32;
                }
            }
            mesh.triangles
                .push(triangle.map(|p| number[p as usize] - 1));
        }
        Ok(mesh)
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
                    let [p, q] = [e, f].map(|h| crate::halfedge::ends(&self.triangles, *h));
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
                fans.join(e as usize, crate::halfedge::next(twin) as usize);
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

/// The line each point of the polylines is on.
fn line_of_points(polylines: &Polylines) -> Result<Vec<usize>> {
    let mut line_of = zeros(polylines.points.len())?;
    for (i, line) in polylines.lines.iter().enumerate() {
        line_of[line.first..line.first + line.count].fill(i);
    }
    Ok(line_of)
}

/// What the low-pass asks about the lines of the points, which are copies of `source`.
fn lines_of_points(polylines: &Polylines, source: &[u32]) -> Result<Vec<LineOfPoint>> {
    let mut known = filled(LineOfPoint::default(), polylines.points.len())?;
    let mut slices: BTreeMap<u32, [i64; 2]> = BTreeMap::new();
    for line in &polylines.lines {
        let ends = slices.entry(line.component).or_insert([line.slice; 2]);
        *ends = [ends[0].min(line.slice), ends[1].max(line.slice)];
    }
    for (i, line) in polylines.lines.iter().enumerate() {
        let range = line.first..line.first + line.count;
        let points = &polylines.points[range.clone()];
        let edge = polylines.mean_edge(i..i + 1);
        let across = unit(area(points));
        let on_boundary = if line.closed && across != [0.0; 3] {
            OnBoundary::Within(across)
        } else {
            // The end of an open line may lie on the border of the volume.
            OnBoundary::Stays
        };
        for p in range {
            known[p] = LineOfPoint {
                edge,
                on_boundary,
                room: polylines.border_distance[p].into(),
                at_end: slices[&line.component].contains(&line.slice),
            };
        }
    }
    collected(source.iter().map(|&p| known[p as usize]))
}

/// Twice the area of a closed line, as a vector across its plane (Newell).
fn area(points: &[Vec3]) -> Vec3 {
    let around = points.iter().zip(points.iter().cycle().skip(1));
    around.fold([0.0; 3], |sum, (p, q)| {
        along(sum, 1.0, cross(sub(*p, points[0]), sub(*q, points[0])))
    })
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
