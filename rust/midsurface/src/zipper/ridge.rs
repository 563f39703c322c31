//! Stage 4, distance → ridge field: a smooth field whose crest is the mid-surface.
//!
//! The ridge field is the distance under an isotropic Gaussian with σ = D_max / 2 and radius
//! 2σ + 1 (MidSurfer, section "Ridge Field Transformation"), with D_max the largest distance in
//! the part's connected component, so that one thick object does not blur a thin membrane.
//!
//! The *sheet fraction* is the label's mask under the same Gaussian, divided by what an endless
//! sheet of the local thickness would give in its middle, erf(h / (√2 σ)). It is 1 inside a sheet
//! and ½ on its rim, which is how the next stage finds rims and holes at subvoxel position.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::bricks::{Batch, BRICK};
use crate::fields::distance::distance;
use crate::fields::mask::{self, Mask};
use crate::fields::separable::{local_maximum, smooth, Kernel};
use crate::grid::Vec3;
use crate::reading::components::Part;
use crate::sheets::sheet::{self, sheets, unshrink, Sheet};

/// The largest σ in work units: a label for which it would be larger is not a thin slab.
pub(crate) const LARGEST_SCALE: f64 = 8.0;

/// The smallest σ in work units: below it the grid shows through.
const SMALLEST_SCALE: f64 = 0.8;

/// Passes over all bricks that [`ridge_field`] makes, for its progress.
pub(crate) const PASSES: usize = 15 + mask::PASSES + sheet::PASSES;

/// The fields of a batch, over its bricks.
pub(crate) struct RidgeField {
    /// Distance to the outside of the part, work units.
    pub distance: Vec<f32>,
    /// Where that is positive.
    pub mask: Mask,
    /// The smoothed distance, work units.
    pub ridge: Vec<f32>,
    /// The smoothed mask over that of an endless sheet.
    pub fraction: Vec<f32>,
    /// Normal of the sheet and offset to its middle.
    pub sheets: Vec<Sheet>,
}

/// Distance and ridge field of parts that make up whole components, with the bricks they are on.
/// `h` is the work spacing.
pub(crate) fn ridge_field<'a>(
    parts: &'a [Part],
    dimensions: [usize; 3],
    h: Vec3,
    execution: &mut Execution,
) -> Result<(Batch<'a>, RidgeField)> {
    let batch = Batch::new(parts, dimensions)?;
    let distance = distance(&batch, h, execution)?;
    let scales = scales(&batch, &distance);
    warn_if_thick(parts, &scales, execution);
    let reach = |part: usize| 2.0 * scales[part] + 1.0;
    let kernels: Vec<[Kernel; 3]> = (0..parts.len())
        .map(|part| Kernel::axes(scales[part], reach(part), h, &batch.directories[part]))
        .collect();
    let mut scratch = batch.field()?;
    let copy = of_distance(&distance, |d| d, execution)?;
    let ridge = smooth(&batch, &kernels, copy, &mut scratch, execution)?;
    let mask = of_distance(&distance, |d| f32::from(d > 0.0), execution)?;
    let mut fraction = smooth(&batch, &kernels, mask, &mut scratch, execution)?;
    let copy = of_distance(&distance, |d| d, execution)?;
    let thick = local_maximum(&batch, &kernels, copy, &mut scratch, execution)?;
    over_endless_sheet((&batch, &scales), &thick, &mut fraction, execution)?;
    drop(thick);
    let mut sheets = sheets(
        &batch,
        &scales,
        &distance,
        &ridge,
        h,
        &mut scratch,
        execution,
    )?;
    drop(scratch);
    let variance: Vec<f64> = kernels
        .iter()
        .map(|kernels| kernels[0].variance(h[0]))
        .collect();
    let variance = |brick: usize| variance[batch.part_of_brick[brick] as usize];
    unshrink(&batch, variance, &mut sheets, h, execution)?;
    let field = RidgeField {
        mask: Mask::new(&batch, &distance, execution)?,
        distance,
        ridge,
        fraction,
        sheets,
    };
    Ok((batch, field))
}

/// Divides the smoothed mask by that of an endless sheet as thick as the label is here.
fn over_endless_sheet(
    (batch, scales): (&Batch, &[f64]),
    thick: &[f32],
    fraction: &mut [f32],
    execution: &mut Execution,
) -> Result<()> {
    execution.fill(fraction, BRICK, |brick, fraction| {
        let sigma = scales[batch.part_of_brick[brick] as usize];
        // Neighbours mostly have the same maximum.
        let (mut latest, mut endless) = (f32::NAN, 1.0);
        for (fraction, &thick) in fraction.iter_mut().zip(&thick[brick * BRICK..]) {
            if *fraction == 0.0 {
                continue;
            }
            if thick != latest {
                (latest, endless) = (thick, endless_sheet(thick, sigma));
            }
            *fraction /= endless;
        }
    })
}

/// Tells of components for which σ had to be bounded.
fn warn_if_thick(parts: &[Part], scales: &[f64], execution: &mut Execution) {
    let thick = parts
        .iter()
        .zip(scales)
        .filter(|(_, scale)| **scale == LARGEST_SCALE);
    let mut thick: Vec<(i64, u32)> = thick
        .map(|(part, _)| (part.label, part.component))
        .collect();
    thick.dedup();
    for (label, component) in thick {
        execution.warning(&format!(
            "component {component} of label {label} is more than {} voxels thick: no thin \
             membrane, so that its mid-surface means little",
            4.0 * LARGEST_SCALE
        ));
    }
}

/// A field made of the distance, voxel by voxel.
fn of_distance(
    distance: &[f32],
    f: impl Fn(f32) -> f32 + Sync,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    let field = execution.collect(distance.len() / BRICK, |brick| {
        let mut values = [0.0; BRICK];
        for (value, d) in values.iter_mut().zip(&distance[brick * BRICK..]) {
            *value = f(*d);
        }
        values
    })?;
    Ok(field.into_flattened())
}

/// σ of each part: half the largest distance in the part's component.
fn scales(batch: &Batch, distance: &[f32]) -> Vec<f64> {
    let largest: Vec<f32> = batch
        .directories
        .iter()
        .map(|directory| {
            let range = directory.first * BRICK..(directory.first + directory.places.len()) * BRICK;
            distance[range].iter().copied().fold(0.0, f32::max)
        })
        .collect();
    let mut scales = Vec::with_capacity(largest.len());
    // Parts are ordered by component, so those of one component are neighbours.
    for parts in batch.parts.chunk_by(|a, b| a.component == b.component) {
        let own = &largest[scales.len()..][..parts.len()];
        let most = own.iter().copied().fold(0.0, f32::max);
        let scale = (f64::from(most) / 2.0).clamp(SMALLEST_SCALE, LARGEST_SCALE);
        scales.resize(scales.len() + parts.len(), scale);
    }
    scales
}

/// The smoothed mask midway through an endless sheet whose largest distance is `thick`.
fn endless_sheet(thick: f32, sigma: f64) -> f32 {
    // Half a voxel lies between the last labelled centre and the face.
    let half = (f64::from(thick) - 0.5).max(0.5);
    erf(half / (std::f64::consts::SQRT_2 * sigma)) as f32
}

/// The error function, by Abramowitz and Stegun 7.1.26 (absolute error below 1.5e-7).
fn erf(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.3275911 * x.abs());
    let series = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t
        + 0.254829592)
        * t;
    (1.0 - series * (-x * x).exp()).copysign(x)
}
