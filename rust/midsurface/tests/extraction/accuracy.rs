//! How near the mesh is to the true mid-surface, and whether it is all there. Lengths in voxels.

use phantoms::*;

use crate::measure::{assert_all_match, complete_within, report_of, Limits};

/// What every tube 6 thick and every sheet with a hole must keep.
const STRICT: Limits = complete_within(0.1);

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

fn tubes(thickness: f64, count: usize) -> impl Iterator<Item = (String, Phantom)> {
    within_a_voxel(count).map(move |offset| {
        let name = format!("tube {thickness} thick, moved by {offset:.2?}");
        (
            name,
            tube_at(Frame::new([72, 72, 20]), offset, 25.0, thickness),
        )
    })
}

/// Seeds from the one that the environment names, so that `SEED=100 cargo test …` tries others.
fn seeds(count: u64) -> std::ops::Range<u64> {
    let seed = std::env::var("SEED").map(|seed| seed.parse().expect("SEED is a whole number"));
    let first = seed.unwrap_or(1);
    first..first + count
}

#[test]
fn random_tubes() {
    let tubes = seeds(24).map(upright_tube);
    assert_all_match(tubes.map(|tube| (tube.name.clone(), tube)), STRICT);
}

#[test]
fn random_leaning_sheets_with_a_hole() {
    let sheets = seeds(24).map(leaning_sheet);
    assert_all_match(sheets.map(|sheet| (sheet.name.clone(), sheet)), STRICT);
}

#[test]
fn tubes_whose_terraces_are_longest() {
    // The circle comes to within a hair of the next row of voxels, on one side at least.
    let tubes = [49, 64, 91, 154, 178, 186].map(upright_tube);
    assert_all_match(tubes.map(|tube| (tube.name.clone(), tube)), STRICT);
}

#[test]
fn sheets_that_leave_at_a_small_angle() {
    // The ends of neighbouring slices' lines lie several edges apart.
    let sheets = [84, 99, 114, 129, 149].map(leaning_sheet);
    assert_all_match(sheets.map(|sheet| (sheet.name.clone(), sheet)), STRICT);
}

#[test]
fn tubes_6_thick_wherever_their_centre_is() {
    assert_all_match(tubes(6.0, 8), STRICT);
}

#[test]
fn tubes_of_other_thickness() {
    // The fewer voxels wide the label, the more its width differs from place to place.
    let thicknesses = [2.0, 3.0, 4.5, 9.0].into_iter();
    assert_all_match(thicknesses.flat_map(|t| tubes(t, 3)), complete_within(0.12));
}

#[test]
fn a_tight_tube() {
    let tubes = within_a_voxel(3).map(|offset| {
        (
            format!("moved by {offset:?}"),
            tube_at(Frame::new([32, 32, 16]), offset, 9.0, 4.0),
        )
    });
    assert_all_match(tubes, complete_within(0.15));
}

#[test]
fn thin_membranes_in_slices_far_apart() {
    // Lines of neighbouring slices are farther apart than the membrane is thick.
    for apart in [3.0, 3.4, 4.0, 5.0] {
        let frame = Frame::with_spacing([48, 48, 12], [1.0, 1.0, apart]);
        let leanings = [(0.0, 0.0), (5.0, 20.0), (10.0, 75.0)];
        let sheets = leanings.iter().flat_map(|&(tilt, azimuth)| {
            let sheet = |thick| sheet(frame.clone(), leaning(tilt, azimuth), thick, &[]);
            [1.0, 2.0].map(|thick| (format!("{tilt} degrees, {thick} thick"), sheet(thick)))
        });
        let tube = ("tube".to_owned(), tube(frame.clone(), 17.3, 2.0));
        let membranes = sheets.chain([tube]);
        let named = membranes.map(|(name, phantom)| (format!("{name}, {apart} apart"), phantom));
        assert_all_match(named, complete_within(0.12));
    }
}

fn sheet_with_a_hole(tilt: f64, azimuth: f64, thickness: f64) -> (String, Phantom) {
    let frame = Frame::new([64; 3]);
    let hole = hole_in_the_middle(&frame, 12.0);
    let name = format!("{tilt} degrees, azimuth {azimuth}, {thickness} thick");
    (
        name,
        sheet(frame, leaning(tilt, azimuth), thickness, &[hole]),
    )
}

fn sheets_with_a_hole(tilts: &[f64], thickness: f64, limits: Limits) {
    let sheets = tilts.iter().flat_map(|&tilt| {
        [0.0, 17.0, 33.0, 45.0, 75.0].map(|azimuth| sheet_with_a_hole(tilt, azimuth, thickness))
    });
    assert_all_match(sheets, limits);
}

#[test]
fn upright_sheets_2_thick_with_a_hole() {
    sheets_with_a_hole(&[0.0], 2.0, STRICT);
}

#[test]
fn upright_sheets_3_thick_with_a_hole() {
    sheets_with_a_hole(&[0.0], 3.0, STRICT);
}

#[test]
fn upright_sheets_6_thick_with_a_hole() {
    sheets_with_a_hole(&[0.0], 6.0, STRICT);
}

#[test]
fn leaning_sheets_2_thick_with_a_hole() {
    sheets_with_a_hole(&[10.0, 20.0, 30.0, 40.0, 45.0], 2.0, STRICT);
}

#[test]
fn leaning_sheets_3_thick_with_a_hole() {
    sheets_with_a_hole(&[10.0, 20.0, 30.0, 40.0, 45.0], 3.0, STRICT);
}

#[test]
fn leaning_sheets_8_thick_with_a_hole() {
    sheets_with_a_hole(&[45.0], 8.0, STRICT);
}

#[test]
fn leaning_sheets_12_thick_with_a_hole() {
    // In a corner of the volume a point may be missing.
    let limits = Limits {
        rms: 0.12,
        covered: 0.9997,
    };
    sheets_with_a_hole(&[30.0, 40.0, 45.0], 12.0, limits);
}

#[test]
fn leaning_sheets_6_thick_with_a_hole() {
    // At 20 degrees and an azimuth of 45 the sheet is nearly a plane (2 2 1) of the lattice: terraces a
    // third of a voxel high and 33 slices long.
    sheets_with_a_hole(&[10.0, 20.0, 30.0, 40.0, 45.0], 6.0, STRICT);
}

#[test]
fn leaning_disks_with_and_without_a_hole() {
    let disks = [0.0, 15.0, 30.0, 45.0].into_iter().flat_map(|tilt| {
        [0.0, 9.0].map(|hole| {
            let (normal, thickness) = (leaning(tilt, 33.0), Thickness::Constant(4.0));
            let name = format!("{tilt} degrees, hole {hole}");
            (
                name,
                disk(Frame::new([56; 3]), normal, 22.0, hole, thickness),
            )
        })
    });
    assert_all_match(disks, STRICT);
}

#[test]
fn a_disk_that_grows_thicker() {
    let disks = [0.0, 20.0, 40.0].map(|tilt| {
        let phantom = wedge_disk(Frame::new([64; 3]), leaning(tilt, 33.0), 24.0, 3.0, 12.0);
        (format!("{tilt} degrees"), phantom)
    });
    // At its thick end a leaning disk is as thick as it is long in the last slices: no line there.
    assert_all_match(
        disks,
        Limits {
            rms: 0.1,
            covered: 0.97,
        },
    );
}

#[test]
fn sheets_one_voxel_thin() {
    // Less than 1.4 thick, these labels have holes of their own.
    let sheets = [0.0, 15.0, 35.0].map(|tilt| {
        (
            format!("{tilt} degrees"),
            sheet(Frame::new([40; 3]), leaning(tilt, 33.0), 1.4, &[]),
        )
    });
    assert_all_match(sheets, STRICT);
}

#[test]
fn noise_does_not_move_the_surface() {
    let frame = || Frame::new([64, 64, 24]);
    let noisy = [1, 2, 3].into_iter().flat_map(|seed| {
        let tube = (format!("tube, seed {seed}"), tube(frame(), 25.0, 6.0));
        [sheet_with_a_hole(0.0, 33.0, 6.0), tube]
            .map(move |(n, phantom)| (n, phantom.with_noise(0.05, seed)))
    });
    assert_all_match(noisy, complete_within(0.12));
}

#[test]
fn noise_does_not_tear_leaning_sheets() {
    let noisy = [20.0, 30.0, 40.0].into_iter().flat_map(|tilt| {
        [(0.0, 2), (17.0, 1), (33.0, 1), (75.0, 2)].map(|(azimuth, seed)| {
            let (name, phantom) = sheet_with_a_hole(tilt, azimuth, 6.0);
            (name, phantom.with_noise(0.05, seed))
        })
    });
    // In its corners a noisy sheet may end a voxel early.
    assert_all_match(
        noisy,
        Limits {
            rms: 0.1,
            covered: 0.999,
        },
    );
}

#[test]
fn a_curved_sheet_keeps_its_radius() {
    let report = report_of(&tube(Frame::new([48, 48, 16]), 16.0, 6.0));
    assert!(report.mean_signed.abs() <= 0.08, "{report}");
}
