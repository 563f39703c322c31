//! Rays through the label: where a line from a point leaves it.
//!
//! The label's mask, linear between voxels, falls below one half at a face. Where the outside is far
//! the ray jumps, near it goes in short steps, and the crossing within the last one is found by false
//! position.

use crate::bricks::{BRICK, EDGE, LAYER};
use crate::grid::{along, length, Vec3};
use crate::interpolation::Sampler;

/// Shortest step along the ray, work units.
const STEP: f64 = 0.5;
/// From a voxel's depth to a step that cannot pass a face, work units.
const SHORT_OF_FACE: f64 = 1.5;
/// Rounds of false position (Illinois): a hundredth of a step and better.
const ROUNDS: usize = 3;

/// How a ray through the label ended, after which length, work units.
#[derive(Clone, Copy)]
pub(crate) enum Reach {
    Face(f64),
    Border,
}

/// A ray, in voxels.
pub(crate) struct Ray<'a> {
    distance: &'a Sampler<'a>,
    from: Vec3,
    /// Voxels in a work unit of its length.
    direction: Vec3,
}

impl<'a> Ray<'a> {
    /// A ray from a point in a unit direction, work units, through the label where `distance`, that
    /// to the outside, is positive.
    pub fn new(distance: &'a Sampler<'a>, from: Vec3, direction: Vec3) -> Self {
        let voxels = |v: Vec3| std::array::from_fn(|a| v[a] / distance.h[a]);
        Self {
            distance,
            from: voxels(from),
            direction: voxels(direction),
        }
    }

    /// Follows the ray until the label or the volume ends.
    pub fn reach(&self) -> Reach {
        let most = (2.0 * crate::distance::LARGEST / STEP) as usize;
        let (mut t, mut depth) = (0.0, self.depth(0.0));
        let Some(mut mask) = self.mask(0.0, depth) else {
            return Reach::Border;
        };
        for _ in 0..most {
            if mask < 0.5 {
                break;
            }
            let next = t + (depth - SHORT_OF_FACE).max(STEP);
            depth = self.depth(next);
            let Some(ahead) = self.mask(next, depth) else {
                return Reach::Border;
            };
            if ahead < 0.5 {
                return Reach::Face(self.crossing((t, mask), (next, ahead)));
            }
            (t, mask) = (next, ahead);
        }
        Reach::Face(t)
    }

    /// Where between two lengths, each with the mask there, the label ends.
    fn crossing(&self, mut low: (f64, f64), mut high: (f64, f64)) -> f64 {
        let between = |low: (f64, f64), high: (f64, f64)| {
            let (below, above) = (0.5 - high.1, low.1 - 0.5);
            low.0 + (high.0 - low.0) * above / (above + below)
        };
        let mut was_inside = None;
        for _ in 0..ROUNDS {
            let t = between(low, high);
            let Some(mask) = self.interpolated(t) else {
                break;
            };
            let inside = mask >= 0.5;
            // An end that stays counts half, or the other would creep.
            let stays = was_inside == Some(inside);
            let halved = |mask: f64| if stays { 0.5 * (mask + 0.5) } else { mask };
            if inside {
                (low, high.1) = ((t, mask), halved(high.1));
            } else {
                (high, low.1) = ((t, mask), halved(low.1));
            }
            was_inside = Some(inside);
        }
        between(low, high)
    }

    fn at(&self, t: f64) -> Vec3 {
        along(self.from, t, self.direction)
    }

    /// Distance to the outside at the voxel nearest to the ray, 0 outside the label.
    fn depth(&self, t: f64) -> f64 {
        self.distance.nearest(self.at(t))
    }

    /// The label's mask where the nearest voxel is so deep; `None` outside the volume.
    fn mask(&self, t: f64, depth: f64) -> Option<f64> {
        // The eight voxels around are within a voxel's diagonal of the nearest one.
        if depth > length(self.distance.h) {
            self.is_within_volume(self.at(t)).then_some(1.0)
        } else {
            self.interpolated(t)
        }
    }

    fn is_within_volume(&self, voxel: Vec3) -> bool {
        let dimensions = self.distance.directory.dimensions;
        (0..3).all(|a| voxel[a] >= 0.0 && voxel[a] <= (dimensions[a] - 1) as f64)
    }

    /// The label's mask, linear between voxels; `None` outside the volume.
    fn interpolated(&self, t: f64) -> Option<f64> {
        let voxel = self.at(t);
        if !self.is_within_volume(voxel) {
            return None;
        }
        // None is negative, so that a cast is the floor.
        let low = voxel.map(|v| v as usize);
        let [x, y, z]: Vec3 = std::array::from_fn(|a| voxel[a] - low[a] as f64);
        let m = self.corners(low);
        let between = |t: f64, a: f64, b: f64| a + t * (b - a);
        let along_x = |i: usize| between(x, m[i], m[i + 1]);
        let along_y = |i: usize| between(y, along_x(i), along_x(i + 2));
        Some(between(z, along_y(0), along_y(4)))
    }

    /// The mask at a voxel and those next to it ahead, x fastest.
    fn corners(&self, low: [usize; 3]) -> [f64; 8] {
        let Sampler {
            directory, field, ..
        } = *self.distance;
        let mut mask = [0.0; 8];
        if low.iter().all(|v| v % EDGE + 1 < EDGE) {
            // All eight voxels are in one brick.
            if let Some(first) = directory.entry(low) {
                let field = &field[first..][..LAYER + EDGE + 2];
                for (i, mask) in mask.iter_mut().enumerate() {
                    let offset = (i >> 2) * LAYER + (i >> 1 & 1) * EDGE + (i & 1);
                    *mask = f64::from(u8::from(field[offset] > 0.0));
                }
            }
            return mask;
        }
        // The corners are in up to eight bricks, mostly in two.
        let crosses = low.map(|v| usize::from(v % EDGE + 1 == EDGE));
        let mut bricks = [None; 8];
        for i in 0..8 {
            let corner = [i & 1, i >> 1 & 1, i >> 2];
            let side: [usize; 3] = std::array::from_fn(|a| corner[a] & crosses[a]);
            let first = side[0] | side[1] << 1 | side[2] << 2;
            if i == first {
                bricks[i] = directory.brick(std::array::from_fn(|a| low[a] / EDGE + side[a]));
            }
            if let Some(brick) = bricks[first] {
                let [x, y, z]: [usize; 3] = std::array::from_fn(|a| (low[a] + corner[a]) % EDGE);
                let depth = field[brick * BRICK + z * LAYER + y * EDGE + x];
                mask[i] = f64::from(u8::from(depth > 0.0));
            }
        }
        mask
    }
}
