//! Extracts the mid-surface of a phantom and asserts what holds for every mesh.

use midsurface::{extract, Grid, Label, Mesh, Method, Options, Quiet, Volume};
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

/// The polyline zipper's mid-surface of all labels, and the warnings.
pub fn extract_all<T: Label>(labels: &[T], grid: Grid) -> (Mesh, Vec<String>) {
    let volume = Volume::new(labels, grid).expect("a sound volume");
    let mut observer = Quiet::default();
    let options = Options {
        method: Method::PolylineZipper,
        ..Options::default()
    };
    let mesh = extract(&volume, &options, &mut observer).expect("a mesh");
    assert_sound(&mesh);
    (mesh, observer.warnings)
}

/// The mid-surface of a phantom.
pub fn mesh_of(phantom: &Phantom) -> Mesh {
    extract_all(&phantom.labels, grid(&phantom.frame)).0
}

/// The judge's report on the mid-surface of a phantom.
pub fn report_of(phantom: &Phantom) -> Report {
    let mesh = mesh_of(phantom);
    let report = judge(&mesh.points, &mesh.triangles, phantom);
    assert!(report.is_clean(), "{report}");
    report
}

/// How far from the truth a mesh may be. Lengths in voxels.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Largest root mean square distance.
    pub rms: f64,
    /// Least share of the truth within 1 voxel of the mesh.
    pub covered: f64,
}

/// All of the truth is there, and as near as this.
pub const fn complete_within(rms: f64) -> Limits {
    Limits { rms, covered: 1.0 }
}

/// Asserts the topology of every phantom, exactly, that no mesh runs into itself, and the limits.
/// Tells about all that fail, by the names given.
pub fn assert_all_match(phantoms: impl IntoIterator<Item = (String, Phantom)>, limits: Limits) {
    let failures: Vec<String> = phantoms
        .into_iter()
        .filter_map(|(name, phantom)| {
            let report = report_of(&phantom);
            let matches = Some(report.connectivity.topology) == phantom.topology
                && report.self_intersections == 0
                && report.rms <= limits.rms
                && report.covered_within_1 >= limits.covered;
            (!matches).then(|| format!("{name}: {report}"))
        })
        .collect();
    assert!(
        failures.is_empty(),
        "{limits:?} was asked for\n{}",
        failures.join("\n")
    );
}

/// [`assert_all_match`] for a single phantom.
pub fn assert_matches(phantom: &Phantom, limits: Limits) {
    assert_all_match([(phantom.name.clone(), phantom.clone())], limits);
}
