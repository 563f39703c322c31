//! The zipper's triangles → a 2-manifold without terraces, and that in nearly equilateral triangles.
//!
//! The triangles between two lines are as large as the lines' edges and the slices' distance make them:
//! half squares, where a membrane stands upright. What the remesher makes of them lies on the same surface;
//! thickness, label and component of its points and triangles are those of the places they come from.

use std::collections::BTreeMap;

use crate::error::{collected, filled, zeros, Result};
use crate::execution::Execution;
use crate::findings::{self, Findings};
use crate::finish::lattice::planes_across_slices;
use crate::finish::sharp::{self, widen_all};
use crate::finish::terraces::{self, flatten_terraces, LineOfPoint, OnBoundary};
use crate::grid::{along, cross, farthest, last_voxel, length, sub, unit, Grid, Vec3};
use crate::mesh::{drop_degenerate, turn_outward, Mesh};
use crate::remesh::{remesh, Before, Origin};
use crate::surface::halfedge::Fans;
use crate::surface::manifold::{self, make_manifold, Surface};
use crate::surface::normals::{normals, NORMAL_PASSES};
use crate::zipper::flips::flip_edges;
use crate::zipper::polylines::Polylines;
use crate::zipper::zip::{self, zip, Zipped};

/// Passes over the zipper's triangles until they are a mesh.
pub(crate) const PASSES: usize =
    2 + manifold::PASSES + 2 * NORMAL_PASSES + terraces::OF_LINES.passes();
/// Shares of what comes after the lines that zipping takes, and that zipping and remeshing take.
pub(crate) const ZIPPED: f64 = 0.3;
const REMESHED: f64 = 0.97;
/// Passes over a remeshed surface until it is a mesh.
const LAST_PASSES: usize = sharp::PASSES + NORMAL_PASSES;

/// Zips lines and makes the surface between them. Takes the share `until` of what is left of the progress.
pub(crate) fn zipped_surface(
    polylines: &Polylines,
    findings: &mut Findings,
    until: f64,
    execution: &mut Execution,
) -> Result<ZippedSurface> {
    let polylines = &*polylines.without_repeats()?;
    execution.stage("Zipping polylines", 0.0, 0.6 * until, zip::PASSES)?;
    let triangles = zip(polylines, execution)?;
    execution.stage("Making the mesh", 0.6 * until, until, PASSES)?;
    findings.lines = polylines.lines.len();
    findings.triangles = triangles.len();
    if let Some(([a, b, _], _)) = triangles.first() {
        let [a, b] = [a, b].map(|&p| polylines.points[p as usize]);
        let edge = length(sub(a, b));
        findings.is_far = findings::is_far(farthest(&polylines.points), edge);
    }
    ZippedSurface::new(polylines, triangles, execution)
}

/// The surface between lines, before its coordinates are rounded to the mesh's.
pub(crate) struct ZippedSurface {
    /// World coordinates.
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Of each point, world units.
    thickness: Vec<f32>,
    /// Of each triangle.
    labels: Vec<i64>,
    components: Vec<u32>,
}

impl ZippedSurface {
    /// Makes a surface of the zipper's triangles.
    fn new(polylines: &Polylines, zipped: Vec<Zipped>, execution: &mut Execution) -> Result<Self> {
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
        let planes = planes_across_slices(polylines.voxel_steps);
        flatten_terraces(
            &mut surface.points,
            (&surface.triangles, &fans),
            &rough,
            &lines,
            (terraces::OF_LINES, &planes),
            execution,
        )?;
        drop_degenerate(&mut surface, |p| p.map(|v| v as f32), execution)?;
        let line_of = line_of_points(polylines)?;
        let line = |t: &[u32; 3]| &polylines.lines[line_of[surface.source[t[0] as usize] as usize]];
        let labels = collected(surface.triangles.iter().map(|t| line(t).label))?;
        let components = collected(surface.triangles.iter().map(|t| line(t).component))?;
        let surface = surface.compact()?;
        let thickness = surface.source.iter();
        Ok(Self {
            thickness: collected(thickness.map(|&p| polylines.thickness[p as usize]))?,
            points: surface.points,
            triangles: surface.triangles,
            labels,
            components,
        })
    }

    /// The same surface in nearly equilateral triangles, as a mesh; edges are `wanted` long, work units.
    pub fn remeshed(self, grid: &Grid, wanted: f64, execution: &mut Execution) -> Result<Mesh> {
        execution.stage("Remeshing", ZIPPED, REMESHED, 1)?;
        let points = collected(self.points.iter().copied().map(grid.world_to_work()))?;
        let remeshed = remesh(&points, &self.triangles, (wanted, Before::Rows), execution)?;
        drop(points);
        execution.stage("Finishing the mesh", REMESHED, 1.0, LAST_PASSES)?;
        let mut surface = Surface {
            source: collected(0..remeshed.points.len() as u32)?,
            points: remeshed.points,
            triangles: remeshed.triangles,
        };
        let fans = Fans::new(&surface.triangles, surface.points.len())?;
        let last = last_voxel(grid.dimensions, grid.work_spacing());
        widen_all(&mut surface, &fans, last, execution)?;
        grid.keep_within(&mut surface.points);
        drop_degenerate(&mut surface, grid.in_mesh(), execution)?;
        let surface = surface.compact()?;
        self.in_triangles_of(surface, &remeshed.origin, grid)?
            .into_mesh(execution)
    }

    /// What is known of the surface, on a remeshed one; a point's source is its number in `origin`.
    fn in_triangles_of(self, surface: Surface, origin: &[Origin], grid: &Grid) -> Result<Self> {
        let origin = |point: u32| origin[surface.source[point as usize] as usize];
        let thickness = |Origin { triangle, weights }: Origin| -> f32 {
            let corners = self.triangles[triangle as usize].iter().zip(weights);
            corners.map(|(&p, w)| w * self.thickness[p as usize]).sum()
        };
        let places = || {
            let first_corners = surface.triangles.iter().map(|t| t[0]);
            first_corners.map(|p| origin(p).triangle as usize)
        };
        let count = surface.points.len() as u32;
        Ok(Self {
            labels: collected(places().map(|triangle| self.labels[triangle]))?,
            components: collected(places().map(|triangle| self.components[triangle]))?,
            thickness: collected((0..count).map(|p| thickness(origin(p))))?,
            points: collected(surface.points.into_iter().map(grid.work_to_world()))?,
            triangles: surface.triangles,
        })
    }

    /// The surface as a mesh.
    pub fn into_mesh(self, execution: &mut Execution) -> Result<Mesh> {
        let fans = Fans::new(&self.triangles, self.points.len())?;
        let normals = normals(&self.points, &self.triangles, &fans, execution)?;
        Ok(Mesh {
            points: collected(self.points.iter().map(|p| p.map(|v| v as f32)))?,
            triangles: self.triangles,
            normals: collected(normals.iter().map(|n| n.map(|v| v as f32)))?,
            thickness: self.thickness,
            labels: self.labels,
            components: self.components,
        })
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::Findings;
    use crate::remesh::wanted_edge;
    use crate::{extract, mid_polylines, Method, Options, Quiet, Volume};

    /// A tube, and a sheet that leans.
    fn labels([x, y, z]: [usize; 3]) -> Vec<u8> {
        let voxels = (0..x * y * z).map(|i| [i % x, i / x % y, i / (x * y)].map(|v| v as f64));
        let label = |[x, y, z]: Vec3| {
            let from_axis = ((x - 15.3).powi(2) + (y - 15.8).powi(2)).sqrt();
            let from_sheet = x - 40.0 + 0.3 * (y + z);
            u8::from((from_axis - 10.0).abs() < 2.0) + 2 * u8::from(from_sheet.abs() < 2.0)
        };
        voxels.map(label).collect()
    }

    #[test]
    fn the_one_call_gives_the_chains_surface_remeshed() {
        let mut grid = Grid::new([48, 32, 16]);
        (grid.spacing, grid.origin) = ([0.7, 0.7, 1.3], [-31.7, 1e4, 0.3]);
        let labels = labels(grid.dimensions);
        let volume = Volume::new(&labels, grid.clone()).unwrap();
        for edge_length in [0.0, 2.1] {
            let options = Options {
                method: Method::PolylineZipper,
                edge_length,
                ..Options::default()
            };
            let whole = extract(&volume, &options, &mut Quiet::default()).unwrap();
            let lines = mid_polylines(&volume, &options, &mut Quiet::default()).unwrap();
            let mut quiet = Quiet::default();
            let mut execution = Execution::new(1, &mut quiet).unwrap();
            let surface =
                zipped_surface(&lines, &mut Findings::default(), 1.0, &mut execution).unwrap();
            let wanted = wanted_edge(edge_length, &grid);
            assert!(whole.triangles.len() > 500);
            assert!(whole == surface.remeshed(&grid, wanted, &mut execution).unwrap());
        }
    }
}
