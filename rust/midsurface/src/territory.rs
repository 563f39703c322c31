//! Which voxels of a volume belong to which of several processes.

use std::collections::BTreeSet;

use crate::error::{push, Error, Result};
use crate::exchange::Team;
use crate::grid::Grid;
use crate::runs::Run;
use crate::volume::Volume;

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

    /// Whether a run lies in it or beside it, at corners too.
    fn is_near(&self, run: &Run) -> bool {
        let from = [run.start, run.y, run.z].map(i64::from);
        let to = [run.end, run.y + 1, run.z + 1].map(i64::from);
        !self.is_empty() && (0..3).all(|a| from[a] <= self.to[a] && self.from[a] <= to[a])
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
    pub fn clip(&self, runs: &mut Vec<Run>) -> Result<()> {
        let from = self.extents[self.own].from;
        let mut clipped = Vec::new();
        for run in runs.drain(..) {
            let [y, z] = [i64::from(run.y) + from[1], i64::from(run.z) + from[2]];
            let earlier = self.extents[..self.own].iter().filter(|e| {
                !e.is_empty()
                    && (e.from[1]..e.to[1]).contains(&y)
                    && (e.from[2]..e.to[2]).contains(&z)
            });
            let mut taken: Vec<[i64; 2]> = earlier.map(|e| [e.from[0], e.to[0]]).collect();
            taken.sort_unstable();
            let end = i64::from(run.end) + from[0];
            let mut start = i64::from(run.start) + from[0];
            taken.push([end, end]);
            for [from, to] in taken {
                if start < from.min(end) {
                    push(
                        &mut clipped,
                        Run {
                            start: start as u32,
                            end: from.min(end) as u32,
                            y: y as u32,
                            z: z as u32,
                            ..run
                        },
                    )?;
                }
                start = start.max(to);
            }
        }
        *runs = clipped;
        Ok(())
    }

    /// Whether a run may touch one of another process.
    pub fn is_at_border(&self, run: &Run) -> bool {
        let mut others = self.extents.iter().enumerate();
        others.any(|(process, extent)| process != self.own && extent.is_near(run))
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
