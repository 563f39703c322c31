//! Separable filters over bricks: one pass an axis, touching bricks only.
//!
//! What lies outside the bricks counts as zero. Midway through a sheet, where fields are read, no
//! filter reaches that far.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::bricks::{Batch, Directory, BRICK, EDGE, LAYER};
use crate::fields::vectors::with_widest_vectors;
use crate::grid::Vec3;

/// Passes over all bricks that a filter makes, for its progress.
pub(crate) const PASSES: usize = 3;
/// The axes along which a filter goes, one after the other.
pub(crate) const AXES: [usize; PASSES] = [2, 1, 0];

/// Gaussian weights along one axis, for every place it can have to the borders of the volume.
///
/// Beyond the border lies the unknown. There the weights become those of a local linear fit (Fan
/// and Gijbels 1996): a field that is linear across the border is kept as it is, so that a tilted
/// sheet is not bent where it leaves the volume.
pub(crate) struct Kernel {
    radius: usize,
    /// Rows of 2 · radius + 1 weights: the plain kernel, then those near the low and high border.
    weights: Vec<Vec<f32>>,
    count: usize,
}

impl Kernel {
    /// A Gaussian of `sigma`, cut off at `reach`, both in work units, for an axis of `count` voxels
    /// with spacing `h`.
    pub fn new(sigma: f64, reach: f64, h: f64, count: usize) -> Self {
        let radius = ((reach / h).round() as usize).max(1);
        let near = radius.min(count);
        let mut weights = vec![weights(sigma / h, radius, [radius; 2])];
        weights.extend((0..near).map(|i| self::weights(sigma / h, radius, [i, count - 1 - i])));
        weights.extend((0..near).map(|i| self::weights(sigma / h, radius, [count - 1 - i, i])));
        Self {
            radius,
            weights,
            count,
        }
    }

    /// Like [`Self::axes`], but beyond the border the outermost voxels are repeated: what is right
    /// for a field with steps, such as a mask, that is not to be continued as a line.
    pub fn repeating(sigma: f64, reach: f64, h: Vec3, directory: &Directory) -> [Self; 3] {
        let mut kernels = Self::axes(sigma, reach, h, directory);
        for kernel in &mut kernels {
            kernel.repeat();
        }
        kernels
    }

    fn repeat(&mut self) {
        let near = self.radius.min(self.count);
        for i in 0..2 * near {
            let (low, high) = if i < near {
                (i, self.count - 1 - i)
            } else {
                (self.count - 1 - (i - near), i - near)
            };
            // The first and the last entry of the row that lie within the volume.
            let first = self.radius - low.min(self.radius);
            let last = self.radius + high.min(self.radius);
            let mut row = vec![0.0; 2 * self.radius + 1];
            for (k, w) in self.weights[0].iter().enumerate() {
                row[k.clamp(first, last)] += w;
            }
            self.weights[1 + i] = row;
        }
    }

    /// The kernels of the three axes of a part.
    pub fn axes(sigma: f64, reach: f64, h: Vec3, directory: &Directory) -> [Self; 3] {
        std::array::from_fn(|a| Self::new(sigma, reach, h[a], directory.dimensions[a]))
    }

    /// Bricks that the kernel reaches into on either side.
    pub fn reach(&self) -> usize {
        self.radius.div_ceil(EDGE)
    }

    /// Variance of the kernel in work units squared, h being the spacing it was made for.
    pub fn variance(&self, h: f64) -> f64 {
        let square =
            |(i, w): (usize, &f32)| f64::from(*w) * (i as f64 - self.radius as f64).powi(2);
        h * h * self.weights[0].iter().enumerate().map(square).sum::<f64>()
    }

    /// The weights at index `i` of the axis.
    fn at(&self, i: usize) -> &[f32] {
        let near = self.radius.min(self.count);
        let to_high = self.count.saturating_sub(1 + i);
        if i < near {
            &self.weights[1 + i]
        } else if to_high < near {
            &self.weights[1 + near + to_high]
        } else {
            &self.weights[0]
        }
    }
}

/// Weights at offsets −radius .. radius, of which `room` lie within the volume on either side.
fn weights(sigma: f64, radius: usize, room: [usize; 2]) -> Vec<f32> {
    let offset = |i: usize| i as f64 - radius as f64;
    let gaussian = |i: usize| {
        let t = offset(i);
        let inside = -t <= room[0] as f64 && t <= room[1] as f64;
        f64::from(u8::from(inside)) * (-0.5 * (t / sigma.max(1e-3)).powi(2)).exp()
    };
    let raw: Vec<f64> = (0..=2 * radius).map(gaussian).collect();
    let moment = |power: i32| -> f64 {
        raw.iter()
            .enumerate()
            .map(|(i, w)| w * offset(i).powi(power))
            .sum()
    };
    let (m0, m1, m2) = (moment(0), moment(1), moment(2));
    let determinant = m0 * m2 - m1 * m1;
    let fit = |(i, w): (usize, &f64)| {
        if determinant > 1e-6 * m0 * m0 {
            (w * (m2 - m1 * offset(i)) / determinant) as f32
        } else {
            (w / m0) as f32
        }
    };
    raw.iter().enumerate().map(fit).collect()
}

/// Smooths `field` with the kernels of each part. A field may have several values a voxel: a brick
/// then holds one after the other for all its voxels. `scratch`, as long, is overwritten.
pub(crate) fn smooth(
    batch: &Batch,
    kernels: &[[Kernel; 3]],
    field: Vec<f32>,
    scratch: &mut Vec<f32>,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    let kernel_of = |brick: usize| Some(&kernels[batch.part_of_brick[brick] as usize]);
    filter(batch, kernel_of, Kernel::at, add, field, scratch, execution)
}

/// What smoothing adds of a value.
#[inline(always)]
fn add(sum: f32, value: f32, weight: f32) -> f32 {
    sum + weight * value
}

/// Smooths a brick along an axis, given the values of the bricks around; without kernels it becomes zero.
pub(crate) fn smooth_brick<'f>(
    (batch, brick): (&Batch, usize),
    kernels: Option<&'f [Kernel; 3]>,
    axis: usize,
    values_of: impl Fn(usize) -> &'f [f32],
    out: &mut [f32],
) {
    match kernels {
        Some(kernels) => {
            let weights = |i: usize| kernels[axis].at(i);
            filter_brick((batch, brick), axis, weights, add, values_of, out);
        }
        None => out.fill(0.0),
    }
}

/// Filters a brick along an axis, whose weights at an index are given.
fn filter_brick<'f>(
    (batch, brick): (&Batch, usize),
    axis: usize,
    weights: impl Fn(usize) -> &'f [f32],
    combine: impl Fn(f32, f32, f32) -> f32 + Copy,
    values_of: impl Fn(usize) -> &'f [f32],
    out: &mut [f32],
) {
    let (directory, place) = batch.brick(brick);
    let weights: [&[f32]; EDGE] = std::array::from_fn(|k| weights(place[axis] * EDGE + k));
    with_widest_vectors(
        #[inline(always)]
        || {
            let input = Neighbours::new(directory, place, axis, weights, &values_of);
            input.filter(axis, combine, out);
        },
    );
}

/// The largest value within the kernels' radius, along all axes; at least 0. `scratch`, as long as
/// `field`, is overwritten.
pub(crate) fn local_maximum(
    batch: &Batch,
    kernels: &[[Kernel; 3]],
    field: Vec<f32>,
    scratch: &mut Vec<f32>,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    // f32::max would ask whether either is no number.
    let larger = |most: f32, value: f32, _| if value > most { value } else { most };
    filter(
        batch,
        |brick| Some(&kernels[batch.part_of_brick[brick] as usize]),
        |kernel, _| &kernel.weights[0],
        larger,
        field,
        scratch,
        execution,
    )
}

/// Replaces every value by `combine(so far, value in reach, weight)` over all values in reach,
/// starting from 0, along one axis after the other. `weights` are those of a kernel at an index.
fn filter<'k>(
    batch: &Batch,
    kernel_of: impl Fn(usize) -> Option<&'k [Kernel; 3]> + Sync,
    weights: impl Fn(&Kernel, usize) -> &[f32] + Sync,
    combine: impl Fn(f32, f32, f32) -> f32 + Sync + Copy,
    mut field: Vec<f32>,
    scratch: &mut Vec<f32>,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    let size = field.len() / batch.part_of_brick.len().max(1);
    for axis in AXES {
        execution.fill(scratch, size, |brick, out| {
            let Some(kernel) = kernel_of(brick).map(|kernels| &kernels[axis]) else {
                // Writing zeros over zeros would make memory of pages that nobody has touched.
                if out.iter().any(|v| *v != 0.0) {
                    out.fill(0.0);
                }
                return;
            };
            let weights = |i: usize| weights(kernel, i);
            let values_of = |brick: usize| &field[brick * size..][..size];
            filter_brick((batch, brick), axis, weights, combine, values_of, out);
        })?;
        std::mem::swap(&mut field, scratch);
    }
    Ok(field)
}

/// Rows of a brick that are worked on side by side: what fits into the registers.
const ROWS: usize = 4;

/// Takes one value into every place of the rows that are worked on.
#[inline(always)]
fn take(
    rows: &mut [[f32; EDGE]; ROWS],
    input: [&[f32]; ROWS],
    weight: f32,
    combine: impl Fn(f32, f32, f32) -> f32,
) {
    for (row, input) in rows.iter_mut().zip(input) {
        for (so_far, value) in row.iter_mut().zip(input) {
            *so_far = combine(*so_far, *value, weight);
        }
    }
}

/// The bricks in a row along one axis, as far as a filter reaches; empty ones are left out.
struct Neighbours<'a> {
    bricks: Vec<Option<&'a [f32]>>,
    /// Voxels from the start of the first of `bricks` to the first voxel the filter reaches.
    lead: usize,
    /// The filter's weights at each voxel of the brick in the middle.
    weights: [&'a [f32]; EDGE],
}

impl<'a> Neighbours<'a> {
    #[inline(always)]
    fn new(
        directory: &Directory,
        place: [usize; 3],
        axis: usize,
        weights: [&'a [f32]; EDGE],
        values_of: impl Fn(usize) -> &'a [f32],
    ) -> Self {
        let radius = weights[0].len() / 2;
        let reach = radius.div_ceil(EDGE);
        let brick = |i: usize| {
            let mut at = place;
            at[axis] = (at[axis] + i).checked_sub(reach)?;
            let values = values_of(directory.brick(at)?);
            let is_zero = |values: &[f32]| values.iter().fold(true, |zero, v| zero & (*v == 0.0));
            (!values.chunks_exact(LAYER).all(is_zero)).then_some(values)
        };
        Self {
            bricks: (0..=2 * reach).map(brick).collect(),
            lead: reach * EDGE - radius,
            weights,
        }
    }

    /// Filters all values of the voxels along `axis`.
    #[inline(always)]
    fn filter(&self, axis: usize, combine: impl Fn(f32, f32, f32) -> f32 + Copy, out: &mut [f32]) {
        if self.bricks.iter().all(Option::is_none) {
            out.fill(0.0);
            return;
        }
        let mut lines = Vec::new();
        for (value, out) in out.chunks_exact_mut(BRICK).enumerate() {
            match axis {
                0 => self.along_x(value, combine, &mut lines, out),
                _ => self.across(value, axis, combine, out),
            }
        }
    }

    /// Filters one value of the voxels across `axis`, which is not x.
    #[inline(always)]
    fn across(
        &self,
        value: usize,
        axis: usize,
        combine: impl Fn(f32, f32, f32) -> f32 + Copy,
        out: &mut [f32],
    ) {
        // From one voxel to the next along the axis, and from row to row across it.
        let (step, next) = if axis == 2 {
            (LAYER, EDGE)
        } else {
            (EDGE, LAYER)
        };
        for (to, weights) in self.weights.iter().enumerate() {
            for first in (0..EDGE).step_by(ROWS) {
                let row = |k: usize| (first + k) * next;
                let mut rows = [[0.0; EDGE]; ROWS];
                for (offset, &weight) in weights.iter().enumerate() {
                    let at = to + offset + self.lead;
                    if let Some(brick) = self.bricks[at / EDGE] {
                        let layer = &brick[value * BRICK + at % EDGE * step..];
                        let input = std::array::from_fn(|k| &layer[row(k)..][..EDGE]);
                        take(&mut rows, input, weight, combine);
                    }
                }
                for (k, values) in rows.iter().enumerate() {
                    out[to * step + row(k)..][..EDGE].copy_from_slice(values);
                }
            }
        }
    }

    /// Filters one value of the voxels along x. `lines`, empty at first, is for all values.
    #[inline(always)]
    fn along_x(
        &self,
        value: usize,
        combine: impl Fn(f32, f32, f32) -> f32 + Copy,
        lines: &mut Vec<f32>,
        out: &mut [f32],
    ) {
        let width = self.bricks.len() * EDGE;
        // Empty bricks leave their zeros.
        lines.resize(LAYER * width, 0.0);
        for (line, own) in lines.chunks_exact_mut(width).enumerate() {
            for (brick, own) in self.bricks.iter().zip(own.chunks_exact_mut(EDGE)) {
                if let Some(brick) = brick {
                    own.copy_from_slice(&brick[value * BRICK + line * EDGE..][..EDGE]);
                }
            }
        }
        // Away from the borders all eight kernels are one, and the rows run side by side.
        let is_one = |w: &&[f32]| std::ptr::eq(w.as_ptr(), self.weights[0].as_ptr());
        if self.weights.iter().all(is_one) {
            let groups = lines.chunks_exact(ROWS * width);
            for (lines, out) in groups.zip(out.chunks_exact_mut(ROWS * EDGE)) {
                let mut rows = [[0.0; EDGE]; ROWS];
                for (offset, &weight) in self.weights[0].iter().enumerate() {
                    let from = self.lead + offset;
                    let input = std::array::from_fn(|k| &lines[k * width + from..][..EDGE]);
                    take(&mut rows, input, weight, combine);
                }
                out.copy_from_slice(rows.as_flattened());
            }
        } else {
            for (line, out) in lines.chunks_exact(width).zip(out.chunks_exact_mut(EDGE)) {
                for (k, out) in out.iter_mut().enumerate() {
                    *out = line[self.lead + k..]
                        .iter()
                        .zip(self.weights[k])
                        .fold(0.0, |so_far, (v, w)| combine(so_far, *v, *w));
                }
            }
        }
    }
}
