//! What has no mid-surface gives none, and says so.

use midsurface::{extract, Grid, Mesh, Options, Quiet, Volume};

fn run(labels: &[u8], dimensions: [usize; 3]) -> (Mesh, Vec<String>) {
    let volume = Volume::new(labels, Grid::new(dimensions)).expect("a sound volume");
    let mut observer = Quiet::default();
    let mesh = extract(&volume, &Options::default(), &mut observer).expect("a mesh");
    (mesh, observer.warnings)
}

/// A cube, which is no sheet, in a 24³ volume.
fn is_in_cube(i: usize) -> bool {
    [i % 24, i / 24 % 24, i / 24 / 24]
        .iter()
        .all(|v| (16..22).contains(v))
}

#[test]
fn pieces_without_a_surface_are_told_by_label() {
    let labels: Vec<u8> = (0..24 * 24 * 24)
        .map(|i| if is_in_cube(i) { 7 } else { 0 })
        .collect();
    let (mesh, warnings) = run(&labels, [24; 3]);
    assert_eq!(mesh, Mesh::default());
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].starts_with("Label 7: 1 of"), "{warnings:?}");
}

#[test]
fn a_piece_without_a_surface_is_told_beside_one_that_has_it() {
    let labels: Vec<u8> = (0..24 * 24 * 24)
        .map(|i| u8::from(is_in_cube(i) || (4..8).contains(&(i / 24 % 24))))
        .collect();
    let (mesh, warnings) = run(&labels, [24; 3]);
    assert!(!mesh.triangles.is_empty());
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].starts_with("Label 1: 1 of"), "{warnings:?}");
}

/// A bar of so many voxels along x, y, z.
fn bar([nx, ny, nz]: [usize; 3]) -> Vec<u8> {
    let inside = |i: usize| {
        (8..8 + nx).contains(&(i % 40))
            && (8..8 + ny).contains(&(i / 40 % 40))
            && (8..8 + nz).contains(&(i / 40 / 40))
    };
    (0..40 * 40 * 40).map(|i| u8::from(inside(i))).collect()
}

#[test]
fn a_ribbon_hardly_wider_than_thick_has_a_surface() {
    for size in [[20, 3, 2], [2, 20, 3], [4, 3, 20], [5, 20, 3], [20, 4, 6]] {
        let (mesh, warnings) = run(&bar(size), [40; 3]);
        assert!(!mesh.triangles.is_empty(), "{size:?}");
        assert!(warnings.is_empty(), "{size:?}: {warnings:?}");
    }
}

#[test]
fn a_single_slice_has_no_surface() {
    for dimensions in [[24, 24, 1], [24, 1, 24], [1, 24, 24]] {
        // 4 thick across the axis that is the slower one within the slice.
        let inside = |i: usize| (10..14).contains(&(i / 24));
        let labels: Vec<u8> = (0..24 * 24).map(|i| u8::from(inside(i))).collect();
        let (mesh, warnings) = run(&labels, dimensions);
        assert_eq!(mesh, Mesh::default());
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(warnings[0].contains("single slice"), "{warnings:?}");
    }
}
