//! Spacing, origin, extent, direction and units: the mesh lies where the voxels lie.

use midsurface::{extract, Grid, Mesh, Method, Options, Quiet, Volume};
use phantoms::*;

use crate::measure::{assert_all_match, complete_within, extract_all, grid, mesh_of, Limits};

/// A rotation about an axis that is none of the image's.
fn rotation(degrees: f64) -> [Vec3; 3] {
    let (s, c) = degrees.to_radians().sin_cos();
    let [x, y, z] = [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0];
    let t = 1.0 - c;
    [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
    ]
}

/// Asserts that `mesh` is `original` with its points moved by `place`, to 1e-5 of its extent.
fn assert_moved(original: &Mesh, mesh: &Mesh, scale: f64, place: impl Fn(Vec3) -> Vec3) {
    assert!(!mesh.triangles.is_empty());
    assert_eq!(mesh.triangles, original.triangles);
    assert_eq!(mesh.components, original.components);
    for (p, q) in original.points.iter().zip(&mesh.points) {
        let expected = place(p.map(f64::from));
        for (expected, found) in expected.iter().zip(q) {
            // f32 keeps 24 bits: far from the origin that, and not the work, is the limit.
            let slack = 1e-5 * 64.0 * scale + 2e-7 * expected.abs();
            assert!(
                (expected - f64::from(*found)).abs() <= slack,
                "{expected} {found}"
            );
        }
    }
    for (a, b) in original.thickness.iter().zip(&mesh.thickness) {
        let expected = f64::from(*a) * scale;
        assert!(
            (expected - f64::from(*b)).abs() <= 1e-5 * expected,
            "{expected} {b}"
        );
    }
}

fn noisy_sheet() -> Phantom {
    let frame = Frame::new([36, 40, 24]);
    let hole = hole_in_the_middle(&frame, 7.0);
    sheet(frame, leaning(25.0, 40.0), 5.0, &[hole]).with_noise(0.05, 3)
}

#[test]
fn other_units_give_the_same_mesh_scaled() {
    let phantoms = [noisy_sheet(), tube(Frame::new([48, 48, 10]), 17.0, 5.0)];
    for phantom in phantoms {
        let original = mesh_of(&phantom);
        for scale in [10.0, 0.1, 1e-9, 1e9, 12.44, 1.0 / 3.0, 7.3e-4] {
            let mut grid = grid(&phantom.frame);
            grid.spacing = [scale; 3];
            let (mesh, _) = extract_all(&phantom.labels, grid);
            assert_moved(&original, &mesh, scale, |p| p.map(|v| v * scale));
        }
    }
}

#[test]
fn other_units_of_anisotropic_voxels_give_the_same_mesh_scaled() {
    let spacing = [1.1, 0.7, 1.9];
    let frame = Frame::with_spacing([40, 60, 20], spacing);
    let phantom = sheet(frame, leaning(15.0, 60.0), 5.0, &[]);
    let original = mesh_of(&phantom);
    for scale in [10.0, 0.1, 1e-9, 1.0 / 3.0] {
        let mut grid = grid(&phantom.frame);
        grid.spacing = spacing.map(|s| s * scale);
        let (mesh, _) = extract_all(&phantom.labels, grid);
        assert_moved(&original, &mesh, scale, |p| p.map(|v| v * scale));
    }
}

#[test]
fn origin_and_direction_move_the_mesh() {
    let phantom = noisy_sheet();
    let original = mesh_of(&phantom);
    for degrees in [0.0, 30.0, 90.0, 200.0] {
        let (origin, direction) = ([-120.5, 33.25, 1000.0], rotation(degrees));
        let grid = Grid {
            origin,
            direction,
            ..grid(&phantom.frame)
        };
        let (mesh, _) = extract_all(&phantom.labels, grid);
        let turn = |p: Vec3| -> Vec3 {
            std::array::from_fn(|r| (0..3).map(|c| direction[r][c] * p[c]).sum())
        };
        assert_moved(&original, &mesh, 1.0, |p| {
            let turned = turn(p);
            std::array::from_fn(|a| origin[a] + turned[a])
        });
        for (a, b) in original.normals.iter().zip(&mesh.normals) {
            let turned = turn(a.map(f64::from));
            let cosine: f64 = (0..3).map(|k| turned[k] * f64::from(b[k])).sum();
            assert!(cosine > 1.0 - 1e-5, "normals {a:?} and {b:?}");
        }
    }
}

#[test]
fn the_extent_start_moves_the_mesh() {
    let phantom = noisy_sheet();
    let original = mesh_of(&phantom);
    // Even slices stay even: neighbouring slices are sampled half an edge apart.
    let extent_start = [5, -9, -106];
    let grid = Grid {
        extent_start,
        spacing: [2.0; 3],
        ..grid(&phantom.frame)
    };
    let (mesh, _) = extract_all(&phantom.labels, grid);
    assert_moved(&original, &mesh, 2.0, |p| {
        std::array::from_fn(|a| 2.0 * (p[a] + extent_start[a] as f64))
    });
}

#[test]
fn everything_at_once_is_still_accurate() {
    let sheets = [(0.0, 33.0), (25.0, 40.0), (40.0, 70.0)].map(|(tilt, azimuth)| {
        let mut frame = Frame::with_spacing([64; 3], [0.8; 3]);
        frame.extent_start = [11, -20, 7];
        frame.origin = [100.0, -40.0, 17.5];
        frame.direction = rotation(50.0);
        // Leaning is relative to the image's axes.
        let across = leaning(tilt, azimuth);
        let turned = |r: usize| (0..3).map(|c| frame.direction[r][c] * across[c]).sum();
        let normal = std::array::from_fn(turned);
        let hole = hole_in_the_middle(&frame, 9.6);
        (
            format!("{tilt} degrees, azimuth {azimuth}"),
            sheet(frame, normal, 4.8, &[hole]),
        )
    });
    assert_all_match(sheets, complete_within(0.1));
}

#[test]
fn anisotropic_voxels_are_accurate() {
    let spacings = [
        [1.0, 1.0, 2.0],
        [2.0, 1.0, 1.0],
        [1.0, 1.5, 1.0],
        [1.0, 1.0, 0.5],
    ];
    let sheets = spacings.into_iter().flat_map(|spacing| {
        [0.0, 20.0].map(|tilt| {
            let dimensions = spacing.map(|s: f64| (48.0 / s) as usize);
            let frame = Frame::with_spacing(dimensions, spacing);
            let phantom = sheet(frame, leaning(tilt, 33.0), 6.0, &[]);
            (
                format!("sheet {tilt} degrees, spacing {spacing:?}"),
                phantom,
            )
        })
    });
    let frame = Frame::with_spacing([64, 64, 12], [1.0, 1.0, 2.5]);
    let tube = ("tube".to_owned(), tube(frame, 25.0, 6.0));
    // In voxels of the finest spacing, of which the coarsest is up to 2.5.
    assert_all_match(
        sheets.chain([tube]),
        Limits {
            rms: 0.2,
            covered: 0.99,
        },
    );
}

/// From a few voxels' worth of rounding up to where no two points differ.
#[test]
fn far_from_the_origin_the_mesh_is_sound_and_a_warning_says_so() {
    let phantom = noisy_sheet();
    for far in [1e6, 3e6, 1e7, 3e7, 1e9, 1e15] {
        for method in [Method::RidgeSurface, Method::PolylineZipper] {
            let mut grid = grid(&phantom.frame);
            grid.origin = [far, -far, 0.3 * far];
            let volume = Volume::new(&phantom.labels, grid).expect("a sound volume");
            let options = Options {
                method,
                ..Options::default()
            };
            let mut observer = Quiet::default();
            let mesh = extract(&volume, &options, &mut observer).expect("a mesh");
            assert_eq!(mesh.check_invariants(), Ok(()), "{far} {method:?}");
            let is_told = |text: &String| text.contains("so far from the origin");
            assert!(observer.warnings.iter().any(is_told), "{far} {method:?}");
        }
    }
}

/// The pages of an array of zeros that nobody writes to take no memory.
#[test]
fn voxels_beyond_the_two_thousand_millionth_are_found_where_they_are() {
    let phantom = noisy_sheet();
    let [nx, ny, nz] = phantom.frame.dimensions;
    let dimensions = [2048, 2048, 544];
    let start = [1960, 1976, 512];
    let mut labels = vec![0u8; dimensions.iter().product()];
    for row in 0..ny * nz {
        let [y, z] = [row % ny, row / ny];
        let at = ((z + start[2]) * dimensions[1] + y + start[1]) * dimensions[0] + start[0];
        assert!(at > 1 << 31);
        labels[at..at + nx].copy_from_slice(&phantom.labels[row * nx..][..nx]);
    }
    let volume = Volume::new(&labels, Grid::new(dimensions)).expect("a sound volume");
    for method in [Method::RidgeSurface, Method::PolylineZipper] {
        let options = Options {
            method,
            ..Options::default()
        };
        let mesh = extract(&volume, &options, &mut Quiet::default()).expect("a mesh");
        assert_eq!(mesh.check_invariants(), Ok(()));
        assert!(mesh.triangles.len() > 500, "{}", mesh.triangles.len());
        for p in &mesh.points {
            for axis in 0..3 {
                let from_start = p[axis] - start[axis] as f32;
                let end = phantom.frame.dimensions[axis] as f32;
                assert!(from_start > -1.0 && from_start < end, "{p:?}");
            }
        }
    }
}
