//! Sheets → sheet fraction: where the sheet ends.
//!
//! Midway through a sheet the slightly smoothed mask is the same everywhere inside and half of that
//! on a rim or a hole's edge, if these are straight. So the *sheet fraction* is the smoothed mask
//! over what it is midway through the sheet around here: 1 inside and ½ on the rim. Its σ is that
//! of the grid, not of the sheet, so that rims stay sharp.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::bricks::{Batch, BRICK};
use crate::fields::separable::Kernel;
use crate::grid::Vec3;
use crate::sheets::profile::smooth_mask;
use crate::sheets::scale::{self, BrickMeans};
use crate::sheets::sheet::{voxel_along, Sheet};

/// Sheet fraction from which on a rim is a *blind* one: not the label ends there, but another sheet begins.
pub(crate) const BLIND: f64 = 0.8;
/// σ of the smoothing, work units.
pub(crate) const SIGMA: f64 = 1.0;
/// Where the kernel is cut off, in σ.
const REACH: f64 = 2.6;
/// How near to the middle of a sheet its inside is measured, work units, and how much of what a voxel is
/// longer along the normal is added: midway between two layers both count.
const CLOSE: f32 = 0.5;
const LONGER: f32 = 0.65;

/// Passes over all bricks that [`sheet_fraction`] makes, for its progress.
pub(crate) const PASSES: usize = 2 + scale::PASSES;

/// The sheet fraction at every voxel of a batch; 0 where no sheet is near.
pub(crate) fn sheet_fraction(
    batch: &Batch,
    sheets: &[Sheet],
    distance: &[f32],
    h: Vec3,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    let smoothed = smoothed_mask(batch, distance, h, execution)?;
    let inside = inside(batch, sheets, (distance, &smoothed), h, execution)?;
    over_inside(batch, smoothed, &inside, execution)
}

/// The slightly smoothed mask at every voxel of a batch.
pub(crate) fn smoothed_mask(
    batch: &Batch,
    distance: &[f32],
    h: Vec3,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    let kernels = batch.directories.first();
    let kernels = kernels.map(|first| Kernel::repeating(SIGMA, REACH * SIGMA, h, first));
    smooth_mask(batch, distance, |_| kernels.as_ref(), execution)
}

/// What the `smoothed` mask is midway through the sheet around a voxel.
pub(crate) fn inside(
    batch: &Batch,
    sheets: &[Sheet],
    (distance, smoothed): (&[f32], &[f32]),
    h: Vec3,
    execution: &mut Execution,
) -> Result<BrickMeans> {
    let spacing = h.map(|h| h as f32);
    BrickMeans::new(
        batch,
        |brick| {
            let own = brick * BRICK..(brick + 1) * BRICK;
            let mut sums = [0.0; 2];
            for ((value, sheet), d) in smoothed[own.clone()]
                .iter()
                .zip(&sheets[own.clone()])
                .zip(&distance[own])
            {
                let [x, y, z, offset] = *sheet;
                let close = CLOSE + LONGER * (voxel_along([x, y, z], spacing) - 1.0);
                if *d > 0.0 && *sheet != Sheet::default() && offset.abs() < close {
                    // High powers: the inside counts, rims do not.
                    let fourth = (value * value) * (value * value);
                    sums = [sums[0] + fourth * value, sums[1] + fourth];
                }
            }
            sums
        },
        execution,
    )
}

/// The sheet fraction, from the smoothed mask and what that is inside.
pub(crate) fn over_inside(
    batch: &Batch,
    mut smoothed: Vec<f32>,
    inside: &BrickMeans,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    execution.fill(&mut smoothed, BRICK, |brick, values| {
        if values.iter().all(|v| *v == 0.0) {
            return;
        }
        for (value, inside) in values.iter_mut().zip(inside.brick(batch, brick)) {
            *value = if inside > 0.0 { *value / inside } else { 0.0 };
        }
    })?;
    Ok(smoothed)
}
