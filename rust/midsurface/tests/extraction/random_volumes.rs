//! Any small volume gives a sound mesh, in bounded time.

use std::time::{Duration, Instant};

use midsurface::{extract, mid_polylines, zip_polylines, Grid, Method, Options, Quiet, Volume};
use proptest::prelude::*;

use crate::chain::assert_same_surface;
use crate::measure::assert_sound;

#[derive(Debug, Clone)]
struct Case {
    grid: Grid,
    labels: Vec<u8>,
    wanted: Option<Vec<i64>>,
    threads: usize,
}

fn grids(longest: usize) -> impl Strategy<Value = Grid> {
    let spacing = prop_oneof![Just([1.0; 3]), [0.3..3.0f64, 0.3..3.0f64, 0.3..3.0f64]];
    let dimensions = [1..=longest, 1..=longest, 1..=longest];
    (dimensions, spacing, [-9..9i64, -9..9i64, -9..9i64]).prop_map(
        |(dimensions, spacing, start)| Grid {
            spacing,
            extent_start: start,
            ..Grid::new(dimensions)
        },
    )
}

fn cases(
    labels: impl Fn(&Grid) -> BoxedStrategy<Vec<u8>>,
    longest: usize,
) -> impl Strategy<Value = Case> {
    let wanted = prop::option::weighted(0.3, prop::collection::vec(1..=3i64, 1..3));
    grids(longest)
        .prop_flat_map(move |grid| (labels(&grid), Just(grid)))
        .prop_flat_map(move |(labels, grid)| (Just(labels), Just(grid), wanted.clone(), 0..3usize))
        .prop_map(|(labels, grid, wanted, threads)| Case {
            grid,
            labels,
            wanted,
            threads,
        })
}

/// Each voxel by itself, as dense as the number of zeros among the choices says.
fn scattered(grid: &Grid) -> BoxedStrategy<Vec<u8>> {
    let count = grid.dimensions.iter().product::<usize>();
    (0..12usize, 1..=3u8)
        .prop_flat_map(move |(background, labels)| {
            let choices = (0..background)
                .map(|_| 0)
                .chain(1..=labels)
                .collect::<Vec<u8>>();
            prop::collection::vec(prop::sample::select(choices), count)
        })
        .boxed()
}

/// Boxes painted over each other, some of them with background.
fn boxes(grid: &Grid) -> BoxedStrategy<Vec<u8>> {
    let [nx, ny, nz] = grid.dimensions;
    let side = |n: usize| (0..n, 1..=n);
    let one = (
        side(nx),
        side(ny),
        side(nz),
        prop::sample::select(vec![1u8, 1, 2, 3, 0]),
    );
    prop::collection::vec(one, 1..9)
        .prop_map(move |boxes| {
            let mut labels = vec![0; nx * ny * nz];
            for ((x, w), (y, h), (z, d), label) in boxes {
                for z in z..(z + d).min(nz) {
                    for y in y..(y + h).min(ny) {
                        labels[(z * ny + y) * nx..][x..(x + w).min(nx)].fill(label);
                    }
                }
            }
            labels
        })
        .boxed()
}

/// Thin level sets of a sum of waves: curved sheets that branch, touch and end.
fn waves(grid: &Grid) -> BoxedStrategy<Vec<u8>> {
    let [nx, ny, nz] = grid.dimensions;
    let wave = || [-1.0..1.0f64, -1.0..1.0, -1.0..1.0, 0.0..6.3];
    ([wave(), wave(), wave()], 0.1..0.7f64)
        .prop_map(move |(waves, width)| {
            let value = |i: usize| -> f64 {
                let p = [i % nx, i / nx % ny, i / (nx * ny)].map(|v| v as f64);
                let phase = |w: &[f64; 4]| w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3];
                waves.iter().map(|w| phase(w).sin()).sum()
            };
            (0..nx * ny * nz)
                .map(|i| u8::from(value(i).abs() < width))
                .collect()
        })
        .boxed()
}

fn assert_extracts(case: &Case) {
    let volume = Volume::new(&case.labels, case.grid.clone()).expect("a sound volume");
    let options = Options {
        method: Method::PolylineZipper,
        labels: case.wanted.clone(),
        threads: case.threads,
        ..Options::default()
    };
    let clock = Instant::now();
    let Ok(mesh) = extract(&volume, &options, &mut Quiet::default()) else {
        // The labels asked for need not be there; nothing else may fail.
        let absent = case
            .wanted
            .as_ref()
            .expect("an error without labels asked for");
        assert!(absent
            .iter()
            .all(|&label| !case.labels.contains(&(label as u8))));
        return;
    };
    // Milliseconds on a quiet machine: longer than this is a hang, however busy it is.
    assert!(
        clock.elapsed() < Duration::from_secs(20),
        "{:?}",
        clock.elapsed()
    );
    assert_sound(&mesh);
    let lines = mid_polylines(&volume, &options, &mut Quiet::default()).expect("polylines");
    assert_eq!(lines.check(), Ok(()));
    let zipped = zip_polylines(&lines, &options, &mut Quiet::default()).expect("a mesh");
    assert_same_surface(&mesh, &zipped);
    for p in &mesh.points {
        let outside = beyond(&case.grid, p.map(f64::from));
        assert!(
            outside <= 0.01,
            "{p:?} is {outside} voxels outside the volume"
        );
    }
}

/// How far a point lies outside the volume, voxels.
fn beyond(grid: &Grid, p: [f64; 3]) -> f64 {
    let one = |a: usize| {
        let index = p[a] / grid.spacing[a] - grid.extent_start[a] as f64;
        (-index).max(index - (grid.dimensions[a] as f64 - 1.0))
    };
    (0..3).map(one).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        max_shrink_iters: 200,
        ..ProptestConfig::with_cases(250)
    })]

    #[test]
    fn scattered_voxels(case in cases(scattered, 14)) {
        assert_extracts(&case);
    }

    #[test]
    fn blocky_structures(case in cases(boxes, 14)) {
        assert_extracts(&case);
    }

    #[test]
    fn curved_sheets(case in cases(waves, 20)) {
        assert_extracts(&case);
    }
}
