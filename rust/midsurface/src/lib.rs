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
//! | sheets | profile → normal and offset of the sheet at every voxel near it | `crest.rs`, `lag.rs`, `one_face.rs`, `bending.rs`, `extension.rs`, `settle.rs` |
//! | contour | sheets → a surface through them, cut at the label's rims | `contour.rs`, `rim.rs`, `trim.rs`, `scraps.rs` |
//! | holes | surface → surface without creases where sheets meet, nor false holes, led on beyond the border of the volume for the while | `creases.rs`, `holes.rs`, `beyond.rs` |
//! | midway | surface → surface midway between both faces, with smooth rims, led on to where sheets meet | `midway.rs`, `look.rs`, `fairing.rs`, `rim_smoothing.rs`, `reach.rs`, `meeting.rs` |
//! | mesh | triangles → nearly equilateral ones, no terraces, no self-intersections | `remesh`, `terraces.rs`, `sharp.rs`, `self_intersections.rs` |
//!
//! The polyline zipper is the method of Boneš et al., "MidSurfer: A Parameter-Free Approach for
//! Mid-Surface Extraction from Segmented Volumetric Data" (arXiv 2405.19339):
//!
//! | stage | from → to | file |
//! | --- | --- | --- |
//! | ridge field | distance → a smooth field whose crest is the mid-surface | `ridge.rs`, `sheet.rs` |
//! | polylines | ridge field → a line midway through every slice (`slice.rs`, `trace.rs`) | `polylines.rs` |
//! | zipper | polylines → strips of triangles between slices (`strip.rs`) | `zipper.rs` |
//! | mesh | triangles → 2-manifold (`manifold.rs`), no terraces (`terraces.rs`), then nearly equilateral triangles (`remesh`) | `zipped_surface.rs` |
//!
//! Arrays are in the order x, y, z, volumes have shape (z, y, x) with x fastest. Lengths inside
//! are in units of the finest spacing, so that the same voxels in other units give the same mesh;
//! `grid.rs` tells the frames. Everything between scan and polylines, or the ridge surface, happens in
//! batches of whole components, two side by side (`batches.rs`), so that memory follows the largest
//! batches, and depends on places in the volume only, never on the order of work: any number of
//! threads gives the same mesh. A component that is larger than a batch should be is cut into tiles
//! (`lots.rs`, `tiles.rs`, `tiled_surface.rs`) for the ridge surface. Processes that hold a piece of the
//! volume each give the same mesh, too, however many they are: they swap runs (`exchange.rs`) until each
//! has whole components (`territory.rs`, `pieces.rs`), and what follows is the same; tiles are dealt to
//! all processes, which swap what lies between them.
#![forbid(unsafe_code)]

mod batches;
mod bending;
mod beyond;
mod block;
mod border;
mod bricks;
mod buckets;
mod cells;
mod centre;
mod components;
mod contour;
mod creases;
mod crest;
mod crossings;
mod distance;
mod distributed;
mod eigen;
mod ends;
mod error;
mod exact_sum;
mod exchange;
mod execution;
mod extension;
mod fairing;
mod findings;
mod flips;
mod grid;
mod halfedge;
mod hash;
mod holes;
#[cfg(feature = "inject-panics")]
pub mod injected_panics;
mod interpolation;
mod joints;
mod lag;
mod lattice;
mod look;
mod lots;
mod manifold;
mod mask;
mod measure;
mod meeting;
mod mesh;
mod midway;
mod mosaic;
mod normals;
mod numbering;
mod one_face;
mod pieces;
mod polylines;
mod profile;
mod quality;
mod quantiles;
mod ray;
mod reach;
mod reading;
mod region;
mod remesh;
mod resample;
mod ridge;
mod ridge_surface;
mod rim;
mod rim_smoothing;
mod runs;
mod scale;
mod scraps;
mod seams;
mod self_intersections;
mod separable;
mod settle;
mod sharp;
mod sheet;
mod slabs;
mod slice;
mod slices;
mod statistics;
mod strip;
mod terraces;
mod territory;
mod thickness;
mod tile;
mod tiled_mesh;
mod tiled_surface;
mod tiles;
mod touching;
mod trace;
mod trim;
mod vectors;
mod volume;
mod weld;
mod zipped_surface;
mod zipper;

use ndarray::ArrayViewMut3;

use batches::{for_each_batch, for_each_ridge_field};
use components::Part;
pub use distributed::{
    extract_piece, mid_polylines_piece, ridge_field_piece, zip_polylines_piece, MeshPiece,
};
pub use error::{Error, Result};
pub use exchange::{abandon, Exchange};
use exchange::{Alone, Team};
use execution::Execution;
pub use execution::{Observer, Quiet};
use findings::Findings;
pub use grid::{Grid, Vec3};
use lots::Sizes;
pub use mesh::{InvariantViolation, Mesh};
use numbering::Key;
pub use polylines::{Polyline, Polylines};
pub use quality::Quality;
use reading::{read_parts, READING};
use remesh::wanted_edge;
pub use statistics::{
    statistics, statistics_of_pieces, Scope, Statistics, ThicknessFigures, TriangleMesh,
};
use tiled_mesh::TileMesh;
use tiled_surface::tiled_surface;
pub use volume::{Label, Scalars, Volume};
use zipped_surface::{ZippedSurface, ZIPPED};

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
    /// Share of the run within which labels are read and, by the zipper, lines are traced.
    fn tracing(&self) -> f64 {
        match self.method {
            Method::PolylineZipper => 0.45,
            Method::RidgeSurface => 1.0,
        }
    }

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
    let mut execution = Execution::new(options.threads, observer)?;
    let parts = read_parts(volume, options, &mut execution, options.tracing())?;
    let mut alone = Alone;
    let team = &mut Team::new(&mut alone);
    let found = find_surface(
        &parts,
        &volume.grid,
        (options, Sizes::USUAL),
        team,
        &mut execution,
    )?;
    found.findings.warn(&mut execution);
    execution.finish()?;
    Ok(found.mesh)
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
    let voxels = volume.grid.voxel_count()?;
    let scan = runs::scan(volume, voxels, &mut execution, |_| false)?;
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
    let parts = read_parts(volume, options, &mut execution, 1.0)?;
    let mut fields = Fields {
        distance: distance.view_mut(),
        ridge: ridge.view_mut(),
        first: [0; 3],
    };
    write_fields(&parts, &volume.grid, &mut fields, &mut execution)
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
    let parts = read_parts(volume, options, &mut execution, 1.0)?;
    let (polylines, disks) = trace_polylines(&parts, &volume.grid, &mut execution, 1.0)?;
    let findings = Findings {
        disks,
        ..Findings::default()
    };
    findings.warn(&mut execution);
    Ok(polylines)
}

/// Joins the polylines of neighbouring slices to a mesh: that of [`extract`] before it is remeshed,
/// whatever edge length the options name.
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
    let mut findings = Findings::default();
    let mesh = zip(polylines, &mut findings, 1.0, &mut execution)?.into_mesh(&mut execution)?;
    findings.warn(&mut execution);
    execution.finish()?;
    Ok(mesh)
}

/// The surface of components by the method chosen, and what there is to tell about it.
#[derive(Default)]
struct Found {
    mesh: Mesh,
    /// The points that other processes may have, too.
    shared: Vec<(Key, u32)>,
    findings: Findings,
}

impl Found {
    /// Adds the own tiles of a component; the first process tells where nobody has any of it.
    fn add_tiled(&mut self, lot: &[Part], tiled: TileMesh, team: &mut Team) -> Result<()> {
        let of_all = team.share(&[tiled.mesh.triangles.len() as i64])?;
        if team.process() == 0 && of_all.iter().flatten().all(|count| *count == 0) {
            self.findings.add_without(lot, &tiled.mesh);
        }
        let first = self.mesh.points.len() as u32;
        let shared = tiled.shared.into_iter();
        error::extend(&mut self.shared, shared.map(|(key, p)| (key, first + p)))?;
        self.mesh.append(tiled.mesh)
    }
}

/// Those that are worked on in tiles all processes have to have.
fn find_surface(
    parts: &[Part],
    grid: &Grid,
    (options, sizes): (&Options, Sizes),
    team: &mut Team,
    execution: &mut Execution,
) -> Result<Found> {
    let mut found = Found::default();
    match options.method {
        Method::PolylineZipper => {
            let findings = &mut found.findings;
            let (polylines, disks) = trace_polylines(parts, grid, execution, options.tracing())?;
            findings.disks = disks;
            let surface = zip(&polylines, findings, ZIPPED, execution)?;
            drop(polylines);
            let wanted = wanted_edge(options.edge_length, grid);
            found.mesh = surface.remeshed(grid, wanted, execution)?;
        }
        Method::RidgeSurface => {
            let size = (options.edge_length, sizes);
            find_ridge_surface(parts, grid, size, &mut found, team, execution)?;
        }
    }
    Ok(found)
}

/// Where fields go: arrays of shape (z, y, x) whose first voxel is the volume's voxel `first`, x, y, z.
struct Fields<'a> {
    distance: ArrayViewMut3<'a, f32>,
    ridge: ArrayViewMut3<'a, f32>,
    first: [usize; 3],
}

/// Writes the fields of whole components where the arrays have room for them.
fn write_fields(
    parts: &[Part],
    grid: &Grid,
    fields: &mut Fields,
    execution: &mut Execution,
) -> Result<()> {
    let unit = grid.unit() as f32;
    for_each_ridge_field(
        parts,
        grid,
        execution,
        (1.0, "Writing the fields"),
        |batch, field, _| Ok((batch, field)),
        |(batch, field)| {
            for (brick, place) in batch.places() {
                for (entry, voxel) in bricks::voxels(brick, place, grid.dimensions) {
                    // What lies before the first wraps round to beyond the last.
                    let [x, y, z] = std::array::from_fn(|a| voxel[a].wrapping_sub(fields.first[a]));
                    let places = (
                        fields.distance.get_mut([z, y, x]),
                        fields.ridge.get_mut([z, y, x]),
                    );
                    if let (Some(d), Some(r)) = places {
                        // Margins of neighbouring parts overlap: the stronger field wins.
                        *d = d.max(field.distance[entry] * unit);
                        *r = r.max(field.ridge[entry] * unit);
                    }
                }
            }
            Ok(())
        },
    )
}

/// The polylines, and the number of disks in place of which there are none.
fn trace_polylines(
    parts: &[Part],
    grid: &Grid,
    execution: &mut Execution,
    until: f64,
) -> Result<(Polylines, usize)> {
    let mut polylines = Polylines::default();
    let mut disks = 0;
    for_each_ridge_field(
        parts,
        grid,
        execution,
        (until, "Tracing mid-polylines"),
        |batch, field, execution| polylines::polylines(&batch, &field, grid, execution),
        |(found, disks_of_batch)| {
            disks += disks_of_batch;
            polylines.append(found)
        },
    )?;
    Ok((polylines, disks))
}

fn find_ridge_surface(
    parts: &[Part],
    grid: &Grid,
    (edge_length, sizes): (f64, Sizes),
    found: &mut Found,
    team: &mut Team,
    execution: &mut Execution,
) -> Result<()> {
    found.findings.is_slice = grid.dimensions.contains(&1);
    if found.findings.is_slice {
        return Ok(());
    }
    let work = |parts: &[Part], execution: &mut Execution| {
        ridge_surface::ridge_surface(parts, grid, edge_length, execution)
    };
    let all: usize = parts.iter().map(Part::voxels).sum();
    let share = |voxels: usize| READING + (1.0 - READING) * voxels as f64 / all as f64;
    let mut done = 0;
    for lot in sizes.lots(parts)? {
        let before = done;
        done += lot.iter().map(Part::voxels).sum::<usize>();
        let span = [share(before), share(done)];
        if sizes.is_tiled(lot) {
            execution.within(span[0], span[1]);
            let size = (edge_length, sizes.side);
            if let Some(tiled) = tiled_surface(lot, grid, size, team, execution)? {
                found.add_tiled(lot, tiled, team)?;
                continue;
            }
            // All processes have the component; one works on it as a whole.
            if lot[0].component as usize % team.processes() != team.process() {
                continue;
            }
        }
        for_each_batch(lot, execution, span, work, |parts, surface| {
            found.findings.add_without(parts, &surface);
            found.mesh.append(surface)
        })?;
    }
    found.findings.triangles = found.mesh.triangles.len();
    found.findings.is_far = !parts.is_empty() && findings::is_volume_far(grid);
    Ok(())
}

/// Takes the share `until` of what is left of the progress.
fn zip(
    polylines: &Polylines,
    findings: &mut Findings,
    until: f64,
    execution: &mut Execution,
) -> Result<ZippedSurface> {
    let polylines = &*polylines.without_repeats()?;
    execution.stage("Zipping polylines", 0.0, 0.6 * until, zipper::PASSES)?;
    let triangles = zipper::zip(polylines, execution)?;
    execution.stage(
        "Making the mesh",
        0.6 * until,
        until,
        zipped_surface::PASSES,
    )?;
    findings.lines = polylines.lines.len();
    findings.triangles = triangles.len();
    if let Some(([a, b, _], _)) = triangles.first() {
        let [a, b] = [a, b].map(|&p| polylines.points[p as usize]);
        let edge = grid::length(grid::sub(a, b));
        findings.is_far = findings::is_far(grid::farthest(&polylines.points), edge);
    }
    ZippedSurface::new(polylines, triangles, execution)
}
