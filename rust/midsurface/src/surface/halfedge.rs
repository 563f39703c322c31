//! Half-edges of a triangle list, as arrays: half-edge 3 t + k goes from corner k of triangle t to
//! the next corner.

use crate::buckets::Buckets;
use crate::error::{collected, filled, reserved, zeros, Result};
use crate::execution::Execution;

/// No twin: a boundary.
pub(crate) const NONE: u32 = u32::MAX;

/// Half-edges handed to a worker at a time.
const PIECE: usize = 4096;
/// Half-edges around a point that are looked through one by one; more are sorted.
const MOST_SEARCHED: usize = 64;
/// Passes over the half-edges that [`twins`] makes, for its progress.
pub(crate) const TWIN_PASSES: usize = 1;

/// Start and end point of a half-edge.
pub(crate) fn ends(triangles: &[[u32; 3]], half_edge: u32) -> (u32, u32) {
    let triangle = &triangles[half_edge as usize / 3];
    let k = half_edge as usize % 3;
    (triangle[k], triangle[(k + 1) % 3])
}

/// The next half-edge of the same triangle.
pub(crate) fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 {
        half_edge - 2
    } else {
        half_edge + 1
    }
}

/// The half-edge before in the same triangle.
pub(crate) fn previous(half_edge: u32) -> u32 {
    if half_edge % 3 == 0 {
        half_edge + 2
    } else {
        half_edge - 1
    }
}

/// All half-edges, each with its start and end point.
fn half_edges(triangles: &[[u32; 3]]) -> impl Iterator<Item = (u32, u32, u32)> + '_ {
    let of_triangle = |(t, &[a, b, c]): (usize, &[u32; 3])| {
        let first = 3 * t as u32;
        [(first, a, b), (first + 1, b, c), (first + 2, c, a)]
    };
    triangles.iter().enumerate().flat_map(of_triangle)
}

/// The triangles that have a corner among some points, ascending.
pub(crate) fn triangles_at(triangles: &[[u32; 3]], wanted: &[bool]) -> Result<Vec<u32>> {
    let is_there = |t: &u32| {
        let corners = triangles[*t as usize];
        corners.iter().any(|&p| wanted[p as usize])
    };
    collected((0..triangles.len() as u32).filter(is_there))
}

/// A half-edge with start and end, as what is sorted into a bucket: the smaller end p, and with the
/// half-edge the larger one.
fn by_smaller_end((e, a, b): (u32, u32, u32)) -> (u32, (u32, u32)) {
    (a.min(b), (a.max(b), e))
}

/// The other half-edge of each edge that exactly two triangles share, whatever their winding.
pub(crate) fn twins(
    triangles: &[[u32; 3]],
    points: usize,
    execution: &mut Execution,
) -> Result<Vec<u32>> {
    let mut edges = Buckets::new(points, || half_edges(triangles).map(by_smaller_end))?;
    for p in 0..points {
        if edges.of(p).len() > MOST_SEARCHED {
            edges.of_mut(p).sort_unstable();
        }
    }
    let mut twins = zeros(3 * triangles.len())?;
    execution.fill(&mut twins, PIECE, |piece, out| {
        for (i, twin) in out.iter_mut().enumerate() {
            let e = (piece * PIECE + i) as u32;
            let (a, b) = ends(triangles, e);
            let mut around = edges.of(a.min(b) as usize);
            if around.len() > MOST_SEARCHED {
                around = &around[around.partition_point(|(q, _)| *q < a.max(b))..];
                around = &around[..around.partition_point(|(q, _)| *q == a.max(b))];
            }
            let mut others = around.iter().filter(|&&(q, f)| q == a.max(b) && f != e);
            *twin = match (others.next(), others.next()) {
                (Some(&(_, f)), None) => f,
                _ => NONE,
            };
        }
    })?;
    Ok(twins)
}

/// The opposite half-edges of a consistently wound manifold, on the calling thread.
pub(crate) fn twins_if_wound(triangles: &[[u32; 3]], points: usize) -> Result<Vec<u32>> {
    // By their first points: their ends, too.
    let leaving = Buckets::new(points, || {
        half_edges(triangles).map(|(e, a, b)| (a, (b, e)))
    })?;
    let mut twins = reserved(3 * triangles.len())?;
    half_edges(triangles).for_each(|(_, a, b)| {
        let back = leaving.of(b as usize).iter().find(|(end, _)| *end == a);
        twins.push(back.map_or(NONE, |&(_, f)| f));
    });
    Ok(twins)
}

/// The half-edges that leave or enter each point p, with p the smaller end: the larger end and the
/// half-edge, ordered by the larger end.
pub(crate) struct Edges(Buckets<(u32, u32)>);

impl Edges {
    /// Sorts the half-edges into buckets by their smaller end, without hashing.
    pub fn new(triangles: &[[u32; 3]], points: usize) -> Result<Self> {
        Self::of_half_edges(points, || half_edges(triangles))
    }

    /// Those of some triangles only.
    pub fn of_triangles(triangles: &[[u32; 3]], wanted: &[u32], points: usize) -> Result<Self> {
        Self::of_half_edges(points, || {
            let all = wanted.iter().flat_map(|&t| 3 * t..3 * t + 3);
            all.map(|e| {
                let (a, b) = ends(triangles, e);
                (e, a, b)
            })
        })
    }

    fn of_half_edges<I: Iterator<Item = (u32, u32, u32)>>(
        points: usize,
        half_edges: impl Fn() -> I,
    ) -> Result<Self> {
        let mut edges = Buckets::new(points, || half_edges().map(by_smaller_end))?;
        for p in 0..points {
            edges.of_mut(p).sort_unstable();
        }
        Ok(Self(edges))
    }

    /// All edges, each as its smaller end, its larger end and its half-edges.
    pub fn groups(&self) -> impl Iterator<Item = (u32, u32, &[(u32, u32)])> {
        (0..self.0.count()).flat_map(move |p| {
            self.0
                .of(p)
                .chunk_by(|a, b| a.0 == b.0)
                .map(move |group| (p as u32, group[0].0, group))
        })
    }

    /// The other half-edge of each edge that exactly two triangles share, whatever their winding.
    pub fn twins(&self) -> Result<Vec<u32>> {
        let mut twins = filled(NONE, self.0.all().len())?;
        for (_, _, group) in self.groups() {
            if let [(_, e), (_, f)] = *group {
                twins[e as usize] = f;
                twins[f as usize] = e;
            }
        }
        Ok(twins)
    }
}

/// The half-edges that leave each point.
pub(crate) struct Fans(Buckets<u32>);

impl Fans {
    /// Sorts the half-edges into buckets by their origin.
    pub fn new(triangles: &[[u32; 3]], points: usize) -> Result<Self> {
        let leaving = || half_edges(triangles).map(|(e, a, _)| (a, e));
        Ok(Self(Buckets::new(points, leaving)?))
    }

    /// Those of some points only; the others have no half-edges. `around` are the triangles that have
    /// a corner there, ascending, and maybe others.
    pub fn of_points(triangles: &[[u32; 3]], around: &[u32], wanted: &[bool]) -> Result<Self> {
        let leaving = || {
            let half_edges = around.iter().flat_map(|&t| 3 * t..3 * t + 3);
            let leaving = half_edges.map(|e| (ends(triangles, e).0, e));
            leaving.filter(|(p, _)| wanted[*p as usize])
        };
        Ok(Self(Buckets::new(wanted.len(), leaving)?))
    }

    /// Whether a point of a consistently wound manifold is on the boundary: not every neighbour is
    /// found both ways around.
    pub fn is_boundary(&self, triangles: &[[u32; 3]], p: u32) -> bool {
        let corner = |e: u32| ends(triangles, e).0;
        let half_edges = || self.of(p).iter().copied();
        half_edges().any(|e| half_edges().all(|f| corner(previous(f)) != corner(next(e))))
    }

    /// The half-edges that leave a point.
    pub fn of(&self, p: u32) -> &[u32] {
        self.0.of(p as usize)
    }

    /// The points that share an edge with each point, each once.
    pub fn neighbours(
        &self,
        triangles: &[[u32; 3]],
        execution: &mut Execution,
    ) -> Result<Buckets<u32>> {
        let corner = |e: u32| ends(triangles, e).0;
        // On a manifold a point has at most one neighbour more than triangles.
        let most = 3 * triangles.len() + self.0.count();
        let add = |p: usize, neighbours: &mut Vec<u32>| {
            let first = neighbours.len();
            let half_edges = self.0.of(p);
            neighbours.extend(half_edges.iter().map(|&e| corner(next(e))));
            // Where the point is on a boundary, one of them is only found backwards.
            for q in half_edges.iter().map(|&e| corner(previous(e))) {
                if !neighbours[first..].contains(&q) {
                    neighbours.push(q);
                }
            }
        };
        Buckets::fill(self.0.count(), most, add, execution)
    }

    /// The opposite half-edge of a half-edge of a consistently wound manifold, or [`NONE`].
    pub fn twin(&self, triangles: &[[u32; 3]], e: u32) -> u32 {
        let (a, b) = ends(triangles, e);
        let back = |&&f: &&u32| ends(triangles, f).1 == a;
        self.of(b).iter().find(back).copied().unwrap_or(NONE)
    }
}

/// Number of half-edges that a walk around a point can take at most, as a bound for its loop.
pub(crate) const MOST_AROUND: usize = 1 << 20;
