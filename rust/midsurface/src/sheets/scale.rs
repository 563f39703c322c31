//! Distance → local scale: how thick the label is here.
//!
//! One σ for a whole component would blur its thin folds for the sake of its thickest spot. So each
//! voxel has a half thickness of its own, from the distances D of the labelled voxels around it. In
//! a slab whose faces are h from the middle, ΣD⁵ / ΣD⁴ is 5/6 h: high powers make the middle count
//! and the rims, faces and noise not. The sums are kept by brick and interpolated linearly between
//! the bricks' centres, so that the scale changes smoothly.

use crate::error::{collected, Result};
use crate::execution::Execution;
use crate::fields::bricks::{Batch, Directory, BRICK, EDGE, LAYER};

/// D is measured to the first voxel outside, about this much beyond the face, work units.
const BEYOND_FACE: f32 = 0.4;
/// The smallest half thickness: that of a single voxel.
const LEAST: f32 = 0.5;
/// What a brick takes of the sums of each one around that has some.
const TAKEN: f32 = 0.01;

/// Passes over all bricks that [`BrickMeans::new`] makes, for its progress.
pub(crate) const PASSES: usize = 1;

/// Two sums for every brick of a batch whose ratio is a mean, interpolated between the bricks.
pub(crate) struct BrickMeans(Vec<[f32; 2]>);

impl BrickMeans {
    /// Sums that `sums` gives for each brick: weighted values, and weights.
    pub fn new(
        batch: &Batch,
        sums: impl Fn(usize) -> [f32; 2] + Sync,
        execution: &mut Execution,
    ) -> Result<Self> {
        let sums = execution.collect(batch.part_of_brick.len(), sums)?;
        Ok(Self(sums))
    }

    /// From the sums of all bricks.
    pub fn of_sums(sums: Vec<[f32; 2]>) -> Self {
        Self(sums)
    }

    /// The sums of all bricks.
    pub fn sums(&self) -> &[[f32; 2]] {
        &self.0
    }

    /// Lets bricks without a sum take those of the bricks around, so many times; what is taken counts
    /// little against what is known.
    pub fn spread(mut self, batch: &Batch, times: usize) -> Result<Self> {
        for _ in 0..times {
            let mut next = collected(self.0.iter().copied())?;
            for (brick, own) in next.iter_mut().enumerate().filter(|(_, own)| own[1] == 0.0) {
                let (directory, place) = batch.brick(brick);
                for [value, weight] in directory.around(place).map(|b| self.0[b]) {
                    *own = [own[0] + TAKEN * value, own[1] + TAKEN * weight];
                }
            }
            self.0 = next;
        }
        Ok(self)
    }

    /// The sums of the bricks around a brick, 0 where there is none.
    fn around(&self, directory: &Directory, place: [usize; 3]) -> [[f32; 2]; 27] {
        std::array::from_fn(|i| {
            let side = [i % 3, i / 3 % 3, i / 9];
            let mut at = place;
            for (at, side) in at.iter_mut().zip(side) {
                match (*at + side).checked_sub(1) {
                    Some(v) => *at = v,
                    None => return [0.0; 2],
                }
            }
            directory.brick(at).map_or([0.0; 2], |b| self.0[b])
        })
    }

    /// The mean at every voxel of a brick; 0 where nothing is near.
    pub fn brick(&self, batch: &Batch, brick: usize) -> [f32; BRICK] {
        let (directory, place) = batch.brick(brick);
        let around = self.around(directory, place);
        let first = around.iter().find(|sums| sums[1] > 0.0);
        let Some(first) = first else {
            return [0.0; BRICK];
        };
        if around
            .iter()
            .all(|s| s[1] == 0.0 || s[0] * first[1] == first[0] * s[1])
        {
            return [first[0] / first[1]; BRICK];
        }
        interpolate(&around)
    }
}

/// Ratio of both sums at the voxels of the middle one of 27 bricks, the sums linear between the
/// bricks' centres.
fn interpolate(around: &[[f32; 2]; 27]) -> [f32; BRICK] {
    let weights: [[f32; 3]; EDGE] = std::array::from_fn(|v| {
        let t = (v as f32 + 0.5) / EDGE as f32 - 0.5;
        [(-t).max(0.0), 1.0 - t.abs(), t.max(0.0)]
    });
    let mean = |w: &[f32; 3], sums: [[f32; 2]; 3]| -> [f32; 2] {
        std::array::from_fn(|k| w[0] * sums[0][k] + w[1] * sums[1][k] + w[2] * sums[2][k])
    };
    let mut ratios = [0.0; BRICK];
    for (along_z, layer) in weights.iter().zip(ratios.chunks_exact_mut(LAYER)) {
        let plane: [[f32; 2]; 9] =
            std::array::from_fn(|i| mean(along_z, [around[i], around[i + 9], around[i + 18]]));
        for (along_y, row) in weights.iter().zip(layer.chunks_exact_mut(EDGE)) {
            let line: [[f32; 2]; 3] =
                std::array::from_fn(|i| mean(along_y, [plane[i], plane[i + 3], plane[i + 6]]));
            for (along_x, ratio) in weights.iter().zip(row) {
                let [value, weight] = mean(along_x, line);
                *ratio = if weight > 0.0 { value / weight } else { 0.0 };
            }
        }
    }
    ratios
}

/// The local half thickness.
pub(crate) struct HalfThickness(BrickMeans);

impl HalfThickness {
    /// From the distance to the outside, work units.
    pub fn new(batch: &Batch, distance: &[f32], execution: &mut Execution) -> Result<Self> {
        let sums = |brick: usize| {
            let own = &distance[brick * BRICK..][..BRICK];
            own.iter().fold([0.0; 2], |[five, four], d| {
                let fourth = (d * d) * (d * d);
                [five + fourth * d, four + fourth]
            })
        };
        Ok(Self(BrickMeans::new(batch, sums, execution)?))
    }

    /// Half the thickness of the label at every voxel of a brick, work units; 0 where no label is
    /// near.
    pub fn brick(&self, batch: &Batch, brick: usize) -> [f32; BRICK] {
        self.0.brick(batch, brick).map(of_ratio)
    }
}

fn of_ratio(ratio: f32) -> f32 {
    if ratio > 0.0 {
        (1.2 * ratio - BEYOND_FACE).max(LEAST)
    } else {
        0.0
    }
}
