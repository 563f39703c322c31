//! Which triangles of a mesh run into each other.
//!
//! Candidates are triangles whose boxes overlap, found in the cells of a grid. What decides are the
//! signs of determinants, computed exactly (J. R. Shewchuk, "Adaptive Precision Floating-Point
//! Arithmetic and Fast Robust Geometric Predicates", 1997), so that there is no tolerance and no
//! doubt: two triangles that touch in a single point count, unless that point is a vertex that both
//! name. Neighbours that share a vertex or an edge count where they have more than that in common:
//! neighbours folded flat onto each other, say. Triangles without an area are looked at as the
//! segments or points that they are.

use robust::{orient2d, orient3d, Coord, Coord3D};

use crate::vector::Vec3;

/// Every pair of triangles, smaller index first, ascending, that have a point in common beyond the
/// vertices and the edge that they share. Triangles that name the same three points count, too.
///
/// # Panics
/// Where a triangle names a point that does not exist.
pub fn self_intersections(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let place = |v: u32| points[v as usize].map(f64::from);
    let mut pairs = Vec::new();
    for_each_candidate(&boxes(points, triangles), |pair| {
        let [a, b] = pair.map(|t| triangles[t as usize]);
        if intersect(a, b, place) {
            pairs.push(pair);
        }
    });
    pairs.sort_unstable();
    pairs
}

/// Lower and upper corner of what encloses a triangle.
type Bounds = [Vec3; 2];

fn boxes(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<Bounds> {
    let of_corners = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| points[v as usize].map(f64::from));
        [
            std::array::from_fn(|k| a[k].min(b[k]).min(c[k])),
            std::array::from_fn(|k| a[k].max(b[k]).max(c[k])),
        ]
    };
    triangles.iter().map(of_corners).collect()
}

/// Calls `look` once for each pair of boxes that overlap, smaller index first. Boxes are sorted
/// into the cells of a grid that they reach into; a pair is looked at in the first cell that both
/// share.
fn for_each_candidate(boxes: &[Bounds], mut look: impl FnMut([u32; 2])) {
    let cells = Cells::fitting(boxes);
    let mut entries: Vec<(u64, u32)> = Vec::new();
    for (index, bounds) in boxes.iter().enumerate() {
        let (lower, upper) = (cells.of(bounds[0]), cells.of(bounds[1]));
        for z in lower[2]..=upper[2] {
            for y in lower[1]..=upper[1] {
                entries.extend((lower[0]..=upper[0]).map(|x| (key([x, y, z]), index as u32)));
            }
        }
    }
    entries.sort_unstable();
    for in_cell in entries.chunk_by(|a, b| a.0 == b.0) {
        for (place, &(cell, a)) in in_cell.iter().enumerate() {
            for &(_, b) in &in_cell[place + 1..] {
                let (p, q) = (&boxes[a as usize], &boxes[b as usize]);
                let overlap = (0..3).all(|k| p[1][k] >= q[0][k] && q[1][k] >= p[0][k]);
                let first_shared = || cells.of(std::array::from_fn(|k| p[0][k].max(q[0][k])));
                if overlap && key(first_shared()) == cell {
                    look([a, b]);
                }
            }
        }
    }
}

/// A number for a cell; no two cells of a mesh have the same one.
fn key([x, y, z]: [u32; 3]) -> u64 {
    u64::from(z) << 42 | u64::from(y) << 21 | u64::from(x)
}

/// A grid of cubes, less than 2²¹ along each axis.
struct Cells {
    origin: Vec3,
    side: f64,
}

impl Cells {
    /// As fine as the mean box, coarser where long boxes would fill too many cells.
    fn fitting(boxes: &[Bounds]) -> Self {
        let mut origin = [f64::INFINITY; 3];
        let mut end = [f64::NEG_INFINITY; 3];
        let mut extent = 0.0;
        for [lower, upper] in boxes {
            origin = std::array::from_fn(|k| origin[k].min(lower[k]));
            end = std::array::from_fn(|k| end[k].max(upper[k]));
            extent += (0..3).map(|k| upper[k] - lower[k]).fold(0.0, f64::max);
        }
        let mean = extent / boxes.len().max(1) as f64;
        let longest = (0..3).map(|k| end[k] - origin[k]).fold(0.0, f64::max);
        let side = (1.5 * mean).max(longest / f64::from(1 << 20));
        let mut cells = Self {
            origin,
            side: if side > 0.0 { side } else { 1.0 },
        };
        // Doubling the side ends: at the size of the whole mesh a box reaches into one cell.
        while boxes.iter().map(|b| cells.filled_by(b)).sum::<f64>() > 16.0 * boxes.len() as f64 {
            cells.side *= 2.0;
        }
        cells
    }

    fn of(&self, p: Vec3) -> [u32; 3] {
        let along = |k: usize| ((p[k] - self.origin[k]) / self.side) as u32;
        [along(0), along(1), along(2)]
    }

    /// About how many cells a box reaches into.
    fn filled_by(&self, bounds: &Bounds) -> f64 {
        let along = |k: usize| 1.0 + (bounds[1][k] - bounds[0][k]) / self.side;
        along(0) * along(1) * along(2)
    }
}

/// Whether two triangles have more in common than the vertices and the edge that they share.
fn intersect(a: [u32; 3], b: [u32; 3], place: impl Fn(u32) -> Vec3) -> bool {
    let shared: Vec<u32> = a.into_iter().filter(|v| b.contains(v)).collect();
    let (p, q) = (a.map(&place), b.map(&place));
    match shared[..] {
        [] => (0..3).any(|i| {
            segment_meets_triangle([p[i], p[(i + 1) % 3]], q)
                || segment_meets_triangle([q[i], q[(i + 1) % 3]], p)
        }),
        // Whatever they share beyond the vertex reaches the edge opposite of it in one of them.
        [v] => {
            segment_meets_triangle(opposite(a, v).map(&place), q)
                || segment_meets_triangle(opposite(b, v).map(&place), p)
        }
        // Two triangles at an edge share more only where one lies flat on the other.
        [v, w] => {
            let apex = |t: [u32; 3]| t.into_iter().find(|&u| u != v && u != w);
            match (apex(a), apex(b)) {
                (Some(x), Some(y)) => folded_flat([v, w, x, y].map(&place)),
                _ => true,
            }
        }
        _ => true,
    }
}

/// The ends of the edge that does not have the vertex.
fn opposite(triangle: [u32; 3], vertex: u32) -> [u32; 2] {
    let i = triangle.iter().position(|&v| v == vertex).unwrap_or(0);
    [triangle[(i + 1) % 3], triangle[(i + 2) % 3]]
}

/// Which side of the plane through a, b and c the point d lies on: a sign, exact.
fn side(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    let coord = |[x, y, z]: Vec3| Coord3D { x, y, z };
    orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// Which side of the line through a and b the point c lies on, seen along an axis; exact.
fn side_along(axis: usize, a: Vec3, b: Vec3, c: Vec3) -> f64 {
    let flat = |p: Vec3| Coord {
        x: p[(axis + 1) % 3],
        y: p[(axis + 2) % 3],
    };
    orient2d(flat(a), flat(b), flat(c))
}

/// An axis along which a triangle does not look flat; `None` for one without an area.
fn open_axis([a, b, c]: [Vec3; 3]) -> Option<usize> {
    (0..3).find(|&axis| side_along(axis, a, b, c) != 0.0)
}

/// Whether the triangles v w x and v w y lie in a plane on the same side of their common edge.
fn folded_flat([v, w, x, y]: [Vec3; 4]) -> bool {
    if side(v, w, x, y) != 0.0 {
        return false;
    }
    match open_axis([v, w, x]) {
        Some(axis) => sign(side_along(axis, v, w, x)) * sign(side_along(axis, v, w, y)) > 0,
        None => true,
    }
}

/// Whether a segment and a triangle have a point in common.
fn segment_meets_triangle([p, q]: [Vec3; 2], t: [Vec3; 3]) -> bool {
    let [a, b, c] = t;
    let (above, below) = (side(a, b, c, p), side(a, b, c, q));
    if sign(above) * sign(below) > 0 {
        return false;
    }
    if above == 0.0 && below == 0.0 {
        return match open_axis(t) {
            Some(axis) => flat_segment_meets_triangle(axis, [p, q], t),
            None => (0..3).any(|i| segments_meet([p, q], [t[i], t[(i + 1) % 3]])),
        };
    }
    // The line through p and q passes all three edges on the same side, or touches them.
    let (first, second) = (side(p, q, a, b), side(p, q, b, c));
    if sign(first) * sign(second) < 0 {
        return false;
    }
    let third = side(p, q, c, a);
    sign(first) * sign(third) >= 0 && sign(second) * sign(third) >= 0
}

/// The same for a segment in the plane of a triangle that is open along the axis.
fn flat_segment_meets_triangle(axis: usize, [p, q]: [Vec3; 2], t: [Vec3; 3]) -> bool {
    let inside = |point: Vec3| {
        let sides = [0, 1, 2].map(|i| side_along(axis, t[i], t[(i + 1) % 3], point));
        sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
    };
    inside(p)
        || inside(q)
        || (0..3).any(|i| flat_segments_meet(axis, [p, q], [t[i], t[(i + 1) % 3]]))
}

/// Whether two segments of a plane, seen along an axis, have a point in common.
fn flat_segments_meet(axis: usize, [p, q]: [Vec3; 2], [a, b]: [Vec3; 2]) -> bool {
    let signs =
        |[u, v]: [Vec3; 2], [x, y]: [Vec3; 2]| [x, y].map(|end| sign(side_along(axis, u, v, end)));
    let ([c, d], [e, f]) = (signs([p, q], [a, b]), signs([a, b], [p, q]));
    if [c, d, e, f] == [0; 4] {
        return boxes_meet([p, q], [a, b]);
    }
    c * d <= 0 && e * f <= 0
}

/// Whether two segments in space have a point in common.
fn segments_meet(first: [Vec3; 2], second: [Vec3; 2]) -> bool {
    side(first[0], first[1], second[0], second[1]) == 0.0
        && boxes_meet(first, second)
        && (0..3).all(|axis| flat_segments_meet(axis, first, second))
}

fn boxes_meet([p, q]: [Vec3; 2], [a, b]: [Vec3; 2]) -> bool {
    (0..3).all(|k| p[k].max(q[k]) >= a[k].min(b[k]) && a[k].max(b[k]) >= p[k].min(q[k]))
}

fn sign(value: f64) -> i32 {
    i32::from(value > 0.0) - i32::from(value < 0.0)
}
