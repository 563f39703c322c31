//! Where the voxels lie: the image's frame, and the frame the work is done in.
//!
//! Three frames are in use. *Voxel*: integer index along x, y, z from the first voxel of the
//! buffer. *Work*: voxel index times normalised spacing, in units of the finest spacing, so that
//! the same voxels in other units give the same numbers. *World*: the user's coordinates,
//! `origin + direction · (spacing ∘ (extent_start + voxel))`.

use crate::error::{Error, Result};

/// A point or vector, x, y, z.
pub type Vec3 = [f64; 3];

/// The geometry of a regular volume. All arrays are in the order x, y, z.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Number of voxels along each axis.
    pub dimensions: [usize; 3],
    /// Index of the first voxel in the image's extent (0 for most images).
    pub extent_start: [i64; 3],
    /// Distance between voxel centres along each axis, world units.
    pub spacing: Vec3,
    /// World coordinates of the voxel with extent index (0, 0, 0).
    pub origin: Vec3,
    /// Row-major 3×3 matrix whose columns are the image axes in world coordinates.
    pub direction: [Vec3; 3],
}

impl Grid {
    /// A grid at the origin with spacing 1, axes along the world's.
    pub fn new(dimensions: [usize; 3]) -> Self {
        Self {
            dimensions,
            extent_start: [0; 3],
            spacing: [1.0; 3],
            origin: [0.0; 3],
            direction: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }

    /// Checks that every figure is usable, and that the voxels can be counted.
    pub fn check(&self) -> Result<()> {
        self.voxel_count()?;
        if !self.spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
            return Err(Error::Spacing(self.spacing));
        }
        if !self.origin.iter().all(|v| v.is_finite()) {
            return Err(Error::Placement("origin"));
        }
        let d = &self.direction;
        let determinant = dot(d[0], cross(d[1], d[2]));
        if !(determinant.is_finite() && determinant.abs() > 1e-9) {
            return Err(Error::Placement("direction"));
        }
        Ok(())
    }

    /// The spacing that is meant where z is stretched by a known defect of MRC files: without the
    /// number of slices in its header (mz = 1), readers take the height of the whole volume for
    /// the height of a voxel. `None` where the spacing does not look like that.
    ///
    /// `dimensions` are those of the whole image, of which the volume at hand may be a piece. A
    /// few thick slices may well be as many times thicker as there are slices: only images well
    /// above one voxel along each axis are judged.
    pub fn unstretched_spacing(dimensions: [usize; 3], spacing: Vec3) -> Option<Vec3> {
        const FEWEST_VOXELS: usize = 16;
        // A cell's edges are written with about five digits.
        let is_close = |a: f64, b: f64| (a - b).abs() <= 1e-4 * b.abs();
        let [x, y, z] = spacing;
        let is_stretched = dimensions.iter().all(|&n| n >= FEWEST_VOXELS)
            && is_close(y, x)
            && is_close(z, dimensions[2] as f64 * x)
            && x > 0.0;
        is_stretched.then_some([x, y, x])
    }

    /// Number of voxels, or an error where it does not fit into an index.
    pub fn voxel_count(&self) -> Result<usize> {
        let [x, y, z] = self.dimensions;
        x.checked_mul(y)
            .and_then(|n| n.checked_mul(z))
            .filter(|&n| n < isize::MAX as usize)
            .filter(|_| [x, y, z].iter().all(|&n| n < u32::MAX as usize / 2))
            .ok_or(Error::Dimensions(self.dimensions))
    }

    /// The finest spacing, world units: the length of one work unit.
    pub fn unit(&self) -> f64 {
        self.spacing.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Spacing in work units. Rounded to nine digits, so that a change of units, which may cost a
    /// last bit, cannot change a decision further down.
    pub fn work_spacing(&self) -> Vec3 {
        let unit = self.unit();
        self.spacing.map(|s| to_nine_digits(s / unit))
    }

    /// Whether the image's axes are a mirror image of the world's.
    pub(crate) fn is_mirrored(&self) -> bool {
        let d = &self.direction;
        dot(d[0], cross(d[1], d[2])) < 0.0
    }

    /// World direction of a unit vector of the work frame.
    pub(crate) fn direction_of(&self, v: Vec3) -> Vec3 {
        self.direction.map(|row| dot(row, v))
    }

    /// Row-major matrix whose columns are the steps from voxel to voxel, world units.
    pub(crate) fn voxel_steps(&self) -> [Vec3; 3] {
        self.direction
            .map(|row| std::array::from_fn(|a| row[a] * self.spacing[a]))
    }

    /// World coordinates of the voxels at the volume's corners.
    pub(crate) fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|corner| {
            self.world(std::array::from_fn(|axis| {
                let last = self.dimensions[axis] as f64 - 1.0;
                last * (corner >> axis & 1) as f64
            }))
        })
    }

    /// World coordinates of a point given as a continuous voxel index.
    pub fn world(&self, voxel: Vec3) -> Vec3 {
        let local: Vec3 =
            std::array::from_fn(|a| self.spacing[a] * (self.extent_start[a] as f64 + voxel[a]));
        std::array::from_fn(|r| self.origin[r] + dot(self.direction[r], local))
    }

    /// World coordinates of a point of the work frame.
    pub(crate) fn work_to_world(&self) -> impl Fn(Vec3) -> Vec3 + Sync + '_ {
        let h = self.work_spacing();
        move |p| self.world(std::array::from_fn(|a| p[a] / h[a]))
    }

    /// What becomes of a point of the work frame in the mesh.
    pub(crate) fn in_mesh(&self) -> impl Fn(Vec3) -> [f32; 3] + Sync + '_ {
        let to_world = self.work_to_world();
        move |p| to_world(p).map(|v| v as f32)
    }

    /// Puts points that were moved beyond the border of the volume back onto it.
    pub(crate) fn keep_within(&self, points: &mut [Vec3]) {
        let last = last_voxel(self.dimensions, self.work_spacing());
        for p in points {
            *p = std::array::from_fn(|a| p[a].clamp(0.0, last[a]));
        }
    }

    /// Work coordinates of a point of the world. Rounded to nine digits, so that the same voxels elsewhere,
    /// which may cost a last bit, cannot change a decision further down.
    pub(crate) fn world_to_work(&self) -> impl Fn(Vec3) -> Vec3 + Sync + '_ {
        let h = self.work_spacing();
        let steps = self.voxel_steps();
        let [x, y, z]: [Vec3; 3] = std::array::from_fn(|a| steps.map(|row| row[a]));
        let across = [cross(y, z), cross(z, x), cross(x, y)];
        let volume = dot(x, across[0]);
        move |p| {
            let from_origin = sub(p, self.origin);
            std::array::from_fn(|a| {
                let index = dot(across[a], from_origin) / volume;
                to_nine_digits(h[a] * (index - self.extent_start[a] as f64))
            })
        }
    }
}

fn to_nine_digits(v: f64) -> f64 {
    (v * 1e9).round() / 1e9
}

/// The last voxel of a volume, whose first one is the origin, in units of `h`.
pub(crate) fn last_voxel(dimensions: [usize; 3], h: Vec3) -> Vec3 {
    let last = |a: usize| (dimensions[a] - 1) as f64 * h[a];
    [last(0), last(1), last(2)]
}

/// Whether a point lies on the border of a volume with this last voxel, or beyond it, for each axis.
pub(crate) fn on_border(p: Vec3, last: Vec3) -> [bool; 3] {
    std::array::from_fn(|a| p[a] <= 0.0 || p[a] >= last[a])
}

/// The largest coordinate of all points, whichever its sign.
pub(crate) fn farthest(points: &[Vec3]) -> f64 {
    let coordinates = points.iter().flatten();
    coordinates.fold(0.0, |far, v| far.max(v.abs()))
}

/// ⌊v⌋ by a cast: on processors without an instruction for it `f64::floor` is a call.
#[inline(always)]
pub(crate) fn floor(v: f64) -> isize {
    let towards_zero = v as isize;
    towards_zero - isize::from((towards_zero as f64) > v)
}

/// The nearest whole number, halves away from zero, as [`f64::round`] has it but without a call.
#[inline(always)]
pub(crate) fn round(v: f64) -> isize {
    let towards_zero = v as isize;
    let rest = v - towards_zero as f64;
    towards_zero + isize::from(rest >= 0.5) - isize::from(rest <= -0.5)
}

/// a · b.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// a − b.
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + t b.
pub fn along(a: Vec3, t: f64, b: Vec3) -> Vec3 {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

/// Length of a.
pub fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// Squared distance between two points.
pub fn squared_distance(a: Vec3, b: Vec3) -> f64 {
    let d = sub(a, b);
    dot(d, d)
}

/// a scaled to length 1; zero stays zero.
pub fn unit(a: Vec3) -> Vec3 {
    let l = length(a);
    if l > 0.0 {
        a.map(|v| v / l)
    } else {
        a
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_those_of_the_standard_library() {
        let halves = (-9..10).map(|i| 0.5 * f64::from(i));
        let near =
            halves.flat_map(|v: f64| [v * (1.0 - f64::EPSILON), v, v * (1.0 + f64::EPSILON)]);
        for v in near.chain([0.0, -0.0, 1e9 + 0.25, -1e9 - 0.75]) {
            assert_eq!(floor(v), v.floor() as isize, "{v}");
            assert_eq!(round(v), v.round() as isize, "{v}");
        }
    }

    #[test]
    fn a_stretched_z_is_told_from_thick_slices() {
        let meant = Grid::unstretched_spacing;
        // Spacing and size of a widely used example.
        let found = meant([928, 960, 312], [12.44, 12.44, 3881.28]);
        assert_eq!(found, Some([12.44, 12.44, 12.44]));
        // Single precision, as the header has it, and edges rounded to a decimal.
        let single = [12.44f32, 12.44, 3881.28].map(f64::from);
        assert!(meant([928, 960, 312], single).is_some());
        assert!(meant([928, 960, 312], [12.44, 12.44, 3881.3]).is_some());

        for (dimensions, spacing) in [
            ([928, 960, 312], [1.0, 1.0, 1.0]),
            ([928, 960, 312], [12.44, 12.44, 12.44]),
            ([928, 960, 311], [12.44, 12.44, 3881.28]),
            ([928, 960, 312], [12.44, 6.22, 3881.28]),
            ([928, 960, 1], [1.0, 1.0, 1.0]),
            ([928, 960, 10], [4.0, 4.0, 40.0]),
            ([8, 960, 312], [1.0, 1.0, 312.0]),
            ([928, 960, 312], [0.0, 0.0, 0.0]),
            ([928, 960, 312], [-1.0, -1.0, -312.0]),
            ([928, 960, 312], [f64::NAN; 3]),
        ] {
            assert_eq!(
                meant(dimensions, spacing),
                None,
                "{dimensions:?} {spacing:?}"
            );
        }
    }
}
