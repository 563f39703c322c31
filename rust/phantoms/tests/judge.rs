//! The judge itself on trial: right on meshes known to be right, and blind to none of the faults.

use phantoms::*;

/// A grid of quads over u × v, each split in two; closed in u where `wrap`.
fn patch(
    (nu, nv): (u32, u32),
    wrap: bool,
    at: impl Fn(f64, f64) -> Vec3,
) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut points = Vec::new();
    let columns = if wrap { nu } else { nu + 1 };
    for j in 0..=nv {
        for i in 0..columns {
            let p = at(f64::from(i) / f64::from(nu), f64::from(j) / f64::from(nv));
            points.push(p.map(|v| v as f32));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..nv {
        for i in 0..nu {
            let corner = |di, dj| (i + di) % columns + (j + dj) * columns;
            let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (points, triangles)
}

fn cylinder(radius: f64) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    patch((160, 30), true, |u, v| {
        let (s, c) = (u * std::f64::consts::TAU).sin_cos();
        [30.0 + radius * c, 30.0 + radius * s, 29.0 * v]
    })
}

fn tube_phantom() -> Phantom {
    tube(Frame::new([61, 61, 30]), 20.0, 4.0)
}

#[test]
fn a_perfect_tube_is_found_perfect() {
    let (points, triangles) = cylinder(20.0);
    let report = judge(&points, &triangles, &tube_phantom());
    assert!(report.is_clean(), "{report}");
    assert!(report.rms < 0.005, "{report}");
    assert!(report.max_error < 0.01, "{report}");
    assert_eq!(report.covered_within_1, 1.0);
    assert_eq!(Some(report.connectivity.topology), tube_phantom().topology);
}

#[test]
fn a_tube_too_wide_is_measured() {
    let (points, triangles) = cylinder(20.5);
    let report = judge(&points, &triangles, &tube_phantom());
    assert!((report.rms - 0.5).abs() < 0.01, "{report}");
    assert!((report.mean_signed - 0.5).abs() < 0.01, "{report}");
    assert_eq!(report.covered_within_1, 1.0);
    let (points, triangles) = cylinder(18.0);
    let report = judge(&points, &triangles, &tube_phantom());
    assert!((report.mean_signed + 2.0).abs() < 0.01, "{report}");
    assert_eq!(report.covered_within_1, 0.0);
}

#[test]
fn half_a_tube_covers_half() {
    let (points, triangles) = cylinder(20.0);
    let half = &triangles[..triangles.len() / 2];
    let report = judge(&points, half, &tube_phantom());
    let rows_and_reach = (15.0 + 1.0) / 30.0;
    assert!(
        (report.covered_within_1 - rows_and_reach).abs() < 0.03,
        "{report}"
    );
    assert_eq!(report.connectivity.unused_points, 160 * 15);
}

#[test]
fn lengths_are_in_voxels() {
    let frame = Frame::with_spacing([61, 61, 30], [1e-3; 3]);
    let phantom = tube(frame, 20e-3, 4e-3);
    let (points, triangles) = cylinder(20.5);
    let scaled: Vec<[f32; 3]> = points.iter().map(|p| p.map(|v| v * 1e-3)).collect();
    let report = judge(&scaled, &triangles, &phantom);
    assert!((report.rms - 0.5).abs() < 0.01, "{report}");
    assert!(report.is_clean());
}

#[test]
fn each_fault_is_seen() {
    let (points, good) = cylinder(20.0);
    let phantom = tube_phantom();
    let check = |triangles: &[[u32; 3]]| judge(&points, triangles, &phantom);

    let mut flipped = good.clone();
    flipped[2000].swap(0, 1);
    assert_eq!(check(&flipped).connectivity.misoriented_edges, 3);

    let mut twice = good.clone();
    twice.push(good[7]);
    assert_eq!(check(&twice).connectivity.duplicate_triangles, 1);
    assert!(check(&twice).connectivity.nonmanifold_edges > 0);

    let mut sliver = good.clone();
    sliver.push([0, 0, 1]);
    assert_eq!(check(&sliver).degenerate, 1);

    // Two triangles that meet in a vertex only.
    let pinched = [[0, 1, 160], [0, 159, 2000]];
    assert_eq!(check(&pinched).connectivity.pinched_vertices, 1);
    assert_eq!(check(&pinched).connectivity.topology.boundary_loops, 1);

    let mut holed = good.clone();
    holed.remove(2000);
    let topology = check(&holed).connectivity.topology;
    assert_eq!((topology.euler, topology.boundary_loops), (-1, 3));
}

#[test]
fn an_empty_mesh_covers_nothing() {
    let report = judge(&[], &[], &tube_phantom());
    assert_eq!(report.covered_within_1, 0.0);
    assert!(report.rms.is_nan());
}

#[test]
fn distance_to_a_triangle_is_exact() {
    let t = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
    for (p, expected) in [
        ([1.0, 1.0, -2.0], 2.0),
        ([2.0, -3.0, 0.0], 3.0),
        ([-3.0, -4.0, 0.0], 5.0),
        ([3.8, 3.9, 0.0], 3.0),
        ([7.0, 0.0, 4.0], 5.0),
    ] {
        let distance = distance_to_triangle(p, &t);
        assert!((distance - expected).abs() < 1e-12, "{p:?}: {distance}");
    }
}
