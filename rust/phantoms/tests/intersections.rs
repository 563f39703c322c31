//! The checker of self-intersections: sees each kind, under every affine map that integers can
//! stand exactly, and none in clean meshes.

use phantoms::{self_intersections, Dice};

type Points = Vec<[i64; 3]>;

/// Two triangles by the names of their points, and whether they intersect.
struct Case {
    name: &'static str,
    points: &'static [[i64; 3]],
    triangles: [[u32; 3]; 2],
    intersect: bool,
}

const APART: [[u32; 3]; 2] = [[0, 1, 2], [3, 4, 5]];
const AT_A_VERTEX: [[u32; 3]; 2] = [[0, 1, 2], [0, 3, 4]];
const AT_AN_EDGE: [[u32; 3]; 2] = [[0, 1, 2], [1, 0, 3]];

const CASES: &[Case] = &[
    Case {
        name: "an edge pierces a face",
        points: &[
            [0, 0, 0],
            [9, 0, 0],
            [0, 9, 0],
            [2, 2, -1],
            [3, 2, 5],
            [9, 9, 5],
        ],
        triangles: APART,
        intersect: true,
    },
    Case {
        name: "an edge passes beside a face",
        points: &[
            [0, 0, 0],
            [9, 0, 0],
            [0, 9, 0],
            [5, 5, -1],
            [5, 5, 5],
            [9, 9, 5],
        ],
        triangles: APART,
        intersect: false,
    },
    Case {
        name: "a vertex touches a face",
        points: &[
            [0, 0, 0],
            [9, 0, 0],
            [0, 9, 0],
            [2, 2, 0],
            [3, 2, 5],
            [9, 9, 5],
        ],
        triangles: APART,
        intersect: true,
    },
    Case {
        name: "a vertex ends just above a face",
        points: &[
            [0, 0, 0],
            [90, 0, 0],
            [0, 90, 0],
            [20, 20, 1],
            [30, 20, 50],
            [90, 90, 50],
        ],
        triangles: APART,
        intersect: false,
    },
    Case {
        name: "edges touch in space",
        points: &[
            [0, 0, 0],
            [8, 0, 0],
            [0, 8, 0],
            [4, -1, -1],
            [4, 1, 1],
            [4, -9, 9],
        ],
        triangles: APART,
        intersect: true,
    },
    Case {
        name: "two points in one place",
        points: &[
            [0, 0, 0],
            [9, 0, 0],
            [0, 9, 0],
            [0, 0, 0],
            [-3, 2, 5],
            [-9, 9, 5],
        ],
        triangles: APART,
        intersect: true,
    },
    Case {
        name: "parallel",
        points: &[
            [0, 0, 0],
            [9, 0, 0],
            [0, 9, 0],
            [0, 0, 1],
            [9, 0, 1],
            [0, 9, 1],
        ],
        triangles: APART,
        intersect: false,
    },
    Case {
        name: "in one plane, crossing",
        points: &[
            [0, 0, 0],
            [9, 0, 0],
            [0, 9, 0],
            [-1, 3, 0],
            [9, 3, 0],
            [9, 4, 0],
        ],
        triangles: APART,
        intersect: true,
    },
    Case {
        name: "in one plane, one within the other",
        points: &[
            [0, 0, 0],
            [9, 0, 0],
            [0, 9, 0],
            [1, 1, 0],
            [2, 1, 0],
            [1, 2, 0],
        ],
        triangles: APART,
        intersect: true,
    },
    Case {
        name: "in one plane, apart",
        points: &[
            [0, 0, 0],
            [9, 0, 0],
            [0, 9, 0],
            [9, 9, 0],
            [9, 1, 0],
            [1, 9, 0],
        ],
        triangles: APART,
        intersect: false,
    },
    Case {
        name: "neighbours at a vertex, one pierces the other",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0], [3, 3, -3], [3, 3, 4]],
        triangles: AT_A_VERTEX,
        intersect: true,
    },
    Case {
        name: "neighbours at a vertex, one touches the other's face",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0], [3, 3, 0], [3, 3, 4]],
        triangles: AT_A_VERTEX,
        intersect: true,
    },
    Case {
        name: "neighbours at a vertex, edges along each other",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0], [4, 0, 0], [3, -3, 4]],
        triangles: AT_A_VERTEX,
        intersect: true,
    },
    Case {
        name: "neighbours at a vertex, folded flat onto each other",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0], [2, 1, 0], [1, 2, 0]],
        triangles: AT_A_VERTEX,
        intersect: true,
    },
    Case {
        name: "neighbours at a vertex, in one plane",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0], [-9, 0, 0], [-1, -9, 0]],
        triangles: AT_A_VERTEX,
        intersect: false,
    },
    Case {
        name: "neighbours at a vertex, one standing on the other",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0], [3, 3, 4], [1, 3, 4]],
        triangles: AT_A_VERTEX,
        intersect: false,
    },
    Case {
        name: "neighbours at an edge, folded flat onto each other",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0], [3, 2, 0]],
        triangles: AT_AN_EDGE,
        intersect: true,
    },
    Case {
        name: "neighbours at an edge, nearly folded",
        points: &[[0, 0, 0], [900, 0, 0], [0, 900, 0], [300, 200, 1]],
        triangles: AT_AN_EDGE,
        intersect: false,
    },
    Case {
        name: "neighbours at an edge, in one plane",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0], [9, -9, 0]],
        triangles: AT_AN_EDGE,
        intersect: false,
    },
    Case {
        name: "the same triangle twice",
        points: &[[0, 0, 0], [9, 0, 0], [0, 9, 0]],
        triangles: [[0, 1, 2], [2, 0, 1]],
        intersect: true,
    },
];

/// An invertible affine map of integers; its determinant is 1 or −1, so nothing collapses.
fn affine(random: &mut fastrand::Rng) -> impl Fn([i64; 3]) -> [i64; 3] {
    let mut rows = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    for _ in 0..4 {
        let (i, j) = (random.usize(..3), random.usize(1..3));
        let (i, j) = (i, (i + j) % 3);
        let factor = random.i64(-3..=3);
        rows[i] = std::array::from_fn(|k| rows[i][k] + factor * rows[j][k]);
    }
    random.shuffle(&mut rows);
    let move_by = [(); 3].map(|()| random.i64(-500..500));
    move |p| std::array::from_fn(|r| (0..3).map(|k| rows[r][k] * p[k]).sum::<i64>() + move_by[r])
}

fn as_floats(points: &[[i64; 3]]) -> Vec<[f32; 3]> {
    let limit = 1 << 24;
    assert!(points.as_flattened().iter().all(|v| v.abs() < limit));
    points.iter().map(|p| p.map(|v| v as f32)).collect()
}

#[test]
fn each_kind_is_told_under_any_affine_map() {
    let mut random = fastrand::Rng::with_seed(5);
    for case in CASES {
        for _ in 0..200 {
            let map = affine(&mut random);
            let points: Points = case.points.iter().map(|&p| map(p)).collect();
            let mut triangles = case.triangles;
            triangles
                .iter_mut()
                .for_each(|t| t.rotate_left(random.usize(..3)));
            if random.bool() {
                triangles[0].swap(0, 1);
            }
            if random.bool() {
                triangles.swap(0, 1);
            }
            let found = self_intersections(&as_floats(&points), &triangles);
            let expected: &[[u32; 2]] = if case.intersect { &[[0, 1]] } else { &[] };
            assert_eq!(found, expected, "{}: {points:?} {triangles:?}", case.name);
        }
    }
}

/// Whether a plane separates two triangles strictly, tried along every direction that can; exact.
fn separable(a: [[i64; 3]; 3], b: [[i64; 3]; 3]) -> bool {
    let sub = |p: [i64; 3], q: [i64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let cross = |u: [i64; 3], v: [i64; 3]| {
        [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3])
    };
    let edges = |t: [[i64; 3]; 3]| [0, 1, 2].map(|i| sub(t[(i + 1) % 3], t[i]));
    let (ea, eb) = (edges(a), edges(b));
    let (na, nb) = (cross(ea[0], ea[1]), cross(eb[0], eb[1]));
    let mut axes = vec![na, nb];
    for u in ea {
        axes.push(cross(na, u));
        axes.extend(eb.map(|v| cross(u, v)));
    }
    axes.extend(eb.map(|v| cross(nb, v)));
    axes.into_iter().any(|axis| {
        let along = |t: [[i64; 3]; 3]| {
            let d = t.map(|p| p[0] * axis[0] + p[1] * axis[1] + p[2] * axis[2]);
            (d[0].min(d[1]).min(d[2]), d[0].max(d[1]).max(d[2]))
        };
        let ((a0, a1), (b0, b1)) = (along(a), along(b));
        a1 < b0 || b1 < a0
    })
}

#[test]
fn separate_triangles_agree_with_separating_planes() {
    let mut random = fastrand::Rng::with_seed(11);
    let (mut met, mut tried) = (0, 0);
    while tried < 200_000 {
        // A coarse lattice, so that touching and lying in one plane are common.
        let side = random.i64(2..5);
        let points: Points = (0..6)
            .map(|_| [(); 3].map(|()| random.i64(0..=side)))
            .collect();
        let [a, b] = APART.map(|t| t.map(|v| points[v as usize]));
        let area = |t: [[i64; 3]; 3]| {
            let e = |i: usize, k: usize| t[i][k] - t[0][k];
            (0..3).any(|k| e(1, k) * e(2, (k + 1) % 3) != e(1, (k + 1) % 3) * e(2, k))
        };
        if !area(a) || !area(b) {
            continue;
        }
        tried += 1;
        let found = !self_intersections(&as_floats(&points), &APART).is_empty();
        assert_eq!(found, !separable(a, b), "{points:?}");
        met += usize::from(found);
    }
    assert!(met > tried / 10 && met < tried * 9 / 10, "{met}");
}

/// A closed surface of rings by columns, its points moved by a rotation.
fn turned_torus(rings: u32, columns: u32, seed: u64) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let rotation = Dice::new("torus", seed).rotation();
    let turn = |n: u32, of: u32| (f64::from(n) / f64::from(of) * std::f64::consts::TAU).sin_cos();
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for j in 0..rings {
        for i in 0..columns {
            let ((sj, cj), (si, ci)) = (turn(j, rings), turn(i, columns));
            let r = 40.0 + 15.0 * ci;
            let p = [r * cj, r * sj, 15.0 * si];
            points.push(rotation.map(|row| (0..3).map(|k| row[k] * p[k]).sum::<f64>() as f32));
            let at = |di: u32, dj: u32| (i + di) % columns + (j + dj) % rings * columns;
            let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (points, triangles)
}

#[test]
fn clean_meshes_have_none_and_planted_ones_are_found() {
    for seed in 0..10 {
        let (mut points, mut triangles) = turned_torus(120, 60, seed);
        assert_eq!(self_intersections(&points, &triangles), [[0u32; 2]; 0]);

        // A vertex pushed through the opposite wall, a flipped pair, a triangle laid across.
        let opposite = points[30 + 60 * 7];
        points[60 * 7] = std::array::from_fn(|k| 1.3 * opposite[k] - 0.3 * points[60 * 7][k]);
        assert!(!self_intersections(&points, &triangles).is_empty());

        let (points, _) = turned_torus(120, 60, seed);
        triangles.push([0, 60 * 40, 60 * 80]);
        let across = triangles.len() as u32 - 1;
        let found = self_intersections(&points, &triangles);
        assert!(found.len() > 50 && found.iter().all(|pair| pair[1] == across));
    }
}

#[test]
fn a_large_mesh_takes_seconds() {
    let (points, triangles) = turned_torus(775, 387, 3);
    assert!(triangles.len() > 590_000);
    let start = std::time::Instant::now();
    assert!(self_intersections(&points, &triangles).is_empty());
    let seconds = start.elapsed().as_secs_f64();
    println!("{} triangles in {seconds:.1} s", triangles.len());
    assert!(seconds < 60.0, "{seconds} s");
}
