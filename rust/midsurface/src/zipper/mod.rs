//! The method "polyline zipper": lines midway through every slice, neighbouring ones zipped together.
//!
//! | stage | file |
//! | --- | --- |
//! | distance → a smooth field whose crest is the mid-surface | `ridge.rs` |
//! | ridge field → a line midway through every slice: traced, at even distances, moved to the middle, led on to the border of the volume | `polylines.rs`: `slice.rs`, `trace.rs`, `resample.rs`, `centre.rs`, `ends.rs`, `border.rs` |
//! | lines that come from elsewhere are looked at | `slices.rs` |
//! | lines → strips of triangles between slices | `zip.rs`, `strip.rs` |
//! | triangles → a 2-manifold with better triangles, no terraces, then nearly equilateral ones | `zipped_surface.rs`, `flips.rs` |

mod border;
mod centre;
mod ends;
mod flips;
pub(crate) mod polylines;
mod resample;
mod ridge;
mod slice;
mod slices;
mod strip;
mod trace;
mod zip;
pub(crate) mod zipped_surface;

use ndarray::ArrayViewMut3;

use crate::batches::for_each_batch;
use crate::error::Result;
use crate::execution::Execution;
use crate::fields::bricks::{voxels, Batch};
use crate::grid::Grid;
use crate::reading::components::Part;
use crate::reading::READING;
use polylines::Polylines;
use ridge::RidgeField;

/// Hands what `work` makes of the parts' ridge fields to `keep`, as [`for_each_batch`]; `stage` is
/// what that is called.
fn for_each_ridge_field<'a, R: Send>(
    all_parts: &'a [Part],
    grid: &Grid,
    execution: &mut Execution,
    (until, stage): (f64, &'static str),
    work: impl Fn(Batch<'a>, RidgeField, &mut Execution) -> Result<R> + Sync,
    mut keep: impl FnMut(R) -> Result<()>,
) -> Result<()> {
    let h = grid.work_spacing();
    let work = |parts: &'a [Part], execution: &mut Execution| {
        execution.stage("Computing the ridge field", 0.0, 0.5, ridge::PASSES)?;
        let (batch, field) = ridge::ridge_field(parts, grid.dimensions, h, execution)?;
        execution.stage(stage, 0.5, 1.0, 1)?;
        work(batch, field, execution)
    };
    let span = [until * READING, until];
    for_each_batch(all_parts, execution, span, work, |_, found| keep(found))
}

/// Where fields go: arrays of shape (z, y, x) whose first voxel is the volume's voxel `first`, x, y, z.
pub(crate) struct Fields<'a> {
    pub distance: ArrayViewMut3<'a, f32>,
    pub ridge: ArrayViewMut3<'a, f32>,
    pub first: [usize; 3],
}

/// Writes the fields of whole components where the arrays have room for them.
pub(crate) fn write_fields(
    parts: &[Part],
    grid: &Grid,
    fields: &mut Fields,
    execution: &mut Execution,
) -> Result<()> {
    let unit = grid.unit() as f32;
    for_each_ridge_field(
        parts,
        grid,
        execution,
        (1.0, "Writing the fields"),
        |batch, field, _| Ok((batch, field)),
        |(batch, field)| {
            for (brick, place) in batch.places() {
                for (entry, voxel) in voxels(brick, place, grid.dimensions) {
                    // What lies before the first wraps round to beyond the last.
                    let [x, y, z] = std::array::from_fn(|a| voxel[a].wrapping_sub(fields.first[a]));
                    let places = (
                        fields.distance.get_mut([z, y, x]),
                        fields.ridge.get_mut([z, y, x]),
                    );
                    if let (Some(d), Some(r)) = places {
                        // Margins of neighbouring parts overlap: the stronger field wins.
                        *d = d.max(field.distance[entry] * unit);
                        *r = r.max(field.ridge[entry] * unit);
                    }
                }
            }
            Ok(())
        },
    )
}

/// The polylines, and the number of disks in place of which there are none.
pub(crate) fn trace_polylines(
    parts: &[Part],
    grid: &Grid,
    execution: &mut Execution,
    until: f64,
) -> Result<(Polylines, usize)> {
    let mut polylines = Polylines::default();
    let mut disks = 0;
    for_each_ridge_field(
        parts,
        grid,
        execution,
        (until, "Tracing mid-polylines"),
        |batch, field, execution| polylines::polylines(&batch, &field, grid, execution),
        |(found, disks_of_batch)| {
            disks += disks_of_batch;
            polylines.append(found)
        },
    )?;
    Ok((polylines, disks))
}
