//! Scale → profile: the label's mask, smoothed as wide as the label is thick here.
//!
//! Under a Gaussian with σ = 0.7 times the half thickness the mask of a slab has a profile much like
//! a Gaussian across, with its maximum midway. Its logarithm is what is worked with: there a rim
//! only adds a term that does not depend on the place across the sheet, and so neither turns the
//! normal nor moves the middle.
//!
//! The mask is smoothed at a few levels of σ, each where it is wanted, and the logarithms'
//! derivatives are blended between the two levels next to a voxel's own σ.

use rayon::prelude::*;

use crate::error::{collected, Result};
use crate::execution::Execution;
use crate::fields::block::{matrix_at, vector_at, Block, Row};
use crate::fields::bricks::{Batch, BRICK, EDGE, LAYER};
use crate::fields::separable::Kernel;
use crate::fields::slabs::{smooth_in_slabs, Bricks};
use crate::grid::Vec3;
use crate::sheets::scale::HalfThickness;
use crate::sheets::sheet::dot;

/// σ over the local half thickness.
const SHARE: f32 = 0.7;
/// σ of the first level, work units: below it the grid shows through.
const FIRST: f32 = 0.8;
/// Ratio of one level's σ to the last.
const RATIO: f32 = std::f32::consts::SQRT_2;
/// Number of levels; the last one's σ is that of a label 20 thick.
const LEVELS: usize = 7;
/// σ of the last level.
const LAST: f32 = 8.0 * FIRST;
/// Where kernels are cut off, in σ.
const REACH: f64 = 2.6;
/// The logarithm of a slab's profile is no parabola, so that Newton's step falls short of the middle: with
/// a half thickness of a σ, a step of o σ by SHORT a⁴ o² of itself, o² being at most MOST_SHORT; right to
/// 0.05 σ up to the faces (a fit to the exact step, for a up to 1 / SHARE).
const SHORT: f32 = 0.04;
const MOST_SHORT: f32 = 1.4;
/// A smoothed mask below this has no logarithm to speak of.
const LEAST: f32 = 1e-4;

/// The smoothed mask at every level.
pub(crate) struct Profile {
    levels: Vec<Vec<f32>>,
    /// The levels wanted in each brick, a bit each.
    wanted: Vec<u8>,
    half_thickness: HalfThickness,
}

/// First and second derivatives of the smoothed mask's logarithm in one row of a brick, 0 where the
/// mask is.
#[derive(Clone, Copy)]
pub(crate) struct Derivatives {
    /// Row y of layer z is row 8 z + y.
    pub row: usize,
    pub gradient: [Row; 3],
    pub hessian: [Row; 6],
    /// The scale that they are of.
    pub sigma: Row,
    half_thickness: Row,
    /// The level that goes with it.
    level: Row,
}

impl Profile {
    /// Smooths the mask of a batch, which is where `distance` is positive.
    pub fn new(
        batch: &Batch,
        distance: &[f32],
        half_thickness: HalfThickness,
        h: Vec3,
        execution: &mut Execution,
    ) -> Result<Self> {
        execution.still(1 + passes(u8::MAX, h));
        let bricks = batch.part_of_brick.len();
        let wanted = execution.collect(bricks, |brick| {
            let near = Block::gather(batch, brick, distance);
            if near.values.iter().all(|d| *d == 0.0) {
                return 0u8;
            }
            let half = half_thickness.brick(batch, brick);
            let voxels = half.iter().zip(near.largest_near());
            let near = voxels.filter(|(_, near)| *near > 0.0);
            near.fold(0, |bits, (half, _)| bits | levels_of(level(*half)))
        })?;
        let somewhere = wanted.iter().fold(0, |bits, wanted| bits | wanted);
        execution.still(passes(somewhere, h));
        let mut levels = Vec::new();
        for level in 0..LEVELS {
            levels.push(smooth_level(batch, &wanted, level, distance, h, execution)?);
        }
        Ok(Self {
            levels,
            wanted,
            half_thickness,
        })
    }

    /// σ at every voxel of a brick; 0 where no label is near.
    pub fn sigma(&self, batch: &Batch, brick: usize) -> [f32; BRICK] {
        let sigma = |half| if half > 0.0 { wanted_sigma(half) } else { 0.0 };
        self.half_thickness.brick(batch, brick).map(sigma)
    }

    /// The derivatives in the `wanted` rows of a brick, right at voxels in or beside the label.
    #[inline(always)]
    pub fn derivatives(
        &self,
        batch: &Batch,
        brick: usize,
        wanted: impl Fn(usize) -> bool,
        h: Vec3,
    ) -> Vec<Derivatives> {
        let half = self.half_thickness.brick(batch, brick);
        let mut rows: Vec<Derivatives> = (0..LAYER)
            .filter(|&row| wanted(row))
            .map(|row| Derivatives::new(row, std::array::from_fn(|i| half[row * EDGE + i])))
            .collect();
        let levels = rows.iter().flat_map(|row| row.level);
        let levels = levels.fold(0, |bits, level| bits | levels_of(level)) & self.wanted[brick];
        for level in (0..LEVELS).filter(|level| levels >> level & 1 == 1) {
            let block = Block::smooth(batch, brick, &self.levels[level]);
            for row in &mut rows {
                row.blend(&block, level as f32, h);
            }
        }
        rows
    }
}

impl Derivatives {
    /// Those of a row with such half thicknesses before any level has its say.
    fn new(row: usize, half: Row) -> Self {
        Self {
            row,
            gradient: [[0.0; EDGE]; 3],
            hessian: [[0.0; EDGE]; 6],
            sigma: half.map(wanted_sigma),
            half_thickness: half,
            level: half.map(level),
        }
    }

    /// Adds what one level says.
    #[inline(always)]
    fn blend(&mut self, block: &Block<f32>, level: f32, h: Vec3) {
        let mut weight = [0.0; EDGE];
        for (weight, own) in weight.iter_mut().zip(&self.level) {
            *weight = (1.0 - (own - level).abs()).max(0.0);
        }
        if weight.iter().all(|w| *w == 0.0) {
            return;
        }
        let (y, z) = (self.row % EDGE, self.row / EDGE);
        let value = *block.row(y, z);
        // Copies: only then do the eight voxels run side by side.
        let mut sum = *self;
        let (gradient, hessian) = block.row_derivatives(y, z, h);
        for i in 0..EDGE {
            let known = value[i] > LEAST;
            let (w, inverse) = if known {
                (weight[i], 1.0 / value[i])
            } else {
                (0.0, 0.0)
            };
            let g: [f32; 3] = std::array::from_fn(|k| gradient[k][i] * inverse);
            for (sum, g) in sum.gradient.iter_mut().zip(g) {
                sum[i] += w * g;
            }
            let products = [
                g[0] * g[0],
                g[1] * g[1],
                g[2] * g[2],
                g[0] * g[1],
                g[0] * g[2],
                g[1] * g[2],
            ];
            for k in 0..6 {
                sum.hessian[k][i] += w * (hessian[k][i] * inverse - products[k]);
            }
        }
        *self = sum;
    }

    /// How far the middle is where Newton's step says `offset`. The longer voxels are the fewer layers tell of
    /// a sheet, and those off the middle must say the same; where they are cubes the step will do.
    #[inline(always)]
    pub fn way_to_middle(&self, offset: f32, i: usize, h: [f32; 3]) -> f32 {
        let longest = h[0].max(h[1]).max(h[2]);
        let short = SHORT * (2.0 * (longest - 1.0)).min(1.0);
        let per_sigma = 1.0 / self.sigma[i];
        let half = (per_sigma * self.half_thickness[i]).min(1.0 / SHARE);
        let squared = ((per_sigma * offset) * (per_sigma * offset)).min(MOST_SHORT);
        offset * (1.0 + short * (half * half) * (half * half) * squared)
    }

    /// Newton's step along n to where the logarithm of the profile is largest, how far a step of the
    /// same curvature would go within the sheet, and the curvature within the sheet over that along n;
    /// no numbers where the profile has no crest along n.
    #[inline(always)]
    pub fn step(&self, i: usize, n: [f32; 3]) -> (f32, f32, f32) {
        let g = vector_at(&self.gradient, i);
        let [xx, yy, zz, xy, xz, yz] = matrix_at(&self.hessian, i);
        let bent = [
            xx * n[0] + xy * n[1] + xz * n[2],
            xy * n[0] + yy * n[1] + yz * n[2],
            xz * n[0] + yz * n[1] + zz * n[2],
        ];
        let (slope, curvature) = (dot(g, n), dot(n, bent));
        let within = [
            g[0] - slope * n[0],
            g[1] - slope * n[1],
            g[2] - slope * n[2],
        ];
        // What is left of the trace is the curvature within the sheet, both directions together.
        let bend = (xx + yy + zz - curvature) / curvature;
        let number = if curvature < 0.0 { 1.0 } else { f32::NAN };
        (
            number * (-slope / curvature),
            number * (dot(within, within).sqrt() / -curvature),
            number * bend,
        )
    }
}

/// The σ that goes with a half thickness.
fn wanted_sigma(half: f32) -> f32 {
    (SHARE * half).clamp(FIRST, LAST)
}

/// Its level, from 0.
fn level(half: f32) -> f32 {
    let level = (SHARE * half / FIRST).max(1.0).log2() / RATIO.log2();
    level.min((LEVELS - 1) as f32)
}

/// σ at a level.
fn sigma(level: f32) -> f32 {
    FIRST * RATIO.powf(level)
}

/// The levels that a voxel blends, a bit each. Whole numbers by a cast, as in [`crate::grid::floor`].
fn levels_of(level: f32) -> u8 {
    let below = level as u8;
    1 << below | 1 << (below + u8::from(f32::from(below) < level))
}

/// Rings of bricks that a level's filter reaches into.
fn rings(level: usize, h: Vec3) -> usize {
    let finest = h.iter().copied().fold(f64::INFINITY, f64::min);
    let reach = REACH * f64::from(sigma(level as f32)) / finest;
    (reach.round() as usize + 1).div_ceil(EDGE)
}

/// Passes over all bricks that it takes to smooth the mask at these levels.
fn passes(levels: u8, h: Vec3) -> usize {
    (0..LEVELS)
        .filter(|level| levels >> level & 1 == 1)
        .map(|level| rings(level, h) + 1)
        .sum()
}

/// The mask at one level, right in the bricks that want it and a voxel around; the mask is where
/// `distance` is positive.
fn smooth_level(
    batch: &Batch,
    wanted: &[u8],
    level: usize,
    distance: &[f32],
    h: Vec3,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    let sigma = f64::from(sigma(level as f32));
    if wanted.iter().all(|w| w >> level & 1 == 0) {
        return Ok(Vec::new());
    }
    let Some(directory) = batch.directories.first() else {
        return Ok(Vec::new());
    };
    let kernels = [Kernel::repeating(sigma, REACH * sigma, h, directory)];
    let mut active = collected(wanted.iter().map(|w| w >> level & 1 == 1))?;
    for _ in 0..rings(level, h) {
        active = execution.collect(active.len(), |brick| {
            let (directory, place) = batch.brick(brick);
            directory.around(place).any(|b| active[b])
        })?;
    }
    let kernel_of = |brick: usize| active[brick].then_some(&kernels[0]);
    smooth_mask(batch, distance, kernel_of, execution)
}

/// The mask, 1 where `distance` is positive and 0 elsewhere, smoothed with a kernel for each brick; 0 in
/// bricks without one.
pub(crate) fn smooth_mask<'k>(
    batch: &Batch,
    distance: &[f32],
    kernel_of: impl Fn(usize) -> Option<&'k [Kernel; 3]> + Sync,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    let make = |brick: usize, mask: &mut [f32]| {
        for (mask, d) in mask.iter_mut().zip(&distance[brick * BRICK..]) {
            *mask = f32::from(*d > 0.0);
        }
    };
    let mut smoothed = batch.field()?;
    let mut out = Bricks::of(&mut smoothed)?;
    let take = |bricks: &[u32], values: &[f32], execution: &Execution| {
        let out = out.take(bricks)?;
        execution.in_pool(|| {
            let both = out.into_par_iter().zip(values.par_chunks_exact(BRICK));
            both.for_each(|(out, values)| {
                // Pages where there is nothing stay untouched.
                if values.iter().any(|v| *v != 0.0) {
                    out.copy_from_slice(values);
                }
            });
        });
        Ok(())
    };
    smooth_in_slabs(batch, kernel_of, BRICK, make, take, execution)?;
    Ok(smoothed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slab's profile under a Gaussian of σ = 1, but for a factor.
    fn profile(x: f64, half: f64) -> f64 {
        let steps = 2000;
        let at = |k: i32| 2.0 * half * f64::from(k) / f64::from(steps) - half;
        (0..=steps)
            .map(|k| (-0.5 * (x - at(k)).powi(2)).exp())
            .sum()
    }

    #[test]
    fn the_middle_of_a_slab_is_found_from_its_faces() {
        for half in [0.7, 1.0, 1.25, 1.0 / f64::from(SHARE)] {
            for share in [0.2, 0.5, 0.8, 1.0] {
                let (x, d) = (share * half, 1e-3);
                let [before, at, after] = [x - d, x, x + d].map(|x| profile(x, half).ln());
                let slope = (after - before) / (2.0 * d);
                let curvature = (after - 2.0 * at + before) / (d * d);
                let mut row = Derivatives::new(0, [0.0; EDGE]);
                (row.sigma, row.half_thickness) = ([1.0; EDGE], [half as f32; EDGE]);
                row.gradient[2] = [slope as f32; EDGE];
                row.hessian[2] = [curvature as f32; EDGE];
                let (offset, ..) = row.step(0, [0.0, 0.0, 1.0]);
                let off = |offset: f32| (f64::from(offset) + x).abs();
                assert!(off(row.way_to_middle(offset, 0, [1.0, 1.0, 2.0])) < 0.05);
                assert_eq!(row.way_to_middle(offset, 0, [1.0; 3]), offset);
                // A header's rounding is no other shape.
                let rounded = row.way_to_middle(offset, 0, [1.0, 1.0, 1.0 + 1e-6]);
                assert!((rounded - offset).abs() < 1e-5, "{rounded} {offset}");
            }
        }
    }
}
