//! Separable filters over bricks: one pass an axis, touching bricks only.
//!
//! What lies outside the bricks counts as zero. Midway through a sheet, where fields are read, no
//! filter reaches that far.

use crate::bricks::{Batch, Directory, BRICK, EDGE, LAYER};
use crate::error::Result;
use crate::execution::Execution;
use crate::grid::Vec3;

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

    /// The kernels of the three axes of a part.
    pub fn axes(sigma: f64, reach: f64, h: Vec3, directory: &Directory) -> [Self; 3] {
        std::array::from_fn(|a| Self::new(sigma, reach, h[a], directory.dimensions[a]))
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

/// Smooths `field` with the kernels of each part. `scratch` is overwritten.
pub(crate) fn smooth(
    batch: &Batch,
    kernels: &[[Kernel; 3]],
    mut field: Vec<f32>,
    scratch: &mut Vec<f32>,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    for axis in [2, 1, 0] {
        execution.fill(scratch, BRICK, |brick, out| {
            out.fill(0.0);
            let kernel = &kernels[batch.part_of_brick[brick] as usize][axis];
            let (directory, place) = batch.brick(brick);
            let input = Neighbours::new(directory, place, axis, kernel.radius, &field);
            if input.bricks.iter().all(Option::is_none) {
                return;
            }
            let weights: [&[f32]; EDGE] =
                std::array::from_fn(|k| kernel.at(place[axis] * EDGE + k));
            match axis {
                0 => input.along_x(|row, out| convolve_row(row, &weights, out), out),
                _ => input.across(axis, &weights, |out, v, w| *out += w * v, out),
            }
        })?;
        std::mem::swap(&mut field, scratch);
    }
    Ok(field)
}

/// The largest value within the kernels' radius, along all axes. `scratch` is overwritten.
pub(crate) fn local_maximum(
    batch: &Batch,
    kernels: &[[Kernel; 3]],
    mut field: Vec<f32>,
    scratch: &mut Vec<f32>,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    for axis in [2, 1, 0] {
        execution.fill(scratch, BRICK, |brick, out| {
            out.fill(0.0);
            let kernel = &kernels[batch.part_of_brick[brick] as usize][axis];
            let (directory, place) = batch.brick(brick);
            let input = Neighbours::new(directory, place, axis, kernel.radius, &field);
            if input.bricks.iter().all(Option::is_none) {
                return;
            }
            let weights = [&kernel.weights[0][..]; EDGE];
            match axis {
                0 => input.along_x(|row, out| maximum_row(row, kernel.radius, out), out),
                _ => input.across(axis, &weights, |out, v, _| *out = out.max(v), out),
            }
        })?;
        std::mem::swap(&mut field, scratch);
    }
    Ok(field)
}

/// `out[k] = weights[k] · row[k ..]`.
fn convolve_row(row: &[f32], weights: &[&[f32]; EDGE], out: &mut [f32]) {
    let first = weights[0];
    // Away from the borders all eight kernels are one, and the sums run side by side.
    if weights
        .iter()
        .all(|w| std::ptr::eq(w.as_ptr(), first.as_ptr()))
    {
        for (k, &w) in first.iter().enumerate() {
            for (out, v) in out.iter_mut().zip(&row[k..k + EDGE]) {
                *out += w * v;
            }
        }
    } else {
        for (k, out) in out.iter_mut().enumerate() {
            *out = row[k..].iter().zip(weights[k]).map(|(v, w)| v * w).sum();
        }
    }
}

/// `out[k]` = the largest of `row[k ..= k + 2 · radius]`.
fn maximum_row(row: &[f32], radius: usize, out: &mut [f32]) {
    for k in 0..=2 * radius {
        for (out, v) in out.iter_mut().zip(&row[k..k + EDGE]) {
            *out = out.max(*v);
        }
    }
}

/// The bricks in a row along one axis, as far as a filter reaches; empty ones are left out.
struct Neighbours<'a> {
    bricks: Vec<Option<&'a [f32]>>,
    radius: usize,
    /// Voxels from the start of the first of `bricks` to the first voxel the filter reaches.
    lead: usize,
}

impl<'a> Neighbours<'a> {
    fn new(
        directory: &Directory,
        place: [usize; 3],
        axis: usize,
        radius: usize,
        field: &'a [f32],
    ) -> Self {
        let reach = radius.div_ceil(EDGE);
        let brick = |i: usize| {
            let mut at = place;
            at[axis] = (at[axis] + i).checked_sub(reach)?;
            let values = &field[directory.brick(at)? * BRICK..][..BRICK];
            let empty = values.iter().fold(true, |empty, v| empty & (*v == 0.0));
            (!empty).then_some(values)
        };
        Self {
            bricks: (0..=2 * reach).map(brick).collect(),
            radius,
            lead: reach * EDGE - radius,
        }
    }

    /// Applies `f(out, input, weight)` for every layer of the output across `axis`, which is not x,
    /// and every layer of the input in its reach.
    #[inline(always)]
    fn across(
        &self,
        axis: usize,
        weights: &[&[f32]; EDGE],
        f: impl Fn(&mut f32, f32, f32),
        out: &mut [f32],
    ) {
        // Along z a layer is 64 values in a piece; along y it is 8 in each of 8 slices.
        let (size, pieces) = if axis == 2 { (LAYER, 1) } else { (EDGE, EDGE) };
        for to in 0..EDGE {
            for (offset, &weight) in weights[to].iter().enumerate() {
                let at = to + offset + self.lead;
                let Some(brick) = self.bricks[at / EDGE] else {
                    continue;
                };
                for piece in 0..pieces {
                    let input = &brick[piece * LAYER + at % EDGE * size..][..size];
                    let out = &mut out[piece * LAYER + to * size..][..size];
                    for (out, v) in out.iter_mut().zip(input) {
                        f(out, *v, weight);
                    }
                }
            }
        }
    }

    /// Applies `f(row with the filter's radius on both sides, output row)` to every row along x.
    fn along_x(&self, f: impl Fn(&[f32], &mut [f32]), out: &mut [f32]) {
        let mut row = vec![0.0; self.bricks.len() * EDGE];
        for (i, out) in out.chunks_exact_mut(EDGE).enumerate() {
            for (brick, row) in self.bricks.iter().zip(row.chunks_exact_mut(EDGE)) {
                if let Some(brick) = brick {
                    row.copy_from_slice(&brick[i * EDGE..][..EDGE]);
                }
            }
            f(&row[self.lead..][..EDGE + 2 * self.radius], out);
        }
    }
}
