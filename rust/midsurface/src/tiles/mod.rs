//! A component cut into tiles, cubes of voxels, so that it may be larger than what is worked on at once.
//!
//! Tiles lie where the component's voxels are, whatever number of threads or processes there is: counted
//! from its own lower corner, so that a sheet in the middle of the volume is not halved along its
//! length, each half with a margin as large as the other. A tile is worked on with a margin around it
//! wide enough that what comes out within does not depend on what lies beyond: stages have bounded
//! support.
//!
//! | step | file |
//! | --- | --- |
//! | all tiles, on all processes, until they fit together | `tiled_surface.rs` |
//! | the stages as they are run in one tile | `tile.rs` |
//! | a surface of which each process holds some tiles | `mosaic.rs` |
//! | what tiles agree on along the seams between them | `seams.rs` |
//! | the mesh of the tiles | `tiled_mesh.rs` |

mod mosaic;
mod seams;
mod tile;
pub(crate) mod tiled_mesh;
pub(crate) mod tiled_surface;

use std::collections::BTreeMap;

use crate::error::{collected, push, Result};
use crate::fields::bricks::EDGE;
use crate::grid::Vec3;
use crate::reading::components::Part;
use crate::reading::runs::Run;

/// A tile's number along x, y, z.
pub(crate) type Place = [i32; 3];

/// Voxels from the label that its surface may be.
const OFF_LABEL: usize = 4;

/// A grid of tiles; the last one along an axis takes what is left where that is less than half a side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tiling {
    /// The first voxel of the first tile, where the grid is not moved; the first of a brick, too.
    first: [i64; 3],
    /// Voxels along a tile's edge.
    side: usize,
    /// How far the grid is moved along each axis, in sides.
    shift: f64,
    /// The last tile.
    last: Place,
    /// The work spacing.
    h: Vec3,
}

impl Tiling {
    /// The tiles of what lies in a box of voxels.
    pub fn new(side: usize, shift: f64, bounds: &VoxelBox, h: Vec3) -> Self {
        let first = bounds.from.map(|v| v - v.rem_euclid(EDGE as i64));
        let last = |a: usize| {
            let count = (bounds.to[a] - first[a]) as f64;
            (count / side as f64 + shift - 0.5).max(0.0) as i32
        };
        Self {
            first,
            side,
            shift,
            last: std::array::from_fn(last),
            h,
        }
    }

    /// Tiles counted from the first one's border to a point, work units, along an axis.
    fn along(&self, p: Vec3, axis: usize) -> f64 {
        let from_first = p[axis] / self.h[axis] - self.first[axis] as f64;
        from_first / self.side as f64 + self.shift
    }

    /// The tile that a point is in, work units; one beyond the border of the volume is in the nearest.
    pub fn place(&self, p: Vec3) -> Place {
        std::array::from_fn(|a| (self.along(p, a).floor() as i32).clamp(0, self.last[a]))
    }

    /// The tile that a voxel is in, in a grid that is not moved.
    fn place_of_voxel(&self, voxel: [i64; 3]) -> Place {
        let side = self.side as i64;
        std::array::from_fn(|a| {
            let tile = (voxel[a] - self.first[a]) / side;
            (tile as i32).clamp(0, self.last[a])
        })
    }

    /// The tile that a brick is in, in a grid that is not moved.
    pub fn place_of_brick(&self, place: [usize; 3]) -> Place {
        self.place_of_voxel(place.map(|v| (v * EDGE) as i64))
    }

    /// The voxels of a tile, in a grid that is not moved; the last one's reach beyond the component.
    fn voxels(&self, place: Place) -> VoxelBox {
        let side = self.side as i64;
        let border = |a: usize, tile: i32| self.first[a] + i64::from(tile) * side;
        VoxelBox {
            from: std::array::from_fn(|a| border(a, place[a])),
            to: std::array::from_fn(|a| {
                let is_last = place[a] == self.last[a];
                border(a, place[a] + 1 + i32::from(is_last))
            }),
        }
    }

    /// The lower and the upper corner of a tile, work units; there is none where no other tile lies.
    pub fn corners(&self, place: Place) -> [Vec3; 2] {
        let corner = |a: usize, tile: i32| {
            let from_first = (f64::from(tile) - self.shift) * self.side as f64;
            (self.first[a] as f64 + from_first) * self.h[a]
        };
        let low = |a: usize| match place[a] {
            0 => f64::NEG_INFINITY,
            tile => corner(a, tile),
        };
        let high = |a: usize| match place[a] == self.last[a] {
            true => f64::INFINITY,
            false => corner(a, place[a] + 1),
        };
        [std::array::from_fn(low), std::array::from_fn(high)]
    }

    /// Whether a point is so near to where tiles meet.
    pub fn is_near_border(&self, p: Vec3, distance: f64) -> bool {
        (0..3).filter(|&a| self.last[a] > 0).any(|a| {
            let tiles = self.along(p, a);
            let border = tiles.round().clamp(1.0, self.last[a].into());
            (tiles - border).abs() * self.side as f64 * self.h[a] <= distance
        })
    }
}

/// A box of voxels, the upper corner not included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct VoxelBox {
    pub from: [i64; 3],
    pub to: [i64; 3],
}

impl VoxelBox {
    /// The box and so many voxels around it.
    pub fn grown(&self, voxels: usize) -> Self {
        let voxels = voxels as i64;
        Self {
            from: self.from.map(|v| v - voxels),
            to: self.to.map(|v| v + voxels),
        }
    }

    /// What of a run is in the box.
    pub fn clip(&self, run: &Run) -> Option<Run> {
        let is_in = |a: usize, v: u32| (self.from[a]..self.to[a]).contains(&i64::from(v));
        let from = i64::from(run.start).max(self.from[0]);
        let to = i64::from(run.end).min(self.to[0]);
        (is_in(1, run.y) && is_in(2, run.z) && from < to).then_some(Run {
            start: from as u32,
            end: to as u32,
            ..*run
        })
    }

    /// The corners of the box and so many voxels around it, work units.
    pub fn reaching(&self, voxels: f64, h: Vec3) -> [Vec3; 2] {
        let corner = |of: [i64; 3], by: f64| std::array::from_fn(|a| (of[a] as f64 + by) * h[a]);
        [corner(self.from, -voxels), corner(self.to, voxels)]
    }

    /// The box of all voxels of the parts.
    pub fn around(parts: &[Part]) -> Self {
        let runs = parts.iter().flat_map(|part| &part.runs);
        let both = |mut all: Self, own: Self| {
            all.add(&own);
            all
        };
        let none = Self {
            from: [0; 3],
            to: [0; 3],
        };
        runs.map(Self::of).reduce(both).unwrap_or(none)
    }

    /// The box of a run.
    fn of(run: &Run) -> Self {
        let from = [run.start, run.y, run.z].map(i64::from);
        let to = [run.end.into(), from[1] + 1, from[2] + 1];
        Self { from, to }
    }

    fn add(&mut self, other: &Self) {
        for a in 0..3 {
            self.from[a] = self.from[a].min(other.from[a]);
            self.to[a] = self.to[a].max(other.to[a]);
        }
    }
}

/// A tile that a component reaches into, or nearly so.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tile {
    pub place: Place,
    /// What encloses the labelled voxels in and next to the tile, and how many these are.
    pub near: VoxelBox,
    pub voxels: usize,
}

/// The tiles in which the surface of a component may be, ordered by x, y, z.
pub(crate) fn tiles(parts: &[Part], tiling: &Tiling) -> Result<Vec<Tile>> {
    let mut found: BTreeMap<Place, Tile> = BTreeMap::new();
    for run in parts.iter().flat_map(|part| &part.runs) {
        let around = VoxelBox::of(run).grown(OFF_LABEL);
        let first = tiling.place_of_voxel(around.from);
        let last = tiling.place_of_voxel(around.to.map(|v| v - 1));
        let along = |a: usize| first[a]..=last[a];
        let places =
            along(0).flat_map(|x| along(1).flat_map(move |y| along(2).map(move |z| [x, y, z])));
        for place in places {
            let Some(run) = tiling.voxels(place).grown(OFF_LABEL).clip(run) else {
                continue;
            };
            let near = VoxelBox::of(&run);
            let tile = found.entry(place).or_insert(Tile {
                place,
                near,
                voxels: 0,
            });
            tile.near.add(&near);
            tile.voxels += run.length();
        }
    }
    collected(found.into_values())
}

/// The parts that reach into a box, clipped to it, and their numbers among all.
pub(crate) fn clipped(parts: &[Part], to: &VoxelBox) -> Result<(Vec<Part>, Vec<u32>)> {
    let (mut clipped, mut numbers) = (Vec::new(), Vec::new());
    for (number, part) in parts.iter().enumerate() {
        let runs = collected(part.runs.iter().filter_map(|run| to.clip(run)))?;
        if !runs.is_empty() {
            push(&mut clipped, Part { runs, ..*part })?;
            push(&mut numbers, number as u32)?;
        }
    }
    Ok((clipped, numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(runs: &[[u32; 4]]) -> Part {
        let run = |&[z, y, start, end]: &[u32; 4]| Run {
            label: 1,
            z,
            y,
            start,
            end,
        };
        Part {
            label: 1,
            component: 0,
            runs: runs.iter().map(run).collect(),
        }
    }

    fn cube(from: i64, to: i64) -> VoxelBox {
        VoxelBox {
            from: [from; 3],
            to: [to; 3],
        }
    }

    #[test]
    fn tiles_are_where_the_label_is_or_nearly_so() {
        let tiling = |n: i64| Tiling::new(32, 0.0, &cube(0, n), [1.0; 3]);
        let parts = [part(&[[40, 40, 10, 50], [41, 40, 10, 30]])];
        let places = |n: i64| {
            let found = tiles(&parts, &tiling(n)).unwrap();
            found.iter().map(|t| t.place).collect::<Vec<_>>()
        };
        assert_eq!(places(64), [[0, 1, 1], [1, 1, 1]]);
        // The second one along an axis would be thin.
        assert_eq!(places(45), [[0; 3]]);
        let at_border = [part(&[[40, 61, 10, 20]])];
        let found = tiles(&at_border, &tiling(128)).unwrap();
        let second = Tile {
            place: [0, 2, 1],
            near: VoxelBox {
                from: [10, 61, 40],
                to: [20, 62, 41],
            },
            voxels: 10,
        };
        assert_eq!(found[1], second);
    }

    #[test]
    fn parts_are_clipped() {
        let parts = [part(&[[0, 0, 0, 9]]), part(&[[5, 5, 0, 9], [6, 5, 3, 4]])];
        let to = VoxelBox {
            from: [2, 4, 4],
            to: [5, 6, 6],
        };
        let (clipped, numbers) = clipped(&parts, &to).unwrap();
        assert_eq!(numbers, [1]);
        assert_eq!(clipped, [part(&[[5, 5, 2, 5]])]);
    }

    #[test]
    fn the_border_of_tiles_is_told() {
        let tiling = Tiling::new(10, 0.5, &cube(0, 40), [1.0, 1.0, 2.0]);
        assert_eq!(tiling.place([4.9, 5.1, 9.0]), [0, 1, 0]);
        assert_eq!(tiling.corners([0, 1, 0])[1], [5.0, 15.0, 10.0]);
        assert!(tiling.is_near_border([0.0, 0.0, 9.1], 1.0));
        assert!(!tiling.is_near_border([0.0, 0.0, 8.0], 1.0));
    }

    #[test]
    fn tiles_are_counted_from_the_first_brick_of_a_component() {
        let sheet = [part(&[[60, 3, 100, 170], [68, 100, 100, 170]])];
        let bounds = VoxelBox::around(&sheet);
        assert_eq!(bounds.from, [100, 3, 60]);
        assert_eq!(bounds.to, [170, 101, 69]);
        let tiling = Tiling::new(64, 0.0, &bounds, [1.0; 3]);
        // One layer of tiles along z, though it lies on both sides of a multiple of the side.
        let found = tiles(&sheet, &tiling).unwrap();
        let places: Vec<_> = found.iter().map(|t| t.place).collect();
        assert_eq!(places, [[0, 0, 0], [0, 1, 0]]);
        assert_eq!(tiling.corners([0, 0, 0])[1][1], 64.0);
        assert_eq!(tiling.place([0.0, 64.5, 200.0]), [0, 1, 0]);
        assert_eq!(tiling.place_of_brick([0; 3]), [0; 3]);
        assert_eq!(tiling.place_of_brick([12, 8, 7]), [0, 1, 0]);
        let shifted = Tiling::new(64, 0.5, &bounds, [1.0; 3]);
        assert_eq!(shifted.place([96.0, 31.5, 60.0]), [0, 0, 0]);
        assert_eq!(shifted.place([96.0, 32.5, 60.0]), [0, 1, 0]);
    }
}
