//! Everything that must hold on the table of phantoms, one test a line of the table, clean and
//! noisy. `cargo run -p phantoms --release --example table` prints the figures.
//!
//! `SEED=17 cargo test …` tries other positions, orientations and sizes than the usual ones.

use midsurface::Grid;
use phantoms::{judge, trials, Phantom, Report, Trial};

use crate::ridge_surface;

const CLEAN: bool = false;
const NOISY: bool = true;

fn seed() -> u64 {
    let seed = std::env::var("SEED").map(|seed| seed.parse().expect("SEED is a whole number"));
    seed.unwrap_or(1)
}

fn assert_must(name: &str, noisy: bool) {
    let (trial, phantom, report) = judged(name, seed(), noisy);
    let (missed, _) = trial.verdict(&report, &phantom, noisy);
    assert!(
        missed.is_empty(),
        "seed {}: {}\n{report}",
        seed(),
        missed.join(", ")
    );
}

/// A line of the table, with the phantom of this seed and what is to be said of its mesh.
pub(crate) fn judged(name: &str, seed: u64, noisy: bool) -> (Trial, Phantom, Report) {
    let mut trials = trials().into_iter();
    let trial = trials.find(|trial| trial.name == name);
    let trial = trial.expect("a line of the table");
    let phantom = trial.phantom(seed, noisy);
    let report = judged_phantom(&phantom);
    (trial, phantom, report)
}

/// What is to be said of the mesh of a phantom.
pub(crate) fn judged_phantom(phantom: &Phantom) -> Report {
    let frame = &phantom.frame;
    let grid = Grid {
        dimensions: frame.dimensions,
        extent_start: frame.extent_start,
        spacing: frame.spacing,
        origin: frame.origin,
        direction: frame.direction,
    };
    let mesh = ridge_surface(&phantom.labels, grid);
    judge(&mesh.points, &mesh.triangles, phantom)
}

macro_rules! must {
    ($(#[$attribute:meta])* $name:ident, $trial:literal, $noisy:expr) => {
        $(#[$attribute])*
        #[test]
        fn $name() {
            assert_must($trial, $noisy);
        }
    };
}

/// The method does not reach the limits here; run with `--include-ignored` to see by how much.
macro_rules! falls_short {
    ($name:ident, $trial:literal, $noisy:expr) => {
        must!(
            #[ignore = "falls short of the limits"]
            $name,
            $trial,
            $noisy
        );
    };
}

#[test]
fn every_line_of_the_table_is_tried() {
    let tests = include_str!("phantoms_known.rs");
    for trial in trials() {
        let named = format!("\"{}\"", trial.name);
        assert_eq!(tests.matches(&named).count(), 2, "{named}");
    }
}

must!(sphere_clean, "sphere", CLEAN);
must!(sphere_noisy, "sphere", NOISY);
must!(sphere_2_thick_clean, "sphere 2 thick", CLEAN);
must!(sphere_2_thick_noisy, "sphere 2 thick", NOISY);
must!(sphere_r_12_clean, "sphere R=12", CLEAN);
must!(sphere_r_12_noisy, "sphere R=12", NOISY);
must!(sphere_12_to_14_thick_clean, "sphere 12 to 14 thick", CLEAN);
must!(sphere_12_to_14_thick_noisy, "sphere 12 to 14 thick", NOISY);
must!(torus_clean, "torus", CLEAN);
must!(torus_noisy, "torus", NOISY);
must!(torus_2_thick_clean, "torus 2 thick", CLEAN);
must!(torus_2_thick_noisy, "torus 2 thick", NOISY);
must!(tube_clean, "tube", CLEAN);
must!(tube_noisy, "tube", NOISY);
falls_short!(tube_along_an_axis_clean, "tube along an axis", CLEAN);
must!(tube_along_an_axis_noisy, "tube along an axis", NOISY);
must!(tube_2_thick_clean, "tube 2 thick", CLEAN);
must!(tube_2_thick_noisy, "tube 2 thick", NOISY);
must!(disk_clean, "disk", CLEAN);
must!(disk_noisy, "disk", NOISY);
must!(disk_with_a_hole_clean, "disk with a hole", CLEAN);
must!(disk_with_a_hole_noisy, "disk with a hole", NOISY);
must!(
    disk_with_a_hole_2_thick_clean,
    "disk with a hole, 2 thick",
    CLEAN
);
must!(
    disk_with_a_hole_2_thick_noisy,
    "disk with a hole, 2 thick",
    NOISY
);
must!(disk_in_slices_clean, "disk in slices", CLEAN);
must!(disk_in_slices_noisy, "disk in slices", NOISY);
must!(cap_clean, "cap", CLEAN);
must!(cap_noisy, "cap", NOISY);
must!(cap_2_thick_clean, "cap 2 thick", CLEAN);
must!(cap_2_thick_noisy, "cap 2 thick", NOISY);
must!(disk_3_to_12_thick_clean, "disk 3 to 12 thick", CLEAN);
must!(disk_3_to_12_thick_noisy, "disk 3 to 12 thick", NOISY);
must!(plane_85_degrees_clean, "plane 85 degrees", CLEAN);
must!(plane_85_degrees_noisy, "plane 85 degrees", NOISY);
must!(gyroid_clean, "gyroid", CLEAN);
falls_short!(gyroid_noisy, "gyroid", NOISY);
must!(sphere_1_thick_clean, "sphere 1 thick", CLEAN);
must!(sphere_1_thick_noisy, "sphere 1 thick", NOISY);
must!(
    sphere_1_thick_corners_clean,
    "sphere 1 thick, corners",
    CLEAN
);
must!(
    sphere_1_thick_corners_noisy,
    "sphere 1 thick, corners",
    NOISY
);
must!(
    disk_with_a_hole_1_thick_clean,
    "disk with a hole, 1 thick",
    CLEAN
);
must!(
    disk_with_a_hole_1_thick_noisy,
    "disk with a hole, 1 thick",
    NOISY
);
must!(
    disk_with_a_hole_1_thick_corners_clean,
    "disk with a hole, 1 thick, corners",
    CLEAN
);
falls_short!(
    disk_with_a_hole_1_thick_corners_noisy,
    "disk with a hole, 1 thick, corners",
    NOISY
);
must!(
    nested_spheres_4_apart_clean,
    "nested spheres 4 apart",
    CLEAN
);
must!(
    nested_spheres_4_apart_noisy,
    "nested spheres 4 apart",
    NOISY
);
must!(
    nested_spheres_3_apart_clean,
    "nested spheres 3 apart",
    CLEAN
);
must!(
    nested_spheres_3_apart_noisy,
    "nested spheres 3 apart",
    NOISY
);
must!(
    nested_spheres_2_apart_clean,
    "nested spheres 2 apart",
    CLEAN
);
must!(
    nested_spheres_2_apart_noisy,
    "nested spheres 2 apart",
    NOISY
);
must!(
    nested_spheres_1_apart_clean,
    "nested spheres 1 apart",
    CLEAN
);
must!(
    nested_spheres_1_apart_noisy,
    "nested spheres 1 apart",
    NOISY
);
must!(two_sheets_3_apart_clean, "two sheets 3 apart", CLEAN);
must!(two_sheets_3_apart_noisy, "two sheets 3 apart", NOISY);
must!(two_sheets_2_apart_clean, "two sheets 2 apart", CLEAN);
must!(two_sheets_2_apart_noisy, "two sheets 2 apart", NOISY);
must!(two_sheets_1_apart_clean, "two sheets 1 apart", CLEAN);
must!(two_sheets_1_apart_noisy, "two sheets 1 apart", NOISY);
must!(
    thick_slab_beside_thin_sheet_clean,
    "thick slab beside thin sheet",
    CLEAN
);
must!(
    thick_slab_beside_thin_sheet_noisy,
    "thick slab beside thin sheet",
    NOISY
);
must!(
    labels_touching_sheets_clean,
    "labels touching, sheets",
    CLEAN
);
must!(
    labels_touching_sheets_noisy,
    "labels touching, sheets",
    NOISY
);
must!(
    labels_touching_shells_clean,
    "labels touching, shells",
    CLEAN
);
must!(
    labels_touching_shells_noisy,
    "labels touching, shells",
    NOISY
);
must!(invagination_clean, "invagination", CLEAN);
must!(invagination_noisy, "invagination", NOISY);
must!(fold_clean, "fold", CLEAN);
must!(fold_noisy, "fold", NOISY);
must!(cristae_clean, "cristae", CLEAN);
must!(cristae_noisy, "cristae", NOISY);
must!(bent_tube_clean, "bent tube", CLEAN);
must!(bent_tube_noisy, "bent tube", NOISY);
must!(sheet_with_many_holes_clean, "sheet with many holes", CLEAN);
falls_short!(sheet_with_many_holes_noisy, "sheet with many holes", NOISY);
must!(junction_t_clean, "junction T", CLEAN);
must!(junction_t_noisy, "junction T", NOISY);
must!(junction_y_clean, "junction Y", CLEAN);
must!(junction_y_noisy, "junction Y", NOISY);
falls_short!(junction_y_narrow_clean, "junction Y, narrow", CLEAN);
falls_short!(junction_y_narrow_noisy, "junction Y, narrow", NOISY);
must!(junction_x_clean, "junction X", CLEAN);
must!(junction_x_noisy, "junction X", NOISY);
must!(sphere_slices_apart_clean, "sphere, slices apart", CLEAN);
must!(sphere_slices_apart_noisy, "sphere, slices apart", NOISY);
must!(tube_slices_apart_clean, "tube, slices apart", CLEAN);
must!(tube_slices_apart_noisy, "tube, slices apart", NOISY);
must!(
    disk_with_a_hole_slices_apart_clean,
    "disk with a hole, slices apart",
    CLEAN
);
must!(
    disk_with_a_hole_slices_apart_noisy,
    "disk with a hole, slices apart",
    NOISY
);
must!(
    disk_lying_in_slices_apart_clean,
    "disk lying in slices apart",
    CLEAN
);
must!(
    disk_lying_in_slices_apart_noisy,
    "disk lying in slices apart",
    NOISY
);
