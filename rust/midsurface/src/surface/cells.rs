//! Which triangles are near: a grid of cells around some triangles of a surface.

use crate::error::{collected, zeros, Result};
use crate::grid::{floor, sub, Vec3};
use crate::surface::manifold::Surface;
use crate::surface::touching::TOUCHING;

/// Side of a cell, in mean sizes of a triangle and at least this share of what is looked at around
/// them; larger where the grid would have more than so many cells a triangle.
const SIDE: f64 = 1.5;
const SHARE: f64 = 0.5;
const CELLS: usize = 4;

/// A box along the axes: its lower and upper corner.
pub(crate) type Bounds = [Vec3; 2];

/// The triangles of a surface within `reach` of some boxes, with such as are hardly farther: those in a
/// cell that a box reaches into.
pub(crate) fn near(surface: &Surface, boxes: &[Bounds], reach: f64) -> Result<Vec<u32>> {
    let cells = Cells::around(boxes, reach, surface);
    let mut is_reached: Vec<bool> = zeros(cells.count())?;
    for [low, high] in boxes {
        let wider = [low.map(|v| v - reach), high.map(|v| v + reach)];
        for cell in cells.reached_by(wider) {
            is_reached[cell as usize] = true;
        }
    }
    let is_near = |&t: &u32| {
        let mut around = cells.reached_by(bounds(surface, t));
        around.any(|cell| is_reached[cell as usize])
    };
    let all = 0..surface.triangles.len() as u32;
    collected(all.filter(is_near))
}

/// What encloses each of some triangles, with room for touching.
pub(crate) fn all_bounds(surface: &Surface, some: &[u32]) -> Result<Vec<Bounds>> {
    collected(some.iter().map(|&t| bounds(surface, t)))
}

/// What encloses a triangle, with room for touching.
pub(crate) fn bounds(surface: &Surface, t: u32) -> Bounds {
    let [a, b, c] = surface.triangles[t as usize].map(|p| surface.points[p as usize]);
    [
        std::array::from_fn(|k| a[k].min(b[k]).min(c[k]) - TOUCHING),
        std::array::from_fn(|k| a[k].max(b[k]).max(c[k]) + TOUCHING),
    ]
}

/// Whether two boxes have a point in common.
pub(crate) fn overlap([low, high]: Bounds, [other_low, other_high]: Bounds) -> bool {
    (0..3).all(|k| high[k] >= other_low[k] && other_high[k] >= low[k])
}

/// A grid of cubes around some boxes.
pub(crate) struct Cells {
    low: Vec3,
    side: f64,
    dimensions: [usize; 3],
}

impl Cells {
    /// A grid that reaches `margin` beyond boxes as large as a surface's triangles, with cells for these.
    pub fn around(boxes: &[Bounds], margin: f64, surface: &Surface) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut size = 0.0;
        for [from, to] in boxes {
            low = std::array::from_fn(|k| low[k].min(from[k]));
            high = std::array::from_fn(|k| high[k].max(to[k]));
            size += (0..3).map(|k| to[k] - from[k]).fold(0.0, f64::max);
        }
        let low = low.map(|v| v - margin);
        let extent = sub(high.map(|v| v + margin), low);
        let most = CELLS * surface.triangles.len();
        let least = (extent.iter().product::<f64>() / most as f64).cbrt();
        let side = least.max(SIDE * size / boxes.len() as f64);
        let side = side.max(SHARE * margin);
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
    pub fn reached_by(&self, [low, high]: Bounds) -> impl Iterator<Item = u32> {
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
