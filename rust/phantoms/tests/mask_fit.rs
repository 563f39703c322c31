//! How a mesh lies within a mask, on masks where that is known.

use phantoms::*;

/// A plane at height z over the volume's x and y, triangles of two voxels.
fn flat_mesh(n: u32, z: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let points = (0..n * n)
        .map(|i| [2.0 * (i % n) as f32, 2.0 * (i / n) as f32, z])
        .collect();
    let mut triangles = Vec::new();
    for j in 0..n - 1 {
        for i in 0..n - 1 {
            let [a, b] = [i + n * j, i + n * (j + 1)];
            triangles.extend([[a, a + 1, b], [b, a + 1, b + 1]]);
        }
    }
    (points, triangles)
}

/// A slab of eight slices, z = 12 to 19: its faces lie at 11.5 and 19.5.
fn slab_fit(n: u32, z: f32) -> MaskFit {
    let frame = Frame::new([41, 41, 32]);
    let labelled: Vec<bool> = (0..41 * 41 * 32)
        .map(|i| (12..20).contains(&(i / 41 / 41)))
        .collect();
    let (points, triangles) = flat_mesh(n, z);
    mask_fit(&points, &triangles, &labelled, &frame)
}

#[test]
fn the_middle_of_a_slab_is_centred_and_covers_it() {
    let fit = slab_fit(21, 15.5);
    assert!(fit.off_centre_mean < 0.051, "{fit:?}");
    assert_eq!((fit.inside, fit.excess, fit.covered), (1.0, 0.0, 1.0));
}

#[test]
fn a_mesh_off_the_middle_is_measured() {
    let fit = slab_fit(21, 17.0);
    assert!((fit.off_centre_mean - 1.5).abs() < 0.051, "{fit:?}");
    assert!((fit.off_centre_95 - 1.5).abs() < 0.051, "{fit:?}");
    assert_eq!((fit.inside, fit.excess), (1.0, 0.0));
}

#[test]
fn what_lies_outside_is_excess() {
    let fit = slab_fit(21, 20.2);
    assert_eq!((fit.inside, fit.excess), (0.0, 0.0));
    let fit = slab_fit(21, 21.0);
    assert_eq!((fit.inside, fit.excess), (0.0, 1.0));
}

#[test]
fn half_a_mesh_covers_half_and_its_reach() {
    // The mesh ends at x = y = 20; the slab is at most 4 deep.
    let fit = slab_fit(11, 15.5);
    let least = 21.0f64.powi(2) / 41.0f64.powi(2);
    let most = 26.0f64.powi(2) / 41.0f64.powi(2);
    assert!(fit.covered > least && fit.covered < most, "{fit:?}");
}

#[test]
fn lengths_are_in_voxels_of_any_size() {
    let frame = Frame::with_spacing([41, 41, 16], [3.0, 3.0, 6.0]);
    let labelled: Vec<bool> = (0..41 * 41 * 16)
        .map(|i| (6..10).contains(&(i / 41 / 41)))
        .collect();
    let (points, triangles) = flat_mesh(21, 15.0);
    // Faces at 5.5 and 9.5 slices of 2 voxels: 11 and 19 voxels; the mesh is at 16.
    let points: Vec<[f32; 3]> = points
        .iter()
        .map(|p| [3.0 * p[0], 3.0 * p[1], 48.0])
        .collect();
    let fit = mask_fit(&points, &triangles, &labelled, &frame);
    assert!((fit.off_centre_mean - 1.0).abs() < 0.051, "{fit:?}");
    assert_eq!((fit.inside, fit.covered), (1.0, 1.0));
}
