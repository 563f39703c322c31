//! Threads do not change the mesh; progress goes forward; a cancelled run stops at once.

use midsurface::{extract, mid_polylines, Error, Grid, Mesh, Method, Options, Result, Volume};
use phantoms::*;

use crate::measure::grid;
use crate::observer::Recorder;

/// The mesh as bits, so that −0 and 0 differ and NaN would equal itself.
fn bits(mesh: &Mesh) -> Vec<u32> {
    let points = mesh
        .points
        .as_flattened()
        .iter()
        .chain(mesh.normals.as_flattened());
    let floats = points.chain(&mesh.thickness).map(|v| v.to_bits());
    let triangles = mesh.triangles.as_flattened().iter().copied();
    floats
        .chain(triangles)
        .chain(mesh.components.iter().copied())
        .collect()
}

fn run<T: midsurface::Label>(
    labels: &[T],
    grid: Grid,
    threads: usize,
    recorder: &mut Recorder,
) -> Result<Mesh> {
    let volume = Volume::new(labels, grid)?;
    extract(
        &volume,
        &Options {
            method: Method::PolylineZipper,
            threads,
            ..Options::default()
        },
        recorder,
    )
}

#[test]
fn any_number_of_threads_gives_the_same_mesh() {
    let dimensions = [128, 96, 48];
    let noisy = mitochondrion(dimensions, 0.05, 11);
    let branched = junction(Frame::new([48; 3]), leaning(5.0, 33.0), 4.0);
    for (labels, dimensions) in [(noisy, dimensions), (branched.labels, [48; 3])] {
        let mesh = |threads| {
            let mut recorder = Recorder::new(usize::MAX);
            run(&labels, Grid::new(dimensions), threads, &mut recorder).expect("a mesh")
        };
        let one = mesh(1);
        assert!(one.triangles.len() > 1000);
        for threads in [2, 5, 0] {
            let many = mesh(threads);
            assert_eq!(bits(&one), bits(&many), "{threads} threads");
            assert_eq!(one.labels, many.labels, "{threads} threads");
        }
    }
}

#[test]
fn two_runs_give_the_same_mesh() {
    let labels = mitochondrion([96, 64, 32], 0.05, 2);
    let mesh = || {
        run(
            &labels,
            Grid::new([96, 64, 32]),
            2,
            &mut Recorder::new(usize::MAX),
        )
    };
    assert_eq!(
        bits(&mesh().expect("a mesh")),
        bits(&mesh().expect("a mesh"))
    );
}

fn assert_forward(recorder: &Recorder) {
    let fractions: Vec<f64> = recorder.calls.iter().map(|c| c.fraction).collect();
    assert!(fractions.windows(2).all(|w| w[0] <= w[1]), "{fractions:?}");
    assert_eq!(
        (fractions.first(), fractions.last()),
        (Some(&0.0), Some(&1.0))
    );
    let caller = std::thread::current().id();
    assert!(recorder.calls.iter().all(|call| call.thread == caller));
    assert!(recorder.calls.iter().all(|call| !call.stage.is_empty()));
}

#[test]
fn progress_goes_from_0_to_1_on_the_calling_thread() {
    let labels = mitochondrion([128, 96, 48], 0.0, 4);
    for threads in [1, 3] {
        let mut recorder = Recorder::new(usize::MAX);
        run(&labels, Grid::new([128, 96, 48]), threads, &mut recorder).expect("a mesh");
        assert_forward(&recorder);
        let mut stages: Vec<&str> = recorder.calls.iter().map(|c| c.stage.as_str()).collect();
        stages.dedup();
        assert!(stages.len() >= 5, "{stages:?}");
    }
}

#[test]
fn progress_is_reported_where_there_is_no_surface() {
    let empty = (vec![0u8; 1000], [10; 3]);
    let single_slice = (vec![1u8; 400], [20, 1, 20]);
    for (labels, dimensions) in [empty, single_slice] {
        for method in [Method::RidgeSurface, Method::PolylineZipper] {
            let volume = Volume::new(&labels, Grid::new(dimensions)).expect("a sound volume");
            let options = Options {
                method,
                ..Options::default()
            };
            let mut recorder = Recorder::new(usize::MAX);
            let mesh = extract(&volume, &options, &mut recorder).expect("an empty mesh");
            assert!(mesh.triangles.is_empty());
            assert_forward(&recorder);
        }
    }
}

#[test]
fn every_call_of_progress_can_cancel() {
    let phantom = two_sheets(
        Frame::new([24, 24, 10]),
        leaning(10.0, 33.0),
        4.0,
        0.0,
        [1, 2],
    );
    let mut whole = Recorder::new(usize::MAX);
    run(&phantom.labels, grid(&phantom.frame), 2, &mut whole).expect("a mesh");
    assert!(whole.calls.len() > 10);
    for index in 0..whole.calls.len() {
        let mut recorder = Recorder::new(index);
        let result = run(&phantom.labels, grid(&phantom.frame), 2, &mut recorder);
        // How many calls there are depends on how long the work takes: this run may have fewer.
        if index > 10 && recorder.calls.len() <= index {
            assert!(result.is_ok(), "nobody cancelled");
            break;
        }
        assert!(result == Err(Error::Cancelled), "cancelled at call {index}");
        assert_eq!(
            recorder.calls.len(),
            index + 1,
            "asked again after a cancel"
        );
    }
}

#[test]
fn the_stages_can_be_cancelled_too() {
    let phantom = tube(Frame::new([40, 40, 8]), 14.0, 4.0);
    let volume = Volume::new(&phantom.labels, grid(&phantom.frame)).expect("a sound volume");
    let options = Options::default();
    let cancelled = mid_polylines(&volume, &options, &mut Recorder::new(3));
    assert_eq!(cancelled, Err(Error::Cancelled));
    let lines = mid_polylines(&volume, &options, &mut Recorder::new(usize::MAX)).expect("lines");
    let cancelled = midsurface::zip_polylines(&lines, &options, &mut Recorder::new(1));
    assert_eq!(cancelled, Err(Error::Cancelled));
    let found = midsurface::find_labels(&volume, &options, &mut Recorder::new(0));
    assert_eq!(found, Err(Error::Cancelled));
    let shape = (8, 40, 40);
    let (mut distance, mut ridge) = (field(shape), field(shape));
    let result = midsurface::ridge_field(
        &volume,
        &options,
        &mut Recorder::new(2),
        distance.view_mut(),
        ridge.view_mut(),
    );
    assert_eq!(result, Err(Error::Cancelled));
}

fn field(shape: (usize, usize, usize)) -> ndarray::Array3<f32> {
    ndarray::Array3::zeros(shape)
}
