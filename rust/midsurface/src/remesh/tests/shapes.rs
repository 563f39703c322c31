//! Meshes of known surfaces, made of poor triangles.

use crate::grid::{unit, Vec3};

/// A mesh.
#[derive(Clone)]
pub(super) struct Shape {
    pub points: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// A small generator of random numbers (splitmix64), so that a seed gives the same mesh anywhere.
pub(super) struct Random(pub u64);

impl Random {
    /// Uniform between −1 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A grid of n × m quadrilaterals whose points are jittered by up to 0.24 of a cell (more would
/// fold), each cut along a random diagonal. `place` takes jittered grid coordinates; a direction
/// may be closed, and is not jittered across an open end.
pub(super) fn grid(
    [n, m]: [usize; 2],
    closed: [bool; 2],
    seed: u64,
    place: impl Fn(f64, f64) -> Vec3,
) -> Shape {
    let mut random = Random(seed);
    let count = [n + usize::from(!closed[0]), m + usize::from(!closed[1])];
    let mut points = Vec::new();
    for j in 0..count[1] {
        for i in 0..count[0] {
            let mut at = [i as f64, j as f64];
            for k in 0..2 {
                let last = [n, m][k] as f64;
                let fixed = !closed[k] && (at[k] == 0.0 || at[k] == last);
                at[k] += if fixed { 0.0 } else { 0.24 * random.next() };
            }
            points.push(place(at[0], at[1]));
        }
    }
    let number = |i: usize, j: usize| (j % count[1] * count[0] + i % count[0]) as u32;
    let mut triangles = Vec::new();
    for j in 0..m {
        for i in 0..n {
            let [a, b] = [number(i, j), number(i + 1, j)];
            let [d, c] = [number(i, j + 1), number(i + 1, j + 1)];
            triangles.extend(if random.next() > 0.0 {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            });
        }
    }
    Shape { points, triangles }
}

/// A sphere around the origin: a cube of jittered squares, blown up.
pub(super) fn sphere(radius: f64, seed: u64) -> Shape {
    let n = (1.6 * radius) as usize;
    let mut random = Random(seed);
    let mut sphere = Shape {
        points: Vec::new(),
        triangles: Vec::new(),
    };
    let mut number = std::collections::HashMap::new();
    for axis in 0..3 {
        for side in [0, n] {
            for i in 0..n {
                for j in 0..n {
                    let mut corner = |i: usize, j: usize| {
                        let mut key = [0; 3];
                        (key[axis], key[(axis + 1) % 3], key[(axis + 2) % 3]) = (side, i, j);
                        *number.entry(key).or_insert_with(|| {
                            let jittered = key.map(|k| {
                                let at = k as f64 + 0.24 * random.next();
                                (std::f64::consts::FRAC_PI_4 * (2.0 * at / n as f64 - 1.0)).tan()
                            });
                            sphere.points.push(unit(jittered).map(|v| radius * v));
                            sphere.points.len() as u32 - 1
                        })
                    };
                    let (a, b) = (corner(i, j), corner(i + 1, j));
                    let (c, d) = (corner(i + 1, j + 1), corner(i, j + 1));
                    let mut two = [[a, b, c], [a, c, d]];
                    if side == 0 {
                        two.iter_mut().for_each(|t| t.swap(1, 2));
                    }
                    sphere.triangles.extend(two);
                }
            }
        }
    }
    sphere
}

/// A torus around z.
pub(super) fn torus(radius: f64, tube: f64, seed: u64) -> Shape {
    let turn = |t: f64, n: usize| std::f64::consts::TAU * t / n as f64;
    let n = (6.5 * radius) as usize;
    let m = (6.5 * tube) as usize;
    grid([n, m], [true, true], seed, |u, v| {
        let (u, v) = (turn(u, n), turn(v, m));
        let r = radius + tube * v.cos();
        [r * u.cos(), r * u.sin(), tube * v.sin()]
    })
}

/// An open tube around z with a rim at each end.
pub(super) fn tube(radius: f64, length: usize, seed: u64) -> Shape {
    let n = (6.5 * radius) as usize;
    grid([n, length], [true, false], seed, |u, v| {
        let u = std::f64::consts::TAU * u / n as f64;
        [radius * u.cos(), radius * u.sin(), v]
    })
}

/// A flat ring: a plane with a round hole and a round rim.
pub(super) fn ring(inner: f64, outer: f64, seed: u64) -> Shape {
    let n = (4.0 * outer) as usize;
    let m = (1.2 * (outer - inner)) as usize;
    grid([n, m], [true, false], seed, |u, v| {
        let u = -std::f64::consts::TAU * u / n as f64;
        let r = inner + (outer - inner) * v / m as f64;
        [r * u.cos(), r * u.sin(), 0.0]
    })
}

/// A rectangle in the plane z, with its four corners.
pub(super) fn rectangle(n: usize, m: usize, z: f64, seed: u64) -> Shape {
    grid([n, m], [false, false], seed, |u, v| [u, v, z])
}

impl Shape {
    /// Adds another shape.
    pub fn with(mut self, other: Shape) -> Self {
        let first = self.points.len() as u32;
        self.points.extend(other.points);
        let moved = other.triangles.into_iter().map(|t| t.map(|p| p + first));
        self.triangles.extend(moved);
        self
    }

    /// Stretches z.
    pub fn stretched(mut self, factor: f64) -> Self {
        self.points.iter_mut().for_each(|p| p[2] *= factor);
        self
    }

    /// Moves every point by up to `amount` along each axis.
    pub fn noisy(mut self, amount: f64, seed: u64) -> Self {
        let mut random = Random(seed);
        for v in self.points.iter_mut().flatten() {
            *v += amount * random.next();
        }
        self
    }
}
