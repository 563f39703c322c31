//! Half-edges of a triangle list, as arrays: half-edge 3 t + k goes from corner k of triangle t to
//! the next corner.

use crate::buckets::Buckets;
use crate::error::Result;

/// No twin: a boundary.
pub(crate) const NONE: u32 = u32::MAX;

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

/// The half-edges that leave or enter each point p, with p the smaller end: the larger end and the
/// half-edge, ordered by the larger end.
pub(crate) struct Edges(Buckets<(u32, u32)>);

impl Edges {
    /// Sorts the half-edges into buckets by their smaller end, without hashing.
    pub fn new(triangles: &[[u32; 3]], points: usize) -> Self {
        let mut edges = Buckets::new(points, || {
            (0..3 * triangles.len() as u32).map(|e| {
                let (a, b) = ends(triangles, e);
                (a.min(b), (a.max(b), e))
            })
        });
        for p in 0..points {
            edges.of_mut(p).sort_unstable();
        }
        Self(edges)
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
    pub fn twins(&self) -> Vec<u32> {
        let mut twins = vec![NONE; self.0.all().len()];
        for (_, _, group) in self.groups() {
            if let [(_, e), (_, f)] = *group {
                twins[e as usize] = f;
                twins[f as usize] = e;
            }
        }
        twins
    }
}

/// The half-edges that leave each point.
pub(crate) struct Fans(Buckets<u32>);

impl Fans {
    /// Sorts the half-edges into buckets by their origin.
    pub fn new(triangles: &[[u32; 3]], points: usize) -> Self {
        Self(Buckets::new(points, || {
            (0..3 * triangles.len() as u32).map(|e| (ends(triangles, e).0, e))
        }))
    }

    /// Those of some points only; the others have no half-edges.
    pub fn of_points(triangles: &[[u32; 3]], wanted: &[bool]) -> Self {
        Self(Buckets::new(wanted.len(), || {
            let half_edges = (0..3 * triangles.len() as u32).map(|e| (ends(triangles, e).0, e));
            half_edges.filter(|(p, _)| wanted[*p as usize])
        }))
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
    pub fn neighbours(&self, triangles: &[[u32; 3]]) -> Result<Buckets<u32>> {
        let corner = |e: u32| ends(triangles, e).0;
        // On a manifold a point has at most one neighbour more than triangles.
        let most = 3 * triangles.len() + self.0.count();
        Buckets::fill(self.0.count(), most, |p, neighbours| {
            let first = neighbours.len();
            let half_edges = self.0.of(p);
            neighbours.extend(half_edges.iter().map(|&e| corner(next(e))));
            // Where the point is on a boundary, one of them is only found backwards.
            for q in half_edges.iter().map(|&e| corner(previous(e))) {
                if !neighbours[first..].contains(&q) {
                    neighbours.push(q);
                }
            }
        })
    }

    /// The opposite half-edge of a half-edge of a consistently wound manifold, or [`NONE`].
    pub fn twin(&self, triangles: &[[u32; 3]], e: u32) -> u32 {
        let (a, b) = ends(triangles, e);
        let back = |&&f: &&u32| ends(triangles, f).1 == a;
        self.of(b).iter().find(back).copied().unwrap_or(NONE)
    }

    /// The opposite half-edges of all.
    pub fn twins(&self, triangles: &[[u32; 3]]) -> Vec<u32> {
        (0..3 * triangles.len() as u32)
            .map(|e| self.twin(triangles, e))
            .collect()
    }
}

/// Number of half-edges that a walk around a point can take at most, as a bound for its loop.
pub(crate) const MOST_AROUND: usize = 1 << 20;
