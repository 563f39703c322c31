//! Distance → mask: the label as bits, for rays (`ray.rs`), which ask for the corners of cells again
//! and again.
//!
//! A brick's bits lie in rows along x, and come with the voxels, rows and layers that follow: all
//! corners of a cell whose low corner is in the brick are there.

use crate::block::{Block, SIDE};
use crate::bricks::{Batch, EDGE};
use crate::error::Result;
use crate::execution::Execution;

/// Voxels, rows and layers of a brick and what follows it.
const ROWS: usize = EDGE + 1;

/// Whether each voxel is labelled, brick by brick: bit x of row z · [`ROWS`] + y.
pub(crate) struct Mask(Vec<[u16; ROWS * ROWS]>);

/// Passes over all bricks that [`Mask::new`] makes, for its progress.
pub(crate) const PASSES: usize = 1;

impl Mask {
    /// The mask of a batch, which is where `distance` is positive.
    pub fn new(batch: &Batch, distance: &[f32], execution: &mut Execution) -> Result<Self> {
        let rows = execution.collect(batch.part_of_brick.len(), |brick| {
            let near = Block::gather(batch, brick, distance);
            if near.values.iter().all(|d| *d == 0.0) {
                return [0; ROWS * ROWS];
            }
            std::array::from_fn(|i| {
                let first = ((i / ROWS + 1) * SIDE + i % ROWS + 1) * SIDE + 1;
                let row = near.values[first..first + ROWS].iter().rev();
                row.fold(0, |bits, d| bits << 1 | u16::from(*d > 0.0))
            })
        })?;
        Ok(Self(rows))
    }

    /// Which corners of a cell are labelled, a bit each, x fastest; its low corner is voxel (x, y, z)
    /// of a brick.
    #[inline]
    pub fn corners(&self, brick: usize, [x, y, z]: [usize; 3]) -> u8 {
        let rows = &self.0[brick];
        let two = |row: usize| (rows[row] >> x & 3) as u8;
        let first = z * ROWS + y;
        two(first) | two(first + 1) << 2 | two(first + ROWS) << 4 | two(first + ROWS + 1) << 6
    }
}
