//! Separable filters slab by slab: where a field is wanted for what its smoothed values tell of each brick,
//! only a few slabs of it are there at a time, and these are still in the processor's cache.
//!
//! Slabs lie across the axis along which the bricks reach farthest. The filter along that axis takes what
//! lies in the slabs on both sides, those along the others stay within a slab. What comes out is what
//! `separable.rs` makes of the whole field, to the bit.

use rayon::prelude::*;

use crate::buckets::Buckets;
use crate::error::{collected, filled, zeros, Result};
use crate::execution::Execution;
use crate::fields::bricks::{Batch, BRICK};
use crate::fields::separable::{smooth_brick, Kernel, AXES};

/// Bricks that a slab has at least, where there are so many: enough for all workers.
const FEWEST: usize = 256;

/// The bricks of a batch in slabs, each as many bricks thick as a filter reaches at least.
struct Slabs {
    axis: usize,
    bricks: Buckets<u32>,
    /// The slab of each brick, and its place there.
    place: Vec<(u32, u32)>,
}

impl Slabs {
    /// Slabs for filters that reach so many bricks along each axis.
    fn new(batch: &Batch, reach: [usize; 3]) -> Result<Self> {
        let axis = longest_axis(batch);
        let along = |brick: usize| batch.brick(brick).1[axis];
        let count = batch.part_of_brick.len();
        let last = (0..count).map(along).max().unwrap_or(0);
        let mut in_layer: Vec<usize> = zeros(last + 1)?;
        (0..count).for_each(|brick| in_layer[along(brick)] += 1);
        let mut slab_of_layer: Vec<u32> = filled(0, last + 1)?;
        let (mut slab, mut layers, mut bricks) = (0, 0, 0);
        for (of_layer, count) in slab_of_layer.iter_mut().zip(in_layer) {
            if layers >= reach[axis] && bricks >= FEWEST {
                (slab, layers, bricks) = (slab + 1, 0, 0);
            }
            *of_layer = slab;
            (layers, bricks) = (layers + 1, bricks + count);
        }
        let slab_of = |brick: u32| slab_of_layer[along(brick as usize)];
        let all = || (0..count as u32).map(|brick| (slab_of(brick), brick));
        let bricks = Buckets::new(slab as usize + 1, all)?;
        let mut place: Vec<(u32, u32)> = filled((0, 0), count)?;
        for slab in 0..bricks.count() {
            for (i, &brick) in bricks.of(slab).iter().enumerate() {
                place[brick as usize] = (slab as u32, i as u32);
            }
        }
        Ok(Self {
            axis,
            bricks,
            place,
        })
    }

    /// The most bricks that a slab has.
    fn most(&self) -> usize {
        let sizes = (0..self.bricks.count()).map(|slab| self.bricks.of(slab).len());
        sizes.max().unwrap_or(0)
    }
}

/// The axis along which there are most layers of bricks.
fn longest_axis(batch: &Batch) -> usize {
    let along = |axis: usize| {
        let layers = batch.places().map(|(_, place)| place[axis]);
        let ends = layers.fold((usize::MAX, 0), |(a, b), v| (a.min(v), b.max(v)));
        ends.1.saturating_sub(ends.0)
    };
    (0..3).max_by_key(|&axis| along(axis)).unwrap_or(0)
}

/// Smooths a field of `size` values a brick with a kernel for each brick; bricks without one become zero.
/// `make` writes a brick of the field over zeros, `take` gets the bricks of a slab and their values
/// smoothed. All is one pass.
pub(crate) fn smooth_in_slabs<'k>(
    batch: &Batch,
    kernel_of: impl Fn(usize) -> Option<&'k [Kernel; 3]> + Sync,
    size: usize,
    make: impl Fn(usize, &mut [f32]) + Sync,
    mut take: impl FnMut(&[u32], &[f32], &Execution) -> Result<()>,
    execution: &mut Execution,
) -> Result<()> {
    let mut reach = [1; 3];
    for kernels in (0..batch.part_of_brick.len()).filter_map(&kernel_of) {
        reach = std::array::from_fn(|a| reach[a].max(kernels[a].reach()));
    }
    let slabs = Slabs::new(batch, reach)?;
    let Slabs { axis, bricks, .. } = &slabs;
    let across = AXES.iter().position(|a| a == axis).unwrap_or(0);
    let (before, after) = (&AXES[..across], &AXES[across + 1..]);
    let room = size * slabs.most();
    // Of three slabs that follow each other what the filters before the one across made of them.
    let mut made: [Vec<f32>; 3] = [zeros(room)?, zeros(room)?, zeros(room)?];
    let (mut smoothed, mut scratch) = (zeros(room)?, zeros(room)?);
    let pass = |slab: usize, axis, field: [&[f32]; 3], out: &mut [f32]| {
        let values_of = |brick: usize| {
            let (slab, i) = slabs.place[brick];
            &field[slab as usize % 3][size * i as usize..][..size]
        };
        let of_slab = bricks
            .of(slab)
            .par_iter()
            .zip(out.par_chunks_exact_mut(size));
        of_slab.for_each(|(&brick, out)| {
            let brick = brick as usize;
            smooth_brick((batch, brick), kernel_of(brick), axis, values_of, out);
        });
    };
    for next in 0..=bricks.count() {
        if next < bricks.count() {
            execution.in_pool(|| {
                let all = made[next % 3].par_chunks_exact_mut(size);
                all.zip(bricks.of(next)).for_each(|(out, &brick)| {
                    out.fill(0.0);
                    make(brick as usize, out);
                });
            });
            for &axis in before {
                let field = [0, 1, 2].map(|i| &made[i][..]);
                execution.in_pool(|| pass(next, axis, field, &mut scratch));
                std::mem::swap(&mut made[next % 3], &mut scratch);
            }
        }
        let Some(slab) = next.checked_sub(1) else {
            continue;
        };
        let field = [0, 1, 2].map(|i| &made[i][..]);
        execution.in_pool(|| pass(slab, *axis, field, &mut smoothed));
        for &axis in after {
            execution.in_pool(|| pass(slab, axis, [&smoothed; 3], &mut scratch));
            std::mem::swap(&mut smoothed, &mut scratch);
        }
        let own = bricks.of(slab);
        take(own, &smoothed[..size * own.len()], execution)?;
        execution.report(next as f64 / bricks.count() as f64)?;
    }
    execution.pass_done()
}

/// The bricks of a field, to be written slab by slab.
pub(crate) struct Bricks<'a, T>(Vec<&'a mut [T]>);

impl<'a, T> Bricks<'a, T> {
    pub fn of(field: &'a mut [T]) -> Result<Self> {
        collected(field.chunks_exact_mut(BRICK)).map(Self)
    }

    /// Some bricks, which are nobody else's from then on.
    pub fn take(&mut self, bricks: &[u32]) -> Result<Vec<&'a mut [T]>> {
        let all = bricks
            .iter()
            .map(|&brick| std::mem::take(&mut self.0[brick as usize]));
        collected(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Quiet;
    use crate::fields::separable::smooth;
    use crate::reading::components::Part;
    use crate::reading::runs::Run;

    /// A box of labelled voxels whose lower corner is the volume's, but for a gap in the middle.
    fn part([nx, ny, nz]: [u32; 3]) -> Part {
        let row = |z: u32, y: u32| Run {
            label: 1,
            z,
            y,
            start: 0,
            end: if (y, z) == (ny / 2, nz / 2) { 1 } else { nx },
        };
        Part {
            label: 1,
            component: 0,
            runs: (0..nz)
                .flat_map(|z| (0..ny).map(move |y| row(z, y)))
                .collect(),
        }
    }

    #[test]
    fn slabs_make_no_difference_to_the_bit() {
        for sides in [[300, 100, 33], [33, 300, 100], [100, 33, 300]] {
            let parts = [part(sides), part([9, 8, 7])];
            let batch = &Batch::new(&parts, [320, 320, 320]).unwrap();
            let bricks = batch.part_of_brick.len();
            let mut quiet = Quiet::default();
            let execution = &mut Execution::new(2, &mut quiet).unwrap();
            for sigma in [1.0, 4.5] {
                let size = 2 * BRICK;
                let make = |brick: usize, out: &mut [f32]| {
                    for (i, v) in out.iter_mut().enumerate().filter(|_| brick % 5 != 0) {
                        *v = ((brick * size + i) as f32 * 0.7).sin();
                    }
                };
                let mut field: Vec<f32> = zeros(bricks * size).unwrap();
                let all = field.chunks_exact_mut(size).enumerate();
                all.for_each(|(brick, out)| make(brick, out));
                let kernels = || Kernel::axes(sigma, 2.6 * sigma, [1.0; 3], &batch.directories[0]);
                let kernels = [kernels(), kernels()];
                let mut scratch = zeros(field.len()).unwrap();
                let expected = smooth(batch, &kernels, field, &mut scratch, execution).unwrap();
                let (mut found, mut slabs) = (vec![0.0; expected.len()], 0);
                let take = |bricks: &[u32], values: &[f32], _: &Execution| {
                    slabs += 1;
                    for (&brick, values) in bricks.iter().zip(values.chunks_exact(size)) {
                        found[brick as usize * size..][..size].copy_from_slice(values);
                    }
                    Ok(())
                };
                let kernel_of = |brick: usize| Some(&kernels[brick % 2]);
                smooth_in_slabs(batch, kernel_of, size, make, take, execution).unwrap();
                assert!(slabs > 3, "{slabs}");
                assert!(found == expected);
            }
        }
    }
}
