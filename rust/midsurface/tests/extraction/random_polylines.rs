//! Any polylines in slices zip to a sound mesh.

use midsurface::{zip_polylines, Options, Polyline, Polylines, Quiet};
use proptest::prelude::*;

use crate::measure::assert_sound;

/// Points of one line within its slice, whether it is closed, and its label.
type Line = (Vec<[f64; 2]>, bool, i64);

fn assemble(slices: Vec<Vec<Line>>) -> Polylines {
    let mut polylines = Polylines::default();
    for (slice, lines) in slices.into_iter().enumerate() {
        for (points, closed, label) in lines {
            polylines.lines.push(Polyline {
                first: polylines.points.len(),
                count: points.len(),
                closed,
                label,
                component: label as u32,
                slice: slice as i64,
            });
            polylines
                .thickness
                .extend(std::iter::repeat_n(3.0, points.len()));
            polylines
                .border_distance
                .extend(std::iter::repeat_n(f32::INFINITY, points.len()));
            polylines
                .points
                .extend(points.iter().map(|p| [p[0], p[1], slice as f64]));
        }
    }
    polylines
}

fn slices(coordinate: impl Strategy<Value = f64> + Clone) -> impl Strategy<Value = Polylines> {
    let points = prop::collection::vec([coordinate.clone(), coordinate], 0..24);
    let line = (points, any::<bool>(), 1..=2i64);
    prop::collection::vec(prop::collection::vec(line, 0..5), 1..6).prop_map(assemble)
}

/// A step to a neighbouring place: like a traced line, but with folds and crossings.
fn walks() -> impl Strategy<Value = Polylines> {
    let step = prop::sample::select(vec![
        [1.4, 0.0],
        [0.0, 1.4],
        [-1.4, 0.0],
        [0.0, -1.4],
        [1.0, 1.0],
    ]);
    let steps = prop::collection::vec(step, 2..40);
    let start = [0..4i32, 0..4i32];
    let line = (start, steps, any::<bool>()).prop_map(|(start, steps, closed)| {
        let mut p = start.map(f64::from);
        let mut points = vec![p];
        for s in steps {
            p = [p[0] + s[0], p[1] + s[1]];
            points.push(p);
        }
        (points, closed, 1)
    });
    prop::collection::vec(prop::collection::vec(line, 1..3), 2..7).prop_map(assemble)
}

/// What is refused is refused for its planes only, and told to be so by `check`.
fn assert_zips(polylines: &Polylines) {
    let mesh = zip_polylines(polylines, &Options::default(), &mut Quiet::default());
    match (polylines.check(), mesh) {
        (Ok(()), Ok(mesh)) => assert_sound(&mesh),
        (Err(expected), Err(found)) => assert_eq!(expected, found),
        (check, _) => panic!("the check says {check:?}, the zipper something else"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(600)
    })]

    #[test]
    fn scattered_points(polylines in slices(-8.0..8.0f64)) {
        assert_zips(&polylines);
    }

    #[test]
    fn coincident_points(polylines in slices((0..4i32).prop_map(f64::from))) {
        assert_zips(&polylines);
    }

    #[test]
    fn walks_with_folds(polylines in walks()) {
        prop_assert_eq!(polylines.check(), Ok(()));
        assert_zips(&polylines);
    }

    #[test]
    fn coordinates_of_all_sizes(
        polylines in slices(prop::sample::select(vec![-1e4, -3.0, 0.0, 1e-3, 2e-3, 1.0, 1e4])),
    ) {
        assert_zips(&polylines);
    }
}
