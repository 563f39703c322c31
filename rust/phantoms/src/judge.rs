//! How well a mesh matches the mid-surface it should be.

use std::fmt;

use crate::accuracy::{accuracy, coverage};
use crate::intersections::self_intersections;
use crate::junction::widest_gap;
use crate::phantom::Phantom;
use crate::topology::{closed_inward, connectivity, Connectivity};
use crate::triangle_shape::{area, shapes};
use crate::vector::Vec3;

/// What the judge found. Lengths are in voxels: the finest spacing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Number of points.
    pub points: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Root mean square distance of the mesh to the truth, over its area. NaN for an empty mesh.
    pub rms: f64,
    /// Largest distance of the mesh to the truth.
    pub max_error: f64,
    /// As `rms`, but only farther than [`crate::INSIDE`] from rims and the border.
    pub rms_inside: f64,
    /// As `max_error`, but only farther than [`crate::INSIDE`] from rims and the border.
    pub max_inside: f64,
    /// Mean signed distance of the mesh to the truth, positive on the side of its normal: a bias.
    pub mean_signed: f64,
    /// Mean angle between the triangles' normals and the true normal, degrees, sign ignored.
    pub normal_error: f64,
    /// Area farther than 1 voxel from the truth, square voxels: walls that should not be there.
    pub stray_area: f64,
    /// Share of the truth, 0 to 1, that lies within 1 voxel of the mesh.
    pub covered_within_1: f64,
    /// Share of the truth, 0 to 1, that lies within 0.6 voxel of the mesh.
    pub covered_within_06: f64,
    /// Distance of the point of the truth that is farthest from the mesh; infinite for no mesh.
    pub farthest: f64,
    /// Widest gap between a junction's line and one of its sheets; `None` without a junction.
    pub junction_gap: Option<f64>,
    /// Topology and faults of the connectivity.
    pub connectivity: Connectivity,
    /// Pairs of triangles that run into each other.
    pub self_intersections: usize,
    /// Closed components whose normals point inward.
    pub closed_inward: usize,
    /// Triangles with a repeated vertex, a point that is no number, or no area.
    pub degenerate: usize,
    /// Mean edge length.
    pub edge_mean: f64,
    /// Smallest 6/√3 · area / (half perimeter · longest edge).
    pub quality_least: f64,
    /// Mean of 6/√3 · area / (half perimeter · longest edge): 1 for equilateral triangles.
    pub quality_mean: f64,
    /// Mean of each triangle's smallest angle, degrees.
    pub smallest_angle_mean: f64,
    /// Smallest angle anywhere, degrees.
    pub smallest_angle: f64,
    /// Number of angles under 25°.
    pub angles_under_25: usize,
    /// Number of angles under 30°.
    pub angles_under_30: usize,
    /// Number of angles over 120°.
    pub angles_over_120: usize,
}

impl Report {
    /// Whether the mesh is a consistently wound 2-manifold with boundary, without waste. It may run
    /// into itself.
    pub fn is_clean(&self) -> bool {
        let c = &self.connectivity;
        let faults = c.nonmanifold_edges
            + c.pinched_vertices
            + c.misoriented_edges
            + c.duplicate_triangles
            + c.unused_points
            + self.degenerate;
        faults == 0
    }

    /// What no mesh may have, and how often this one has it.
    pub fn faults(&self) -> [(usize, &'static str); 8] {
        let c = &self.connectivity;
        [
            (c.nonmanifold_edges, "non-manifold edges"),
            (c.pinched_vertices, "pinched vertices"),
            (c.misoriented_edges, "misoriented edges"),
            (c.duplicate_triangles, "duplicate triangles"),
            (c.unused_points, "unused points"),
            (self.degenerate, "degenerate triangles"),
            (self.self_intersections, "self-intersections"),
            (self.closed_inward, "closed components wound inward"),
        ]
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let c = &self.connectivity;
        write!(
            f,
            "{:6} triangles, rms {:.3} max {:.2} (inside {:.3} {:.2}) bias {:+.3} normals {:.1}°, \
             covered {:.2}/{:.2} % far {:.2}, {} components Euler {} loops {}, \
             Q {:.3} min {:.2} angle {:.1} min {:.0}, V567 {:.1} V6 {:.0} %",
            self.triangles,
            self.rms,
            self.max_error,
            self.rms_inside,
            self.max_inside,
            self.mean_signed,
            self.normal_error,
            100.0 * self.covered_within_1,
            100.0 * self.covered_within_06,
            self.farthest,
            c.topology.components,
            c.topology.euler,
            c.topology.boundary_loops,
            self.quality_mean,
            self.quality_least,
            self.smallest_angle_mean,
            self.smallest_angle,
            100.0 * c.valence_567,
            100.0 * c.valence_6,
        )?;
        if let Some(gap) = self.junction_gap {
            write!(f, ", gap {gap:.2} stray {:.1}", self.stray_area)?;
        }
        for (count, fault) in self.faults() {
            if count > 0 {
                write!(f, ", {count} {fault}")?;
            }
        }
        Ok(())
    }
}

/// Judges a mesh in world coordinates against the phantom's true mid-surface.
///
/// # Panics
/// Where a triangle names a point that does not exist.
pub fn judge(points: &[[f32; 3]], triangles: &[[u32; 3]], phantom: &Phantom) -> Report {
    let unit = phantom.frame.unit();
    let places: Vec<Vec3> = points.iter().map(|p| p.map(f64::from)).collect();
    let corners = triangles.iter().map(|t| t.map(|v| places[v as usize]));
    let sound: Vec<[Vec3; 3]> = corners.filter(|t| area(t) > 1e-9 * unit * unit).collect();
    let accuracy = accuracy(&sound, phantom);
    let coverage = coverage(&sound, phantom);
    let shapes = shapes(&sound);
    Report {
        points: points.len(),
        triangles: triangles.len(),
        rms: accuracy.rms,
        max_error: accuracy.max_error,
        rms_inside: accuracy.rms_inside,
        max_inside: accuracy.max_inside,
        mean_signed: accuracy.mean_signed,
        normal_error: accuracy.normal_error,
        stray_area: accuracy.stray_area,
        covered_within_1: coverage.within_1,
        covered_within_06: coverage.within_06,
        farthest: coverage.farthest,
        junction_gap: phantom
            .junction
            .as_ref()
            .map(|junction| widest_gap(&sound, junction, &phantom.frame)),
        connectivity: connectivity(points.len(), triangles),
        self_intersections: self_intersections(points, triangles).len(),
        closed_inward: closed_inward(&places, triangles),
        degenerate: triangles.len() - sound.len(),
        edge_mean: shapes.edge_mean / unit,
        quality_least: shapes.quality_least,
        quality_mean: shapes.quality_mean,
        smallest_angle_mean: shapes.smallest_angle_mean,
        smallest_angle: shapes.smallest_angle,
        angles_under_25: shapes.angles_under_25,
        angles_under_30: shapes.angles_under_30,
        angles_over_120: shapes.angles_over_120,
    }
}
