//! Extracts the mid-surface of a phantom and asserts what holds for every mesh.

use midsurface::{extract, Grid, Label, Mesh, Options, Quiet, Volume};
use phantoms::{connectivity, judge, Frame, Phantom, Report};

/// The phantom's frame as the core knows it.
pub fn grid(frame: &Frame) -> Grid {
    Grid {
        dimensions: frame.dimensions,
        extent_start: frame.extent_start,
        spacing: frame.spacing,
        origin: frame.origin,
        direction: frame.direction,
    }
}

/// Asserts what holds for every mesh; counted by the core and, independently, by the judge.
pub fn assert_sound(mesh: &Mesh) {
    assert_eq!(mesh.check_invariants(), Ok(()));
    let counted = connectivity(mesh.points.len(), &mesh.triangles);
    let faults = [
        counted.nonmanifold_edges,
        counted.pinched_vertices,
        counted.misoriented_edges,
        counted.duplicate_triangles,
        counted.unused_points,
    ];
    assert_eq!(faults, [0; 5], "{counted:?}");
    for normal in &mesh.normals {
        let length = normal.iter().map(|v| v * v).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-4, "a normal of length {length}");
    }
}

/// The mid-surface of all labels, and the warnings.
pub fn extract_all<T: Label>(labels: &[T], grid: Grid) -> (Mesh, Vec<String>) {
    let volume = Volume::new(labels, grid).expect("a sound volume");
    let mut observer = Quiet::default();
    let mesh = extract(&volume, &Options::default(), &mut observer).expect("a mesh");
    assert_sound(&mesh);
    (mesh, observer.warnings)
}

/// The mid-surface of a phantom, which must come without a warning.
pub fn mesh_of(phantom: &Phantom) -> Mesh {
    let (mesh, warnings) = extract_all(&phantom.labels, grid(&phantom.frame));
    assert_eq!(warnings, [""; 0], "{}", phantom.name);
    mesh
}

/// The judge's report on the mid-surface of a phantom.
pub fn report_of(phantom: &Phantom) -> Report {
    let mesh = mesh_of(phantom);
    let report = judge(&mesh.points, &mesh.triangles, phantom);
    assert!(report.is_clean(), "{report}");
    report
}

/// Asserts the phantom's topology, and accuracy in voxels.
pub fn assert_matches(phantom: &Phantom, most_rms: f64) {
    let report = report_of(phantom);
    let told = format!("{} {:?}: {report}", phantom.name, phantom.slabs[0]);
    assert_eq!(
        Some(report.connectivity.topology),
        phantom.topology,
        "{told}"
    );
    assert!(report.rms <= most_rms, "{told}");
    assert_eq!(report.covered_within_1, 1.0, "{told}");
}
