//! The figures a mesh is judged by (MidSurfer, section "Mesh quality").

use crate::error::{zeros, Result};
use crate::grid::{cross, dot, length, sub, unit, Vec3};
use crate::halfedge::Edges;
use crate::mesh::Mesh;

/// Shape and valence of a mesh's triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Quality {
    /// Area of all triangles, world units squared.
    pub area: f64,
    /// Smallest Q = (6 / √3) · area / (half the perimeter · longest edge); 1 is equilateral.
    pub smallest: f64,
    /// Mean of Q.
    pub mean: f64,
    /// Mean of each triangle's smallest angle, degrees.
    pub mean_smallest_angle: f64,
    /// Share of angles under 30°, of all angles.
    pub share_under_30: f64,
    /// Share of angles over 120°, of all angles.
    pub share_over_120: f64,
    /// Share of the interior points that have five, six or seven edges.
    pub valence_567: f64,
}

impl Mesh {
    /// Shape and valence of the triangles; all zero for an empty mesh.
    ///
    /// # Errors
    /// Where memory is refused.
    pub fn quality(&self) -> Result<Quality> {
        let corners = self
            .triangles
            .iter()
            .map(|t| t.map(|p| self.points[p as usize].map(f64::from)));
        let edges = Edges::new(&self.triangles, self.points.len())?;
        Ok(QualitySums::of(corners, &edges, self.points.len())?.quality())
    }
}

/// What [`Quality`] is made of: figures that add up over the pieces of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct QualitySums {
    triangles: f64,
    area: f64,
    smallest: f64,
    q: f64,
    smallest_angle: f64,
    under_30: f64,
    over_120: f64,
    interior: f64,
    valence_567: f64,
}

impl QualitySums {
    /// Of triangles given by their corners, with the edges of a mesh of `points` points, all in use.
    pub fn of(
        triangles: impl Iterator<Item = [Vec3; 3]>,
        edges: &Edges,
        points: usize,
    ) -> Result<Self> {
        let [interior, valence_567] = valences(edges, points)?;
        let mut sums = Self::from([
            0.0,
            0.0,
            f64::INFINITY,
            0.0,
            0.0,
            0.0,
            0.0,
            interior,
            valence_567,
        ]);
        for triangle in triangles {
            let (area, q, angles) = shape(triangle);
            let count = |f: &dyn Fn(f64) -> bool| angles.iter().filter(|&&a| f(a)).count() as f64;
            sums.triangles += 1.0;
            sums.area += area;
            sums.smallest = sums.smallest.min(q);
            sums.q += q;
            sums.smallest_angle += angles.iter().copied().fold(f64::INFINITY, f64::min);
            sums.under_30 += count(&|a| a < 30.0);
            sums.over_120 += count(&|a| a > 120.0);
        }
        Ok(sums)
    }

    /// The sums of two pieces that share no points.
    pub fn add(&self, other: &Self) -> Self {
        let (a, b) = (self.numbers(), other.numbers());
        let mut sums: [f64; Self::LENGTH] = std::array::from_fn(|i| a[i] + b[i]);
        sums[2] = self.smallest.min(other.smallest);
        Self::from(sums)
    }

    /// How many numbers there are.
    pub const LENGTH: usize = 9;

    pub fn numbers(&self) -> [f64; Self::LENGTH] {
        [
            self.triangles,
            self.area,
            self.smallest,
            self.q,
            self.smallest_angle,
            self.under_30,
            self.over_120,
            self.interior,
            self.valence_567,
        ]
    }

    pub fn quality(&self) -> Quality {
        if self.triangles == 0.0 {
            return Quality::default();
        }
        Quality {
            area: self.area,
            smallest: self.smallest,
            mean: self.q / self.triangles,
            mean_smallest_angle: self.smallest_angle / self.triangles,
            share_under_30: self.under_30 / (3.0 * self.triangles),
            share_over_120: self.over_120 / (3.0 * self.triangles),
            valence_567: self.valence_567 / self.interior.max(1.0),
        }
    }
}

impl From<[f64; QualitySums::LENGTH]> for QualitySums {
    fn from(numbers: [f64; Self::LENGTH]) -> Self {
        let [triangles, area, smallest, q, smallest_angle, under_30, over_120, interior, valence_567] =
            numbers;
        Self {
            triangles,
            area,
            smallest,
            q,
            smallest_angle,
            under_30,
            over_120,
            interior,
            valence_567,
        }
    }
}

/// Number of points off the boundary, and of those among them that have five to seven edges.
fn valences(edges: &Edges, points: usize) -> Result<[f64; 2]> {
    let mut valence: Vec<u32> = zeros(points)?;
    let mut boundary: Vec<bool> = zeros(points)?;
    for (a, b, group) in edges.groups() {
        for p in [a, b] {
            valence[p as usize] += 1;
            boundary[p as usize] |= group.len() == 1;
        }
    }
    let interior = boundary.iter().filter(|b| !**b).count();
    let good = valence
        .iter()
        .zip(&boundary)
        .filter(|(v, b)| !**b && (5..=7).contains(*v));
    Ok([interior as f64, good.count() as f64])
}

/// Area, Q and the angles in degrees.
fn shape([a, b, c]: [Vec3; 3]) -> (f64, f64, [f64; 3]) {
    let area = 0.5 * length(cross(sub(b, a), sub(c, a)));
    let sides = [length(sub(c, b)), length(sub(a, c)), length(sub(b, a))];
    let half = 0.5 * sides.iter().sum::<f64>();
    let longest = sides.iter().copied().fold(0.0, f64::max);
    let q = if longest > 0.0 {
        6.0 / 3f64.sqrt() * area / (half * longest)
    } else {
        0.0
    };
    let angle = |p: Vec3, q: Vec3, r: Vec3| {
        dot(unit(sub(q, p)), unit(sub(r, p)))
            .clamp(-1.0, 1.0)
            .acos()
            .to_degrees()
    };
    (area, q, [angle(a, b, c), angle(b, c, a), angle(c, a, b)])
}
