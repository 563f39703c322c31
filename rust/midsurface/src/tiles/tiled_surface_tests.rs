//! Components that are small enough to be worked on as a whole, in small tiles.

use super::*;
use crate::contour::contour;
use crate::execution::Quiet;
use crate::fields::bricks::Batch;
use crate::fields::distance;
use crate::fields::label::Label;
use crate::fields::mask::Mask;
use crate::lots::Sizes;
use crate::mesh::Mesh;
use crate::processes::exchange::{Alone, Exchange};
use crate::processes::{extract_piece_in, MeshPiece};
use crate::reading::read_parts;
use crate::reading::volume::Volume;
use crate::ridge_surface::{find_sheets, ridge_surface};
use crate::statistics::{statistics, Statistics, TriangleMesh};
use crate::{extract, Options};
use channels::connect;

#[path = "../../tests/extraction/channels.rs"]
mod channels;

/// Chance, −0.5 to 0.5, at a voxel.
fn noise(p: [usize; 3]) -> f64 {
    let hash = p.iter().fold(0u64, |hash, &v| {
        (hash ^ v as u64)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(29)
    });
    (hash >> 40) as f64 / (1 << 24) as f64 - 0.5
}

/// A made-up label: where a point's distance from the mid-surface is below half the thickness, 2.5, with
/// rough faces.
fn labels([nx, ny, nz]: [usize; 3], distance: impl Fn([f64; 3]) -> f64) -> Vec<u8> {
    let mut labels = Vec::new();
    for (z, y) in (0..nz).flat_map(|z| (0..ny).map(move |y| (z, y))) {
        labels.extend((0..nx).map(|x| {
            let place = [x, y, z];
            u8::from(distance(place.map(|v| v as f64)) < 2.5 + 0.8 * noise(place))
        }));
    }
    labels
}

/// The parts of the largest component of such a label.
fn parts(grid: &Grid, distance: impl Fn([f64; 3]) -> f64) -> Vec<Part> {
    let labels = labels(grid.dimensions, distance);
    let volume = Volume::new(&labels, grid.clone()).unwrap();
    let mut quiet = Quiet::default();
    let mut execution = Execution::new(2, &mut quiet).unwrap();
    let mut parts = read_parts(&volume, &Options::default(), &mut execution, 1.0).unwrap();
    parts.retain(|part| part.component == 0);
    parts
}

fn tiled(parts: &[Part], grid: &Grid, side: usize, threads: usize) -> Mesh {
    let mut quiet = Quiet::default();
    let mut execution = Execution::new(threads, &mut quiet).unwrap();
    let mut alone = Alone;
    let team = &mut Team::new(&mut alone);
    let tiled = tiled_surface(parts, grid, (0.0, side), team, &mut execution).unwrap();
    let mesh = tiled.expect("tiles that fit together").mesh;
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

/// Asserts that a mesh is as near to where it should be as the whole's: in the mean square, but for the
/// farthest hundredth, which a few points at rims decide, and at its farthest point. The points of two
/// meshes lie in different places, and each goes its own way a little (`midway`).
fn is_as_near(mesh: &Mesh, whole: &Mesh, distance: impl Fn([f64; 3]) -> f64) {
    const OWN_WAY: f64 = 0.02;
    let figures = |mesh: &Mesh| {
        let points = mesh.points.iter();
        let mut off: Vec<f64> = points.map(|p| distance(p.map(f64::from))).collect();
        off.sort_unstable_by(f64::total_cmp);
        let most = &off[..off.len() - off.len() / 100];
        let square = most.iter().map(|v| v * v).sum::<f64>() / most.len() as f64;
        [square.sqrt(), off[off.len() - 1]]
    };
    let ([own, farthest], [of_whole, farthest_of_whole]) = (figures(mesh), figures(whole));
    assert!(own < 1.02 * of_whole, "{own} not {of_whole}");
    assert!(
        farthest < farthest_of_whole + OWN_WAY,
        "{farthest} not {farthest_of_whole}"
    );
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
    let parts = parts(&grid, sphere);
    let mesh = tiled(&parts, &grid, 64, 2);
    let found = figures(&mesh);
    assert_eq!((found.euler_number, found.boundary_loops), (2, 0));
    let whole = whole(&parts, &grid);
    is_as_near(&mesh, &whole, sphere);
    // Its normals point outward, as those of the whole do.
    for (p, n) in mesh.points.iter().zip(&mesh.normals) {
        let out: f32 = (0..3).map(|a| (p[a] - 55.3) * n[a]).sum();
        assert!(out > 30.0, "{p:?} {n:?}");
    }
}

#[test]
fn a_sheet_in_tiles_ends_at_the_border_of_the_volume_only() {
    let grid = Grid::new([330, 200, 60]);
    let parts = parts(&grid, wave);
    let mesh = tiled(&parts, &grid, 128, 2);
    let found = figures(&mesh);
    assert_eq!((found.euler_number, found.boundary_loops), (1, 1));
    let whole = whole(&parts, &grid);
    is_as_near(&mesh, &whole, wave);
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
    let parts = parts(&grid, gyroid);
    let (mesh, whole) = (tiled(&parts, &grid, 64, 2), whole(&parts, &grid));
    let (own, of_whole) = (figures(&mesh), figures(&whole));
    assert_eq!(own.euler_number, of_whole.euler_number);
    assert_eq!(own.boundary_loops, of_whole.boundary_loops);
    is_as_near(&mesh, &whole, gyroid);
}

#[test]
fn threads_and_long_voxels_make_no_difference() {
    let grid = Grid {
        spacing: [4.0, 4.0, 7.0],
        ..Grid::new([200, 150, 50])
    };
    let parts = parts(&grid, wave);
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
    let parts = parts(&grid, band);
    let found = figures(&tiled(&parts, &grid, 64, 2));
    // Cut once it is a disk.
    assert_eq!((found.euler_number, found.boundary_loops), (1, 1));
}

#[test]
fn contours_of_tiles_are_those_of_the_whole_to_the_bit() {
    let grid = Grid::new([330, 200, 60]);
    let parts = parts(&grid, wave);
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
        let own = chosen(&surface, component.is_in(tile), execution).unwrap();
        found.extend(own.triangles.iter().map(|t| corners(&own, t)));
    }
    let batch = &Batch::new(&parts, grid.dimensions).unwrap();
    let distance = distance::distance(batch, stages.h, execution).unwrap();
    let label = Label {
        batch,
        distance: &distance,
        mask: &Mask::new(batch, &distance, execution).unwrap(),
        h: stages.h,
    };
    let sheets = find_sheets(&label, execution).unwrap();
    let surface = contour(batch, &sheets, stages.h, execution).unwrap();
    let triangles = surface.triangles.iter();
    let mut expected: Vec<_> = triangles.map(|t| corners(&surface, t)).collect();
    found.sort_unstable();
    expected.sort_unstable();
    assert!(found == expected, "{} {}", found.len(), expected.len());
}

/// What each of several processes makes of a slab of a volume whose components are all worked on in tiles.
fn in_processes(labels: &[u8], whole: &Grid, edge_length: f64, processes: usize) -> Vec<MeshPiece> {
    let all = told_in_processes(labels, whole, edge_length, processes);
    all.into_iter().map(|(piece, _)| piece).collect()
}

/// The same, each with its warnings.
fn told_in_processes(
    labels: &[u8],
    whole: &Grid,
    edge_length: f64,
    processes: usize,
) -> Vec<(MeshPiece, Vec<String>)> {
    let [nx, ny, nz] = whole.dimensions;
    let work = |mut end: channels::Channels| {
        let [from, to] = [end.process, end.process + 1].map(|p| nz * p / processes);
        let grid = Grid {
            dimensions: [nx, ny, to - from],
            extent_start: [0, 0, from as i64],
            ..whole.clone()
        };
        let volume = Volume::new(&labels[nx * ny * from..nx * ny * to], grid).unwrap();
        let sizes = Sizes {
            most_voxels: 1000,
            side: 48,
        };
        let options = Options {
            threads: 1,
            edge_length,
            ..Options::default()
        };
        let mut quiet = Quiet::default();
        let size = (&options, sizes);
        let piece = extract_piece_in(Some(&volume), whole, size, &mut end, &mut quiet);
        (piece.unwrap(), quiet.warnings)
    };
    std::thread::scope(|scope| {
        let start = |end| scope.spawn(move || work(end));
        let threads: Vec<_> = connect(processes).into_iter().map(start).collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    })
}

/// The meshes of all processes as one, by the numbers of their points.
fn merged(pieces: &[MeshPiece]) -> Mesh {
    let mut points = std::collections::BTreeMap::new();
    let mut mesh = Mesh::default();
    for piece in pieces {
        assert_eq!(piece.first_triangle as usize, mesh.triangles.len());
        let own = &piece.mesh;
        for (p, id) in piece.point_ids.iter().enumerate() {
            let point = (own.points[p], own.normals[p], own.thickness[p]);
            assert_eq!(*points.entry(*id).or_insert(point), point, "point {id}");
        }
        let number = |p: u32| piece.point_ids[p as usize] as u32;
        mesh.triangles
            .extend(own.triangles.iter().map(|t| t.map(number)));
        mesh.labels.extend(&own.labels);
        mesh.components.extend(&own.components);
    }
    assert!(points.keys().copied().eq(0..points.len() as i64));
    for (point, normal, thickness) in points.into_values() {
        mesh.points.push(point);
        mesh.normals.push(normal);
        mesh.thickness.push(thickness);
    }
    mesh
}

/// The corners of a mesh's triangles with all there is to tell of them, in an order of their own.
fn triangles(mesh: &Mesh) -> Vec<Vec<u32>> {
    let corner = |p: u32| {
        let (p, thickness) = (p as usize, mesh.thickness[p as usize]);
        let floats = mesh.points[p].into_iter().chain(mesh.normals[p]);
        floats.chain([thickness]).map(f32::to_bits)
    };
    let of = |t: usize| {
        let corners = mesh.triangles[t].into_iter().flat_map(corner);
        corners.chain([mesh.components[t]]).collect()
    };
    let mut all: Vec<Vec<u32>> = (0..mesh.triangles.len()).map(of).collect();
    all.sort_unstable();
    all
}

#[test]
fn any_number_of_processes_gives_the_mesh_of_one() {
    let whole = Grid {
        spacing: [2.0, 2.0, 3.0],
        ..Grid::new([104, 112, 40])
    };
    // A gyroid, and a sphere beside it.
    let sphere = |p: [f64; 3]| {
        let r = p
            .iter()
            .zip([18.0, 92.0, 20.0])
            .map(|(v, c)| (v - c).powi(2));
        (r.sum::<f64>().sqrt() - 14.0).abs()
    };
    let labels = labels(whole.dimensions, |[x, y, z]| match x < 40.0 && y > 68.0 {
        true => sphere([x, y, z]),
        false => gyroid([x, y, z]),
    });
    let alone = in_processes(&labels, &whole, 0.0, 1);
    let expected = merged(&alone);
    assert_eq!(expected, alone[0].mesh);
    expected.check_invariants().unwrap();
    assert!(expected.components.contains(&1));
    for processes in [2, 3, 4, 7] {
        let pieces = in_processes(&labels, &whole, 0.0, processes);
        let busy = pieces
            .iter()
            .filter(|piece| !piece.mesh.triangles.is_empty());
        assert!(busy.count() > 1);
        let mesh = merged(&pieces);
        mesh.check_invariants().unwrap();
        assert_eq!(mesh.points.len(), expected.points.len());
        assert!(triangles(&mesh) == triangles(&expected), "{processes}");
    }
}

#[test]
fn what_does_not_fit_into_tiles_one_process_works_on_whole() {
    let whole = Grid::new([60, 60, 40]);
    let labels = labels(whole.dimensions, |[x, y, z]| {
        (((x - 30.0).powi(2) + (y - 30.0).powi(2) + (z - 20.0).powi(2)).sqrt() - 14.0).abs()
    });
    // Longer than a tile's margin would have room for.
    let edge_length = 3.0;
    let options = Options {
        edge_length,
        ..Options::default()
    };
    let volume = Volume::new(&labels, whole.clone()).unwrap();
    let expected = extract(&volume, &options, &mut Quiet::default()).unwrap();
    let pieces = in_processes(&labels, &whole, edge_length, 2);
    assert!(pieces[1].mesh.triangles.is_empty());
    assert_eq!(merged(&pieces), expected);
}

#[test]
fn a_component_without_a_surface_is_told_of_once() {
    let whole = Grid::new([40; 3]);
    // A ball.
    let labels = labels(whole.dimensions, |p| {
        p.iter().map(|v| (v - 20.0).powi(2)).sum::<f64>().sqrt() - 6.0
    });
    for processes in [1, 2] {
        let found = told_in_processes(&labels, &whole, 0.0, processes);
        assert!(found.iter().all(|(p, _)| p.mesh.triangles.is_empty()));
        let warnings: Vec<String> = found.into_iter().flat_map(|(_, w)| w).collect();
        assert!(
            warnings.len() == 1 && warnings[0].contains("1 of its separate pieces"),
            "{warnings:?}"
        );
    }
}
