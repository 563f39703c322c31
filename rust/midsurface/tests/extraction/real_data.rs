//! Real segmentations, where they lie beside the checkout in ../shared/data: at least as good as
//! the paper's own plugin on them, and hardly a triangle runs into another.

use std::path::Path;

use midsurface::Grid;

use crate::image_file;
use crate::measure::extract_all;

/// Mean quality in hundredths, mean smallest angle in degrees and share of interior points with 5
/// to 7 edges in per mille, each rounded.
#[derive(Debug)]
struct AtLeast {
    quality: f64,
    angle: f64,
    valence: f64,
}

fn check(name: &str, least: AtLeast) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = folder.join(name);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return;
    }
    let (labels, grid): (Vec<u8>, Grid) = image_file::read(&path);
    assert_eq!(labels.len(), grid.dimensions.iter().product::<usize>());
    // Sound, too: that is asserted for every mesh.
    let (mesh, _) = extract_all(&labels, grid);
    let quality = mesh.quality().unwrap();
    let told = format!("{name}: {} points, {quality:?}", mesh.points.len());
    println!("{told}");
    assert!((100.0 * quality.mean).round() >= least.quality, "{told}");
    assert!(quality.mean_smallest_angle.round() >= least.angle, "{told}");
    assert!(
        (1000.0 * quality.valence_567).round() >= least.valence,
        "{told}"
    );
    let crossings = phantoms::self_intersections(&mesh.points, &mesh.triangles).len();
    assert!(
        crossings <= mesh.triangles.len() / 50_000,
        "{told}: {crossings} pairs of triangles run into each other"
    );
}

#[test]
fn virion_small() {
    check(
        "Fig13A.vti",
        AtLeast {
            quality: 82.0,
            angle: 44.0,
            valence: 999.0,
        },
    );
}

#[test]
fn virion_large() {
    check(
        "Fig13B.vti",
        AtLeast {
            quality: 83.0,
            angle: 45.0,
            valence: 999.0,
        },
    );
}

#[test]
fn virion_larger() {
    check(
        "Fig7.vti",
        AtLeast {
            quality: 83.0,
            angle: 45.0,
            valence: 999.0,
        },
    );
}

#[test]
fn outer_membranes() {
    check(
        "Fig11-OMM.vti",
        AtLeast {
            quality: 81.0,
            angle: 44.0,
            valence: 999.0,
        },
    );
}

#[test]
fn inner_membranes() {
    check(
        "Fig11-IMM.vti",
        AtLeast {
            quality: 79.0,
            angle: 42.0,
            valence: 999.0,
        },
    );
}
