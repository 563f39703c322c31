//! Separable filters over bricks: one pass an axis, touching bricks only.
//!
//! What lies outside the bricks counts as zero; a margin as wide as the filter's radius therefore
//! makes a filtered field exact wherever the part has voxels.

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
        raw.iter().enumerate().map(|(i, w)| w * offset(i).powi(power)).sum()
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
            let part = batch.part_of_brick[brick] as usize;
            let kernel = &kernels[part][axis];
            let (directory, place) = batch.brick(brick);
            let input = Neighbours::new(directory, place, axis, kernel.radius, &field);
            out.fill(0.0);
            for k in 0..EDGE {
                let weights = kernel.at(place[axis] * EDGE + k);
                for (offset, &weight) in weights.iter().enumerate() {
                    if weight != 0.0 {
                        input.add(axis, k, k + offset, weight, out);
                    }
                }
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
            let radius = kernels[batch.part_of_brick[brick] as usize][axis].radius;
            let (directory, place) = batch.brick(brick);
            let input = Neighbours::new(directory, place, axis, radius, &field);
            out.fill(0.0);
            for k in 0..EDGE {
                for offset in 0..=2 * radius {
                    input.raise(axis, k, k + offset, out);
                }
            }
        })?;
        std::mem::swap(&mut field, scratch);
    }
    Ok(field)
}

/// The bricks in a row along one axis, as far as a filter reaches.
struct Neighbours<'a> {
    bricks: Vec<Option<&'a [f32]>>,
    /// Voxels from the start of the first of `bricks` to the first voxel the filter reaches.
    lead: usize,
}

impl<'a> Neighbours<'a> {
    fn new(directory: &Directory, place: [usize; 3], axis: usize, radius: usize, field: &'a [f32]) -> Self {
        let reach = radius.div_ceil(EDGE);
        let brick = |i: usize| {
            let mut at = place;
            at[axis] = (at[axis] + i).checked_sub(reach)?;
            directory.brick(at).map(|b| &field[b * BRICK..][..BRICK])
        };
        Self {
            bricks: (0..=2 * reach).map(brick).collect(),
            lead: reach * EDGE - radius,
        }
    }

    /// Brick and layer of the input at `position` voxels from the first one in reach.
    fn locate(&self, position: usize) -> Option<(&'a [f32], usize)> {
        let at = position + self.lead;
        self.bricks[at / EDGE].map(|brick| (brick, at % EDGE))
    }

    /// Adds `weight` times the input layer at `position` to layer k of the output.
    fn add(&self, axis: usize, k: usize, position: usize, weight: f32, out: &mut [f32]) {
        if let Some((brick, from)) = self.locate(position) {
            combine(axis, k, from, brick, out, |out, v| *out += weight * v);
        }
    }

    /// Raises layer k of the output to the input layer at `position`.
    fn raise(&self, axis: usize, k: usize, position: usize, out: &mut [f32]) {
        if let Some((brick, from)) = self.locate(position) {
            combine(axis, k, from, brick, out, |out, v| *out = out.max(v));
        }
    }
}

/// Applies `f` to layer `to` of the output and layer `from` of a brick, layers across `axis`.
#[inline(always)]
fn combine(axis: usize, to: usize, from: usize, brick: &[f32], out: &mut [f32], f: impl Fn(&mut f32, f32)) {
    match axis {
        2 => {
            let input = &brick[from * LAYER..][..LAYER];
            for (out, v) in out[to * LAYER..][..LAYER].iter_mut().zip(input) {
                f(out, *v);
            }
        }
        1 => {
            for z in 0..EDGE {
                let input = &brick[z * LAYER + from * EDGE..][..EDGE];
                let out = &mut out[z * LAYER + to * EDGE..][..EDGE];
                for (out, v) in out.iter_mut().zip(input) {
                    f(out, *v);
                }
            }
        }
        _ => {
            for row in 0..LAYER {
                f(&mut out[row * EDGE + to], brick[row * EDGE + from]);
            }
        }
    }
}
