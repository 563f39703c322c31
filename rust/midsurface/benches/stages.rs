//! Time of every stage, through the public API: on a tube, on a made-up mitochondrion, and on the
//! real volumes where they lie beside the checkout in ../shared/data.
//!
//! `cargo bench -p midsurface [-- PART OF A NAME]`

#[path = "../tests/extraction/image_file.rs"]
mod image_file;

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use criterion::{Criterion, SamplingMode};
use midsurface::{
    extract, find_labels, mid_polylines, ridge_field, zip_polylines, Grid, Options, Quiet, Volume,
};
use ndarray::Array3;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let frame = phantoms::Frame::new([128, 128, 96]);
    let tube = phantoms::tube(frame, 50.0, 6.0).labels;
    measure(&mut criterion, "tube", &tube, &Grid::new([128, 128, 96]));
    let dimensions = [256, 160, 64];
    let labels = phantoms::mitochondrion(dimensions, 0.02, 1);
    measure(
        &mut criterion,
        "mitochondrion",
        &labels,
        &Grid::new(dimensions),
    );

    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    for name in ["Fig13A", "Fig13B", "Fig7", "Fig11-OMM", "Fig11-IMM"] {
        let path = folder.join(name).with_extension("vti");
        if path.exists() {
            let (labels, grid) = image_file::read(&path);
            measure(&mut criterion, name, &labels, &grid);
        } else {
            println!("skipped: {} is not there", path.display());
        }
    }
    criterion.final_summary();
}

/// Times all stages on one volume, all cores at work.
fn measure(criterion: &mut Criterion, name: &str, labels: &[u8], grid: &Grid) {
    let volume = Volume::new(labels, grid.clone()).expect("a sound volume");
    let options = Options::default();
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(10)
        .sampling_mode(SamplingMode::Flat)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_secs(1));
    group.bench_function("find_labels", |b| {
        b.iter(|| black_box(find_labels(&volume, &options, &mut Quiet::default())));
    });
    let [x, y, z] = grid.dimensions;
    let (mut distance, mut ridge) = (Array3::zeros((z, y, x)), Array3::zeros((z, y, x)));
    group.bench_function("ridge_field", |b| {
        b.iter(|| {
            let (distance, ridge) = (distance.view_mut(), ridge.view_mut());
            black_box(ridge_field(
                &volume,
                &options,
                &mut Quiet::default(),
                distance,
                ridge,
            ))
        });
    });
    drop((distance, ridge));
    group.bench_function("mid_polylines", |b| {
        b.iter(|| black_box(mid_polylines(&volume, &options, &mut Quiet::default())));
    });
    let lines = mid_polylines(&volume, &options, &mut Quiet::default()).expect("polylines");
    group.bench_function("zip_polylines", |b| {
        b.iter(|| black_box(zip_polylines(&lines, &options, &mut Quiet::default())));
    });
    group.bench_function("extract", |b| {
        b.iter(|| black_box(extract(&volume, &options, &mut Quiet::default())));
    });
    group.finish();
}
