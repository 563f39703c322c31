//! The table of a mesh's figures, on meshes whose figures are known.

use midsurface::{statistics, Error, Scope, Statistics, TriangleMesh, Vec3};

/// A regular octahedron with corners at distance 1 from the centre, without its last `missing`
/// faces.
fn octahedron(centre_x: f64, first: i64, missing: usize) -> (Vec<Vec3>, Vec<[i64; 3]>) {
    let points = vec![
        [centre_x + 1.0, 0.0, 0.0],
        [centre_x - 1.0, 0.0, 0.0],
        [centre_x, 1.0, 0.0],
        [centre_x, -1.0, 0.0],
        [centre_x, 0.0, 1.0],
        [centre_x, 0.0, -1.0],
    ];
    let mut faces = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    faces.truncate(8 - missing);
    (points, faces.iter().map(|f| f.map(|p| p + first)).collect())
}

fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}

/// Label 7 is a closed octahedron (component 0) and one without its lower half (component 1);
/// label -2 one without a face (component 0).
fn table() -> Vec<Statistics> {
    let (mut points, mut triangles) = octahedron(0.0, 0, 0);
    let (mut labels, mut components) = (vec![7; 8], vec![0; 8]);
    for (centre, first, missing, label, component) in [(10.0, 6, 4, 7, 1), (20.0, 12, 1, -2, 0)] {
        let (p, t) = octahedron(centre, first, missing);
        labels.resize(labels.len() + t.len(), label);
        components.resize(components.len() + t.len(), component);
        points.extend(p);
        triangles.extend(t);
    }
    // Every other point is 3 thick, the others 5, and one is not known.
    let mut thickness: Vec<f32> = (0..points.len())
        .map(|p| 3.0 + 2.0 * (p % 2) as f32)
        .collect();
    thickness[0] = f32::NAN;
    let mesh = TriangleMesh {
        points: &points,
        triangles: &triangles,
        thickness: Some(&thickness),
        labels: Some(&labels),
        components: Some(&components),
        point_ids: None,
    };
    statistics(&mesh).expect("a good mesh")
}

#[test]
fn rows_are_the_total_and_each_label_with_its_components() {
    let scopes: Vec<Scope> = table().iter().map(|row| row.scope).collect();
    let component = |label, component| Scope::Component {
        label: Some(label),
        component,
    };
    let expected = [
        Scope::Total,
        Scope::Label(-2),
        component(-2, 0),
        Scope::Label(7),
        component(7, 0),
        component(7, 1),
    ];
    assert_eq!(scopes, expected);
}

#[test]
fn figures_are_those_of_the_rows_own_triangles() {
    let rows = table();
    let figures = |row: &Statistics| {
        (
            row.points,
            row.triangles,
            row.euler_number,
            row.boundary_loops,
        )
    };
    let found: Vec<_> = rows.iter().map(figures).collect();
    // The half without its lower faces does not use the lowest point.
    let expected = [
        (17, 19, 4, 2),
        (6, 7, 1, 1),
        (6, 7, 1, 1),
        (11, 12, 3, 1),
        (6, 8, 2, 0),
        (5, 4, 1, 1),
    ];
    assert_eq!(found, expected);

    let face = 3f64.sqrt() / 2.0;
    for (row, edges) in rows.iter().zip([7.0, 3.0, 3.0, 4.0, 0.0, 4.0]) {
        assert_close(row.boundary_length, edges * 2f64.sqrt());
        assert_close(row.quality.area, row.triangles as f64 * face);
        assert_close(row.quality.smallest, 1.0);
        assert_close(row.quality.mean, 1.0);
        assert_close(row.quality.mean_smallest_angle, 60.0);
        assert_eq!(row.quality.share_under_30, 0.0);
        assert_eq!(row.quality.valence_567, 0.0);
    }
}

#[test]
fn thickness_is_told_of_the_points_where_it_is_known() {
    let closed = table()[4].thickness.expect("known");
    // 3, 3, 5, 5, 5: the first point's is not known.
    assert_close(closed.mean, 4.2);
    for (found, expected) in closed.quantiles.iter().zip([3.0, 3.0, 5.0, 5.0, 5.0]) {
        assert_close(*found, expected);
    }
}

#[test]
fn a_mesh_without_arrays_has_its_total() {
    let (points, triangles) = octahedron(0.0, 0, 3);
    let mesh = TriangleMesh {
        points: &points,
        triangles: &triangles,
        ..TriangleMesh::default()
    };
    let rows = statistics(&mesh).expect("a good mesh");
    assert_eq!(rows.len(), 1);
    assert_eq!((rows[0].scope, rows[0].thickness), (Scope::Total, None));
    assert_eq!(
        statistics(&TriangleMesh::default()).expect("empty")[0].points,
        0
    );
}

#[test]
fn badly_shaped_triangles_are_counted() {
    // Angles of 120° and more, and of 30° and less, at the ends of the ranges.
    let height = (150f64.to_radians() / 2.0).tan().recip();
    let points = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, height, 0.0]];
    let mesh = TriangleMesh {
        points: &points,
        triangles: &[[0, 1, 2]],
        ..TriangleMesh::default()
    };
    let quality = statistics(&mesh).expect("a good mesh")[0].quality;
    assert_close(quality.share_under_30, 2.0 / 3.0);
    assert_close(quality.share_over_120, 1.0 / 3.0);
    assert_close(quality.mean_smallest_angle, 15.0);
}

#[test]
fn edges_of_many_triangles_and_pinched_points_are_no_problem() {
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let mesh = TriangleMesh {
        points: &points,
        triangles: &[[0, 1, 2], [0, 1, 3], [0, 1, 4], [2, 2, 2]],
        ..TriangleMesh::default()
    };
    let row = &statistics(&mesh).expect("measured")[0];
    assert_eq!((row.points, row.triangles, row.boundary_loops), (5, 4, 1));
}

#[test]
fn what_cannot_be_measured_is_an_error_that_says_why() {
    let (points, triangles) = octahedron(0.0, 0, 0);
    let good = TriangleMesh {
        points: &points,
        triangles: &triangles,
        ..TriangleMesh::default()
    };
    let refused = |mesh: &TriangleMesh, word: &str| {
        let error = statistics(mesh).expect_err("refused");
        assert!(matches!(error, Error::Triangles(_)));
        assert!(error.to_string().contains(word), "{error}");
    };
    for bad in [6, -1] {
        let triangles = [[0, 1, bad]];
        refused(
            &TriangleMesh {
                triangles: &triangles,
                ..good
            },
            "uses point",
        );
    }
    let mut no_number = points.clone();
    no_number[3][1] = f64::NAN;
    refused(
        &TriangleMesh {
            points: &no_number,
            ..good
        },
        "point 3",
    );
    refused(
        &TriangleMesh {
            labels: Some(&[1]),
            ..good
        },
        "label",
    );
    refused(
        &TriangleMesh {
            components: Some(&[]),
            ..good
        },
        "component",
    );
    refused(
        &TriangleMesh {
            thickness: Some(&[1.0]),
            ..good
        },
        "thickness",
    );
}
