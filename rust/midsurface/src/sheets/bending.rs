//! Core sheets → how they bend: what a sheet's normal does on the way along it.
//!
//! The derivative of the normal along the sheet (the shape operator) says how a sheet runs on
//! beyond what is seen of it. It is averaged over the core voxels of bricks, so that noise of the
//! normals does not count. A normal n and its opposite are the same sheet, but their derivatives D
//! have opposite signs: what is summed are the products n ⊗ D, which do not know of the sign. Sheets
//! across each other in one brick hardly mix, since those products are scaled by the cosine between
//! their normals.
//!
//! Where a sheet's bend changes within a brick or two it is followed no better than on average.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::block::{row, Block, SIDE};
use crate::fields::bricks::{Batch, BRICK, EDGE};
use crate::grid::Vec3;
use crate::sheets::sheet::{dot, Sheet};

/// Neighbours are of one sheet with normals within this cosine and offsets as far from what is
/// expected, work units.
const ALIKE: f32 = 0.8;
const NEAR: f32 = 0.5;
/// A sheet bends by at most this much on a work unit: a radius of three.
const MOST: f32 = 0.33;
/// The fewest pairs of voxels that tell the bend along an axis.
const FEWEST: f32 = 16.0;

/// Weight of a brick's own voxels against those of each brick around.
const OWN_WEIGHT: f32 = 8.0;

/// Σ n ⊗ ∂n/∂a over pairs of core voxels along each axis a, and their number.
#[derive(Clone, Copy, Default)]
struct Sums {
    products: [[[f32; 3]; 3]; 3],
    count: [f32; 3],
}

/// How the sheets in and around a brick bend: mean of n ⊗ ∂n/∂a for each axis a.
#[derive(Clone, Copy, Default)]
pub(crate) struct Bend([[[f32; 3]; 3]; 3]);

/// Passes over the bricks that [`bends`] makes, for its progress.
pub(crate) const PASSES: usize = 2;

/// How the sheets of a batch bend, brick by brick, from those of the core voxels.
pub(crate) fn bends(
    batch: &Batch,
    sheets: &[Sheet],
    h: Vec3,
    execution: &mut Execution,
) -> Result<Vec<Bend>> {
    let bricks = batch.part_of_brick.len();
    let sums = execution.collect(bricks, |brick| {
        let own = &sheets[brick * BRICK..][..BRICK];
        if own.iter().all(|sheet| *sheet == Sheet::default()) {
            return Sums::default();
        }
        Sums::new(&Block::gather(batch, brick, sheets), h)
    })?;
    execution.collect(bricks, |brick| Bend::around(batch, brick, &sums))
}

impl Sums {
    fn new(block: &Block<Sheet>, h: Vec3) -> Self {
        let mut sums = Self::default();
        for i in 0..BRICK {
            let at = row(i / EDGE % EDGE, i / EDGE / EDGE) + i % EDGE;
            let own = block.values[at];
            if own == Sheet::default() {
                continue;
            }
            let n = [own[0], own[1], own[2]];
            for (a, stride) in [1, SIDE, SIDE * SIDE].into_iter().enumerate() {
                let h = h[a] as f32;
                if let Some(change) = change(&own, &block.values[at + stride], a, h) {
                    sums.add(a, 1.0, &n.map(|n| change.map(|v| n * v)));
                }
            }
        }
        sums
    }

    /// Adds products along an axis.
    fn add(&mut self, axis: usize, count: f32, products: &[[f32; 3]; 3]) {
        self.count[axis] += count;
        let own = self.products[axis].iter_mut().flatten();
        own.zip(products.iter().flatten())
            .for_each(|(sum, v)| *sum += v);
    }
}

/// The derivative of the normal along axis a, between a voxel and the next.
fn change(own: &Sheet, next: &Sheet, a: usize, h: f32) -> Option<[f32; 3]> {
    let cosine = own[0] * next[0] + own[1] * next[1] + own[2] * next[2];
    let turn = cosine.signum();
    let expected = 0.5 * (own[a] + turn * next[a]) * h;
    let off = (own[3] - turn * next[3] - expected).abs();
    (cosine.abs() >= ALIKE && off <= NEAR)
        .then(|| std::array::from_fn(|k| (turn * next[k] - own[k]) / h))
}

impl Bend {
    /// From the sums of a brick and those around it.
    fn around(batch: &Batch, brick: usize, of_bricks: &[Sums]) -> Self {
        let (directory, place) = batch.brick(brick);
        let mut sums = Sums::default();
        for b in directory.around(place) {
            let own = &of_bricks[b];
            let weight = if b == brick { OWN_WEIGHT } else { 1.0 };
            for a in 0..3 {
                let products = own.products[a].map(|row| row.map(|v| weight * v));
                sums.add(a, weight * own.count[a], &products);
            }
        }
        for (products, count) in sums.products.iter_mut().zip(sums.count) {
            let share = if count < FEWEST { 0.0 } else { 1.0 / count };
            products.iter_mut().flatten().for_each(|v| *v *= share);
        }
        Self(sums.products)
    }

    /// How much a normal n changes over a way.
    pub fn change(&self, n: [f32; 3], way: [f32; 3]) -> [f32; 3] {
        let mut change = [0.0; 3];
        for (products, way) in self.0.iter().zip(way) {
            for (row, n) in products.iter().zip(n) {
                for (sum, v) in change.iter_mut().zip(row) {
                    *sum += way * n * v;
                }
            }
        }
        let share = MOST * dot(way, way).sqrt() / dot(change, change).sqrt().max(1e-12);
        change.map(|v| v * share.min(1.0))
    }
}
