//! Stage 1, volume → runs: the only pass over the input.
//!
//! A run is a maximal stretch of one label along x. The runs of a segmentation are a few per cent
//! of its voxels; everything after this stage reads runs and never the volume again.

use std::collections::BTreeSet;

use crate::error::{Error, Result};
use crate::execution::Execution;
use crate::volume::{Label, Scalars, Volume};

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

/// The runs of the wanted labels, ordered by z, y, x, and all labels of the volume.
pub(crate) struct Scan {
    pub runs: Vec<Run>,
    pub labels: BTreeSet<i64>,
}

/// Reads the whole volume once. `wanted` tells which labels' runs are kept.
pub(crate) fn scan(
    volume: &Volume,
    execution: &mut Execution,
    wanted: impl Fn(i64) -> bool + Sync,
) -> Result<Scan> {
    let [width, height, depth] = volume.grid.dimensions;
    let slices: Vec<usize> = (0..depth).collect();
    let mut scan = Scan {
        runs: Vec::new(),
        labels: BTreeSet::new(),
    };
    let (mut run_count, mut slice_count) = (0, 0);
    execution.stream(
        &slices,
        |&z| read_slice(&volume.scalars, z, &wanted),
        |slice| {
            let slice = slice?;
            scan.labels.extend(&slice.labels);
            run_count += slice.run_count;
            slice_count += 1;
            if scan.labels.len() > MOST_LABELS {
                return Err(Error::TooManyLabels { limit: MOST_LABELS });
            }
            let voxels = width * height * slice_count;
            if scan.labels.len() > RAW_LABELS && run_count > voxels / RAW_RUN_LENGTH {
                return Err(Error::NotASegmentation {
                    labels: scan.labels.len(),
                });
            }
            let bytes = slice.runs.len() * std::mem::size_of::<Run>();
            scan.runs
                .try_reserve(slice.runs.len())
                .map_err(|_| Error::OutOfMemory(bytes))?;
            scan.runs.extend(slice.runs);
            Ok(())
        },
    )?;
    Ok(scan)
}

fn read_slice(
    scalars: &Scalars,
    z: usize,
    wanted: &(impl Fn(i64) -> bool + Sync),
) -> Result<Slice> {
    macro_rules! typed {
        ($($variant:ident),*) => {
            match scalars { $(Scalars::$variant(view) => read_typed(view, z, wanted)),* }
        };
    }
    typed!(I8, U8, I16, U16, I32, U32, I64, U64, F32, F64)
}

fn read_typed<T: Label>(
    view: &ndarray::ArrayView3<T>,
    z: usize,
    wanted: &(impl Fn(i64) -> bool + Sync),
) -> Result<Slice> {
    let mut slice = Slice::default();
    let mut latest = (0, false);
    for (y, row) in view
        .index_axis(ndarray::Axis(0), z)
        .outer_iter()
        .enumerate()
    {
        let row = row.to_slice().unwrap_or(&[]);
        let mut start = skip_background(row, 0);
        while start < row.len() {
            let label = row[start].label().ok_or_else(|| Error::NotALabel {
                value: row[start].to_string(),
                voxel: [start, y, z],
            })?;
            let end = row[start..]
                .iter()
                .position(|v| *v != row[start])
                .map_or(row.len(), |n| start + n);
            slice.run_count += 1;
            if latest.0 != label {
                latest = (label, wanted(label));
                slice.labels.insert(label);
                if slice.labels.len() > MOST_LABELS {
                    return Err(Error::TooManyLabels { limit: MOST_LABELS });
                }
            }
            if latest.1 {
                let bytes = std::mem::size_of::<Run>();
                slice
                    .runs
                    .try_reserve(1)
                    .map_err(|_| Error::OutOfMemory(bytes))?;
                slice.runs.push(Run {
                    label,
                    z: z as u32,
                    y: y as u32,
                    start: start as u32,
                    end: end as u32,
                });
            }
            start = skip_background(row, end);
        }
    }
    Ok(slice)
}

/// The first index from `x` on that is not background. Most of a volume is background, so it is
/// looked at in blocks that the compiler turns into vector comparisons.
fn skip_background<T: Label>(row: &[T], mut x: usize) -> usize {
    const BLOCK: usize = 32;
    let background = T::default();
    while let Some(block) = row.get(x..x + BLOCK) {
        if block.iter().fold(false, |any, v| any | (*v != background)) {
            break;
        }
        x += BLOCK;
    }
    while x < row.len() && row[x] == background {
        x += 1;
    }
    x
}
