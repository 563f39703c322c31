//! Which voxels of a volume belong to which of several processes.

use std::collections::BTreeSet;

use crate::error::{collected, push, Error, Result};
use crate::grid::Grid;
use crate::processes::exchange::Team;
use crate::reading::runs::Run;
use crate::reading::volume::Volume;

/// Voxels `from .. to` along x, y, z, counted in the whole volume.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extent {
    from: [i64; 3],
    to: [i64; 3],
}

impl Extent {
    const EMPTY: Self = Self {
        from: [0; 3],
        to: [0; 3],
    };

    fn of(piece: &Grid, whole: &Grid) -> Self {
        let from =
            std::array::from_fn(|a| piece.extent_start[a].saturating_sub(whole.extent_start[a]));
        let to = std::array::from_fn(|a| from[a].saturating_add(piece.dimensions[a] as i64));
        Self { from, to }
    }

    fn is_empty(&self) -> bool {
        (0..3).any(|a| self.from[a] >= self.to[a])
    }

    fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|a| self.from[a].max(other.from[a]) < self.to[a].min(other.to[a]))
    }

    /// Whether it reaches into the row of a run.
    fn has_row(&self, run: &Run) -> bool {
        (self.from[1]..self.to[1]).contains(&run.y.into())
            && (self.from[2]..self.to[2]).contains(&run.z.into())
    }

    /// Whether a run lies in it or so many voxels off, at corners too.
    fn is_near(&self, run: &Run, voxels: i64) -> bool {
        let from = [run.start, run.y, run.z].map(i64::from);
        let to = [run.end, run.y + 1, run.z + 1].map(i64::from);
        let is_along = |a: usize| from[a] < self.to[a] + voxels && self.from[a] < to[a] + voxels;
        !self.is_empty() && (0..3).all(is_along)
    }
}

/// Which voxels are whose: a voxel of several pieces belongs to the first of their processes.
pub(crate) struct Territory {
    extents: Vec<Extent>,
    own: usize,
}

impl Territory {
    /// All processes tell where their pieces lie.
    pub fn agree(piece: Option<&Volume>, whole: &Grid, team: &mut Team) -> Result<Self> {
        let own = piece.map_or(Extent::EMPTY, |volume| Extent::of(&volume.grid, whole));
        let message: Vec<i64> = [own.from, own.to].concat();
        let mut extents = Vec::new();
        for message in team.share(&message)? {
            let numbers: [i64; 6] = message.try_into().map_err(|_| Error::Pieces)?;
            let [x, y, z, to @ ..] = numbers;
            extents.push(Extent {
                from: [x, y, z],
                to,
            });
        }
        let territory = Self {
            extents,
            own: team.process(),
        };
        territory.check(whole)?;
        Ok(territory)
    }

    /// Whether the extents lie in the whole and cover it.
    fn check(&self, whole: &Grid) -> Result<()> {
        let size = whole.dimensions.map(|n| n as i64);
        let extents = self.extents.iter().filter(|e| !e.is_empty());
        let mut is_inside = true;
        let mut cuts: [BTreeSet<i64>; 3] = std::array::from_fn(|a| BTreeSet::from([0, size[a]]));
        for e in extents.clone() {
            is_inside &= (0..3).all(|a| e.from[a] >= 0 && e.to[a] <= size[a]);
            for (a, cuts) in cuts.iter_mut().enumerate() {
                cuts.extend([e.from[a], e.to[a]]);
            }
        }
        // Between two cuts along each axis all voxels are covered, or none.
        let is_covered = |x: i64, y: i64, z: i64| {
            let mut extents = extents.clone();
            extents.any(|e| (0..3).all(|a| (e.from[a]..e.to[a]).contains(&[x, y, z][a])))
        };
        let starts = |axis: usize| cuts[axis].iter().copied().filter(move |&v| v < size[axis]);
        let is_whole = is_inside
            && starts(2).all(|z| starts(1).all(|y| starts(0).all(|x| is_covered(x, y, z))));
        if is_whole {
            Ok(())
        } else {
            Err(Error::Pieces)
        }
    }

    /// Keeps of the runs of the own piece what belongs to this process, counted in the whole.
    pub fn clip(&self, runs: Vec<Run>) -> Result<Vec<Run>> {
        let own = self.extents[self.own];
        let [x, y, z] = own.from.map(|v| v as u32);
        let runs = runs.into_iter().map(|run| Run {
            start: run.start + x,
            end: run.end + x,
            y: run.y + y,
            z: run.z + z,
            ..run
        });
        let earlier = self.extents[..self.own].iter();
        let mut earlier: Vec<&Extent> = earlier.filter(|e| e.overlaps(&own)).collect();
        if earlier.is_empty() {
            return collected(runs);
        }
        earlier.sort_unstable_by_key(|e| e.from[0]);
        let mut clipped = Vec::new();
        for run in runs {
            let mut start = run.start;
            for taken in earlier.iter().filter(|e| e.has_row(&run)) {
                let [from, to] = [taken.from[0], taken.to[0]].map(|v| v as u32);
                if start < from.min(run.end) {
                    let end = from.min(run.end);
                    push(&mut clipped, Run { start, end, ..run })?;
                }
                start = start.max(to);
            }
            if start < run.end {
                push(&mut clipped, Run { start, ..run })?;
            }
        }
        Ok(clipped)
    }

    /// Whether a run may touch one of another process.
    pub fn is_at_border(&self, run: &Run) -> bool {
        let mut others = self.extents.iter().enumerate();
        others.any(|(process, extent)| process != self.own && extent.is_near(run, 1))
    }

    /// The processes in whose pieces a run lies, or up to so many voxels off.
    pub fn near<'a>(&'a self, run: &'a Run, voxels: usize) -> impl Iterator<Item = usize> + 'a {
        let all = self.extents.iter().enumerate();
        let near = all.filter(move |(_, extent)| extent.is_near(run, voxels as i64));
        near.map(|(process, _)| process)
    }

    /// The same error, with its voxel counted in the whole.
    pub fn place(&self, error: Error) -> Error {
        let from = self.extents[self.own].from;
        let placed = |voxel: [usize; 3]| std::array::from_fn(|a| voxel[a] + from[a] as usize);
        match error {
            Error::NotALabel { value, voxel } => Error::NotALabel {
                value,
                voxel: placed(voxel),
            },
            Error::LabelTooLarge { value, voxel } => Error::LabelTooLarge {
                value,
                voxel: placed(voxel),
            },
            error => error,
        }
    }
}
