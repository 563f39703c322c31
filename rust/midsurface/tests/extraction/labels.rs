//! Each label by itself, whatever the scalars' type, and how components are numbered.

use std::collections::BTreeMap;

use midsurface::{extract, find_labels, Grid, Label, Mesh, Method, Options, Quiet, Volume};
use phantoms::*;

use crate::measure::{assert_matches, assert_sound, complete_within, extract_all, grid, mesh_of};

/// Upright sheets across x and z of a volume: label, first row and height in slices of each.
fn sheets(dimensions: [usize; 3], sheets: &[(i64, usize, usize)]) -> Vec<i64> {
    let [nx, ny, nz] = dimensions;
    let mut labels = vec![0; nx * ny * nz];
    for &(label, first, height) in sheets {
        for z in 0..height {
            for y in first..first + 4 {
                labels[(z * ny + y) * nx..][..nx].fill(label);
            }
        }
    }
    labels
}

/// The triangles' corners of one label, in order.
fn corners(mesh: &Mesh, label: i64) -> Vec<[[f32; 3]; 3]> {
    let chosen = (0..mesh.triangles.len()).filter(|&i| mesh.labels[i] == label);
    chosen
        .map(|i| mesh.triangles[i].map(|p| mesh.points[p as usize]))
        .collect()
}

#[test]
fn touching_labels_do_not_mix() {
    for tilt in [0.0, 25.0] {
        let phantom = two_sheets(Frame::new([40; 3]), leaning(tilt, 33.0), 4.0, 0.0, [1, 2]);
        assert_matches(&phantom, complete_within(0.1));
        let mesh = mesh_of(&phantom);
        let mut label_of_point = vec![None; mesh.points.len()];
        for (triangle, label) in mesh.triangles.iter().zip(&mesh.labels) {
            for &p in triangle {
                let known = label_of_point[p as usize].get_or_insert(*label);
                assert_eq!(known, label, "a point of two labels");
                let (_, slab) = phantom.closest(mesh.points[p as usize].map(f64::from));
                assert_eq!(
                    i64::from(slab.label),
                    *label,
                    "a triangle on the other label's sheet"
                );
            }
        }
    }
}

#[test]
fn a_label_gives_the_same_surface_alone_and_beside_another() {
    let dimensions = [40, 40, 12];
    let labels = mitochondrion([64, 64, 32], 0.02, 3);
    let (both, _) = extract_all(&labels, Grid::new([64, 64, 32]));
    for label in [OUTER, INNER] {
        let alone: Vec<u8> = labels
            .iter()
            .map(|&l| if l == label { l } else { 0 })
            .collect();
        let (alone, _) = extract_all(&alone, Grid::new([64, 64, 32]));
        assert_eq!(corners(&alone, label.into()), corners(&both, label.into()));
    }
    let labels = sheets(dimensions, &[(1, 4, 12), (7, 8, 12), (3, 24, 12)]);
    let volume = Volume::new(&labels, Grid::new(dimensions)).expect("a sound volume");
    let options = Options {
        method: Method::PolylineZipper,
        ..Options::default()
    };
    let all = extract(&volume, &options, &mut Quiet::default()).expect("a mesh");
    let options = Options {
        labels: Some(vec![7]),
        ..options
    };
    let chosen = extract(&volume, &options, &mut Quiet::default()).expect("a mesh");
    assert_sound(&chosen);
    assert!(!chosen.triangles.is_empty());
    assert!(chosen.labels.iter().all(|&l| l == 7));
    assert_eq!(corners(&chosen, 7), corners(&all, 7));
}

#[test]
fn components_are_numbered_by_label_then_by_size() {
    let dimensions = [30, 60, 20];
    let list = [
        (5, 2, 8),
        (2, 12, 9),
        (5, 22, 20),
        (2, 32, 18),
        (-3, 42, 12),
        (5, 52, 14),
    ];
    let (mesh, warnings) = extract_all(&sheets(dimensions, &list), Grid::new(dimensions));
    assert_eq!(warnings, [""; 0]);
    let mut rows: BTreeMap<u32, (i64, usize)> = BTreeMap::new();
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        let row = mesh.points[triangle[0] as usize][1].round() as usize / 10 * 10 + 2;
        let known = rows
            .entry(mesh.components[i])
            .or_insert((mesh.labels[i], row));
        assert_eq!(*known, (mesh.labels[i], row), "a component in two sheets");
    }
    let expected = [(-3, 42), (2, 32), (2, 12), (5, 22), (5, 52), (5, 2)];
    assert_eq!(rows, (0..).zip(expected).collect());
}

#[test]
fn labels_are_found_in_order() {
    let dimensions = [30, 60, 4];
    let labels = sheets(
        dimensions,
        &[(200, 2, 4), (-7, 12, 4), (1 << 40, 22, 4), (3, 32, 1)],
    );
    let volume = Volume::new(&labels, Grid::new(dimensions)).expect("a sound volume");
    let found = find_labels(&volume, &Options::default(), &mut Quiet::default());
    assert_eq!(found, Ok(vec![-7, 3, 200, 1 << 40]));
}

#[test]
fn a_single_large_label_is_extracted() {
    let dimensions = [30, 20, 6];
    for label in [200, 255, -1, 70_000, i64::MIN, i64::MAX] {
        let (mesh, _) = extract_all(&sheets(dimensions, &[(label, 6, 6)]), Grid::new(dimensions));
        assert!(!mesh.triangles.is_empty());
        assert!(mesh.labels.iter().all(|&l| l == label));
    }
}

#[test]
fn every_scalar_type_gives_the_same_mesh() {
    let phantom = two_sheets(
        Frame::new([24, 24, 10]),
        leaning(15.0, 33.0),
        4.0,
        1.5,
        [1, 100],
    );
    let expected = mesh_of(&phantom);
    assert!(!expected.triangles.is_empty());
    fn check<T: Label>(phantom: &Phantom, expected: &Mesh, convert: impl Fn(u8) -> T) {
        let labels: Vec<T> = phantom.labels.iter().map(|&l| convert(l)).collect();
        let (mesh, _) = extract_all(&labels, grid(&phantom.frame));
        assert_eq!(mesh, *expected, "{}", std::any::type_name::<T>());
    }
    check(&phantom, &expected, |l| l as i8);
    check(&phantom, &expected, i16::from);
    check(&phantom, &expected, u16::from);
    check(&phantom, &expected, i32::from);
    check(&phantom, &expected, u32::from);
    check(&phantom, &expected, i64::from);
    check(&phantom, &expected, u64::from);
    check(&phantom, &expected, f32::from);
    check(&phantom, &expected, f64::from);
}

/// The mesh of a map's voxels at or above a threshold.
fn above<T: Label>(map: &[T], dimensions: [usize; 3], threshold: f64) -> Mesh {
    let volume = Volume::new(map, Grid::new(dimensions)).expect("usable");
    let volume = volume.with_threshold(threshold).expect("a number");
    let options = Options {
        method: Method::PolylineZipper,
        ..Options::default()
    };
    extract(&volume, &options, &mut Quiet::default()).expect("a mesh")
}

#[test]
fn what_reaches_a_threshold_is_label_1() {
    let dimensions = [24, 20, 12];
    let labels = sheets(dimensions, &[(1, 6, 10)]);
    let expected = extract_all(&labels, Grid::new(dimensions)).0;
    assert!(!expected.triangles.is_empty());
    // Values differ from voxel to voxel on both sides of the threshold, and some are no numbers.
    let value = |i: usize, l: i64| match (l, i % 3) {
        (1, r) => 0.3 + 0.2 * r as f64,
        (_, 0) => f64::NAN,
        (_, r) => 0.29 - r as f64,
    };
    let doubles: Vec<f64> = labels
        .iter()
        .enumerate()
        .map(|(i, &l)| value(i, l))
        .collect();
    assert_eq!(above(&doubles, dimensions, 0.3), expected);
    let singles: Vec<f32> = doubles.iter().map(|&v| v as f32).collect();
    assert_eq!(above(&singles, dimensions, 0.2999), expected);
    let bytes: Vec<u8> = doubles.iter().map(|&v| (100.0 * v) as u8).collect();
    assert_eq!(above(&bytes, dimensions, 29.5), expected);
    assert_eq!(above(&bytes, dimensions, 256.0), Mesh::default());
}
