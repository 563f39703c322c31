//! Sheets → surface: dual contouring without a global inside and outside.
//!
//! Every voxel near a sheet knows the sheet's normal and how far along it the middle is, and so a
//! signed distance, but normals have no sign of their own. None is needed: whether the sheet passes
//! between two neighbouring voxels is decided with one normal turned to agree with the other, and
//! all else follows from faces alone:
//!
//! - a grid edge whose signed distances change sign is *crossed*; it carries a quadrilateral, one
//!   corner in each of the four cubes of voxel centres around it;
//! - in a face of a cube, crossed edges are *paired*: two belong together, of three (where sheets
//!   meet) the two that continue each other best, four (where sheets pass side by side) by twos.
//!   Both cubes at the face decide alike, since they look at the face only;
//! - the crossed edges of a cube that pairs chain together share a corner, on the sheet (one vertex
//!   a loop, as in Schaefer, Ju and Warren 2007, "Manifold dual contouring").
//!
//! So each pair joins exactly two quadrilaterals, and the result is a 2-manifold with boundary,
//! whatever the field, but for its winding, which `surface/manifold.rs` settles. At a junction the sheet that
//! continues no other ends. Beyond the border of the volume the voxels are repeated, which makes
//! surfaces end on the border exactly.
//!
//! What follows on the surface is in this folder, too:
//!
//! | step | file |
//! | --- | --- |
//! | which edges of the voxel grid a sheet passes through | `crossings.rs` |
//! | the sheet fraction, ½ on a rim, and the cut along that | `rim.rs`, `trim.rs` |
//! | pieces that are no sheet's, short edges | `scraps.rs`, `weld.rs` |
//! | creases where sheets meet are cut open, holes within the label closed | `creases.rs`, `holes.rs` |

pub(crate) mod creases;
mod crossings;
pub(crate) mod holes;
pub(crate) mod rim;
pub(crate) mod scraps;
pub(crate) mod trim;
pub(crate) mod weld;

use crate::error::{check_count, collected, extend, reserve, reserved, Result};
use crate::execution::Execution;
use crate::fields::block::SIDE;
use crate::fields::bricks::{Batch, Directory, EDGE};
use crate::grid::{length, sub, Vec3};
use crate::sheets::sheet::Sheet;
use crate::surface::manifold::Surface;
use crossings::{edge_of_cube, Crossings, STRIDE};

/// No corner in a crossed edge's cube.
const NO_CORNER: u8 = 15;

/// Passes over all bricks that [`contour`] makes, for its progress.
pub(crate) const PASSES: usize = 2;

/// The surfaces of all parts of a batch, points in work units; a point's source is its part, as an
/// index into the batch's. `h` is the work spacing.
pub(crate) fn contour(
    batch: &Batch,
    sheets: &[Sheet],
    h: Vec3,
    execution: &mut Execution,
) -> Result<Surface> {
    let bricks = collected(0..batch.part_of_brick.len())?;
    let mut cells: Vec<Cells> = reserved(bricks.len())?;
    let mut surface = Surface::default();
    execution.stream(
        &bricks,
        |&brick| match Crossings::find(batch, brick, sheets, h) {
            Some(crossings) => Cells::new(&crossings),
            None => Default::default(),
        },
        |(mut own, points)| {
            own.first = surface.points.len() as u32;
            check_count("points", surface.points.len() + points.len(), 1)?;
            reserve(&mut surface.source, points.len())?;
            extend(&mut surface.points, points)?;
            let part = batch.part_of_brick[cells.len()];
            surface.source.resize(surface.points.len(), part);
            cells.push(own);
            Ok(())
        },
    )?;
    let points = &surface.points;
    let triangles = &mut surface.triangles;
    execution.stream(
        &bricks,
        |&brick| quadrilaterals(batch, &cells, brick, points),
        |own| {
            check_count("triangles", triangles.len() + own.len(), 3)?;
            extend(triangles, own)
        },
    )?;
    Ok(surface)
}

/// The cubes of one brick that the surface passes, in the order of their keys.
#[derive(Default)]
struct Cells {
    /// Each cube's key, and for each of its twelve edges the corner it shares, four bits each.
    cubes: Vec<(u16, u64)>,
    /// First point of each cube, counted from the brick's first.
    offset: Vec<u32>,
    /// Number of the brick's first point.
    first: u32,
    /// Crossed edges of the brick's own voxels: the voxel each starts from, and its axis.
    crossed: Vec<(u16, u8)>,
}

/// A cube's key: its low corner counted from one voxel before the brick.
fn key(low: [usize; 3]) -> u16 {
    ((low[2] * SIDE + low[1]) * SIDE + low[0]) as u16
}

impl Cells {
    fn new(crossings: &Crossings) -> (Self, Vec<Vec3>) {
        let mut cells = Self::default();
        let mut points = Vec::new();
        if crossings.crossed.iter().all(|&c| c == 0) {
            return (cells, points);
        }
        let from = crossings.first_cube;
        for z in from[2]..=EDGE.min(crossings.last[2]) {
            for y in from[1]..=EDGE.min(crossings.last[1]) {
                if !crossings.has_crossed_near(y, z) {
                    continue;
                }
                for x in from[0]..=EDGE.min(crossings.last[0]) {
                    cells.add_cube(crossings, [x, y, z], &mut points);
                }
            }
        }
        for z in 1..=EDGE.min(crossings.last[2]) {
            for y in 1..=EDGE.min(crossings.last[1]) {
                for x in 1..=EDGE.min(crossings.last[0]) {
                    cells.add_crossed(crossings, [x, y, z]);
                }
            }
        }
        (cells, points)
    }

    fn add_cube(&mut self, crossings: &Crossings, low: [usize; 3], points: &mut Vec<Vec3>) {
        let base = key(low) as usize;
        let mut edges = 0u16;
        for edge in 0..12 {
            let (axis, at) = edge_of_cube(base, edge);
            edges |= u16::from(crossings.crossed[at] >> axis & 1) << edge;
        }
        if edges == 0 {
            return;
        }
        let corner = corners(crossings, base, edges);
        let count = corner.iter().filter(|&&c| c != NO_CORNER).max();
        let count = count.map_or(0, |&c| c + 1);
        self.offset.push(points.len() as u32);
        for own in 0..count {
            points.push(crossings.place(base, low, |edge| corner[edge] == own));
        }
        let packed = corner
            .iter()
            .rev()
            .fold(0u64, |packed, &c| packed << 4 | u64::from(c));
        self.cubes.push((base as u16, packed));
    }

    fn add_crossed(&mut self, crossings: &Crossings, voxel: [usize; 3]) {
        let at = key(voxel) as usize;
        for axis in 0..3 {
            // An edge that leaves the volume lies between a voxel and its copy, and is not crossed.
            if crossings.crossed[at] >> axis & 1 == 1 {
                self.crossed.push((at as u16, axis as u8));
            }
        }
    }

    /// The point that crossed edge `edge` of the cube with this key has there.
    fn point(&self, key: u16, edge: usize) -> Option<u32> {
        let i = self.cubes.binary_search_by_key(&key, |cube| cube.0).ok()?;
        let corner = self.cubes[i].1 >> (4 * edge) & 15;
        (corner != u64::from(NO_CORNER)).then(|| self.first + self.offset[i] + corner as u32)
    }
}

/// Which corner of the surface each crossed edge of a cube shares: those that pairs in the cube's
/// faces chain together have the same.
fn corners(crossings: &Crossings, base: usize, edges: u16) -> [u8; 12] {
    let mut chain: [u8; 12] = std::array::from_fn(|edge| edge as u8);
    for (axis, stride) in STRIDE.into_iter().enumerate() {
        for side in 0..2 {
            // Around the face: along b, along c at the far end of b, and so on.
            let b = 4 * ((axis + 1) % 3);
            let c = 4 * ((axis + 2) % 3);
            let ring = [b + 2 * side, c + side + 2, b + 2 * side + 1, c + side];
            let crossed = ring.map(|edge| edges >> edge & 1 == 1);
            for (i, j) in crossings.pairs(base + side * stride, axis, crossed) {
                let (from, to) = (chain[ring[i]], chain[ring[j]]);
                chain
                    .iter_mut()
                    .filter(|c| **c == from)
                    .for_each(|c| *c = to);
            }
        }
    }
    let mut number = [NO_CORNER; 12];
    let mut corner = [NO_CORNER; 12];
    let mut count = 0;
    for edge in 0..12 {
        if edges >> edge & 1 == 1 {
            let chain = chain[edge] as usize;
            if number[chain] == NO_CORNER {
                number[chain] = count;
                count += 1;
            }
            corner[edge] = number[chain];
        }
    }
    corner
}

/// The triangles of the quadrilaterals around the crossed edges that start in a brick's voxels.
fn quadrilaterals(batch: &Batch, cells: &[Cells], brick: usize, points: &[Vec3]) -> Vec<[u32; 3]> {
    let (directory, place) = batch.brick(brick);
    let mut triangles = Vec::with_capacity(2 * cells[brick].crossed.len());
    for &(at, axis) in &cells[brick].crossed {
        let axis = axis as usize;
        // Around the edge, counted from its own voxel: the cube there, and those before it along
        // the two other axes.
        let corner = |u: usize, v: usize| {
            let mut low = [
                at as usize % SIDE,
                at as usize / SIDE % SIDE,
                at as usize / SIDE / SIDE,
            ];
            low[(axis + 1) % 3] -= u;
            low[(axis + 2) % 3] -= v;
            let (owner, low) = owner(directory, brick, place, low)?;
            cells[owner].point(key(low), 4 * axis + u + 2 * v)
        };
        if let (Some(a), Some(b), Some(c), Some(d)) =
            (corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1))
        {
            triangles.extend(halves([a, b, c, d], points));
        }
    }
    triangles
}

/// The brick that owns a cube, and the cube's low corner there: cubes before the brick belong to the
/// brick before, but at the border of the volume.
fn owner(
    directory: &Directory,
    brick: usize,
    mut place: [usize; 3],
    mut low: [usize; 3],
) -> Option<(usize, [usize; 3])> {
    let mut same = true;
    for axis in 0..3 {
        if low[axis] == 0 && place[axis] > 0 {
            place[axis] -= 1;
            low[axis] = EDGE;
            same = false;
        }
    }
    let owner = if same { brick } else { directory.brick(place)? };
    Some((owner, low))
}

/// Cuts a quadrilateral along its shorter diagonal; corners may coincide where chains meet.
fn halves([a, b, c, d]: [u32; 4], points: &[Vec3]) -> impl Iterator<Item = [u32; 3]> {
    let apart = |p: u32, q: u32| length(sub(points[p as usize], points[q as usize]));
    let halves = if apart(a, c) <= apart(b, d) {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    };
    halves
        .into_iter()
        .filter(|[p, q, r]| p != q && q != r && r != p)
}
