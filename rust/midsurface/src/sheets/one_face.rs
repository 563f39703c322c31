//! Core sheets → sheets beside a border of the volume as well, from the one face that is seen there.
//!
//! Where a sheet runs along a border of the volume, or leaves it leaning, one of its faces lies
//! beyond the border, and its profile has no crest that says where the middle is. Led on from
//! afar (`extension.rs`) a sheet misses what it does there: a membrane that turns back just below
//! the border would leave the volume twice. But there is the other face. Its normal is that of the
//! sheet, and the middle lies half a thickness before it, which is that of the core voxels in the
//! bricks around.
//!
//! A normal needs the face to be seen on all sides: where it is nearer to the border than that,
//! nothing is found, and the sheet is led on after all. Where no core voxel is within a few bricks,
//! nothing is known of the thickness, and the profile's word stands.

use crate::error::Result;
use crate::execution::Execution;
use crate::fields::bricks::{BRICK, EDGE, LAYER};
use crate::fields::label::Label;
use crate::grid::{along, dot, sub, unit, Vec3};
use crate::sheets::scale::{self, BrickMeans};
use crate::sheets::sheet::{voxel_along, Sheet};

/// How near to the middle of a sheet its thickness is measured, work units, and how far beyond the
/// face the first voxel outside is, in voxels along the normal.
const CLOSE: f32 = 0.5;
const BEYOND_FACE: f32 = 0.4;
/// How often bricks without a core voxel take the thickness of those around.
const SPREAD: usize = 3;
/// Half a step over which the distance's slope says where the face is, at first, in voxels.
const SLOPE: usize = 2;
/// Times that the normal is taken from where the face is found by the one before.
const TURNS: usize = 3;
/// σ of the Gaussian under which the face has its normal, in the coarsest spacing; where it is cut
/// off, in σ; and how deep in the volume the face is for that at least, in the coarsest spacing.
const SIGMA: f64 = 1.3;
const REACH: f64 = 2.4;
const DEEP: f64 = 2.0;
/// Beyond the face there is no label so far off, in the coarsest spacing: that of a sheet close by would
/// turn the normal.
const CLEAR: [f64; 3] = [1.5, 2.25, 3.0];
/// A sheet leans against the border that cuts off its other face by at least this cosine,
const LEANING: f64 = 0.65;
/// and the border is no farther than so much beyond where that face should be, work units.
const MORE: f64 = 1.0;

/// Passes over all bricks that [`add_cut_sheets`] makes, for its progress.
pub(crate) const PASSES: usize = 1 + scale::PASSES;

/// Adds to the `sheets` of the core voxels those of other labelled voxels with one face in view, with
/// offsets of up to `farthest`.
pub(crate) fn add_cut_sheets(
    label: &Label,
    farthest: f64,
    sheets: &mut [Sheet],
    execution: &mut Execution,
) -> Result<()> {
    let sums = |brick: usize| half_thickness(label, sheets, brick);
    let half = BrickMeans::new(label.batch, sums, execution)?.spread(label.batch, SPREAD)?;
    execution.fill(sheets, BRICK, |brick, sheets| {
        let distance = &label.distance[brick * BRICK..][..BRICK];
        let is_open = |(sheet, d): (&Sheet, &f32)| *d > 0.0 && *sheet == Sheet::default();
        if !sheets.iter().zip(distance).any(is_open) {
            return;
        }
        let (_, place) = label.batch.brick(brick);
        let part = label.batch.part_of_brick[brick];
        let half = half.brick(label.batch, brick);
        for (i, sheet) in sheets.iter_mut().enumerate() {
            let half = f64::from(half[i]);
            let is_near_middle = f64::from(distance[i]) >= half - farthest;
            if !is_open((sheet, &distance[i])) || half == 0.0 || !is_near_middle {
                continue;
            }
            let within = [i % EDGE, i / EDGE % EDGE, i / LAYER];
            let voxel = std::array::from_fn(|a| place[a] * EDGE + within[a]);
            if let Some((n, offset)) = cut_sheet(label, part, voxel, half) {
                if offset.abs() <= farthest {
                    let [x, y, z] = n.map(|v| v as f32);
                    *sheet = [x, y, z, offset as f32];
                }
            }
        }
    })
}

/// Sum over a brick's core voxels midway of half the thickness, and their number.
fn half_thickness(label: &Label, sheets: &[Sheet], brick: usize) -> [f32; 2] {
    let own = brick * BRICK..(brick + 1) * BRICK;
    let spacing = label.h.map(|h| h as f32);
    let mut sums = [0.0; 2];
    for (sheet, d) in sheets[own.clone()].iter().zip(&label.distance[own]) {
        let [x, y, z, offset] = *sheet;
        if *d > 0.0 && *sheet != Sheet::default() && offset.abs() < CLOSE {
            let half = d + offset.abs() - BEYOND_FACE * voxel_along([x, y, z], spacing);
            sums = [sums[0] + half, sums[1] + 1.0];
        }
    }
    sums
}

/// Normal and offset of the sheet at a voxel of a part, from its only face in view.
fn cut_sheet(label: &Label, part: u32, voxel: [usize; 3], half: f64) -> Option<(Vec3, f64)> {
    let coarsest = label.h.iter().copied().fold(1.0, f64::max);
    let p: Vec3 = std::array::from_fn(|a| voxel[a] as f64 * label.h[a]);
    if label.depth(p) > 2.0 * half + MORE {
        return None;
    }
    let mut normal = slope(label, part, voxel);
    let mut depth = f64::INFINITY;
    for _ in 0..TURNS {
        if !leaves_volume(label, p, normal, 2.0 * half + MORE) {
            return None;
        }
        let [ahead, behind] = label.faces(part, p, normal)?;
        let face = along(p, -behind, normal);
        if ahead.is_finite() || behind.is_infinite() || label.depth(face) < DEEP * coarsest {
            return None;
        }
        normal = face_normal(label, part, face, SIGMA * coarsest);
        depth = dot(sub(p, face), normal);
    }
    let distance = label.distance(part);
    let is_label = |far: f64| distance.linear(along(p, -depth - far * coarsest, normal)) > 0.0;
    if CLEAR.into_iter().any(is_label) {
        return None;
    }
    let is_cut = leaves_volume(label, p, normal, 2.0 * half + MORE - depth);
    is_cut.then_some((normal, half - depth))
}

/// Whether a way leads across a border of the volume within this length.
fn leaves_volume(label: &Label, p: Vec3, way: Vec3, within: f64) -> bool {
    let last = label.last();
    (0..3).any(|a| {
        let to_border = if way[a] > 0.0 { last[a] - p[a] } else { p[a] };
        way[a].abs() >= LEANING && to_border < within * way[a].abs()
    })
}

/// The direction in which the outside gets farther away at a voxel.
fn slope(label: &Label, part: u32, voxel: [usize; 3]) -> Vec3 {
    let directory = &label.batch.directories[part as usize];
    unit(std::array::from_fn(|a| {
        let distance = |v: usize| {
            let mut at = voxel;
            at[a] = v;
            let entry = directory.entry(at);
            entry.map_or(0.0, |entry| f64::from(label.distance[entry]))
        };
        let low = voxel[a].saturating_sub(SLOPE);
        let high = (voxel[a] + SLOPE).min(directory.dimensions[a] - 1);
        (distance(high) - distance(low)) / ((high - low).max(1) as f64 * label.h[a])
    }))
}

/// Normal of a part's face at a point, into the label: the gradient of the mask under a Gaussian, as
/// wide on both sides where a border is near.
fn face_normal(label: &Label, part: u32, p: Vec3, sigma: f64) -> Vec3 {
    let directory = &label.batch.directories[part as usize];
    let last = label.last();
    let room: Vec3 = std::array::from_fn(|a| p[a].min(last[a] - p[a]).min(REACH * sigma));
    let low: [usize; 3] = std::array::from_fn(|a| ((p[a] - room[a]) / label.h[a]).ceil() as usize);
    let high: [usize; 3] = std::array::from_fn(|a| ((p[a] + room[a]) / label.h[a]) as usize);
    let mut sum = [0.0; 3];
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                let voxel = [x, y, z];
                let way: Vec3 = std::array::from_fn(|a| voxel[a] as f64 * label.h[a] - p[a]);
                let weight = (-0.5 * dot(way, way) / (sigma * sigma)).exp();
                let entry = directory.entry(voxel);
                let is_inside = entry.is_some_and(|entry| label.distance[entry] > 0.0);
                sum = along(sum, if is_inside { weight } else { -weight }, way);
            }
        }
    }
    unit(sum)
}
