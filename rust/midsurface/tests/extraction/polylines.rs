//! Polylines that come from elsewhere: what is wrong with them is said, what is odd is borne.

use midsurface::{zip_polylines, Error, Mesh, Options, Polyline, Polylines, Quiet, Result};

use crate::measure::assert_sound;

/// Straight parallel lines, one a slice, along x.
fn straight(slices: i64, count: usize) -> Polylines {
    let mut polylines = Polylines::default();
    for slice in 0..slices {
        let points = (0..count)
            .map(|i| [1.4 * i as f64, 0.0, slice as f64])
            .collect();
        add_line(&mut polylines, points, slice, false);
    }
    polylines
}

fn add_line(polylines: &mut Polylines, points: Vec<[f64; 3]>, slice: i64, closed: bool) {
    let (first, count) = (polylines.points.len(), points.len());
    polylines.thickness.extend(std::iter::repeat_n(4.0, count));
    let no_border = std::iter::repeat_n(f32::INFINITY, count);
    polylines.border_distance.extend(no_border);
    polylines.points.extend(points);
    polylines.lines.push(Polyline {
        first,
        count,
        closed,
        label: 1,
        component: 0,
        slice,
    });
}

fn zip(polylines: &Polylines) -> Result<Mesh> {
    zip_polylines(polylines, &Options::default(), &mut Quiet::default())
}

#[track_caller]
fn assert_refused(polylines: &Polylines) {
    let found = zip(polylines);
    assert!(matches!(found, Err(Error::Polylines(_))), "{found:?}");
    assert_eq!(polylines.check(), found.map(|_| ()));
}

#[test]
fn straight_lines_make_a_strip() {
    let mesh = zip(&straight(5, 12)).expect("a mesh");
    assert_sound(&mesh);
    assert_eq!((mesh.points.len(), mesh.triangles.len()), (60, 2 * 11 * 4));
}

#[test]
fn no_lines_at_all() {
    assert_eq!(zip(&Polylines::default()), Ok(Mesh::default()));
}

#[test]
fn a_line_that_leaves_its_slice() {
    let mut polylines = straight(4, 10);
    polylines.points[13][2] += 0.5;
    assert_refused(&polylines);
}

#[test]
fn two_slices_in_one_plane() {
    let mut polylines = straight(4, 10);
    for p in &mut polylines.points[10..20] {
        p[2] = 0.0;
    }
    assert_refused(&polylines);
}

#[test]
fn one_slice_in_two_planes() {
    let mut polylines = straight(4, 10);
    for line in &mut polylines.lines {
        line.slice /= 2;
    }
    assert_refused(&polylines);
}

#[test]
fn points_that_are_no_numbers() {
    for bad in [f64::NAN, f64::INFINITY] {
        for axis in 0..3 {
            let mut polylines = straight(4, 10);
            polylines.points[17][axis] = bad;
            assert_refused(&polylines);
        }
    }
    let mut polylines = straight(4, 10);
    polylines.thickness[3] = f32::NAN;
    assert_refused(&polylines);
    for bad in [f32::NAN, -1.0] {
        let mut polylines = straight(4, 10);
        polylines.border_distance[3] = bad;
        assert_refused(&polylines);
    }
    let mut polylines = straight(4, 10);
    polylines.voxel_steps[1][2] = f64::NAN;
    assert_refused(&polylines);
}

#[test]
fn arrays_that_do_not_fit() {
    let mut short = straight(4, 10);
    short.thickness.pop();
    assert_refused(&short);

    let mut short = straight(4, 10);
    short.border_distance.pop();
    assert_refused(&short);

    let mut beyond = straight(4, 10);
    beyond.lines[3].count = 11;
    assert_refused(&beyond);

    let mut overflow = straight(4, 10);
    overflow.lines[3].first = usize::MAX;
    assert_refused(&overflow);
}

#[test]
fn the_extremes_of_slice_numbers() {
    for first in [i64::MIN, i64::MAX - 3] {
        let mut polylines = straight(4, 10);
        for (i, line) in polylines.lines.iter_mut().enumerate() {
            line.slice = first + i as i64;
        }
        assert_sound(&zip(&polylines).expect("a mesh"));
    }
}

#[test]
fn slices_in_planes_that_are_turned() {
    // The slices' common normal is (0.6, 0, 0.8).
    let mut polylines = Polylines::default();
    for slice in 0..4 {
        let h = 1.5 * slice as f64;
        let at = |t: f64| {
            [
                0.6 * h + 0.8 * t + 50.0,
                2.0 * t.sin(),
                0.8 * h - 0.6 * t - 9.0,
            ]
        };
        add_line(
            &mut polylines,
            (0..20).map(|i| at(f64::from(i))).collect(),
            slice,
            false,
        );
    }
    let mesh = zip(&polylines).expect("a mesh");
    assert_sound(&mesh);
    assert_eq!(mesh.triangles.len(), 2 * 19 * 3);
}

#[test]
fn lines_in_any_order() {
    let sorted = straight(5, 12);
    let mut shuffled = sorted.clone();
    shuffled.lines.swap(0, 3);
    shuffled.lines.swap(1, 4);
    let corners = |mesh: &Mesh| {
        let corner = |t: &[u32; 3]| t.map(|p| mesh.points[p as usize].map(f32::to_bits));
        let mut corners: Vec<_> = mesh.triangles.iter().map(corner).collect();
        corners.sort_unstable();
        corners
    };
    let (sorted, shuffled) = (
        zip(&sorted).expect("a mesh"),
        zip(&shuffled).expect("a mesh"),
    );
    assert_sound(&shuffled);
    assert_eq!(corners(&sorted), corners(&shuffled));
}

#[test]
fn a_gap_between_slices_stays_a_gap() {
    let mut polylines = straight(6, 12);
    polylines.lines.remove(3);
    let mesh = zip(&polylines).expect("a mesh");
    // Unused points are left out.
    assert_sound(&mesh);
    assert_eq!(mesh.triangles.len(), 2 * 11 * 3);
}

#[test]
fn lines_far_apart_stay_apart() {
    let mut polylines = straight(2, 12);
    for p in &mut polylines.points[12..] {
        p[1] += 40.0;
    }
    assert_eq!(zip(&polylines).map(|mesh| mesh.triangles.len()), Ok(0));
}

#[test]
fn components_and_labels_are_not_joined() {
    for change in [
        |line: &mut Polyline| line.label = 2,
        |line: &mut Polyline| line.component = 1,
    ] {
        let mut polylines = straight(2, 12);
        change(&mut polylines.lines[1]);
        assert_eq!(zip(&polylines).map(|mesh| mesh.triangles.len()), Ok(0));
    }
}

#[test]
fn duplicate_points_are_borne() {
    let mut polylines = straight(4, 10);
    polylines.points[5] = polylines.points[4];
    polylines.points[14] = polylines.points[15];
    polylines.points[24] = polylines.points[25];
    polylines.points[26] = polylines.points[25];
    assert_sound(&zip(&polylines).expect("a mesh"));
}

#[test]
fn a_line_of_a_single_place_is_borne() {
    let mut polylines = straight(4, 10);
    for p in &mut polylines.points[10..20] {
        *p = [3.0, 0.0, 1.0];
    }
    assert_sound(&zip(&polylines).expect("a mesh"));
}

#[test]
fn short_lines_are_borne() {
    for count in [0, 1, 2, 3] {
        for closed in [false, true] {
            let mut polylines = rings(3);
            polylines.lines[1].count = count;
            polylines.lines[1].closed = closed;
            assert_sound(&zip(&polylines).expect("a mesh"));
        }
    }
}

#[test]
fn a_line_that_turns_back_on_itself_is_borne() {
    let mut polylines = Polylines::default();
    let row = |columns: &[f64], slice: i64| -> Vec<[f64; 3]> {
        columns
            .iter()
            .map(|x| [1.4 * x, 0.0, slice as f64])
            .collect()
    };
    add_line(
        &mut polylines,
        row(&[0.0, 1.0, 0.0, 1.0, 2.0, 1.0], 0),
        0,
        false,
    );
    add_line(&mut polylines, row(&[0.0, 1.0, 2.0], 1), 1, false);
    assert_sound(&zip(&polylines).expect("a mesh"));
}

#[test]
fn the_same_line_twice_is_borne() {
    let mut polylines = straight(4, 10);
    let copy: Vec<_> = polylines.points[10..20].to_vec();
    add_line(&mut polylines, copy, 1, false);
    assert_sound(&zip(&polylines).expect("a mesh"));
}

/// Closed circles, one a slice.
fn rings(slices: i64) -> Polylines {
    let mut polylines = Polylines::default();
    for slice in 0..slices {
        let turn = |i: i32| f64::from(i) * std::f64::consts::TAU / 40.0;
        let ring = (0..40).map(|i| [9.0 * turn(i).cos(), 9.0 * turn(i).sin(), slice as f64]);
        add_line(&mut polylines, ring.collect(), slice, true);
    }
    polylines
}

#[test]
fn rings_make_a_tube() {
    let mesh = zip(&rings(4)).expect("a mesh");
    assert_sound(&mesh);
    assert_eq!(mesh.triangles.len(), 2 * 40 * 3);
    let topology = phantoms::connectivity(mesh.points.len(), &mesh.triangles).topology;
    let found = (topology.components, topology.euler, topology.boundary_loops);
    assert_eq!(found, (1, 0, 2));
}

/// The least y of a mesh of lines along x, half of them at y = 0, the others a step higher. A
/// low-pass undershoots at a step.
fn lowest_of_a_step(border_distance: impl Fn(f64) -> f32) -> f32 {
    let mut polylines = straight(24, 24);
    let distances = polylines.border_distance.iter_mut();
    for (point, distance) in polylines.points.iter_mut().zip(distances) {
        point[1] = if point[2] < 12.0 { 0.0 } else { 1.5 };
        *distance = border_distance(point[1]);
    }
    let mesh = zip(&polylines).expect("a mesh");
    assert_sound(&mesh);
    mesh.points
        .iter()
        .fold(f32::MAX, |least, p| least.min(p[1]))
}

#[test]
fn flattening_moves_no_point_over_the_border() {
    let free = lowest_of_a_step(|_| f32::INFINITY);
    assert!(free < -0.02, "without a border: {free}");
    assert_eq!(lowest_of_a_step(|y| y as f32), 0.0);
}
