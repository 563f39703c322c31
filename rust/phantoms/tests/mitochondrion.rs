//! The sample is what it claims to be, whatever its size.

use phantoms::{mitochondrion, write_mrc, write_vti, Frame, INNER, OUTER};

#[test]
fn both_membranes_run_through_every_slice_and_never_touch() {
    for dimensions in [[224, 128, 64], [96, 96, 40], [300, 90, 33]] {
        let labels = mitochondrion(dimensions, 0.0, 1);
        let [nx, ny, nz] = dimensions;
        for z in 0..nz {
            let slice = &labels[z * nx * ny..(z + 1) * nx * ny];
            for label in [OUTER, INNER] {
                let count = slice.iter().filter(|&&l| l == label).count();
                assert!(
                    count > nx,
                    "{dimensions:?} slice {z} label {label}: {count}"
                );
            }
        }
        let touching = |step: usize| {
            let pairs = labels.iter().zip(&labels[step..]);
            pairs
                .filter(|(&a, &b)| a != b && a * b == OUTER * INNER)
                .count()
        };
        assert_eq!([1, nx, nx * ny].map(touching), [0; 3], "{dimensions:?}");
    }
}

#[test]
fn the_smallest_and_odd_sizes_work() {
    for dimensions in [[32, 32, 32], [33, 200, 47]] {
        let labels = mitochondrion(dimensions, 0.1, 9);
        assert_eq!(labels.len(), dimensions.iter().product::<usize>());
        assert!(labels.contains(&OUTER));
    }
}

#[test]
fn a_seed_makes_one_mitochondrion() {
    let make = |seed| mitochondrion([96, 64, 32], 0.03, seed);
    assert_eq!(make(1), make(1));
    assert_ne!(make(1), make(2));
}

#[test]
fn files_hold_every_voxel() {
    let frame = Frame::with_spacing([4, 3, 2], [0.5, 1.0, 2.0]);
    let labels: Vec<u8> = (0..24).collect();

    let mut mrc = Vec::new();
    write_mrc(&mut mrc, &frame, &labels).unwrap();
    assert_eq!(mrc.len(), 1024 + 24);
    assert_eq!(&mrc[1024..], &labels);
    assert_eq!(&mrc[208..212], b"MAP ");
    assert_eq!(mrc[40..44], 2f32.to_le_bytes());

    let mut vti = Vec::new();
    write_vti(&mut vti, &frame, &labels).unwrap();
    let text = String::from_utf8(vti).unwrap();
    assert!(text.contains(r#"WholeExtent="0 3 0 2 0 1""#), "{text}");
    assert!(text.contains(r#"Spacing="0.5 1 2""#), "{text}");
    // The length, 24, as eight bytes, then 0, 1, 2 and so on.
    assert!(
        text.contains("\nGAAAAAAAAAAAAQIDBAUGBwgJCgsMDQ4PEBESExQVFhc=\n"),
        "{text}"
    );
}
