//! Eigenvalues and eigenvectors of symmetric 3 × 3 matrices, without a branch, so that loops over
//! voxels run side by side. For the same end nothing here takes an array's `map`, which is not always
//! inlined.

use num_traits::Float;

/// A symmetric matrix as xx, yy, zz, xy, xz, yz.
pub(crate) type Symmetric<T> = [T; 6];

/// f32 or f64.
pub(crate) trait Real: Float + From<f32> {}
impl<T: Float + From<f32>> Real for T {}

/// The eigenvalues in ascending order (Smith 1961): with p the standard deviation of the spectrum
/// times √½ and t the roots of t³ − 3 t = 2 r, they are mean + p t.
#[inline(always)]
pub(crate) fn eigenvalues<T: Real>([xx, yy, zz, xy, xz, yz]: Symmetric<T>) -> [T; 3] {
    let number = |v: f32| <T as From<f32>>::from(v);
    let mean = (xx + yy + zz) / number(3.0);
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let off_diagonal = xy * xy + xz * xz + yz * yz;
    let p = ((a * a + b * b + c * c + number(2.0) * off_diagonal) / number(6.0)).sqrt();
    let scale = larger(p, T::min_positive_value()).recip();
    let [a, b, c] = [a * scale, b * scale, c * scale];
    let [xy, xz, yz] = [xy * scale, xz * scale, yz * scale];
    let determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    let r = number(0.5) * determinant;
    let (smallest, largest) = (-largest_root(-r), largest_root(r));
    let middle = -(smallest + largest);
    [mean + p * smallest, mean + p * middle, mean + p * largest]
}

/// The largest root of t³ − 3 t = 2 r, which is 2 cos(acos(r) / 3), for r from −1 to 1.
#[inline(always)]
fn largest_root<T: Real>(r: T) -> T {
    let number = |v: f32| <T as From<f32>>::from(v);
    // With u = cos(acos(r) / 2) and t = 1 + u q the equation is q² (3 + u q) = 4, which is sound at
    // double roots (u = 0) too. The parabola below is right to 3 digits, and each step of Newton's
    // method doubles them.
    let u = larger(number(0.5) * (number(1.0) + r), T::zero()).sqrt();
    let mut q = number(1.1547) + u * (number(0.0436) * u - number(0.1983));
    for _ in 0..2 {
        let residual = q * q * (number(3.0) + u * q) - number(4.0);
        q = q - residual / (number(3.0) * q * (number(2.0) + u * q));
    }
    T::one() + u * q
}

/// The unit eigenvector of a simple eigenvalue: what is across the rows of A − λ I. Zero, or any,
/// where the eigenvalue is not simple.
#[inline(always)]
pub(crate) fn eigenvector<T: Real>([xx, yy, zz, xy, xz, yz]: Symmetric<T>, value: T) -> [T; 3] {
    let rows = [
        [xx - value, xy, xz],
        [xy, yy - value, yz],
        [xz, yz, zz - value],
    ];
    let mut longest = cross(rows[0], rows[1]);
    for other in [cross(rows[0], rows[2]), cross(rows[1], rows[2])] {
        let is_longer = dot(other, other) > dot(longest, longest);
        let longer = |k: usize| if is_longer { other[k] } else { longest[k] };
        longest = [longer(0), longer(1), longer(2)];
    }
    let squared = dot(longest, longest);
    let length = larger(squared, T::min_positive_value()).sqrt();
    [
        longest[0] / length,
        longest[1] / length,
        longest[2] / length,
    ]
}

#[inline(always)]
fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The larger of two numbers; `Float::max` would ask whether either is no number.
#[inline(always)]
fn larger<T: Real>(a: T, b: T) -> T {
    if a > b {
        a
    } else {
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check<T: Real>(m: [f64; 6], tolerance: f64) -> std::result::Result<(), TestCaseError> {
        let of = |v: T| v.to_f64().unwrap_or(f64::NAN);
        let own = m.map(|v| num_traits::cast(v).unwrap_or_else(T::nan));
        let [xx, yy, zz, xy, xz, yz] = own.map(of);
        let values = eigenvalues(own);
        let [low, middle, high] = values.map(of);
        prop_assert!(low <= middle + tolerance && middle <= high + tolerance);
        for (value, gap) in [(0, middle - low), (2, high - middle)] {
            if gap > 1e-3 {
                let v = eigenvector(own, values[value]).map(of);
                let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
                for i in 0..3 {
                    let image = dot(rows[i], v);
                    prop_assert!(
                        (image - of(values[value]) * v[i]).abs() < tolerance / gap.min(1.0)
                    );
                }
            }
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn eigenpairs_solve_the_matrix(m in prop::array::uniform6(-10.0f64..10.0)) {
            check::<f64>(m, 1e-9)?;
            check::<f32>(m, 1e-3)?;
        }

        #[test]
        fn nearly_equal_eigenvalues_are_told_apart_from_the_third(
            v in prop::array::uniform3(-1.0f64..1.0),
            small in 0.0f64..1e-6,
            sign in prop::bool::ANY,
        ) {
            let scale = if sign { 1.0 } else { -1.0 };
            let entry = |a: usize, b: usize| scale * v[a] * v[b];
            let m = [entry(0, 0) + small, entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)];
            check::<f64>(m, 1e-7)?;
            check::<f32>(m, 1e-4)?;
        }
    }
}
