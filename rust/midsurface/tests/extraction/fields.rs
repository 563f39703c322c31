//! Distance and ridge field as images.

use midsurface::{ridge_field, Options, Quiet, Volume};
use ndarray::Array3;
use phantoms::*;

use crate::measure::grid;

const UNTOUCHED: f32 = -7.0;

fn fields(phantom: &Phantom) -> (Array3<f32>, Array3<f32>) {
    let volume = Volume::new(&phantom.labels, grid(&phantom.frame)).expect("a sound volume");
    let [x, y, z] = phantom.frame.dimensions;
    let (mut distance, mut ridge) = (
        Array3::from_elem((z, y, x), UNTOUCHED),
        Array3::from_elem((z, y, x), UNTOUCHED),
    );
    let (d, r) = (distance.view_mut(), ridge.view_mut());
    ridge_field(&volume, &Options::default(), &mut Quiet::default(), d, r).expect("fields");
    (distance, ridge)
}

/// Distance to the nearest background voxel, world units, looked for among all of them.
fn true_distance(phantom: &Phantom, at: [usize; 3]) -> f64 {
    let frame = &phantom.frame;
    let [nx, ny, _] = frame.dimensions;
    let mut least = f64::INFINITY;
    for (i, _) in phantom.labels.iter().enumerate().filter(|(_, l)| **l == 0) {
        let other = [i % nx, i / nx % ny, i / (nx * ny)];
        let squared = (0..3).map(|a| (frame.spacing[a] * (at[a] as f64 - other[a] as f64)).powi(2));
        least = least.min(squared.sum::<f64>().sqrt());
    }
    least
}

#[test]
fn the_distance_is_exact() {
    for spacing in [[1.0; 3], [2.0, 0.9, 1.3], [13.0, 20.0, 13.0]] {
        let frame = Frame::with_spacing([17, 14, 12], spacing);
        let thickness = 5.0 * frame.unit();
        let phantom = sheet(frame, leaning(25.0, 35.0), thickness, &[]).with_noise(0.1, 4);
        let (distance, _) = fields(&phantom);
        for ((z, y, x), &found) in distance.indexed_iter() {
            if phantom.labels[x + 17 * (y + 14 * z)] == 0 {
                assert!(
                    found == UNTOUCHED || found == 0.0,
                    "{found} in the background"
                );
                continue;
            }
            let expected = true_distance(&phantom, [x, y, z]);
            // Specks that are left out have no distance.
            if found > 0.0 {
                let error = (f64::from(found) - expected).abs();
                assert!(
                    error <= 1e-5 * expected,
                    "{found} {expected} at {:?}",
                    [x, y, z]
                );
            }
        }
        let known = distance.iter().filter(|d| **d > 0.0).count();
        let labelled = phantom.labels.iter().filter(|l| **l > 0).count();
        assert!(
            known * 10 > labelled * 9,
            "{known} of {labelled} voxels have a distance"
        );
    }
}

#[test]
fn the_ridge_is_highest_in_the_middle() {
    // 5 voxels thick, middle at x = 12.
    let phantom = sheet(Frame::new([25, 16, 16]), [1.0, 0.0, 0.0], 5.4, &[]);
    let (_, ridge) = fields(&phantom);
    for z in 0..16 {
        for y in 0..16 {
            let highest = (0..25).max_by(|&a, &b| ridge[[z, y, a]].total_cmp(&ridge[[z, y, b]]));
            assert_eq!(highest, Some(12));
        }
    }
    assert!(ridge.iter().filter(|r| **r > 0.0).count() >= 5 * 16 * 16);
}

#[test]
fn fields_scale_with_the_units() {
    let phantom = tube(Frame::new([30, 30, 6]), 9.0, 5.0);
    let (distance, ridge) = fields(&phantom);
    let mut larger = phantom.clone();
    larger.frame.spacing = [12.5; 3];
    let (larger_distance, larger_ridge) = fields(&larger);
    for (small, large) in [(distance, larger_distance), (ridge, larger_ridge)] {
        for (a, b) in small.iter().zip(&large).filter(|(a, _)| **a > 0.0) {
            assert!((12.5 * a - b).abs() <= 1e-5 * b, "{a} {b}");
        }
    }
}

#[test]
fn voxels_far_from_labels_stay_as_they_are() {
    let mut labels = vec![0u8; 64 * 64 * 64];
    for (i, label) in labels.iter_mut().enumerate() {
        *label = u8::from(i % 64 < 4 && i / 64 % 64 < 12 && i / 4096 < 12);
    }
    let phantom = Phantom {
        labels,
        ..sphere(Frame::new([64; 3]), 1.0, 0.0)
    };
    let (distance, ridge) = fields(&phantom);
    let corner = |field: &Array3<f32>| field[[63, 63, 63]];
    assert_eq!((corner(&distance), corner(&ridge)), (UNTOUCHED, UNTOUCHED));
    assert!(distance[[5, 5, 2]] > 0.0);
}
