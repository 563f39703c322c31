//! The figures a mesh is judged by (MidSurfer, section "Mesh quality").

use crate::error::{extend, zeros, Result};
use crate::grid::{cross, dot, length, sub, unit, Vec3};
use crate::mesh::Mesh;
use crate::processes::exchange::taken;
use crate::statistics::exact_sum::ExactSum;
use crate::surface::halfedge::Edges;

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
        let mut valences = Valences::new(self.points.len())?;
        for (a, b, group) in edges.groups() {
            valences.add([a, b].map(|p| p as usize), group.len());
        }
        let mut interior = Interior::default();
        (0..self.points.len()).for_each(|p| interior.add_point(&valences, p));
        Ok(ShapeSums::of(corners).quality(&interior))
    }
}

/// What triangles add up to for [`Quality`], whatever their order, to the bit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShapeSums {
    pub triangles: usize,
    area: ExactSum,
    smallest: f64,
    q: ExactSum,
    smallest_angle: ExactSum,
    under_30: usize,
    over_120: usize,
}

impl Default for ShapeSums {
    fn default() -> Self {
        Self {
            triangles: 0,
            area: ExactSum::default(),
            smallest: f64::INFINITY,
            q: ExactSum::default(),
            smallest_angle: ExactSum::default(),
            under_30: 0,
            over_120: 0,
        }
    }
}

impl ShapeSums {
    /// Of triangles given by their corners.
    pub fn of(triangles: impl Iterator<Item = [Vec3; 3]>) -> Self {
        let mut sums = Self::default();
        for triangle in triangles {
            let (area, q, angles) = shape(triangle);
            let count = |f: &dyn Fn(f64) -> bool| angles.iter().filter(|&&a| f(a)).count();
            sums.triangles += 1;
            sums.area.add(area);
            sums.smallest = sums.smallest.min(q);
            sums.q.add(q);
            let smallest = angles.iter().copied().fold(f64::INFINITY, f64::min);
            sums.smallest_angle.add(smallest);
            sums.under_30 += count(&|a| a < 30.0);
            sums.over_120 += count(&|a| a > 120.0);
        }
        sums
    }

    /// Adds those of other triangles.
    pub fn add(&mut self, other: &Self) {
        self.triangles += other.triangles;
        self.area.add_sum(&other.area);
        self.smallest = self.smallest.min(other.smallest);
        self.q.add_sum(&other.q);
        self.smallest_angle.add_sum(&other.smallest_angle);
        self.under_30 += other.under_30;
        self.over_120 += other.over_120;
    }

    /// Appends the sums to a message for another process.
    pub fn pack(&self, message: &mut Vec<i64>) -> Result<()> {
        let counts = [self.triangles, self.under_30, self.over_120];
        extend(message, counts.map(|n| n as i64))?;
        extend(message, [self.smallest.to_bits() as i64])?;
        for sum in [&self.area, &self.q, &self.smallest_angle] {
            sum.pack(message)?;
        }
        Ok(())
    }

    /// Takes sums from the beginning of a message.
    pub fn unpack(message: &mut &[i64]) -> Result<Self> {
        let [triangles, under_30, over_120, smallest] = taken(message)?;
        Ok(Self {
            triangles: triangles as usize,
            smallest: f64::from_bits(smallest as u64),
            under_30: under_30 as usize,
            over_120: over_120 as usize,
            area: ExactSum::unpack(message)?,
            q: ExactSum::unpack(message)?,
            smallest_angle: ExactSum::unpack(message)?,
        })
    }

    /// The quality of the triangles, whose points off the boundary are told.
    pub fn quality(&self, interior: &Interior) -> Quality {
        if self.triangles == 0 {
            return Quality::default();
        }
        let triangles = self.triangles as f64;
        Quality {
            area: self.area.value(),
            smallest: self.smallest,
            mean: self.q.value() / triangles,
            mean_smallest_angle: self.smallest_angle.value() / triangles,
            share_under_30: self.under_30 as f64 / (3.0 * triangles),
            share_over_120: self.over_120 as f64 / (3.0 * triangles),
            valence_567: interior.valence_567 as f64 / (interior.points as f64).max(1.0),
        }
    }
}

/// How many edges each point has, and whether one of them is on the boundary.
pub(crate) struct Valences {
    pub edges: Vec<u32>,
    pub on_boundary: Vec<bool>,
}

impl Valences {
    /// Of so many points before there is any edge.
    pub fn new(points: usize) -> Result<Self> {
        Ok(Self {
            edges: zeros(points)?,
            on_boundary: zeros(points)?,
        })
    }

    /// Adds an edge that so many triangles have.
    pub fn add(&mut self, ends: [usize; 2], triangles: usize) {
        for p in ends {
            self.edges[p] += 1;
            self.on_boundary[p] |= triangles == 1;
        }
    }
}

/// Number of points off the boundary, and of those among them that have five to seven edges.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Interior {
    pub points: usize,
    pub valence_567: usize,
}

impl Interior {
    /// Counts a point where it is one.
    pub fn add_point(&mut self, valences: &Valences, p: usize) {
        if !valences.on_boundary[p] {
            self.points += 1;
            self.valence_567 += usize::from((5..=7).contains(&valences.edges[p]));
        }
    }

    /// Adds other points.
    pub fn add(&mut self, other: &Self) {
        self.points += other.points;
        self.valence_567 += other.valence_567;
    }
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
