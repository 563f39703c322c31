//! Fields between the voxels: a cubic B-spline whose coefficients are the field's values.
//!
//! The spline adds a variance of 1/3 voxel to the Gaussian and has no kinks at the voxels, so that
//! where a field crosses a threshold does not snap to the grid, as under linear interpolation.

use crate::fields::bricks::{Directory, EDGE, LAYER};
use crate::grid::{floor, round, Vec3};

/// Values of the uniform cubic B-spline at offsets −1, 0, 1, 2 from the voxel below.
fn basis(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        s * s * s / 6.0,
        (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
        (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
        t * t * t / 6.0,
    ]
}

/// One field of a part, and the work spacing.
#[derive(Clone, Copy)]
pub(crate) struct Sampler<'a> {
    pub directory: &'a Directory,
    pub field: &'a [f32],
    pub h: Vec3,
}

impl Sampler<'_> {
    /// The field's value at voxel (x, y, z). Across the border of the volume it is continued
    /// linearly, from the values as far inside.
    fn coefficient(&self, voxel: [isize; 3]) -> f64 {
        let dimensions = self.directory.dimensions;
        for axis in 0..3 {
            let last = dimensions[axis] as isize - 1;
            let edge = voxel[axis].clamp(0, last);
            if voxel[axis] != edge {
                let (mut border, mut mirrored) = (voxel, voxel);
                border[axis] = edge;
                mirrored[axis] = (2 * edge - voxel[axis]).clamp(0, last);
                return 2.0 * self.coefficient(border) - self.coefficient(mirrored);
            }
        }
        self.directory
            .entry_at(voxel)
            .map_or(0.0, |entry| self.field[entry].into())
    }

    /// The 4 × 4 coefficients around (x, y) in slice z, and the fraction within the pixel.
    fn window(&self, at: [f64; 2], z: usize) -> ([[f64; 4]; 4], [f64; 2]) {
        let p = [at[0] / self.h[0], at[1] / self.h[1]];
        let base = p.map(floor);
        let (x, y) = (base[0] - 1, base[1] - 1);
        let mut window = [[0.0; 4]; 4];
        let [nx, ny, _] = self.directory.dimensions;
        let inside = x >= 0 && y >= 0 && x as usize + 3 < nx && y as usize + 3 < ny;
        if inside {
            self.copy_window(x as usize, y as usize, z, &mut window);
        } else {
            for (j, row) in window.iter_mut().enumerate() {
                for (i, value) in row.iter_mut().enumerate() {
                    *value = self.coefficient([x + i as isize, y + j as isize, z as isize]);
                }
            }
        }
        (window, [p[0] - base[0] as f64, p[1] - base[1] as f64])
    }

    /// Fills the window from at most four bricks.
    fn copy_window(&self, x: usize, y: usize, z: usize, window: &mut [[f64; 4]; 4]) {
        for by in y / EDGE..=(y + 3) / EDGE {
            for bx in x / EDGE..=(x + 3) / EDGE {
                let Some(brick) = self.directory.brick([bx, by, z / EDGE]) else {
                    continue;
                };
                let layer = &self.field[(brick * EDGE + z % EDGE) * LAYER..][..LAYER];
                for j in y.max(by * EDGE)..(y + 4).min(by * EDGE + EDGE) {
                    for i in x.max(bx * EDGE)..(x + 4).min(bx * EDGE + EDGE) {
                        window[j - y][i - x] = layer[j % EDGE * EDGE + i % EDGE].into();
                    }
                }
            }
        }
    }

    /// The field's value at the voxel nearest to a continuous voxel index; 0 where it has none.
    #[inline]
    pub fn nearest(&self, [x, y, z]: Vec3) -> f64 {
        let entry = self.directory.entry_at([round(x), round(y), round(z)]);
        entry.map_or(0.0, |entry| self.field[entry].into())
    }

    /// The value at a point of the volume, linear between voxels, work units.
    pub fn linear(&self, p: Vec3) -> f64 {
        let voxel: Vec3 = std::array::from_fn(|a| p[a] / self.h[a]);
        let low = voxel.map(floor);
        let weights: [[f64; 2]; 3] = std::array::from_fn(|a| {
            let low = low[a] as f64;
            [1.0 - voxel[a] + low, voxel[a] - low]
        });
        let values = self.corners(low);
        (0..8)
            .map(|i| {
                let [x, y, z] = [i & 1, i >> 1 & 1, i >> 2];
                weights[0][x] * weights[1][y] * weights[2][z] * values[i]
            })
            .sum()
    }

    /// The values at a voxel and those next to it ahead, x fastest.
    fn corners(&self, low: [isize; 3]) -> [f64; 8] {
        let within = |a: usize| {
            let last_of_brick = low[a] as usize % EDGE + 1 == EDGE;
            low[a] >= 0 && !last_of_brick && low[a] as usize + 1 < self.directory.dimensions[a]
        };
        if within(0) && within(1) && within(2) {
            // All eight voxels are in one brick.
            let Some(first) = self.directory.entry_at(low) else {
                return [0.0; 8];
            };
            let field = &self.field[first..][..LAYER + EDGE + 2];
            return [
                field[0],
                field[1],
                field[EDGE],
                field[EDGE + 1],
                field[LAYER],
                field[LAYER + 1],
                field[LAYER + EDGE],
                field[LAYER + EDGE + 1],
            ]
            .map(f64::from);
        }
        std::array::from_fn(|i| {
            let corner = [i & 1, i >> 1 & 1, i >> 2];
            self.coefficient(std::array::from_fn(|a| low[a] + corner[a] as isize))
        })
    }

    /// The value at (x, y) in slice z, work units.
    pub fn value(&self, at: [f64; 2], z: usize) -> f64 {
        let (window, t) = self.window(at, z);
        contract(&window, &basis(t[0]), &basis(t[1]))
    }
}

fn contract(window: &[[f64; 4]; 4], x: &[f64; 4], y: &[f64; 4]) -> f64 {
    let row = |j: usize| -> f64 { (0..4).map(|i| window[j][i] * x[i]).sum() };
    (0..4).map(|j| y[j] * row(j)).sum()
}
