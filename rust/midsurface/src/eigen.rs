//! Eigenvalues and eigenvectors of symmetric 3 × 3 matrices, in closed form.

use crate::grid::{cross, dot, unit, Vec3};

/// A symmetric matrix as xx, yy, zz, xy, xz, yz.
pub(crate) type Symmetric = [f64; 6];

/// The eigenvalues in ascending order (Smith 1961, by the trigonometric solution of the cubic).
pub(crate) fn eigenvalues([xx, yy, zz, xy, xz, yz]: Symmetric) -> Vec3 {
    let mean = (xx + yy + zz) / 3.0;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let p = ((a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0).sqrt();
    if p <= f64::MIN_POSITIVE {
        return [mean; 3];
    }
    let determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    let angle = (determinant / (2.0 * p * p * p)).clamp(-1.0, 1.0).acos() / 3.0;
    let turn = 2.0 * std::f64::consts::FRAC_PI_3;
    let largest = mean + 2.0 * p * angle.cos();
    let smallest = mean + 2.0 * p * (angle + turn).cos();
    [smallest, 3.0 * mean - largest - smallest, largest]
}

/// The unit eigenvector of a simple eigenvalue: what is across the rows of A − λ I. Zero where the
/// eigenvalue is not simple.
pub(crate) fn eigenvector([xx, yy, zz, xy, xz, yz]: Symmetric, value: f64) -> Vec3 {
    let rows = [
        [xx - value, xy, xz],
        [xy, yy - value, yz],
        [xz, yz, zz - value],
    ];
    let candidates = [
        cross(rows[0], rows[1]),
        cross(rows[0], rows[2]),
        cross(rows[1], rows[2]),
    ];
    let longest = candidates
        .into_iter()
        .max_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b)));
    unit(longest.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn eigenpairs_solve_the_matrix(m in prop::array::uniform6(-10.0f64..10.0)) {
            let [xx, yy, zz, xy, xz, yz] = m;
            let values = eigenvalues(m);
            prop_assert!(values[0] <= values[1] + 1e-9 && values[1] <= values[2] + 1e-9);
            for (k, other) in [(0, 1), (2, 1)] {
                prop_assume!((values[k] - values[other]).abs() > 1e-3);
                let v = eigenvector(m, values[k]);
                let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
                for i in 0..3 {
                    prop_assert!((dot(rows[i], v) - values[k] * v[i]).abs() < 1e-6);
                }
            }
        }
    }
}
