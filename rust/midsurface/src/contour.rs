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
//! whatever the field, but for its winding, which `manifold.rs` settles. At a junction the sheet that
//! continues no other ends. Beyond the border of the volume the voxels are repeated, which makes
//! surfaces end on the border exactly.

use crate::block::{Block, SIDE};
use crate::bricks::{Batch, Directory, BRICK, EDGE};
use crate::error::{reserved, Result};
use crate::execution::Execution;
use crate::grid::{along, dot, length, sub, unit, Vec3};
use crate::manifold::Surface;
use crate::sheet::Sheet;

/// Steps in a block of `SIDE`³ along x, y, z.
const STRIDE: [usize; 3] = [1, SIDE, SIDE * SIDE];
/// Neighbouring voxels whose normals differ by more than this cosine's angle share no sheet.
const ALIKE: f64 = 0.3;
/// Signed distances of neighbours may differ from what their normals say by so many work units:
/// more is the seam between two sheets.
const SEAM: f64 = 1.0;
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
    let bricks: Vec<usize> = (0..batch.part_of_brick.len()).collect();
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
            surface.points.extend(points);
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
            triangles.extend(own);
            Ok(())
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

/// Axis of an edge of the cube with its low corner at `base`, and the voxel it starts from: four
/// edges an axis a, by their place along a + 1 and a + 2.
fn edge_of_cube(base: usize, edge: usize) -> (usize, usize) {
    let axis = edge / 4;
    let (u, v) = (edge & 1, edge >> 1 & 1);
    (
        axis,
        base + u * STRIDE[(axis + 1) % 3] + v * STRIDE[(axis + 2) % 3],
    )
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

/// What a brick knows of its sheets, with a voxel around it, repeated beyond the border of the
/// volume.
struct Crossings {
    sheets: Block<Sheet>,
    /// Whether the edge from each voxel along x, y, z is crossed, a bit each.
    crossed: [u8; SIDE * SIDE * SIDE],
    /// First cube along each axis: one earlier at the border of the volume.
    first_cube: [usize; 3],
    /// The volume's last voxel along each axis.
    last: [usize; 3],
    /// Voxel of the volume at the block's first, which may lie outside.
    start: [isize; 3],
    h: Vec3,
    /// Where crossed edges are crossed, from the block's first voxel, and the sheet's normal there.
    places: Vec<(Vec3, Vec3)>,
    /// Which of these is that of the edge from each voxel along x, y, z.
    number: [[u16; 3]; SIDE * SIDE * SIDE],
}

impl Crossings {
    /// `None` where the brick knows no sheet.
    fn find(batch: &Batch, brick: usize, field: &[Sheet], h: Vec3) -> Option<Self> {
        let own = &field[brick * BRICK..][..BRICK];
        if own.iter().all(|sheet| *sheet == Sheet::default()) {
            return None;
        }
        let (directory, place) = batch.brick(brick);
        let mut sheets = Block::gather(batch, brick, field);
        sheets.repeat_beyond(directory, place);
        let start = place.map(|p| (p * EDGE) as isize - 1);
        let mut crossings = Self {
            sheets,
            crossed: [0; SIDE * SIDE * SIDE],
            first_cube: place.map(|p| usize::from(p > 0)),
            last: std::array::from_fn(|a| {
                (directory.dimensions[a] as isize - 1 - start[a]) as usize
            }),
            start,
            h,
            places: Vec::new(),
            number: [[0; 3]; SIDE * SIDE * SIDE],
        };
        crossings.find_crossed();
        crossings.find_places();
        Some(crossings)
    }

    fn find_crossed(&mut self) {
        for at in 0..self.crossed.len() {
            if self.sheets.values[at] == Sheet::default() {
                continue;
            }
            let voxel = [at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE];
            for (axis, place) in voxel.into_iter().enumerate() {
                if place + 1 < SIDE && self.is_crossed(at, axis) {
                    self.crossed[at] |= 1 << axis;
                }
            }
        }
    }

    /// Whether any edge is crossed in the cubes whose low corners are in a row.
    fn has_crossed_near(&self, y: usize, z: usize) -> bool {
        let is_crossed = |y: usize, z: usize| {
            let row = &self.crossed[(z * SIDE + y) * SIDE..][..SIDE];
            row.iter().fold(0, |any, c| any | c) != 0
        };
        is_crossed(y, z) || is_crossed(y + 1, z) || is_crossed(y, z + 1) || is_crossed(y + 1, z + 1)
    }

    /// Whether the sheet passes between a voxel and its neighbour along an axis.
    fn is_crossed(&self, at: usize, axis: usize) -> bool {
        let (a, b) = (
            self.sheets.values[at],
            self.sheets.values[at + STRIDE[axis]],
        );
        let alike = cosine(&a, &b);
        // −offset is the signed distance; the sign of a zero counts.
        let changes = a[3].is_sign_negative() ^ b[3].is_sign_negative() ^ (alike < 0.0);
        if !changes || f64::from(alike.abs()) < ALIKE {
            return false;
        }
        let turn = alike.signum();
        let expected = 0.5 * (a[axis] + turn * b[axis]) * self.h[axis] as f32;
        let found = a[3] - turn * b[3];
        f64::from((found - expected).abs()) <= SEAM
    }

    fn find_places(&mut self) {
        for at in 0..self.crossed.len() {
            for axis in (0..3).filter(|axis| self.crossed[at] >> axis & 1 == 1) {
                self.number[at][axis] = self.places.len() as u16;
                self.places.push(self.find_place(at, axis));
            }
        }
    }

    /// Where the sheet crosses an edge and its normal there.
    fn crossing(&self, at: usize, axis: usize) -> (Vec3, Vec3) {
        self.places[self.number[at][axis] as usize]
    }

    fn find_place(&self, at: usize, axis: usize) -> (Vec3, Vec3) {
        let (a, b) = (
            &self.sheets.values[at],
            &self.sheets.values[at + STRIDE[axis]],
        );
        let turn = cosine(a, b).signum();
        let (from, to) = (f64::from(a[3]), f64::from(turn * b[3]));
        let t = if from == to { 0.5 } else { from / (from - to) };
        let mut place = self.position(at);
        place[axis] += t * self.h[axis];
        let normal =
            std::array::from_fn(|k| f64::from((1.0 - t as f32) * a[k] + t as f32 * turn * b[k]));
        (place, unit(normal))
    }

    /// Work coordinates of a voxel of the block; a copy beyond the border is where its original is.
    fn position(&self, at: usize) -> Vec3 {
        let voxel = [at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE];
        std::array::from_fn(|a| {
            let inside = voxel[a].min(self.last[a]) as isize;
            (self.start[a] + inside).max(0) as f64 * self.h[a]
        })
    }

    /// Pairs the crossed edges around the face of a cube across `axis` with its low corner at
    /// `base`; edges by their place in the ring.
    fn pairs(
        &self,
        base: usize,
        axis: usize,
        crossed: [bool; 4],
    ) -> impl Iterator<Item = (usize, usize)> {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let edge = |i: usize| match i {
            0 => self.crossing(base, b),
            1 => self.crossing(base + STRIDE[b], c),
            2 => self.crossing(base + STRIDE[c], b),
            _ => self.crossing(base, c),
        };
        // How far two crossings are from lying on one sheet.
        let gap = |i: usize, j: usize| {
            let ((p, m), (q, n)) = (edge(i), edge(j));
            let d = sub(q, p);
            dot(d, m).abs() + dot(d, n).abs()
        };
        let mut own = [0; 4];
        let mut count = 0;
        for i in (0..4).filter(|&i| crossed[i]) {
            own[count] = i;
            count += 1;
        }
        let pairs: [Option<(usize, usize)>; 2] = match own[..count] {
            [i, j] => [Some((i, j)), None],
            [i, j, k] => {
                let (ij, ik, jk) = (gap(i, j), gap(i, k), gap(j, k));
                let best = if ij <= ik && ij <= jk {
                    (i, j)
                } else if ik <= jk {
                    (i, k)
                } else {
                    (j, k)
                };
                [Some(best), None]
            }
            [_, _, _, _] => {
                if gap(0, 1) + gap(2, 3) <= gap(1, 2) + gap(3, 0) {
                    [Some((0, 1)), Some((2, 3))]
                } else {
                    [Some((1, 2)), Some((3, 0))]
                }
            }
            _ => [None, None],
        };
        pairs.into_iter().flatten()
    }

    /// The surface's corner in a cube: the mean of where its edges are crossed, moved onto the sheet.
    fn place(&self, base: usize, low: [usize; 3], shares: impl Fn(usize) -> bool) -> Vec3 {
        let (mut sum, mut normal, mut count) = ([0.0; 3], [0.0; 3], 0.0);
        for edge in (0..12).filter(|&edge| shares(edge)) {
            let (axis, at) = edge_of_cube(base, edge);
            let (place, n) = self.crossing(at, axis);
            sum = along(sum, 1.0, place);
            normal = along(normal, if dot(n, normal) < 0.0 { -1.0 } else { 1.0 }, n);
            count += 1.0;
        }
        let (mean, normal) = (sum.map(|v| v / count), unit(normal));
        let (mut off, mut count) = (0.0, 0.0);
        for edge in (0..12).filter(|&edge| shares(edge)) {
            let (axis, at) = edge_of_cube(base, edge);
            for end in [at, at + STRIDE[axis]] {
                off += self.distance_from(end, mean, normal);
                count += 1.0;
            }
        }
        // The corner of a cube beyond the border of the volume stays on the border.
        let within: Vec3 =
            std::array::from_fn(|a| if self.beyond(low, a) { 0.0 } else { normal[a] });
        let share = dot(within, within);
        if share < 0.1 {
            return mean;
        }
        let place = along(mean, -off / count / share, within);
        std::array::from_fn(|a| {
            let last = (self.start[a] + self.last[a] as isize) as f64 * self.h[a];
            place[a].clamp(0.0, last)
        })
    }

    /// Whether a cube lies beyond the border of the volume along an axis.
    fn beyond(&self, low: [usize; 3], axis: usize) -> bool {
        (low[axis] == 0 && self.start[axis] < 0) || low[axis] == self.last[axis]
    }

    /// Signed distance of a point from the sheet of a voxel, along `normal`. The mean of both
    /// normals makes it exact to second order.
    fn distance_from(&self, at: usize, p: Vec3, normal: Vec3) -> f64 {
        let [x, y, z, offset] = self.sheets.values[at].map(f64::from);
        let own = [x, y, z];
        let turn = if dot(own, normal) < 0.0 { -1.0 } else { 1.0 };
        let d = sub(p, self.position(at));
        -turn * offset + 0.5 * (dot(normal, d) + turn * dot(own, d))
    }
}

/// Cosine between the normals of two voxels; 0 where one knows none.
fn cosine(a: &Sheet, b: &Sheet) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
