//! The label as it is seen from a point: the outside, both faces, and the border of the volume.

use crate::fields::bricks::Batch;
use crate::fields::interpolation::Sampler;
use crate::fields::mask::Mask;
use crate::fields::ray::{both_ways, Inside, Reach};
use crate::fields::thickness::View;
use crate::grid::{along, last_voxel, length, on_border, unit, Vec3};

/// A point sees both faces if this much before a ray meets one, work units, the outside is at least
/// this share of that away.
const BEFORE: f64 = 4.0;
const ACROSS: f64 = 0.5;
/// A sheet leaves the volume upright where its normal is parallel to the border but for this cosine.
const UPRIGHT: f64 = 0.95;

/// What is known of the label of a batch.
pub(crate) struct Label<'a> {
    pub batch: &'a Batch<'a>,
    /// Distance to the outside at the voxels, work units.
    pub distance: &'a [f32],
    pub mask: &'a Mask,
    /// The work spacing.
    pub h: Vec3,
}

impl Label<'_> {
    /// The distance to the outside within a part.
    pub fn distance(&self, part: u32) -> Sampler<'_> {
        Sampler {
            directory: &self.batch.directories[part as usize],
            field: self.distance,
            h: self.h,
        }
    }

    /// What a point of a part sees along its normal.
    pub fn view(&self, part: u32, point: Vec3, normal: Vec3) -> View {
        let (distance, mask) = (self.distance(part), self.mask);
        View::new(&Inside { distance, mask }, point, normal)
    }

    /// How far the label's faces are along the normal and against it from a point of a part, infinitely
    /// where the border of the volume comes first; `None` where the wall of a rim does.
    pub fn faces(&self, part: u32, point: Vec3, normal: Vec3) -> Option<[f64; 2]> {
        let (distance, mask) = (self.distance(part), self.mask);
        let label = Inside { distance, mask };
        let face = |direction: Vec3, reach: Reach| match reach {
            Reach::Border => Some(f64::INFINITY),
            Reach::Face(reach) => {
                // Just before a ray meets a face the outside is about as near.
                let before = reach.min(BEFORE);
                let there = along(point, reach - before, direction);
                (label.distance.linear(there) >= ACROSS * before).then_some(reach)
            }
        };
        let both = |way: Vec3| {
            let [ahead, behind] = both_ways(&label, point, way);
            Some([face(way, ahead)?, face(way.map(|v| -v), behind)?])
        };
        let [ahead, behind] = both(normal)?;
        // Hardly leaning, a sheet is as good as across a line within the border.
        let nearest = ahead.min(behind);
        if nearest.is_finite() && ahead.max(behind).is_infinite() {
            let level = self.level(point, normal, nearest);
            let cosine = length(level);
            if cosine > UPRIGHT {
                let found = both(unit(level))?.map(|reach| cosine * reach);
                if found.iter().all(|reach| reach.is_finite()) {
                    return Some(found);
                }
            }
        }
        Some([ahead, behind])
    }

    /// The part of a normal that is parallel to the borders that a way of such a length along it gets to.
    fn level(&self, p: Vec3, normal: Vec3, way: f64) -> Vec3 {
        let last = self.last();
        let is_near = |a: usize| p[a].min(last[a] - p[a]) <= way * normal[a].abs();
        std::array::from_fn(|a| if is_near(a) { 0.0 } else { normal[a] })
    }

    /// Whether a point lies on the border of the volume, for each axis.
    pub fn on_border(&self, p: Vec3) -> [bool; 3] {
        on_border(p, self.last())
    }

    /// Whether a point lies in the volume, its border included.
    pub fn within_volume(&self, p: Vec3) -> bool {
        self.depth(p) >= 0.0
    }

    /// How far a point is from the border of the volume; negative beyond it.
    pub fn depth(&self, p: Vec3) -> f64 {
        let last = self.last();
        let depth = |a: usize| p[a].min(last[a] - p[a]);
        depth(0).min(depth(1)).min(depth(2))
    }

    /// The last voxel of the volume, work coordinates.
    pub fn last(&self) -> Vec3 {
        let directory = self.batch.directories.first();
        directory.map_or([0.0; 3], |d| last_voxel(d.dimensions, self.h))
    }
}
