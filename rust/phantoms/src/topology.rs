//! How the triangles of a mesh hang together, counted without trust in whoever made it.

use std::collections::{HashMap, HashSet};

use crate::phantom::Topology;

/// What is wrong with a mesh's connectivity, and its topology.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Connectivity {
    /// Components (joined by edges), Euler number, boundary loops.
    pub topology: Topology,
    /// Edges of more than two triangles.
    pub nonmanifold_edges: usize,
    /// Vertices whose triangles form more than one fan.
    pub pinched_vertices: usize,
    /// Edges that two triangles run through in the same direction.
    pub misoriented_edges: usize,
    /// Triangles with the vertices of an earlier one.
    pub duplicate_triangles: usize,
    /// Points that no triangle uses.
    pub unused_points: usize,
}

/// An edge of the mesh: the triangles that have it, and whether each runs from the smaller index
/// to the larger one.
type Edges = HashMap<[u32; 2], Vec<(usize, bool)>>;

/// Counts everything, for any list of triangles whose indices are below `point_count`.
pub fn connectivity(point_count: usize, triangles: &[[u32; 3]]) -> Connectivity {
    let edges = collect_edges(triangles);
    let mut used = vec![false; point_count];
    let mut seen = HashSet::new();
    let mut duplicate_triangles = 0;
    for triangle in triangles {
        triangle.iter().for_each(|&v| used[v as usize] = true);
        let mut sorted = *triangle;
        sorted.sort_unstable();
        duplicate_triangles += usize::from(!seen.insert(sorted));
    }
    let vertices = used.iter().filter(|&&u| u).count();
    let rim: Vec<[u32; 2]> = edges
        .iter()
        .filter(|(_, sides)| sides.len() == 1)
        .map(|(&edge, _)| edge)
        .collect();
    Connectivity {
        topology: Topology {
            components: connected(point_count, edges.keys().copied()),
            euler: vertices as i64 - edges.len() as i64 + triangles.len() as i64,
            boundary_loops: connected(point_count, rim),
        },
        nonmanifold_edges: edges.values().filter(|sides| sides.len() > 2).count(),
        pinched_vertices: count_pinched(point_count, triangles, &edges),
        misoriented_edges: edges
            .values()
            .filter(|sides| sides.len() == 2 && sides[0].1 == sides[1].1)
            .count(),
        duplicate_triangles,
        unused_points: point_count - vertices,
    }
}

fn collect_edges(triangles: &[[u32; 3]]) -> Edges {
    let mut edges = Edges::new();
    for (index, t) in triangles.iter().enumerate() {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            edges
                .entry([a.min(b), a.max(b)])
                .or_default()
                .push((index, a < b));
        }
    }
    edges
}

/// Number of connected groups among the vertices of these edges.
fn connected(point_count: usize, edges: impl IntoIterator<Item = [u32; 2]>) -> usize {
    let mut sets = DisjointSets::new(point_count);
    let mut touched = HashSet::new();
    for [a, b] in edges {
        sets.join(a as usize, b as usize);
        touched.extend([a, b]);
    }
    let roots: HashSet<usize> = touched.into_iter().map(|v| sets.root(v as usize)).collect();
    roots.len()
}

/// Corners of a vertex belong to one fan where two triangles share the edge between them.
fn count_pinched(point_count: usize, triangles: &[[u32; 3]], edges: &Edges) -> usize {
    let corner = |triangle: usize, vertex: u32| {
        let place = triangles[triangle].iter().position(|&v| v == vertex);
        3 * triangle + place.unwrap_or(0)
    };
    let mut fans = DisjointSets::new(3 * triangles.len());
    for (edge, sides) in edges.iter().filter(|(_, sides)| sides.len() == 2) {
        for &vertex in edge {
            fans.join(corner(sides[0].0, vertex), corner(sides[1].0, vertex));
        }
    }
    let mut fans_of = vec![HashSet::new(); point_count];
    for (index, triangle) in triangles.iter().enumerate() {
        for (place, &vertex) in triangle.iter().enumerate() {
            fans_of[vertex as usize].insert(fans.root(3 * index + place));
        }
    }
    fans_of.iter().filter(|fans| fans.len() > 1).count()
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
