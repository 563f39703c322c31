//! Mid-surfaces of thin labelled slabs in segmented volumes.
//!
//! A cell membrane in a segmented tomogram is a slab of labelled voxels, 2 to 15 thick. This crate
//! finds the surface midway between its two faces, as a triangle mesh. Data flows one way, a stage
//! is a file. Both methods begin with
//!
//! | stage | from → to | file |
//! | --- | --- | --- |
//! | scan | volume → runs of labelled voxels, the only pass over the input | `runs.rs` |
//! | parts | runs → connected parts, each with its label and component | `components.rs` |
//! | distance | parts → distance to the outside, in sparse bricks (`bricks.rs`) | `distance.rs` |
//!
//! The ridge surface (`ridge_surface.rs`) goes on in all three directions at once:
//!
//! | stage | from → to | file |
//! | --- | --- | --- |
//! | scale | distance → how thick the label is here | `scale.rs` |
//! | profile | mask → the mask smoothed as wide as it is thick | `profile.rs` |
//! | sheets | profile → normal and offset of the sheet at every voxel near it | `crest.rs`, `extension.rs`, `settle.rs` |
//! | contour | sheets → a surface through them, cut at the label's rims | `contour.rs`, `rim.rs`, `trim.rs`, `scraps.rs` |
//! | midway | surface → surface midway between both faces | `midway.rs` |
//! | mesh | triangles → nearly equilateral ones, no terraces, no self-intersections | `remesh`, `terraces.rs`, `self_intersections.rs` |
//!
//! The polyline zipper is the method of Boneš et al., "MidSurfer: A Parameter-Free Approach for
//! Mid-Surface Extraction from Segmented Volumetric Data" (arXiv 2405.19339):
//!
//! | stage | from → to | file |
//! | --- | --- | --- |
//! | ridge field | distance → a smooth field whose crest is the mid-surface | `ridge.rs`, `sheet.rs` |
//! | polylines | ridge field → a line midway through every slice (`slice.rs`, `trace.rs`) | `polylines.rs` |
//! | zipper | polylines → strips of triangles between slices (`strip.rs`) | `zipper.rs` |
//! | mesh | triangles → 2-manifold (`manifold.rs`), better triangles (`flips.rs`), no terraces (`terraces.rs`), normals | `mesh.rs` |
//!
//! Arrays are in the order x, y, z, volumes have shape (z, y, x) with x fastest. Lengths inside
//! are in units of the finest spacing, so that the same voxels in other units give the same mesh;
//! `grid.rs` tells the frames. Everything between scan and polylines happens in batches of whole
//! components, so that memory follows the largest batch, and depends on places in the volume
//! only, never on the order of work: any number of threads gives the same mesh.
#![forbid(unsafe_code)]

mod bending;
mod block;
mod border;
mod bricks;
mod buckets;
mod centre;
mod components;
mod contour;
mod crest;
mod crossings;
mod distance;
mod eigen;
mod ends;
mod error;
mod execution;
mod extension;
mod flips;
mod grid;
mod halfedge;
#[cfg(feature = "inject-panics")]
pub mod injected_panics;
mod interpolation;
mod manifold;
mod mask;
mod mesh;
mod midway;
mod normals;
mod polylines;
mod profile;
mod quality;
mod ray;
mod remesh;
mod resample;
mod ridge;
mod ridge_surface;
mod rim;
mod runs;
mod scale;
mod scraps;
mod self_intersections;
mod separable;
mod settle;
mod sheet;
mod slice;
mod slices;
mod statistics;
mod strip;
mod terraces;
mod thickness;
mod touching;
mod trace;
mod trim;
mod vectors;
mod volume;
mod weld;
mod zipper;

use std::collections::{BTreeMap, BTreeSet};

use ndarray::ArrayViewMut3;

use bricks::Batch;
use components::{parts, Part};
pub use error::{Error, Result};
use execution::Execution;
pub use execution::{Observer, Quiet};
pub use grid::{Grid, Vec3};
pub use mesh::{InvariantViolation, Mesh};
pub use polylines::{Polyline, Polylines};
pub use quality::Quality;
pub use statistics::{statistics, Scope, Statistics, ThicknessFigures, TriangleMesh};
pub use volume::{Label, Scalars, Volume};

/// How the mid-surface is found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Method {
    /// The paper's method: a line in every slice along z, neighbouring lines zipped together.
    PolylineZipper,
    /// The default: a surface midway between both faces, in whichever direction the membrane lies,
    /// flat in the slices, too.
    #[default]
    RidgeSurface,
}

/// What a run may be told. The default is right for most.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// How the mid-surface is found.
    pub method: Method,
    /// The labels to extract; `None`: all.
    pub labels: Option<Vec<i64>>,
    /// Number of worker threads; 0: one a core.
    pub threads: usize,
    /// The mesh's edge length to aim at, world units; 0: √2 times the finest spacing.
    pub edge_length: f64,
}

impl Options {
    fn check(&self) -> Result<()> {
        if self.edge_length >= 0.0 && self.edge_length.is_finite() {
            Ok(())
        } else {
            Err(Error::EdgeLength(self.edge_length))
        }
    }
}

/// The mid-surface of the labels as a triangle mesh.
///
/// # Errors
/// Where the scalars are no segmentation, none of the labels asked for is there, an option is
/// unusable, memory is refused, or the observer cancels.
pub fn extract(volume: &Volume, options: &Options, observer: &mut dyn Observer) -> Result<Mesh> {
    options.check()?;
    match options.method {
        Method::PolylineZipper => {
            let mut execution = Execution::new(options.threads, observer)?;
            let polylines = trace_polylines(volume, options, &mut execution, TRACING)?;
            zip(&polylines, &mut execution)
        }
        Method::RidgeSurface => {
            let mut execution = Execution::new(options.threads, observer)?;
            find_ridge_surface(volume, options, &mut execution)
        }
    }
}

/// The distinct labels of a volume, ascending; 0 is background.
///
/// # Errors
/// As [`extract`].
pub fn find_labels(
    volume: &Volume,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Vec<i64>> {
    let mut execution = Execution::new(options.threads, observer)?;
    execution.stage("Finding labels", 0.0, 1.0, 1)?;
    let scan = runs::scan(volume, &mut execution, |_| false)?;
    Ok(scan.labels.into_iter().collect())
}

/// Writes distance and ridge field, both in world units, into arrays of the volume's shape
/// (z, y, x). Voxels far from every label stay as they are.
///
/// # Errors
/// As [`extract`].
pub fn ridge_field(
    volume: &Volume,
    options: &Options,
    observer: &mut dyn Observer,
    mut distance: ArrayViewMut3<f32>,
    mut ridge: ArrayViewMut3<f32>,
) -> Result<()> {
    let mut execution = Execution::new(options.threads, observer)?;
    let unit = volume.grid.unit() as f32;
    for_each_ridge_field(
        volume,
        options,
        &mut execution,
        1.0,
        "Writing the fields",
        |batch, field, _| {
            for (brick, place) in batch.places() {
                for (entry, [x, y, z]) in bricks::voxels(brick, place, volume.grid.dimensions) {
                    // Margins of neighbouring parts overlap: the stronger field wins.
                    let (d, r) = (&mut distance[[z, y, x]], &mut ridge[[z, y, x]]);
                    *d = d.max(field.distance[entry] * unit);
                    *r = r.max(field.ridge[entry] * unit);
                }
            }
            Ok(())
        },
    )
}

/// The mid-polylines of every slice.
///
/// # Errors
/// As [`extract`].
pub fn mid_polylines(
    volume: &Volume,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Polylines> {
    let mut execution = Execution::new(options.threads, observer)?;
    trace_polylines(volume, options, &mut execution, 1.0)
}

/// Joins the polylines of neighbouring slices to a mesh.
///
/// # Errors
/// Where the lines do not lie in parallel slices, memory is refused, or the observer cancels.
pub fn zip_polylines(
    polylines: &Polylines,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Mesh> {
    polylines.check()?;
    let mut execution = Execution::new(options.threads, observer)?;
    zip(polylines, &mut execution)
}

fn trace_polylines(
    volume: &Volume,
    options: &Options,
    execution: &mut Execution,
    until: f64,
) -> Result<Polylines> {
    let mut polylines = Polylines::default();
    let mut disks = 0;
    for_each_ridge_field(
        volume,
        options,
        execution,
        until,
        "Tracing mid-polylines",
        |batch, field, execution| {
            disks += polylines::polylines(batch, field, &volume.grid, &mut polylines, execution)?;
            Ok(())
        },
    )?;
    if disks > 0 {
        execution.warning(&format!(
            "{disks} regions of single slices are disks, where the membrane lies flat in the \
             slices along z, as at the caps of a vesicle: the surface has a gap there"
        ));
    }
    Ok(polylines)
}

fn find_ridge_surface(
    volume: &Volume,
    options: &Options,
    execution: &mut Execution,
) -> Result<Mesh> {
    let mut mesh = Mesh::default();
    if volume.grid.dimensions.contains(&1) {
        read_parts(volume, options, execution)?;
        execution.warning(
            "there is no surface: the volume is a single slice, in which a membrane is a line",
        );
        execution.finish()?;
        return Ok(mesh);
    }
    let mut without: BTreeMap<i64, usize> = BTreeMap::new();
    let count = for_each_batch(volume, options, execution, 1.0, |parts, execution| {
        let first = mesh.triangles.len();
        ridge_surface::ridge_surface(
            parts,
            &volume.grid,
            options.edge_length,
            &mut mesh,
            execution,
        )?;
        let found: BTreeSet<u32> = mesh.components[first..].iter().copied().collect();
        for component in parts.chunk_by(|a, b| a.component == b.component) {
            if !found.contains(&component[0].component) {
                *without.entry(component[0].label).or_default() += 1;
            }
        }
        Ok(())
    })?;
    warn_of_components_without(&without, execution);
    if count > 0 {
        let grid = &volume.grid;
        warn_if_far(grid::farthest(&grid.corners()), grid.unit(), execution);
    }
    execution.finish()?;
    Ok(mesh)
}

/// Warns of the components without a surface, counted for each label.
fn warn_of_components_without(without: &BTreeMap<i64, usize>, execution: &mut Execution) {
    for (label, count) in without.iter().take(MOST_LISTED) {
        execution.warning(&format!(
            "Label {label}: {count} of its separate pieces gave no surface, since they hold no \
             sheet that could be followed"
        ));
    }
    if without.len() > MOST_LISTED {
        let more = without.len() - MOST_LISTED;
        execution.warning(&format!("{more} more labels have pieces without a surface"));
    }
}

/// Takes what is left of the progress.
fn zip(polylines: &Polylines, execution: &mut Execution) -> Result<Mesh> {
    let polylines = &*polylines.without_repeats();
    execution.stage("Zipping polylines", 0.0, 0.6, zipper::PASSES)?;
    let triangles = zipper::zip(polylines, execution)?;
    execution.stage("Making the mesh", 0.6, 1.0, mesh::PASSES)?;
    if let Some(([a, b, _], _)) = triangles.first() {
        let [a, b] = [a, b].map(|&p| polylines.points[p as usize]);
        let edge = grid::length(grid::sub(a, b));
        warn_if_far(grid::farthest(&polylines.points), edge, execution);
    } else if !polylines.lines.is_empty() {
        execution.warning(
            "there is no surface: it takes lines in two neighbouring slices, and this input has \
             them in single slices only",
        );
    }
    let mesh = Mesh::assemble(polylines, triangles, execution)?;
    execution.finish()?;
    Ok(mesh)
}

/// Warns where the points' 32-bit coordinates, the largest being `farthest`, are too coarse for
/// edges of this length, world units.
fn warn_if_far(farthest: f64, edge: f64, execution: &mut Execution) {
    if farthest * f64::from(f32::EPSILON) > 0.01 * edge {
        execution.warning(
            "the volume lies so far from the origin that the points' 32-bit coordinates are \
             rounded visibly: move its origin nearer to 0",
        );
    }
}

/// Cost of the parts that are worked on at once; a larger component is a batch of its own.
const BATCH_COST: usize = 600_000;

/// Share of the run that reading the labels takes, and of the polyline zipper's until there are
/// lines.
const READING: f64 = 0.05;
const TRACING: f64 = 0.7;

/// Scans the volume and hands its parts to `work`, in batches of whole components. All takes the
/// progress up to `until`, within which each call has a span of its own. Tells how many parts there
/// are.
fn for_each_batch(
    volume: &Volume,
    options: &Options,
    execution: &mut Execution,
    until: f64,
    mut work: impl FnMut(&[Part], &mut Execution) -> Result<()>,
) -> Result<usize> {
    execution.within(0.0, until);
    let all_parts = read_parts(volume, options, execution)?;
    let total: usize = all_parts.iter().map(Part::voxels).sum();
    let share = |voxels: usize| until * (READING + (1.0 - READING) * voxels as f64 / total as f64);
    let mut done = 0;
    for parts in batches(&all_parts) {
        let voxels: usize = parts.iter().map(Part::voxels).sum();
        execution.within(share(done), share(done + voxels));
        work(parts, execution)?;
        done += voxels;
    }
    execution.within(until, 1.0);
    Ok(all_parts.len())
}

/// Hands the parts' ridge fields to `work`, as [`for_each_batch`]; `stage` is what that is called.
fn for_each_ridge_field(
    volume: &Volume,
    options: &Options,
    execution: &mut Execution,
    until: f64,
    stage: &'static str,
    mut work: impl FnMut(&Batch, &ridge::RidgeField, &mut Execution) -> Result<()>,
) -> Result<()> {
    let h = volume.grid.work_spacing();
    for_each_batch(volume, options, execution, until, |parts, execution| {
        execution.stage("Computing the ridge field", 0.0, 0.5, ridge::PASSES)?;
        let (batch, field) = ridge::ridge_field(parts, volume.grid.dimensions, h, execution)?;
        execution.stage(stage, 0.5, 1.0, 1)?;
        work(&batch, &field, execution)
    })?;
    Ok(())
}

/// Cuts the parts, which are ordered by component, into batches of whole components.
fn batches(parts: &[Part]) -> Vec<&[Part]> {
    let mut batches = Vec::new();
    let (mut start, mut end, mut cost) = (0, 0, 0);
    for component in parts.chunk_by(|a, b| a.component == b.component) {
        let size: usize = component.iter().map(Part::cost).sum();
        if cost > 0 && cost + size > BATCH_COST {
            batches.push(&parts[start..end]);
            (start, cost) = (end, 0);
        }
        end += component.len();
        cost += size;
    }
    if end > start {
        batches.push(&parts[start..end]);
    }
    batches
}

/// The most labels that a message names.
const MOST_LISTED: usize = 20;

/// The parts of the wanted labels; tells the user what is missing or left out.
fn read_parts(volume: &Volume, options: &Options, execution: &mut Execution) -> Result<Vec<Part>> {
    let wanted: Option<BTreeSet<i64>> =
        options.labels.as_ref().map(|l| l.iter().copied().collect());
    let is_wanted = |label: i64| wanted.as_ref().is_none_or(|wanted| wanted.contains(&label));
    execution.stage("Reading labels", 0.0, READING, 2)?;
    let scan = runs::scan(volume, execution, is_wanted)?;
    report_labels(wanted.as_ref(), &scan.labels, execution)?;
    let (mut parts, specks) = parts(scan.runs, execution)?;
    if specks > 0 {
        execution.warning(&format!(
            "{specks} specks of fewer than {} voxels were left out",
            components::SPECK
        ));
    }
    let volume_size = volume.grid.voxel_count()?;
    let found = parts.len();
    parts.retain(|part| part.voxels() < volume_size);
    if parts.len() < found {
        execution
            .warning("one label fills the whole volume: it has no faces, and so no mid-surface");
    }
    Ok(parts)
}

/// Compares the labels asked for with those that are there.
fn report_labels(
    wanted: Option<&BTreeSet<i64>>,
    present: &BTreeSet<i64>,
    execution: &mut Execution,
) -> Result<()> {
    if present.is_empty() {
        execution.warning("the volume has no label: all its values are 0, so there is no surface");
        return Ok(());
    }
    let Some(wanted) = wanted else {
        return Ok(());
    };
    if wanted.is_empty() {
        execution.warning("no label is chosen, so there is no surface");
        return Ok(());
    }
    let list = |labels: &mut dyn Iterator<Item = &i64>| {
        let names: Vec<String> = labels.take(MOST_LISTED).map(i64::to_string).collect();
        names.join(", ")
    };
    let absent = list(&mut wanted.difference(present));
    if wanted.is_disjoint(present) {
        return Err(Error::LabelsAbsent {
            asked: absent,
            present: list(&mut present.iter()),
        });
    }
    if !absent.is_empty() {
        execution.warning(&format!("these labels are not in the volume: {absent}"));
    }
    Ok(())
}
