//! Whether triangles touch each other, with some room for rounding.

use crate::grid::{along, cross, dot, length, squared_distance, sub, Vec3};

/// Triangles nearer to each other than this touch, work units: much more than the rounding of
/// coordinates, and less than anybody sees.
pub(crate) const TOUCHING: f64 = 0.004;

/// Whether two triangles have more in common than the points or the edge that they share, or come
/// nearer to each other than `room`.
pub(crate) fn touch(a: [u32; 3], b: [u32; 3], points: &[Vec3], room: f64) -> bool {
    let place = |p: u32| points[p as usize];
    let (s, t) = (a.map(place), b.map(place));
    let opposite = |of: [u32; 3], other: [u32; 3]| {
        let k = of.iter().position(|p| other.contains(p)).unwrap_or(0);
        [place(of[(k + 1) % 3]), place(of[(k + 2) % 3])]
    };
    match a.iter().filter(|p| b.contains(p)).count() {
        0 => {
            let side = |t: [Vec3; 3], i: usize| [t[i], t[(i + 1) % 3]];
            !lies_beside(s, t, room)
                && !lies_beside(t, s, room)
                && (0..3).any(|i| is_near(side(s, i), t, room) || is_near(side(t, i), s, room))
        }
        // Whatever they share beyond the point, the side opposite to it in one of them reaches.
        1 => is_near(opposite(a, b), t, room) || is_near(opposite(b, a), s, room),
        _ => false,
    }
}

/// Whether a triangle lies on one side of another's plane.
fn lies_beside(t: [Vec3; 3], other: [Vec3; 3], room: f64) -> bool {
    let [a, b, c] = other;
    let normal = cross(sub(b, a), sub(c, a));
    let heights = t.map(|p| dot(normal, sub(p, a)));
    let room = room * length(normal);
    heights.iter().all(|&h| h > room) || heights.iter().all(|&h| h < -room)
}

/// Whether a segment touches a triangle.
fn is_near([p, q]: [Vec3; 2], t: [Vec3; 3], room: f64) -> bool {
    let normal = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let [above, below] = [p, q].map(|end| dot(normal, sub(end, t[0])));
    let inside = |p: Vec3| {
        (0..3).all(|i| dot(cross(sub(t[(i + 1) % 3], t[i]), sub(p, t[i])), normal) >= 0.0)
    };
    if above * below < 0.0 && inside(along(p, above / (above - below), sub(q, p))) {
        return true;
    }
    let height = room * length(normal);
    (above.abs() < height && inside(p))
        || (below.abs() < height && inside(q))
        || (0..3).any(|i| squared_gap([p, q], [t[i], t[(i + 1) % 3]]) < room * room)
}

/// Squared distance between two segments (Ericson, "Real-time collision detection", 2005, 5.1.9).
fn squared_gap([p, q]: [Vec3; 2], [r, s]: [Vec3; 2]) -> f64 {
    let (d, e, f) = (sub(q, p), sub(s, r), sub(p, r));
    let (dd, ee, de) = (dot(d, d), dot(e, e), dot(d, e));
    let (df, ef) = (dot(d, f), dot(e, f));
    let share = |a: f64, b: f64| {
        if b > 0.0 {
            (a / b).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let first = share(de * ef - df * ee, dd * ee - de * de);
    let second = share(de * first + ef, ee);
    // The end of the second segment may have been nearer to another place on the first.
    let first = share(de * second - df, dd);
    squared_distance(along(p, first, d), along(r, second, e))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether the triangle of the first three points touches the one of the last three.
    fn meet(points: [Vec3; 6]) -> bool {
        touch([0, 1, 2], [3, 4, 5], &points, TOUCHING)
    }

    #[test]
    fn triangles_that_cross_or_lie_on_each_other_touch() {
        let flat = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let beside = |third: [Vec3; 3]| {
            let [a, b, c] = flat;
            meet([a, b, c, third[0], third[1], third[2]])
        };
        assert!(beside([[0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [5.0, 5.0, 0.5]]));
        assert!(beside([[0.5, 0.5, 0.0], [0.6, 0.5, 0.0], [0.5, 0.6, 0.0]]));
        assert!(beside([
            [0.5, 0.5, 0.001],
            [0.5, 0.5, 2.0],
            [0.5, 1.5, 2.0]
        ]));
        assert!(beside([[-1.0, 1.0, 0.0], [3.0, 1.0, 0.0], [1.0, 4.0, 0.0]]));
        assert!(!beside([[0.5, 0.5, 0.1], [0.5, 0.5, 2.0], [0.5, 1.5, 2.0]]));
        assert!(!beside([[1.2, 1.2, 0.0], [3.0, 1.2, 0.0], [1.2, 3.0, 0.0]]));
        assert!(!beside([
            [1.2, 1.2, -1.0],
            [1.2, 1.2, 1.0],
            [3.0, 3.0, 0.0]
        ]));
    }

    #[test]
    fn neighbours_touch_only_beyond_what_they_share() {
        let mut points = vec![
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
            [-2.0, 0.0, 0.0],
            [0.0, -2.0, 0.0],
        ];
        assert!(!touch([0, 1, 2], [1, 0, 4], &points, TOUCHING));
        assert!(!touch([0, 1, 2], [0, 3, 4], &points, TOUCHING));
        // The last point swings over into the first triangle.
        points[3] = [1.0, 0.5, 0.5];
        points[4] = [1.0, 0.5, -0.5];
        assert!(touch([0, 1, 2], [0, 3, 4], &points, TOUCHING));
    }
}
