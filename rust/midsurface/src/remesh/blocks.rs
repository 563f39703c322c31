//! The surface cut into blocks, so that threads can work on it at once.
//!
//! A triangle belongs to the block of the global grid that its centre is in. A block is worked on
//! with the points it shares with other blocks frozen; the next pass, if there is one, shifts the grid, so that
//! they come to lie inside. What happens in a block depends on what is in it, never on the other
//! blocks or on the order of work.

use super::patch::{Patch, Vertex};
use super::reference::Reference;
use crate::error::{check_count, collected, extend, filled, push, reserved, zeros, Result};
use crate::execution::Execution;
use crate::grid::floor;
use crate::surface::halfedge::NONE;

/// Triangles handed to a worker at a time.
const PIECE: usize = 4096;
/// Block of a point that more than one block uses, or that is frozen for good.
const SHARED: u32 = u32::MAX - 1;
/// Marks the number of a point of the whole surface, among those of a block's own points.
const GLOBAL: u32 = 1 << 31;

/// The mesh under work.
#[derive(Default)]
pub(super) struct Surface {
    pub vertices: Vec<Vertex>,
    pub triangles: Vec<[u32; 3]>,
}

/// A grid of blocks over the surface.
pub(super) struct Blocks {
    /// Triangles, block by block.
    order: Vec<u32>,
    /// Where each block starts in `order`, and the end.
    starts: Vec<u32>,
    /// The block that alone uses each point, or [`SHARED`].
    owner: Vec<u32>,
    /// Number of each point within the first block that uses it.
    rank: Vec<u32>,
    /// Number of points ranked in each block.
    ranked: Vec<u32>,
    /// Number of edges of each point.
    valence: Vec<u16>,
}

/// What became of a block.
struct Worked {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
}

impl Blocks {
    /// Cuts a surface by a grid of cubes of side `side` whose origin is moved by `shift` sides.
    pub fn new(
        surface: &Surface,
        side: f64,
        shift: [f64; 3],
        execution: &mut Execution,
    ) -> Result<Self> {
        let keys = keys(surface, side, shift, execution)?;
        // Neighbouring triangles mostly share a block: sorting runs of them is cheap.
        let mut runs: Vec<(u64, u32, u32)> = Vec::new();
        let mut start = 0;
        for run in keys.chunk_by(|a, b| a == b) {
            let end = start + run.len() as u32;
            push(&mut runs, (run[0], start, end))?;
            start = end;
        }
        runs.sort_unstable();
        let mut order = reserved(keys.len())?;
        let mut starts = vec![0];
        for block in runs.chunk_by(|a, b| a.0 == b.0) {
            order.extend(block.iter().flat_map(|&(_, start, end)| start..end));
            push(&mut starts, order.len() as u32)?;
        }
        let points = surface.vertices.len();
        let mut blocks = Self {
            order,
            starts,
            owner: filled(NONE, points)?,
            rank: zeros(points)?,
            ranked: Vec::new(),
            valence: zeros(points)?,
        };
        blocks.assign_points(surface)?;
        Ok(blocks)
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    fn triangles_of(&self, block: usize) -> &[u32] {
        &self.order[self.starts[block] as usize..self.starts[block + 1] as usize]
    }

    fn assign_points(&mut self, surface: &Surface) -> Result<()> {
        for block in 0..self.count() {
            let mut ranked = 0;
            let range = self.starts[block] as usize..self.starts[block + 1] as usize;
            for &t in &self.order[range] {
                for p in surface.triangles[t as usize].map(|p| p as usize) {
                    if self.owner[p] == NONE {
                        let vertex = &surface.vertices[p];
                        self.valence[p] =
                            u16::from(vertex.is_boundary()) + u16::from(vertex.beyond);
                        if vertex.is_frozen() {
                            self.owner[p] = SHARED;
                        } else {
                            self.owner[p] = block as u32;
                            self.rank[p] = ranked;
                            ranked += 1;
                        }
                    } else if self.owner[p] != block as u32 {
                        self.owner[p] = SHARED;
                    }
                    self.valence[p] = self.valence[p].saturating_add(1);
                }
            }
            push(&mut self.ranked, ranked)?;
        }
        Ok(())
    }

    /// Lets `work` change every block, and returns the new surface.
    pub fn work(
        &self,
        surface: &Surface,
        reference: &Reference,
        (scale, longest): (f64, f64),
        execution: &mut Execution,
        work: impl Fn(&mut Patch) -> Result<()> + Sync,
    ) -> Result<Surface> {
        let mut new = Surface::default();
        let mut number = filled(NONE, surface.vertices.len())?;
        let blocks = collected(0..self.count())?;
        execution.stream(
            &blocks,
            |&block| {
                let (mut patch, global) =
                    self.patch(surface, reference, (scale, longest), block)?;
                work(&mut patch)?;
                collect(&patch, &global)
            },
            |worked: Result<Worked>| {
                let worked = worked?;
                let most = new.vertices.len() + worked.vertices.len();
                // Numbers from GLOBAL on stand for others.
                check_count("points", most, 2)?;
                check_count("triangles", new.triangles.len() + worked.triangles.len(), 3)?;
                let first = new.vertices.len() as u32;
                extend(&mut new.vertices, worked.vertices)?;
                for p in worked
                    .triangles
                    .iter()
                    .flatten()
                    .filter(|p| *p & GLOBAL != 0)
                {
                    let p = (p ^ GLOBAL) as usize;
                    if number[p] == NONE {
                        number[p] = new.vertices.len() as u32;
                        push(&mut new.vertices, surface.vertices[p])?;
                    }
                }
                let renumbered = |p: u32| match p & GLOBAL {
                    0 => first + p,
                    _ => number[(p ^ GLOBAL) as usize],
                };
                extend(
                    &mut new.triangles,
                    worked.triangles.iter().map(|t| t.map(renumbered)),
                )
            },
        )?;
        Ok(new)
    }

    /// A block as a patch, and the numbers of its frozen points, which come last.
    fn patch<'a>(
        &self,
        surface: &Surface,
        reference: &'a Reference<'a>,
        (scale, longest): (f64, f64),
        block: usize,
    ) -> Result<(Patch<'a>, Vec<u32>)> {
        let own = self.triangles_of(block);
        let corners = |t: &u32| surface.triangles[*t as usize];
        let is_shared = |&p: &u32| self.owner[p as usize] == SHARED;
        let mut shared = collected(own.iter().flat_map(corners).filter(is_shared))?;
        shared.sort_unstable();
        shared.dedup();
        let ranked = self.ranked[block] as usize;
        let mut vertices = filled(Vertex::default(), ranked)?;
        let mut valence: Vec<i32> = zeros(ranked)?;
        let mut triangles = reserved(own.len())?;
        for t in own {
            triangles.push(corners(t).map(|p| {
                if self.owner[p as usize] == SHARED {
                    let place = shared.binary_search(&p).unwrap_or_else(|place| place);
                    return (ranked + place) as u32;
                }
                let local = self.rank[p as usize];
                vertices[local as usize] = surface.vertices[p as usize];
                valence[local as usize] = i32::from(self.valence[p as usize]);
                local
            }));
        }
        let mut frozen = filled(true, ranked + shared.len())?;
        frozen[..ranked].fill(false);
        let beyond = || shared.iter().map(|&p| p as usize);
        extend(&mut vertices, beyond().map(|p| surface.vertices[p]))?;
        extend(&mut valence, beyond().map(|p| i32::from(self.valence[p])))?;
        let mut global = filled(NONE, ranked)?;
        extend(&mut global, shared)?;
        let patch = Patch::new(
            reference,
            (scale, longest),
            vertices,
            frozen,
            valence,
            triangles,
        )?;
        Ok((patch, global))
    }
}

/// Which block each triangle's centre is in.
fn keys(
    surface: &Surface,
    side: f64,
    shift: [f64; 3],
    execution: &mut Execution,
) -> Result<Vec<u64>> {
    let mut keys: Vec<u64> = zeros(surface.triangles.len())?;
    execution.fill(&mut keys, PIECE, |piece, out| {
        for (i, key) in out.iter_mut().enumerate() {
            let [a, b, c] =
                surface.triangles[piece * PIECE + i].map(|p| surface.vertices[p as usize].point);
            for k in [2, 1, 0] {
                let centre = (a[k] + b[k] + c[k]) / 3.0;
                // 21 bits an axis, around 0.
                let cell = floor(centre / side + shift[k]) as i64 + (1 << 20);
                *key = *key << 21 | (cell as u64 & 0x1f_ffff);
            }
        }
    })?;
    Ok(keys)
}

/// The points and triangles of a patch that are left, frozen points by their global numbers.
fn collect(patch: &Patch, global: &[u32]) -> Result<Worked> {
    let mut number = filled(NONE, patch.vertices.len())?;
    let mut worked = Worked {
        vertices: reserved(patch.vertices.len())?,
        triangles: reserved(patch.triangles.len())?,
    };
    for triangle in patch.triangles.iter().filter(|t| t[0] != NONE) {
        worked.triangles.push(triangle.map(|p| {
            let p = p as usize;
            if patch.frozen[p] {
                return global[p] | GLOBAL;
            }
            if number[p] == NONE {
                number[p] = worked.vertices.len() as u32;
                worked.vertices.push(patch.vertices[p]);
            }
            number[p]
        }));
    }
    Ok(worked)
}
