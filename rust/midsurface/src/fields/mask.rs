//! Distance → mask: the label as bits, for rays (`ray.rs`), which ask for the corners of cells again
//! and again.
//!
//! A brick's bits lie in rows along x, and come with the voxels, rows and layers that follow: all
//! corners of a cell whose low corner is in the brick are there.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::block::{Block, SIDE};
use crate::fields::bricks::{Batch, EDGE};
use crate::fields::ray::DEEP;

/// Voxels, rows and layers of a brick and what follows it.
const ROWS: usize = EDGE + 1;

/// The mask of a batch, brick by brick.
pub(crate) struct Mask(Vec<Brick>);

struct Brick {
    /// Whether each voxel is labelled: bit x of row z · [`ROWS`] + y.
    rows: [u16; ROWS * ROWS],
    /// Whether any voxel in or next to the brick is farther from the outside than [`DEEP`].
    is_deep: bool,
}

/// Passes over all bricks that [`Mask::new`] makes, for its progress.
pub(crate) const PASSES: usize = 1;

impl Mask {
    /// The mask of a batch, which is where `distance` is positive.
    pub fn new(batch: &Batch, distance: &[f32], execution: &mut Execution) -> Result<Self> {
        let bricks = execution.collect(batch.part_of_brick.len(), |brick| {
            let near = Block::gather(batch, brick, distance);
            let deepest = near.values.iter().fold(0.0, |most, &d| f32::max(most, d));
            let mut rows = [0; ROWS * ROWS];
            if deepest > 0.0 {
                for (i, bits) in rows.iter_mut().enumerate() {
                    let first = ((i / ROWS + 1) * SIDE + i % ROWS + 1) * SIDE + 1;
                    let row = near.values[first..first + ROWS].iter().rev();
                    *bits = row.fold(0, |bits, d| bits << 1 | u16::from(*d > 0.0));
                }
            }
            let is_deep = f64::from(deepest) > DEEP;
            Brick { rows, is_deep }
        })?;
        Ok(Self(bricks))
    }

    /// Which corners of a cell are labelled, a bit each, x fastest; its low corner is voxel (x, y, z)
    /// of a brick.
    #[inline]
    pub fn corners(&self, brick: usize, [x, y, z]: [usize; 3]) -> u8 {
        let rows = &self.0[brick].rows;
        let two = |row: usize| (rows[row] >> x & 3) as u8;
        let first = z * ROWS + y;
        two(first) | two(first + 1) << 2 | two(first + ROWS) << 4 | two(first + ROWS + 1) << 6
    }
    /// Whether a voxel in or next to a brick is so deep within the label that a ray may jump.
    #[inline]
    pub fn is_deep(&self, brick: usize) -> bool {
        self.0[brick].is_deep
    }
}
