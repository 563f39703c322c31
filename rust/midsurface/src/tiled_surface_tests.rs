//! Components that are small enough to be worked on as a whole, in small tiles.

use super::*;
use crate::bricks::Batch;
use crate::components;
use crate::contour::contour;
use crate::distance;
use crate::exchange::Alone;
use crate::execution::Quiet;
use crate::ridge_surface::{find_sheets, ridge_surface};
use crate::runs::Run;
use crate::statistics::{statistics, Statistics, TriangleMesh};

/// Chance, −0.5 to 0.5, at a voxel.
fn noise(p: [usize; 3]) -> f64 {
    let hash = p.iter().fold(0u64, |hash, &v| {
        (hash ^ v as u64)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(29)
    });
    (hash >> 40) as f64 / (1 << 24) as f64 - 0.5
}

/// The parts of the largest component of a made-up label: where a point's distance from the mid-surface
/// is below half the thickness, 2.5, with rough faces.
fn parts(dimensions: [usize; 3], distance: impl Fn([f64; 3]) -> f64) -> Vec<Part> {
    let [nx, ny, nz] = dimensions;
    let mut runs = Vec::new();
    for (z, y) in (0..nz).flat_map(|z| (0..ny).map(move |y| (z, y))) {
        let is_in = |&x: &usize| {
            let place = [x, y, z];
            distance(place.map(|v| v as f64)) < 2.5 + 0.8 * noise(place)
        };
        let mut x = 0;
        while let Some(start) = (x..nx).find(is_in) {
            let end = (start..nx).find(|x| !is_in(x)).unwrap_or(nx);
            runs.push(Run {
                label: 1,
                z: z as u32,
                y: y as u32,
                start: start as u32,
                end: end as u32,
            });
            x = end;
        }
    }
    let mut quiet = Quiet::default();
    let mut execution = Execution::new(2, &mut quiet).unwrap();
    let (mut parts, _) = components::parts(runs, &mut execution).unwrap();
    parts.retain(|part| part.component == 0);
    parts
}

fn tiled(parts: &[Part], grid: &Grid, side: usize, threads: usize) -> Mesh {
    let mut quiet = Quiet::default();
    let mut execution = Execution::new(threads, &mut quiet).unwrap();
    let mut alone = Alone;
    let team = &mut Team::new(&mut alone);
    let mesh = tiled_surface(parts, grid, (0.0, side), team, &mut execution).unwrap();
    let mesh = mesh.expect("tiles that fit together");
    mesh.check_invariants().unwrap();
    mesh
}

fn whole(parts: &[Part], grid: &Grid) -> Mesh {
    let mut quiet = Quiet::default();
    let mut execution = Execution::new(2, &mut quiet).unwrap();
    ridge_surface(parts, grid, 0.0, &mut execution).unwrap()
}

fn figures(mesh: &Mesh) -> Statistics {
    let points: Vec<Vec3> = mesh.points.iter().map(|p| p.map(f64::from)).collect();
    let triangles = mesh.triangles.iter().map(|t| t.map(i64::from));
    let triangles: Vec<[i64; 3]> = triangles.collect();
    let mesh = TriangleMesh {
        points: &points,
        triangles: &triangles,
        ..TriangleMesh::default()
    };
    statistics(&mesh).unwrap().remove(0)
}

/// Root of the mean square of the points' distances from where they should be.
fn off(mesh: &Mesh, distance: impl Fn([f64; 3]) -> f64) -> f64 {
    let squares = mesh
        .points
        .iter()
        .map(|p| distance(p.map(f64::from)).powi(2));
    (squares.sum::<f64>() / mesh.points.len() as f64).sqrt()
}

fn sphere(p: [f64; 3]) -> f64 {
    let r = p.iter().map(|v| (v - 55.3).powi(2)).sum::<f64>().sqrt();
    (r - 44.0).abs()
}

/// A sheet that leans and waves, and leaves the volume.
fn wave([x, y, z]: [f64; 3]) -> f64 {
    let off = z - 24.0 - 0.03 * x - 5.0 * (x / 17.0).sin() * (y / 23.0).cos();
    off.abs() / (1.0 + 0.07 + 0.05f64).sqrt()
}

/// The gyroid, about as far from it as it says.
fn gyroid(p: [f64; 3]) -> f64 {
    let wave = 2.0 * std::f64::consts::PI / 90.0;
    let [x, y, z] = p.map(|v| wave * (v + 13.0));
    let value = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
    (value / (1.5 * wave)).abs()
}

#[test]
fn a_sphere_in_tiles_is_closed() {
    let grid = Grid::new([112; 3]);
    let parts = parts(grid.dimensions, sphere);
    let mesh = tiled(&parts, &grid, 64, 2);
    let found = figures(&mesh);
    assert_eq!((found.euler_number, found.boundary_loops), (2, 0));
    let whole = whole(&parts, &grid);
    let (own, of_whole) = (off(&mesh, sphere), off(&whole, sphere));
    assert!(own < 1.02 * of_whole, "{own} not {of_whole}");
    // Its normals point outward, as those of the whole do.
    for (p, n) in mesh.points.iter().zip(&mesh.normals) {
        let out: f32 = (0..3).map(|a| (p[a] - 55.3) * n[a]).sum();
        assert!(out > 30.0, "{p:?} {n:?}");
    }
}

#[test]
fn a_sheet_in_tiles_ends_at_the_border_of_the_volume_only() {
    let grid = Grid::new([330, 200, 60]);
    let parts = parts(grid.dimensions, wave);
    let mesh = tiled(&parts, &grid, 128, 2);
    let found = figures(&mesh);
    assert_eq!((found.euler_number, found.boundary_loops), (1, 1));
    let whole = whole(&parts, &grid);
    let (own, of_whole) = (off(&mesh, wave), off(&whole, wave));
    assert!(own < 1.02 * of_whole, "{own} not {of_whole}");
    let area = |mesh: &Mesh| figures(mesh).quality.area;
    let (own, of_whole) = (area(&mesh), area(&whole));
    assert!((own / of_whole - 1.0).abs() < 1e-3, "{own} not {of_whole}");
    let (own, of_whole) = (mesh.triangles.len(), whole.triangles.len());
    assert!(
        own.abs_diff(of_whole) < of_whole / 25,
        "{own} not {of_whole}"
    );
}

#[test]
fn a_gyroid_in_tiles_has_the_handles_of_the_whole() {
    let grid = Grid::new([130, 130, 100]);
    let parts = parts(grid.dimensions, gyroid);
    let (mesh, whole) = (tiled(&parts, &grid, 64, 2), whole(&parts, &grid));
    let (own, of_whole) = (figures(&mesh), figures(&whole));
    assert_eq!(own.euler_number, of_whole.euler_number);
    assert_eq!(own.boundary_loops, of_whole.boundary_loops);
    let (own, of_whole) = (off(&mesh, gyroid), off(&whole, gyroid));
    assert!(own < 1.02 * of_whole, "{own} not {of_whole}");
}

#[test]
fn threads_and_long_voxels_make_no_difference() {
    let grid = Grid {
        spacing: [4.0, 4.0, 7.0],
        ..Grid::new([200, 150, 50])
    };
    let parts = parts(grid.dimensions, wave);
    let mesh = tiled(&parts, &grid, 96, 1);
    assert_eq!(figures(&mesh).boundary_loops, 1);
    assert_eq!(mesh, tiled(&parts, &grid, 96, 3));
}

#[test]
fn a_mobius_band_in_tiles_is_cut_once() {
    // A band around a circle that turns over once.
    let band = |[x, y, z]: [f64; 3]| {
        let (x, y, z) = (x - 70.0, y - 70.0, z - 25.0);
        let half = 0.5 * y.atan2(x);
        let out = x.hypot(y) - 50.0;
        let (across, along) = (
            z * half.cos() - out * half.sin(),
            z * half.sin() + out * half.cos(),
        );
        across.abs() + (along.abs() - 12.0).max(0.0) * 10.0
    };
    let grid = Grid::new([140, 140, 50]);
    let parts = parts(grid.dimensions, band);
    let found = figures(&tiled(&parts, &grid, 64, 2));
    // Cut once it is a disk.
    assert_eq!((found.euler_number, found.boundary_loops), (1, 1));
}

#[test]
fn contours_of_tiles_are_those_of_the_whole_to_the_bit() {
    let grid = Grid::new([330, 200, 60]);
    let parts = parts(grid.dimensions, wave);
    let mut quiet = Quiet::default();
    let execution = &mut Execution::new(2, &mut quiet).unwrap();
    let mut alone = Alone;
    let team = Team::new(&mut alone);
    let component = Component::new(&parts, &grid, (0.0, 128), &team, execution).unwrap();
    let corners = |surface: &Surface, t: &[u32; 3]| {
        let mut corners = t.map(|p| surface.points[p as usize].map(f64::to_bits));
        corners.sort_unstable();
        corners
    };
    let stages = &component.stages;
    let mut found = Vec::new();
    for tile in &component.tiles {
        let (surface, _) = stages.contour(&tile.near, 1.0, execution).unwrap();
        let own = chosen(&surface, component.is_in(tile)).unwrap();
        found.extend(own.triangles.iter().map(|t| corners(&own, t)));
    }
    let batch = &Batch::new(&parts, grid.dimensions).unwrap();
    let distance = distance::distance(batch, stages.h, execution).unwrap();
    let sheets = find_sheets(batch, &distance, stages.h, execution).unwrap();
    let surface = contour(batch, &sheets, stages.h, execution).unwrap();
    let triangles = surface.triangles.iter();
    let mut expected: Vec<_> = triangles.map(|t| corners(&surface, t)).collect();
    found.sort_unstable();
    expected.sort_unstable();
    assert!(found == expected, "{} {}", found.len(), expected.len());
}
