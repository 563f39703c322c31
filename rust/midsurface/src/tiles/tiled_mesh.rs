//! The mesh of a surface that was finished in tiles.
//!
//! Tiles have the points on the seams between them in common: each is told by its part and its place in
//! the finished surface, exact to the bit.

use crate::error::{collected, extend, filled, push, Result};
use crate::mesh::Mesh;
use crate::processes::numbering::Key;
use crate::surface::halfedge::NONE;
use crate::surface::manifold::Surface;
use crate::tiles::seams::{used_by, Patches};

/// The mesh of the own triangles of a tile, or of several.
#[derive(Default)]
pub(crate) struct TileMesh {
    pub mesh: Mesh,
    /// The points that other tiles' triangles use, too, and their numbers.
    pub shared: Vec<(Key, u32)>,
}

impl TileMesh {
    /// Of a mesh, the surface it was made of and which triangles are the tile's own.
    pub fn new(mesh: &Mesh, surface: &Surface, own: &[bool]) -> Result<Self> {
        let is_shared = used_by(surface, |t| !own[t])?;
        let mut number = filled(NONE, mesh.points.len())?;
        let mut tile = Self::default();
        for t in (0..mesh.triangles.len()).filter(|&t| own[t]) {
            let triangle = mesh.triangles[t].map(|p| p as usize);
            for p in triangle {
                if number[p] != NONE {
                    continue;
                }
                number[p] = tile.mesh.points.len() as u32;
                add_point(&mut tile.mesh, mesh, p)?;
                if is_shared[p] {
                    let [x, y, z] = surface.points[p].map(|v| v.to_bits() as i64);
                    let whose = [mesh.components[t], surface.source[p]].map(i64::from);
                    let key = [whose[0], whose[1], x, y, z];
                    push(&mut tile.shared, (key, number[p]))?;
                }
            }
            push(&mut tile.mesh.triangles, triangle.map(|p| number[p]))?;
            push(&mut tile.mesh.labels, mesh.labels[t])?;
            push(&mut tile.mesh.components, mesh.components[t])?;
        }
        Ok(tile)
    }

    /// Turns whole patches.
    pub fn turn(&mut self, patches: &Patches, turns: &[bool]) -> Result<()> {
        let mesh = &mut self.mesh;
        let mut is_turned = filled(false, mesh.normals.len())?;
        for (triangle, (patch, _)) in mesh.triangles.iter_mut().zip(&patches.of_triangle) {
            if turns[*patch as usize] {
                triangle.swap(1, 2);
                triangle.iter().for_each(|&p| is_turned[p as usize] = true);
            }
        }
        let normals = mesh.normals.iter_mut().zip(is_turned);
        for (normal, _) in normals.filter(|(_, turned)| *turned) {
            *normal = normal.map(|v| -v);
        }
        Ok(())
    }
}

/// Appends a point of a mesh to another one.
fn add_point(to: &mut Mesh, from: &Mesh, p: usize) -> Result<()> {
    push(&mut to.points, from.points[p])?;
    push(&mut to.normals, from.normals[p])?;
    push(&mut to.thickness, from.thickness[p])
}

/// The meshes of the own tiles as one, in which shared points are one. These are told apart, with their
/// numbers: other processes' tiles may have them, too.
pub(crate) fn assembled(tiles: Vec<TileMesh>) -> Result<TileMesh> {
    let mut shared: Vec<(Key, usize, u32)> = Vec::new();
    for (number, tile) in tiles.iter().enumerate() {
        let own = tile.shared.iter().map(|&(key, p)| (key, number, p));
        extend(&mut shared, own)?;
    }
    shared.sort_unstable();
    // Of each tile its shared points, each with the place that it has among those of all.
    let mut of_tile: Vec<Vec<(u32, usize)>> = collected(tiles.iter().map(|_| Vec::new()))?;
    let mut known = Vec::new();
    for same in shared.chunk_by(|a, b| a.0 == b.0) {
        for &(_, tile, p) in same {
            push(&mut of_tile[tile], (p, known.len()))?;
        }
        push(&mut known, (same[0].0, NONE))?;
    }
    let mut all = Mesh::default();
    for (tile, shared) in tiles.into_iter().zip(of_tile) {
        let mesh = tile.mesh;
        let mut number = filled(NONE, mesh.points.len())?;
        for &(p, same) in &shared {
            number[p as usize] = known[same].1;
        }
        for (p, number) in number.iter_mut().enumerate().filter(|(_, n)| **n == NONE) {
            *number = all.points.len() as u32;
            add_point(&mut all, &mesh, p)?;
        }
        for &(p, same) in &shared {
            known[same].1 = number[p as usize];
        }
        let triangles = mesh.triangles.iter();
        extend(
            &mut all.triangles,
            triangles.map(|t| t.map(|p| number[p as usize])),
        )?;
        extend(&mut all.labels, mesh.labels)?;
        extend(&mut all.components, mesh.components)?;
    }
    Ok(TileMesh {
        mesh: all,
        shared: known,
    })
}
