//! Stage 4, distance → ridge field: a smooth field whose crest is the mid-surface.
//!
//! The ridge field is the distance under an isotropic Gaussian with σ = D_max / 2 and radius
//! 2σ + 1 (MidSurfer, section "Ridge Field Transformation"), with D_max the largest distance in
//! the part's connected component, so that one thick object does not blur a thin membrane.
//!
//! Beyond the border of the volume lies the unknown. There the kernel becomes that of a local
//! linear fit (Fan and Gijbels 1996): a field that is linear across the border is kept as it is,
//! so that a tilted sheet is not bent where it leaves the volume.
//!
//! The *sheet fraction* is the label's mask under the same Gaussian, divided by what an endless
//! sheet of the local thickness would give in its middle, erf(h / (√2 σ)). It is 1 inside a sheet
//! and ½ on its rim, which is how the next stage finds rims and holes at subvoxel position.

use crate::bricks::{Batch, Directory, BRICK, EDGE, LAYER};
use crate::distance::distance;
use crate::error::Result;
use crate::execution::Execution;
use crate::grid::Vec3;

/// The largest σ in work units: a label for which it would be larger is not a thin slab.
pub(crate) const LARGEST_SCALE: f64 = 8.0;

/// The fields of a batch, over its bricks.
pub(crate) struct RidgeField {
    /// Distance to the outside of the part, work units.
    pub distance: Vec<f32>,
    /// The smoothed distance, work units.
    pub ridge: Vec<f32>,
    /// The smoothed mask over that of an endless sheet.
    pub fraction: Vec<f32>,
    /// σ of each part, work units.
    pub scale: Vec<f64>,
}

/// Distance and ridge field of a batch that holds whole components. `h` is the work spacing.
pub(crate) fn ridge_field(batch: &Batch, h: Vec3, execution: &mut Execution) -> Result<RidgeField> {
    let distance = distance(batch, h, execution)?;
    let scale = scales(batch, &distance);
    let kernels: Vec<[Kernels; 3]> = scale
        .iter()
        .zip(&batch.directories)
        .map(|(&sigma, directory)| {
            std::array::from_fn(|a| Kernels::new(sigma, h[a], directory.dimensions[a]))
        })
        .collect();
    let mut both: Vec<[f32; 2]> = crate::error::filled(distance.len(), [0.0; 2])?;
    execution.fill(&mut both, BRICK, |brick, out| {
        let part = batch.part_of_brick[brick] as usize;
        let (directory, place) = batch.brick(brick);
        let tile = Tile::gather(directory, place, &distance, &kernels[part]);
        tile.smooth(&kernels[part], place, scale[part], out);
    })?;
    let mut ridge = crate::error::reserved(both.len())?;
    ridge.extend(both.iter().map(|v| v[0]));
    let mut fraction = crate::error::reserved(both.len())?;
    fraction.extend(both.iter().map(|v| v[1]));
    Ok(RidgeField {
        distance,
        ridge,
        fraction,
        scale,
    })
}

/// σ of each part: half the largest distance in the part's component.
fn scales(batch: &Batch, distance: &[f32]) -> Vec<f64> {
    let largest: Vec<f32> = batch
        .directories
        .iter()
        .map(|directory| {
            let range = directory.first * BRICK..(directory.first + directory.places.len()) * BRICK;
            distance[range].iter().copied().fold(0.0, f32::max)
        })
        .collect();
    let mut scales = Vec::with_capacity(largest.len());
    // Parts are ordered by component, so those of one component are neighbours.
    for parts in batch.parts.chunk_by(|a, b| a.component == b.component) {
        let own = &largest[scales.len()..][..parts.len()];
        let most = own.iter().copied().fold(0.0, f32::max);
        let scale = (f64::from(most) / 2.0).min(LARGEST_SCALE);
        scales.resize(scales.len() + parts.len(), scale);
    }
    scales
}

/// The Gaussian along one axis, for every place it can have to the borders of the volume.
struct Kernels {
    radius: usize,
    /// Rows of 2 · radius + 1 weights: the plain kernel, then those near the low and high border.
    weights: Vec<Vec<f32>>,
    count: usize,
}

impl Kernels {
    fn new(sigma: f64, h: f64, count: usize) -> Self {
        let radius = (((2.0 * sigma + 1.0) / h).round() as usize).max(1);
        let plain = kernel(sigma, h, radius, radius, radius);
        let mut weights = vec![plain];
        // Where the volume is narrower than the kernel both ends are cut.
        let reach = radius.min(count);
        for i in 0..reach {
            weights.push(kernel(sigma, h, radius, i, count - 1 - i));
        }
        for i in 0..reach {
            weights.push(kernel(sigma, h, radius, count - 1 - i, i));
        }
        Self {
            radius,
            weights,
            count,
        }
    }

    /// The weights at index `i` of the axis.
    fn at(&self, i: usize) -> &[f32] {
        let reach = self.radius.min(self.count);
        let to_high = self.count.saturating_sub(1 + i);
        if i < reach {
            &self.weights[1 + i]
        } else if to_high < reach {
            &self.weights[1 + reach + to_high]
        } else {
            &self.weights[0]
        }
    }
}

/// Gaussian weights at offsets −radius .. radius, of which `below` and `above` lie in the volume.
fn kernel(sigma: f64, h: f64, radius: usize, below: usize, above: usize) -> Vec<f32> {
    let offset = |i: usize| i as f64 - radius as f64;
    let gaussian = |i: usize| {
        let t = offset(i);
        let inside = -t <= below as f64 && t <= above as f64;
        if inside { (-0.5 * (t * h / sigma.max(1e-9)).powi(2)).exp() } else { 0.0 }
    };
    let raw: Vec<f64> = (0..=2 * radius).map(gaussian).collect();
    let moment = |power: i32| -> f64 {
        raw.iter().enumerate().map(|(i, w)| w * offset(i).powi(power)).sum()
    };
    let (m0, m1, m2) = (moment(0), moment(1), moment(2));
    let determinant = m0 * m2 - m1 * m1;
    let fit = |(i, w): (usize, &f64)| {
        let weight = if determinant > 1e-9 * m0 * m0 {
            w * (m2 - m1 * offset(i)) / determinant
        } else {
            w / m0
        };
        weight as f32
    };
    raw.iter().enumerate().map(fit).collect()
}

/// A brick's surroundings, as far as the kernels reach: shape (z, y, x), x fastest.
struct Tile {
    size: [usize; 3],
    distance: Vec<f32>,
}

impl Tile {
    fn gather(directory: &Directory, place: [usize; 3], distance: &[f32], kernels: &[Kernels; 3]) -> Self {
        let radius: [usize; 3] = std::array::from_fn(|a| kernels[a].radius);
        let size = radius.map(|r| EDGE + 2 * r);
        let mut tile = vec![0.0; size.iter().product()];
        let low: [isize; 3] = std::array::from_fn(|a| (place[a] * EDGE) as isize - radius[a] as isize);
        let bricks = |a: usize| {
            let first = low[a].div_euclid(EDGE as isize).max(0);
            let last = (low[a] + size[a] as isize - 1).div_euclid(EDGE as isize);
            first..=last
        };
        for bz in bricks(2) {
            for by in bricks(1) {
                for bx in bricks(0) {
                    let at = [bx, by, bz];
                    if let Some(brick) = directory.brick(at.map(|b| b as usize)) {
                        copy_brick(&distance[brick * BRICK..][..BRICK], at, low, size, &mut tile);
                    }
                }
            }
        }
        Self {
            size,
            distance: tile,
        }
    }

    /// Smooths distance and mask into `out`, one pair a voxel of the brick.
    fn smooth(&self, kernels: &[Kernels; 3], place: [usize; 3], sigma: f64, out: &mut [[f32; 2]]) {
        if self.distance.iter().all(|&d| d == 0.0) {
            return;
        }
        let mask: Vec<f32> = self.distance.iter().map(|&d| f32::from(d > 0.0)).collect();
        let ridge = self.separable(&self.distance, kernels, place);
        let mask = self.separable(&mask, kernels, place);
        let thick = self.local_maximum(kernels);
        for i in 0..BRICK {
            // Half a voxel lies between the last labelled centre and the face.
            let half = f64::from(thick[i]) - 0.5;
            let endless = erf(half.max(0.5) / (std::f64::consts::SQRT_2 * sigma));
            out[i] = [ridge[i], mask[i] / endless as f32];
        }
    }

    /// Convolution along z, then y, then x, each pass keeping only what the next one needs.
    fn separable(&self, input: &[f32], kernels: &[Kernels; 3], place: [usize; 3]) -> Vec<f32> {
        let [nx, ny, _] = self.size;
        let plane = nx * ny;
        let mut along_z = vec![0.0; EDGE * plane];
        for (z, out) in along_z.chunks_exact_mut(plane).enumerate() {
            for (k, &w) in kernels[2].at(place[2] * EDGE + z).iter().enumerate() {
                accumulate(out, &input[(z + k) * plane..][..plane], w);
            }
        }
        let mut along_y = vec![0.0; LAYER * nx];
        for (row, out) in along_y.chunks_exact_mut(nx).enumerate() {
            let (z, y) = (row / EDGE, row % EDGE);
            for (k, &w) in kernels[1].at(place[1] * EDGE + y).iter().enumerate() {
                accumulate(out, &along_z[z * plane + (y + k) * nx..][..nx], w);
            }
        }
        let mut result = vec![0.0; BRICK];
        for (row, out) in result.chunks_exact_mut(EDGE).enumerate() {
            for (x, out) in out.iter_mut().enumerate() {
                let weights = kernels[0].at(place[0] * EDGE + x);
                let input = &along_y[row * nx + x..][..weights.len()];
                *out = input.iter().zip(weights).map(|(v, w)| v * w).sum();
            }
        }
        result
    }

    /// The largest distance within the kernels' reach of each voxel of the brick.
    fn local_maximum(&self, kernels: &[Kernels; 3]) -> Vec<f32> {
        let [nx, ny, _] = self.size;
        let plane = nx * ny;
        let reach: [usize; 3] = std::array::from_fn(|a| 2 * kernels[a].radius + 1);
        let mut along_z = vec![0.0f32; EDGE * plane];
        for (z, out) in along_z.chunks_exact_mut(plane).enumerate() {
            for k in 0..reach[2] {
                raise(out, &self.distance[(z + k) * plane..][..plane]);
            }
        }
        let mut along_y = vec![0.0f32; LAYER * nx];
        for (row, out) in along_y.chunks_exact_mut(nx).enumerate() {
            let (z, y) = (row / EDGE, row % EDGE);
            for k in 0..reach[1] {
                raise(out, &along_z[z * plane + (y + k) * nx..][..nx]);
            }
        }
        let mut result = vec![0.0f32; BRICK];
        for (row, out) in result.chunks_exact_mut(EDGE).enumerate() {
            for k in 0..reach[0] {
                raise(out, &along_y[row * nx + k..][..EDGE]);
            }
        }
        result
    }
}

fn accumulate(out: &mut [f32], input: &[f32], weight: f32) {
    for (out, v) in out.iter_mut().zip(input) {
        *out += weight * v;
    }
}

fn raise(out: &mut [f32], input: &[f32]) {
    for (out, v) in out.iter_mut().zip(input) {
        *out = out.max(*v);
    }
}

/// Copies the part of a brick that lies in a tile whose first voxel is `low`.
fn copy_brick(brick: &[f32], at: [isize; 3], low: [isize; 3], size: [usize; 3], tile: &mut [f32]) {
    let overlap: [(usize, usize, usize); 3] = std::array::from_fn(|a| {
        let start = at[a] * EDGE as isize - low[a];
        let from = (-start).max(0) as usize;
        let to = (size[a] as isize - start).min(EDGE as isize) as usize;
        (from, to, (start + from as isize) as usize)
    });
    let [(x0, x1, tx), (y0, y1, ty), (z0, z1, tz)] = overlap;
    for z in z0..z1 {
        for y in y0..y1 {
            let from = z * LAYER + y * EDGE;
            let to = ((tz + z - z0) * size[1] + ty + y - y0) * size[0] + tx;
            tile[to..to + x1 - x0].copy_from_slice(&brick[from + x0..from + x1]);
        }
    }
}

/// The error function, by Abramowitz and Stegun 7.1.26 (absolute error below 1.5e-7).
fn erf(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.3275911 * x.abs());
    let series = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t
        + 0.254829592)
        * t;
    (1.0 - series * (-x * x).exp()).copysign(x)
}
