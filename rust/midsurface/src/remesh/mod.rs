//! Isotropic remeshing: a mesh of any triangles in, one of nearly equilateral triangles out.
//!
//! The known base is Botsch and Kobbelt, "A remeshing approach to multiresolution modeling"
//! (2004): split long edges, collapse short ones, flip edges for better valence, move points along
//! the surface, repeat. Points lie on the mesh that came in, the reference, at all times
//! (`reference.rs`), boundary points on its boundary (`curve.rs`). Components, Euler number and
//! boundary loops never change.
//!
//! | step | file |
//! | --- | --- |
//! | how long edges should be, place by place | `sizing.rs` |
//! | cut into blocks that threads work on at once, with their borders frozen | `blocks.rs` |
//! | a block's half-edges, and the three changes of connectivity | `patch.rs` |
//! | which edges are split, collapsed, flipped | `split.rs`, `collapse.rs`, `flip.rs` |
//! | where points move | `relax.rs` |
//! | points leave their lattice | `jitter.rs` |
//! | edges far too long are halved first; every triangle becomes four, from twice the edge length to the one asked for | `subdivide.rs` |
//! | what is still poor is mended | `polish.rs`, `repair.rs` |
//!
//! A triangle's work touches its block only, and blocks lie on a global grid: no step looks
//! farther than a block's side.

mod blocks;
mod collapse;
mod curve;
mod flip;
mod jitter;
mod patch;
mod polish;
mod reference;
mod relax;
mod repair;
mod shape;
mod sizing;
mod split;
mod subdivide;
#[cfg(test)]
mod tests;

use crate::error::{collected, filled, Result};
use crate::execution::Execution;
use crate::grid::{Grid, Vec3};
use crate::surface::halfedge::ends;
use blocks::{Blocks, Surface};
use jitter::jitter;
use patch::{Kind, Patch, Vertex};
use reference::{Place, Reference};
pub(crate) use repair::SHARP;
pub(crate) use shape::sine_of_smallest_angle;
use subdivide::{halve_long, subdivide};

/// A remeshed surface.
#[derive(Debug, Default)]
pub(crate) struct Remeshed {
    pub points: Vec<Vec3>,
    /// Wound as the input's.
    pub triangles: Vec<[u32; 3]>,
    /// Where each point lies on the input.
    pub origin: Vec<Origin>,
}

/// A place on the input mesh: one of its triangles, and the weights of its corners, which sum to
/// 1 and are not negative. A triangle's three points stem from the same component.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Origin {
    pub triangle: u32,
    pub weights: [f32; 3],
}

/// What triangles are before they are remeshed.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Before {
    Any,
    /// Rows of points, those of each row about as far apart as all others: everywhere nearly a lattice.
    Rows,
    /// Remeshed already, but for seams: only near these there is something to do, and where a mesh of
    /// triangles twice as large would end at its border those of the final size would be poor.
    Remeshed,
}

/// The edge length by default, in units of the finest spacing (the paper's step).
const EDGE_LENGTH: f64 = std::f64::consts::SQRT_2;
/// Side of a block in edge lengths.
const BLOCK: f64 = 20.0;
/// Shifts of the grid of blocks from pass to pass, in sides along each axis.
const SHIFTS: [f64; 5] = [0.0, 0.5, 0.25, 0.75, 0.4];
/// What is reached at once: about twice the edges of a surface through voxels of size 1.
const FINE: f64 = 1.8;
/// Passes at twice the final edge length, where most of the work is done, and at the final one. In that
/// blocks are as wide as before: few points lie between them, which keep what subdividing gave them.
const COARSE_PASSES: usize = 4;
const FINE_PASSES: usize = 1;
/// Passes over what is remeshed already.
const MENDING_PASSES: usize = 4;
/// Times that points are moved in a pass.
const RELAXATIONS: usize = 4;
/// Points handed to a worker at a time.
const PIECE: usize = 4096;
/// Passes before the first over blocks: leaving a lattice, and halving long edges twice; mostly none is.
const FIRST_PASSES: usize = 5;
/// Passes that subdividing makes, repairing, and finding out where the points lie on the reference.
const OTHER_PASSES: usize = 4;

/// The edge length to aim at, work units; `edge_length` is what is asked for, world units, 0: the default.
pub(crate) fn wanted_edge(edge_length: f64, grid: &Grid) -> f64 {
    match edge_length {
        0.0 => EDGE_LENGTH,
        length => length / grid.unit(),
    }
}

/// Remeshes a consistently wound 2-manifold, with or without boundary, to edges of about
/// `edge_length`. Lengths are in units of the finest voxel spacing.
pub(crate) fn remesh(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    (edge_length, before): (f64, Before),
    execution: &mut Execution,
) -> Result<Remeshed> {
    remesh_some(
        (points, triangles),
        |_| true,
        (edge_length, before),
        execution,
    )
}

/// Remeshes the triangles that `is_own` names, as [`remesh`]; the points that others use too stay, and
/// so do the edges between own triangles and others.
pub(crate) fn remesh_some(
    (points, triangles): (&[Vec3], &[[u32; 3]]),
    is_own: impl Fn(usize) -> bool,
    (edge_length, before): (f64, Before),
    execution: &mut Execution,
) -> Result<Remeshed> {
    if !(0..triangles.len()).any(&is_own) {
        return Ok(Remeshed::default());
    }
    let twice = 2.0 * edge_length;
    let (coarse, fine, side) = match before {
        Before::Any | Before::Rows => (schedule(twice), FINE_PASSES, BLOCK * twice),
        Before::Remeshed => (Vec::new(), MENDING_PASSES, BLOCK * edge_length),
    };
    let all = coarse.len() + fine;
    let over_blocks = 2 * all;
    execution.still(reference::PASSES + FIRST_PASSES + over_blocks + OTHER_PASSES);
    let reference = Reference::new(points, triangles, edge_length, execution)?;
    let mut surface = start(&reference, is_own)?;
    if let Some(&first) = coarse.first() {
        jitter(&mut surface, before, &reference, execution)?;
        surface = halve_long(surface, first, &reference, execution)?;
    }
    execution.still(over_blocks + OTHER_PASSES);
    for (number, &longest) in coarse.iter().enumerate() {
        let blocks = Blocks::new(&surface, BLOCK * longest, shift(number), execution)?;
        surface = blocks.work(&surface, &reference, (2.0, longest), execution, improve)?;
    }
    if !coarse.is_empty() {
        surface = subdivide(&surface, 0.0, &reference, execution)?;
    }
    for number in coarse.len()..all {
        let blocks = Blocks::new(&surface, side, shift(number), execution)?;
        let scale = (1.0, edge_length);
        surface = blocks.work(&surface, &reference, scale, execution, |patch| {
            improve(patch)?;
            polish::polish(patch);
            Ok(())
        })?;
    }
    surface = repair::repair(surface, &reference, edge_length, execution)?;
    execution.pass_done()?;
    finish(&reference, surface, execution)
}

/// Where the grid of blocks lies in a pass.
fn shift(pass: usize) -> [f64; 3] {
    let shift = SHIFTS[pass % SHIFTS.len()];
    [shift, (1.7 * shift).fract(), (2.3 * shift).fract()]
}

/// One pass over a block.
fn improve(patch: &mut Patch) -> Result<()> {
    split::split_long_edges(patch)?;
    collapse::collapse_short_edges(patch)?;
    for _ in 0..RELAXATIONS {
        flip::flip_edges(patch);
        relax::relax(patch);
    }
    Ok(())
}

/// The longest edge wanted in each pass. Much coarser meshes are reached by doubling, so that
/// blocks hold about as much in each pass. It does not depend on the mesh that came in: what becomes
/// of a component must not depend on the others.
fn schedule(edge_length: f64) -> Vec<f64> {
    let mut passes = vec![edge_length; COARSE_PASSES];
    let mut coarser = 0.5 * edge_length;
    while coarser > FINE && passes.len() < 64 {
        passes.insert(0, coarser);
        coarser *= 0.5;
    }
    passes
}

/// The own triangles of the reference as the first surface.
fn start(reference: &Reference, is_own: impl Fn(usize) -> bool) -> Result<Surface> {
    let mut vertices = filled(Vertex::default(), reference.points.len())?;
    for (t, triangle) in reference.triangles.iter().enumerate() {
        for p in triangle.map(|p| p as usize) {
            vertices[p] = Vertex {
                point: reference.points[p],
                normal: reference.normals[p],
                size: reference.sizes[p],
                at: t as u32,
                ..Vertex::default()
            };
        }
    }
    for (e, number, parameter, corner) in reference.curve.vertices() {
        let vertex = &mut vertices[ends(reference.triangles, e).0 as usize];
        (vertex.at, vertex.parameter) = (number, parameter);
        vertex.kind = if corner { Kind::Corner } else { Kind::Boundary };
    }
    let triangles = reference.triangles;
    for (t, _) in triangles.iter().enumerate().filter(|(t, _)| !is_own(*t)) {
        for p in triangles[t] {
            let beyond = &mut vertices[p as usize].beyond;
            *beyond = beyond.saturating_add(1);
        }
    }
    let own = triangles.iter().enumerate().filter(|(t, _)| is_own(*t));
    Ok(Surface {
        vertices,
        triangles: collected(own.map(|(_, triangle)| *triangle))?,
    })
}

/// The result, with each point's origin.
fn finish(reference: &Reference, surface: Surface, execution: &mut Execution) -> Result<Remeshed> {
    let mut origin = filled(Origin::default(), surface.vertices.len())?;
    execution.fill(&mut origin, PIECE, |piece, out| {
        for (i, origin) in out.iter_mut().enumerate() {
            let Place { triangle, weights } = reference.place(&surface.vertices[piece * PIECE + i]);
            *origin = Origin {
                triangle,
                weights: weights.map(|w| w as f32),
            };
        }
    })?;
    Ok(Remeshed {
        points: collected(surface.vertices.iter().map(|v| v.point))?,
        triangles: surface.triangles,
        origin,
    })
}
