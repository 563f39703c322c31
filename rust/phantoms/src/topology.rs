//! How the triangles of a mesh hang together, counted without trust in whoever made it.

use crate::phantom::Topology;
use crate::vector::{cross, dot, Vec3};

/// What is wrong with a mesh's connectivity, and its topology.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Connectivity {
    /// Components (joined by edges), Euler number, boundary loops.
    pub topology: Topology,
    /// Edges of more than two triangles.
    pub nonmanifold_edges: usize,
    /// Vertices whose triangles form more than one fan.
    pub pinched_vertices: usize,
    /// Edges that two triangles run through in the same direction.
    pub misoriented_edges: usize,
    /// Triangles with the vertices of another one.
    pub duplicate_triangles: usize,
    /// Points that no triangle uses.
    pub unused_points: usize,
    /// Share, 0 to 1, of the points inside that have five, six or seven edges; 1 without points.
    pub valence_567: f64,
    /// Share, 0 to 1, of the points inside that have six edges; 1 without points.
    pub valence_6: f64,
}

/// One side of a triangle: its ends in ascending order, the triangle, and whether the triangle
/// runs from the smaller index to the larger one.
#[derive(Clone, Copy)]
struct Side {
    edge: [u32; 2],
    triangle: u32,
    ascending: bool,
}

/// Counts everything, for any list of triangles whose indices are below `point_count`.
pub fn connectivity(point_count: usize, triangles: &[[u32; 3]]) -> Connectivity {
    let sides = sorted_sides(triangles);
    let edges: Vec<&[Side]> = sides.chunk_by(|a, b| a.edge == b.edge).collect();
    let mut used = vec![false; point_count];
    triangles
        .iter()
        .flatten()
        .for_each(|&v| used[v as usize] = true);
    let vertices = used.iter().filter(|&&u| u).count();
    let rim = edges.iter().filter(|sides| sides.len() == 1);
    let (valence_567, valence_6) = valences(point_count, &edges);
    Connectivity {
        topology: Topology {
            components: connected(point_count, edges.iter().map(|sides| sides[0].edge)),
            euler: vertices as i64 - edges.len() as i64 + triangles.len() as i64,
            boundary_loops: connected(point_count, rim.map(|sides| sides[0].edge)),
        },
        nonmanifold_edges: edges.iter().filter(|sides| sides.len() > 2).count(),
        pinched_vertices: count_pinched(point_count, triangles, &edges),
        misoriented_edges: edges
            .iter()
            .filter(|sides| sides.len() == 2 && sides[0].ascending == sides[1].ascending)
            .count(),
        duplicate_triangles: count_duplicates(triangles),
        unused_points: point_count - vertices,
        valence_567,
        valence_6,
    }
}

/// Number of closed components whose triangles are wound so that their normals point inward.
pub fn closed_inward(points: &[Vec3], triangles: &[[u32; 3]]) -> usize {
    let sides = sorted_sides(triangles);
    let mut sets = DisjointSets::new(points.len());
    let mut open = vec![false; points.len()];
    for group in sides.chunk_by(|a, b| a.edge == b.edge) {
        let [a, b] = group[0].edge.map(|v| v as usize);
        sets.join(a, b);
        open[a] |= group.len() == 1;
    }
    let mut open_sets = vec![false; points.len()];
    (0..points.len()).for_each(|v| open_sets[sets.root(v)] |= open[v]);
    // Six times the volume; seen from a point of the component, so that nothing cancels.
    let mut volume = vec![0.0; points.len()];
    for t in triangles {
        let root = sets.root(t[0] as usize);
        let [a, b, c] = t.map(|v| crate::vector::sub(points[v as usize], points[root]));
        volume[root] += dot(a, cross(b, c));
    }
    let closed = volume.iter().zip(&open_sets).filter(|(_, open)| !**open);
    closed.filter(|(volume, _)| **volume < 0.0).count()
}

fn sorted_sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(3 * triangles.len());
    for (triangle, t) in triangles.iter().enumerate() {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            sides.push(Side {
                edge: [a.min(b), a.max(b)],
                triangle: triangle as u32,
                ascending: a < b,
            });
        }
    }
    sides.sort_unstable_by_key(|side| (side.edge, side.triangle));
    sides
}

fn count_duplicates(triangles: &[[u32; 3]]) -> usize {
    let mut sorted = triangles.to_vec();
    sorted.iter_mut().for_each(|t| t.sort_unstable());
    sorted.sort_unstable();
    sorted.windows(2).filter(|pair| pair[0] == pair[1]).count()
}

/// Shares of the points inside with 5 to 7 and with 6 edges.
fn valences(point_count: usize, edges: &[&[Side]]) -> (f64, f64) {
    let mut valence = vec![0u32; point_count];
    let mut on_rim = vec![false; point_count];
    for sides in edges {
        for v in sides[0].edge {
            valence[v as usize] += 1;
            on_rim[v as usize] |= sides.len() == 1;
        }
    }
    let inside: Vec<u32> = valence
        .into_iter()
        .zip(on_rim)
        .filter(|&(valence, rim)| valence > 0 && !rim)
        .map(|(valence, _)| valence)
        .collect();
    if inside.is_empty() {
        return (1.0, 1.0);
    }
    let share = |range: std::ops::RangeInclusive<u32>| {
        inside.iter().filter(|v| range.contains(v)).count() as f64 / inside.len() as f64
    };
    (share(5..=7), share(6..=6))
}

/// Number of connected groups among the vertices of these edges.
fn connected(point_count: usize, edges: impl IntoIterator<Item = [u32; 2]>) -> usize {
    let mut sets = DisjointSets::new(point_count);
    let mut touched = vec![false; point_count];
    for [a, b] in edges {
        sets.join(a as usize, b as usize);
        touched[a as usize] = true;
        touched[b as usize] = true;
    }
    (0..point_count)
        .filter(|&v| touched[v] && sets.root(v) == v)
        .count()
}

/// Corners of a vertex belong to one fan where two triangles share the edge between them.
fn count_pinched(point_count: usize, triangles: &[[u32; 3]], edges: &[&[Side]]) -> usize {
    let corner = |triangle: u32, vertex: u32| {
        let corners = triangles[triangle as usize];
        let place = corners.iter().position(|&v| v == vertex);
        3 * triangle as usize + place.unwrap_or(0)
    };
    let mut fans = DisjointSets::new(3 * triangles.len());
    for sides in edges.iter().filter(|sides| sides.len() == 2) {
        for vertex in sides[0].edge {
            fans.join(
                corner(sides[0].triangle, vertex),
                corner(sides[1].triangle, vertex),
            );
        }
    }
    let mut fan_of: Vec<Option<usize>> = vec![None; point_count];
    let mut pinched = vec![false; point_count];
    for (corner, &vertex) in triangles.as_flattened().iter().enumerate() {
        let fan = fans.root(corner);
        let known = fan_of[vertex as usize].get_or_insert(fan);
        pinched[vertex as usize] |= *known != fan;
    }
    pinched.iter().filter(|&&p| p).count()
}

struct DisjointSets(Vec<usize>);

impl DisjointSets {
    fn new(length: usize) -> Self {
        Self((0..length).collect())
    }

    fn root(&mut self, mut item: usize) -> usize {
        while self.0[item] != item {
            self.0[item] = self.0[self.0[item]];
            item = self.0[item];
        }
        item
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}
