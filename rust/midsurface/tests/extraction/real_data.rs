//! Real segmentations, where they lie beside the checkout in ../shared/data: nearly equilateral
//! triangles, and hardly one runs into another.

use std::path::Path;

use midsurface::Grid;

use crate::image_file;
use crate::measure::extract_all;

fn check(name: &str) {
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
    assert!(quality.mean >= 0.93, "{told}");
    assert!(quality.mean_smallest_angle >= 53.5, "{told}");
    assert_eq!(quality.share_under_30, 0.0, "{told}");
    assert_eq!(quality.share_over_120, 0.0, "{told}");
    assert!(quality.valence_567 >= 0.99999, "{told}");
    let crossings = phantoms::self_intersections(&mesh.points, &mesh.triangles).len();
    assert!(
        crossings <= mesh.triangles.len() / 50_000,
        "{told}: {crossings} pairs of triangles run into each other"
    );
}

#[test]
fn virion_small() {
    check("Fig13A.vti");
}

#[test]
fn virion_large() {
    check("Fig13B.vti");
}

#[test]
fn virion_larger() {
    check("Fig7.vti");
}

#[test]
fn outer_membranes() {
    check("Fig11-OMM.vti");
}

#[test]
fn inner_membranes() {
    check("Fig11-IMM.vti");
}
