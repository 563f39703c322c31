//! Stage 4b, ridge field → sheet: the normal of the sheet in every voxel, and how far along it the
//! middle is.
//!
//! The crest of the ridge field f is where its gradient g has no component along the normal n.
//! Taking n from the Hessian H alone fails near faces and rims, so the Hessians' eigenvectors e of
//! the most negative curvature are smoothed as tensors, T = G_ρ * (w e eᵀ), which has no sign to
//! average away; n is T's principal eigenvector. The weight w = c D⁴, with c how clearly e stands
//! out, lets the middle of the sheet speak for its rims. The offset to the crest is the Newton step
//! for log f, −(g · n) f / (f nᵀ H n − (g · n)²), which is exact at any distance where the profile of
//! f across the sheet is a Gaussian, as it is for thin sheets. Since only the component along n
//! counts, a slope of f within the sheet, as it is near every rim, does not pull the crest aside.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::block::{matrix_at, row, vector_at, Block, Row, SIDE};
use crate::fields::bricks::{Batch, BRICK, EDGE};
use crate::fields::eigen::{eigenvalues, eigenvector, Symmetric};
use crate::fields::separable::{smooth, Kernel};
use crate::fields::vectors::with_widest_vectors;
use crate::grid::Vec3;

/// No sheet is taken to have shrunk by more, work units.
const MOST_SHRUNK: f32 = 0.75;

/// What a voxel knows of its sheet: the unit normal, of either sign, and the distance from the voxel
/// to the crest along it, work units. All zero where the voxel knows none. An array, so that the
/// allocator can zero a field of them.
pub(crate) type Sheet = [f32; 4];

/// The normal of a voxel's sheet, `None` where the voxel knows none.
pub(crate) fn normal(sheet: &Sheet) -> Option<Vec3> {
    let [x, y, z, _] = sheet.map(f64::from);
    (*sheet != [0.0; 4]).then_some([x, y, z])
}

/// A number that sorts as the sheets' offsets do, and where they are the same by their `index`,
/// which is its low half.
pub(crate) fn by_offset(sheet: &Sheet, index: usize) -> u64 {
    let bits = sheet[3].to_bits();
    // Negative numbers come first, in reverse.
    let sortable = bits ^ if bits >> 31 == 1 { u32::MAX } else { 1 << 31 };
    u64::from(sortable) << 32 | index as u64
}

/// Passes over all bricks that [`sheets`] and [`unshrink`] make, for their progress.
pub(crate) const PASSES: usize = 24;

/// An offset beyond this many σ (plus half a unit) is no longer that of a parabola.
const TRUSTED: f64 = 1.3;

/// Whether an offset is such that it tells where the middle is, and no more than `farthest`.
#[inline(always)]
pub(crate) fn is_trusted(offset: f32, sigma: f32, farthest: f32) -> bool {
    offset.abs() <= (TRUSTED as f32 * sigma + 0.5).min(farthest)
}

/// Entries of the tensor e eᵀ − e_z² I: xx, yy, xy, xz, yz. Eigenvectors do not change when a
/// multiple of the identity is taken off, so that five are enough.
pub(crate) const ENTRIES: usize = 5;

/// Rows and columns of the entries.
const PLACES: [[usize; 2]; ENTRIES] = [[0, 0], [1, 1], [0, 1], [0, 2], [1, 2]];

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
    let bricks = batch.part_of_brick.len();
    let sources = execution.collect(bricks, |brick| {
        let distance = &distance[brick * BRICK..][..BRICK];
        if distance.iter().all(|d| *d == 0.0) {
            return [[0.0; BRICK]; 3];
        }
        let ridge = Block::smooth(batch, brick, ridge);
        with_widest_vectors(
            #[inline(always)]
            || sources_of_brick(&ridge, distance, h),
        )
    })?;
    let kernels: Vec<[Kernel; 3]> = scale
        .iter()
        .zip(&batch.directories)
        .map(|(sigma, directory)| {
            let rho = (1.4 * sigma).clamp(1.2, 3.0);
            Kernel::axes(rho, 1.7 * rho, h, directory)
        })
        .collect();
    let mut tensor = Vec::with_capacity(ENTRIES);
    for place in PLACES {
        let field = execution.collect(bricks, |brick| product(&sources[brick], place))?;
        let field = field.into_flattened();
        tensor.push(smooth(batch, &kernels, field, scratch, execution)?);
    }
    drop(sources);
    let sheets = execution.collect(bricks, |brick| {
        let near = Block::gather(batch, brick, distance);
        if near.values.iter().all(|d| *d == 0.0) {
            return [Sheet::default(); BRICK];
        }
        let tensor = std::array::from_fn(|k| &tensor[k][brick * BRICK..][..BRICK]);
        let sigma = scale[batch.part_of_brick[brick] as usize];
        let ridge = Block::smooth(batch, brick, ridge);
        with_widest_vectors(
            #[inline(always)]
            || sheets_of_brick(&ridge, tensor, &near.largest_near(), sigma, h),
        )
    })?;
    Ok(sheets.into_flattened())
}

/// [`source`] of a brick's voxels; zero outside the label.
#[inline(always)]
fn sources_of_brick(ridge: &Block<f32>, distance: &[f32], h: Vec3) -> [[f32; BRICK]; 3] {
    let mut sources = [[0.0; BRICK]; 3];
    for (row, distance) in distance.chunks_exact(EDGE).enumerate() {
        if distance.iter().all(|d| *d == 0.0) {
            continue;
        }
        let (_, hessian) = ridge.row_derivatives(row % EDGE, row / EDGE, h);
        let mut found: [Row; 3] = [[0.0; EDGE]; 3];
        for i in 0..EDGE {
            let e = source(matrix_at(&hessian, i), distance[i]);
            for (found, v) in found.iter_mut().zip(e) {
                found[i] = v;
            }
        }
        for (sources, found) in sources.iter_mut().zip(&found) {
            sources[row * EDGE..][..EDGE].copy_from_slice(found);
        }
    }
    sources
}

/// An entry of the tensors of a brick's voxels.
fn product(e: &[[f32; BRICK]; 3], [row, column]: [usize; 2]) -> [f32; BRICK] {
    let mut product = [0.0; BRICK];
    let on_diagonal = if row == column { 1.0 } else { 0.0 };
    for (i, product) in product.iter_mut().enumerate() {
        *product = e[row][i] * e[column][i] - on_diagonal * e[2][i] * e[2][i];
    }
    product
}

/// The eigenvector of the most negative curvature, times the square root of its weight.
#[inline(always)]
pub(crate) fn source(hessian: Symmetric<f32>, distance: f32) -> [f32; 3] {
    let [first, second, _] = eigenvalues(hessian);
    let e = eigenvector(hessian, first);
    let second = if second < 0.0 { second } else { 0.0 };
    // How clearly the first one stands out, 0 to 1.
    let clear = (first - second) / first;
    let clear = if first < 0.0 && clear > 0.0 {
        clear
    } else {
        0.0
    };
    let weight = clear.sqrt() * distance * distance;
    [e[0] * weight, e[1] * weight, e[2] * weight]
}

/// The sheets of a brick's voxels from the entries of the smoothed tensor, where the label is `near`.
#[inline(always)]
fn sheets_of_brick(
    ridge: &Block<f32>,
    tensor: [&[f32]; ENTRIES],
    near: &[f32],
    sigma: f64,
    h: Vec3,
) -> [Sheet; BRICK] {
    let mut sheets = [Sheet::default(); BRICK];
    let most = (TRUSTED * sigma + 0.5) as f32;
    for (row, near) in near.chunks_exact(EDGE).enumerate() {
        if near.iter().all(|d| *d == 0.0) {
            continue;
        }
        let (y, z) = (row % EDGE, row / EDGE);
        let value = ridge.row(y, z);
        let (gradient, hessian) = ridge.row_derivatives(y, z, h);
        // Copies, whose length is known: only then do the eight voxels run side by side.
        let mut entries: [Row; ENTRIES] = [[0.0; EDGE]; ENTRIES];
        for (own, entry) in entries.iter_mut().zip(&tensor) {
            own.copy_from_slice(&entry[row * EDGE..][..EDGE]);
        }
        let mut found: [Row; 4] = [[0.0; EDGE]; 4];
        for i in 0..EDGE {
            let [xx, yy, xy, xz, yz] = entries;
            let [xx, yy, xy, xz, yz] = [xx[i], yy[i], xy[i], xz[i], yz[i]];
            let sheet = sheet(
                [xx, yy, 0.0, xy, xz, yz],
                value[i],
                vector_at(&gradient, i),
                matrix_at(&hessian, i),
            );
            let known = (near[i] > 0.0) & (sheet[3].abs() <= most);
            for (found, v) in found.iter_mut().zip(sheet) {
                found[i] = if known { v } else { 0.0 };
            }
        }
        for (i, sheet) in sheets[row * EDGE..][..EDGE].iter_mut().enumerate() {
            *sheet = [found[0][i], found[1][i], found[2][i], found[3][i]];
        }
    }
    sheets
}

/// Normal and offset from a smoothed tensor and the ridge field's derivatives; the offset is no
/// number where the field has no crest along the normal.
#[inline(always)]
fn sheet(tensor: Symmetric<f32>, value: f32, gradient: [f32; 3], hessian: Symmetric<f32>) -> Sheet {
    let n = eigenvector(tensor, eigenvalues(tensor)[2]);
    let [xx, yy, zz, xy, xz, yz] = hessian;
    let bent = [
        xx * n[0] + xy * n[1] + xz * n[2],
        xy * n[0] + yy * n[1] + yz * n[2],
        xz * n[0] + yz * n[1] + zz * n[2],
    ];
    let slope = dot(gradient, n);
    let curvature = value * dot(n, bent) - slope * slope;
    let has_crest = (value > 0.0) & (curvature < 0.0);
    let offset = if has_crest {
        -slope * value / curvature
    } else {
        f32::NAN
    };
    [n[0], n[1], n[2], offset]
}

#[inline(always)]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// How long a voxel of the spacing `h` is along a unit vector.
#[inline(always)]
pub(crate) fn voxel_along(n: [f32; 3], h: [f32; 3]) -> f32 {
    let along = [n[0] * h[0], n[1] * h[1], n[2] * h[2]];
    dot(along, along).sqrt()
}

impl Block<f32> {
    /// A smooth field around a brick.
    pub(crate) fn smooth(batch: &Batch, brick: usize, field: &[f32]) -> Self {
        let mut block = Self::gather(batch, brick, field);
        let (directory, place) = batch.brick(brick);
        block.continue_beyond(directory, place);
        block
    }
}

/// Takes back what smoothing shrank: under a Gaussian of variance σ² the crest of a curved sheet
/// moves by ½ σ² div n against n, as the heat equation says for a function of the distance to it.
pub(crate) fn unshrink(
    batch: &Batch,
    variance: impl Fn(usize) -> f64 + Sync,
    sheets: &mut [Sheet],
    h: Vec3,
    execution: &mut Execution,
) -> Result<()> {
    let mut shifts = batch.field()?;
    execution.fill(&mut shifts, BRICK, |brick, shifts| {
        let own = &sheets[brick * BRICK..][..BRICK];
        if own.iter().all(|sheet| *sheet == Sheet::default()) {
            return;
        }
        let half_variance = (0.5 * variance(brick)) as f32;
        let block = Block::gather(batch, brick, sheets);
        let divergence = with_widest_vectors(
            #[inline(always)]
            || divergence(&block.values, h),
        );
        for (shift, divergence) in shifts.iter_mut().zip(divergence) {
            *shift = (half_variance * divergence).clamp(-MOST_SHRUNK, MOST_SHRUNK);
        }
    })?;
    execution.fill(sheets, BRICK, |brick, sheets| {
        let shifts = &shifts[brick * BRICK..][..BRICK];
        for (sheet, shift) in sheets.iter_mut().zip(shifts) {
            // Pages without a sheet stay untouched.
            if *shift != 0.0 {
                sheet[3] += shift;
            }
        }
    })
}

/// div n at the voxels of a block's brick, differences with unknown neighbours left out; 0 at voxels
/// that know no sheet.
#[inline(always)]
fn divergence(sheets: &[Sheet; SIDE * SIDE * SIDE], h: Vec3) -> [f32; BRICK] {
    let mut normals = [[0.0; SIDE * SIDE * SIDE]; 3];
    for (i, sheet) in sheets.iter().enumerate() {
        for (normals, v) in normals.iter_mut().zip(sheet) {
            normals[i] = *v;
        }
    }
    let rows = |first: usize| normals.each_ref().map(|n| &n[first..first + EDGE]);
    let mut sum = [0.0; BRICK];
    for (i, sum) in sum.chunks_exact_mut(EDGE).enumerate() {
        let first = row(i % EDGE, i / EDGE);
        let own = rows(first);
        if own.iter().all(|n| n.iter().all(|v| *v == 0.0)) {
            continue;
        }
        for axis in 0..3 {
            let stride = [1, SIDE, SIDE * SIDE][axis];
            let (low, high) = (rows(first - stride), rows(first + stride));
            let per_step = 1.0 / h[axis] as f32;
            for x in 0..EDGE {
                let at = |n: &[&[f32]; 3]| [n[0][x], n[1][x], n[2][x]];
                sum[x] += per_step * difference(at(&low), at(&own), at(&high), axis);
            }
        }
    }
    sum
}

/// Difference of the normals' components along an axis, a step from `low` to `own` and one to
/// `high`, those turned to the side of `own`; unknown ones are zero, and so is the difference where
/// `own` is.
#[inline(always)]
fn difference(low: [f32; 3], own: [f32; 3], high: [f32; 3], axis: usize) -> f32 {
    let along_axis = |n: [f32; 3]| {
        let turned = if dot(n, own) < 0.0 { -n[axis] } else { n[axis] };
        if dot(n, n) > 0.0 {
            (turned, 1.0)
        } else {
            (own[axis], 0.0)
        }
    };
    let ((low, below), (high, above)) = (along_axis(low), along_axis(high));
    let steps: f32 = below + above;
    let per_step = if steps > 1.5 { 0.5 } else { steps };
    let known = if dot(own, own) > 0.0 { 1.0 } else { 0.0 };
    known * per_step * (high - low)
}
