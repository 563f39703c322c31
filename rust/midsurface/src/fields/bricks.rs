//! Sparse storage: bricks of 8³ voxels, where a part's voxels are and a margin around them.
//!
//! Bricks lie on the volume's own grid, brick b covers voxels 8b .. 8b + 7 along each axis, so that
//! a piece of a volume has the bricks of the whole. Within a brick x runs fastest, then y, z:
//! ```text
//! entry = brick · 512 + (z mod 8) · 64 + (y mod 8) · 8 + (x mod 8)
//! ```
//! Each part has bricks of its own; where two parts are close, both have a brick at the same place.

use crate::error::{reserved, zeros, Result};
use crate::reading::components::Part;
use crate::reading::runs::Run;

/// Voxels along a brick's edge.
pub(crate) const EDGE: usize = 8;
/// Voxels in one slice of a brick.
pub(crate) const LAYER: usize = EDGE * EDGE;
/// Voxels in a brick.
pub(crate) const BRICK: usize = EDGE * LAYER;

/// Voxels around a part for which fields are kept: what interpolation near its faces reaches. It is
/// also as far as filters need: a filter's radius is the sheet's half thickness and a voxel, so that
/// midway through the sheet nothing beyond is seen.
const MARGIN: usize = 3;
/// Voxels from a part that its bricks may reach.
pub(crate) const REACH: usize = MARGIN + EDGE - 1;

/// Entry of a directory where the part has no brick; present ones hold their index plus one.
const ABSENT: u32 = 0;
const PRESENT: u32 = 1;

/// The bricks of one part: a dense directory over the part's bounding box.
#[derive(Debug, Clone)]
pub(crate) struct Directory {
    /// Number of voxels of the volume along x, y, z.
    pub dimensions: [usize; 3],
    /// First brick of the bounding box along x, y, z.
    low: [usize; 3],
    /// Bricks in the bounding box along x, y, z.
    extent: [usize; 3],
    /// Index of each brick among all bricks of the batch, plus one.
    index: Vec<u32>,
    /// Places of the present bricks, ordered by z, y, x.
    pub places: Vec<[usize; 3]>,
    /// Index of the first brick.
    pub first: usize,
}

impl Directory {
    /// The bricks that `part` and its margin touch; the first one gets index `first`.
    pub fn new(part: &Part, dimensions: [usize; 3], first: usize) -> Result<Self> {
        let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
        for run in &part.runs {
            for (axis, (from, to)) in brick_range(run, dimensions).into_iter().enumerate() {
                low[axis] = low[axis].min(from);
                high[axis] = high[axis].max(to);
            }
        }
        let extent: [usize; 3] = std::array::from_fn(|a| high[a] + 1 - low[a]);
        let mut directory = Self {
            dimensions,
            low,
            extent,
            index: zeros(extent.iter().product())?,
            places: Vec::new(),
            first,
        };
        for run in &part.runs {
            let [x, y, z] = brick_range(run, dimensions);
            for bz in z.0..=z.1 {
                for by in y.0..=y.1 {
                    let row = directory.cell([x.0, by, bz]);
                    directory.index[row..=row + x.1 - x.0].fill(PRESENT);
                }
            }
        }
        directory.number_bricks()?;
        Ok(directory)
    }

    fn number_bricks(&mut self) -> Result<()> {
        let present = self.index.iter().filter(|&&i| i != ABSENT).count();
        self.places = reserved(present)?;
        for (cell, index) in self.index.iter_mut().enumerate() {
            if *index != ABSENT {
                *index = (self.first + self.places.len() + 1) as u32;
                let [nx, ny, _] = self.extent;
                let at = [cell % nx, cell / nx % ny, cell / nx / ny];
                self.places
                    .push(std::array::from_fn(|a| at[a] + self.low[a]));
            }
        }
        Ok(())
    }

    /// Position in `index` of a brick within the bounding box.
    #[inline]
    fn cell(&self, [x, y, z]: [usize; 3]) -> usize {
        let [first_x, first_y, first_z] = self.low;
        ((z - first_z) * self.extent[1] + y - first_y) * self.extent[0] + x - first_x
    }

    /// Index of the brick at a place, `None` where the part has none.
    #[inline]
    pub fn brick(&self, place: [usize; 3]) -> Option<usize> {
        // What is below the first brick wraps round to beyond the last.
        let is_inside = |a: usize| place[a].wrapping_sub(self.low[a]) < self.extent[a];
        if !(is_inside(0) && is_inside(1) && is_inside(2)) {
            return None;
        }
        let index = self.index[self.cell(place)];
        (index != ABSENT).then(|| index as usize - 1)
    }

    /// The bricks at a place and next to it, in 26 directions.
    pub fn around(&self, place: [usize; 3]) -> impl Iterator<Item = usize> + '_ {
        (0..27).filter_map(move |i| {
            let side = [i % 3, i / 3 % 3, i / 9];
            let mut at = place;
            for (at, side) in at.iter_mut().zip(side) {
                *at = (*at + side).checked_sub(1)?;
            }
            self.brick(at)
        })
    }

    /// Entry of a voxel in the batch's arrays, `None` where the part has no brick.
    #[inline]
    pub fn entry(&self, [x, y, z]: [usize; 3]) -> Option<usize> {
        let brick = self.brick([x / EDGE, y / EDGE, z / EDGE])?;
        Some(brick * BRICK + z % EDGE * LAYER + y % EDGE * EDGE + x % EDGE)
    }

    /// Like [`Self::entry`], for a voxel that may lie outside the volume.
    #[inline]
    pub fn entry_at(&self, [x, y, z]: [isize; 3]) -> Option<usize> {
        if x < 0 || y < 0 || z < 0 {
            return None;
        }
        self.entry([x as usize, y as usize, z as usize])
    }

    /// The bricks (as indices) of brick layer `bz`, which follow each other.
    pub fn layer(&self, bz: usize) -> std::ops::Range<usize> {
        let start = self.places.partition_point(|place| place[2] < bz);
        let end = self.places.partition_point(|place| place[2] <= bz);
        self.first + start..self.first + end
    }
}

/// First and last brick along each axis of a run with its margin, within the volume.
fn brick_range(run: &Run, dimensions: [usize; 3]) -> [(usize, usize); 3] {
    let (y, z) = (run.y as usize, run.z as usize);
    let voxels = [(run.start as usize, run.end as usize - 1), (y, y), (z, z)];
    std::array::from_fn(|a| {
        let last = (voxels[a].1 + MARGIN).min(dimensions[a] - 1);
        (voxels[a].0.saturating_sub(MARGIN) / EDGE, last / EDGE)
    })
}

/// The parts that are worked on at once, with their bricks numbered through.
pub(crate) struct Batch<'a> {
    pub parts: &'a [Part],
    pub directories: Vec<Directory>,
    /// Part of each brick, as an index into `parts`.
    pub part_of_brick: Vec<u32>,
}

impl<'a> Batch<'a> {
    /// The bricks of `parts`.
    pub fn new(parts: &'a [Part], dimensions: [usize; 3]) -> Result<Self> {
        let mut directories = reserved(parts.len())?;
        let mut first = 0;
        for part in parts {
            let directory = Directory::new(part, dimensions, first)?;
            first += directory.places.len();
            directories.push(directory);
        }
        let mut part_of_brick = reserved(first)?;
        for (part, directory) in directories.iter().enumerate() {
            part_of_brick.resize(directory.first + directory.places.len(), part as u32);
        }
        Ok(Self {
            parts,
            directories,
            part_of_brick,
        })
    }

    /// A field over all bricks, filled with zero.
    pub fn field(&self) -> Result<Vec<f32>> {
        zeros(self.part_of_brick.len() * BRICK)
    }

    /// The directory that brick `index` belongs to, and the brick's place.
    pub fn brick(&self, index: usize) -> (&Directory, [usize; 3]) {
        let directory = &self.directories[self.part_of_brick[index] as usize];
        (directory, directory.places[index - directory.first])
    }
}

impl Batch<'_> {
    /// All bricks as index and place.
    pub fn places(&self) -> impl Iterator<Item = (usize, [usize; 3])> + '_ {
        self.directories.iter().flat_map(|d| {
            d.places
                .iter()
                .enumerate()
                .map(|(i, &place)| (d.first + i, place))
        })
    }
}

/// Entry and coordinates of the voxels of a brick that lie in the volume.
pub(crate) fn voxels(
    brick: usize,
    place: [usize; 3],
    dimensions: [usize; 3],
) -> impl Iterator<Item = (usize, [usize; 3])> {
    (0..BRICK)
        .map(move |i| {
            let within = [i % EDGE, i / EDGE % EDGE, i / LAYER];
            (
                brick * BRICK + i,
                std::array::from_fn(|a| place[a] * EDGE + within[a]),
            )
        })
        .filter(move |(_, voxel): &(usize, [usize; 3])| (0..3).all(|a| voxel[a] < dimensions[a]))
}
