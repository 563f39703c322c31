//! What is no segmentation gets an error or a warning that says so, never silence or a crash.

use midsurface::{extract, Error, Grid, Label, Mesh, Method, Options, Quiet, Result, Volume};

use crate::measure::extract_all;

fn run<T: Label>(
    labels: &[T],
    grid: Grid,
    wanted: Option<Vec<i64>>,
) -> Result<(Mesh, Vec<String>)> {
    let options = Options {
        method: Method::PolylineZipper,
        labels: wanted,
        ..Options::default()
    };
    let mut observer = Quiet::default();
    let mesh = extract(&Volume::new(labels, grid)?, &options, &mut observer)?;
    Ok((mesh, observer.warnings))
}

/// Asserts that there is no mesh, and a warning that holds `word`.
fn assert_empty_with_warning(labels: &[u8], dimensions: [usize; 3], word: &str) {
    let (mesh, warnings) = extract_all(labels, Grid::new(dimensions));
    assert_eq!(mesh, Mesh::default());
    assert!(warnings.iter().any(|w| w.contains(word)), "{warnings:?}");
}

/// A sheet 4 thick across x and z of a 20³ volume, with this label.
fn sheet<T: Copy + Default>(label: T) -> Vec<T> {
    let inside = |i: usize| (8..12).contains(&(i / 20 % 20));
    (0..8000)
        .map(|i| if inside(i) { label } else { T::default() })
        .collect()
}

#[test]
fn a_volume_without_a_label() {
    assert_empty_with_warning(&[0; 1000], [10; 3], "no label");
}

#[test]
fn a_volume_without_voxels() {
    for dimensions in [[0, 0, 0], [0, 5, 5], [5, 5, 0]] {
        assert_empty_with_warning(&[], dimensions, "no label");
    }
}

#[test]
fn all_voxels_labelled() {
    for label in [1, 200] {
        assert_empty_with_warning(&[label; 8000], [20; 3], "fills the whole volume");
    }
}

#[test]
fn one_slice() {
    let labels: Vec<u8> = sheet(1)[..400].to_vec();
    assert_empty_with_warning(&labels, [20, 20, 1], "two neighbouring slices");
}

#[test]
fn one_row_or_one_column() {
    for dimensions in [
        [400, 1, 1],
        [1, 400, 1],
        [1, 1, 400],
        [1, 20, 20],
        [20, 1, 20],
    ] {
        let labels: Vec<u8> = (0..400).map(|i| u8::from(i % 9 < 5)).collect();
        let (_, warnings) = extract_all(&labels, Grid::new(dimensions));
        let (all, all_warnings) = extract_all(&[1u8; 400], Grid::new(dimensions));
        assert!(
            all.triangles.is_empty() && !all_warnings.is_empty(),
            "{dimensions:?} {warnings:?}"
        );
    }
}

#[test]
fn only_specks() {
    let mut labels = vec![0; 8000];
    labels[421..424].fill(1);
    labels[4210] = 2;
    assert_empty_with_warning(&labels, [20; 3], "specks");
}

#[test]
fn a_buffer_of_another_length() {
    for length in [0, 1, 999, 1001] {
        let labels = vec![1u8; length];
        let found = Volume::new(&labels, Grid::new([10; 3])).map(|_| ());
        let expected = Error::BufferLength {
            dimensions: [10; 3],
            length,
        };
        assert_eq!(found, Err(expected));
    }
}

#[test]
fn dimensions_that_overflow() {
    let large = usize::MAX;
    for dimensions in [
        [large; 3],
        [large, 2, 1],
        [large / 2 + 1, 2, 1],
        [1 << 22, 1 << 21, 1 << 21],
    ] {
        let found = Volume::new(&[0u8; 8], Grid::new(dimensions)).map(|_| ());
        assert_eq!(found, Err(Error::Dimensions(dimensions)));
    }
}

#[test]
fn unusable_spacing() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for axis in 0..3 {
            let mut grid = Grid::new([20; 3]);
            grid.spacing[axis] = bad;
            let found = Volume::new(&sheet(1u8), grid).map(|_| ());
            assert!(matches!(found, Err(Error::Spacing(_))), "{bad}: {found:?}");
        }
    }
}

#[test]
fn spacing_beyond_all_proportion_ends() {
    // A wrong header multiplies the z spacing by the number of slices.
    for spacing in [
        [12.44, 12.44, 3881.28],
        [1.0, 1e6, 1.0],
        [1e-12, 1.0, 1.0],
        [1e300, 1.0, 1.0],
    ] {
        let grid = Grid {
            spacing,
            ..Grid::new([20; 3])
        };
        let clock = std::time::Instant::now();
        let _ = extract_all(&sheet(1u8), grid);
        assert!(
            clock.elapsed().as_secs() < 10,
            "{spacing:?}: {:?}",
            clock.elapsed()
        );
    }
}

#[test]
fn unusable_placement() {
    let mut grid = Grid::new([20; 3]);
    grid.origin[1] = f64::NAN;
    assert_eq!(
        run(&sheet(1u8), grid, None),
        Err(Error::Placement("origin"))
    );
    for direction in [[[0.0; 3]; 3], [[f64::NAN; 3]; 3], [[1.0, 0.0, 0.0]; 3]] {
        let grid = Grid {
            direction,
            ..Grid::new([20; 3])
        };
        assert_eq!(
            run(&sheet(1u8), grid, None),
            Err(Error::Placement("direction"))
        );
    }
}

#[test]
fn values_that_are_no_labels() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.5, -1.25] {
        let mut labels = sheet(1.0);
        labels[2 + 20 * (3 + 20 * 4)] = bad;
        let expected = Error::NotALabel {
            value: bad.to_string(),
            voxel: [2, 3, 4],
        };
        assert_eq!(
            run(&labels, Grid::new([20; 3]), None),
            Err(expected.clone())
        );
        assert!(expected.to_string().contains("whole numbers"));
        let narrow: Vec<f32> = labels.iter().map(|&l| l as f32).collect();
        let found = run(&narrow, Grid::new([20; 3]), None);
        assert!(
            matches!(
                found,
                Err(Error::NotALabel {
                    voxel: [2, 3, 4],
                    ..
                })
            ),
            "{found:?}"
        );
    }
}

#[test]
fn whole_numbers_that_are_too_large_for_a_label() {
    let large = [
        run(&sheet(u64::MAX), Grid::new([20; 3]), None),
        run(&sheet(i64::MAX as u64 + 1), Grid::new([20; 3]), None),
        run(&sheet(1e300), Grid::new([20; 3]), None),
        run(&sheet(-1e30f32), Grid::new([20; 3]), None),
    ];
    for found in large {
        let Err(error @ Error::LabelTooLarge { .. }) = found else {
            panic!("accepted");
        };
        assert!(error.to_string().contains("[0, 8, 0]"), "{error}");
    }
    for (label, found) in [
        (
            i64::MAX,
            run(&sheet(i64::MAX as u64), Grid::new([20; 3]), None),
        ),
        (
            1 << 53,
            run(&sheet((1u64 << 53) as f64), Grid::new([20; 3]), None),
        ),
    ] {
        assert_eq!(found.expect("a label").0.labels[0], label);
    }
}

#[test]
fn noise_is_refused_wherever_it_is_and_some_of_it_is_not() {
    let noise: Vec<u8> = (0..8000u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    for first in [0, 4000] {
        let mut labels = vec![0; 8000];
        labels[first..first + 4000].copy_from_slice(&noise[..4000]);
        let found = run(&labels, Grid::new([20; 3]), None);
        assert!(
            matches!(found, Err(Error::NotASegmentation { .. })),
            "{first}"
        );
    }
    // In the first slice only, and a sheet of its own label.
    let mut labels = sheet(255);
    labels[..160].copy_from_slice(&noise[..160]);
    let mesh = run(&labels, Grid::new([20; 3]), Some(vec![255]))
        .expect("a segmentation")
        .0;
    assert!(!mesh.triangles.is_empty());
}

#[test]
fn a_threshold_that_is_no_number() {
    let map = sheet(0.9);
    for threshold in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let volume = Volume::new(&map, Grid::new([20; 3])).expect("usable");
        let refusal = volume.with_threshold(threshold).expect_err("refused");
        assert!(matches!(refusal, Error::Threshold(_)), "{refusal}");
    }
}

#[test]
fn minus_zero_is_background() {
    let labels: Vec<f32> = sheet(1f32)
        .iter()
        .map(|&l| if l == 0.0 { -0.0 } else { l })
        .collect();
    let (mesh, _) = extract_all(&labels, Grid::new([20; 3]));
    assert_eq!(mesh, extract_all(&sheet(1u8), Grid::new([20; 3])).0);
}

#[test]
fn labels_that_are_not_there() {
    let found = run(&sheet(1u8), Grid::new([20; 3]), Some(vec![7, 9]));
    let Err(error @ Error::LabelsAbsent { .. }) = found else {
        panic!("{found:?}");
    };
    assert!(error.to_string().contains("7, 9"), "{error}");

    let found = run(&sheet(1u8), Grid::new([20; 3]), Some(vec![1, 7]));
    let (mesh, warnings) = found.expect("the mesh of label 1");
    assert!(!mesh.triangles.is_empty());
    assert!(
        warnings.len() == 1 && warnings[0].contains('7'),
        "{warnings:?}"
    );

    let found = run(&sheet(1u8), Grid::new([20; 3]), Some(vec![])).expect("an empty mesh");
    assert!(
        found.0.triangles.is_empty() && found.1.len() == 1,
        "{:?}",
        found.1
    );
}

#[test]
fn background_asked_for_as_a_label() {
    let found = run(&sheet(1u8), Grid::new([20; 3]), Some(vec![0]));
    assert!(
        matches!(found, Err(Error::LabelsAbsent { .. })),
        "{found:?}"
    );
}

#[test]
fn too_many_labels() {
    let count_labels = |count: usize| -> Vec<i32> {
        (0..64 * 64 * 8)
            .map(|i| (i / 16 % count) as i32 + 1)
            .collect()
    };
    let found = run(&count_labels(1025), Grid::new([64, 64, 8]), None);
    assert_eq!(found, Err(Error::TooManyLabels { limit: 1024 }));
    assert!(run(&count_labels(1024), Grid::new([64, 64, 8]), None).is_ok());
}

#[test]
fn a_raw_tomogram_of_8_bits() {
    // A linear congruential generator: noise around grey.
    let mut state = 1u32;
    let noise: Vec<u8> = (0..64 * 64 * 16)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    let found = run(&noise, Grid::new([64, 64, 16]), None);
    let Err(error @ Error::NotASegmentation { .. }) = found else {
        panic!(
            "{:?}",
            found.map(|(mesh, warnings)| (mesh.points.len(), warnings))
        );
    };
    assert!(error.to_string().contains("raw tomogram"), "{error}");
}

#[test]
fn an_edge_length_that_is_no_length() {
    let labels = sheet(1u8);
    let volume = Volume::new(&labels, Grid::new([20; 3])).expect("usable");
    for edge_length in [-1.0, f64::NAN, f64::INFINITY] {
        let options = Options {
            edge_length,
            ..Options::default()
        };
        let refusal = extract(&volume, &options, &mut Quiet::default()).unwrap_err();
        assert!(matches!(refusal, Error::EdgeLength(_)), "{refusal}");
    }
}
