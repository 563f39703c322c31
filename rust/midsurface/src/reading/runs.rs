//! Stage 1, volume → runs: the only pass over the input.
//!
//! A run is a maximal stretch of one label along x. The runs of a segmentation are a few per cent
//! of its voxels; everything after this stage reads runs and never the volume again.

use std::collections::BTreeSet;

use crate::error::{collected, extend, push, Error, Result};
use crate::execution::Execution;
use crate::reading::volume::{Label, Scalars, Volume};

/// More distinct labels than this are not a segmentation.
const MOST_LABELS: usize = 1024;

/// Above this number of labels, and below this mean length of the runs, the volume is taken for
/// a raw tomogram of 8 bits.
const RAW_LABELS: usize = 64;
const RAW_RUN_LENGTH: usize = 3;

/// Voxels `start..end` along x in row (y, z), all of one label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    pub label: i64,
    pub z: u32,
    pub y: u32,
    pub start: u32,
    pub end: u32,
}

impl Run {
    pub fn length(&self) -> usize {
        (self.end - self.start) as usize
    }
}

/// What one slice holds.
#[derive(Default)]
struct Slice {
    runs: Vec<Run>,
    labels: BTreeSet<i64>,
    run_count: usize,
}

impl Slice {
    fn add(&mut self, label: i64, [z, y]: [usize; 2], x: [usize; 2], keep: bool) -> Result<()> {
        self.run_count += 1;
        if keep {
            let run = Run {
                label,
                z: z as u32,
                y: y as u32,
                start: x[0] as u32,
                end: x[1] as u32,
            };
            push(&mut self.runs, run)?;
        }
        Ok(())
    }
}

/// The runs of the wanted labels, ordered by z, y, x, and all labels of the volume.
#[derive(Default)]
pub(crate) struct Scan {
    pub runs: Vec<Run>,
    pub labels: BTreeSet<i64>,
    /// Number of runs of all labels.
    pub run_count: usize,
}

impl Scan {
    /// Fails where it cannot be a segmentation of `voxels` voxels. Judged by the whole volume, so
    /// that it does not matter where in it the noise is.
    pub fn check(&self, voxels: usize) -> Result<()> {
        let labels = self.labels.len();
        if labels > MOST_LABELS {
            return Err(Error::TooManyLabels { limit: MOST_LABELS });
        }
        if labels > RAW_LABELS && self.run_count > voxels / RAW_RUN_LENGTH {
            return Err(Error::NotASegmentation { labels });
        }
        Ok(())
    }
}

/// Reads the volume, which is `whole` voxels or a piece of them, once. `wanted` tells which labels'
/// runs are kept.
pub(crate) fn scan(
    volume: &Volume,
    whole: usize,
    execution: &mut Execution,
    wanted: impl Fn(i64) -> bool + Sync,
) -> Result<Scan> {
    let slices = collected(0..volume.grid.dimensions[2])?;
    let mut scan = Scan::default();
    execution.stream(
        &slices,
        |&z| read_slice(volume, z, &wanted),
        |slice| {
            let slice = slice?;
            scan.labels.extend(&slice.labels);
            scan.run_count += slice.run_count;
            scan.check(whole)?;
            extend(&mut scan.runs, slice.runs)
        },
    )?;
    Ok(scan)
}

fn read_slice(volume: &Volume, z: usize, wanted: &(impl Fn(i64) -> bool + Sync)) -> Result<Slice> {
    macro_rules! typed {
        ($($variant:ident),*) => {
            match &volume.scalars {
                $(Scalars::$variant(view) => match volume.threshold {
                    None => read_labels(view, z, wanted),
                    Some(threshold) => read_above(view, z, threshold, wanted),
                }),*
            }
        };
    }
    typed!(I8, U8, I16, U16, I32, U32, I64, U64, F32, F64)
}

fn read_labels<T: Label>(
    view: &ndarray::ArrayView3<T>,
    z: usize,
    wanted: &(impl Fn(i64) -> bool + Sync),
) -> Result<Slice> {
    let mut slice = Slice::default();
    let mut latest = (0, false);
    let is_labelled = |v: T| v != T::default();
    for (y, row) in rows(view, z) {
        let mut start = skip_until(row, 0, is_labelled);
        while start < row.len() {
            let label = row[start].label().ok_or_else(|| {
                let (value, voxel) = (row[start].to_string(), [start, y, z]);
                if row[start].is_whole() {
                    Error::LabelTooLarge { value, voxel }
                } else {
                    Error::NotALabel { value, voxel }
                }
            })?;
            let end = row[start..]
                .iter()
                .position(|v| *v != row[start])
                .map_or(row.len(), |n| start + n);
            if latest.0 != label {
                latest = (label, wanted(label));
                slice.labels.insert(label);
                if slice.labels.len() > MOST_LABELS {
                    return Err(Error::TooManyLabels { limit: MOST_LABELS });
                }
            }
            slice.add(label, [z, y], [start, end], latest.1)?;
            start = skip_until(row, end, is_labelled);
        }
    }
    Ok(slice)
}

/// Voxels at or above the threshold are label 1.
fn read_above<T: Label>(
    view: &ndarray::ArrayView3<T>,
    z: usize,
    threshold: f64,
    wanted: &(impl Fn(i64) -> bool + Sync),
) -> Result<Slice> {
    let mut slice = Slice::default();
    let Some(least) = T::at_or_above(threshold) else {
        return Ok(slice);
    };
    let is_wanted = wanted(1);
    for (y, row) in rows(view, z) {
        let mut start = skip_until(row, 0, |v| v >= least);
        while start < row.len() {
            let end = row[start..]
                .iter()
                .position(|&v| v < least || v.is_nan())
                .map_or(row.len(), |n| start + n);
            slice.labels.insert(1);
            slice.add(1, [z, y], [start, end], is_wanted)?;
            start = skip_until(row, end, |v| v >= least);
        }
    }
    Ok(slice)
}

/// The rows of a slice, with their y.
fn rows<'a, T>(
    view: &ndarray::ArrayView3<'a, T>,
    z: usize,
) -> impl Iterator<Item = (usize, &'a [T])> {
    let (_, height, width) = view.dim();
    let size = height * width;
    let slice = view
        .to_slice()
        .and_then(|all| all.get(z * size..(z + 1) * size));
    slice.unwrap_or(&[]).chunks_exact(width.max(1)).enumerate()
}

/// The first index from `x` on whose value is labelled. Most of a volume is background, so it is
/// looked at in blocks that the compiler turns into vector comparisons.
fn skip_until<T: Copy>(row: &[T], mut x: usize, is_labelled: impl Fn(T) -> bool) -> usize {
    const BLOCK: usize = 32;
    while let Some(block) = row.get(x..x + BLOCK) {
        if block.iter().fold(false, |any, &v| any | is_labelled(v)) {
            break;
        }
        x += BLOCK;
    }
    while x < row.len() && !is_labelled(row[x]) {
        x += 1;
    }
    x
}
