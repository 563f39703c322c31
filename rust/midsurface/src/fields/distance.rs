//! Stage 3, parts → distance: how far each labelled voxel is from the outside of its part.
//!
//! The exact Euclidean distance between voxel centres, in work units, to the nearest voxel that
//! is not of the part. The squared distance is separable: a pass along x finds the nearest
//! outside voxel of the row, and passes along y and z take `min over k of g(i + k) + (k h)²`
//! (Saito and Toriwaki 1994). Each voxel looks only as far as its own value allows, so that the
//! support of a thin membrane is a few voxels. Beyond the border of the volume lies the unknown,
//! which is not an outside: it has no voxel to be near to.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::bricks::{Batch, Directory, BRICK, EDGE};
use crate::fields::vectors::with_widest_vectors;
use crate::grid::Vec3;

/// Distances are told apart up to this many work units; nothing so thick is a membrane.
pub(crate) const LARGEST: f64 = 64.0;

/// Passes over all bricks that [`distance`] makes, for its progress.
pub(crate) const PASSES: usize = 2;

/// Distance of every voxel in the batch's bricks, 0 outside the parts. `h` is the work spacing.
pub(crate) fn distance(batch: &Batch, h: Vec3, execution: &mut Execution) -> Result<Vec<f32>> {
    let mut along_x = batch.field()?;
    for (part, directory) in batch.parts.iter().zip(&batch.directories) {
        for run in &part.runs {
            write_run(directory, run, h[0], &mut along_x);
        }
    }
    let mut along_y = batch.field()?;
    execution.fill(&mut along_y, BRICK, |brick, out| {
        with_widest_vectors(
            #[inline(always)]
            || lower_envelope(batch, brick, &along_x, 1, h[1], out),
        );
    })?;
    let mut squared = along_x;
    execution.fill(&mut squared, BRICK, |brick, out| {
        with_widest_vectors(
            #[inline(always)]
            || {
                lower_envelope(batch, brick, &along_y, 2, h[2], out);
                out.iter_mut().for_each(|v| *v = v.sqrt());
            },
        );
    })?;
    Ok(squared)
}

/// Squared distance to the ends of a run; an end on the border of the volume is no end.
fn write_run(directory: &Directory, run: &crate::reading::runs::Run, h: f64, out: &mut [f32]) {
    let (start, end) = (run.start as usize, run.end as usize);
    for x in start..end {
        let left = if start == 0 {
            usize::MAX
        } else {
            x + 1 - start
        };
        let right = if end == directory.dimensions[0] {
            usize::MAX
        } else {
            end - x
        };
        let distance = (left.min(right) as f64 * h).min(LARGEST);
        if let Some(entry) = directory.entry([x, run.y as usize, run.z as usize]) {
            out[entry] = (distance * distance) as f32;
        }
    }
}

/// `out = min over k of input(i + k) + (k h)²` along `axis`, for the labelled voxels of a brick.
#[inline(always)]
fn lower_envelope(
    batch: &Batch,
    brick: usize,
    input: &[f32],
    axis: usize,
    h: f64,
    out: &mut [f32],
) {
    let (directory, place) = batch.brick(brick);
    let own = &input[brick * BRICK..][..BRICK];
    out.copy_from_slice(own);
    let rows = out.chunks_exact_mut(EDGE).enumerate();
    for (row, out) in rows.filter(|(_, out)| out.iter().any(|v| *v > 0.0)) {
        let Some(out) = out.first_chunk_mut::<EDGE>() else {
            continue;
        };
        let mut worst = largest(out);
        let voxel = [
            place[0] * EDGE,
            place[1] * EDGE + row % EDGE,
            place[2] * EDGE + row / EDGE,
        ];
        let mut k = 1;
        while worst > ((k as f64 * h) as f32).powi(2) {
            let step = ((k as f64 * h) as f32).powi(2);
            for sign in [-1, 1] {
                let mut at = voxel.map(|v| v as isize);
                at[axis] += sign * k;
                if at[axis] < 0 || at[axis] >= directory.dimensions[axis] as isize {
                    continue;
                }
                let entry = directory.entry_at(at);
                let other = entry.and_then(|entry| input[entry..].first_chunk::<EDGE>());
                for (out, other) in out.iter_mut().zip(other.unwrap_or(&[0.0; EDGE])) {
                    // f32::min would ask whether either is no number.
                    let far = other + step;
                    *out = if far < *out { far } else { *out };
                }
            }
            worst = largest(out);
            k += 1;
        }
        // Voxels outside the part started at zero and stay there.
    }
}

#[inline(always)]
fn largest(row: &[f32; EDGE]) -> f32 {
    row.iter()
        .fold(0.0, |most, v| if *v > most { *v } else { most })
}
