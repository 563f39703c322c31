//! Rays through the label: where a line from a point leaves it.
//!
//! The label's mask, linear between voxels, falls below one half at a face. Where the outside is far
//! the ray jumps, near it goes in short steps, and the crossing within the last one is found by false
//! position.

use crate::fields::bricks::EDGE;
use crate::fields::interpolation::Sampler;
use crate::fields::mask::Mask;
use crate::grid::{along, Vec3};

/// Shortest step along the ray, work units.
const STEP: f64 = 0.75;
/// From a voxel's depth to a step that cannot pass a face, work units.
const SHORT_OF_FACE: f64 = 1.5;
/// From voxels no deeper than this a ray goes on by the shortest step, work units.
pub(crate) const DEEP: f64 = SHORT_OF_FACE + STEP;
/// Rounds of false position (Illinois): a hundredth of a step and better.
const ROUNDS: usize = 3;
/// A mask this near to one half is taken for it: straight through a face, a hundredth of a voxel or two.
const ENOUGH: f64 = 0.01;

/// How a ray through the label ended, after which length, work units.
#[derive(Clone, Copy)]
pub(crate) enum Reach {
    Face(f64),
    Border,
}

/// A label: the distance to the outside, positive within, and the mask of that.
pub(crate) struct Inside<'a> {
    pub distance: Sampler<'a>,
    pub mask: &'a Mask,
}

/// A ray, in voxels.
struct Ray<'a> {
    label: &'a Inside<'a>,
    /// The volume's last voxel along each axis.
    last: Vec3,
    from: Vec3,
    /// Voxels in a work unit of its length.
    direction: Vec3,
}

/// How the rays from a point along a unit normal and against it end, work units.
pub(crate) fn both_ways(label: &Inside, from: Vec3, normal: Vec3) -> [Reach; 2] {
    let ahead = Ray::new(label, from, normal);
    let behind = Ray::new(label, from, normal.map(|v| -v));
    let here = ahead.look(0.0);
    [ahead, behind].map(|ray| ray.reach(here))
}

impl<'a> Ray<'a> {
    /// A ray from a point in a unit direction, work units, through the label.
    fn new(label: &'a Inside<'a>, from: Vec3, direction: Vec3) -> Self {
        let Sampler { directory, h, .. } = label.distance;
        let voxels = |v: Vec3| std::array::from_fn(|a| v[a] / h[a]);
        Self {
            label,
            last: directory.dimensions.map(|count| (count - 1) as f64),
            from: voxels(from),
            direction: voxels(direction),
        }
    }

    /// Follows the ray from `here`, what [`Self::look`] gives there, until the label or the volume ends.
    fn reach(&self, here: Option<(f64, f64)>) -> Reach {
        let most = (2.0 * crate::fields::distance::LARGEST / STEP) as usize;
        let mut t = 0.0;
        let Some((mut mask, mut depth)) = here else {
            return Reach::Border;
        };
        for _ in 0..most {
            if mask < 0.5 {
                break;
            }
            let next = t + (depth - SHORT_OF_FACE).max(STEP);
            let Some((ahead, deep)) = self.look(next) else {
                return Reach::Border;
            };
            if ahead < 0.5 {
                return Reach::Face(self.crossing((t, mask), (next, ahead)));
            }
            (t, mask, depth) = (next, ahead, deep);
        }
        Reach::Face(t)
    }

    /// Where between two lengths, each with the mask there, the label ends.
    fn crossing(&self, mut low: (f64, f64), mut high: (f64, f64)) -> f64 {
        let mut was_inside = None;
        for _ in 0..ROUNDS {
            let t = false_position(low, high);
            let Some((mask, _)) = self.look(t) else {
                break;
            };
            if (mask - 0.5).abs() < ENOUGH {
                return t;
            }
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
        false_position(low, high)
    }

    fn at(&self, t: f64) -> Vec3 {
        along(self.from, t, self.direction)
    }

    fn is_within_volume(&self, voxel: Vec3) -> bool {
        let is_within = |a: usize| voxel[a] >= 0.0 && voxel[a] <= self.last[a];
        is_within(0) && is_within(1) && is_within(2)
    }

    /// The label's mask, linear between voxels, and where that is whole and may be for long, how far
    /// the outside is from the nearest voxel, else 0; `None` outside the volume.
    fn look(&self, t: f64) -> Option<(f64, f64)> {
        let voxel = self.at(t);
        if !self.is_within_volume(voxel) {
            return None;
        }
        // None is negative, so that a cast is the floor.
        let low = [voxel[0] as usize, voxel[1] as usize, voxel[2] as usize];
        let place = [low[0] / EDGE, low[1] / EDGE, low[2] / EDGE];
        let Inside { distance, mask } = self.label;
        let Some(brick) = distance.directory.brick(place) else {
            return Some((0.0, 0.0));
        };
        let within = [low[0] % EDGE, low[1] % EDGE, low[2] % EDGE];
        let corners = mask.corners(brick, within);
        if corners == 0 {
            return Some((0.0, 0.0));
        }
        if corners == u8::MAX {
            let is_deep = mask.is_deep(brick);
            return Some((
                1.0,
                if is_deep {
                    distance.nearest(voxel)
                } else {
                    0.0
                },
            ));
        }
        let [x, y, z] = [0, 1, 2].map(|a| voxel[a] - low[a] as f64);
        let m = |i: usize| f64::from(corners >> i & 1);
        let between = |t: f64, a: f64, b: f64| a + t * (b - a);
        let along_x = |i: usize| between(x, m(i), m(i + 1));
        let along_y = |i: usize| between(y, along_x(i), along_x(i + 2));
        Some((between(z, along_y(0), along_y(4)), 0.0))
    }
}

/// Where between two lengths the mask, at least one half at the first and at most at the second, is
/// one half if it falls evenly.
fn false_position(low: (f64, f64), high: (f64, f64)) -> f64 {
    let (below, above) = (0.5 - high.1, low.1 - 0.5);
    // Both are 0 where the mask is one half to the last bit.
    low.0 + (high.0 - low.0) * above / (above + below).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::false_position;

    #[test]
    fn a_mask_of_one_half_at_both_ends_has_a_crossing() {
        assert_eq!(false_position((1.0, 1.0), (2.0, 0.0)), 1.5);
        assert_eq!(false_position((1.0, 0.5), (2.0, 0.5)), 1.0);
    }
}
