//! How well a mesh matches the mid-surface it should be.

use std::collections::HashMap;
use std::fmt;

use crate::phantom::Phantom;
use crate::topology::{connectivity, Connectivity};
use crate::vector::{add, cross, dot, length, scale, sub, Vec3};

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
    /// Mean signed distance of the mesh to the truth, positive on the side of its normal: a bias.
    pub mean_signed: f64,
    /// Share of the truth, 0 to 1, that lies within 1 voxel of the mesh.
    pub covered_within_1: f64,
    /// Topology and faults of the connectivity.
    pub connectivity: Connectivity,
    /// Triangles with a repeated vertex, a point that is no number, or no area.
    pub degenerate: usize,
    /// Mean of 6/√3 · area / (half perimeter · longest edge): 1 for equilateral triangles.
    pub quality_mean: f64,
    /// Mean of each triangle's smallest angle, degrees.
    pub smallest_angle_mean: f64,
}

impl Report {
    /// Whether the mesh is a consistently wound 2-manifold with boundary, without waste.
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
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let c = &self.connectivity;
        write!(
            f,
            "{:6} points {:6} triangles, rms {:.3} max {:.2} bias {:+.3}, covered {:6.2} %, \
             {} components, Euler {}, {} loops, Q {:.3}, angle {:.1}",
            self.points,
            self.triangles,
            self.rms,
            self.max_error,
            self.mean_signed,
            100.0 * self.covered_within_1,
            c.topology.components,
            c.topology.euler,
            c.topology.boundary_loops,
            self.quality_mean,
            self.smallest_angle_mean,
        )?;
        for (count, fault) in [
            (c.nonmanifold_edges, "non-manifold edges"),
            (c.pinched_vertices, "pinched vertices"),
            (c.misoriented_edges, "misoriented edges"),
            (c.duplicate_triangles, "duplicate triangles"),
            (c.unused_points, "unused points"),
            (self.degenerate, "degenerate triangles"),
        ] {
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
    let corners: Vec<[Vec3; 3]> = triangles
        .iter()
        .map(|t| t.map(|v| points[v as usize].map(f64::from)))
        .collect();
    let (sound, degenerate): (Vec<_>, Vec<_>) = corners
        .iter()
        .copied()
        .partition(|t| area(t) > 1e-9 * unit * unit);
    let accuracy = accuracy(&sound, phantom);
    Report {
        points: points.len(),
        triangles: triangles.len(),
        rms: accuracy.rms,
        max_error: accuracy.max,
        mean_signed: accuracy.mean_signed,
        covered_within_1: coverage(&sound, phantom),
        connectivity: connectivity(points.len(), triangles),
        degenerate: degenerate.len(),
        quality_mean: mean(sound.iter().map(quality)),
        smallest_angle_mean: mean(sound.iter().map(smallest_angle)),
    }
}

struct Accuracy {
    rms: f64,
    max: f64,
    mean_signed: f64,
}

/// Distances of points spread evenly over each triangle, at least 4 a square voxel, weighted by
/// the area they stand for.
fn accuracy(triangles: &[[Vec3; 3]], phantom: &Phantom) -> Accuracy {
    let unit = phantom.frame.unit();
    let (mut weight, mut squares, mut signed, mut max) = (0.0, 0.0, 0.0, f64::NAN);
    for t in triangles {
        let area = area(t) / (unit * unit);
        let count = (4.0 * area).ceil() as usize;
        let share = area / count as f64;
        for p in spread(t, count) {
            let (closest, _) = phantom.closest(p);
            let distance = closest.distance / unit;
            weight += share;
            squares += share * distance * distance;
            signed += share * closest.offset / unit;
            max = distance.max(max);
        }
    }
    Accuracy {
        rms: (squares / weight).sqrt(),
        max,
        mean_signed: signed / weight,
    }
}

/// `count` points spread over a triangle: the R2 sequence, folded from the unit square.
fn spread(t: &[Vec3; 3], count: usize) -> impl Iterator<Item = Vec3> {
    let (a, ab, ac) = (t[0], sub(t[1], t[0]), sub(t[2], t[0]));
    (0..count).map(move |i| {
        let n = i as f64 + 1.0;
        let (mut u, mut v) = if count == 1 {
            (1.0 / 3.0, 1.0 / 3.0)
        } else {
            ((n * 0.754_877_666_2).fract(), (n * 0.569_840_290_9).fract())
        };
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        add(a, add(scale(u, ab), scale(v, ac)))
    })
}

/// Share of the truth within one voxel of a triangle.
fn coverage(triangles: &[[Vec3; 3]], phantom: &Phantom) -> f64 {
    let reach = phantom.frame.unit();
    let nearby = Nearby::new(triangles, reach);
    let samples = phantom.truth_samples(reach);
    mean(
        samples
            .iter()
            .map(|&p| f64::from(u8::from(nearby.reaches(p)))),
    )
}

/// Triangles by the cells of a grid that they come within `reach` of, so that a query looks into
/// one cell only.
struct Nearby<'a> {
    triangles: &'a [[Vec3; 3]],
    reach: f64,
    cells: HashMap<[i64; 3], Vec<usize>>,
}

impl<'a> Nearby<'a> {
    fn new(triangles: &'a [[Vec3; 3]], reach: f64) -> Self {
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (index, t) in triangles.iter().enumerate() {
            let least = |a: usize| t[0][a].min(t[1][a]).min(t[2][a]) - reach;
            let most = |a: usize| t[0][a].max(t[1][a]).max(t[2][a]) + reach;
            let [x, y, z] = [0, 1, 2].map(|a| cell_of(least(a), reach)..=cell_of(most(a), reach));
            for k in z {
                for j in y.clone() {
                    for i in x.clone() {
                        cells.entry([i, j, k]).or_default().push(index);
                    }
                }
            }
        }
        Self {
            triangles,
            reach,
            cells,
        }
    }

    fn reaches(&self, p: Vec3) -> bool {
        let cell = p.map(|v| cell_of(v, self.reach));
        self.cells.get(&cell).is_some_and(|found| {
            found
                .iter()
                .any(|&t| distance_to_triangle(p, &self.triangles[t]) <= self.reach)
        })
    }
}

fn cell_of(coordinate: f64, side: f64) -> i64 {
    (coordinate / (2.0 * side)).floor() as i64
}

/// Exact distance of a point from a triangle with an area: from its plane where the foot lies
/// inside, else from the nearest edge.
pub fn distance_to_triangle(p: Vec3, t: &[Vec3; 3]) -> f64 {
    let normal = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let inside = (0..3).all(|i| {
        let edge = sub(t[(i + 1) % 3], t[i]);
        dot(cross(edge, sub(p, t[i])), normal) >= 0.0
    });
    if inside {
        return dot(sub(p, t[0]), normal).abs() / length(normal);
    }
    (0..3)
        .map(|i| distance_to_segment(p, t[i], t[(i + 1) % 3]))
        .fold(f64::INFINITY, f64::min)
}

fn distance_to_segment(p: Vec3, a: Vec3, b: Vec3) -> f64 {
    let (ap, ab) = (sub(p, a), sub(b, a));
    let t = (dot(ap, ab) / dot(ab, ab)).clamp(0.0, 1.0);
    length(sub(ap, scale(t, ab)))
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v, count + 1));
    sum / f64::from(count)
}

fn area(t: &[Vec3; 3]) -> f64 {
    0.5 * length(cross(sub(t[1], t[0]), sub(t[2], t[0])))
}

fn sides(t: &[Vec3; 3]) -> [f64; 3] {
    let mut sides = [0, 1, 2].map(|i| length(sub(t[(i + 1) % 3], t[i])));
    sides.sort_by(f64::total_cmp);
    sides
}

fn quality(t: &[Vec3; 3]) -> f64 {
    let [a, b, c] = sides(t);
    6.0 / 3f64.sqrt() * area(t) / (0.5 * (a + b + c) * c)
}

fn smallest_angle(t: &[Vec3; 3]) -> f64 {
    let [a, b, c] = sides(t);
    ((b * b + c * c - a * a) / (2.0 * b * c))
        .clamp(-1.0, 1.0)
        .acos()
        .to_degrees()
}
