//! A brick with one voxel around it, for differences between neighbouring voxels.

use crate::fields::bricks::{Batch, Directory, BRICK, EDGE, LAYER};
use crate::fields::eigen::Symmetric;
use crate::grid::Vec3;

/// Voxels along a block's edge.
pub(crate) const SIDE: usize = EDGE + 2;

/// A value for every voxel of a row along x of a brick.
pub(crate) type Row = [f32; EDGE];

/// A vector at place i of its entries' rows. Written out, since the `map` of an array is not
/// always inlined, and a loop with it then takes one voxel at a time.
#[inline(always)]
pub(crate) fn vector_at<L: AsRef<[f32]>>(entries: &[L; 3], i: usize) -> [f32; 3] {
    let [x, y, z] = entries;
    [x.as_ref()[i], y.as_ref()[i], z.as_ref()[i]]
}

/// A symmetric matrix at place i of its entries' rows, as [`vector_at`].
#[inline(always)]
pub(crate) fn matrix_at<L: AsRef<[f32]>>(entries: &[L; 6], i: usize) -> Symmetric<f32> {
    let [xx, yy, zz, xy, xz, yz] = entries;
    let [xx, yy, zz] = [xx.as_ref()[i], yy.as_ref()[i], zz.as_ref()[i]];
    [xx, yy, zz, xy.as_ref()[i], xz.as_ref()[i], yz.as_ref()[i]]
}

/// The voxels of a brick and those around it: shape (10, 10, 10), x fastest.
pub(crate) struct Block<T> {
    pub values: [T; SIDE * SIDE * SIDE],
}

impl<T: Copy + Default> Block<T> {
    /// Reads a field around a brick; what lies outside the part's bricks has the default value.
    pub fn gather(batch: &Batch, brick: usize, field: &[T]) -> Self {
        let (directory, place) = batch.brick(brick);
        let mut values = [T::default(); SIDE * SIDE * SIDE];
        for side in 0..27 {
            let side = [side % 3, side / 3 % 3, side / 9];
            let Some(brick) = neighbour(directory, place, side) else {
                continue;
            };
            let own = &field[brick * BRICK..][..BRICK];
            let [x, y, z] = side.map(shared);
            for k in 0..z.count {
                for j in 0..y.count {
                    let to = ((z.to + k) * SIDE + y.to + j) * SIDE + x.to;
                    let from = (z.from + k) * LAYER + (y.from + j) * EDGE + x.from;
                    if x.count == EDGE {
                        // A copy of a length that is known is no call.
                        values[to..to + EDGE].copy_from_slice(&own[from..from + EDGE]);
                    } else {
                        values[to] = own[from];
                    }
                }
            }
        }
        Self { values }
    }
}

/// The brick next to the one at `place`: 0, 1, 2 are below, the same and above along each axis.
fn neighbour(directory: &Directory, place: [usize; 3], side: [usize; 3]) -> Option<usize> {
    let mut at = place;
    for (at, side) in at.iter_mut().zip(side) {
        *at = (*at + side).checked_sub(1)?;
    }
    directory.brick(at)
}

/// The voxels that a block and one of its bricks share along an axis.
struct Shared {
    count: usize,
    from: usize,
    to: usize,
}

fn shared(side: usize) -> Shared {
    let (count, from, to) = [(1, EDGE - 1, 0), (EDGE, 0, 1), (1, 0, SIDE - 1)][side];
    Shared { count, from, to }
}

/// Position in a block of the first voxel of row y in layer z of its brick.
pub(crate) fn row(y: usize, z: usize) -> usize {
    ((z + 1) * SIDE + y + 1) * SIDE + 1
}

impl<T: Copy> Block<T> {
    /// Repeats the outermost voxels across the borders of the volume, the block's brick being at
    /// `place`.
    pub fn repeat_beyond(&mut self, directory: &Directory, place: [usize; 3]) {
        self.fill_beyond(directory, place, |outermost, _| outermost);
    }

    /// Fills the voxels across the borders of the volume with `beyond` of the outermost voxel and
    /// the one before.
    fn fill_beyond(
        &mut self,
        directory: &Directory,
        place: [usize; 3],
        beyond: impl Fn(T, T) -> T,
    ) {
        for axis in 0..3 {
            let stride = [1, SIDE, SIDE * SIDE][axis];
            let last = directory.dimensions[axis] - 1;
            let low = (place[axis] == 0).then_some((0, 1isize));
            let high = (last / EDGE == place[axis]).then_some((last % EDGE + 2, -1));
            for (layer, inward) in low.into_iter().chain(high) {
                for i in 0..SIDE * SIDE {
                    let (a, b) = (i % SIDE, i / SIDE);
                    let other = [[SIDE, SIDE * SIDE], [1, SIDE * SIDE], [1, SIDE]][axis];
                    let at = a * other[0] + b * other[1] + layer * stride;
                    let step = |k: isize| (at as isize + inward * k * stride as isize) as usize;
                    let second = if last == 0 { step(1) } else { step(2) };
                    self.values[at] = beyond(self.values[step(1)], self.values[second]);
                }
            }
        }
    }
}

impl<T: Copy + Default + PartialOrd> Block<T> {
    /// The largest value among each voxel of the brick and its 26 neighbours.
    #[inline(always)]
    pub fn largest_near(&self) -> [T; BRICK] {
        let larger = |a: T, b: T| if a > b { a } else { b };
        let three = |v: &[T], i: usize, stride: usize| {
            larger(larger(v[i], v[i + stride]), v[i + 2 * stride])
        };
        let mut along_x = [T::default(); SIDE * SIDE * EDGE];
        let rows = self.values.chunks_exact(SIDE);
        for (values, out) in rows.zip(along_x.chunks_exact_mut(EDGE)) {
            for (x, out) in out.iter_mut().enumerate() {
                *out = three(values, x, 1);
            }
        }
        let mut along_y = [T::default(); SIDE * LAYER];
        let layers = along_x.chunks_exact(SIDE * EDGE);
        for (values, out) in layers.zip(along_y.chunks_exact_mut(LAYER)) {
            for (i, out) in out.iter_mut().enumerate() {
                *out = three(values, i, EDGE);
            }
        }
        std::array::from_fn(|i| three(&along_y, i, LAYER))
    }
}

impl Block<f32> {
    /// Continues the field linearly across the borders of the volume, the block's brick being at
    /// `place`.
    pub fn continue_beyond(&mut self, directory: &Directory, place: [usize; 3]) {
        self.fill_beyond(directory, place, |outermost, before| {
            2.0 * outermost - before
        });
    }

    /// The field in row y of layer z of the brick.
    #[inline(always)]
    pub fn row(&self, y: usize, z: usize) -> &Row {
        self.row_at(row(y, z))
    }

    #[inline(always)]
    fn row_at(&self, first: usize) -> &Row {
        self.values[first..].first_chunk().unwrap_or(&[0.0; EDGE])
    }

    /// Gradient and Hessian in row y of layer z of the brick, by central differences.
    #[inline(always)]
    pub fn row_derivatives(&self, y: usize, z: usize, h: Vec3) -> ([Row; 3], Symmetric<Row>) {
        let stride = [1, SIDE, SIDE * SIDE];
        let mut gradient = [[0.0; EDGE]; 3];
        let mut hessian = [[0.0; EDGE]; 6];
        let first = row(y, z);
        let centre = self.row_at(first);
        for axis in 0..3 {
            let low = self.row_at(first - stride[axis]);
            let high = self.row_at(first + stride[axis]);
            let once = (0.5 / h[axis]) as f32;
            let twice = (1.0 / (h[axis] * h[axis])) as f32;
            for x in 0..EDGE {
                gradient[axis][x] = once * (high[x] - low[x]);
                // Differences first, since they are exact where the field is smooth.
                let bend = (high[x] - centre[x]) - (centre[x] - low[x]);
                hessian[axis][x] = twice * bend;
            }
        }
        for (entry, (a, b)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
            let (s, t) = (stride[a], stride[b]);
            let (high, low) = (first + t, first - t);
            let (above, below) = (self.row_at(high + s), self.row_at(high - s));
            let (above_low, below_low) = (self.row_at(low + s), self.row_at(low - s));
            let scale = (0.25 / (h[a] * h[b])) as f32;
            for x in 0..EDGE {
                let (up, down) = (above[x] - below[x], above_low[x] - below_low[x]);
                hessian[3 + entry][x] = scale * (up - down);
            }
        }
        (gradient, hessian)
    }
}
