//! Which triangles are near: a grid of cells around some triangles of a surface.

use crate::buckets::Buckets;
use crate::error::{collected, Result};
use crate::grid::{floor, sub, Vec3};
use crate::manifold::Surface;
use crate::touching::TOUCHING;

/// Side of a cell, in mean sizes of a triangle; larger where the grid would have more than so many
/// cells a triangle.
const SIDE: f64 = 1.5;
const CELLS: usize = 4;
/// The triangles of a surface within `reach` of `some` of them.
pub(crate) fn near(surface: &Surface, some: &[u32], reach: f64) -> Result<Vec<u32>> {
    let cells = Cells::around(surface, some, reach);
    let wider = |t: u32| {
        let [low, high] = bounds(surface, t);
        [low.map(|v| v - reach), high.map(|v| v + reach)]
    };
    let entries = || {
        let of = |&t: &u32| cells.reached_by(wider(t)).map(move |cell| (cell, t));
        some.iter().flat_map(of)
    };
    let in_cell = Buckets::new(cells.count(), entries)?;
    let is_near = |&t: &u32| {
        let own = bounds(surface, t);
        let mut around = cells
            .reached_by(own)
            .flat_map(|cell| in_cell.of(cell as usize));
        around.any(|&other| overlap(own, wider(other)))
    };
    let all = 0..surface.triangles.len() as u32;
    collected(all.filter(is_near))
}

/// Lower and upper corner of what encloses a triangle, with room for touching.
pub(crate) fn bounds(surface: &Surface, t: u32) -> [Vec3; 2] {
    let [a, b, c] = surface.triangles[t as usize].map(|p| surface.points[p as usize]);
    [
        std::array::from_fn(|k| a[k].min(b[k]).min(c[k]) - TOUCHING),
        std::array::from_fn(|k| a[k].max(b[k]).max(c[k]) + TOUCHING),
    ]
}

/// Whether two boxes, each by its lower and upper corner, have a point in common.
pub(crate) fn overlap([low, high]: [Vec3; 2], [other_low, other_high]: [Vec3; 2]) -> bool {
    (0..3).all(|k| high[k] >= other_low[k] && other_high[k] >= low[k])
}

/// A grid of cubes around some triangles.
pub(crate) struct Cells {
    low: Vec3,
    side: f64,
    dimensions: [usize; 3],
}

impl Cells {
    /// A grid that reaches `margin` beyond the triangles.
    pub fn around(surface: &Surface, triangles: &[u32], margin: f64) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut size = 0.0;
        for &t in triangles {
            let [from, to] = bounds(surface, t);
            low = std::array::from_fn(|k| low[k].min(from[k]));
            high = std::array::from_fn(|k| high[k].max(to[k]));
            size += (0..3).map(|k| to[k] - from[k]).fold(0.0, f64::max);
        }
        let low = low.map(|v| v - margin);
        let extent = sub(high.map(|v| v + margin), low);
        let most = CELLS * surface.triangles.len();
        let least = (extent.iter().product::<f64>() / most as f64).cbrt();
        let side = least.max(SIDE * size / triangles.len() as f64);
        Self {
            low,
            side,
            dimensions: extent.map(|v| (v / side) as usize + 1),
        }
    }

    pub fn count(&self) -> usize {
        self.dimensions.iter().product()
    }

    /// Whether a cell is the one that holds the lower corner of what two boxes have in common: two that
    /// meet in several cells are to be looked at in one.
    pub fn is_first_of_both(&self, cell: u32, [low, other_low]: [Vec3; 2]) -> bool {
        let [nx, ny, _] = self.dimensions;
        let cell = cell as usize;
        let at = [cell % nx, cell / nx % ny, cell / (nx * ny)];
        (0..3).all(|k| {
            let common = (low[k].max(other_low[k]) - self.low[k]) / self.side;
            floor(common).max(0) as usize == at[k]
        })
    }

    /// The cells that a box reaches into; none where it lies beyond the grid.
    pub fn reached_by(&self, [low, high]: [Vec3; 2]) -> impl Iterator<Item = u32> {
        let [nx, ny, nz] = self.dimensions;
        let range = |k: usize, n: usize| {
            let at = |v: f64| floor((v - self.low[k]) / self.side);
            let first = at(low[k]).max(0) as usize;
            let end = (at(high[k]) + 1).clamp(0, n as isize) as usize;
            first..end
        };
        let (x, y, z) = (range(0, nx), range(1, ny), range(2, nz));
        z.flat_map(move |z| {
            let x = x.clone();
            y.clone()
                .flat_map(move |y| x.clone().map(move |x| ((z * ny + y) * nx + x) as u32))
        })
    }
}
