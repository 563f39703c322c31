//! Core sheets → sheets to beyond the rims.
//!
//! Near a rim, a junction or a face the profile says little about the sheet, but the core voxels
//! next to it do: a sheet runs on as it bends there (`bending.rs`). Ring by ring, an unknown voxel
//! takes the mean of what its known neighbours say, each by its own normal and offset. Where sheets
//! meet the neighbours speak of several, and the one that most speak of goes on.

use crate::error::{collected, push, zeros, Result};
use crate::execution::Execution;
use crate::fields::block::{row, Block, SIDE};
use crate::fields::bricks::{Batch, BRICK, EDGE};
use crate::grid::Vec3;
use crate::sheets::bending::{bends, Bend};
use crate::sheets::sheet::{by_offset, dot, Sheet};

/// Neighbours that say the same: normals within this cosine, offsets within this many work units.
const ALIKE: f32 = 0.8;
const NEAR: f32 = 0.75;
/// Normals that differ by more than this cosine's angle are those of sheets across each other.
const ACROSS: f32 = 0.7;

/// The ring in which a voxel learnt its sheet: never yet, 1 for core voxels, and so on; `FAR` where
/// no label is within a voxel, and no sheet is wanted.
type Ring = u8;
const NEVER: Ring = 0;
const CORE: Ring = 1;
const FAR: Ring = Ring::MAX;

/// Extends the sheets by so many `rings` of voxels, up to one voxel beyond the label and up to
/// offsets of `farthest`.
pub(crate) fn extend(
    batch: &Batch,
    distance: &[f32],
    rings: Ring,
    farthest: f32,
    h: Vec3,
    sheets: &mut [Sheet],
    execution: &mut Execution,
) -> Result<()> {
    let bends = bends(batch, sheets, h, execution)?;
    let mut learnt_in = core_rings(batch, distance, sheets, execution)?;
    let mut open = collected(0..batch.part_of_brick.len())?;
    for last in CORE..CORE + rings {
        let mut found: Vec<(usize, Vec<(u16, Sheet)>)> = Vec::new();
        let (before, known_since) = (&*sheets, &learnt_in);
        execution.stream(
            &open,
            |&brick| {
                let front = front(batch, brick, known_since, last);
                let learnt = if front.is_empty() {
                    Vec::new()
                } else {
                    let known = Block::gather(batch, brick, before);
                    ring(&known, &front, farthest, &bends[brick], h)
                };
                (brick, learnt)
            },
            |own| {
                if !own.1.is_empty() {
                    push(&mut found, own)?;
                }
                Ok(())
            },
        )?;
        // Only bricks next to a change can change in the next ring.
        let mut next: Vec<bool> = zeros(batch.part_of_brick.len())?;
        for (brick, own) in &found {
            for (i, sheet) in own {
                let entry = brick * BRICK + *i as usize;
                sheets[entry] = *sheet;
                learnt_in[entry] = last + 1;
            }
            let (directory, place) = batch.brick(*brick);
            directory.around(place).for_each(|b| next[b] = true);
        }
        open = collected((0..next.len()).filter(|&b| next[b]))?;
        if open.is_empty() {
            break;
        }
    }
    Ok(())
}

/// Which voxels know their sheet from the start, and which never will.
fn core_rings(
    batch: &Batch,
    distance: &[f32],
    sheets: &[Sheet],
    execution: &mut Execution,
) -> Result<Vec<Ring>> {
    let rings = execution.collect(batch.part_of_brick.len(), |brick| {
        let near = Block::gather(batch, brick, distance);
        if near.values.iter().all(|d| *d == 0.0) {
            return [FAR; BRICK];
        }
        let near = near.largest_near();
        let own = &sheets[brick * BRICK..][..BRICK];
        std::array::from_fn(|i| match own[i] == Sheet::default() {
            false => CORE,
            true if near[i] > 0.0 => NEVER,
            true => FAR,
        })
    })?;
    Ok(rings.into_flattened())
}

/// The voxels of a brick that want a sheet and have a neighbour that learnt its own in the `last`
/// ring; for the others nothing is new.
fn front(batch: &Batch, brick: usize, rings: &[Ring], last: Ring) -> Vec<u16> {
    let own = &rings[brick * BRICK..][..BRICK];
    if !own.contains(&NEVER) {
        return Vec::new();
    }
    let mut block = Block::gather(batch, brick, rings);
    let mut any = false;
    for ring in &mut block.values {
        any |= *ring == last;
        *ring = Ring::from(*ring == last);
    }
    if !any {
        return Vec::new();
    }
    let near = block.largest_near();
    let is_front = |i: &u16| own[usize::from(*i)] == NEVER && near[usize::from(*i)] > 0;
    (0..BRICK as u16).filter(is_front).collect()
}

/// The voxels of a brick's front that learn their sheet in this ring.
fn ring(
    known: &Block<Sheet>,
    front: &[u16],
    farthest: f32,
    bend: &Bend,
    h: Vec3,
) -> Vec<(u16, Sheet)> {
    let learn = |&voxel: &u16| {
        let i = usize::from(voxel);
        let at = row(i / EDGE % EDGE, i / EDGE / EDGE) + i % EDGE;
        let sheet = continued(known, at, bend, h)?;
        (sheet[3].abs() <= farthest).then_some((voxel, sheet))
    };
    front.iter().filter_map(learn).collect()
}

/// What the known neighbours of a voxel say of its sheet: the mean of those that agree with the
/// one that speaks for them.
fn continued(known: &Block<Sheet>, at: usize, bend: &Bend, h: Vec3) -> Option<Sheet> {
    let mut said = [Sheet::default(); 26];
    let mut count = 0;
    for step in (0..27).filter(|&step| step != 13) {
        let step = [step % 3, step / 3 % 3, step / 9];
        let neighbour =
            at + step[0] + step[1] * SIDE + step[2] * SIDE * SIDE - 1 - SIDE - SIDE * SIDE;
        let sheet = known.values[neighbour];
        if sheet == Sheet::default() {
            continue;
        }
        // The voxel lies this far from the neighbour.
        let apart: [f32; 3] = std::array::from_fn(|a| (1.0 - step[a] as f32) * h[a] as f32);
        let n = [sheet[0], sheet[1], sheet[2]];
        let change = bend.change(n, apart);
        let offset = sheet[3] - dot(n, apart) - 0.5 * dot(change, apart);
        said[count] = [n[0] + change[0], n[1] + change[1], n[2] + change[2], offset];
        if dot(n, [said[0][0], said[0][1], said[0][2]]) < 0.0 {
            said[count] = said[count].map(|v| -v);
        }
        count += 1;
    }
    if count == 0 {
        return None;
    }
    let said = &said[..count];
    let first = spokesman(said);
    let mut sum = [0.0; 4];
    let mut agreed = 0.0;
    for sheet in said.iter().filter(|sheet| agree(sheet, &first)) {
        let turn = dot(normal(sheet), normal(&first)).signum();
        for (sum, v) in sum.iter_mut().zip(sheet) {
            *sum += turn * v;
        }
        agreed += 1.0;
    }
    let length = dot(normal(&sum), normal(&sum)).sqrt();
    Some([
        sum[0] / length,
        sum[1] / length,
        sum[2] / length,
        sum[3] / agreed,
    ])
}

/// The one that speaks for the others: the middle one by its offset or, where these speak of sheets
/// across each other, the one that most agree with, so that a sheet that goes on beyond a junction
/// is not interrupted by one that ends there.
fn spokesman(said: &[Sheet]) -> Sheet {
    let mut order = [0; 26];
    for (i, (order, sheet)) in order.iter_mut().zip(said).enumerate() {
        *order = by_offset(sheet, i);
    }
    let order = &mut order[..said.len()];
    order.sort_unstable();
    let in_order = || order.iter().map(|&o| said[o as u32 as usize]);
    let middle = said[order[said.len() / 2] as u32 as usize];
    let across = |s: &Sheet| dot(normal(s), normal(&middle)).abs() < ACROSS;
    if !said.iter().any(across) {
        return middle;
    }
    let supporters = |s: &Sheet| in_order().filter(|other| agree(other, s)).count();
    let nearer = |a: &Sheet, b: &Sheet| b[3].abs().total_cmp(&a[3].abs());
    let most = in_order().max_by(|a, b| supporters(a).cmp(&supporters(b)).then(nearer(a, b)));
    most.unwrap_or(middle)
}

/// Whether two say the same.
fn agree(a: &Sheet, b: &Sheet) -> bool {
    let cosine = dot(normal(a), normal(b));
    cosine.abs() >= ALIKE && (cosine.signum() * a[3] - b[3]).abs() <= NEAR
}

fn normal(sheet: &Sheet) -> [f32; 3] {
    [sheet[0], sheet[1], sheet[2]]
}
