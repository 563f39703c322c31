//! Fields between the voxels: a cubic B-spline whose coefficients are the field's values.
//!
//! The spline adds a variance of 1/3 voxel to the Gaussian and makes the field twice continuously
//! differentiable, so that gradient and Hessian are exact and a ridge does not snap to the grid,
//! as it does under linear interpolation.

use crate::bricks::{Directory, EDGE, LAYER};
use crate::grid::Vec3;

/// Values of the uniform cubic B-spline at offsets −1, 0, 1, 2 from the voxel below, with the
/// first and second derivatives.
fn basis(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [
            s * s * s / 6.0,
            (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
            (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
            t * t * t / 6.0,
        ],
        [
            -0.5 * s * s,
            1.5 * t * t - 2.0 * t,
            -1.5 * s * s + 2.0 * s,
            0.5 * t * t,
        ],
        [s, 3.0 * t - 2.0, 3.0 * s - 2.0, t],
    ]
}

/// One field of a part, and the work spacing.
#[derive(Clone, Copy)]
pub(crate) struct Sampler<'a> {
    pub directory: &'a Directory,
    pub field: &'a [f32],
    pub h: Vec3,
}

/// Value and derivatives in a slice, work units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Planar {
    pub gradient: [f64; 2],
    /// Second derivatives xx, xy, yy.
    pub hessian: [f64; 3],
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
        self.directory.entry_at(voxel).map_or(0.0, |entry| self.field[entry].into())
    }

    /// The 4 × 4 coefficients around (x, y) in slice z, and the fraction within the pixel.
    fn window(&self, at: [f64; 2], z: usize) -> ([[f64; 4]; 4], [f64; 2]) {
        let p = [at[0] / self.h[0], at[1] / self.h[1]];
        let base = [p[0].floor(), p[1].floor()];
        let (x, y) = (base[0] as isize - 1, base[1] as isize - 1);
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
        (window, [p[0] - base[0], p[1] - base[1]])
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

    /// The value at (x, y) in slice z, work units.
    pub fn value(&self, at: [f64; 2], z: usize) -> f64 {
        let (window, t) = self.window(at, z);
        contract(&window, &basis(t[0])[0], &basis(t[1])[0])
    }

    /// Gradient and Hessian at (x, y) in slice z.
    pub fn planar(&self, at: [f64; 2], z: usize) -> Planar {
        let (window, t) = self.window(at, z);
        let (x, y) = (basis(t[0]), basis(t[1]));
        let [hx, hy, _] = self.h;
        Planar {
            gradient: [
                contract(&window, &x[1], &y[0]) / hx,
                contract(&window, &x[0], &y[1]) / hy,
            ],
            hessian: [
                contract(&window, &x[2], &y[0]) / (hx * hx),
                contract(&window, &x[1], &y[1]) / (hx * hy),
                contract(&window, &x[0], &y[2]) / (hy * hy),
            ],
        }
    }

    /// The Hessian in space at (x, y) in slice z: xx, yy, zz, xy, xz, yz. Along z the spline
    /// sits on a slice, where its weights are 1/6, 2/3, 1/6.
    pub fn hessian(&self, at: [f64; 2], z: usize) -> [f64; 6] {
        let last = self.directory.dimensions[2] - 1;
        let slices = [z.saturating_sub(1), z, (z + 1).min(last)];
        let windows = slices.map(|z| self.window(at, z).0);
        let t = self.window(at, z).1;
        let (x, y) = (basis(t[0]), basis(t[1]));
        let [hx, hy, hz] = self.h;
        let along_z = |dx: usize, dy: usize, weights: [f64; 3]| -> f64 {
            (0..3).map(|k| weights[k] * contract(&windows[k], &x[dx], &y[dy])).sum()
        };
        let value = [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0];
        // One-sided at the first and the last slice, where two of the windows are the same.
        let span = (slices[2] - slices[0]).max(1) as f64;
        let slope = [-1.0 / span, 0.0, 1.0 / span];
        let bend = if span == 2.0 { [1.0, -2.0, 1.0] } else { [0.0; 3] };
        [
            along_z(2, 0, value) / (hx * hx),
            along_z(0, 2, value) / (hy * hy),
            along_z(0, 0, bend) / (hz * hz),
            along_z(1, 1, value) / (hx * hy),
            along_z(1, 0, slope) / (hx * hz),
            along_z(0, 1, slope) / (hy * hz),
        ]
    }
}

fn contract(window: &[[f64; 4]; 4], x: &[f64; 4], y: &[f64; 4]) -> f64 {
    let row = |j: usize| -> f64 { (0..4).map(|i| window[j][i] * x[i]).sum() };
    (0..4).map(|j| y[j] * row(j)).sum()
}
