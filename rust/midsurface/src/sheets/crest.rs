//! Profile → sheets, in any orientation: normal and offset to the middle for every voxel near one.
//!
//! As in `sheet.rs` the normal is the principal direction of the Hessians' first eigenvectors,
//! smoothed as tensors, and the offset the Newton step for the logarithm; here both come from the
//! profile (`profile.rs`), with a scale of each voxel's own. A voxel is a *core* voxel where it sees
//! the sheet only: not where the profile falls within the sheet as steeply as across, since there
//! another sheet joins, or the label ends in a curve, and not where the normals around disagree:
//! in the corner between two sheets their mean is the normal of neither, and would join them. Of a
//! ribbon hardly wider than it is thick no voxel would be one: there more bend is allowed. The
//! sheets of the other voxels follow from those of their core neighbours (`extension.rs`).

use rayon::prelude::*;

use crate::error::{collected, filled, zeros, Result};
use crate::execution::Execution;
use crate::fields::block::{matrix_at, vector_at, Block, Row};
use crate::fields::bricks::{Batch, BRICK, EDGE, LAYER};
use crate::fields::eigen::{eigenvalues, eigenvector};
use crate::fields::interpolation::Sampler;
use crate::fields::separable::Kernel;
use crate::fields::slabs::{smooth_in_slabs, Bricks};
use crate::fields::vectors::with_widest_vectors;
use crate::grid::Vec3;
use crate::sheets::border::Border;
use crate::sheets::lag::{self, turn_lagging};
use crate::sheets::profile::{Derivatives, Profile};
use crate::sheets::sheet::{dot, is_trusted, source, unshrink, voxel_along, Sheet, ENTRIES};

/// A core voxel's profile falls within the sheet by at most this much, in σ² times curvature.
const TANGENTIAL: f32 = 0.6;
/// and is curved within the sheet by at most this share of its curvature across.
const BENT: f32 = 0.32;
/// Where a part has no core voxel by that, it is a ribbon: wider than thick is enough.
const RIBBON: f32 = 0.8;
/// The normals around a core voxel vary by at most this share of what they have in common, as the
/// middle eigenvalue of their tensor over the largest, both above the least.
const VARIED: f32 = 0.15;
/// A voxel longer than this along the normal, work units, is no core voxel beside the label: there the
/// profile has fallen too far to tell where its crest is.
const LONG: f32 = 1.25;
/// Bounds of the standard deviation ρ of the tensors' smoothing, which is σ, in work units.
const RHO_BOUNDS: [f32; 2] = [1.2, 3.4];
/// Kernels of ρ are made at steps of this ratio.
const RHO_STEP: f32 = 1.1892;
/// The middle that a voxel beside the label tells of is at least so deep in the label, work units. Beyond
/// a ragged rim the profile has crests of its own between the spurs, and sheets would be led on from
/// these.
const FOUNDED: f64 = 0.6;
/// A border of the volume cuts a sheet's profile within this many σ, along the normal.
const REACH: f32 = 2.3;

/// Passes over all bricks that [`core_sheets`] makes, for its progress.
pub(crate) const PASSES: usize = 4 + lag::PASSES;

/// The sheets of the core voxels of a batch, with offsets of up to `farthest`.
pub(crate) fn core_sheets(
    batch: &Batch,
    profile: Profile,
    distance: &[f32],
    farthest: f32,
    h: Vec3,
    execution: &mut Execution,
) -> Result<Vec<Sheet>> {
    let bricks = batch.part_of_brick.len();
    let sigma = execution.collect(bricks, |brick| mean_sigma(&profile, batch, brick))?;
    let mut sheets: Vec<Sheet> = zeros(bricks * BRICK)?;
    let mut weight = batch.field()?;
    let everywhere = filled(true, bricks)?;
    let core = Core {
        batch,
        distance,
        profile: &profile,
        sigma: &sigma,
        farthest,
        h,
        wanted: &everywhere,
        bent: BENT,
    };
    core.find((&mut sheets, &mut weight), execution)?;
    let ribbons = bricks_without_core(batch, &sheets)?;
    if ribbons.contains(&true) {
        let (wanted, bent) = (&ribbons[..], RIBBON);
        let core = Core {
            wanted,
            bent,
            ..core
        };
        core.find((&mut sheets, &mut weight), execution)?;
    }
    let known = (&profile, &sigma[..], &weight[..]);
    turn_lagging(batch, known, farthest, h, &mut sheets, execution)?;
    drop((profile, weight));
    let variance = |brick: usize| f64::from(sigma[brick] * sigma[brick]);
    unshrink(batch, variance, &mut sheets, h, execution)?;
    Ok(sheets)
}

/// The bricks of parts of which no voxel is a core voxel.
fn bricks_without_core(batch: &Batch, sheets: &[Sheet]) -> Result<Vec<bool>> {
    let mut has_core: Vec<bool> = zeros(batch.directories.len())?;
    for (&part, own) in batch.part_of_brick.iter().zip(sheets.chunks_exact(BRICK)) {
        let has = &mut has_core[part as usize];
        *has = *has || own.iter().any(|sheet| *sheet != Sheet::default());
    }
    let parts = batch.part_of_brick.iter();
    collected(parts.map(|&part| !has_core[part as usize]))
}

/// What the sheets of core voxels are found from.
#[derive(Clone, Copy)]
struct Core<'a> {
    batch: &'a Batch<'a>,
    distance: &'a [f32],
    profile: &'a Profile,
    /// Mean σ of each brick.
    sigma: &'a [f32],
    farthest: f32,
    h: Vec3,
    /// The bricks in which they are looked for, and by how much they are bent at most.
    wanted: &'a [bool],
    bent: f32,
}

impl Core<'_> {
    /// Finds the sheets, and what tensors were smoothed from there.
    fn find(
        &self,
        (sheets, weight): (&mut [Sheet], &mut [f32]),
        execution: &mut Execution,
    ) -> Result<()> {
        let make = |brick: usize, tensors: &mut [f32]| self.make_tensors(brick, tensors);
        let (mut sheets, mut weight) = (Bricks::of(sheets)?, Bricks::of(weight)?);
        let take = |bricks: &[u32], tensors: &[f32], execution: &Execution| {
            let (sheets, weight) = (sheets.take(bricks)?, weight.take(bricks)?);
            execution.in_pool(|| {
                let tensors = tensors.par_chunks_exact(ENTRIES * BRICK);
                let out = sheets.into_par_iter().zip(weight);
                let all = bricks.par_iter().zip(tensors).zip(out);
                all.for_each(|((&brick, tensors), (sheets, weight))| {
                    self.find_in(brick as usize, tensors, sheets, weight);
                });
            });
            Ok(())
        };
        let kernels = tensor_kernels(self.batch, self.h);
        let kernel_of = |brick: usize| {
            let ratio = rho(self.sigma[brick]) / RHO_BOUNDS[0];
            let step = (ratio.log2() / RHO_STEP.log2()).round();
            self.wanted[brick].then(|| &kernels[step as usize])
        };
        let size = ENTRIES * BRICK;
        smooth_in_slabs(self.batch, kernel_of, size, make, take, execution)
    }

    /// Fills in the tensors of a brick before they are smoothed.
    fn make_tensors(&self, brick: usize, tensors: &mut [f32]) {
        let own = self.label(brick);
        if !self.wanted[brick] || own.iter().all(|d| *d == 0.0) {
            return;
        }
        let border = self.border(brick);
        with_widest_vectors(
            #[inline(always)]
            || {
                let derivatives = self.derivatives(brick, own);
                let bounds = (self.bent, self.h);
                find_tensors(&derivatives, own, border.as_ref(), bounds, tensors);
            },
        );
    }

    /// Finds the sheets in a brick from its tensors.
    fn find_in(&self, brick: usize, tensors: &[f32], sheets: &mut [Sheet], weight: &mut [f32]) {
        if !self.wanted[brick] {
            return;
        }
        if tensors.iter().any(|v| *v != 0.0) {
            with_widest_vectors(
                #[inline(always)]
                || find_weights(tensors, weight),
            );
        }
        let near = Block::gather(self.batch, brick, self.distance);
        if near.values.iter().all(|d| *d == 0.0) {
            return;
        }
        with_widest_vectors(
            #[inline(always)]
            || {
                let near = near.largest_near();
                let derivatives = self.derivatives(brick, &near);
                let label = (self.label(brick), &near[..]);
                let bounds = (self.farthest, self.bent, self.h);
                find_sheets(&derivatives, tensors, label, bounds, sheets);
            },
        );
        drop_unfounded((self.batch, brick), self.distance, self.h, sheets);
        if let Some(border) = self.border(brick) {
            for (i, sheet) in sheets.iter_mut().enumerate() {
                if border.cuts(i, [sheet[0], sheet[1], sheet[2]]) {
                    *sheet = Sheet::default();
                }
            }
        }
    }

    /// Distance to the outside at the voxels of a brick.
    fn label(&self, brick: usize) -> &[f32] {
        &self.distance[brick * BRICK..][..BRICK]
    }

    /// The profile's derivatives in those rows of a brick in which `field` is positive.
    #[inline(always)]
    fn derivatives(&self, brick: usize, field: &[f32]) -> Vec<Derivatives> {
        let wanted = |row: usize| row_of(field, row).iter().any(|d| *d > 0.0);
        self.profile.derivatives(self.batch, brick, wanted, self.h)
    }

    fn border(&self, brick: usize) -> Option<Border<'_>> {
        let reach = REACH * self.sigma[brick];
        Border::near(self.batch, brick, self.distance, reach, self.h)
    }
}

/// Mean σ of a brick's voxels that have one; 0 where none has.
fn mean_sigma(profile: &Profile, batch: &Batch, brick: usize) -> f32 {
    let sigma = profile.sigma(batch, brick);
    let (sum, count) = sigma
        .iter()
        .filter(|s| **s > 0.0)
        .fold((0.0, 0), |(sum, count), s| (sum + s, count + 1));
    if count > 0 {
        sum / count as f32
    } else {
        0.0
    }
}

/// Drops the sheets of a brick's voxels beside the label that tell of a middle where hardly any label is.
fn drop_unfounded(
    (batch, brick): (&Batch, usize),
    distance: &[f32],
    h: Vec3,
    sheets: &mut [Sheet],
) {
    let (directory, place) = batch.brick(brick);
    let depth = Sampler {
        directory,
        field: distance,
        h,
    };
    let own = &distance[brick * BRICK..][..BRICK];
    for (i, (sheet, d)) in sheets.iter_mut().zip(own).enumerate() {
        if *d > 0.0 || *sheet == Sheet::default() {
            continue;
        }
        let within = [i % EDGE, i / EDGE % EDGE, i / LAYER];
        let middle = std::array::from_fn(|a| {
            (place[a] * EDGE + within[a]) as f64 * h[a] + f64::from(sheet[3] * sheet[a])
        });
        if depth.linear(middle) < FOUNDED {
            *sheet = Sheet::default();
        }
    }
}

/// A row of a field of a brick.
#[inline(always)]
fn row_of(field: &[f32], row: usize) -> Row {
    let mut values = [0.0; EDGE];
    values.copy_from_slice(&field[row * EDGE..][..EDGE]);
    values
}

/// Fills in the tensors of a brick's voxels before smoothing, weighted; zero, as they were, outside
/// the label and where a border cuts the profile.
#[inline(always)]
fn find_tensors(
    rows: &[Derivatives],
    distance: &[f32],
    border: Option<&Border>,
    (most_bent, h): (f32, Vec3),
    tensors: &mut [f32],
) {
    let h = h.map(|h| h as f32);
    for own in rows.iter().copied() {
        let distance = row_of(distance, own.row);
        let mut sources = [[0.0; EDGE]; 3];
        for i in 0..EDGE {
            // Relative to σ, so that a thick sheet does not outshout a thin one beside it.
            let e = source(matrix_at(&own.hessian, i), distance[i] / own.sigma[i]);
            for (sources, v) in sources.iter_mut().zip(e) {
                sources[i] = v;
            }
        }
        if let Some(border) = border {
            for i in 0..EDGE {
                if border.cuts(own.row * EDGE + i, vector_at(&sources, i)) {
                    sources.iter_mut().for_each(|e| e[i] = 0.0);
                }
            }
        }
        let mut products = [[0.0; EDGE]; ENTRIES];
        for i in 0..EDGE {
            let e = vector_at(&sources, i);
            let trust = trust(&own, i, e, (most_bent, h));
            let e = [e[0] * trust, e[1] * trust, e[2] * trust];
            let zz = e[2] * e[2];
            let entries = [
                e[0] * e[0] - zz,
                e[1] * e[1] - zz,
                e[0] * e[1],
                e[0] * e[2],
                e[1] * e[2],
            ];
            for (products, v) in products.iter_mut().zip(entries) {
                products[i] = v;
            }
        }
        for (tensors, product) in tensors.chunks_exact_mut(BRICK).zip(&products) {
            tensors[own.row * EDGE..][..EDGE].copy_from_slice(product);
        }
    }
}

/// How far a voxel's own normal counts, 0 to 1: less the steeper the profile falls within the sheet, and
/// the farther off the middle is, but where voxels are long the nearest may be half of that away.
#[inline(always)]
fn trust(row: &Derivatives, i: usize, e: [f32; 3], (most_bent, h): (f32, [f32; 3])) -> f32 {
    let length = dot(e, e).sqrt().max(f32::MIN_POSITIVE);
    let n = [e[0] / length, e[1] / length, e[2] / length];
    let (offset, tangential, bent) = row.step(i, n);
    let most = TANGENTIAL * row.sigma[i];
    let longer = 0.5 * (voxel_along(n, h) - 1.0);
    let share = (tangential / most).max(offset.abs() / (most + longer));
    let clear = 1.0 - (bent / most_bent).max(0.0);
    if share < 1.0 && clear > 0.0 {
        (1.0 - share * share) * clear
    } else {
        0.0
    }
}

/// The standard deviation of the tensors' smoothing that goes with σ.
pub(crate) fn rho(sigma: f32) -> f32 {
    let [least, most] = RHO_BOUNDS;
    sigma.clamp(least, most)
}

/// Kernels for the tensors, a step of ρ each.
fn tensor_kernels(batch: &Batch, h: Vec3) -> Vec<[Kernel; 3]> {
    let [least, most] = RHO_BOUNDS;
    let steps = ((most / least).log2() / RHO_STEP.log2()).round() as i32;
    let of_step = |step: i32, directory| {
        let rho = f64::from(least * RHO_STEP.powi(step));
        Kernel::axes(rho, 1.7 * rho, h, directory)
    };
    // All directories have the dimensions of the volume.
    let directory = batch.directories.first();
    directory.map_or_else(Vec::new, |directory| {
        (0..=steps).map(|step| of_step(step, directory)).collect()
    })
}

/// Fills in what the tensors of a brick's voxels were smoothed from: their largest eigenvalue over the
/// least, which is that of no sheet.
#[inline(always)]
fn find_weights(tensors: &[f32], weights: &mut [f32]) {
    for (row, weights) in weights.chunks_exact_mut(EDGE).enumerate() {
        let [xx, yy, xy, xz, yz] = entries(tensors, row);
        let mut found = [0.0; EDGE];
        for i in 0..EDGE {
            let tensor = [xx[i], yy[i], 0.0, xy[i], xz[i], yz[i]];
            let [least, _, largest] = eigenvalues(tensor);
            found[i] = largest - least;
        }
        weights.copy_from_slice(&found);
    }
}

/// The entries of a row of tensors. Copies, whose length is known: only then do the eight voxels run
/// side by side.
#[inline(always)]
fn entries(tensors: &[f32], row: usize) -> [Row; ENTRIES] {
    let mut entries = [[0.0; EDGE]; ENTRIES];
    for (entry, tensors) in entries.iter_mut().zip(tensors.chunks_exact(BRICK)) {
        *entry = row_of(tensors, row);
    }
    entries
}

/// Fills in the sheets of a brick's core voxels, in the label or with the label `near`.
#[inline(always)]
fn find_sheets(
    rows: &[Derivatives],
    tensors: &[f32],
    (inside, near): (&[f32], &[f32]),
    (farthest, most_bent, h): (f32, f32, Vec3),
    sheets: &mut [Sheet],
) {
    let h = h.map(|h| h as f32);
    for own in rows.iter().copied() {
        let (inside, near) = (row_of(inside, own.row), row_of(near, own.row));
        let (normals, varied) = principal_directions(&entries(tensors, own.row));
        let mut found = [[0.0; EDGE]; 4];
        for i in 0..EDGE {
            let n = vector_at(&normals, i);
            let (offset, tangential, bent) = own.step(i, n);
            let close = (inside[i] > 0.0) | (voxel_along(n, h) <= LONG);
            let core = (near[i] > 0.0)
                & close
                & is_trusted(offset, own.sigma[i], farthest)
                & (tangential <= TANGENTIAL * own.sigma[i])
                & (bent <= most_bent)
                & (varied[i] <= VARIED);
            let offset = own.way_to_middle(offset, i, h);
            for (found, v) in found.iter_mut().zip([n[0], n[1], n[2], offset]) {
                found[i] = if core { v } else { 0.0 };
            }
        }
        for (i, sheet) in sheets[own.row * EDGE..][..EDGE].iter_mut().enumerate() {
            *sheet = [found[0][i], found[1][i], found[2][i], found[3][i]];
        }
    }
}

/// The principal directions of a row of tensors, and how much the normals that they are sums of vary:
/// the middle eigenvalue over the largest, both above the least.
#[inline(always)]
fn principal_directions([xx, yy, xy, xz, yz]: &[Row; ENTRIES]) -> ([Row; 3], Row) {
    let (mut directions, mut varied) = ([[0.0; EDGE]; 3], [0.0; EDGE]);
    for i in 0..EDGE {
        let tensor = [xx[i], yy[i], 0.0, xy[i], xz[i], yz[i]];
        let [least, middle, largest] = eigenvalues(tensor);
        let n = eigenvector(tensor, largest);
        varied[i] = (middle - least) / (largest - least).max(f32::MIN_POSITIVE);
        for (directions, v) in directions.iter_mut().zip(n) {
            directions[i] = v;
        }
    }
    (directions, varied)
}
