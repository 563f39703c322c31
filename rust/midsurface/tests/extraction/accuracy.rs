//! How near the mesh is to the true mid-surface, and whether it is all there. Lengths in voxels.

use phantoms::*;

use crate::measure::{assert_matches, report_of};

/// The largest root mean square distance from the truth.
const RMS: f64 = 0.1;

/// Positions within a voxel, evenly spread (the R3 sequence).
fn within_a_voxel(count: usize) -> impl Iterator<Item = Vec3> {
    const STEPS: Vec3 = [0.819_172_513, 0.671_043_607, 0.549_700_478];
    (1..=count).map(|i| STEPS.map(|s| (0.5 + i as f64 * s).fract() - 0.5))
}

fn tube_at(frame: Frame, offset: Vec3, radius: f64, thickness: f64) -> Phantom {
    let mut phantom = tube(frame.clone(), radius, thickness);
    let middle = frame.middle();
    let slab = Slab {
        shape: Shape::Tube {
            centre: std::array::from_fn(|a| middle[a] + offset[a]),
            axis: [0.0, 0.0, 1.0],
            radius,
        },
        ..phantom.slabs.remove(0)
    };
    Phantom::new("tube", frame, vec![slab], phantom.topology)
}

#[test]
fn tubes_through_both_faces_wherever_their_centre_is() {
    for offset in within_a_voxel(6) {
        assert_matches(&tube_at(Frame::new([64, 64, 24]), offset, 25.0, 6.0), RMS);
    }
}

#[test]
fn tubes_of_other_thickness() {
    for thickness in [2.0, 3.0, 4.5, 9.0] {
        for offset in within_a_voxel(2) {
            assert_matches(
                &tube_at(Frame::new([72, 72, 20]), offset, 25.0, thickness),
                RMS,
            );
        }
    }
}

#[test]
fn a_tight_tube() {
    for offset in within_a_voxel(3) {
        assert_matches(&tube_at(Frame::new([32, 32, 16]), offset, 9.0, 4.0), 0.15);
    }
}

fn sheet_with_a_hole(tilt: f64, azimuth: f64, thickness: f64) -> Phantom {
    let frame = Frame::new([56; 3]);
    let hole = hole_in_the_middle(&frame, 12.0);
    sheet(frame, leaning(tilt, azimuth), thickness, &[hole])
}

#[test]
fn upright_sheets_with_a_hole() {
    for thickness in [2.0, 3.0, 6.0] {
        for azimuth in [0.0, 17.0, 45.0, 80.0] {
            assert_matches(&sheet_with_a_hole(0.0, azimuth, thickness), RMS);
        }
    }
}

#[test]
fn leaning_sheets_with_a_hole_2_thick() {
    leaning_sheets_with_a_hole(2.0);
}

#[test]
fn leaning_sheets_with_a_hole_3_thick() {
    leaning_sheets_with_a_hole(3.0);
}

#[test]
fn leaning_sheets_with_a_hole_6_thick() {
    leaning_sheets_with_a_hole(6.0);
}

fn leaning_sheets_with_a_hole(thickness: f64) {
    let mut failures = Vec::new();
    for tilt in [10.0, 20.0, 30.0, 45.0] {
        for azimuth in [0.0, 33.0, 75.0] {
            let phantom = sheet_with_a_hole(tilt, azimuth, thickness);
            let report = report_of(&phantom);
            let holds = Some(report.connectivity.topology) == phantom.topology
                && report.rms <= RMS
                && report.covered_within_1 == 1.0;
            if !holds {
                failures.push(format!("{tilt} degrees, azimuth {azimuth}: {report}"));
            }
        }
    }
    assert!(
        failures.is_empty(),
        "{thickness} thick\n{}",
        failures.join("\n")
    );
}

#[test]
fn leaning_disks_with_and_without_a_hole() {
    for tilt in [0.0, 15.0, 30.0, 45.0] {
        for hole in [0.0, 9.0] {
            let normal = leaning(tilt, 33.0);
            let thickness = Thickness::Constant(4.0);
            assert_matches(
                &disk(Frame::new([56; 3]), normal, 22.0, hole, thickness),
                RMS,
            );
        }
    }
}

#[test]
fn a_disk_that_grows_thicker() {
    for tilt in [0.0, 20.0, 40.0] {
        let phantom = wedge_disk(Frame::new([64; 3]), leaning(tilt, 33.0), 24.0, 3.0, 12.0);
        assert_matches(&phantom, RMS);
    }
}

#[test]
fn sheets_one_voxel_thin() {
    for tilt in [0.0, 15.0, 35.0] {
        // √3 thick covers every plane without a gap; less leaves pinholes in the label itself.
        assert_matches(
            &sheet(Frame::new([40; 3]), leaning(tilt, 33.0), 1.4, &[]),
            RMS,
        );
    }
}

#[test]
fn noise_does_not_move_the_surface() {
    let frame = || Frame::new([64, 64, 24]);
    for seed in [1, 2, 3] {
        assert_matches(&tube(frame(), 25.0, 6.0).with_noise(0.05, seed), RMS);
        for tilt in [0.0, 30.0] {
            assert_matches(
                &sheet_with_a_hole(tilt, 33.0, 6.0).with_noise(0.05, seed),
                0.12,
            );
        }
    }
}

#[test]
fn a_curved_sheet_keeps_its_radius() {
    let report = report_of(&tube(Frame::new([48, 48, 16]), 16.0, 6.0));
    assert!(report.mean_signed.abs() <= 0.08, "{report}");
}
