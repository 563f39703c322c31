//! Eigenvectors of symmetric 3 × 3 matrices, by Jacobi rotations.

use crate::grid::Vec3;

/// A symmetric matrix as xx, yy, zz, xy, xz, yz.
pub(crate) type Symmetric = [f64; 6];

/// Eigenvalues in ascending order, with their unit eigenvectors.
pub(crate) fn eigen([xx, yy, zz, xy, xz, yz]: Symmetric) -> [(f64, Vec3); 3] {
    let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let scale = xx.abs().max(yy.abs()).max(zz.abs()).max(xy.abs()).max(xz.abs()).max(yz.abs());
    // Convergence is quadratic: after four sweeps nothing is left off the diagonal.
    for _ in 0..6 {
        if a[0][1].abs().max(a[0][2].abs()).max(a[1][2].abs()) <= 1e-12 * scale {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut v, p, q);
        }
    }
    let mut order = [0, 1, 2].map(|i| (a[i][i], [v[0][i], v[1][i], v[2][i]]));
    order.sort_by(|x, y| x.0.total_cmp(&y.0));
    order
}

/// One Jacobi rotation, which zeroes a[p][q].
fn rotate(a: &mut [Vec3; 3], v: &mut [Vec3; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = 1f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for row in a.iter_mut() {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
    for k in 0..3 {
        (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
    }
    for row in v.iter_mut() {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
}
