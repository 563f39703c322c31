//! The zipper's mesh in triangles of the size asked for: the same surface, in as many pieces, each
//! with its label.

use midsurface::{extract, Mesh, Method, Options, Quiet, Volume};
use phantoms::*;

use crate::measure::{assert_sound, grid};

/// Edge lengths, in voxels.
const LENGTHS: [f64; 6] = [0.7, 1.0, 2.0, 4.0, 9.0, 20.0];

fn zipped(phantom: &Phantom, edge_length: f64, threads: usize) -> Mesh {
    let volume = Volume::new(&phantom.labels, grid(&phantom.frame)).expect("a sound volume");
    let options = Options {
        method: Method::PolylineZipper,
        edge_length,
        threads,
        ..Options::default()
    };
    let mesh = extract(&volume, &options, &mut Quiet::default()).expect("a mesh");
    assert_sound(&mesh);
    mesh
}

fn phantoms() -> [Phantom; 3] {
    [upright_tube(3), leaning_sheet(2), leaning_sheet(5)]
}

#[test]
fn topology_and_place_stay() {
    for phantom in phantoms() {
        for length in LENGTHS {
            let mesh = zipped(&phantom, length, 0);
            let report = judge(&mesh.points, &mesh.triangles, &phantom);
            let told = format!("{} with edges of {length}: {report}", phantom.name);
            assert_eq!(
                Some(report.connectivity.topology),
                phantom.topology,
                "{told}"
            );
            assert_eq!(report.self_intersections, 0, "{told}");
            // A chord of the boundary may cut off a little more than of the surface.
            assert!(report.rms <= 0.15, "{told}");
            assert!(report.covered_within_1 >= 0.999, "{told}");
        }
    }
}

#[test]
fn edges_are_as_long_as_asked_for() {
    // Where the sheet is flat; near its rims edges are shorter.
    let sheet = sheet(Frame::new([64; 3]), leaning(20.0, 33.0), 6.0, &[]);
    for length in [0.7, 1.0, 2.0, 4.0] {
        let mesh = zipped(&sheet, length, 0);
        let report = judge(&mesh.points, &mesh.triangles, &sheet);
        let share = report.edge_mean / length;
        assert!((0.8..1.15).contains(&share), "{length}: {report}");
        // Of edges shorter than the lines' own come rows of equal, longer triangles.
        let least = if length < 1.4 { 0.85 } else { 0.93 };
        assert!(report.quality_mean >= least, "{length}: {report}");
    }
}

#[test]
fn labels_components_and_thickness_stay() {
    let frame = Frame::with_spacing([48, 48, 24], [0.5; 3]);
    let phantom = two_sheets(frame, leaning(15.0, 20.0), 2.0, 0.0, [1, 7]);
    let (plain, coarse) = (zipped(&phantom, 0.0, 0), zipped(&phantom, 2.0, 0));
    assert!(4 * coarse.triangles.len() < plain.triangles.len());
    let areas = |mesh: &Mesh| {
        [(1, 0), (7, 1)].map(|part| {
            let parts = mesh
                .labels
                .iter()
                .copied()
                .zip(mesh.components.iter().copied());
            let triangles = mesh
                .triangles
                .iter()
                .zip(parts)
                .filter(|(_, own)| *own == part);
            triangles.map(|(t, _)| area_of(mesh, t)).sum::<f64>()
        })
    };
    for (before, after) in areas(&plain).into_iter().zip(areas(&coarse)) {
        assert!(before > 0.0);
        assert!((after / before - 1.0).abs() < 0.02, "{before} {after}");
    }
    let thickness = |mesh: &Mesh| {
        let sum: f64 = mesh.thickness.iter().map(|&t| f64::from(t)).sum();
        sum / mesh.thickness.len() as f64
    };
    assert!((thickness(&plain) / thickness(&coarse) - 1.0).abs() < 0.05);
}

fn area_of(mesh: &Mesh, triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|p| mesh.points[p as usize].map(f64::from));
    let sides = [0, 1, 2].map(|k| (b[k] - a[k], c[k] - a[k]));
    let cross = |i: usize, j: usize| sides[i].0 * sides[j].1 - sides[j].0 * sides[i].1;
    0.5 * (cross(0, 1).powi(2) + cross(1, 2).powi(2) + cross(2, 0).powi(2)).sqrt()
}

#[test]
fn threads_do_not_matter() {
    let [tube, ..] = phantoms();
    let first = zipped(&tube, 2.5, 1);
    assert!(first == zipped(&tube, 2.5, 2));
    assert!(first == zipped(&tube, 2.5, 5));
}
