//! Sheets that agree: each voxel's offset becomes the mean of what it and its neighbours say.
//!
//! Neighbours on one sheet know of the same surface, each with an error of its own. What a neighbour
//! says of a voxel follows from the mean of both normals, which is exact to second order, so that a
//! curved sheet is not flattened. Voxels that do not speak of the same sheet are not asked.

use crate::error::{zeros, Result};
use crate::execution::Execution;
use crate::fields::block::{row, Block, SIDE};
use crate::fields::bricks::{Batch, BRICK, EDGE};
use crate::grid::Vec3;
use crate::sheets::sheet::{by_offset, dot, Sheet};

/// Neighbours that speak of the same sheet: normals within this cosine, offsets within this many
/// work units of the one in the middle.
const ALIKE: f32 = 0.7;
const NEAR: f32 = 0.7;

/// Lets the sheets settle, so many times.
pub(crate) fn settle(
    batch: &Batch,
    sheets: &mut Vec<Sheet>,
    times: usize,
    h: Vec3,
    execution: &mut Execution,
) -> Result<()> {
    let mut settled: Vec<Sheet> = zeros(sheets.len())?;
    for _ in 0..times {
        let before = &*sheets;
        execution.fill(&mut settled, BRICK, |brick, out| {
            let own = &before[brick * BRICK..][..BRICK];
            // A voxel that knows no sheet never will: its zeros stay.
            if own.iter().all(|sheet| *sheet == Sheet::default()) {
                return;
            }
            let block = Block::gather(batch, brick, before);
            for (i, out) in out.iter_mut().enumerate() {
                let at = row(i / EDGE % EDGE, i / EDGE / EDGE) + i % EDGE;
                *out = agreed(&block.values, at, h);
            }
        })?;
        std::mem::swap(sheets, &mut settled);
    }
    Ok(())
}

/// What a voxel and its six neighbours agree on.
fn agreed(sheets: &[Sheet], at: usize, h: Vec3) -> Sheet {
    let own = sheets[at];
    if own == Sheet::default() {
        return own;
    }
    let n = [own[0], own[1], own[2]];
    let mut said = [own; 7];
    let mut count = 1;
    for (axis, stride) in [1, SIDE, SIDE * SIDE].into_iter().enumerate() {
        for (neighbour, step) in [
            (at - stride, h[axis] as f32),
            (at + stride, -h[axis] as f32),
        ] {
            let other = sheets[neighbour];
            let cosine = dot([other[0], other[1], other[2]], n);
            if cosine.abs() >= ALIKE {
                // The voxel lies `step` from its neighbour.
                let turned = other.map(|v| v * cosine.signum());
                let offset = turned[3] - 0.5 * (n[axis] + turned[axis]) * step;
                said[count] = [turned[0], turned[1], turned[2], offset];
                count += 1;
            }
        }
    }
    let said = &said[..count];
    let mut order: [u64; 7] = std::array::from_fn(|i| said.get(i).map_or(0, |s| by_offset(s, i)));
    let order = &mut order[..count];
    order.sort_unstable();
    let said = |i: usize| &said[order[i] as u32 as usize];
    // The middle one of them, so that a single voxel that is wrong is overruled.
    let middle = 0.5 * (said((count - 1) / 2)[3] + said(count / 2)[3]);
    let mut sum = [0.0; 4];
    let mut agreed = 0.0;
    for sheet in (0..count).map(said) {
        if (sheet[3] - middle).abs() <= NEAR {
            for (sum, v) in sum.iter_mut().zip(sheet) {
                *sum += v;
            }
            agreed += 1.0;
        }
    }
    let length = dot([sum[0], sum[1], sum[2]], [sum[0], sum[1], sum[2]]).sqrt();
    if agreed == 0.0 || length == 0.0 {
        return own;
    }
    [
        sum[0] / length,
        sum[1] / length,
        sum[2] / length,
        sum[3] / agreed,
    ]
}
