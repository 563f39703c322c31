//! Batches of whole components, so that memory follows the largest batch and not the volume.

use crate::bricks::Batch;
use crate::components::Part;
use crate::error::Result;
use crate::execution::Execution;
use crate::grid::Grid;
use crate::reading::READING;
use crate::ridge::{self, RidgeField};

/// Cost of the parts that are worked on at once; a larger component is a batch of its own.
const BATCH_COST: usize = 600_000;

/// Hands the parts, which are ordered by component, to `work`, batch by batch. All takes the
/// progress from where reading ended up to `until`, within which each call has a span of its own.
pub(crate) fn for_each_batch(
    all_parts: &[Part],
    execution: &mut Execution,
    until: f64,
    mut work: impl FnMut(&[Part], &mut Execution) -> Result<()>,
) -> Result<()> {
    let total: usize = all_parts.iter().map(Part::voxels).sum();
    let share = |voxels: usize| until * (READING + (1.0 - READING) * voxels as f64 / total as f64);
    let mut done = 0;
    for parts in batches(all_parts) {
        let voxels: usize = parts.iter().map(Part::voxels).sum();
        execution.within(share(done), share(done + voxels));
        work(parts, execution)?;
        done += voxels;
    }
    execution.within(until, 1.0);
    Ok(())
}

/// Hands the parts' ridge fields to `work`, as [`for_each_batch`]; `stage` is what that is called.
pub(crate) fn for_each_ridge_field(
    all_parts: &[Part],
    grid: &Grid,
    execution: &mut Execution,
    until: f64,
    stage: &'static str,
    mut work: impl FnMut(&Batch, &RidgeField, &mut Execution) -> Result<()>,
) -> Result<()> {
    let h = grid.work_spacing();
    for_each_batch(all_parts, execution, until, |parts, execution| {
        execution.stage("Computing the ridge field", 0.0, 0.5, ridge::PASSES)?;
        let (batch, field) = ridge::ridge_field(parts, grid.dimensions, h, execution)?;
        execution.stage(stage, 0.5, 1.0, 1)?;
        work(&batch, &field, execution)
    })
}

/// Cuts the parts into batches of whole components.
fn batches(parts: &[Part]) -> Vec<&[Part]> {
    let mut batches = Vec::new();
    let (mut start, mut end, mut cost) = (0, 0, 0);
    for component in parts.chunk_by(|a, b| a.component == b.component) {
        let size: usize = component.iter().map(Part::cost).sum();
        if cost > 0 && cost + size > BATCH_COST {
            batches.push(&parts[start..end]);
            (start, cost) = (end, 0);
        }
        end += component.len();
        cost += size;
    }
    if end > start {
        batches.push(&parts[start..end]);
    }
    batches
}
