//! Core sheets → core sheets whose normals lag less near rims.
//!
//! Normals are smoothed over what there is of a sheet, which near a rim lies to one side. Their mean
//! is the normal at the centre of the weights there, δ = ρ² ∇ ln W away, with ρ² the variance of the
//! Gaussian and W the smoothed weight (the mean shift of Comaniciu and Meer 2002). How much the normal
//! changes on the way back the sheet's bend says (`bending.rs`): near the rim of a thick cap that is
//! up to ten degrees, by which the middle would be looked for askew. The offset is found again along
//! the new normal.
//!
//! To first order only: where a sheet bends otherwise at its rim than around, the lag stays.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::block::{row, Block, SIDE};
use crate::fields::bricks::{Batch, BRICK, EDGE, LAYER};
use crate::fields::vectors::with_widest_vectors;
use crate::grid::Vec3;
use crate::sheets::bending::{self, bends, Bend};
use crate::sheets::crest::rho;
use crate::sheets::profile::Profile;
use crate::sheets::sheet::{dot, is_trusted, normal, Sheet};

/// Nothing lies farther than this many ρ from the centre of what it was smoothed from.
const FARTHEST: f32 = 1.5;
/// A normal stays where turning it would move the middle by less than this a way of ρ off, work units:
/// the bends of thin sheets are known no better.
const LEAST: f32 = 0.1;

/// Passes over all bricks that [`turn_lagging`] makes, for its progress.
pub(crate) const PASSES: usize = bending::PASSES + 1;

/// Turns the normals of sheets where they lag, and finds their offsets, of up to `farthest`, again.
/// `sigma` is the scale of each brick, `weight` what tensors were smoothed from at each voxel.
pub(crate) fn turn_lagging(
    batch: &Batch,
    (profile, sigma, weight): (&Profile, &[f32], &[f32]),
    farthest: f32,
    h: Vec3,
    sheets: &mut [Sheet],
    execution: &mut Execution,
) -> Result<()> {
    let bends = bends(batch, sheets, h, execution)?;
    execution.fill(sheets, BRICK, |brick, sheets| {
        if sheets.iter().all(|sheet| *sheet == Sheet::default()) {
            return;
        }
        let weight = Block::smooth(batch, brick, weight);
        let turned = turned(sheets, &weight, (&bends[brick], rho(sigma[brick])), h);
        let is_turned = |row: usize| turned[row * EDGE..][..EDGE].iter().any(Option::is_some);
        if !(0..LAYER).any(is_turned) {
            return;
        }
        let rows = with_widest_vectors(
            #[inline(always)]
            || profile.derivatives(batch, brick, is_turned, h),
        );
        let spacing = h.map(|h| h as f32);
        for own in &rows {
            for x in 0..EDGE {
                let i = own.row * EDGE + x;
                let Some(n) = turned[i] else {
                    continue;
                };
                let (offset, ..) = own.step(x, n);
                if is_trusted(offset, own.sigma[x], farthest) {
                    sheets[i] = [n[0], n[1], n[2], own.way_to_middle(offset, x, spacing)];
                }
            }
        }
    })
}

/// The normals of a brick's sheets without their lag, `None` where there is no sheet or hardly any lag.
fn turned(
    sheets: &[Sheet],
    weight: &Block<f32>,
    (bend, rho): (&Bend, f32),
    h: Vec3,
) -> [Option<[f32; 3]>; BRICK] {
    std::array::from_fn(|i| {
        let n = normal(&sheets[i])?.map(|v| v as f32);
        let at = row(i / EDGE % EDGE, i / LAYER) + i % EDGE;
        let way = along_sheet(n, shift(weight, at, rho, h));
        let change = bend.change(n, way.map(|v| -v));
        if rho * dot(change, change).sqrt() < LEAST {
            return None;
        }
        let n = [n[0] + change[0], n[1] + change[1], n[2] + change[2]];
        let length = dot(n, n).sqrt();
        Some(n.map(|v| v / length))
    })
}

/// From a voxel to the centre of what it was smoothed from.
fn shift(weight: &Block<f32>, at: usize, rho: f32, h: Vec3) -> [f32; 3] {
    let w = &weight.values;
    let own = w[at].max(f32::MIN_POSITIVE);
    let along = |a: usize| {
        let stride = [1, SIDE, SIDE * SIDE][a];
        rho * rho * (w[at + stride] - w[at - stride]) / (2.0 * h[a] as f32 * own)
    };
    let shift = [along(0), along(1), along(2)];
    let length = dot(shift, shift).sqrt();
    let share = (FARTHEST * rho / length.max(f32::MIN_POSITIVE)).min(1.0);
    shift.map(|v| share * v)
}

/// What of a way is at right angles to the normal.
fn along_sheet(n: [f32; 3], way: [f32; 3]) -> [f32; 3] {
    let across = dot(n, way);
    std::array::from_fn(|a| way[a] - across * n[a])
}
