//! A lattice of long cells → no lattice.
//!
//! What lies along a grid of voxels that are no cubes comes as a lattice of equal cells. In that all edges
//! of a kind are as long, so that a step changes all of them or none, and a lattice is at rest when its
//! points move to the middle of their neighbours, though its triangles may be poor. Its points move a little
//! within the surface first, each its own way, which leaves no such state to end in. All others stay, but
//! for those of a surface of rows: of these the lattice may be bent.

use super::blocks::Surface;
use super::reference::Reference;
use super::Before;
use crate::error::{filled, Result};
use crate::execution::Execution;
use crate::grid::{squared_distance, sub, Vec3};
use crate::hash::mixed;

/// How far points move along each axis at most, as a share of their shortest edge.
const SHARE: f64 = 0.3;
/// The sum of the ways from a point of a lattice to its neighbours, of each of them from both triangles
/// beside it, is shorter than this share of its shortest edge.
const AT_REST: f64 = 0.1;
/// A cell's diagonal is so many times as long as its shorter side, or the cell is taken for a square. Of
/// squares come good triangles.
const LONG: f64 = 1.6;
/// A point's way follows from its place, to such a share of a unit: all tiles of a component have the same.
const PLACES: f64 = 64.0;
/// Points handed to a worker at a time.
const PIECE: usize = 4096;

/// What is known of the edges at a point.
#[derive(Clone, Copy)]
struct Edges {
    shortest_squared: f64,
    longest_squared: f64,
    sum: Vec3,
}

/// Moves the inner points of lattices, or all of a surface of rows, which are on the reference and stay on it.
pub(super) fn jitter(
    surface: &mut Surface,
    before: Before,
    reference: &Reference,
    execution: &mut Execution,
) -> Result<()> {
    let is_all = matches!(before, Before::Rows);
    let edges = edges(surface)?;
    execution.fill(&mut surface.vertices, PIECE, |piece, vertices| {
        for (vertex, edges) in vertices.iter_mut().zip(&edges[PIECE * piece..]) {
            let is_inner = !vertex.is_boundary() && !vertex.is_frozen();
            if is_inner && (is_all || edges.are_a_long_lattice()) {
                let step = SHARE * edges.shortest_squared.sqrt();
                let way = way(vertex.point).map(|v| step * v);
                let target = std::array::from_fn(|k| vertex.point[k] + way[k]);
                *vertex = reference.vertex(vertex.at, target);
            }
        }
    })
}

impl Edges {
    fn are_a_long_lattice(&self) -> bool {
        self.longest_squared > LONG * LONG * self.shortest_squared
            && squared_distance(self.sum, [0.0; 3]) < AT_REST * AT_REST * self.shortest_squared
    }
}

fn edges(surface: &Surface) -> Result<Vec<Edges>> {
    let none = Edges {
        shortest_squared: f64::INFINITY,
        longest_squared: 0.0,
        sum: [0.0; 3],
    };
    let mut edges = filled(none, surface.vertices.len())?;
    for [a, b, c] in &surface.triangles {
        for (p, q) in [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)] {
            let [from, to] = [p, q].map(|p| surface.vertices[*p as usize].point);
            let way = sub(to, from);
            let squared = squared_distance(to, from);
            let edges = &mut edges[*p as usize];
            edges.shortest_squared = edges.shortest_squared.min(squared);
            edges.longest_squared = edges.longest_squared.max(squared);
            edges.sum = std::array::from_fn(|k| edges.sum[k] + way[k]);
        }
    }
    Ok(edges)
}

/// A place's own way, from −1 to 1 along each axis.
fn way(place: Vec3) -> Vec3 {
    let place = place.map(|v| (PLACES * v).round() as i64 as u64);
    std::array::from_fn(|k| {
        let bits = mixed(place.into_iter().chain([k as u64])) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    })
}
