//! Where a border of the volume cuts the profile of a sheet, so that its crest is not midway.

use crate::fields::bricks::{Batch, Directory, EDGE, LAYER};
use crate::grid::{dot, last_voxel, Vec3};

/// The borders as seen from a brick.
pub(crate) struct Border<'a> {
    directory: &'a Directory,
    place: [usize; 3],
    distance: &'a [f32],
    /// How near by a border cuts the profile of a sheet at right angles to it, work units.
    reach: f32,
    h: Vec3,
}

impl<'a> Border<'a> {
    /// `None` where no border is near enough to cut a sheet of the brick.
    pub fn near(
        batch: &'a Batch,
        brick: usize,
        distance: &'a [f32],
        reach: f32,
        h: Vec3,
    ) -> Option<Self> {
        let (directory, place) = batch.brick(brick);
        let last = last_voxel(directory.dimensions, h);
        let is_near = (0..3).any(|a| {
            let first = (place[a] * EDGE) as f64 * h[a];
            first.min(last[a] - first - EDGE as f64 * h[a]) < f64::from(4.0 * reach)
        });
        is_near.then_some(Self {
            directory,
            place,
            distance,
            reach,
            h,
        })
    }

    /// Whether the sheet through voxel i with normal n leaves the volume so near by that the profile
    /// misses a part of it: along a sheet at right angles to the border nothing is missed.
    pub fn cuts(&self, i: usize, n: [f32; 3]) -> bool {
        let Self {
            directory, place, ..
        } = self;
        let n = n.map(f64::from);
        let within = [i % EDGE, i / EDGE % EDGE, i / LAYER];
        let length = dot(n, n).sqrt();
        let n = n.map(|v| v / length.max(1e-12));
        let p: Vec3 = std::array::from_fn(|a| (place[a] * EDGE + within[a]) as f64 * self.h[a]);
        let last = last_voxel(directory.dimensions, self.h);
        (0..3).any(|a| {
            let (to_border, out) = if p[a] < last[a] - p[a] {
                (p[a], -1.0)
            } else {
                (last[a] - p[a], 1.0)
            };
            if to_border >= f64::from(self.reach) * n[a].abs() {
                return false;
            }
            // From here along the sheet to the border: is the label still there?
            let slope = 1.0 - n[a] * n[a];
            let steps = to_border / slope.max(1e-12);
            if steps * slope.sqrt() > 2.0 * f64::from(self.reach) {
                return false;
            }
            let voxel = std::array::from_fn(|b| {
                let along = f64::from(u8::from(a == b)) - n[a] * n[b];
                let at = (p[b] + out * steps * along) / self.h[b];
                at.round().clamp(0.0, directory.dimensions[b] as f64 - 1.0) as usize
            });
            directory
                .entry(voxel)
                .is_some_and(|entry| self.distance[entry] > 0.0)
        })
    }
}
