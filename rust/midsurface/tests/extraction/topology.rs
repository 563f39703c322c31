//! What hangs together, what stays apart, and where the surface ends.

use std::collections::BTreeSet;

use midsurface::{mid_polylines, Options, Quiet, Volume};
use phantoms::*;

use crate::measure::{
    assert_all_match, assert_matches, complete_within, extract_all, grid, mesh_of, report_of,
};

/// The slices that a phantom's lines lie in, and the number of lines that are not closed.
fn slices_and_open_lines(phantom: &Phantom) -> (BTreeSet<i64>, usize) {
    let volume = Volume::new(&phantom.labels, grid(&phantom.frame)).expect("a sound volume");
    let lines = mid_polylines(&volume, &Options::default(), &mut Quiet::default());
    let lines = lines.expect("polylines").lines;
    let open = lines.iter().filter(|line| !line.closed).count();
    (lines.iter().map(|line| line.slice).collect(), open)
}

#[test]
fn every_slice_has_lines_and_loops_are_closed() {
    for thickness in [2.0, 4.0, 8.0] {
        let mut frame = Frame::new([48, 48, 9]);
        frame.extent_start = [3, -7, -4];
        let (slices, open) = slices_and_open_lines(&tube(frame, 16.0, thickness));
        assert_eq!(slices, (-4..5).collect());
        assert_eq!(open, 0);
    }
}

#[test]
fn sheets_reach_all_slices() {
    for tilt in [0.0, 30.0, 45.0] {
        let (slices, _) = slices_and_open_lines(&sheet(
            Frame::new([64, 64, 12]),
            leaning(tilt, 20.0),
            4.0,
            &[],
        ));
        assert_eq!(slices, (0..12).collect(), "{tilt} degrees");
    }
}

/// Asserts that the mesh spans the volume along an axis.
fn assert_spans(phantom: &Phantom, axis: usize) {
    let mesh = mesh_of(phantom);
    let along = || mesh.points.iter().map(|p| f64::from(p[axis]));
    let (first, last) = (
        along().fold(f64::MAX, f64::min),
        along().fold(f64::MIN, f64::max),
    );
    let end = phantom.frame.dimensions[axis] as f64 - 1.0;
    assert!(
        first.abs() < 0.01 && (last - end).abs() < 0.01,
        "from {first} to {last} of {end}"
    );
}

#[test]
fn the_surface_runs_on_to_the_border() {
    assert_spans(&tube(Frame::new([48, 48, 10]), 16.0, 4.0), 2);
    for axis in [0, 2] {
        assert_spans(
            &sheet(Frame::new([40, 48, 10]), [0.0, 1.0, 0.0], 4.0, &[]),
            axis,
        );
        assert_spans(
            &sheet(Frame::new([40, 60, 24]), leaning(30.0, 70.0), 4.0, &[]),
            axis,
        );
    }
}

#[test]
fn two_holes_are_two_loops_more() {
    let frame = Frame::new([40, 80, 40]);
    let middle = frame.middle();
    let hole = |y: f64| Hole {
        centre: [middle[0], middle[1] + y, middle[2]],
        radius: 8.0,
    };
    assert_matches(
        &sheet(frame, leaning(20.0, 5.0), 4.0, &[hole(-18.0), hole(18.0)]),
        complete_within(0.1),
    );
}

#[test]
fn sheets_close_together_stay_apart() {
    let places = [(0.0, 0.0), (0.0, 45.0), (20.0, 0.0), (20.0, 45.0)];
    let sheets = places.into_iter().flat_map(|(tilt, azimuth)| {
        [1.0, 2.0].map(|voxels| {
            let normal = leaning(tilt, azimuth);
            // As wide as it takes for so many voxels to fit in everywhere along an axis.
            let gap = voxels * normal.iter().map(|v| v.abs()).fold(0.0, f64::max);
            // An odd size: no face runs through voxel centres.
            let name = format!("{tilt} degrees, azimuth {azimuth}, {voxels} voxels apart");
            (
                name,
                two_sheets(Frame::new([41; 3]), normal, 4.0, gap, [1, 1]),
            )
        })
    });
    assert_all_match(sheets, complete_within(0.2));
}

#[test]
fn membranes_that_are_nowhere_flat_come_without_a_warning() {
    let cube = || Frame::new([64; 3]);
    let upright = || {
        sheet(
            cube(),
            leaning(0.0, 33.0),
            6.0,
            &[hole_in_the_middle(&cube(), 12.0)],
        )
    };
    let phantoms = [
        ("tube", tube(Frame::new([64, 64, 16]), 25.0, 6.0)),
        (
            "tube with noise",
            tube(Frame::new([64, 64, 16]), 25.0, 6.0).with_noise(0.05, 7),
        ),
        ("upright sheet", upright()),
        (
            "leaning sheet, 3 thick",
            sheet(cube(), leaning(30.0, 33.0), 3.0, &[]),
        ),
        (
            "leaning sheet, 6 thick",
            sheet(cube(), leaning(30.0, 33.0), 6.0, &[]),
        ),
        (
            "leaning sheet with noise",
            sheet(cube(), leaning(40.0, 33.0), 6.0, &[]).with_noise(0.05, 1),
        ),
        (
            "upright disk",
            disk(
                cube(),
                leaning(0.0, 33.0),
                22.0,
                0.0,
                Thickness::Constant(4.0),
            ),
        ),
    ];
    let warned: Vec<String> = phantoms
        .iter()
        .map(|(name, phantom)| (name, extract_all(&phantom.labels, grid(&phantom.frame)).1))
        .filter(|(_, warnings)| !warnings.is_empty())
        .map(|(name, warnings)| format!("{name}: {warnings:?}"))
        .collect();
    assert!(warned.is_empty(), "{}", warned.join("\n"));
}

/// A 3 thick sheet and, well apart from it in the same volume, a ball of the same label.
#[test]
fn a_thick_blob_does_not_blur_a_thin_sheet() {
    let frame = Frame::new([72, 48, 48]);
    let plane = |x: f64| Shape::Plane {
        centre: [x, 24.0, 24.0],
        normal: leaning(10.0, 8.0),
        rim: Rim::None,
        holes: vec![Hole {
            centre: [x, 24.0, 24.0],
            radius: 7.0,
        }],
    };
    let slab = |shape, thickness| Slab {
        shape,
        thickness: Thickness::Constant(thickness),
        label: 1,
    };
    let expected = Some(Topology {
        components: 1,
        euler: 0,
        boundary_loops: 2,
    });
    let alone = Phantom::new(
        "sheet",
        frame.clone(),
        vec![slab(plane(14.0), 3.0)],
        expected,
    );
    let ball = Shape::Sphere {
        centre: [50.0, 24.0, 24.0],
        radius: 0.5,
    };
    let both = vec![slab(plane(14.0), 3.0), slab(ball, 36.0)];
    let both = Phantom::new("sheet and blob", frame, both, None);

    let near_sheet = |p: &[f32; 3]| p[0] < 28.0;
    let mesh = mesh_of(&alone);
    let (beside, _) = extract_all(&both.labels, grid(&both.frame));
    let of_the_sheet: Vec<_> = beside.points.iter().copied().filter(near_sheet).collect();
    assert_eq!(of_the_sheet.len(), mesh.points.len());
    let same = of_the_sheet.iter().all(|p| mesh.points.contains(p));
    assert!(same, "the sheet differs where a blob is in the volume");
}

#[test]
fn branches_are_traced() {
    for tilt in [0.0, 5.0, 20.0] {
        let report = report_of(&junction(Frame::new([56; 3]), leaning(tilt, 33.0), 4.0));
        assert!(report.covered_within_1 >= 0.98, "{tilt} degrees: {report}");
        assert!(report.rms <= 0.2, "{tilt} degrees: {report}");
    }
}

#[test]
fn caps_are_left_out_and_reported() {
    let phantom = sphere(Frame::new([48; 3]), 16.0, 4.0);
    let (mesh, warnings) = extract_all(&phantom.labels, grid(&phantom.frame));
    let report = judge(&mesh.points, &mesh.triangles, &phantom);
    assert!(
        report.rms <= 0.15 && report.covered_within_1 >= 0.9,
        "{report}"
    );
    assert_eq!(report.connectivity.topology.components, 1, "{report}");
    assert!(
        warnings.iter().any(|w| w.contains("flat in the slices")),
        "{warnings:?}"
    );
}

#[test]
fn the_mitochondrion_is_two_membranes() {
    let dimensions = [128, 96, 32];
    let labels = mitochondrion(dimensions, 0.02, 5);
    let (mesh, _) = extract_all(&labels, midsurface::Grid::new(dimensions));
    for label in [OUTER, INNER] {
        let triangles = mesh
            .labels
            .iter()
            .filter(|&&l| l == i64::from(label))
            .count();
        assert!(triangles > 3000, "{triangles} triangles of label {label}");
    }
    let quality = mesh.quality().unwrap();
    assert!(
        quality.mean > 0.8 && quality.mean_smallest_angle > 42.0,
        "{quality:?}"
    );
}
