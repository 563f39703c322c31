//! The edge length wanted at each point of the reference.
//!
//! It is the length asked for, but no longer than keeps flat triangles near the curved surface
//! (an edge of length L leaves a surface of radius R by L² / 8 R, a triangle by L² / 6 R), than
//! keeps a boundary near its curve, and than leaves a boundary loop some edges; and it grows
//! slowly from fine places to coarse ones, since triangles between unequal edges are poor. Sheets
//! close to each other are kept apart by the same bound on how far a triangle leaves its sheet.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::reference::Reference;
use crate::buckets::{self, Buckets};
use crate::error::{collected, refused, zeros, Result};
use crate::execution::Execution;
use crate::grid::{dot, length, sub, Vec3};
use crate::surface::halfedge::{ends, Fans};
use crate::surface::normals::average_normals;

/// How far a flat triangle may be from the surface, in units of the finest spacing.
const CHORD: f64 = 0.1;
/// Curvature never asks for edges shorter than this (or than was asked for).
const FINEST: f64 = 0.7;
/// Growth of the edge length along the surface.
const GROWTH: f64 = 0.25;
/// The least number of edges of a boundary loop.
const LOOP_EDGES: f64 = 6.0;
/// Passes that smooth the normals before their change is measured, against noise.
const SMOOTHING: usize = 3;
/// Points handed to a worker at a time.
const PIECE: usize = 4096;
/// Passes over the reference that [`sizes`] makes, for its progress.
pub(super) const PASSES: usize = buckets::PASSES + SMOOTHING + 1;

/// The edge length wanted at every point of the reference.
pub(super) fn sizes(
    reference: &Reference,
    fans: &Fans,
    edge_length: f64,
    execution: &mut Execution,
) -> Result<Vec<f32>> {
    let neighbours = &fans.neighbours(reference.triangles, execution)?;
    let normals = collected(reference.normals.iter().map(|n| n.map(f64::from)))?;
    let normals = average_normals(normals, neighbours, SMOOTHING, execution)?;
    let mut sizes: Vec<f32> = zeros(reference.points.len())?;
    execution.fill(&mut sizes, PIECE, |piece, out| {
        for (i, size) in out.iter_mut().enumerate() {
            let p = (piece * PIECE + i) as u32;
            let curvature = curvature(reference, neighbours, &normals, p);
            *size = bounded((6.0 * CHORD / curvature).sqrt(), edge_length);
        }
    })?;
    for (e, number, parameter, _) in reference.curve.vertices() {
        let p = ends(reference.triangles, e).0;
        let radius = 1.0 / reference.curve.curvature(number, parameter);
        let length = reference.curve.loop_length(number) / LOOP_EDGES;
        let wanted = bounded((8.0 * CHORD * radius).sqrt().min(length), edge_length);
        let size = &mut sizes[p as usize];
        *size = size.min(wanted);
    }
    grade(reference, neighbours, edge_length as f32, &mut sizes)?;
    Ok(sizes)
}

fn bounded(wanted: f64, edge_length: f64) -> f32 {
    // A flat place wants an infinite edge.
    wanted.max(FINEST).min(edge_length) as f32
}

/// The change of the normals around a point over the way it takes: 1 / R on a sphere.
fn curvature(reference: &Reference, neighbours: &Buckets<u32>, normals: &[Vec3], p: u32) -> f64 {
    let (mut turned, mut way) = (0.0, 0.0);
    for &q in neighbours.of(p as usize) {
        let turn = sub(normals[q as usize], normals[p as usize]);
        let step = sub(reference.points[q as usize], reference.points[p as usize]);
        turned += dot(turn, turn);
        way += dot(step, step);
    }
    if way > 0.0 {
        (turned / way).sqrt()
    } else {
        0.0
    }
}

/// Limits the growth of the sizes along the surface, from the fine places outward.
fn grade(
    reference: &Reference,
    neighbours: &Buckets<u32>,
    edge_length: f32,
    sizes: &mut [f32],
) -> Result<()> {
    // Sizes are positive, so that their bits order as they do.
    let fine = (0..sizes.len() as u32).filter(|&p| sizes[p as usize] < edge_length);
    let fine = fine.map(|p| Reverse((sizes[p as usize].to_bits(), p)));
    let mut heap = BinaryHeap::from(collected(fine)?);
    while let Some(Reverse((bits, p))) = heap.pop() {
        if bits != sizes[p as usize].to_bits() {
            continue;
        }
        for &q in neighbours.of(p as usize) {
            let way = length(sub(
                reference.points[q as usize],
                reference.points[p as usize],
            ));
            let most = f32::from_bits(bits) + (GROWTH * way) as f32;
            if most < sizes[q as usize] {
                sizes[q as usize] = most;
                heap.try_reserve(1)
                    .map_err(|_| refused::<Reverse<(u32, u32)>>(1))?;
                heap.push(Reverse((most.to_bits(), q)));
            }
        }
    }
    Ok(())
}
