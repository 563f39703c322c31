mod shapes;

use shapes::{rectangle, ring, sphere, torus, tube, Shape};

use super::{remesh, Before, Remeshed};
use crate::execution::{Execution, Quiet};
use crate::grid::{cross, dot, length, sub, unit, Vec3};
use crate::mesh::Mesh;
use crate::reading::components::DisjointSets;
use crate::surface::halfedge::{ends, twins_if_wound, NONE};

fn run(shape: &Shape, edge_length: f64, threads: usize) -> Remeshed {
    let mut quiet = Quiet::default();
    let mut execution = Execution::new(threads, &mut quiet).unwrap();
    remesh(
        &shape.points,
        &shape.triangles,
        (edge_length, Before::Any),
        &mut execution,
    )
    .unwrap()
}

/// Components, Euler number, boundary loops.
fn topology(points: &[Vec3], triangles: &[[u32; 3]]) -> [i64; 3] {
    let mut sets = DisjointSets::new(points.len()).unwrap();
    for t in triangles {
        sets.join(t[0] as usize, t[1] as usize);
        sets.join(t[0] as usize, t[2] as usize);
    }
    let components = (0..points.len()).filter(|&p| sets.find(p) == p).count();
    let twins = twins_if_wound(triangles, points.len()).unwrap();
    let open: Vec<(u32, u32)> = (0..twins.len() as u32)
        .filter(|&e| twins[e as usize] == NONE)
        .map(|e| ends(triangles, e))
        .collect();
    let mut rims = DisjointSets::new(points.len()).unwrap();
    open.iter()
        .for_each(|&(a, b)| rims.join(a as usize, b as usize));
    let mut roots: Vec<usize> = open.iter().map(|e| rims.find(e.0 as usize)).collect();
    roots.sort_unstable();
    roots.dedup();
    let edges = (twins.len() + open.len()) / 2;
    let euler = points.len() as i64 - edges as i64 + triangles.len() as i64;
    [components as i64, euler, roots.len() as i64]
}

/// The result as a mesh, for its checks and figures.
fn mesh(remeshed: &Remeshed) -> Mesh {
    let points = remeshed.points.len();
    Mesh {
        points: remeshed
            .points
            .iter()
            .map(|p| p.map(|v| v as f32))
            .collect(),
        triangles: remeshed.triangles.clone(),
        normals: vec![[0.0, 0.0, 1.0]; points],
        thickness: vec![1.0; points],
        labels: vec![1; remeshed.triangles.len()],
        components: vec![0; remeshed.triangles.len()],
    }
}

/// The points of the boundary.
fn boundary(remeshed: &Remeshed) -> impl Iterator<Item = u32> + '_ {
    let twins = twins_if_wound(&remeshed.triangles, remeshed.points.len()).unwrap();
    let sides = (0..twins.len() as u32).filter(move |&e| twins[e as usize] == NONE);
    sides.map(|e| ends(&remeshed.triangles, e).0)
}

/// Smallest and largest angle, degrees.
fn angles(remeshed: &Remeshed) -> [f64; 2] {
    let mut range = [180.0, 0.0f64];
    for t in &remeshed.triangles {
        for k in 0..3 {
            let [p, q, r] = [0, 1, 2].map(|i| remeshed.points[t[(k + i) % 3] as usize]);
            let angle = dot(unit(sub(q, p)), unit(sub(r, p))).acos().to_degrees();
            range = [range[0].min(angle), range[1].max(angle)];
        }
    }
    range
}

/// Asserts what must hold for any input, and returns the figures.
fn check(shape: &Shape, remeshed: &Remeshed) -> crate::Quality {
    let mesh = mesh(remeshed);
    assert_eq!(mesh.check_invariants(), Ok(()));
    assert_eq!(
        topology(&shape.points, &shape.triangles),
        topology(&remeshed.points, &remeshed.triangles)
    );
    mesh.quality().unwrap()
}

/// Asserts the figures that a smooth surface must reach.
fn check_quality(shape: &Shape, remeshed: &Remeshed) {
    let quality = check(shape, remeshed);
    let [least, most] = angles(remeshed);
    assert!(quality.mean >= 0.93, "{quality:?}");
    assert!(quality.mean_smallest_angle >= 53.5, "{quality:?}");
    assert!(least >= 25.0 && most <= 120.0, "angles {least} to {most}");
    assert_eq!(quality.valence_567, 1.0, "{quality:?}");
}

const STEP: f64 = std::f64::consts::SQRT_2;

#[test]
fn points_lie_on_a_sphere() {
    for (radius, seed) in [(12.0, 1), (24.0, 2)] {
        let shape = sphere(radius, seed);
        let remeshed = run(&shape, STEP, 2);
        check_quality(&shape, &remeshed);
        for p in &remeshed.points {
            assert!((length(*p) - radius).abs() <= 0.02, "{p:?} of {radius}");
        }
    }
}

#[test]
fn closed_and_open_surfaces_are_good() {
    let shapes = [
        torus(24.0, 9.0, 3),
        tube(15.0, 30, 4),
        ring(8.0, 30.0, 5),
        rectangle(30, 40, 0.0, 6),
    ];
    for shape in &shapes {
        check_quality(shape, &run(shape, STEP, 2));
    }
}

#[test]
fn triangles_far_longer_than_edges_do_not_fold() {
    for (stretch, edge_length) in [(30.0, STEP), (12.0, 0.7), (100.0, 20.0)] {
        let shape = tube(15.0, 10, 21).stretched(stretch);
        let remeshed = run(&shape, edge_length, 2);
        check(&shape, &remeshed);
        for t in &remeshed.triangles {
            let [a, b, c] = t.map(|p| remeshed.points[p as usize]);
            let normal = unit(cross(sub(b, a), sub(c, a)));
            let outward = unit([a[0], a[1], 0.0]);
            assert!(dot(normal, outward) > 0.2, "{stretch}: {a:?} {b:?} {c:?}");
        }
    }
}

/// With sides of about 3.5 hardly one is long enough to be split, and no short one can be collapsed.
#[test]
fn lattices_of_long_cells_are_remeshed() {
    for side in [1.3, 2.0, 3.3, 3.5, 3.6] {
        let mut shape = rectangle(40, 30, 0.0, 22);
        for [x, y, _] in &mut shape.points {
            (*x, *y) = (x.round(), side * y.round());
        }
        check_quality(&shape, &run(&shape, STEP, 2));
    }
}

/// Polishing alone leaves a fault in each of these.
#[test]
fn no_fault_is_left() {
    let shapes = [
        ring(15.0, 60.0, 20),
        sphere(44.0, 24),
        torus(40.0, 12.0, 36),
        sphere(44.0, 43),
    ];
    for shape in &shapes {
        check_quality(shape, &run(shape, STEP, 2));
    }
}

#[test]
fn topology_outlasts_any_edge_length() {
    let close = rectangle(40, 30, 0.0, 7)
        .with(rectangle(40, 30, 1.0, 8))
        .with(ring(1.5, 20.0, 9))
        .with(rectangle(60, 2, 5.0, 10))
        .with(sphere(6.0, 11));
    for shape in [close.clone(), close.noisy(0.15, 12)] {
        for edge_length in [0.7, STEP, 5.0, 20.0] {
            check(&shape, &run(&shape, edge_length, 2));
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_mesh() {
    let shape = torus(20.0, 8.0, 13).with(ring(3.0, 25.0, 14));
    let one = run(&shape, STEP, 1);
    for threads in [2, 5] {
        let more = run(&shape, STEP, threads);
        assert_eq!(one.points, more.points);
        assert_eq!(one.triangles, more.triangles);
        assert_eq!(one.origin, more.origin);
    }
}

#[test]
fn rims_and_corners_stay() {
    // The rim of the smaller one is 16 long.
    for [n, m] in [[30, 40], [4, 4]] {
        let remeshed = run(&rectangle(n, m, 0.0, 15), STEP, 2);
        let [width, height] = [n, m].map(|side| side as f64);
        for corner in [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]] {
            let there = |p: &Vec3| [p[0], p[1]] == corner;
            assert!(remeshed.points.iter().any(there), "{corner:?}");
        }
        for p in boundary(&remeshed) {
            let [x, y, _] = remeshed.points[p as usize];
            let off = [x, width - x, y, height - y].map(f64::abs);
            assert!(off.iter().any(|&o| o < 1e-9), "{x} {y}");
        }
    }
}

#[test]
fn triangles_at_rims_are_good() {
    for shape in [ring(6.0, 20.0, 5), ring(9.0, 24.0, 6)] {
        let mut remeshed = run(&shape, STEP, 2);
        let on_rim: Vec<u32> = boundary(&remeshed).collect();
        let is_at_rim = |t: &[u32; 3]| t.iter().any(|p| on_rim.contains(p));
        remeshed.triangles.retain(is_at_rim);
        let quality = mesh(&remeshed).quality().unwrap();
        assert!(quality.mean >= 0.895, "{quality:?}");
    }
}

#[test]
fn origins_lead_back_to_the_input() {
    let shape = sphere(15.0, 16).with(rectangle(20, 20, 0.0, 17));
    let mut sets = DisjointSets::new(shape.points.len()).unwrap();
    for t in &shape.triangles {
        sets.join(t[0] as usize, t[1] as usize);
        sets.join(t[0] as usize, t[2] as usize);
    }
    let remeshed = run(&shape, STEP, 2);
    for t in &remeshed.triangles {
        let mut component = |p: u32| {
            let triangle = remeshed.origin[p as usize].triangle as usize;
            sets.find(shape.triangles[triangle][0] as usize)
        };
        let [a, b, c] = t.map(&mut component);
        assert!(a == b && b == c);
    }
    for (p, origin) in remeshed.points.iter().zip(&remeshed.origin) {
        let corners = shape.triangles[origin.triangle as usize].map(|p| shape.points[p as usize]);
        let weights = origin.weights.map(f64::from);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-5);
        let there: Vec3 = std::array::from_fn(|k| (0..3).map(|i| weights[i] * corners[i][k]).sum());
        assert!(length(sub(*p, there)) < 0.1);
    }
}
