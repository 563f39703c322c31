//! Stage 4b, ridge field → sheet: the normal of the sheet in every voxel, and how far along it the
//! middle is.
//!
//! The crest of the ridge field f is where its gradient g has no component along the normal n.
//! Taking n from the Hessian H alone fails near faces and rims, so the Hessians' eigenvectors e of
//! the most negative curvature are smoothed as tensors, T = G_ρ * (w e eᵀ), which has no sign to
//! average away; n is T's principal eigenvector. The weight w = c D⁴, with c how clearly e stands
//! out, lets the middle of the sheet speak for its rims. The offset to the crest is the Newton step
//! for log f, −(g · n) f / (f nᵀ H n − (g · n)²), which is exact at any distance where the profile of
//! f across the sheet is a Gaussian, as it is for thin sheets. Since only the component along n counts, a slope of f within the sheet, as
//! it is near every rim, does not pull the crest aside.

use crate::bricks::{Batch, Directory, BRICK, EDGE, LAYER};
use crate::eigen::{eigenvalues, eigenvector, Symmetric};
use crate::error::{zeros, Result};
use crate::execution::Execution;
use crate::grid::{dot, Vec3};
use crate::separable::{smooth, Kernel};

/// No sheet is taken to have shrunk by more, work units.
const MOST_SHRUNK: f64 = 0.75;

/// What a voxel knows of its sheet: the unit normal, of either sign, and the distance from the voxel
/// to the crest along it, work units. All zero where the voxel knows none. An array, so that the
/// allocator can zero a field of them.
pub(crate) type Sheet = [f32; 4];

/// The normal of a voxel's sheet, `None` where the voxel knows none.
pub(crate) fn normal(sheet: &Sheet) -> Option<Vec3> {
    let [x, y, z, _] = sheet.map(f64::from);
    (*sheet != [0.0; 4]).then_some([x, y, z])
}

/// Passes over all bricks that [`sheets`] makes, for its progress.
pub(crate) const PASSES: usize = 23;

/// An offset beyond this many σ (plus half a unit) is no longer that of a parabola.
const TRUSTED: f64 = 1.3;

/// The sheets of all voxels near the parts. `scale` is σ of each part, `h` the work spacing.
pub(crate) fn sheets(
    batch: &Batch,
    scale: &[f64],
    distance: &[f32],
    ridge: &[f32],
    h: Vec3,
    scratch: &mut Vec<f32>,
    execution: &mut Execution,
) -> Result<Vec<Sheet>> {
    let mut sources: Vec<[f32; 3]> = zeros(ridge.len())?;
    execution.fill(&mut sources, BRICK, |brick, out| {
        let block = Block::gather(batch, brick, ridge);
        for (i, out) in out.iter_mut().enumerate() {
            let d = f64::from(distance[brick * BRICK + i]);
            if d > 0.0 {
                *out = source(block.derivatives(i, h).1, d);
            }
        }
    })?;
    let kernels: Vec<[Kernel; 3]> = scale
        .iter()
        .zip(&batch.directories)
        .map(|(sigma, directory)| {
            let rho = (1.4 * sigma).clamp(1.2, 3.0);
            Kernel::axes(rho, 1.7 * rho, h, directory)
        })
        .collect();
    // Eigenvectors do not change when a multiple of the identity is taken off: e_z² of it, and
    // five fields are left of six.
    let entries: [fn(&[f32; 3]) -> f32; 5] = [
        |e| e[0] * e[0] - e[2] * e[2],
        |e| e[1] * e[1] - e[2] * e[2],
        |e| e[0] * e[1],
        |e| e[0] * e[2],
        |e| e[1] * e[2],
    ];
    let mut tensor = Vec::with_capacity(entries.len());
    for entry in entries {
        let mut product = batch.field()?;
        execution.fill(&mut product, BRICK, |brick, out| {
            for (out, e) in out.iter_mut().zip(&sources[brick * BRICK..]) {
                *out = entry(e);
            }
        })?;
        tensor.push(smooth(batch, &kernels, product, scratch, execution)?);
    }
    drop(sources);
    let mut sheets: Vec<Sheet> = zeros(ridge.len())?;
    execution.fill(&mut sheets, BRICK, |brick, out| {
        let block = Block::gather(batch, brick, ridge);
        let near = Block::gather(batch, brick, distance);
        let sigma = scale[batch.part_of_brick[brick] as usize];
        for (i, out) in out.iter_mut().enumerate() {
            let entry = brick * BRICK + i;
            if distance[entry] > 0.0 || near.any_near(i) {
                let [xx, yy, xy, xz, yz] = std::array::from_fn(|k| f64::from(tensor[k][entry]));
                let tensor = [xx, yy, 0.0, xy, xz, yz];
                *out = sheet(tensor, block.value(i), block.derivatives(i, h), sigma);
            }
        }
    })?;
    Ok(sheets)
}

/// Takes back what smoothing shrank: under a Gaussian of variance σ² the crest of a curved sheet
/// moves by ½ σ² div n against n, as the heat equation says for a function of the distance to it.
pub(crate) fn unshrink(
    batch: &Batch,
    variance: &[f64],
    sheets: &mut Vec<Sheet>,
    h: Vec3,
    execution: &mut Execution,
) -> Result<()> {
    let mut corrected: Vec<Sheet> = zeros(sheets.len())?;
    execution.fill(&mut corrected, BRICK, |brick, out| {
        let (directory, _) = batch.brick(brick);
        let half_variance = 0.5 * variance[batch.part_of_brick[brick] as usize];
        for (i, out) in out.iter_mut().enumerate() {
            *out = sheets[brick * BRICK + i];
            if normal(out).is_some() {
                let shift = half_variance * divergence(directory, brick, i, sheets, h);
                out[3] += shift.clamp(-MOST_SHRUNK, MOST_SHRUNK) as f32;
            }
        }
    })?;
    *sheets = corrected;
    Ok(())
}

/// div n at voxel i of the brick at `place`; differences with unknown neighbours are left out.
fn divergence(directory: &Directory, brick: usize, i: usize, sheets: &[Sheet], h: Vec3) -> f64 {
    let voxel = [i % EDGE, i / EDGE % EDGE, i / LAYER].map(|v| v as isize);
    let place = directory.places[brick - directory.first];
    let known = |at: [isize; 3]| {
        let within = at.iter().all(|v| (0..EDGE as isize).contains(v));
        let entry = if within {
            let [x, y, z] = at.map(|v| v as usize);
            brick * BRICK + z * LAYER + y * EDGE + x
        } else {
            neighbour(directory, place, at)?
        };
        normal(&sheets[entry])
    };
    let Some(own) = known(voxel) else {
        return 0.0;
    };
    (0..3)
        .map(|axis| {
            let along_axis = |step: isize| {
                let mut at = voxel;
                at[axis] += step;
                known(at).map(|n| (n[axis] * dot(n, own).signum(), step as f64))
            };
            let (low, high) = (along_axis(-1), along_axis(1));
            let (a, b) = (
                low.unwrap_or((own[axis], 0.0)),
                high.unwrap_or((own[axis], 0.0)),
            );
            if a.1 == b.1 {
                0.0
            } else {
                (b.0 - a.0) / ((b.1 - a.1) * h[axis])
            }
        })
        .sum()
}

/// The eigenvector of the most negative curvature, times the square root of its weight.
fn source(hessian: Symmetric, distance: f64) -> [f32; 3] {
    let [first, second, _] = eigenvalues(hessian);
    if first >= 0.0 {
        return [0.0; 3];
    }
    let e = eigenvector(hessian, first);
    let clear = ((first - second.min(0.0)) / first).clamp(0.0, 1.0);
    let weight = clear.sqrt() * distance * distance;
    e.map(|v| (v * weight) as f32)
}

fn sheet(
    tensor: Symmetric,
    value: f64,
    (gradient, hessian): (Vec3, Symmetric),
    sigma: f64,
) -> Sheet {
    let n = eigenvector(tensor, eigenvalues(tensor)[2]);
    let [xx, yy, zz, xy, xz, yz] = hessian;
    let bent = [
        xx * n[0] + xy * n[1] + xz * n[2],
        xy * n[0] + yy * n[1] + yz * n[2],
        xz * n[0] + yz * n[1] + zz * n[2],
    ];
    let slope = dot(gradient, n);
    let curvature = value * dot(n, bent) - slope * slope;
    let offset = -slope * value / curvature;
    let known = value > 0.0 && curvature < 0.0 && offset.abs() <= TRUSTED * sigma + 0.5;
    if known {
        [n[0], n[1], n[2], offset].map(|v| v as f32)
    } else {
        Sheet::default()
    }
}

/// A brick with one voxel around it: shape (10, 10, 10), x fastest.
struct Block {
    values: Vec<f32>,
}

const SIDE: usize = EDGE + 2;

impl Block {
    fn gather(batch: &Batch, brick: usize, field: &[f32]) -> Self {
        let (directory, place) = batch.brick(brick);
        let mut values = vec![0.0; SIDE * SIDE * SIDE];
        for z in 0..SIDE {
            for y in 0..SIDE {
                let row = &mut values[(z * SIDE + y) * SIDE..][..SIDE];
                let at = |x: usize| [x, y, z].map(|v| v as isize - 1);
                let middle = neighbour(directory, place, at(1));
                if let Some(entry) = middle {
                    row[1..=EDGE].copy_from_slice(&field[entry..][..EDGE]);
                }
                for x in [0, SIDE - 1] {
                    let entry = neighbour(directory, place, at(x));
                    row[x] = entry.map_or(0.0, |entry| field[entry]);
                }
            }
        }
        let mut block = Self { values };
        block.continue_beyond(directory, place);
        block
    }

    /// Continues the field linearly across the borders of the volume.
    fn continue_beyond(&mut self, directory: &Directory, place: [usize; 3]) {
        for axis in 0..3 {
            let stride = [1, SIDE, SIDE * SIDE][axis];
            let last = directory.dimensions[axis] - 1;
            let low = (place[axis] == 0).then_some((0, 1isize));
            let high = (last / EDGE == place[axis]).then_some((last % EDGE + 2, -1));
            for (layer, inward) in low.into_iter().chain(high) {
                for i in 0..SIDE * SIDE {
                    let (a, b) = (i % SIDE, i / SIDE);
                    let other = [[SIDE, SIDE * SIDE], [1, SIDE * SIDE], [1, SIDE]][axis];
                    let at = a * other[0] + b * other[1] + layer * stride;
                    let step = |k: isize| (at as isize + inward * k * stride as isize) as usize;
                    let second = if last == 0 { step(1) } else { step(2) };
                    self.values[at] = 2.0 * self.values[step(1)] - self.values[second];
                }
            }
        }
    }

    /// Position of voxel i of the brick.
    fn position(i: usize) -> usize {
        ((i / LAYER + 1) * SIDE + i / EDGE % EDGE + 1) * SIDE + i % EDGE + 1
    }

    /// The field at voxel i of the brick.
    fn value(&self, i: usize) -> f64 {
        self.values[Self::position(i)].into()
    }

    /// Whether voxel i or one of its 26 neighbours is not zero.
    fn any_near(&self, i: usize) -> bool {
        let p = Self::position(i);
        [0, SIDE, 2 * SIDE].iter().any(|dy| {
            [0, SIDE * SIDE, 2 * SIDE * SIDE].iter().any(|dz| {
                let from = p + dy + dz - SIDE - SIDE * SIDE - 1;
                self.values[from..from + 3].iter().any(|&v| v > 0.0)
            })
        })
    }

    /// Gradient and Hessian at voxel i by central differences.
    fn derivatives(&self, i: usize, h: Vec3) -> (Vec3, Symmetric) {
        let p = Self::position(i);
        let stride = [1, SIDE, SIDE * SIDE];
        let at = |q: usize| f64::from(self.values[q]);
        let centre = at(p);
        let gradient =
            std::array::from_fn(|a| (at(p + stride[a]) - at(p - stride[a])) / (2.0 * h[a]));
        let second =
            |a: usize| (at(p + stride[a]) - 2.0 * centre + at(p - stride[a])) / (h[a] * h[a]);
        let mixed = |a: usize, b: usize| {
            let (s, t) = (stride[a], stride[b]);
            (at(p + s + t) - at(p + s - t) - at(p + t - s) + at(p - s - t)) / (4.0 * h[a] * h[b])
        };
        let hessian = [
            second(0),
            second(1),
            second(2),
            mixed(0, 1),
            mixed(0, 2),
            mixed(1, 2),
        ];
        (gradient, hessian)
    }
}

/// Entry of a voxel given relative to a brick, from −1 to 8 along each axis.
fn neighbour(directory: &Directory, place: [usize; 3], at: [isize; 3]) -> Option<usize> {
    directory.entry_at(std::array::from_fn(|a| (place[a] * EDGE) as isize + at[a]))
}
