//! Sheets → crossings: which edges of the voxel grid a sheet passes through, and where.
//!
//! Neighbouring voxels each know the sheet from their own side. Where both speak of the same sheet
//! and it lies between them, their edge is crossed. What follows from that in the faces and cubes
//! around is told in `mod.rs`.

use crate::fields::block::{Block, SIDE};
use crate::fields::bricks::{Batch, BRICK, EDGE};
use crate::grid::{along, dot, sub, unit, Vec3};
use crate::sheets::sheet::Sheet;

/// Steps in a block of `SIDE`³ along x, y, z.
pub(crate) const STRIDE: [usize; 3] = [1, SIDE, SIDE * SIDE];
/// Neighbouring voxels, and crossings in a face, whose normals differ by more than this cosine's
/// angle share no sheet.
const ALIKE: f64 = 0.7;
/// Signed distances of neighbours may differ from what their normals say by so many work units:
/// more is the seam between two sheets.
const SEAM: f64 = 1.0;
/// Axis of an edge of the cube with its low corner at `base`, and the voxel it starts from: four
/// edges an axis a, by their place along a + 1 and a + 2.
pub(crate) fn edge_of_cube(base: usize, edge: usize) -> (usize, usize) {
    let axis = edge / 4;
    let (u, v) = (edge & 1, edge >> 1 & 1);
    (
        axis,
        base + u * STRIDE[(axis + 1) % 3] + v * STRIDE[(axis + 2) % 3],
    )
}

/// What a brick knows of its sheets, with a voxel around it, repeated beyond the border of the
/// volume.
pub(crate) struct Crossings {
    sheets: Block<Sheet>,
    /// Whether the edge from each voxel along x, y, z is crossed, a bit each.
    pub crossed: [u8; SIDE * SIDE * SIDE],
    /// First cube along each axis: one earlier at the border of the volume.
    pub first_cube: [usize; 3],
    /// The volume's last voxel along each axis.
    pub last: [usize; 3],
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
    pub fn find(batch: &Batch, brick: usize, field: &[Sheet], h: Vec3) -> Option<Self> {
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
    pub fn has_crossed_near(&self, y: usize, z: usize) -> bool {
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
    /// `base`, where they are of one sheet; edges by their place in the ring.
    pub fn pairs(
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
        let alike = |&(i, j): &(usize, usize)| dot(edge(i).1, edge(j).1).abs() >= ALIKE;
        let shared = pairs.map(|pair| pair.filter(alike));
        shared.into_iter().flatten()
    }

    /// The surface's corner in a cube: the mean of where its edges are crossed, moved onto the sheet.
    pub fn place(&self, base: usize, low: [usize; 3], shares: impl Fn(usize) -> bool) -> Vec3 {
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
